//! How tension and other forces on the films change the potentials.
//!
//! # Equation
//! Virtual work: `d phi_iv/dt = -p_iv / rho` with `p_iv = N_iv . M+ (dE/dx_v - f_v)`, the pressures that hold the film against
//! its tension and the forces on it. On a film this is `dGamma/dt = 2 sigma H / rho` (Da 2015, eq. 9, with the sign that a
//! squashed bubble needs to become round). At rest `p_iv` is the pressure of region `i`, the same at all its vertices.
//!
//! # Limits
//! The inertia of the liquid is neglected against that of the air: a fraction `rho_liquid eta / (rho_air R)`, below a
//! hundredth for films of 400 nm on bubbles of 5 cm. Its weight is not.

use glam::DVec3;

use crate::geometry::Geometry;
use crate::layout::Layout;

/// Pressures per side, Pa; `loads` is the energy gradient less external forces per vertex, N.
pub fn pressures(layout: &Layout, geometry: &Geometry, loads: &[DVec3], pressures: &mut Vec<f64>) {
    pressures.clear();
    for (v, load) in loads.iter().enumerate() {
        let along = geometry.ranges[v].inverse * *load;
        pressures.extend(layout.sides_of(v).map(|side| geometry.gradients[side].dot(along)));
    }
}
