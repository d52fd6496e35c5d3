//! Sixteen places in each sample at which the outlines of triangles and lines are tested.
//!
//! ```text
//!   y = bits of k reversed     No two places share a row or a column of the 16 by 16 cells, so an edge in any
//!   |  .       .               direction meets them one by one: 17 shades from outside to inside.
//!   |      .       .
//!   |    .       .
//!   +-----------------> x = k
//! ```
//! A [`Mask`] has one bit per place. Source: the Hammersley points (Hammersley 1960); masks: Carpenter 1984.

use glam::Vec2;

/// Which of the places in a sample are covered; bit `k` for place `k`.
pub(super) type Mask = u16;

/// All places are covered.
pub(super) const WHOLE: Mask = Mask::MAX;
/// Steps of the finest grid along the edge of a sample: coordinates are rounded to it.
pub(super) const STEPS: i64 = 256;
/// Places along each axis.
const PLACES: u8 = 16;

/// Offsets of the places from the centre of the sample, steps.
pub(super) const OFFSETS: [[i64; 2]; PLACES as usize] = offsets();

const fn offsets() -> [[i64; 2]; PLACES as usize] {
    let mut offsets = [[0; 2]; PLACES as usize];
    let mut k = 0;
    while k < PLACES {
        let (x, y) = (k as i64, (k.reverse_bits() >> 4) as i64);
        offsets[k as usize] = [16 * x + 8 - STEPS / 2, 16 * y + 8 - STEPS / 2];
        k += 1;
    }
    offsets
}

/// Largest offset along an axis, steps.
pub(super) const REACH: i64 = STEPS / 2 - 8;

/// The places for which `covers(offset in steps)` holds.
#[inline]
pub(super) fn mask(covers: impl Fn([i64; 2]) -> bool) -> Mask {
    OFFSETS.iter().enumerate().fold(0, |mask, (k, offset)| mask | Mask::from(covers(*offset)) << k)
}

/// Mean offset of the places in a mask from the centre of the sample, samples; zero for an empty mask.
#[inline]
pub(super) fn middle(mask: Mask) -> Vec2 {
    if mask == WHOLE || mask == 0 {
        return Vec2::ZERO;
    }
    let covered = OFFSETS.iter().enumerate().filter(|(k, _)| mask >> k & 1 == 1);
    let sum = covered.fold([0; 2], |sum, (_, offset)| [sum[0] + offset[0], sum[1] + offset[1]]);
    Vec2::new(sum[0] as f32, sum[1] as f32) / (mask.count_ones() as f32 * STEPS as f32)
}

#[cfg(test)]
mod tests {
    use super::{OFFSETS, REACH, WHOLE, mask, middle};
    use glam::Vec2;

    #[test]
    fn no_two_places_share_a_row_or_a_column() {
        for axis in 0..2 {
            let mut places = OFFSETS.map(|offset| offset[axis]);
            places.sort_unstable();
            assert!(places.windows(2).all(|pair| pair[1] - pair[0] == 16));
            assert_eq!([places[0], places[15]], [-REACH, REACH]);
        }
    }

    #[test]
    fn half_a_sample_has_eight_places_and_its_middle_a_quarter_off() {
        let left = mask(|offset| offset[0] < 0);
        assert_eq!(left.count_ones(), 8);
        assert!((middle(left).x + 0.25).abs() < 1e-6 && middle(left).y.abs() < 0.1);
        assert_eq!(middle(WHOLE), Vec2::ZERO);
    }
}
