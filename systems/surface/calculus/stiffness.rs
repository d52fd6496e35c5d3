//! The cotangent stiffness matrix of the films, weighted by tension: symmetric, positive semidefinite.
//!
//! # Equation
//! `K_vw = -Σ_f T_f cot θ_f / 2` over the films on edge `vw`, `θ_f` the angle opposite of it; rows add up to zero.
//! `K x` is the gradient of the energy `Σ T_f A_f`. Every face adds the Dirichlet energy of linear functions, which is
//! never negative: `K` is semidefinite whatever the angles; only its off-diagonal signs depend on them.
//!
//! # Limits
//! A face without area is left out.

use glam::DVec3;

use super::area::{corners_of, double_area_normal};
use super::incidence::Incidence;
use super::weights::Weights;

/// Half cotangents of the angles at the corners of a face, dimensionless; zeros without area.
#[must_use]
pub fn half_cotangents([a, b, c]: [DVec3; 3]) -> [f64; 3] {
    let double = double_area_normal([a, b, c]).length();
    if !(double > 0.0) {
        return [0.0; 3];
    }
    let half = 0.5 / double;
    [(b - a).dot(c - a) * half, (c - b).dot(a - b) * half, (a - c).dot(b - c) * half]
}

/// The matrix in rows: values of vertex `v` and its neighbours.
#[derive(Clone, Debug, Default)]
pub struct Stiffness {
    diagonal: Vec<f64>,
    offsets: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<f64>,
    /// Per film and corner: where the two entries of the opposite edge are.
    slots: Vec<[[u32; 2]; 3]>,
}

impl Stiffness {
    /// Lays out rows for a mesh; values come with [`Self::fill`].
    pub fn lay_out(&mut self, incidence: &Incidence) {
        let rows = incidence.vertex_rows();
        let (starts, listed) = neighbours_with_repeats(incidence);
        self.columns.clear();
        self.offsets.clear();
        self.offsets.push(0);
        for v in 0..rows {
            let (from, own) = (self.columns.len(), starts[v] as usize..starts[v + 1] as usize);
            for w in &listed[own] {
                if !self.columns[from..].contains(w) {
                    self.columns.push(*w);
                }
            }
            self.columns[from..].sort_unstable();
            self.offsets.push(self.columns.len() as u32);
        }
        let edges = incidence.films().iter().map(|film| opposite_edges(film.corners));
        let slots = edges.map(|edges| edges.map(|[v, w]| [self.place(v, w), self.place(w, v)])).collect();
        self.slots = slots;
        self.diagonal.resize(rows, 0.0);
        self.values.resize(self.columns.len(), 0.0);
    }

    /// Where column `w` of row `v` is.
    fn place(&self, v: u32, w: u32) -> u32 {
        let (from, to) = (self.offsets[v as usize], self.offsets[v as usize + 1]);
        let place = self.columns[from as usize..to as usize].iter().position(|column| *column == w);
        from + place.expect("invariant: edges of films are listed") as u32
    }

    /// Sets the values at these positions, for these tensions (N/m).
    pub fn fill(&mut self, incidence: &Incidence, positions: &[DVec3], tension: Weights<'_>) {
        self.diagonal.fill(0.0);
        self.values.fill(0.0);
        for (film, slots) in incidence.films().iter().zip(&self.slots) {
            let halves = half_cotangents(corners_of(film.corners, positions));
            let weight = tension.of(film.row);
            for ((edge, pair), half) in opposite_edges(film.corners).iter().zip(slots).zip(halves) {
                pair.iter().for_each(|slot| self.values[*slot as usize] -= weight * half);
                edge.iter().for_each(|v| self.diagonal[*v as usize] += weight * half);
            }
        }
    }

    /// Diagonal, per vertex, N/m.
    #[must_use]
    pub fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// Row `v` of `K x`.
    #[must_use]
    #[inline]
    pub fn row_times(&self, v: usize, x: &[DVec3]) -> DVec3 {
        let row = self.offsets[v] as usize..self.offsets[v + 1] as usize;
        let others = self.columns[row.clone()].iter().zip(&self.values[row]);
        others.fold(x[v] * self.diagonal[v], |sum, (w, value)| sum + x[*w as usize] * *value)
    }
}

/// The other corners of the films of each vertex, those of vertex `v` from `starts[v]` to `starts[v + 1]`: a counting sort.
fn neighbours_with_repeats(incidence: &Incidence) -> (Vec<u32>, Vec<u32>) {
    let rows = incidence.vertex_rows();
    let mut starts = vec![0u32; rows + 1];
    let corners = incidence.films().iter().flat_map(|film| film.corners);
    corners.for_each(|v| starts[v as usize + 1] += 2);
    for v in 0..rows {
        starts[v + 1] += starts[v];
    }
    let mut next = starts.clone();
    let mut listed = vec![0; starts[rows] as usize];
    for [a, b, c] in incidence.films().iter().map(|film| film.corners) {
        for (v, others) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
            let place = next[v as usize] as usize;
            listed[place..place + 2].copy_from_slice(&others);
            next[v as usize] += 2;
        }
    }
    (starts, listed)
}

/// Edges opposite of the corners.
fn opposite_edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[b, c], [c, a], [a, b]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calculus::area::area_gradient;
    use crate::calculus::test_shapes::{double_bubble, flat_disc, shaken};

    fn filled(surface: &crate::Surface, tension: Weights<'_>) -> (Incidence, Stiffness) {
        let incidence = Incidence::new(surface);
        let mut stiffness = Stiffness::default();
        stiffness.lay_out(&incidence);
        stiffness.fill(&incidence, &surface.positions, tension);
        (incidence, stiffness)
    }

    #[test]
    fn stiffness_times_positions_is_the_gradient_of_area() {
        let surface = shaken(&double_bubble(1.0, 0.7, 4), 0.1);
        let tension: Vec<f64> = (0..surface.mesh.face_rows()).map(|f| 1.0 + 0.3 * (f as f64).sin()).collect();
        let (incidence, stiffness) = filled(&surface, Weights::PerFace(&tension));
        let mut gradient = vec![DVec3::ZERO; surface.positions.len()];
        area_gradient(&incidence, &surface.positions, Weights::PerFace(&tension), &mut gradient);
        for (v, expected) in gradient.iter().enumerate() {
            assert!(stiffness.row_times(v, &surface.positions).distance(*expected) < 1e-12);
        }
    }

    #[test]
    fn linear_fields_on_a_plane_have_no_laplacian_inside() {
        let surface = flat_disc(1.0, 5);
        let (_, stiffness) = filled(&surface, Weights::Uniform(1.0));
        let field: Vec<DVec3> =
            surface.positions.iter().map(|x| DVec3::new(x.x + 2.0 * x.y + 1.0, x.y, -x.x)).collect();
        for v in surface.mesh.vertices().filter(|v| !surface.pinned[*v]) {
            assert!(stiffness.row_times(v.index(), &field).length() < 1e-13);
        }
    }

    #[test]
    fn energies_of_random_fields_are_never_negative_even_on_slivers() {
        let surface = shaken(&double_bubble(1.0, 0.7, 3), 0.6);
        let (_, stiffness) = filled(&surface, Weights::Uniform(1.0));
        for seed in 0..50 {
            let field: Vec<DVec3> = (0..surface.positions.len())
                .map(|v| DVec3::splat((f64::from(seed) * 7.3 + v as f64 * 1.7).sin()))
                .collect();
            let energy: f64 = (0..field.len()).map(|v| field[v].dot(stiffness.row_times(v, &field))).sum();
            assert!(energy > -1e-10);
        }
    }
}
