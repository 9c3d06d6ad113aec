//! Decimal numbers, fast where they are short, as the standard library rounds them always.

/// The nearest `f32`; also the spellings of infinity and NaN, Microsoft's among them. `None` for anything else.
#[inline]
pub(crate) fn parse_f32(text: &[u8]) -> Option<f32> {
    short_decimal(text).map(|value| value as f32).or_else(|| any_f32(text))
}

/// The number as it is written, to the nearest `f64`; cast to `f32` it is what [`parse_f32`] gives.
#[inline]
pub(crate) fn parse_f64(text: &[u8]) -> Option<f64> {
    short_decimal(text).or_else(|| any_f64(text))
}

/// A decimal integer with an optional sign. `None` for anything else and beyond 18 digits.
#[inline]
pub(crate) fn parse_integer(text: &[u8]) -> Option<i64> {
    let (negative, digits) = split_sign(text);
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0_i64;
    for &byte in digits {
        if !byte.is_ascii_digit() {
            return None;
        }
        value = 10 * value + i64::from(byte - b'0');
    }
    Some(if negative { -value } else { value })
}

fn split_sign(text: &[u8]) -> (bool, &[u8]) {
    match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    }
}

/// Powers of ten that an `f64` holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// Digits and exponent so small that one exact `f64` operation gives the value (Clinger 1990).
#[inline]
fn short_decimal(text: &[u8]) -> Option<f64> {
    let (negative, text) = split_sign(text);
    let (whole, rest) = digits(0, text)?;
    let (mantissa, rest, decimals) = match rest {
        [b'.', fraction @ ..] => {
            let (mantissa, rest) = digits(whole, fraction)?;
            (mantissa, rest, fraction.len() - rest.len())
        }
        _ => (whole, rest, 0),
    };
    // A dot alone is no number; the general reader says so.
    if decimals == 0 && !text.first()?.is_ascii_digit() {
        return None;
    }
    let exponent = match rest {
        [] => 0,
        [b'e' | b'E', exponent @ ..] if exponent.len() <= 4 => parse_integer(exponent)?,
        _ => return None,
    };
    let value = scaled(mantissa, exponent - decimals as i64)?;
    Some(if negative { -value } else { value })
}

/// Continues a mantissa with the digits at the start of a text. `None` where it would outgrow an `f64`.
#[inline]
fn digits(mut mantissa: u64, text: &[u8]) -> Option<(u64, &[u8])> {
    let mut at = 0;
    while let Some(byte) = text.get(at).filter(|byte| byte.is_ascii_digit()) {
        mantissa = 10 * mantissa + u64::from(byte - b'0');
        if mantissa >= 1 << 53 {
            return None;
        }
        at += 1;
    }
    Some((mantissa, &text[at..]))
}

/// `mantissa * 10^exponent`, rounded once, to `f64`. `None` where a second rounding, to `f32`, might differ from rounding
/// to `f32` at once: half way between two `f32`, below the normal numbers, and beyond the largest.
#[inline]
fn scaled(mantissa: u64, exponent: i64) -> Option<f64> {
    let power = POWERS.get(usize::try_from(exponent.abs()).ok()?)?;
    let value = if exponent < 0 { mantissa as f64 / power } else { mantissa as f64 * power };
    let half_way = value.to_bits() & 0x1fff_ffff == 0x1000_0000;
    let in_range = value == 0.0 || (value >= f64::from(f32::MIN_POSITIVE) && value <= f64::from(f32::MAX));
    (in_range && !half_way).then_some(value)
}

#[cold]
fn any_f32(text: &[u8]) -> Option<f32> {
    let text = std::str::from_utf8(text).ok()?;
    text.parse().ok().or_else(|| microsoft(&text.to_ascii_lowercase()))
}

