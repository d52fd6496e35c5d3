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

/// Part of the smoothing length below which edges do not shorten steps: half an edge at the usual `alpha` of 0.75 edges.
pub const SLOWED: f64 = 2.0 / 3.0;

/// The edge that limits steps, metres: the shortest, unless the kernel's smoothing length slows what moves there.
#[must_use]
pub fn limiting_edge(shortest: f64, smoothing_length: f64) -> f64 {
    shortest.max(SLOWED * smoothing_length)
}
