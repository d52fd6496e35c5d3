//! Tension as curvature at the vertices: the bend of each region's own surface over an area.
//!
//! # Equation
//! `H_i = 1/(2 A_v) sum_e |e| theta_i(e)` over the edges at vertex `v`, a sum of principal curvatures (sphere: `2/R`); the pressure
//! that holds the film is `p_i = sigma H_i`, and `dGamma(i, j)/dt = (p_i - p_j)/rho`.
//!
//! # Discretisation
//! Dihedral angles by atan2 from outward normals; areas by mixed Voronoi cells (Meyer et al. 2003). Curvature of single vertices does not
//! converge on irregular meshes, with these areas less wrong (6 % scatter in the mode l = 2) than with thirds of triangles (12 %).
//! Where two films of different tension meet along an edge, their mean acts.
//!
//! # Source
//! Da 2015, eqs 10 and 11, after Cohen-Steiner and Morvan 2003.

use froth_surface::calculus::Weights;
use froth_surface::calculus::stiffness::half_cotangents;
use glam::DVec3;

use crate::geometry::{Geometry, corners, edges};
use crate::layout::Layout;
use crate::pointwise::hinges::Hinges;

/// The area that curvatures of a vertex's regions refer to. All are the same inside a film; at a Plateau border they differ.
///
/// Let three films with sums of principal curvatures `k_a`, `k_b`, `k_c` meet at rest, each with a strip of area `s` at the vertex.
/// The bends of the regions, less what the border gives to all of them, are `-(k_a + k_b) s`, `(k_a - k_c) s` and `(k_b + k_c) s`;
/// with `k_b - k_a = k_c` they differ by `3 k s` where the pressures differ by `2 k`. So the area that leaves films at rest
/// at 120 degrees is `3 s / 2`: that of the films by the number of unknowns of the vertex, 1 on a film, 2 on a border.
///
/// How far an exact double bubble (radii 1 and 0.56, edges of 0.17 and 0.12) is from balance at its border, over the pressure of the
/// smaller bubble; and how far from 120 degrees equal bubbles of 201, 412 and 824 vertices come to rest with each in its turn:
///
/// | | off balance | degrees off |
/// |---|---|---|
/// | per region | .14 .12 | 6.9 7.0 4.6 |
/// | shared | .23 .24 | 7.3 5.9 4.2 |
/// | per unknown | .045 .038 | 1.6 .3 .1 |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AreaShare {
    /// That of the region's own surface (the paper's words): unequal areas pull a border to where it should not be.
    PerRegion,
    /// The mean over the regions at the vertex (the authors' program): `2 s` at a border, by a third too much.
    Shared,
    /// The films' area over one less than the number of regions.
    // DEVIATION: Da 2015 divides by "the Voronoi area of the vertex" without saying which where three films meet; the other two
    // are what that has been read as. Test: the_area_per_unknown_leaves_an_exact_double_bubble_nearest_to_rest.
    #[default]
    PerUnknown,
}

/// Bends `sum_e sigma |e| theta_i(e) / 2` per side, N; `tension` is that of films, `2 sigma`, N/m.
pub(super) fn bending(
    hinges: &Hinges,
    layout: &Layout,
    geometry: &Geometry,
    positions: &[DVec3],
    tension: Weights<'_>,
    bending: &mut Vec<f64>,
) {
    bending.clear();
    bending.resize(layout.side_count(), 0.0);
    hinges.for_each_sector(layout, geometry, positions, tension, |sector| {
        let bend = 0.25 * sector.tension * sector.length * sector.angle;
        sector.sides.iter().for_each(|side| bending[*side as usize] += bend);
    });
}

/// Areas that curvatures refer to, m^2 per side.
pub fn areas(layout: &Layout, positions: &[DVec3], share: AreaShare, areas: &mut Vec<f64>) {
    areas.clear();
    areas.resize(layout.side_count(), 0.0);
    for panel in layout.panels() {
        let cells = mixed_cells(corners(panel, positions));
        for k in 0..3 {
            areas[panel.back[k] as usize] += cells[k];
            areas[panel.front[k] as usize] += cells[k];
        }
    }
    for v in 0..layout.vertex_rows() {
        let own = &mut areas[layout.sides_of(v)];
        // Every film counts on its two sides.
        let (films, count) = (0.5 * own.iter().sum::<f64>(), own.len() as f64);
        match share {
            AreaShare::PerRegion => {}
            AreaShare::Shared => own.fill(2.0 * films / count),
            AreaShare::PerUnknown => own.fill(films / (count - 1.0)),
        }
    }
}

/// Curvatures `H_i` per side, 1/m.
#[must_use]
pub fn curvatures(layout: &Layout, geometry: &Geometry, positions: &[DVec3], share: AreaShare) -> Vec<f64> {
    let (mut bends, mut over) = (Vec::new(), Vec::new());
    // Film tension 2: sigma is 1.
    bending(&Hinges::new(layout), layout, geometry, positions, Weights::Uniform(2.0), &mut bends);
    areas(layout, positions, share, &mut over);
    bends.iter().zip(&over).map(|(bend, area)| if *area > 0.0 { bend / area } else { 0.0 }).collect()
}

/// Parts of a triangle that are nearest to its corners, m^2; where one corner is obtuse it gets half and the others a quarter.
fn mixed_cells(x: [DVec3; 3]) -> [f64; 3] {
    let half = half_cotangents(x);
    let area = 0.5 * (x[1] - x[0]).cross(x[2] - x[0]).length();
    if let Some(obtuse) = half.iter().position(|cotangent| *cotangent < 0.0) {
        return std::array::from_fn(|k| area * if k == obtuse { 0.5 } else { 0.25 });
    }
    let squares = edges(x).map(DVec3::length_squared);
    let part = |k: usize| 0.25 * half[k] * squares[k];
    std::array::from_fn(|k| part((k + 1) % 3) + part((k + 2) % 3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_add_up_to_the_triangle() {
        for c in [DVec3::new(0.4, 0.9, 0.1), DVec3::new(-0.8, 0.3, 0.0), DVec3::new(0.0, 1.0, 0.0)] {
            let x = [DVec3::ZERO, DVec3::X, c];
            let area = 0.5 * c.cross(DVec3::X).length();
            assert!((mixed_cells(x).iter().sum::<f64>() - area).abs() < 1e-15);
        }
    }
}
