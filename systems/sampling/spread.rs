//! Even point sets: golden spirals on round shapes, a low-discrepancy sequence and lattices on straight-edged ones.

use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// The golden angle, `pi (3 - sqrt 5)`.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;

/// `count` directions spread evenly over the part of the unit sphere with `y` between `lowest` and 1.
pub fn sphere_cap(count: usize, lowest: f64) -> impl Iterator<Item = DVec3> {
    (0..count).map(move |i| {
        let y = 1.0 - (1.0 - lowest) * (i as f64 + 0.5) / count as f64;
        let ring = (1.0 - y * y).max(0.0).sqrt();
        let (sin, cos) = (GOLDEN_ANGLE * i as f64).sin_cos();
        DVec3::new(ring * sin, y, ring * cos)
    })
}

/// `count` points spread evenly over the unit disc, as (x, y).
pub fn disc(count: usize) -> impl Iterator<Item = (f64, f64)> {
    (0..count).map(move |i| {
        let r = ((i as f64 + 0.5) / count as f64).sqrt();
        let (sin, cos) = (GOLDEN_ANGLE * i as f64).sin_cos();
        (r * cos, r * sin)
    })
}

/// Points of a triangular lattice of about `spacing` that fits the rectangle `[-half_width, half_width] x
/// [-half_height, half_height]`, the outermost half a spacing inside, as (x, y).
#[must_use]
pub fn lattice(half_width: f64, half_height: f64, spacing: f64) -> Vec<(f64, f64)> {
    let row_distance = spacing * 0.75_f64.sqrt().sqrt();
    let rows = (2.0 * half_height / row_distance).round().max(1.0);
    let across = (4.0 * half_width * half_height / (spacing * spacing) / rows).round().max(1.0);
    let step = 2.0 * half_width / across;
    let mut points = Vec::with_capacity((rows * across) as usize);
    for row in 0..rows as u32 {
        let shift = if row % 2 == 0 { 0.25 } else { 0.75 };
        let y = -half_height + 2.0 * half_height * (f64::from(row) + 0.5) / rows;
        points.extend((0..across as u32).map(|k| (-half_width + step * (f64::from(k) + shift), y)));
    }
    points
}

/// Rings of a triangular lattice of `step` around a point of it, as (x, y). Ring `k` is a hexagon of `6 k` points with a
/// corner at `(k step, 0)`; ring 0 is the point itself.
pub fn hexagons(step: f64, rings: Range<u32>) -> impl Iterator<Item = (f64, f64)> {
    let side = |ring: u32, k: u32| {
        let direction = |sixth: u32| (TAU / 6.0 * f64::from(sixth)).sin_cos();
        let ((corner_y, corner_x), (along_y, along_x)) = (direction(k), direction(k + 2));
        let places = 0..if ring == 0 { u32::from(k == 0) } else { ring };
        places.map(move |j| {
            let (from, along) = (f64::from(ring), f64::from(j));
            (corner_x * from + along_x * along, corner_y * from + along_y * along)
        })
    };
    rings.flat_map(move |ring| (0..6).flat_map(move |k| side(ring, k))).map(move |(x, y)| (x * step, y * step))
}

/// How many rings of [`hexagons`], the centre included, fit a hexagon of `radius` (centre to corner) at about `spacing`
/// (square root of the area per point), and their step: the outermost is half a step inside.
#[must_use]
pub fn fitting_hexagons(radius: f64, spacing: f64) -> (u32, f64) {
    let step = spacing * (4.0_f64 / 3.0).sqrt().sqrt();
    let rings = (radius / step + 0.5).round().max(1.0);
    (rings as u32, radius / (rings - 0.5))
}

/// The first `count` points of a two-dimensional low-discrepancy sequence on the rectangle, as (x, y).
///
/// Additive recurrence with the plastic number (Roberts 2018).
pub fn scattered(count: usize, half_width: f64, half_height: f64) -> impl Iterator<Item = (f64, f64)> {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let (a, b) = (1.0 / PLASTIC, 1.0 / (PLASTIC * PLASTIC));
    (0..count).map(move |i| {
        let k = i as f64 + 0.5;
        let place = |share: f64, half: f64| half * (2.0 * (0.5 + share * k).fract() - 1.0);
        (place(a, half_width), place(b, half_height))
    })
}

