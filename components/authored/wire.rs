//! Wires that hold films: rings and lines of wire, each an entity of its own, at rest or moving.
//!
//! ```ron
//! [ Wire(path: Ring(centre: (0, "2 cm", 0), axis: (0, 1, 0), radius: "3 cm")), Moves(velocity: (0, "1 cm/s", 0)) ]
//! ```
//!
//! What a method does with a wire: where a film has a pinned rim on it, the rim is the wire's from then on (both rings of a
//! [`Catenoid`](super::mesh_shape::Catenoid)); where it passes along a film without a rim (around the cap of a bubble), the
//! film's nearest vertices are put on it and held. They stay on it for the whole run, and move as it moves.

use std::f64::consts::TAU;

use bevy_ecs::component::Component;
use glam::DVec3;
use serde::{Deserialize, Deserializer};

use super::shape::Place;
use crate::quantity::{Direction, Keyframed, Length, Refusal, RefusalKind, Vector, dimension, range};

/// Makes an entity a wire.
#[derive(Component, Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wire {
    /// Where it runs at the start.
    pub path: WirePath,
    /// [`Name`](super::Name) of the film it holds. Default: every film it meets.
    #[serde(default)]
    pub holds: Option<String>,
    /// Thickness of the film that is drawn out of the liquid on the wire, metres. Default: none is, and film that is drawn out is the film
    /// that was there, stretched.
    #[serde(default, deserialize_with = "range::positive_if_given")]
    pub feeds: Option<Length>,
}

/// Where a wire runs.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub enum WirePath {
    /// Along a circle.
    Ring(Ring),
    /// From point to point in straight lines.
    Line(Line),
}

impl WirePath {
    /// The point of the wire nearest to a place, metres.
    #[must_use]
    pub fn nearest(&self, place: DVec3) -> DVec3 {
        match self {
            Self::Ring(ring) => ring.nearest(place),
            Self::Line(line) => line.nearest(place),
        }
    }

    /// How far along the wire its point nearest to a place is, metres: from where a ring happens to begin, or from the first point.
    #[must_use]
    pub fn along(&self, place: DVec3) -> f64 {
        match self {
            Self::Ring(ring) => ring.along(place),
            Self::Line(line) => line.along(place),
        }
    }

    /// Whether its end is its beginning.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Ring(_) => true,
            Self::Line(line) => line.closed,
        }
    }

    /// Length of the wire, metres.
    #[must_use]
    pub fn length(&self) -> f64 {
        match self {
            Self::Ring(ring) => TAU * ring.radius.si(),
            Self::Line(line) => line.segments().map(|[a, b]| a.distance(b)).sum(),
        }
    }
}

/// A circle of wire.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ring {
    /// Centre, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Normal of its plane. Default: y.
    #[serde(default = "along_y")]
    pub axis: Direction,
    /// Radius, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub radius: Length,
}

impl Ring {
    /// The point of the ring nearest to a place, metres; any one for a place on the axis.
    #[must_use]
    pub fn nearest(&self, place: DVec3) -> DVec3 {
        let axis = self.axis.unit();
        let out = (place - self.centre.si()).reject_from_normalized(axis);
        let out = out.try_normalize().unwrap_or_else(|| axis.any_orthonormal_vector());
        self.centre.si() + self.radius.si() * out
    }

    fn along(&self, place: DVec3) -> f64 {
        let start = self.axis.unit().any_orthonormal_vector();
        let out = self.nearest(place) - self.centre.si();
        let angle = out.dot(self.axis.unit().cross(start)).atan2(out.dot(start));
        self.radius.si() * angle.rem_euclid(TAU)
    }
}

/// Straight pieces of wire from point to point.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Two points or more, metres.
    points: Vec<Place>,
    /// Whether the last point is joined to the first. Default false.
    closed: bool,
}

impl Line {
    /// The points, metres; two or more.
    #[must_use]
    pub fn points(&self) -> &[Place] {
        &self.points
    }

    /// Ends of each straight piece, metres.
    pub fn segments(&self) -> impl Iterator<Item = [DVec3; 2]> {
        let ends = self.points.windows(2).map(|ends| [ends[0].si(), ends[1].si()]);
        let closing = match (self.closed, &self.points[..]) {
            (true, [first, .., last]) => Some([last.si(), first.si()]),
            _ => None,
        };
        ends.chain(closing)
    }

