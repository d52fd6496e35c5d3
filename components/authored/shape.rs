//! Shapes a film starts from: closed ([`Sphere`], [`Ellipsoid`]) or pinned at a rim ([`HalfSphere`], [`Disc`],
//! [`Rectangle`], [`Hexagon`]).
//!
//! Films of one piece, which particles and meshes can be; what takes a mesh is a [`MeshShape`](super::mesh_shape::MeshShape).
//! Each knows its area and the length of its rim, from which the number of particles is estimated before any is made.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use bevy_ecs::component::Component;
use glam::{DQuat, DVec3};
use serde::{Deserialize, Deserializer};

use crate::quantity::{Direction, Length, Refusal, RefusalKind, Vector, dimension, range};

/// A place, metres.
pub type Place = Vector<dimension::Length>;

/// A closed sphere.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Centre, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Radius, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub radius: Length,
}

/// A closed ellipsoid with its axes along x, y and z.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ellipsoid {
    /// Centre, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Half axes along x, y and z, metres.
    pub radii: Radii,
}

/// Three lengths of a film, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radii(DVec3);

impl Radii {
    /// Half axes in metres; for literals in code.
    #[must_use]
    pub const fn from_si(radii: DVec3) -> Self {
        Self(radii)
    }

    /// Half axes along x, y and z, metres.
    #[must_use]
    pub const fn si(self) -> DVec3 {
        self.0
    }
}

impl<'de> Deserialize<'de> for Radii {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        range::film_sizes(deserializer).map(|radii: Place| Self(radii.si()))
    }
}

/// Half a sphere on a plane; the rim is pinned, the plane itself is no film.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalfSphere {
    /// Centre of the rim, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Radius, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub radius: Length,
    /// From the plane to the pole. Default: y.
    #[serde(default = "along_y")]
    pub up: Direction,
}

/// A flat disc whose rim is pinned.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Disc {
    /// Centre, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Radius, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub radius: Length,
    /// Normal of the plane. Default: z.
    #[serde(default = "along_z")]
    pub normal: Direction,
}

/// A flat rectangle whose rim is pinned.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Centre, metres. Default: the origin.
    pub centre: Place,
    /// Extent across `up`, metres.
    pub width: Length,
    /// Extent along `up`, metres.
    pub height: Length,
    /// Normal of the plane. Default: z.
    pub normal: Direction,
    /// Direction of the height, at right angles to the normal: what is written, less its part along the normal.
    /// Default: y, or -z where the normal is along y.
    pub up: Direction,
}

impl Rectangle {
    /// Direction of the width, `up × normal`.
    #[must_use]
    pub fn across(&self) -> DVec3 {
        self.up.unit().cross(self.normal.unit())
    }
}

impl<'de> Deserialize<'de> for Rectangle {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "Rectangle", deny_unknown_fields)]
        struct Fields {
            #[serde(default)]
            centre: Place,
            #[serde(deserialize_with = "range::film_size")]
            width: Length,
            #[serde(deserialize_with = "range::film_size")]
            height: Length,
            #[serde(default = "along_z")]
            normal: Direction,
            #[serde(default)]
            up: Option<Direction>,
        }
        let Fields { centre, width, height, normal, up } = Fields::deserialize(deserializer)?;
        Ok(Self { centre, width, height, normal, up: upright(up, normal)? })
    }
}

/// A flat regular hexagon whose rim is pinned.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Hexagon {
    /// Centre, metres. Default: the origin.
    pub centre: Place,
    /// Distance from the centre to a corner, which is the length of a side, metres.
    pub radius: Length,
    /// Normal of the plane. Default: z.
    pub normal: Direction,
    /// Direction of a corner, at right angles to the normal: what is written, less its part along the normal.
    /// Default: y, or -z where the normal is along y.
    pub up: Direction,
}

impl<'de> Deserialize<'de> for Hexagon {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "Hexagon", deny_unknown_fields)]
        struct Fields {
            #[serde(default)]
            centre: Place,
            #[serde(deserialize_with = "range::film_size")]
            radius: Length,
            #[serde(default = "along_z")]
            normal: Direction,
            #[serde(default)]
            up: Option<Direction>,
        }
        let Fields { centre, radius, normal, up } = Fields::deserialize(deserializer)?;
        Ok(Self { centre, radius, normal, up: upright(up, normal)? })
    }
}

