//! The air around: a wind that is the same everywhere, and gas that comes into bubbles, which pushes everything else away.
//!
//! # Equation
//! While gas comes into regions `r` of volume `V_r` at rates `Q_r`, `div u = Q_r/V_r` there and nothing elsewhere. The flow with these
//! sources and no circulation is the gravity of evenly heavy bodies of the other sign,
//! `u_s(x) = sum_r Q_r/V_r int_r (x - y)/(4 pi |x - y|^3) dy = 1/(4 pi) oint [Q/V] (x - y) dOmega`, by Gauss an integral over films: `dOmega` is the
//! solid angle under which `x` sees a film from behind, `[Q/V]` what there is more in the back of the film. Sources add up. From afar each is
//! one at its bubble's middle, that of a sphere from its film outwards.
//!
//! `u_s` and its potential `Phi` are continuous across films, and so is `d Phi/dt + u_s^2/2`: the sources press on both sides of a film alike.
//! With total potentials `phi_i + Phi`, Bernoulli at a vertex that moves with `w` leaves
//! `d phi_i/dt = (w - u_s).grad phi_i - 1/2 |grad phi_i|^2 - p_i/rho`, but for what all regions have in common: the equation in still air, seen
//! from a frame that goes, and is strained, with `u_s`. Circulation is carried by the whole flow.
//! Kinetic energies of both flows add up, since `int u_s.grad phi = 0`; the impulse `rho sum_iv phi_iv N_iv` changes as `N` does under the
//! strain of `u_s`.
//!
//! # Discretisation
//! One term per vertex and panel, with the panel's centroid and its solid angle: exact near the vertex, from afar that of its centroid. Films
//! that end at the vertex are seen edge-on and have none, so that nothing is singular, and nothing smoothed. The flux out of a region is
//! `Q_r` to second order in the edge length; the [projection of volumes](crate::Sheet::meet_volumes) moves films by the rest.
//! Vertices of films that nothing holds go with `u_s` along the films too, which keeps triangles in shape. On films
//! that hang on wires they go across alone: the film stays with its wire, and the air flows along it.
//!
//! # Limits
//! How gas is let in is not told: here evenly, all over the bubble, with the velocity that the air has there. A jet from a straw is none of
//! this. The kinetic energy of `u_s` itself, which has no inertia of its own, is not counted. All pairs of vertices and panels around bubbles that
//! change are summed directly.
//!
//! # Source
//! Batchelor 1967, §2.4, for flows of given sources. Da 2015 has none.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use froth_surface::Region;
use froth_surface::calculus::solid_angle::solid_angle;
use glam::DVec3;
use rayon::prelude::*;

use crate::geometry::{Geometry, circulations, corners, turning};
use crate::layout::Layout;

/// Velocities of the air around, without the films' own.
#[derive(Clone, Debug, Default)]
pub struct Ambient {
    /// The same everywhere, m/s.
    pub wind: DVec3,
    /// By gas that comes into bubbles, per vertex, m/s; empty where none does.
    pub by_sources: Vec<DVec3>,
}

impl Ambient {
    /// Velocity at a vertex, m/s.
    #[must_use]
    #[inline]
    pub fn at(&self, vertex: usize) -> DVec3 {
        self.wind + self.by_sources.get(vertex).copied().unwrap_or(DVec3::ZERO)
    }

    /// Velocities per vertex (m/s) as they are seen from the air around; those that are missing are 0.
    #[must_use]
    pub fn seen(&self, velocities: &[DVec3], vertices: usize) -> Vec<DVec3> {
        let velocity = |v: usize| velocities.get(v).copied().unwrap_or(DVec3::ZERO);
        (0..vertices).map(|v| velocity(v) - self.at(v)).collect()
    }
}

/// A panel between regions of which gas comes into one.
struct Source {
    corners: [DVec3; 3],
    centre: DVec3,
    /// Its area along the normal, m^2.
    area: DVec3,
    /// Square of the distance within which its solid angle is worked out exactly, m^2.
    near: f64,
    /// `[Q/V] / 4 pi`, 1/s.
    strength: f64,
}

