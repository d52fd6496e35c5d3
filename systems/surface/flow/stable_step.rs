//! How long an explicit step may be.
//!
//! # Equation
//! Linearised, tension is the stiffness `K` ([`stiffness`](crate::calculus::stiffness)). By Gershgorin the largest
//! eigenvalue of `M⁻¹K` is at most the largest `Σ_w |K_vw| / m_v`. Symplectic Euler is stable for `Δt < 2 / sqrt(λ)`,
//! forward Euler (with area over mobility for mass) for `Δt < 2 / λ`.
//!
//! # Limits
//! Entries are summed face by face, so obtuse angles make the bound a little too careful. For equilateral faces of side
//! `h` it is `8 β / h²`, where the true value is `6 β / h²`.

use glam::DVec3;

use super::settings::Motion;
use crate::calculus::area::corners_of;
use crate::calculus::stiffness::half_cotangents;
use crate::calculus::{Incidence, Weights};

/// Largest `Σ_w |K_vw| / m_v` over the vertices with `inverse_mass = 1/m_v` above zero; `rows` is scratch.
///
/// 1/s^2 for masses in kg; 1/s with area over mobility in their place.
#[must_use]
pub fn gershgorin_bound(
    incidence: &Incidence,
    positions: &[DVec3],
    tension: Weights<'_>,
    inverse_mass: &[f64],
    rows: &mut [f64],
) -> f64 {
    rows.fill(0.0);
    for film in incidence.films() {
        let [a, b, c] = half_cotangents(corners_of(film.corners, positions));
        let weight = tension.of(film.row);
        let sums = [(b + c, b.abs() + c.abs()), (c + a, c.abs() + a.abs()), (a + b, a.abs() + b.abs())];
        for (v, (diagonal, others)) in film.corners.iter().zip(sums) {
            rows[*v as usize] += weight * (diagonal + others);
        }
    }
    rows.iter().zip(inverse_mass).map(|(row, inverse)| row * inverse).fold(0.0, f64::max)
}

/// Longest stable explicit step, s, for a bound from [`gershgorin_bound`]; infinite without stiffness.
#[must_use]
pub fn stable_step(bound: f64, motion: Motion) -> f64 {
    match motion {
        Motion::Inertial => 2.0 / bound.sqrt(),
        Motion::Overdamped { .. } => 2.0 / bound,
    }
}
