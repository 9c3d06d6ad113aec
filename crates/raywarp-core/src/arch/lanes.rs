//! A value for each of 32 lanes: of a warp's threads on a GPU, of one thread in turn on a CPU.
//!
//! What is written with these runs in all lanes at once on both machines: a step is a closure that is called for each
//! lane, and between two steps every lane may have the values of every other.

/// Lanes of a warp.
pub const LANES: u32 = 32;

/// What threads of a warp may give to each other.
pub trait Shuffle: Copy + Default {
    /// The value of the thread in a lane, counted modulo [`LANES`]. All threads of the warp are here.
    fn of_lane(self, lane: u32) -> Self;
}

impl Shuffle for u32 {
    #[inline(always)]
    fn of_lane(self, lane: u32) -> Self {
        // SAFETY: all threads of the warp are here.
        unsafe { super::broadcast(u32::MAX >> (32 - super::WARP), self, lane % LANES) }
    }
}

impl Shuffle for f32 {
    #[inline(always)]
    fn of_lane(self, lane: u32) -> Self {
        f32::from_bits(self.to_bits().of_lane(lane))
    }
}

/// A value for each lane. On a GPU all threads of the warp are together wherever one is made or asked.
#[derive(Clone, Copy)]
pub struct Lanes<T> {
    #[cfg(target_arch = "nvptx64")]
    own: T,
    #[cfg(not(target_arch = "nvptx64"))]
    all: [T; LANES as usize],
}

impl<T: Copy + Default> Lanes<T> {
    /// What `value` gives for each lane.
    #[inline(always)]
    pub fn each(mut value: impl FnMut(u32) -> T) -> Self {
        #[cfg(target_arch = "nvptx64")]
        return Self { own: value(super::lane()) };
        #[cfg(not(target_arch = "nvptx64"))]
        {
            let mut all = [T::default(); LANES as usize];
            for lane in 0..LANES {
                all[lane as usize] = value(lane);
            }
            Self { all }
        }
    }

    /// The value of the lane whose step this is.
    #[inline(always)]
    pub fn of(&self, lane: u32) -> T {
        #[cfg(target_arch = "nvptx64")]
        {
            let _ = lane;
            self.own
        }
        #[cfg(not(target_arch = "nvptx64"))]
        self.all[(lane % LANES) as usize]
    }
}

impl<T: Shuffle> Lanes<T> {
    /// The value of any lane, counted modulo [`LANES`]; all lanes ask in the same step, each for the one that it likes.
    #[inline(always)]
    pub fn from(&self, lane: u32) -> T {
        #[cfg(target_arch = "nvptx64")]
        return self.own.of_lane(lane);
        #[cfg(not(target_arch = "nvptx64"))]
        self.all[(lane % LANES) as usize]
    }

    /// To each lane the value of the one so many after it; to the last ones, which have none, any.
    #[inline(always)]
    pub fn later(&self, by: u32) -> Self {
        #[cfg(target_arch = "nvptx64")]
        return Self::each(|lane| self.from(lane + by));
        #[cfg(not(target_arch = "nvptx64"))]
        {
            let (mut all, by) = (self.all, by as usize);
            all[..LANES as usize - by].copy_from_slice(&self.all[by..]);
            Self { all }
        }
    }

    /// To each lane the value of the one so many before it; to the first ones, which have none, any.
    #[inline(always)]
    pub fn earlier(&self, by: u32) -> Self {
        #[cfg(target_arch = "nvptx64")]
        return Self::each(|lane| self.from(lane.wrapping_sub(by)));
        #[cfg(not(target_arch = "nvptx64"))]
        {
            let (mut all, by) = (self.all, by as usize);
            all[by..].copy_from_slice(&self.all[..LANES as usize - by]);
            Self { all }
        }
    }
}

/// The lanes that say yes, a bit each.
#[inline(always)]
pub fn lanes_where(mut yes: impl FnMut(u32) -> bool) -> u32 {
    #[cfg(target_arch = "nvptx64")]
    // SAFETY: all threads of the warp are here.
    return unsafe { super::ballot(u32::MAX, yes(super::lane())) };
    #[cfg(not(target_arch = "nvptx64"))]
    (0..LANES).fold(0, |bits, lane| bits | (yes(lane) as u32) << lane)
}

/// Does something in each lane.
#[inline(always)]
pub fn in_each_lane(mut act: impl FnMut(u32)) {
    #[cfg(target_arch = "nvptx64")]
    act(super::lane());
    #[cfg(not(target_arch = "nvptx64"))]
    for lane in 0..LANES {
        act(lane);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_see_each_other() {
        let own = Lanes::<u32>::each(|lane| 10 * lane);
        assert_eq!([own.later(3).of(0), own.later(3).of(28)], [30, 310]);
        assert_eq!([own.earlier(3).of(3), own.earlier(3).of(31)], [0, 280]);
        assert_eq!(Lanes::<u32>::each(|lane| own.from(31 - lane)).of(1), 300);
        assert_eq!(lanes_where(|lane| own.of(lane) < 50), 0b11111);
        let mut sum = 0;
        in_each_lane(|lane| sum += lane);
        assert_eq!(sum, 31 * 16);
    }
}