impl Source {
    /// Velocity at `x`, m/s.
    #[inline]
    fn velocity(&self, x: DVec3) -> DVec3 {
        let way = self.centre - x;
        let square = way.length_squared();
        let angle = if square < self.near {
            solid_angle(self.corners.map(|corner| corner - x))
        } else {
            way.dot(self.area) / (square * square.sqrt())
        };
        way * (-self.strength * angle)
    }
}

/// Velocities of the air by gas that comes in, m/s per vertex with films; `dilatations` are the rates `Q/V` of the regions that have any, 1/s.
pub fn velocities_by_sources(
    layout: &Layout,
    geometry: &Geometry,
    positions: &[DVec3],
    dilatations: &BTreeMap<Region, f64>,
    velocities: &mut Vec<DVec3>,
) {
    let rate = |side: u32| dilatations.get(&layout.regions()[side as usize]).copied().unwrap_or(0.0);
    let panels = layout.panels().iter().zip(geometry.area_vectors.iter().zip(&geometry.centres));
    let sources: Vec<Source> = panels
        .map(|(panel, (area, centre))| Source {
            corners: corners(panel, positions),
            centre: *centre,
            area: *area,
            near: area.length(),
            strength: (rate(panel.back[0]) - rate(panel.front[0])) / (4.0 * PI),
        })
        .filter(|source| source.strength != 0.0)
        .collect();
    let at = |v: usize| match layout.sides_of(v).is_empty() {
        true => DVec3::ZERO,
        false => sources.iter().map(|source| source.velocity(positions[v])).sum(),
    };
    (0..layout.vertex_rows()).into_par_iter().map(at).collect_into_vec(velocities);
}

/// Rate at which the impulse per density changes under the strain of `velocities` (m/s per vertex), m^4/s^2 per vertex: `sum_i phi_i N'_i`.
#[must_use]
pub fn strained_impulses(layout: &Layout, positions: &[DVec3], potentials: &[f64], velocities: &[DVec3]) -> Vec<DVec3> {
    let mut rates = vec![DVec3::ZERO; layout.vertex_rows()];
    for panel in layout.panels() {
        let turning = turning(corners(panel, positions), corners(panel, velocities));
        let gamma = circulations(panel, potentials);
        for k in 0..3 {
            rates[panel.corners[k] as usize] -= turning * (gamma[k] / 3.0);
        }
    }
    rates
}

#[cfg(test)]
mod tests {
    use froth_surface::Surface;
    use froth_surface::shapes::icosphere;

    use super::*;

    #[test]
    fn a_closed_film_is_seen_under_the_whole_sphere_from_within_and_not_at_all_from_outside() {
        let surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.4));
        let layout = Layout::new(&surface);
        for (x, whole) in [(DVec3::new(0.3, -0.2, 0.8), 4.0 * PI), (DVec3::new(0.9, 0.9, 0.1), 0.0)] {
            let angle = |panel: &crate::layout::Panel| {
                let sign = if layout.regions()[panel.back[0] as usize] == Region(1) { 1.0 } else { -1.0 };
                sign * solid_angle(corners(panel, &surface.positions).map(|corner| corner - x))
            };
            let sum: f64 = layout.panels().iter().map(angle).sum();
            assert!((sum - whole).abs() < 1e-12, "{sum}");
        }
    }

    #[test]
    fn a_film_is_no_more_than_a_film_however_near_it_is_seen() {
        let corners = [DVec3::X, DVec3::new(-0.5, 0.8, 0.0), DVec3::new(-0.5, -0.8, 0.0)];
        let area = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let source = Source { corners, centre: DVec3::ZERO, area, near: area.length(), strength: 1.0 };
        for height in [0.5, 1e-3, 1e-12, 0.0] {
            assert!(source.velocity(DVec3::Z * height).length() <= 2.0 * PI * height, "{height}");
        }
    }
}
