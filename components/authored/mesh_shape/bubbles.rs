//! Cubes and small clusters of bubbles, in equilibrium as far as their shape is known in closed form.
//!
//! Bubbles of equal gas meet at 120° in films that are parts of spheres; two of radii `r1 >= r2` share a wall of curvature
//! radius `r1 r2 / (r1 - r2)`, and their centres are `d` apart with `d² = r1² + r2² - r1 r2`
//! (Plateau; see Isenberg 1992, ch. 4).

use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

use bevy_ecs::component::Component;
use glam::{DQuat, DVec3};
use serde::Deserialize;

use super::{Measured, corners};
use crate::authored::shape::{Place, QUARTER, globe};
use crate::quantity::{Direction, Length, range};

/// A closed cube along the axes: a bubble of one region.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cube {
    /// Centre, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Side, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub side: Length,
}

impl Measured for Cube {
    fn centre(&self) -> DVec3 {
        self.centre.si()
    }

    fn size(&self) -> f64 {
        0.5 * self.side.si()
    }

    /// Exact.
    fn area(&self) -> f64 {
        6.0 * self.side.si().powi(2)
    }

    fn outline(&self) -> Vec<DVec3> {
        corners(self.centre.si(), DVec3::splat(self.side.si()))
    }

    fn flat_normals(&self) -> Vec<DVec3> {
        DVec3::AXES.to_vec()
    }
}

/// Radii of two bubbles, metres. Written `("3 cm", "2 cm")`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(expecting = "two radii, e.g. (\"3 cm\", \"2 cm\")")]
pub struct TwoRadii(
    #[serde(deserialize_with = "range::film_size")] Length,
    #[serde(deserialize_with = "range::film_size")] Length,
);

impl TwoRadii {
    /// Radii in metres; for literals in code.
    #[must_use]
    pub const fn from_si(first: f64, second: f64) -> Self {
        Self(Length::from_si(first), Length::from_si(second))
    }

    /// Radii, metres.
    #[must_use]
    pub const fn si(self) -> [f64; 2] {
        [self.0.si(), self.1.si()]
    }
}

/// Two bubbles that share a wall, in equilibrium. Region 1 is the first, region 2 the second.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DoubleBubble {
    /// Centre of the circle where the three films meet, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// From the first bubble to the second. Default: x.
    #[serde(default = "along_x")]
    pub axis: Direction,
    /// Radii of the outer caps of the first and the second bubble, metres.
    pub radii: TwoRadii,
}

impl DoubleBubble {
    /// Heights of the centres of the two caps along the axis above [`centre`](Self::centre), metres.
    #[must_use]
    pub fn heights(&self) -> [f64; 2] {
        let [first, second] = self.radii.si();
        let apart = (first * first + second * second - first * second).sqrt();
        let below = 0.5 * (apart + (first - second) * (first + second) / apart);
        [-below, apart - below]
    }

    /// Radius of the circle where the three films meet, metres.
    #[must_use]
    pub fn junction_radius(&self) -> f64 {
        let ([first, second], [low, high]) = (self.radii.si(), self.heights());
        // Of the smaller bubble, whose centre is nearer to the circle's plane: no digits are lost.
        let (radius, height) = if first < second { (first, low) } else { (second, high) };
        ((radius - height) * (radius + height)).max(0.0).sqrt()
    }

    /// Curvature of the wall, 1 over metres: positive where it bulges into the first bubble.
    #[must_use]
    pub fn wall_curvature(&self) -> f64 {
        let [first, second] = self.radii.si();
        1.0 / second - 1.0 / first
    }
}

impl Measured for DoubleBubble {
    fn centre(&self) -> DVec3 {
        self.centre.si()
    }

    fn size(&self) -> f64 {
        let [first, second] = self.radii.si();
        first.max(second)
    }

