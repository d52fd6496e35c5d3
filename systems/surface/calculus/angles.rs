//! Angles at which films meet along borders (120 degrees at rest), and borders at quadruple points (109.47).
//!
//! # Discretisation
//! Faces at a border tilt against the true film by half the arc they span: angles between faces err by `O(h/R)`. Instead,
//!
//! 1. the tangent of a border is that of the parabola through a vertex and its two neighbours along the border (at a
//!    quadruple point through the vertex and the next two): error `O(h^2)`;
//! 2. the slope of each sheet is that of a [`quadric`] through the vertex, fitted to the sheet's first two
//!    rings: error `O(h^2)`;
//! 3. the conormal of a sheet lies in its tangent plane, across the tangent.
//!
//! On the exact double bubble the measured angles converge to 120 degrees at second order, as a test shows. Where a mesh is at rest
//! the first rings beside a border are off by a part of their sagitta, `O(h^2)` over a distance `h`: there these angles err by `O(h)`.
//! For films that are spheres [`border_angles_of_spheres`] takes the slope in step 2 from the sphere that fits the sheet within a
//! distance that does not shrink with `h`: error `O(h^2)` also at rest.
//!
//! # Limits
//! Measured at free vertices with exactly two border edges and three sheets; others have no angles here.

use glam::DVec3;

use super::borders::Borders;
use super::quadric;
use crate::rows::{FaceRow, Region, VertexRow};
use crate::surface::Surface;

/// The angle of a regular border, radians: 120 degrees.
pub const BORDER_ANGLE: f64 = std::f64::consts::TAU / 3.0;

/// The angle between borders at a regular quadruple point, radians: `arccos(-1/3)`, 109.47 degrees.
#[must_use]
pub fn quadruple_angle() -> f64 {
    (-1.0f64 / 3.0).acos()
}

/// Angles between three sheets at a vertex of a border.
#[derive(Clone, Debug, PartialEq)]
pub struct BorderAngles {
    /// The vertex.
    pub vertex: VertexRow,
    /// Length of border it stands for, m.
    pub length: f64,
    /// Angle between each two sheets, radians, and the region between them (the smaller label if they share two).
    pub angles: [(Region, f64); 3],
}

/// Angles between four borders at a quadruple point.
#[derive(Clone, Debug, PartialEq)]
pub struct QuadrupleAngles {
    /// The vertex.
    pub vertex: VertexRow,
    /// The angle between each two borders, radians.
    pub angles: [f64; 6],
}

/// How far a set of angles is from the regular one, radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Mean of the absolute deviation, weighted by length along borders.
    pub mean: f64,
    /// Largest angle minus the regular one.
    pub above: f64,
    /// Smallest angle minus the regular one.
    pub below: f64,
}

/// What the slope of a sheet at a border is taken from.
#[derive(Clone, Copy)]
enum Slope {
    /// The quadric through the vertex, fitted to two rings.
    Rings,
    /// The sphere that fits what lies within this distance, m.
    Sphere(f64),
}

impl Deviation {
    /// Of angles that were not measured: it is not a number.
    pub const UNKNOWN: Self = Self { mean: f64::NAN, above: f64::NAN, below: f64::NAN };
}

/// Angles along all borders.
#[must_use]
pub fn border_angles(surface: &Surface, borders: &Borders) -> Vec<BorderAngles> {
    borders.vertices().filter_map(|vertex| angles_at(surface, borders, vertex, Slope::Rings)).collect()
}

/// Angles along all borders between sheets that are spheres or planes, as they are within `reach` metres of each vertex: a distance over
/// which the sheets go on, and which is the same at all resolutions.
#[must_use]
pub fn border_angles_of_spheres(surface: &Surface, borders: &Borders, reach: f64) -> Vec<BorderAngles> {
    borders.vertices().filter_map(|vertex| angles_at(surface, borders, vertex, Slope::Sphere(reach))).collect()
}

/// Angles at all quadruple points whose four borders go on for two edges at least.
#[must_use]
pub fn quadruple_angles(surface: &Surface, borders: &Borders) -> Vec<QuadrupleAngles> {
    borders.quadruple_points().filter_map(|vertex| quadruple_angles_at(surface, borders, vertex)).collect()
}

/// Deviation of border angles from 120 degrees; `None` if there are none.
#[must_use]
pub fn border_deviation(measured: &[BorderAngles]) -> Option<Deviation> {
    deviation(measured.iter().flat_map(|at| at.angles.map(|(_, angle)| (angle - BORDER_ANGLE, at.length))))
}

/// Deviation of angles at quadruple points from 109.47 degrees; `None` if there are none.
#[must_use]
pub fn quadruple_deviation(measured: &[QuadrupleAngles]) -> Option<Deviation> {
    deviation(measured.iter().flat_map(|at| at.angles.map(|angle| (angle - quadruple_angle(), 1.0))))
}

