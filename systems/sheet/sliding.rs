//! How the mesh moves along the films, which keeps triangles even while the films move by their normal velocity alone.
//!
//! # Equation
//! `tau_v = (c / t) (I - P_v)(m_v - x_v)`, with `m_v` the area-weighted mean of the centroids around the vertex: part `c` of the way to
//! the middle in a time `t` of about a step, within the film, or along the border. The convection term carries the potentials with it exactly.
//!
//! # Discretisation
//! Sliding damps waves as short as the mesh, so it acts where triangles need it: fully where the smallest angle around a
//! vertex is below [`Sliding::full_below`], not at all above [`Sliding::none_above`], linearly in between.

use glam::DVec3;

use crate::geometry::{Geometry, corners, edges};
use crate::layout::Layout;

/// Tangential motion of the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sliding {
    /// Part `c` of the way to the middle per step, dimensionless; 0 is none.
    pub strength: f64,
    /// Smallest angle around a vertex below which it slides with full strength, radians.
    pub full_below: f64,
    /// Smallest angle around a vertex above which it does not slide, radians.
    pub none_above: f64,
}

impl Default for Sliding {
    fn default() -> Self {
        Self { strength: 0.1, full_below: 25f64.to_radians(), none_above: 40f64.to_radians() }
    }
}

impl Sliding {
    /// None: vertices move with the films' normal velocity.
    pub const NONE: Self = Self { strength: 0.0, full_below: 0.0, none_above: 0.0 };

    /// Full strength everywhere, as the prototype of the scheme had it.
    #[must_use]
    pub fn everywhere(strength: f64) -> Self {
        Self { strength, full_below: std::f64::consts::PI, none_above: std::f64::consts::PI }
    }

    /// Adds the sliding of one part of the way in `interval` seconds to velocities per vertex (m/s); held vertices do not slide.
    pub fn add(
        &self,
        layout: &Layout,
        geometry: &Geometry,
        positions: &[DVec3],
        held: &[bool],
        interval: f64,
        velocities: &mut [DVec3],
    ) {
        if !(self.strength > 0.0) {
            return;
        }
        let cosines = largest_cosines(layout, positions);
        for (v, velocity) in velocities.iter_mut().enumerate().filter(|(v, _)| !held[*v] && !layout.is_rim(*v)) {
            let need = self.need(cosines[v]);
            let way = geometry.middles[v] - positions[v];
            *velocity += (way - geometry.ranges[v].projector * way) * (need * self.strength / interval);
        }
    }

    /// How much a vertex with this cosine of its smallest angle needs to slide, 0 to 1.
    fn need(&self, cosine: f64) -> f64 {
        let angle = cosine.clamp(-1.0, 1.0).acos();
        if angle <= self.full_below {
            1.0
        } else if angle >= self.none_above {
            0.0
        } else {
            (self.none_above - angle) / (self.none_above - self.full_below)
        }
    }
}

/// Cosine of the smallest angle of all films around each vertex.
fn largest_cosines(layout: &Layout, positions: &[DVec3]) -> Vec<f64> {
    let mut largest = vec![-1.0f64; layout.vertex_rows()];
    for panel in layout.panels() {
        let e = edges(corners(panel, positions)).map(DVec3::normalize_or_zero);
        let cosine = (0..3).map(|k| -e[(k + 1) % 3].dot(e[(k + 2) % 3])).fold(-1.0, f64::max);
        for v in panel.corners {
            largest[v as usize] = largest[v as usize].max(cosine);
        }
    }
    largest
}