    /// Exact: two caps and the wall, `2π r (r + |h|)` each and `π (a² + s²)` with the wall's sagitta `s`.
    fn area(&self) -> f64 {
        let ([first, second], [low, high]) = (self.radii.si(), self.heights());
        let (across, bend) = (self.junction_radius(), self.wall_curvature().abs());
        let sagitta = across * across * bend / (1.0 + (1.0 - (across * bend).powi(2)).max(0.0).sqrt());
        TAU * (first * (first - low) + second * (second + high)) + PI * (across * across + sagitta * sagitta)
    }

    fn outline(&self) -> Vec<DVec3> {
        let placed = self.radii.si().into_iter().zip(self.heights());
        placed.flat_map(|(radius, height)| ball(self.centre.si() + height * self.axis.unit(), radius)).collect()
    }

    fn bubbles(&self) -> u64 {
        2
    }
}

/// Three equal bubbles around an axis, in equilibrium. Regions 1, 2, 3 counterclockwise seen from the tip of the axis.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TripleBubble {
    /// Centre of all, where the three walls meet, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// The line in which the walls meet. Default: z.
    #[serde(default = "along_z")]
    pub axis: Direction,
    /// Radius of the outer caps, metres; also the distance between their centres.
    #[serde(deserialize_with = "range::film_size")]
    pub radius: Length,
}

impl TripleBubble {
    /// Centres of the outer caps, metres.
    #[must_use]
    pub fn centres(&self) -> [DVec3; 3] {
        let axis = self.axis.unit();
        let first = axis.any_orthonormal_vector() * self.radius.si() / 3.0_f64.sqrt();
        [0.0, 1.0, 2.0].map(|turn| self.centre.si() + DQuat::from_axis_angle(axis, turn * TAU / 3.0) * first)
    }
}

impl Measured for TripleBubble {
    fn centre(&self) -> DVec3 {
        self.centre.si()
    }

    fn size(&self) -> f64 {
        self.radius.si()
    }

    /// Within 0.1 %: 22.93 radii squared outside, 5.01 in walls, by counting points of the caps and walls.
    fn area(&self) -> f64 {
        27.94 * self.radius.si().powi(2)
    }

    fn outline(&self) -> Vec<DVec3> {
        self.centres().into_iter().flat_map(|centre| ball(centre, self.radius.si())).collect()
    }

    fn bubbles(&self) -> u64 {
        3
    }
}

/// Four equal bubbles around a point, in equilibrium. Regions 1 to 4 towards (1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1).
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QuadrupleBubble {
    /// Point where all walls meet, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Radius of the outer caps, metres; also the distance between their centres.
    #[serde(deserialize_with = "range::film_size")]
    pub radius: Length,
}

impl QuadrupleBubble {
    /// Centres of the outer caps, metres.
    #[must_use]
    pub fn centres(&self) -> [DVec3; 4] {
        let corners =
            [DVec3::ONE, DVec3::new(1.0, -1.0, -1.0), DVec3::new(-1.0, 1.0, -1.0), DVec3::new(-1.0, -1.0, 1.0)];
        corners.map(|corner| self.centre.si() + 0.5 * FRAC_1_SQRT_2 * self.radius.si() * corner)
    }
}

impl Measured for QuadrupleBubble {
    fn centre(&self) -> DVec3 {
        self.centre.si()
    }

    fn size(&self) -> f64 {
        self.radius.si()
    }

    /// Within 0.1 %: 25.90 radii squared outside, 7.60 in walls, by counting points of the caps and walls.
    fn area(&self) -> f64 {
        33.50 * self.radius.si().powi(2)
    }

    fn outline(&self) -> Vec<DVec3> {
        self.centres().into_iter().flat_map(|centre| ball(centre, self.radius.si())).collect()
    }

    fn bubbles(&self) -> u64 {
        4
    }
}

/// Points of a sphere, metres.
pub(super) fn ball(centre: DVec3, radius: f64) -> impl Iterator<Item = DVec3> {
    globe(-QUARTER).map(move |point| centre + radius * point)
}

