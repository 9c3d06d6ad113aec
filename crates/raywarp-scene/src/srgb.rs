//! The transfer function of sRGB (IEC 61966-2-1).

/// Linear value of an sRGB one, both from 0 to 1.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// [`srgb_to_linear`] in double precision, for tables and for values of more than 8 bits.
pub fn srgb_to_linear_precise(encoded: f64) -> f64 {
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

/// Linear colour of `#rrggbb`; nothing for any other text.
pub fn srgb(text: &str) -> Option<[f32; 3]> {
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii())?;
    let mut color = [0.0; 3];
    for (index, channel) in color.iter_mut().enumerate() {
        let byte = u8::from_str_radix(&digits[2 * index..2 * index + 2], 16).ok()?;
        *channel = srgb_to_linear(f32::from(byte) / 255.0);
    }
    Some(color)
}
