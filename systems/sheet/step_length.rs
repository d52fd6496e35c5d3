//! How long a step may be: the shortest capillary wave that moves freely must be resolved in time.
//!
//! Equation: `dt < C sqrt(rho h^3 / sigma)` with `h` the shortest edge; symplectic Euler is stable up to `C` of about 1 on irregular meshes.
//! A smoothed kernel slows waves shorter than its length `alpha`: the frequency `omega^2 = T k^3 / (2 rho) s(k alpha)` with the symbol
//! `s(x) = exp(-x) (1 + x + x^2 / 2)` is largest at `k alpha` of about 5, whatever the mesh. Edges shorter than [`SLOWED`] of `alpha` need no
//! shorter steps.

use glam::DVec3;

use crate::geometry::{corners, edges};
use crate::layout::Layout;

/// `sqrt(rho h^3 / sigma)` of an edge of `edge` metres, s; `density` in kg/m^3, `surface_tension` in N/m.
#[must_use]
pub fn capillary_time(edge: f64, density: f64, surface_tension: f64) -> f64 {
    (density * edge.powi(3) / surface_tension).sqrt()
}

/// The shortest edge of all films, metres; infinite without films.
#[must_use]
pub fn shortest_edge(layout: &Layout, positions: &[DVec3]) -> f64 {
    let lengths = layout.panels().iter().flat_map(|panel| edges(corners(panel, positions)));
    lengths.map(DVec3::length_squared).fold(f64::INFINITY, f64::min).sqrt()
}

/// The largest rate at which films change their shape, 1/s, from the corners of their faces (metres) and the velocities there (m/s): differences of
/// velocity along edges, over their lengths, or over `least` metres where they are shorter. Films that move as a whole have none.
#[must_use]
pub fn straining(faces: impl Iterator<Item = ([DVec3; 3], [DVec3; 3])>, least: f64) -> f64 {
    let rates = faces.flat_map(|(x, w)| {
        let (e, changes) = (edges(x), edges(w));
        [0, 1, 2].map(|k| changes[k].length_squared() / e[k].length_squared().max(least * least))
    });
    rates.fold(0.0, f64::max).sqrt()
}

/// Part of the smoothing length below which edges do not shorten steps: half an edge at the usual `alpha` of 0.75 edges.
pub const SLOWED: f64 = 2.0 / 3.0;

/// The edge that limits steps, metres: the shortest, unless the kernel's smoothing length slows what moves there.
#[must_use]
pub fn limiting_edge(shortest: f64, smoothing_length: f64) -> f64 {
    shortest.max(SLOWED * smoothing_length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn films_are_strained_by_what_they_do_to_their_edges_and_not_by_going_along() {
        let x = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let drift = DVec3::new(5.0, -3.0, 2.0);
        assert_eq!(straining(std::iter::once((x, [drift; 3])), 0.1), 0.0);
        let stretched = x.map(|x| drift + x * 2.0);
        assert!((straining(std::iter::once((x, stretched)), 0.1) - 2.0).abs() < 1e-14);
        let short = x.map(|x| x * 0.01);
        assert!(
            (straining(std::iter::once((short, short.map(|x| x * 2.0))), 0.1) - 2.0 * 0.01 * 2f64.sqrt() / 0.1).abs()
                < 1e-14
        );
    }
}
