//! Films that hang between wires of their own: pinned rims without a [`Wire`](crate::authored::wire::Wire) entity.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use bevy_ecs::component::Component;
use glam::{DQuat, DVec3};
use serde::Deserialize;

use super::{Measured, corners};
use crate::authored::shape::{Place, parallel};
use crate::quantity::{Direction, Length, range};

/// A film between two equal rings, its two rims pinned. The air within is region 1.
///
/// It starts as the catenoid, or, where the rings are farther apart than 1.3255 radii and no catenoid exists, as the
/// cylinder, which necks and pinches off.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Catenoid {
    /// Centre between the rings, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// From one ring to the other. Default: y.
    #[serde(default = "along_y")]
    pub axis: Direction,
    /// Radius of the rings, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub radius: Length,
    /// Distance between the rings, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub gap: Length,
}

impl Catenoid {
    /// Widest gap that a catenoid spans, in radii.
    pub const WIDEST_GAP: f64 = 1.325_486_838_4;
}

impl Measured for Catenoid {
    fn centre(&self) -> DVec3 {
        self.centre.si()
    }

    fn size(&self) -> f64 {
        self.radius.si()
    }

    /// That of the cylinder, which is up to 10 % more than a catenoid.
    fn area(&self) -> f64 {
        TAU * self.radius.si() * self.gap.si()
    }

    fn rim(&self) -> f64 {
        2.0 * TAU * self.radius.si()
    }

    fn outline(&self) -> Vec<DVec3> {
        let turn = DQuat::from_rotation_arc(DVec3::Z, self.axis.unit());
        let ring = |side: f64| {
            let centre = self.centre.si() + side * self.gap.si() * self.axis.unit();
            parallel(0).map(move |point| centre + self.radius.si() * (turn * point))
        };
        ring(-0.5).chain(ring(0.5)).collect()
    }

    fn is_closed(&self) -> bool {
        false
    }
}

/// The films that a regular frame of wire holds when it is drawn from soap water. Its wires are pinned.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WireFrame {
    /// Which frame.
    pub kind: FrameKind,
    /// Centre, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Length of each wire, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub edge: Length,
}

/// A regular frame of wire. Films go from every wire to the centre at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum FrameKind {
    /// Six wires; corners towards (1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1).
    Tetrahedron,
    /// Twelve wires along the axes.
    Cube,
    /// Twelve wires; corners on the axes.
    Octahedron,
}

impl FrameKind {
    /// Corners of a frame with wires of length 1.
    #[must_use]
    pub fn corners(self) -> Vec<DVec3> {
        match self {
            Self::Tetrahedron => {
                let signs = [(1.0, 1.0, 1.0), (1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, 1.0)];
                signs.map(|(x, y, z)| 0.5 * FRAC_1_SQRT_2 * DVec3::new(x, y, z)).to_vec()
            }
            Self::Cube => corners(DVec3::ZERO, DVec3::ONE),
            Self::Octahedron => {
                let axes = [DVec3::X, DVec3::Y, DVec3::Z];
                axes.iter().flat_map(|axis| [-FRAC_1_SQRT_2 * axis, FRAC_1_SQRT_2 * axis]).collect()
            }
        }
    }

    /// Number of wires.
    #[must_use]
    pub fn wires(self) -> usize {
        match self {
            Self::Tetrahedron => 6,
            Self::Cube | Self::Octahedron => 12,
        }
    }
}

impl Measured for WireFrame {
    fn centre(&self) -> DVec3 {
        self.centre.si()
    }

    fn size(&self) -> f64 {
        0.5 * self.edge.si()
    }

    /// Of the triangles from every wire to the centre.
    fn area(&self) -> f64 {
        let edge = self.edge.si();
        let to_wire = match self.kind {
            FrameKind::Tetrahedron => 0.5 * FRAC_1_SQRT_2,
            FrameKind::Cube => FRAC_1_SQRT_2,
            FrameKind::Octahedron => 0.5,
        };
        0.5 * self.kind.wires() as f64 * to_wire * edge * edge
    }

    fn rim(&self) -> f64 {
        self.kind.wires() as f64 * self.edge.si()
    }

    fn outline(&self) -> Vec<DVec3> {
        self.kind.corners().into_iter().map(|corner| self.centre.si() + self.edge.si() * corner).collect()
    }

    fn is_closed(&self) -> bool {
        false
    }
}

fn along_y() -> Direction {
    Direction::Y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_frame_has_as_many_wires_of_length_one_as_it_says_and_their_films_the_stated_area() {
        for kind in [FrameKind::Tetrahedron, FrameKind::Cube, FrameKind::Octahedron] {
            let corners = kind.corners();
            let pairs = corners.iter().enumerate().flat_map(|(i, a)| corners[..i].iter().map(move |b| (*a, *b)));
            let wires: Vec<_> = pairs.filter(|(a, b)| (a.distance(*b) - 1.0).abs() < 1e-12).collect();
            assert_eq!(wires.len(), kind.wires(), "{kind:?}");
            let area: f64 = wires.iter().map(|(a, b)| 0.5 * a.cross(*b).length()).sum();
            let frame = WireFrame { kind, centre: Place::ZERO, edge: Length::from_si(1.0) };
            assert!((frame.area() / area - 1.0).abs() < 1e-12, "{kind:?}");
        }
    }

    #[test]
    fn the_widest_catenoid_touches_the_ring_at_the_known_slope() {
        // Rings of radius 1 at ±h: c cosh(h/c) = 1; the widest gap has (h/c) tanh(h/c) = 1 (Lindelöf).
        let mut ratio = 1.2_f64;
        for _ in 0..50 {
            ratio = 1.0 / ratio.tanh();
        }
        let widest = 2.0 * ratio / ratio.cosh();
        assert!((widest - Catenoid::WIDEST_GAP).abs() < 1e-9, "{widest}");
    }
}