/// A number that rounds to another `f32` by way of `f64` is given as that `f32`: what is lost is half its last place.
#[cold]
fn any_f64(text: &[u8]) -> Option<f64> {
    let single = any_f32(text)?;
    let exact = std::str::from_utf8(text).ok().and_then(|text| text.parse::<f64>().ok());
    Some(exact.filter(|&exact| (exact as f32).to_bits() == single.to_bits()).unwrap_or(f64::from(single)))
}

/// `1.#INF`, `-1.#IND00`, `1.#QNAN`, `-nan(ind)` as older C libraries print them.
fn microsoft(text: &str) -> Option<f32> {
    let unsigned = text.trim_start_matches(['-', '+']);
    if unsigned.starts_with("1.#inf") {
        return Some(if text.starts_with('-') { f32::NEG_INFINITY } else { f32::INFINITY });
    }
    let nan = ["1.#ind", "1.#qnan", "1.#snan", "nan("].iter().any(|start| unsigned.starts_with(start));
    nan.then_some(f32::NAN)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn numbers_of_all_shapes() {
        for text in ["0", "-0", "+1", "1.", ".5", "-.5e1", "1e-5", "3.4028235e38", "1e-45", "16777217", "1e22", "007"] {
            let ours = parse_f32(text.as_bytes()).map(f32::to_bits);
            assert_eq!(ours, text.parse::<f32>().ok().map(f32::to_bits), "{text}");
        }
        for text in ["", "-", ".", "e5", "1e", "1e+", "1,5", "1.2.3", "0x10", "1f", "--1", "+-1", "1 "] {
            assert_eq!(parse_f32(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn infinities_and_nans() {
        for text in ["inf", "1e999", "Infinity", "1.#INF", "1.#INF00"] {
            assert_eq!(parse_f32(text.as_bytes()), Some(f32::INFINITY), "{text}");
        }
        assert_eq!(parse_f32(b"-1.#INF"), Some(f32::NEG_INFINITY));
        for text in ["nan", "-nan", "NaN", "-1.#IND", "1.#QNAN0", "-nan(ind)"] {
            assert!(parse_f32(text.as_bytes()).is_some_and(f32::is_nan), "{text}");
        }
    }

    #[test]
    fn integers() {
        assert_eq!(parse_integer(b"-12"), Some(-12));
        assert_eq!(parse_integer(b"+7"), Some(7));
        for text in ["", "-", "1.0", "1234567890123456789", "1/2"] {
            assert_eq!(parse_integer(text.as_bytes()), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn rounded_as_the_standard_library_rounds(
            whole in 0_u64..1 << 40, decimals in 0_u32..2_000_000_000, exponent in -50..50,
        ) {
            for text in [format!("{whole}.{decimals}e{exponent}"), format!("-{whole}.{decimals:08}"), whole.to_string()] {
                let expected = text.parse::<f32>().unwrap();
                prop_assert_eq!(parse_f32(text.as_bytes()).map(f32::to_bits), Some(expected.to_bits()), "{}", text);
                let wide = parse_f64(text.as_bytes()).unwrap();
                prop_assert_eq!((wide as f32).to_bits(), expected.to_bits(), "{}", text);
                prop_assert!(wide == f64::from(expected) || wide == text.parse::<f64>().unwrap(), "{}", text);
            }
        }

        #[test]
        fn every_float_survives_being_written(bits in any::<u32>()) {
            let float = f32::from_bits(bits);
            for text in [format!("{float}"), format!("{float:e}"), format!("{:.17}", f64::from(float))] {
                let expected = text.parse::<f32>().unwrap();
                let ours = parse_f32(text.as_bytes()).unwrap();
                prop_assert!(ours.to_bits() == expected.to_bits() || ours.is_nan() && expected.is_nan(), "{}", text);
            }
        }

        #[test]
        fn anything_else_is_none(text in "\\PC{0,12}") {
            let ours = parse_f32(text.as_bytes());
            if let Ok(expected) = text.parse::<f32>() {
                prop_assert!(ours.is_some_and(|x| x == expected || x.is_nan() && expected.is_nan()), "{}", text);
            }
        }
    }
}
