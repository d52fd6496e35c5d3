//! The films of a run: which rows each occupies, whether it is closed, where its rim is.
//!
//! Made by a method's `discretise` from authored entities and saved in checkpoints; constant over the run.

use crate::identity::RegionId;
use bevy_ecs::resource::Resource;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::ops::Range;

/// All films, in the order of their region numbers, and the spacing they are sampled with.
#[derive(Resource, Clone, Debug, Default, Serialize, Deserialize)]
pub struct Lamellae {
    /// One entry per film.
    pub films: Vec<Lamella>,
    /// Distance between neighbouring carriers, m.
    pub spacing: f64,
}

/// One film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lamella {
    /// Its region: the gas inside a bubble, or the film itself where it is open.
    pub region: RegionId,
    /// Rows of its Eulerian particles.
    pub carriers: Range<usize>,
    /// Rows of its Lagrangian particles.
    pub material: Range<usize>,
    /// Where it ends; `None` for a closed film.
    pub rim: Option<Rim>,
    /// Size that relative lengths refer to, m: the radius of a sphere.
    pub size: f64,
    /// Centre of the shape the film was made as, m.
    pub centre: DVec3,
    /// Mass of air per film area that moves with its normal motion, kg/m^2.
    pub air_mass: f64,
}

/// The frame on which an open film is stretched: liquid may slide along it but not leave.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Rim {
    /// A circle around a flat film.
    Circle {
        /// Centre, m.
        centre: DVec3,
        /// Unit normal of its plane.
        axis: DVec3,
        /// Radius, m.
        radius: f64,
    },
    /// A rectangle around a flat film.
    Rectangle {
        /// Centre, m.
        centre: DVec3,
        /// Unit vectors along width and height.
        sides: [DVec3; 2],
        /// Half the width and half the height, m.
        half: [f64; 2],
    },
    /// A regular hexagon around a flat film.
    Hexagon {
        /// Centre, m.
        centre: DVec3,
        /// Unit vectors in its plane, at right angles; the first points to a corner.
        sides: [DVec3; 2],
        /// Distance from the centre to a corner, m.
        radius: f64,
    },
    /// A plane on which a dome stands; the film is on the side of `up`.
    Ground {
        /// A point of the plane, m.
        point: DVec3,
        /// Unit vector away from the plane.
        up: DVec3,
    },
}

impl Lamella {
    /// Whether the film encloses gas: a closed film by itself, a dome together with the ground it stands on.
    #[must_use]
    pub fn encloses_gas(&self) -> bool {
        Rim::leaves_gas_enclosed(self.rim)
    }

    /// Point from which the enclosed volume is measured, m: one that the ground, if any, adds nothing to.
    #[must_use]
    pub fn volume_origin(&self) -> DVec3 {
        match self.rim {
            Some(Rim::Ground { point, .. }) => point,
            _ => self.centre,
        }
    }
}

impl Rim {
    /// Whether a film with this rim, or none, encloses gas.
    #[must_use]
    pub fn leaves_gas_enclosed(rim: Option<Self>) -> bool {
        matches!(rim, None | Some(Self::Ground { .. }))
    }

    /// How far `place` lies beyond the rim (positive outside), m, and the unit vector back inside.
    #[must_use]
    pub fn beyond(&self, place: DVec3) -> (f64, DVec3) {
        match *self {
            Self::Circle { centre, axis, radius } => {
                let arm = place - centre;
                let flat = arm - axis * axis.dot(arm);
                (flat.length() - radius, -flat.normalize_or_zero())
            }
            Self::Rectangle { centre, sides, half } => {
                let arm = place - centre;
                let along = [sides[0].dot(arm), sides[1].dot(arm)];
                let out = [along[0].abs() - half[0], along[1].abs() - half[1]];
                let side = usize::from(out[1] > out[0]);
                (out[side], -sides[side] * along[side].signum())
            }
            Self::Hexagon { centre, sides, radius } => {
                let arm = place - centre;
                let side = |k: u32| {
                    let (sin, cos) = (TAU / 12.0 * f64::from(2 * k + 1)).sin_cos();
                    sides[0] * cos + sides[1] * sin
                };
                let outward = (0..6).map(side).max_by(|a, b| a.dot(arm).total_cmp(&b.dot(arm))).unwrap_or(DVec3::ZERO);
                (outward.dot(arm) - radius * (TAU / 12.0).cos(), -outward)
            }
            Self::Ground { point, up } => (-up.dot(place - point), up),
        }
    }

    /// A point of the rim's plane and its unit normal, for a flat rim.
    #[must_use]
    pub fn plane(&self) -> Option<(DVec3, DVec3)> {
        match *self {
            Self::Circle { centre, axis, .. } => Some((centre, axis)),
            Self::Rectangle { centre, sides, .. } | Self::Hexagon { centre, sides, .. } => {
                Some((centre, sides[0].cross(sides[1])))
            }
            Self::Ground { .. } => None,
        }
    }

    /// `place` moved back inside by the shortest way if it lies beyond the rim.
    #[must_use]
    pub fn confine(&self, place: DVec3) -> DVec3 {
        // A corner takes two moves.
        let once = |p: DVec3| match self.beyond(p) {
            (out, inward) if out > 0.0 => p + inward * out,
            _ => p,
        };
        once(once(place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_beyond_a_corner_is_brought_back_to_the_corner() {
        let rim = Rim::Rectangle { centre: DVec3::ZERO, sides: [DVec3::X, DVec3::Y], half: [2.0, 1.0] };
        assert_eq!(rim.confine(DVec3::new(2.5, -1.5, 0.3)), DVec3::new(2.0, -1.0, 0.3));
        assert_eq!(rim.confine(DVec3::new(1.5, -0.5, 0.0)), DVec3::new(1.5, -0.5, 0.0));
    }

    #[test]
    fn a_hexagon_ends_at_its_sides_and_corners() {
        let rim = Rim::Hexagon { centre: DVec3::X, sides: [DVec3::X, DVec3::Y], radius: 2.0 };
        let apothem = 3.0_f64.sqrt();
        let (out, inward) = rim.beyond(DVec3::new(1.0, 2.0, 0.1));
        assert!((out - (2.0 - apothem)).abs() < 1e-12 && inward.distance(-DVec3::Y) < 1e-12);
        let corner = rim.confine(DVec3::new(3.5, 0.1, 0.0));
        assert!(rim.beyond(corner).0 < 1e-12 && corner.distance(DVec3::new(3.0, 0.0, 0.0)) < 0.2, "{corner}");
    }

    #[test]
    fn circle_and_ground_point_back_inside() {
        let circle = Rim::Circle { centre: DVec3::X, axis: DVec3::Z, radius: 1.0 };
        assert_eq!(circle.beyond(DVec3::new(3.0, 0.0, 0.2)), (1.0, -DVec3::X));
        let ground = Rim::Ground { point: DVec3::ZERO, up: DVec3::Y };
        assert_eq!(ground.confine(DVec3::new(1.0, -0.5, 0.0)), DVec3::new(1.0, 0.0, 0.0));
    }
}
