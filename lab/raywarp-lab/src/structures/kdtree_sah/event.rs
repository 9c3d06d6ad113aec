//! Where parts of triangles begin and end along an axis: the places where a plane may cut.

/// The begin or the end of a part along an axis, as one number: its place, then whether it begins, then which part it is.
/// So they sort by place, and what ends at a place comes before what begins there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Event(u64);

const BEGINS: u64 = 1 << 31;

impl Event {
    /// Both events of a part.
    pub fn pair(part: u32, low: f32, high: f32) -> [Self; 2] {
        [Self(ordered(low) << 32 | BEGINS | u64::from(part)), Self(ordered(high) << 32 | u64::from(part))]
    }

    /// Coordinate of the begin or the end.
    pub fn at(self) -> f32 {
        let bits = (self.0 >> 32) as u32;
        f32::from_bits(if bits >> 31 == 1 { bits & !(1 << 31) } else { !bits })
    }

    /// Whether the part begins here; else it ends.
    pub fn begins(self) -> bool {
        self.0 & BEGINS != 0
    }

    /// Index of the part in its cell.
    pub fn part(self) -> usize {
        (self.0 & (BEGINS - 1)) as usize
    }

    /// The same of a part that has another index now.
    pub fn of(self, part: u32) -> Self {
        Self(self.0 & !(BEGINS - 1) | u64::from(part))
    }

    /// Whether both are at the same place.
    pub fn meets(self, other: Self) -> bool {
        self.0 >> 32 == other.0 >> 32
    }
}

/// Bits that sort as the numbers do. The two zeros are one place.
fn ordered(x: f32) -> u64 {
    let bits = (x + 0.0).to_bits();
    u64::from(if bits >> 31 == 0 { bits | 1 << 31 } else { !bits })
}

/// Two sorted lists as one.
pub(super) fn merged(a: Vec<Event>, b: &[Event]) -> Vec<Event> {
    if b.is_empty() {
        return a;
    }
    let mut all = Vec::with_capacity(a.len() + b.len());
    let (mut a, mut b) = (&a[..], b);
    while let ([first, rest_a @ ..], [second, rest_b @ ..]) = (a, b) {
        if first <= second {
            all.push(*first);
            a = rest_a;
        } else {
            all.push(*second);
            b = rest_b;
        }
    }
    all.extend(a);
    all.extend(b);
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn events_sort_as_their_places_do(a: f32, b: f32, part in 0u32..1 << 31) {
            prop_assume!(a.is_finite() && b.is_finite());
            for (first, second) in Event::pair(part, a, a).into_iter().zip(Event::pair(0, b, b)) {
                prop_assert_eq!((first.at(), first.part()), (a, part as usize));
                prop_assert_eq!(first.at() < second.at(), !first.meets(second) && first < second);
            }
            let [begin, end] = Event::pair(part, a, a);
            prop_assert!(end < begin && begin.begins() && !end.begins());
        }

        #[test]
        fn merged_is_sorted(mut a: Vec<u64>, mut b: Vec<u64>) {
            let mut all: Vec<_> = a.iter().chain(&b).copied().map(Event).collect();
            all.sort_unstable();
            a.sort_unstable();
            b.sort_unstable();
            let [a, b] = [a, b].map(|list| list.into_iter().map(Event).collect::<Vec<_>>());
            prop_assert_eq!(merged(a, &b), all);
        }
    }

    #[test]
    fn both_zeros_are_one_place() {
        assert!(Event::pair(0, 0.0, -0.0)[0].meets(Event::pair(1, -0.0, 0.0)[0]));
    }
}
