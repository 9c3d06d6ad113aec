//! What the arguments of options mean, and which make no sense.

use std::ffi::OsStr;
use std::fmt;
use std::marker::PhantomData;
use std::str::FromStr;

use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Arg, Command};
use raywarp::render::MAX_SIDE;
use raywarp::scene::radians;
use raywarp::scene::schema::{Kind, Value};
use raywarp::scene::srgb::srgb;

/// `WxH` in pixels.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let form = || "give width and height in pixels, such as 1920x1080".to_owned();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(form)?;
    let side = |text: &str| text.parse::<u64>().map_err(|_| form());
    let (width, height) = (side(width)?, side(height)?);
    if width == 0 || height == 0 {
        return Err("a picture has at least 1x1 pixels".to_owned());
    }
    let side = |side: u64| u32::try_from(side).ok().filter(|&side| side <= MAX_SIDE);
    match (side(width), side(height)) {
        (Some(width), Some(height)) => Ok([width, height]),
        _ => Err(format!("a picture has at most {MAX_SIDE} pixels each way")),
    }
}

/// `x0,y0,x1,y1` in pixels from the upper left, the end excluded.
pub fn crop(text: &str) -> Result<[u32; 4], String> {
    let form = "give the first column and row and the ones after the last, such as 100,50,740,410";
    let [x0, y0, x1, y1] = numbers::<u32, 4>(text).ok_or(form)?;
    if x0 >= x1 || y0 >= y1 {
        return Err("it holds no pixels: x0 must be less than x1, and y0 less than y1".to_owned());
    }
    Ok([x0, y0, x1, y1])
}

/// `x,y,z`, all finite.
pub fn vector(text: &str) -> Result<[f32; 3], String> {
    let vector = numbers::<f32, 3>(text).ok_or("give three numbers, such as 0,1.5,-3")?;
    if vector.iter().all(|coordinate| coordinate.is_finite()) {
        Ok(vector)
    } else {
        Err("coordinates are finite numbers".to_owned())
    }
}

/// What is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Upward {
    /// Not zero.
    pub direction: [f32; 3],
    /// Whether it was an axis by its name.
    pub is_axis: bool,
}

/// What is up: a direction; by the name of an axis, that of the scene too.
pub fn upward(text: &str) -> Result<Upward, String> {
    Ok(Upward { direction: direction(text)?, is_axis: !text.contains(',') })
}

/// A direction: `x,y,z`, or an axis such as `+Z`.
pub fn direction(text: &str) -> Result<[f32; 3], String> {
    let direction = match text.to_ascii_lowercase().as_str() {
        "+x" | "x" => [1.0, 0.0, 0.0],
        "+y" | "y" => [0.0, 1.0, 0.0],
        "+z" | "z" => [0.0, 0.0, 1.0],
        "-x" => [-1.0, 0.0, 0.0],
        "-y" => [0.0, -1.0, 0.0],
        "-z" => [0.0, 0.0, -1.0],
        _ => vector(text).map_err(|error| format!("{error}, or an axis, such as +Z"))?,
    };
    if direction == [0.0; 3] {
        return Err("a direction is not zero".to_owned());
    }
    Ok(direction)
}

/// A field of view in degrees.
pub fn field_of_view(text: &str) -> Result<f64, String> {
    ranged(text, 0.001, 179.0).ok_or_else(|| "give an angle from 0.001 to 179 degrees".to_owned())
}

/// Degrees about an upward axis.
pub fn azimuth(text: &str) -> Result<f64, String> {
    ranged(text, -360.0, 360.0).ok_or_else(|| "give an angle from -360 to 360 degrees".to_owned())
}

/// Degrees above a horizon.
pub fn elevation(text: &str) -> Result<f64, String> {
    ranged(text, -90.0, 90.0).ok_or_else(|| "give an angle from -90 to 90 degrees".to_owned())
}

/// How many times as large.
pub fn zoom(text: &str) -> Result<f64, String> {
    ranged(text, 0.01, 100.0).ok_or_else(|| "give a factor from 0.01 to 100".to_owned())
}

/// What rays see that leave the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Backdrop {
    /// Nothing: pixels there are transparent.
    None,
    /// One linear colour all around.
    Color([f32; 3]),
}

/// As [`backdrop`] reads it, to the same bits.
impl fmt::Display for Backdrop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Color([r, g, b]) => write!(f, "{r:?},{g:?},{b:?}"),
        }
    }
}