/// The authored `up` of a flat shape within its plane, or a default one.
fn upright<E: serde::de::Error>(up: Option<Direction>, normal: Direction) -> Result<Direction, E> {
    match up {
        Some(up) => within_plane(up, normal).ok_or_else(|| {
            let help = "write an up that lies more or less in the plane of the film";
            Refusal::new(RefusalKind::Contradiction, "`up` points along the normal", help).into_serde()
        }),
        None => Ok(within_plane(Direction::Y, normal).unwrap_or(Direction::MINUS_Z)),
    }
}

/// The part of a direction at right angles to a normal; `None` if hardly any is left.
fn within_plane(direction: Direction, normal: Direction) -> Option<Direction> {
    const HARDLY_ANY: f64 = 1e-6;
    let part = direction.unit().reject_from_normalized(normal.unit());
    Direction::of(part).filter(|_| part.length() > HARDLY_ANY)
}

fn along_y() -> Direction {
    Direction::Y
}

fn along_z() -> Direction {
    Direction::Z
}

/// Any one shape of a single film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A closed sphere.
    Sphere(Sphere),
    /// A closed ellipsoid.
    Ellipsoid(Ellipsoid),
    /// A half sphere with a pinned rim.
    HalfSphere(HalfSphere),
    /// A disc with a pinned rim.
    Disc(Disc),
    /// A rectangle with a pinned rim.
    Rectangle(Rectangle),
    /// A regular hexagon with a pinned rim.
    Hexagon(Hexagon),
}

impl Shape {
    /// Names of the shape components, as scene files write them.
    pub const NAMES: [&str; 6] = ["Sphere", "Ellipsoid", "HalfSphere", "Disc", "Rectangle", "Hexagon"];

    /// Centre, metres.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        match self {
            Self::Sphere(sphere) => sphere.centre.si(),
            Self::Ellipsoid(ellipsoid) => ellipsoid.centre.si(),
            Self::HalfSphere(half) => half.centre.si(),
            Self::Disc(disc) => disc.centre.si(),
            Self::Rectangle(rectangle) => rectangle.centre.si(),
            Self::Hexagon(hexagon) => hexagon.centre.si(),
        }
    }

    /// Size that relative amplitudes and noise frequencies refer to, metres: the radius, the geometric mean of the half axes,
    /// or half the longer side.
    #[must_use]
    pub fn size(&self) -> f64 {
        match self {
            Self::Sphere(sphere) => sphere.radius.si(),
            Self::Ellipsoid(ellipsoid) => ellipsoid.radii.si().element_product().cbrt(),
            Self::HalfSphere(half) => half.radius.si(),
            Self::Disc(disc) => disc.radius.si(),
            Self::Rectangle(rectangle) => 0.5 * rectangle.width.si().max(rectangle.height.si()),
            Self::Hexagon(hexagon) => hexagon.radius.si(),
        }
    }

    /// Area of the film, square metres. Exact but for the ellipsoid (Knud Thomsen's formula, within 1.1 %).
    #[must_use]
    pub fn area(&self) -> f64 {
        match self {
            Self::Sphere(sphere) => 4.0 * PI * sphere.radius.si().powi(2),
            Self::Ellipsoid(ellipsoid) => ellipsoid_area(ellipsoid.radii.si()),
            Self::HalfSphere(half) => TAU * half.radius.si().powi(2),
            Self::Disc(disc) => PI * disc.radius.si().powi(2),
            Self::Rectangle(rectangle) => rectangle.width.si() * rectangle.height.si(),
            Self::Hexagon(hexagon) => 1.5 * 3.0_f64.sqrt() * hexagon.radius.si().powi(2),
        }
    }

    /// Length of the pinned rim, metres; 0 for a closed shape.
    #[must_use]
    pub fn rim(&self) -> f64 {
        match self {
            Self::Sphere(_) | Self::Ellipsoid(_) => 0.0,
            Self::HalfSphere(half) => TAU * half.radius.si(),
            Self::Disc(disc) => TAU * disc.radius.si(),
            Self::Rectangle(rectangle) => 2.0 * (rectangle.width.si() + rectangle.height.si()),
            Self::Hexagon(hexagon) => 6.0 * hexagon.radius.si(),
        }
    }

    /// Points whose convex hull is the shape's hull, metres: the corners of a rectangle; on round shapes a net of meridians and
    /// parallels, so fine that less than 0.3 % of the radius is cut off.
    #[must_use]
    pub fn outline(&self) -> Vec<DVec3> {
        match self {
            Self::Sphere(sphere) => {
                let radius = sphere.radius.si();
                globe(-QUARTER).map(|p| sphere.centre.si() + radius * p).collect()
            }
            Self::Ellipsoid(ellipsoid) => {
                globe(-QUARTER).map(|p| ellipsoid.centre.si() + ellipsoid.radii.si() * p).collect()
            }
            Self::HalfSphere(half) => {
                let turn = DQuat::from_rotation_arc(DVec3::Z, half.up.unit());
                globe(0).map(|p| half.centre.si() + half.radius.si() * (turn * p)).collect()
            }
            Self::Disc(disc) => {
                let turn = DQuat::from_rotation_arc(DVec3::Z, disc.normal.unit());
                parallel(0).map(|p| disc.centre.si() + disc.radius.si() * (turn * p)).collect()
            }
            Self::Hexagon(hexagon) => {
                let (up, across) = (hexagon.up.unit(), hexagon.normal.unit().cross(hexagon.up.unit()));
                let corner = |k: u32| (TAU / 6.0 * f64::from(k)).sin_cos();
                let place =
                    |(sin, cos): (f64, f64)| hexagon.centre.si() + hexagon.radius.si() * (up * cos + across * sin);
                (0..6).map(corner).map(place).collect()
            }
            Self::Rectangle(rectangle) => {
                let half_width = 0.5 * rectangle.width.si() * rectangle.across();
                let half_height = 0.5 * rectangle.height.si() * rectangle.up.unit();
                let corners = [half_width + half_height, half_width - half_height];
                corners
                    .iter()
                    .flat_map(|corner| [rectangle.centre.si() + corner, rectangle.centre.si() - corner])
                    .collect()
            }
        }
    }

    /// Normal of a flat shape; none for a curved one.
    #[must_use]
    pub fn flat_normal(&self) -> Option<DVec3> {
        match self {
            Self::Disc(disc) => Some(disc.normal.unit()),
            Self::Rectangle(rectangle) => Some(rectangle.normal.unit()),
            Self::Hexagon(hexagon) => Some(hexagon.normal.unit()),
            Self::Sphere(_) | Self::Ellipsoid(_) | Self::HalfSphere(_) => None,
        }
    }

    /// Whether the shape encloses a gas volume by itself.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        matches!(self, Self::Sphere(_) | Self::Ellipsoid(_))
    }
}