/// Mean angle within a region, weighted by length of border, radians; not a number where there is none.
#[must_use]
pub fn mean_angle_within(measured: &[BorderAngles], region: Region) -> f64 {
    let parts = measured.iter().flat_map(|at| at.angles.map(|(within, angle)| (within, angle, at.length)));
    let parts = parts.filter(|(within, ..)| *within == region);
    let (sum, length) =
        parts.fold((0.0, 0.0), |(sum, whole), (_, angle, length)| (sum + angle * length, whole + length));
    sum / length
}

fn deviation(parts: impl Iterator<Item = (f64, f64)>) -> Option<Deviation> {
    let start = (0.0, 0.0, f64::NEG_INFINITY, f64::INFINITY);
    let (sum, weight, above, below) = parts.fold(start, |(sum, weight, above, below), (off, w)| {
        (sum + w * off.abs(), weight + w, f64::max(above, off), f64::min(below, off))
    });
    (weight > 0.0).then(|| Deviation { mean: sum / weight, above, below })
}

fn angles_at(surface: &Surface, borders: &Borders, vertex: VertexRow, slope: Slope) -> Option<BorderAngles> {
    let &[before, after] = borders.neighbours(vertex) else { return None };
    let sheets = borders.sheets_of(surface, vertex);
    if surface.pinned[vertex] || sheets.len() != 3 {
        return None;
    }
    let [x, p, q] = [vertex, before, after].map(|v| surface.positions[v]);
    let tangent = middle_tangent(p, x, q)?;
    let mut conormals = [DVec3::ZERO; 3];
    for (sheet, conormal) in sheets.iter().zip(&mut conormals) {
        *conormal = sheet_conormal(surface, borders, vertex, sheet, tangent, slope)?;
    }
    let angles = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
        let region = region_between(surface, sheets[i][0], sheets[j][0]);
        (region, angle_between(conormals[i], conormals[j]))
    });
    Some(BorderAngles { vertex, length: 0.5 * (x.distance(p) + x.distance(q)), angles })
}

fn region_between(surface: &Surface, a: FaceRow, b: FaceRow) -> Region {
    let other = surface.mesh.face(b);
    let mut labels = surface.mesh.face(a).labels();
    labels.sort_unstable();
    labels.into_iter().find(|label| other.borders(*label)).unwrap_or(labels[0])
}

