//! What the sheet needs of the shape of the films: area vectors, volume gradients, and the space they span at each vertex.
//!
//! # Equation
//! Area vector `a_f = (x1 - x0) x (x2 - x0) / 2`, from back to front. Volume gradient of region `i` at vertex `v`:
//! `N_iv = sum of +a_f/3` over films with `i` in the back, `-a_f/3` with `i` in front. `M_v = sum_i N_iv N_iv^T`.
//!
//! # Discretisation
//! `M_v` has rank 1 on a film, 2 on a Plateau border, 3 where borders meet; eigenvalues below [`RANK_CUT`] of the largest are
//! dropped, so that nearly flat borders count as films. Where a film is folded over itself its area vectors cancel, and dividing by
//! what is left would make velocities of noise: inside films `M` counts as at least that of a fold of [`FOLD_CUT`]; at borders directions in
//! which it is below [`RANK_CUT`] of the square of the area are dropped.

use glam::{DMat3, DVec3};

use crate::layout::{Layout, Panel};
use crate::symmetric::{RangeInverse, outer};

/// Part of the largest eigenvalue below which one counts as zero.
pub const RANK_CUT: f64 = 1e-3;

/// Part of its area, an area vector's length over that of its faces, below which a film counts as folded over itself: to within twelve degrees.
pub const FOLD_CUT: f64 = 0.2;

/// Shape of the films.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    /// Per panel, area along the normal, m^2.
    pub area_vectors: Vec<DVec3>,
    /// Per panel, centroid, metres.
    pub centres: Vec<DVec3>,
    /// Per side, volume gradient `N`, m^2.
    pub gradients: Vec<DVec3>,
    /// Per vertex, a third of the films around it, m^2.
    pub areas: Vec<f64>,
    /// Per vertex, area-weighted mean of the centroids of its films, metres.
    pub middles: Vec<DVec3>,
    /// Per vertex, the inverse of `M` on its range, 1/m^4, and the projector onto that.
    pub ranges: Vec<RangeInverse>,
}

impl Geometry {
    /// Measures films with vertices at `positions` (metres).
    pub fn measure(&mut self, layout: &Layout, positions: &[DVec3]) {
        self.clear(layout);
        for panel in layout.panels() {
            let [a, b, c] = corners(panel, positions);
            let (area, centre) = (0.5 * (b - a).cross(c - a), (a + b + c) / 3.0);
            self.area_vectors.push(area);
            self.centres.push(centre);
            let (third, weight) = (area / 3.0, area.length() / 3.0);
            for k in 0..3 {
                self.gradients[panel.back[k] as usize] += third;
                self.gradients[panel.front[k] as usize] -= third;
                let v = panel.corners[k] as usize;
                self.areas[v] += weight;
                self.middles[v] += centre * weight;
            }
        }
        for (v, middle) in self.middles.iter_mut().enumerate() {
            *middle = if self.areas[v] > 0.0 { *middle / self.areas[v] } else { positions[v] };
            self.ranges.push(range_of(&self.gradients[layout.sides_of(v)], self.areas[v]));
        }
    }

    fn clear(&mut self, layout: &Layout) {
        self.area_vectors.clear();
        self.centres.clear();
        self.ranges.clear();
        self.gradients.clear();
        self.gradients.resize(layout.side_count(), DVec3::ZERO);
        self.areas.clear();
        self.areas.resize(layout.vertex_rows(), 0.0);
        self.middles.clear();
        self.middles.resize(layout.vertex_rows(), DVec3::ZERO);
    }
}

fn range_of(gradients: &[DVec3], area: f64) -> RangeInverse {
    match gradients {
        [] => RangeInverse::default(),
        // Films between two regions: the gradients are opposite.
        [n, _] => RangeInverse::of_film(*n, FOLD_CUT * area),
        several => {
            let matrix = several.iter().fold(DMat3::ZERO, |m, n| m + outer(*n, *n));
            RangeInverse::of(matrix, RANK_CUT, RANK_CUT * area * area)
        }
    }
}

/// Corners of a panel in its winding.
#[must_use]
#[inline]
pub fn corners(panel: &Panel, positions: &[DVec3]) -> [DVec3; 3] {
    panel.corners.map(|v| positions[v as usize])
}

/// Edges opposite to the corners, counter-clockwise: `e_k` leads from corner `k + 1` to corner `k + 2`.
#[must_use]
#[inline]
pub fn edges([a, b, c]: [DVec3; 3]) -> [DVec3; 3] {
    [c - b, a - c, b - a]
}

/// Rate of the area vector of a triangle with corners at `x` (metres) that move with `w` (m/s), m^2/s.
#[must_use]
#[inline]
pub fn turning(x: [DVec3; 3], w: [DVec3; 3]) -> DVec3 {
    0.5 * ((w[1] - w[0]).cross(x[2] - x[0]) + (x[1] - x[0]).cross(w[2] - w[0]))
}

/// Circulations `Gamma_k = phi_front - phi_back` at the corners of a panel, m^2/s.
#[must_use]
#[inline]
pub fn circulations(panel: &Panel, potentials: &[f64]) -> [f64; 3] {
    std::array::from_fn(|k| potentials[panel.front[k] as usize] - potentials[panel.back[k] as usize])
}

#[cfg(test)]
mod tests {
    use froth_surface::Surface;
    use froth_surface::shapes::icosphere;

    use super::*;

    #[test]
    fn a_film_that_is_folded_over_itself_is_not_moved_by_noise() {
        let surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.3));
        let layout = Layout::new(&surface);
        let mut geometry = Geometry::default();
        // Pressed flat: at the rim area vectors of both sides cancel but for the thickness.
        for thickness in [1.0, 1e-1, 1e-3, 1e-9, 0.0] {
            let flat: Vec<DVec3> = surface.positions.iter().map(|x| DVec3::new(x.x, x.y, thickness * x.z)).collect();
            geometry.measure(&layout, &flat);
            let shapes = geometry.ranges.iter().zip(&geometry.areas);
            let widest = shapes.map(|(range, area)| (range.inverse * DVec3::ONE).length() * area * area);
            let widest = widest.fold(0.0, f64::max);
            assert!(widest < 3f64.sqrt() * 0.5 / FOLD_CUT.powi(2) * (1.0 + 1e-12), "{thickness}: {widest:e}");
        }
    }
}