/// Parallels from the equator to a pole; four times as many meridians.
pub(super) const QUARTER: i32 = 16;

/// Points of the unit sphere from one parallel to the pole at z.
pub(super) fn globe(lowest: i32) -> impl Iterator<Item = DVec3> {
    (lowest..=QUARTER).flat_map(parallel)
}

/// Points of one parallel of the unit sphere, counted from the equator.
pub(super) fn parallel(row: i32) -> impl Iterator<Item = DVec3> {
    let (height, radius) = (FRAC_PI_2 * f64::from(row) / f64::from(QUARTER)).sin_cos();
    (0..4 * QUARTER).map(move |step| {
        let (sin, cos) = (FRAC_PI_2 * f64::from(step) / f64::from(QUARTER)).sin_cos();
        DVec3::new(radius * cos, radius * sin, height)
    })
}

/// Knud Thomsen's approximation `4π ((aᵖbᵖ + aᵖcᵖ + bᵖcᵖ)/3)^(1/p)`, `p = 1.6075`.
fn ellipsoid_area(radii: DVec3) -> f64 {
    const POWER: f64 = 1.6075;
    // Scaled by the longest half axis: the powers of a tiny ellipsoid would vanish.
    let longest = radii.max_element();
    let [a, b, c] = (radii / longest).to_array().map(|radius| radius.powf(POWER));
    4.0 * PI * longest.powi(2) * ((a * b + a * c + b * c) / 3.0).powf(1.0 / POWER)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ellipsoid(radii: DVec3) -> Shape {
        Shape::Ellipsoid(Ellipsoid { centre: Place::ZERO, radii: Radii(radii) })
    }

    #[test]
    fn an_ellipsoid_of_equal_axes_has_the_area_of_a_sphere() {
        let sphere = Shape::Sphere(Sphere { centre: Place::ZERO, radius: Length::from_si(0.05) });
        let ratio = ellipsoid(DVec3::splat(0.05)).area() / sphere.area();
        assert!((ratio - 1.0).abs() < 1e-12, "{ratio}");
    }

    #[test]
    fn the_area_of_a_prolate_ellipsoid_is_within_the_stated_bound() {
        // Exact for axes 1, 1, 2: 2π(1 + c/e asin e) with e² = 3/4.
        let eccentricity = 0.75_f64.sqrt();
        let exact = TAU * (1.0 + 2.0 / eccentricity * eccentricity.asin());
        assert!((ellipsoid(DVec3::new(1.0, 1.0, 2.0)).area() / exact - 1.0).abs() < 0.011);
    }

    #[test]
    fn the_outline_of_a_shape_reaches_as_far_as_the_shape_in_every_direction() {
        let (centre, tilted) =
            (Place::from_si(DVec3::new(0.3, -1.0, 2.0)), Direction::of(DVec3::new(1.0, 2.0, -2.0)).unwrap());
        let radius = Length::from_si(0.05);
        let radii = DVec3::new(0.02, 0.05, 0.1);
        // How far each shape reaches from its centre along a unit vector.
        let along_disc = |d: DVec3| 0.05 * d.reject_from(tilted.unit()).length();
        type Reach<'a> = &'a dyn Fn(DVec3) -> f64;
        let rectangle = Rectangle {
            centre,
            width: Length::from_si(0.4),
            height: Length::from_si(0.2),
            normal: Direction::X,
            up: Direction::Y,
        };
        let hexagon = Hexagon { centre, radius, normal: Direction::X, up: Direction::Y };
        let shapes: [(Shape, Reach); 6] = [
            (Shape::Sphere(Sphere { centre, radius }), &|_| 0.05),
            (Shape::Ellipsoid(Ellipsoid { centre, radii: Radii(radii) }), &|d| (radii * d).length()),
            (Shape::HalfSphere(HalfSphere { centre, radius, up: tilted }), &|d| {
                if d.dot(tilted.unit()) > 0.0 { 0.05 } else { along_disc(d) }
            }),
            (Shape::Disc(Disc { centre, radius, normal: tilted }), &along_disc),
            (Shape::Hexagon(hexagon), &|d| {
                let flat = DVec3::new(0.0, d.y, d.z);
                let towards_corner = flat.y.atan2(flat.z).rem_euclid(TAU / 6.0) - TAU / 12.0;
                0.05 * flat.length() * towards_corner.cos().max(0.0)
            }),
            (Shape::Rectangle(rectangle), &|d| 0.2 * d.z.abs() + 0.1 * d.y.abs()),
        ];
        for (shape, reach) in shapes {
            for direction in globe(-QUARTER).map(|p| DQuat::from_rotation_y(0.1) * p) {
                let found = shape.outline().iter().map(|p| (p - centre.si()).dot(direction)).fold(f64::MIN, f64::max);
                let short = reach(direction) - found;
                // A mesh of pi/32 by pi/32 is nowhere farther than pi/64 * sqrt 2 from a point: 1 - cos = 0.0024.
                assert!(short > -1e-12 && short < 0.003 * 0.1, "{shape:?} along {direction}: {short}");
            }
        }
    }

    #[test]
    fn a_negative_half_axis_is_refused() {
        assert!(ron::from_str::<Ellipsoid>("(radii: (1, 1, 2))").is_ok());
        assert!(ron::from_str::<Ellipsoid>("(radii: (1, -1, 2))").is_err());
    }

    #[test]
    fn the_height_of_a_rectangle_lies_in_its_plane() {
        let read = |text: &str| ron::from_str::<Rectangle>(text);
        let upright = read("(width: 1, height: 2)").unwrap();
        assert_eq!((upright.across(), upright.up.unit()), (DVec3::X, DVec3::Y));
        let level = read("(width: 1, height: 2, normal: (0, 1, 0))").unwrap();
        assert_eq!((level.across(), level.up.unit()), (DVec3::X, DVec3::NEG_Z));
        let tilted = read("(width: 1, height: 2, normal: (0, 1, 1))").unwrap();
        assert!(tilted.up.unit().dot(tilted.normal.unit()).abs() < 1e-15);
        assert!(read("(width: 1, height: 2, normal: (0, 1, 0), up: (0, -3, 0))").is_err());
    }
}
