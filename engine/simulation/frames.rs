//! The moments at which pictures are made: frame `k` is at `k / frames_per_second`.

/// The frames of a scene. Steps land on their times exactly, so a time is compared without a tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frames {
    per_second: f64,
}

impl Frames {
    /// Frames at a rate, 1/s.
    #[must_use]
    pub const fn per_second(rate: f64) -> Self {
        Self { per_second: rate }
    }

    /// Time of a frame, s.
    #[must_use]
    pub fn time(&self, frame: u64) -> f64 {
        frame as f64 / self.per_second
    }

    /// The frame at exactly this time.
    #[must_use]
    pub fn at(&self, time: f64) -> Option<u64> {
        let nearest = (time * self.per_second).round() as u64;
        (self.time(nearest) == time).then_some(nearest)
    }

    /// The first frame after a time.
    #[must_use]
    pub fn next_after(&self, time: f64) -> u64 {
        let guess = (time * self.per_second).floor() as u64;
        (guess..).find(|&frame| self.time(frame) > time).expect("invariant: times of frames grow without bound")
    }

    /// Frames up to a time, counting the one at 0.
    #[must_use]
    pub fn count_until(&self, time: f64) -> u64 {
        self.next_after(time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_frame_follows_the_one_before(rate in 0.1..1e4_f64, frame in 0..100_000_u64) {
            let frames = Frames::per_second(rate);
            prop_assert_eq!(frames.at(frames.time(frame)), Some(frame));
            prop_assert_eq!(frames.next_after(frames.time(frame)), frame + 1);
        }
    }

    #[test]
    fn a_time_between_frames_is_none() {
        let frames = Frames::per_second(50.0);
        assert_eq!((frames.at(0.03), frames.next_after(0.03)), (None, 2));
        assert_eq!(frames.count_until(2.0), 101);
    }
}
