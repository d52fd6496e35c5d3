//! An authored shape with its perturbation as places and normals.

use super::harmonic::Harmonic;
use super::spread;
use froth_components::authored::perturbation::{Bumps, HarmonicMode};
use froth_components::authored::shape::{Hexagon, Shape};
use froth_components::lamella::Rim;
use glam::DVec3;
use noise::{NoiseFn, Perlin};

/// Layers of boundary particles beyond a rim: the density kernel reaches four spacings.
const WALL_LAYERS: u32 = 5;

/// A point of a film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmPoint {
    /// Place, m.
    pub position: DVec3,
    /// Unit normal of the unperturbed shape.
    pub normal: DVec3,
}

/// How a shape is displaced along its normals.
#[derive(Clone, Copy, Debug, Default)]
pub struct Perturbation {
    /// Noise, with its seed decided.
    pub bumps: Option<(Bumps, u32)>,
    /// One harmonic.
    pub mode: Option<HarmonicMode>,
}

/// Layered gradient noise of about -1 to 1, of standard deviation about a quarter.
pub struct LayeredNoise {
    perlin: Perlin,
    frequency: f64,
    octaves: u32,
}

impl LayeredNoise {
    /// Noise with `frequency` cells per unit length and `octaves` layers, each half as long and half as high.
    #[must_use]
    pub fn new(seed: u32, frequency: f64, octaves: u32) -> Self {
        Self { perlin: Perlin::new(seed), frequency, octaves }
    }

    /// Value at a dimensionless place.
    #[must_use]
    pub fn at(&self, place: DVec3) -> f64 {
        (0..self.octaves)
            .map(|octave| f64::from(1_u32 << octave))
            .map(|scale| self.perlin.get((place * self.frequency * scale).to_array()) / scale)
            .sum()
    }
}

/// A perturbation, ready to be evaluated.
pub struct Displacement {
    bumps: Option<(LayeredNoise, f64)>,
    mode: Option<(Harmonic, f64)>,
}

impl Displacement {
    /// The displacement that a perturbation asks for.
    #[must_use]
    pub fn new(perturbation: Perturbation) -> Self {
        let bumps = perturbation
            .bumps
            .map(|(bumps, seed)| (LayeredNoise::new(seed, bumps.frequency.si(), bumps.octaves), bumps.amplitude.si()));
        let mode = perturbation.mode.map(|mode| (Harmonic::new(mode.degree, mode.order), mode.amplitude.si()));
        Self { bumps, mode }
    }

    /// Height along the normal in sizes of the shape; `arm` is the place from its centre in sizes.
    #[must_use]
    pub fn at(&self, arm: DVec3) -> f64 {
        let bumps = self.bumps.as_ref().map_or(0.0, |(noise, amplitude)| amplitude * noise.at(arm));
        let mode = self.mode.as_ref().map_or(0.0, |(harmonic, amplitude)| amplitude * harmonic.at(arm));
        bumps + mode
    }
}

/// The sampler of one shape.
pub struct Surface {
    shape: Shape,
    displacement: Displacement,
}

impl Surface {
    /// The surface of `shape`, displaced.
    #[must_use]
    pub fn new(shape: Shape, perturbation: Perturbation) -> Self {
        Self { shape, displacement: Displacement::new(perturbation) }
    }

    /// About `count` points spread evenly over the unperturbed shape, displaced with it. `lattice` asks for a regular
    /// arrangement where the shape has one.
    #[must_use]
    pub fn points(&self, count: usize, lattice: bool) -> Vec<FilmPoint> {
        self.flat_points(count, lattice).into_iter().map(|point| self.displaced(point)).collect()
    }

    fn flat_points(&self, count: usize, lattice: bool) -> Vec<FilmPoint> {
        match self.shape {
            Shape::Sphere(sphere) => {
                let (centre, radius) = (sphere.centre.si(), sphere.radius.si());
                spread::sphere_cap(count, -1.0)
                    .map(|n| FilmPoint { position: centre + n * radius, normal: n })
                    .collect()
            }
            Shape::Ellipsoid(ellipsoid) => {
                let (centre, radii) = (ellipsoid.centre.si(), ellipsoid.radii.si());
                let point = |n: DVec3| FilmPoint { position: centre + n * radii, normal: (n / radii).normalize() };
                spread::sphere_cap(count, -1.0).map(point).collect()
            }
            Shape::HalfSphere(half) => {
                let (frame, radius) = (frame_of(half.up.unit()), half.radius.si());
                let turn = |n: DVec3| frame[0] * n.x + half.up.unit() * n.y + frame[1] * n.z;
                let point = |n: DVec3| FilmPoint { position: half.centre.si() + turn(n) * radius, normal: turn(n) };
                spread::sphere_cap(count, 0.0).map(point).collect()
            }
            Shape::Disc(disc) => {
                let (normal, radius) = (disc.normal.unit(), disc.radius.si());
                let [a, b] = frame_of(normal);
                let place = |(x, y): (f64, f64)| disc.centre.si() + (a * x + b * y) * radius;
                spread::disc(count).map(|p| FilmPoint { position: place(p), normal }).collect()
            }
            Shape::Rectangle(rectangle) => {
                let Rim::Rectangle { centre, sides, half } = rectangle_rim(&rectangle) else { return Vec::new() };
                let place = |(x, y): (f64, f64)| FilmPoint {
                    position: centre + sides[0] * x + sides[1] * y,
                    normal: rectangle.normal.unit(),
                };
                if lattice {
                    let spacing = (4.0 * half[0] * half[1] / count as f64).sqrt();
                    spread::lattice(half[0], half[1], spacing).into_iter().map(place).collect()
                } else {
                    spread::scattered(count, half[0], half[1]).map(place).collect()
                }
            }
            Shape::Hexagon(hexagon) => {
                let (normal, radius) = (hexagon.normal.unit(), hexagon.radius.si());
                let rim = hexagon_rim(&hexagon);
                let point = |position: DVec3| FilmPoint { position, normal };
                if lattice {
                    let (rings, step) = spread::fitting_hexagons(radius, (self.shape.area() / count as f64).sqrt());
                    spread::hexagons(step, 0..rings).map(|p| point(on_hexagon(&hexagon, p))).collect()
                } else {
                    // The sequence fills the box around the hexagon, a third larger than the hexagon itself.
                    let box_count = count * 4 / 3;
                    let places = spread::scattered(box_count, radius, 0.75_f64.sqrt() * radius);
                    places.map(|p| on_hexagon(&hexagon, p)).filter(|p| rim.beyond(*p).0 < 0.0).map(point).collect()
                }
            }
        }
    }

