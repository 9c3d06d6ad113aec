//! Numbers as people read them: three digits that count, and `-` for what is no number.

use raywarp_cli::bench::Spread;

/// Stands for what is not there.
pub const NONE: &str = "-";

/// Three significant digits; whole numbers above that keep all of theirs, in groups.
pub fn number(value: f64) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    let size = value.abs();
    if size == 0.0 {
        "0".to_owned()
    } else if !(1e-4..1e12).contains(&size) {
        format!("{value:.2e}")
    } else if size >= 99.95 {
        grouped(&format!("{value:.0}"))
    } else {
        let digits = 2 - size.log10().floor() as i32;
        // 9.999 has one digit more before the point once it is rounded.
        let rounded = format!("{size:.0$}", digits.max(0) as usize);
        let digits = digits - i32::from(rounded.parse().is_ok_and(|r: f64| r.log10().floor() > size.log10().floor()));
        format!("{value:.0$}", digits.max(0) as usize)
    }
}

/// A mark of an axis: a number without zeros that say nothing, millions and more in units of their own.
pub fn tick(value: f64) -> String {
    match value.abs() {
        1e6..1e9 => format!("{} M", trimmed(value * 1e-6)),
        1e9..1e12 => format!("{} G", trimmed(value * 1e-9)),
        _ => trimmed(value),
    }
}

fn trimmed(value: f64) -> String {
    let text = number(value);
    let (mantissa, exponent) = text.split_once('e').map_or((text.as_str(), None), |(m, e)| (m, Some(e)));
    let short = match mantissa.contains('.') {
        true => mantissa.trim_end_matches('0').trim_end_matches('.'),
        false => mantissa,
    };
    exponent.map_or(short.to_owned(), |exponent| format!("{short}e{exponent}"))
}

/// A count, its digits in groups.
pub fn count(value: impl TryInto<u64>) -> String {
    value.try_into().map_or(NONE.to_owned(), |value| grouped(&value.to_string()))
}

/// A share of 0 to 1.
pub fn percent(share: f64) -> String {
    match share.is_finite() {
        true => format!("{} %", number(100.0 * share)),
        false => NONE.to_owned(),
    }
}

/// A share that others have rounded.
pub fn round_percent(share: f64) -> String {
    format!("{} %", tick(100.0 * share))
}

/// How many times as much.
pub fn times(value: f64) -> String {
    match value.is_finite() {
        true => format!("{}×", number(value)),
        false => NONE.to_owned(),
    }
}

/// The median, and from where to where.
pub fn spread(Spread { median, least, most }: Spread) -> String {
    let [median, least, most] = [median, least, most].map(number);
    if least == most {
        return median;
    }
    format!("{median} ({least} to {most})")
}

/// Digits of a whole number in groups of three.
fn grouped(digits: &str) -> String {
    let (sign, digits) = digits.strip_prefix('-').map_or(("", digits), |digits| ("-", digits));
    let mut text = String::from(sign);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index) % 3 == 0 {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_count() {
        let cases = [
            (0.0, "0"),
            (1234.5, "1,234"),
            (17_000_000.0, "17,000,000"),
            (123.4, "123"),
            (99.96, "100"),
            (12.345, "12.3"),
            (9.999, "10.0"),
            (1.0, "1.00"),
            (0.12345, "0.123"),
            (0.000_999_9, "0.00100"),
            (-2.5, "-2.50"),
            (1e-9, "1.00e-9"),
            (3e15, "3.00e15"),
            (f64::NAN, "-"),
            (f64::INFINITY, "-"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value), text, "{value}");
        }
    }

    #[test]
    fn marks_are_short() {
        assert_eq!([0.0, 2.0, 0.5, 20.0, 1000.0, 1e-6].map(tick), ["0", "2", "0.5", "20", "1,000", "1e-6"]);
        assert_eq!([1e6, 2.5e7, -3e9].map(tick), ["1 M", "25 M", "-3 G"]);
    }

    #[test]
    fn shares_have_three_digits_as_well() {
        let texts = [0.0, 0.0012, 0.037, 0.115, 1.0, f64::NAN].map(percent);
        assert_eq!([0.9, 0.037, 0.115].map(round_percent), ["90 %", "3.7 %", "11.5 %"]);
        assert_eq!(texts, ["0 %", "0.120 %", "3.70 %", "11.5 %", "100 %", "-"]);
    }
}