    /// The point of the wire nearest to a place, metres; of several the first.
    #[must_use]
    pub fn nearest(&self, place: DVec3) -> DVec3 {
        let on = self
            .segments()
            .map(|[a, b]| a + (b - a) * ((place - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0));
        on.min_by(|p, q| p.distance_squared(place).total_cmp(&q.distance_squared(place)))
            .expect("invariant: a line has two points or more")
    }
}

impl Line {
    fn along(&self, place: DVec3) -> f64 {
        let nearest = self.nearest(place);
        let (mut before, mut best) = (0.0, (f64::INFINITY, 0.0));
        for [a, b] in self.segments() {
            let length = a.distance(b);
            let on = ((nearest - a).dot(b - a) / length).clamp(0.0, length);
            let off = nearest.distance(a + (b - a) * (on / length));
            if off < best.0 {
                best = (off, before + on);
            }
            before += length;
        }
        best.1
    }
}

impl<'de> Deserialize<'de> for Line {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "Line", deny_unknown_fields)]
        struct Fields {
            points: Vec<Place>,
            #[serde(default)]
            closed: bool,
        }
        let Fields { points, closed } = Fields::deserialize(deserializer)?;
        let line = Self { points, closed };
        let refuse = |message: &str, help: &str| Refusal::new(RefusalKind::Contradiction, message, help).into_serde();
        if line.points.len() < 2 {
            return Err(refuse(
                "a line from point to point has two points or more",
                "write `points: [(0, 0, 0), (1, 0, 0)]`",
            ));
        }
        if line.segments().any(|[a, b]| !(a.distance(b) > 0.0)) {
            return Err(refuse(
                "two points in a row are the same",
                "leave one of them out; `closed: true` joins the ends",
            ));
        }
        Ok(line)
    }
}

/// Moves a wire, or the pinned rims of a film: each point by the same way.
#[derive(Component, Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Moves {
    /// Velocity, metres per second; may be keyframed.
    pub velocity: Keyframed<Vector<dimension::Speed>>,
}

impl Moves {
    /// Way from the start to a time, metres: the exact integral of the velocity. `time` in seconds since the start, 0 or more.
    #[must_use]
    pub fn way(&self, time: f64) -> DVec3 {
        let frames = self.velocity.frames().iter().map(|frame| frame.time.si());
        let stops = frames.filter(|stop| (0.0..time).contains(stop)).chain([time]);
        // Velocity is linear between keyframes: the trapezium is exact.
        let (mut from, mut way) = (0.0, DVec3::ZERO);
        for stop in stops {
            way += 0.5 * (stop - from) * (self.velocity.at(from).si() + self.velocity.at(stop).si());
            from = stop;
        }
        way
    }
}

fn along_y() -> Direction {
    Direction::Y
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moves(text: &str) -> Moves {
        ron::from_str(text).unwrap()
    }

    #[test]
    fn a_steady_wire_goes_velocity_times_time() {
        let steady = moves("(velocity: (1, -2, 0))");
        assert_eq!(steady.way(0.0), DVec3::ZERO);
        assert_eq!(steady.way(2.5), DVec3::new(2.5, -5.0, 0.0));
    }

    #[test]
    fn the_way_of_a_wire_that_starts_and_stops_is_the_area_under_its_speed() {
        let ramp = moves("(velocity: [(t: 1, v: (0, 0, 0)), (t: 2, v: (2, 0, 0)), (t: 4, v: (0, 0, 0))])");
        for (time, way) in [(0.5, 0.0), (1.0, 0.0), (1.5, 0.25), (2.0, 1.0), (3.0, 2.5), (4.0, 3.0), (9.0, 3.0)] {
            assert!((ramp.way(time) - DVec3::X * way).length() < 1e-14, "{time}");
        }
    }

    #[test]
    fn the_nearest_point_of_a_ring_lies_on_it_beside_the_place() {
        let ring = Ring { centre: Place::from_si(DVec3::X), axis: Direction::Y, radius: Length::from_si(0.5) };
        assert_eq!(ring.nearest(DVec3::new(3.0, 7.0, 0.0)), DVec3::new(1.5, 0.0, 0.0));
        let along = |z: f64| WirePath::Ring(ring).along(DVec3::new(1.0 + z.cos(), 0.0, z.sin()));
        assert!(((along(2.0) - along(1.0)).abs() - 0.5).abs() < 1e-14);
        assert!((ring.nearest(DVec3::X).distance(DVec3::X) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn the_nearest_point_of_a_line_is_within_a_piece_or_at_a_corner() {
        let read = |text: &str| ron::from_str::<Line>(text);
        let corner = read("(points: [(0, 0, 0), (1, 0, 0), (1, 1, 0)])").unwrap();
        assert_eq!(corner.nearest(DVec3::new(0.25, -1.0, 3.0)), DVec3::new(0.25, 0.0, 0.0));
        assert_eq!(corner.nearest(DVec3::new(2.0, -1.0, 0.0)), DVec3::X);
        assert_eq!(WirePath::Line(corner.clone()).along(DVec3::new(1.5, 0.25, 0.0)), 1.25);
        assert_eq!(WirePath::Line(corner).length(), 2.0);
        let triangle = read("(points: [(0, 0, 0), (3, 0, 0), (3, 4, 0)], closed: true)").unwrap();
        assert_eq!(WirePath::Line(triangle).length(), 12.0);
        assert!(read("(points: [(0, 0, 0)])").is_err());
        assert!(read("(points: [(0, 0, 0), (0, 0, 0)])").is_err());
        assert!(read("(points: [(0, 0, 0), (1, 0, 0), (0, 0, 0)], closed: true)").is_err());
    }
}