fn along_x() -> Direction {
    Direction::X
}

fn along_z() -> Direction {
    Direction::Z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::authored::shape::Place;

    fn double(first: f64, second: f64) -> DoubleBubble {
        DoubleBubble { centre: Place::ZERO, axis: Direction::X, radii: TwoRadii::from_si(first, second) }
    }

    #[test]
    fn two_equal_bubbles_lose_a_quarter_of_their_area_and_share_a_flat_wall() {
        let bubbles = double(0.03, 0.03);
        assert_eq!(bubbles.wall_curvature(), 0.0);
        let exact = 6.0 * PI * 0.03_f64.powi(2) + 0.75 * PI * 0.03_f64.powi(2);
        assert!((bubbles.area() / exact - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_three_films_of_a_double_bubble_meet_at_120_degrees() {
        for (first, second) in [(0.03, 0.03), (0.03, 0.02), (0.01, 0.05), (1.0, 1e-3)] {
            let bubbles = double(first, second);
            let (across, heights) = (bubbles.junction_radius(), bubbles.heights());
            // Directions from the two caps' centres to a point of the circle are the films' normals there.
            let normals = heights.map(|height| DVec3::new(-height, across, 0.0).normalize());
            assert!((normals[0].dot(normals[1]) - 0.5).abs() < 1e-9, "{first} and {second}");
            assert!((across * across + heights[0] * heights[0] - first * first).abs() < 1e-12 * first * first);
        }
    }

    #[test]
    fn a_tiny_second_bubble_hardly_changes_the_area_of_the_first() {
        let sphere = 4.0 * PI;
        assert!((double(1.0, 1e-3).area() / sphere - 1.0).abs() < 1e-5);
        assert!((double(1e-3, 1.0).area() / sphere - 1.0).abs() < 1e-5);
    }

    #[test]
    fn the_centres_of_equal_clusters_are_a_radius_apart() {
        let radius = Length::from_si(0.02);
        let axis = Direction::of(DVec3::new(1.0, -2.0, 0.5)).unwrap();
        let triple = TripleBubble { centre: Place::from_si(DVec3::X), axis, radius }.centres();
        let quadruple = QuadrupleBubble { centre: Place::from_si(DVec3::X), radius }.centres();
        for centres in [&triple[..], &quadruple[..]] {
            for (i, a) in centres.iter().enumerate() {
                assert!(centres[..i].iter().all(|b| (a.distance(*b) - 0.02).abs() < 1e-12));
            }
        }
        assert!(triple.iter().all(|c| (*c - DVec3::X).dot(axis.unit()).abs() < 1e-12));
    }

    #[test]
    fn the_stated_areas_of_equal_clusters_are_those_of_their_caps_and_walls() {
        // The share of a unit sphere that is nearer to its own centre than to the others, by many even points.
        let outer = |centres: &[DVec3]| {
            let points = || globe(-QUARTER).map(|p| (p, (p.x * p.x + p.y * p.y).sqrt()));
            let weigh = |keep: &dyn Fn(DVec3) -> bool| points().filter(|(p, _)| keep(*p)).map(|(_, w)| w).sum::<f64>();
            let own = |p: DVec3| centres[1..].iter().all(|c| (centres[0] + p).distance(*c) >= 1.0);
            4.0 * PI * centres.len() as f64 * weigh(&own) / weigh(&|_| true)
        };
        let radius = Length::from_si(1.0);
        let triple = TripleBubble { centre: Place::ZERO, axis: Direction::Z, radius };
        let quadruple = QuadrupleBubble { centre: Place::ZERO, radius };
        // A net of pi/32 by pi/32 resolves the cuts to about a per cent.
        assert!((outer(&triple.centres()) - 22.93).abs() < 0.3);
        assert!((outer(&quadruple.centres()) - 25.90).abs() < 0.4);
    }
}