/// Layers of points around a circle of `radius`, half a `spacing` outside and further, as (distance outside, angle).
pub fn rings(radius: f64, spacing: f64, layers: u32) -> impl Iterator<Item = (f64, f64)> {
    (0..layers).flat_map(move |layer| {
        let out = spacing * (f64::from(layer) + 0.5);
        let count = (TAU * (radius + out) / spacing).round().max(3.0) as u32;
        (0..count).map(move |k| (out, TAU * (f64::from(k) + 0.5 * f64::from(layer % 2)) / f64::from(count)))
    })
}

/// Points of a square lattice in a frame `layers` wide around a rectangle, as (x, y).
#[must_use]
pub fn frame(half_width: f64, half_height: f64, spacing: f64, layers: u32) -> Vec<(f64, f64)> {
    let cells = |half: f64| (2.0 * half / spacing).round().max(1.0);
    let (nx, ny) = (cells(half_width), cells(half_height));
    let layers = i64::from(layers);
    let place = |k: i64, n: f64, half: f64| -half + 2.0 * half * (k as f64 + 0.5) / n;
    let inside = |k: i64, n: f64| k >= 0 && (k as f64) < n;
    let span = |n: f64| -layers..n as i64 + layers;
    span(nx)
        .flat_map(|i| span(ny).map(move |j| (i, j)))
        .filter(|&(i, j)| !(inside(i, nx) && inside(j, ny)))
        .map(|(i, j)| (place(i, nx, half_width), place(j, ny, half_height)))
        .collect()
}

/// Latitude layers below the equator of a sphere of `radius`, half a `spacing` of arc below and further, as directions.
pub fn below_equator(radius: f64, spacing: f64, layers: u32) -> impl Iterator<Item = DVec3> {
    (0..layers).flat_map(move |layer| {
        let angle = (spacing / radius * (f64::from(layer) + 0.5)).min(0.5 * PI);
        let ring = angle.cos();
        let count = (TAU * radius * ring / spacing).round().max(1.0) as u32;
        (0..count).map(move |k| {
            let (sin, cos) = (TAU * (f64::from(k) + 0.5 * f64::from(layer % 2)) / f64::from(count)).sin_cos();
            DVec3::new(ring * sin, -angle.sin(), ring * cos)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cap_of_a_sphere_is_covered_evenly() {
        let points: Vec<DVec3> = sphere_cap(1000, 0.0).collect();
        let centroid = points.iter().copied().sum::<DVec3>() / 1000.0;
        assert!(points.iter().all(|p| p.y > 0.0 && (p.length() - 1.0).abs() < 1e-12));
        assert!(centroid.distance(DVec3::new(0.0, 0.5, 0.0)) < 2e-3, "{centroid}");
    }

    #[test]
    fn a_lattice_has_the_density_asked_for_and_stays_inside() {
        let points = lattice(0.08, 0.045, 0.002);
        assert!((points.len() as f64 / (0.16 * 0.09 / 4e-6) - 1.0).abs() < 0.02, "{}", points.len());
        assert!(points.iter().all(|(x, y)| x.abs() < 0.08 && y.abs() < 0.045));
    }

    #[test]
    fn hexagons_are_a_lattice_of_even_neighbours() {
        let (rings, step) = fitting_hexagons(0.05, 0.002);
        let points: Vec<DVec3> = hexagons(step, 0..rings).map(|(x, y)| DVec3::new(x, y, 0.0)).collect();
        assert_eq!(points.len() as u32, 1 + 3 * rings * (rings - 1));
        let area = 1.5 * 3.0_f64.sqrt() * 0.05 * 0.05;
        assert!(((area / points.len() as f64).sqrt() / 0.002 - 1.0).abs() < 0.02, "{}", points.len());
        let nearest = |p: &DVec3| points.iter().map(|q| p.distance(*q)).filter(|d| *d > 0.0).fold(1.0, f64::min);
        assert!(points.iter().all(|p| (nearest(p) / step - 1.0).abs() < 1e-9));
    }

    #[test]
    fn a_frame_surrounds_and_never_enters() {
        let points = frame(0.08, 0.045, 0.002, 5);
        assert!(points.iter().all(|(x, y)| x.abs() > 0.08 || y.abs() > 0.045));
        assert_eq!(points.len(), 90 * 55 - 80 * 45);
    }
}
