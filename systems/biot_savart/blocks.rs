//! Panels and their sums in blocks of eight, one array per component: the layout that vector instructions read.
//!
//! Lengths in here are in units of the smoothing length about a common origin, so that `s = r² + 1`. A block that is not full is
//! padded with panels of no strength at its first panel's place, which add nothing to others and are not read back.

use glam::DVec3;

/// Panels per block: the widest vectors hold eight numbers.
pub(crate) const LANES: usize = 8;

/// One number per panel of a block, aligned to a cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(64))]
pub(crate) struct Lanes(pub(crate) [f64; LANES]);

/// Three components, one number each per panel of a block.
pub(crate) type Triple = [Lanes; 3];

/// Up to eight panels.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Block {
    /// Centroids, in smoothing lengths.
    pub(crate) centres: Triple,
    /// Area-integrated strengths.
    pub(crate) strengths: Triple,
}

/// Sums at the panels of a block, without their factors.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BlockSums {
    /// `Σ G k`.
    pub(crate) potentials: Triple,
    /// `Σ (G_f·G_g) ∇k`.
    pub(crate) gradients: Triple,
}

impl BlockSums {
    /// Adds to one panel's potential and gradient.
    pub(crate) fn add(&mut self, lane: usize, [potential, gradient]: [DVec3; 2]) {
        for (triple, more) in [(&mut self.potentials, potential), (&mut self.gradients, gradient)] {
            let sum = get(triple, lane) + more;
            set(triple, lane, sum);
        }
    }
}

/// Writes a vector at one panel's place.
pub(crate) fn set(triple: &mut Triple, lane: usize, value: DVec3) {
    for (lanes, x) in triple.iter_mut().zip(value.to_array()) {
        lanes.0[lane] = x;
    }
}

/// Reads a vector at one panel's place.
pub(crate) fn get(triple: &Triple, lane: usize) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis: usize| triple[axis].0[lane]))
}

/// Blocks for the centres, padded, without strength.
pub(crate) fn blocks_at(centres: impl ExactSizeIterator<Item = DVec3>) -> Vec<Block> {
    let mut blocks = vec![Block::default(); centres.len().div_ceil(LANES)];
    for (i, centre) in centres.enumerate() {
        let (block, lane) = (&mut blocks[i / LANES], i % LANES);
        for padded in lane..if lane == 0 { LANES } else { lane + 1 } {
            set(&mut block.centres, padded, centre);
        }
    }
    blocks
}

/// Where a sum's numbers stand between panels in metres and blocks in smoothing lengths.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Frame {
    origin: DVec3,
    inverse_length: f64,
}

impl Frame {
    /// About the middle of the centres' box, in units of `length` (m).
    pub(crate) fn about(centres: &[DVec3], length: f64) -> Self {
        let first = centres.first().copied().unwrap_or(DVec3::ZERO);
        let (low, high) = centres.iter().fold((first, first), |(low, high), x| (low.min(*x), high.max(*x)));
        Self { origin: 0.5 * (low + high), inverse_length: length.recip() }
    }

    /// A place in smoothing lengths.
    pub(crate) fn scaled(&self, place: DVec3) -> DVec3 {
        (place - self.origin) * self.inverse_length
    }

    /// Factor of potentials: `1/(4π α)`.
    pub(crate) fn potential_factor(&self) -> f64 {
        self.inverse_length / (4.0 * std::f64::consts::PI)
    }

    /// Factor of velocities and gradients: `1/(4π α²)`.
    pub(crate) fn gradient_factor(&self) -> f64 {
        self.inverse_length * self.potential_factor()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_hold_what_was_put_in_and_pad_with_copies() {
        let centres: Vec<DVec3> = (0..11).map(|i| DVec3::new(f64::from(i), 1.0, -f64::from(i))).collect();
        let blocks = blocks_at(centres.iter().copied());
        assert_eq!(blocks.len(), 2);
        for (i, centre) in centres.iter().enumerate() {
            assert_eq!(get(&blocks[i / LANES].centres, i % LANES), *centre);
        }
        assert_eq!(get(&blocks[1].centres, 7), centres[8]);
    }
}