/// Angle between two vectors, radians; good to the last digits near 0 and 180 degrees too.
#[must_use]
pub fn angle_between(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// Unit tangent at `x` of the parabola through `p`, `x` and `q`, parametrised by chord length.
fn middle_tangent(p: DVec3, x: DVec3, q: DVec3) -> Option<DVec3> {
    let (before, after) = (x.distance(p), q.distance(x));
    let slope = (q - x) * (before / after) + (x - p) * (after / before);
    slope.try_normalize()
}

/// Unit tangent at `x` of the parabola that goes on through `p` and `q`.
fn end_tangent(x: DVec3, p: DVec3, q: DVec3) -> Option<DVec3> {
    let first = p.distance(x);
    let both = first + q.distance(p);
    let slope = (p - x) * (both / first) - (q - x) * (first / both);
    slope.try_normalize()
}

/// Unit vector in the tangent plane of a sheet, across the border and into the sheet.
fn sheet_conormal(
    surface: &Surface,
    borders: &Borders,
    vertex: VertexRow,
    sheet: &[FaceRow],
    tangent: DVec3,
    slope: Slope,
) -> Option<DVec3> {
    let x = surface.positions[vertex];
    let ring = vertices_of(surface, sheet, vertex);
    let mean: DVec3 = ring.iter().map(|v| surface.positions[*v] - x).sum();
    let across = mean.reject_from(tangent).try_normalize()?;
    let up = tangent.cross(across);
    let (faces, reach) = match slope {
        Slope::Rings => (borders.with_next_ring(surface, sheet), f64::INFINITY),
        Slope::Sphere(reach) => (borders.within(surface, sheet, x, reach), reach),
    };
    let points: Vec<[f64; 3]> = vertices_of(surface, &faces, vertex)
        .into_iter()
        .map(|v| surface.positions[v] - x)
        .filter(|d| d.length() < reach)
        .map(|d| [d.dot(tangent), d.dot(across), d.dot(up)])
        .collect();
    let [_, slope] = match slope {
        Slope::Rings => quadric::slopes(&points)?,
        Slope::Sphere(_) => quadric::sphere_slopes(&points)?,
    };
    (across + up * slope).try_normalize()
}

fn vertices_of(surface: &Surface, faces: &[FaceRow], but: VertexRow) -> Vec<VertexRow> {
    let mut vertices: Vec<VertexRow> = faces.iter().flat_map(|face| surface.mesh.face(*face).vertices()).collect();
    vertices.sort_unstable();
    vertices.dedup();
    vertices.retain(|v| *v != but);
    vertices
}

fn quadruple_angles_at(surface: &Surface, borders: &Borders, vertex: VertexRow) -> Option<QuadrupleAngles> {
    let mut tangents = [DVec3::ZERO; 4];
    for (first, tangent) in borders.neighbours(vertex).iter().zip(&mut tangents) {
        let &[a, b] = borders.neighbours(*first) else { return None };
        let second = if a == vertex { b } else { a };
        *tangent = end_tangent(surface.positions[vertex], surface.positions[*first], surface.positions[second])?;
    }
    let pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
    let angles = pairs.map(|(i, j)| angle_between(tangents[i], tangents[j]));
    Some(QuadrupleAngles { vertex, angles })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calculus::test_shapes::double_bubble;
    use crate::surface::LabelledTriangles;

    fn worst(n: usize) -> f64 {
        let surface = double_bubble(1.0, 0.6, n);
        let found = border_deviation(&border_angles(&surface, &Borders::new(&surface))).unwrap();
        found.above.max(-found.below)
    }

    #[test]
    fn the_exact_double_bubble_measures_120_degrees_to_second_order() {
        let errors = [6, 12, 24].map(worst);
        assert!(errors[1] < 1f64.to_radians() && errors[2] < 0.25f64.to_radians(), "{errors:?}");
        assert!(errors[0] / errors[1] > 3.2 && errors[1] / errors[2] > 3.6, "{errors:?}");
    }

    #[test]
    fn spheres_within_a_distance_measure_the_exact_double_bubble_to_the_tangents_of_its_border() {
        let errors = [10, 20, 40].map(|n| {
            let surface = double_bubble(1.0, 0.6, n);
            let measured = border_angles_of_spheres(&surface, &Borders::new(&surface), 0.5);
            assert_eq!(measured.len(), 6 * n);
            let found = border_deviation(&measured).unwrap();
            found.above.max(-found.below)
        });
        assert!(errors.iter().all(|error| *error < 1e-9), "{errors:?}");
    }

    #[test]
    fn spheres_see_past_a_ring_that_is_off_by_a_part_of_its_sagitta() {
        let errors = [10, 20, 40].map(|n| {
            let mut surface = double_bubble(1.0, 0.6, n);
            let borders = Borders::new(&surface);
            let edge = 1.0 / n as f64;
            let beside: Vec<VertexRow> = borders.vertices().flat_map(|v| surface.mesh.neighbours(v)).collect();
            for v in beside.into_iter().filter(|v| borders.neighbours(*v).is_empty()) {
                surface.positions[v].z += 0.05 * edge * edge;
            }
            let found = border_deviation(&border_angles_of_spheres(&surface, &borders, 0.5)).unwrap();
            found.above.max(-found.below)
        });
        assert!(errors[2] < 0.1f64.to_radians(), "{errors:?}");
        assert!(errors[0] / errors[1] > 3.5 && errors[1] / errors[2] > 3.5, "{errors:?}");
    }

    #[test]
    fn angles_do_not_depend_on_the_unit_of_length() {
        let (one, tiny) = (double_bubble(1.0, 0.6, 6), double_bubble(1e-6, 0.6e-6, 6));
        let angles = [one, tiny].map(|s| border_deviation(&border_angles(&s, &Borders::new(&s))).unwrap());
        assert!((angles[0].above - angles[1].above).abs() < 1e-8);
    }

    /// Films from a point to the six edges of a tetrahedron, `n` faces a side.
    fn tetrahedral_cone(n: usize) -> Surface {
        let corners = [[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]].map(DVec3::from_array);
        let mut triangles = LabelledTriangles { open: vec![1, 2, 3], ..Default::default() };
        let mut rows: Vec<DVec3> = Vec::new();
        for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            let others: Vec<u32> = (0..4).filter(|k| *k != i as u32 && *k != j as u32).collect();
            let mut row = |a: usize, b: usize| {
                let place = (corners[i] * a as f64 + corners[j] * b as f64) / n as f64;
                rows.iter().position(|x| x.distance(place) < 1e-9).unwrap_or_else(|| {
                    rows.push(place);
                    triangles.add_vertex(place, a + b == n) as usize
                }) as u32
            };
            let mut faces = Vec::new();
            for a in 0..n {
                for b in 0..n - a {
                    faces.push([row(a, b), row(a + 1, b), row(a, b + 1)]);
                    if a + b + 1 < n {
                        faces.push([row(a + 1, b), row(a + 1, b + 1), row(a, b + 1)]);
                    }
                }
            }
            faces.into_iter().for_each(|face| triangles.add_film(face, [others[0], others[1]]));
        }
        Surface::from_triangles(&triangles)
    }

    #[test]
    fn the_cone_over_a_tetrahedron_has_regular_borders_and_a_regular_point() {
        let surface = tetrahedral_cone(4);
        let borders = Borders::new(&surface);
        let points = quadruple_deviation(&quadruple_angles(&surface, &borders)).unwrap();
        assert_eq!(borders.quadruple_points().count(), 1);
        assert!(points.above.abs() < 1e-12 && points.below.abs() < 1e-12, "{points:?}");
        let edges = border_deviation(&border_angles(&surface, &borders)).unwrap();
        assert!(edges.mean < 1e-12, "{edges:?}");
    }
}