/// A colour, or `none`.
pub fn backdrop(text: &str) -> Result<Backdrop, String> {
    if text.eq_ignore_ascii_case("none") {
        return Ok(Backdrop::None);
    }
    color(text).map(Backdrop::Color).map_err(|form| form.replacen("give ", "give none, ", 1))
}

/// A linear colour, by its name, as sRGB, or by its components.
pub fn color(text: &str) -> Result<[f32; 3], String> {
    let form = "give black, white, an sRGB colour such as #336699, or a linear one such as 0.2,0.4,0.6";
    let color = match text.to_ascii_lowercase().as_str() {
        "black" => Some([0.0; 3]),
        "white" => Some([1.0; 3]),
        _ if text.starts_with('#') => srgb(text),
        _ => numbers::<f32, 3>(text).or_else(|| numbers::<f32, 1>(text).map(|[grey]| [grey; 3])),
    };
    let color = color.filter(|color| Kind::Color.takes(Value::Triple(*color)));
    color.ok_or_else(|| form.to_owned())
}

/// Height of a picture by parallel rays.
pub fn height(text: &str) -> Result<f32, String> {
    ranged(text, f32::MIN_POSITIVE, f32::MAX).ok_or_else(|| "give a height in scene units, more than 0".to_owned())
}

/// A turn in degrees.
pub fn turn(text: &str) -> Result<f32, String> {
    number(text, -360.0, 360.0, "degrees")
}

/// What radiance is multiplied by.
pub fn factor(text: &str) -> Result<f32, String> {
    number(text, 0.0, 1e6, "")
}

/// Seconds to measure for.
pub fn seconds(text: &str) -> Result<f64, String> {
    ranged(text, 0.01, 3600.0).ok_or_else(|| "give a number of seconds from 0.01 to 3600".to_owned())
}

/// A value of a kind of the schema.
pub fn value(kind: Kind, text: &str) -> Result<Value, String> {
    match kind {
        Kind::Flag { .. } => one_of(&["on", "off"], text).map(|word| Value::Flag(word == "on")),
        Kind::Count { low, high } => whole(low.into(), high.into())(text).map(Value::Count),
        Kind::Size { .. } => size(text).map(Value::Size),
        Kind::Number { low, high, unit } => number(text, low, high, unit).map(Value::Number),
        Kind::Positive => height(text).map(Value::Number),
        Kind::Angle => number(text, 0.0, 90.0, "degrees").map(|angle| Value::Number(radians(angle.into()))),
        Kind::Color | Kind::Share | Kind::Vector | Kind::Terms => {
            let value = vector(text).map(Value::Triple)?;
            Some(value).filter(|&value| kind.takes(value)).ok_or_else(|| format!("give {kind}"))
        }
        Kind::Words(words) => one_of(words, text).map(Value::Word),
    }
}

/// Read in single precision at once: rounding twice might miss the number that was written.
fn number(text: &str, low: f64, high: f64, unit: &str) -> Result<f32, String> {
    let of = if unit.is_empty() { String::new() } else { format!(" of {unit}") };
    let number = text.parse().ok().filter(|&number: &f32| (low..=high).contains(&f64::from(number)));
    number.ok_or_else(|| format!("give a number{of} from {low} to {high}"))
}

fn one_of(words: &[&'static str], text: &str) -> Result<&'static str, String> {
    let known = words.iter().copied().find(|word| *word == text);
    known.ok_or_else(|| format!("there is no such; expected {}", listed(words)))
}

/// "a, b or c".
fn listed(words: &[&str]) -> String {
    match words {
        [rest @ .., last] if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => words.concat(),
    }
}

/// A whole number within bounds, both included.
pub fn whole<T>(low: u64, high: u64) -> impl Fn(&str) -> Result<T, String> + Clone
where
    T: TryFrom<u64>,
{
    move |text| {
        let number = text.trim().parse().ok().filter(|number: &u64| (low..=high).contains(number));
        number.and_then(|number| T::try_from(number).ok()).ok_or_else(|| match high {
            u64::MAX => format!("give a whole number, {low} or more"),
            _ => format!("give a whole number from {low} to {high}"),
        })
    }
}

/// Words that an option takes, for completions; what is given is read by [`FromStr`], which may know more.
pub fn words<T>(words: impl IntoIterator<Item = &'static str>) -> Words<T> {
    Words { words: words.into_iter().collect(), value: PhantomData }
}

/// See [`words`].
#[derive(Clone)]
pub struct Words<T> {
    words: Vec<&'static str>,
    value: PhantomData<fn() -> T>,
}

impl<T> TypedValueParser for Words<T>
where
    T: FromStr + Clone + Send + Sync + 'static,
    T::Err: ToString,
{
    type Value = T;

    fn parse_ref(&self, command: &Command, argument: Option<&Arg>, value: &OsStr) -> Result<T, clap::Error> {
        let parse = |text: &str| text.parse().map_err(|error: T::Err| error.to_string());
        parse.parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.words.iter().copied().map(PossibleValue::new)))
    }
}

