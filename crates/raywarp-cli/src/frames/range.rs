//! Which frames: `1..240`, `1..240/2`, `7`.

use std::fmt;

use crate::failure::{ensure, Result};

/// Frames by their numbers, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// The first one.
    pub first: u32,
    /// None is later; where the step misses it, it is not among them.
    pub last: u32,
    /// From a frame to the next.
    pub step: u32,
}

/// Most frames of a run.
const MOST: u64 = 1_000_000;

impl Range {
    /// `FIRST..LAST`, `FIRST..LAST/STEP` or `FRAME`.
    pub fn parse(text: &str) -> Result<Self, String> {
        let form =
            || "give the first and the last frame, such as 1..240, or 1..240/2 for every second, or one".to_owned();
        let number = |text: &str| text.trim().parse::<u32>().map_err(|_| form());
        let (ends, step) = text.split_once('/').map_or((text, Ok(1)), |(ends, step)| (ends, number(step)));
        let (first, last) = ends.split_once("..").unwrap_or((ends, ends));
        let range = Self { first: number(first)?, last: number(last)?, step: step? };
        if range.last < range.first || range.step == 0 {
            return Err("it holds no frames: the first is not after the last, and the step is at least 1".to_owned());
        }
        if u64::from(range.last - range.first) / u64::from(range.step) >= MOST {
            return Err(format!("it holds more than {MOST} frames"));
        }
        Ok(range)
    }

    /// `N` for `1..N`, or `FIRST..LAST`.
    pub fn parse_whole(text: &str) -> Result<Self, String> {
        match text.contains("..") {
            true if text.contains('/') => Err("all frames of the flight have no step: give FIRST..LAST".to_owned()),
            true => Self::parse(text),
            false => Self::parse(&format!("1..{text}")).map_err(|_| "give a number of frames, such as 240".to_owned()),
        }
    }

    /// Every frame.
    pub fn frames(self) -> impl Iterator<Item = u32> {
        (self.first..=self.last).step_by(self.step as usize)
    }

    /// How many frames there are.
    pub fn count(self) -> u32 {
        (self.last - self.first) / self.step + 1
    }

    /// The range that this is a part of: `whole`, if that is given, else from its own first frame to its last.
    ///
    /// # Errors
    /// Where it is no part of `whole`, or where it is a single frame and nobody says of how many.
    pub fn whole(self, whole: Option<Self>) -> Result<Self> {
        match whole {
            Some(whole) => {
                ensure!(
                    whole.first <= self.first && self.last <= whole.last,
                    "--frames {self} are no part of --of {whole}: give frames from {} to {}",
                    whole.first,
                    whole.last
                );
                Ok(whole)
            }
            None => {
                ensure!(
                    self.first != self.last,
                    "--frames {self} is one frame of how many? Give the flight's number of frames, such as --of 240"
                );
                Ok(Self { step: 1, ..self })
            }
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.first)?;
        if self.last != self.first {
            write!(f, "..{}", self.last)?;
        }
        if self.step != 1 {
            write!(f, "/{}", self.step)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(text: &str) -> Vec<u32> {
        let range = Range::parse(text).unwrap();
        let frames: Vec<u32> = range.frames().collect();
        assert_eq!(frames.len(), range.count() as usize, "{text}");
        frames
    }

    #[test]
    fn both_ends_are_frames() {
        assert_eq!(frames("1..4"), [1, 2, 3, 4]);
        assert_eq!(frames("0..7/3"), [0, 3, 6]);
        assert_eq!(frames(" 2 .. 6 / 2"), [2, 4, 6]);
        assert_eq!(frames("7"), [7]);
        assert_eq!(frames("4294967294..4294967295"), [4_294_967_294, 4_294_967_295]);
    }

    #[test]
    fn what_holds_no_frames_is_refused() {
        for text in ["", "..", "1..", "..5", "a..b", "-1..3", "1...3", "1..2..3", "1..4/x", "99999999999"] {
            assert!(Range::parse(text).is_err_and(|error| error.contains("such as 1..240")), "{text}");
        }
        assert!(["4..1", "1..4/0"].iter().all(|text| Range::parse(text).is_err()));
        assert!(Range::parse("0..4294967295").is_err_and(|error| error.contains("more than 1000000")));
        assert!(Range::parse("0..4294967295/4295").is_ok());
    }

    #[test]
    fn a_part_lies_within_the_whole() {
        let [part, whole, zero] = ["1..120", "240", "0..99"].map(|text| Range::parse_whole(text).unwrap());
        assert_eq!((whole.first, whole.last), (1, 240));
        assert_eq!(part.whole(Some(whole)).unwrap(), whole);
        assert!(part.whole(Some(zero)).is_err());
        assert_eq!(Range::parse("1..9/4").unwrap().whole(None).unwrap(), Range { first: 1, last: 9, step: 1 });
        assert!(Range::parse("7").unwrap().whole(None).unwrap_err().to_string().contains("--of 240"));
        assert!(["0", "x", "1..9/2", "-3"].iter().all(|text| Range::parse_whole(text).is_err()));
    }
}