    fn displaced(&self, point: FilmPoint) -> FilmPoint {
        let arm = (point.position - self.shape.centre()) / self.shape.size();
        let height = self.shape.size() * self.displacement.at(arm) * self.pinning(point.position);
        FilmPoint { position: point.position + point.normal * height, ..point }
    }

    /// 1 well inside the film, falling to 0 at a rim, where the film cannot be displaced.
    #[must_use]
    pub fn pinning(&self, place: DVec3) -> f64 {
        self.rim().map_or(1.0, |rim| {
            let inside = (-rim.beyond(place).0 / (0.3 * self.shape.size())).clamp(0.0, 1.0);
            inside * inside * (3.0 - 2.0 * inside)
        })
    }

    /// The rim, for open films.
    #[must_use]
    pub fn rim(&self) -> Option<Rim> {
        match self.shape {
            Shape::Sphere(_) | Shape::Ellipsoid(_) => None,
            Shape::HalfSphere(half) => Some(Rim::Ground { point: half.centre.si(), up: half.up.unit() }),
            Shape::Disc(disc) => {
                Some(Rim::Circle { centre: disc.centre.si(), axis: disc.normal.unit(), radius: disc.radius.si() })
            }
            Shape::Rectangle(rectangle) => Some(rectangle_rim(&rectangle)),
            Shape::Hexagon(hexagon) => Some(hexagon_rim(&hexagon)),
        }
    }

    /// Layers of boundary particles beyond the rim.
    #[must_use]
    pub fn wall(&self, spacing: f64) -> Vec<DVec3> {
        match self.shape {
            Shape::Sphere(_) | Shape::Ellipsoid(_) => Vec::new(),
            Shape::HalfSphere(half) => {
                let (up, radius) = (half.up.unit(), half.radius.si());
                let [a, b] = frame_of(up);
                spread::below_equator(radius, spacing, WALL_LAYERS)
                    .map(|n| half.centre.si() + (a * n.x + up * n.y + b * n.z) * radius)
                    .collect()
            }
            Shape::Disc(disc) => {
                let [a, b] = frame_of(disc.normal.unit());
                spread::rings(disc.radius.si(), spacing, WALL_LAYERS)
                    .map(|(out, angle)| (disc.radius.si() + out, angle.sin_cos()))
                    .map(|(r, (sin, cos))| disc.centre.si() + a * (r * cos) + b * (r * sin))
                    .collect()
            }
            Shape::Rectangle(rectangle) => {
                let Rim::Rectangle { centre, sides, half } = rectangle_rim(&rectangle) else { return Vec::new() };
                let place = |(x, y): (f64, f64)| centre + sides[0] * x + sides[1] * y;
                spread::frame(half[0], half[1], spacing, WALL_LAYERS).into_iter().map(place).collect()
            }
            Shape::Hexagon(hexagon) => {
                let (rings, step) = spread::fitting_hexagons(hexagon.radius.si(), spacing);
                spread::hexagons(step, rings..rings + WALL_LAYERS).map(|p| on_hexagon(&hexagon, p)).collect()
            }
        }
    }
}

/// Two unit vectors that make a right-handed frame `(a, b, axis)`.
fn frame_of(axis: DVec3) -> [DVec3; 2] {
    let (a, b) = axis.any_orthonormal_pair();
    [a, b]
}

fn hexagon_rim(hexagon: &Hexagon) -> Rim {
    let up = hexagon.up.unit();
    let sides = [up, hexagon.normal.unit().cross(up)];
    Rim::Hexagon { centre: hexagon.centre.si(), sides, radius: hexagon.radius.si() }
}

/// A point of a hexagon given along its corner and across.
fn on_hexagon(hexagon: &Hexagon, (x, y): (f64, f64)) -> DVec3 {
    let up = hexagon.up.unit();
    hexagon.centre.si() + up * x + hexagon.normal.unit().cross(up) * y
}

fn rectangle_rim(rectangle: &froth_components::authored::shape::Rectangle) -> Rim {
    let normal = rectangle.normal.unit();
    let up = rectangle.up.unit();
    let up = (up - normal * normal.dot(up)).try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
    Rim::Rectangle {
        centre: rectangle.centre.si(),
        sides: [up.cross(normal), up],
        half: [0.5 * rectangle.width.si(), 0.5 * rectangle.height.si()],
    }
}