fn ranged<T: FromStr + PartialOrd>(text: &str, low: T, high: T) -> Option<T> {
    text.parse().ok().filter(|value| (low..=high).contains(value))
}

fn numbers<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let numbers: Option<Vec<T>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    numbers?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_absurd_ones_refused() {
        assert_eq!(size("1920x1080"), Ok([1920, 1080]));
        for (text, reason) in [
            ("1920", "give width"),
            ("x", "give width"),
            ("-1x5", "give width"),
            ("0x5", "at least"),
            ("5x0", "at least"),
            ("1x65537", "at most"),
            ("99999999999x1", "at most"),
        ] {
            assert!(size(text).is_err_and(|error| error.contains(reason)), "{text}");
        }
    }

    #[test]
    fn whole_numbers_have_bounds_and_are_told_in_words() {
        let port = whole::<u16>(0, 65535);
        assert_eq!((port("8787"), port("0")), (Ok(8787), Ok(0)));
        for text in ["70000", "-1", "1.5", "x", "", "99999999999999999999999"] {
            assert_eq!(port(text), Err("give a whole number from 0 to 65535".to_owned()), "{text}");
        }
        assert_eq!(whole::<u64>(1, u64::MAX)("0"), Err("give a whole number, 1 or more".to_owned()));
    }

    #[test]
    fn crops_hold_pixels() {
        assert_eq!(crop("1, 2, 3, 4"), Ok([1, 2, 3, 4]));
        for text in ["", "1,2,3", "1,2,1,4", "1,4,3,2", "1,2,3,4,5", "-1,0,3,3"] {
            assert!(crop(text).is_err(), "{text}");
        }
    }

    #[test]
    fn vectors_are_finite_and_directions_not_zero() {
        assert_eq!(vector("1,-2.5,3e1"), Ok([1.0, -2.5, 30.0]));
        assert_eq!(direction("-Z"), Ok([0.0, 0.0, -1.0]));
        assert!(vector("1,2,nan").is_err() && vector("inf,0,0").is_err() && vector("1,2").is_err());
        assert!(direction("0,0,0").is_err() && direction("up").is_err());
    }

    #[test]
    fn backgrounds_are_colours_or_none() {
        assert_eq!(backdrop("none"), Ok(Backdrop::None));
        assert_eq!(backdrop("0.25,0.5,2"), Ok(Backdrop::Color([0.25, 0.5, 2.0])));
        for white in ["#ffffff", "white", "1", "1,1,1"] {
            assert_eq!(backdrop(white), Ok(Backdrop::Color([1.0; 3])), "{white}");
        }
        for text in ["", "#fff", "#12345g", "-1", "nan", "1,2", "sky"] {
            assert!(backdrop(text).is_err(), "{text}");
        }
        assert!(color("none").is_err() && color("white") == Ok([1.0; 3]), "a colour alone");
        let color = backdrop("#336699").unwrap();
        assert_eq!(backdrop(&color.to_string()), Ok(color));
    }

    #[test]
    fn words_are_known_and_told() {
        let tree = |text| value(Kind::Words(&["fast", "medium", "high"]), text);
        assert_eq!(tree("high"), Ok(Value::Word("high")));
        assert_eq!(tree("best"), Err("there is no such; expected fast, medium or high".to_owned()));
    }

    #[test]
    fn angles_and_stops_have_bounds() {
        assert_eq!(field_of_view("45"), Ok(45.0));
        assert!(["0", "180", "nan", "-5", "x"].iter().all(|text| field_of_view(text).is_err()));
        assert!(["inf", "nan", "0", "-1"].iter().all(|text| height(text).is_err()) && height("2.5") == Ok(2.5));
        let exposure = |text| value(Kind::Number { low: -60.0, high: 60.0, unit: "stops" }, text);
        assert_eq!(exposure("-0.5"), Ok(Value::Number(-0.5)));
        let refused = Err("give a number of stops from -60 to 60".to_owned());
        assert!(["inf", "nan", "61"].iter().all(|text| exposure(text) == refused));
    }
}
