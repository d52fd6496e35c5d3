//! Films with a held rim: a disc, a rectangle, a hexagon, a dome on a plate.
//!
//! A disc, a rectangle or a hexagon separates the outside, region 0, from a pocket of air behind it, region 1. The pocket is open: it has
//! no volume of its own. Ghosts close it, from the rim to one held vertex two radii behind the film, so that no motion of the
//! film comes near them. A dome encloses gas: region 1 is a bubble, and ghosts in the plane of the plate close it.

use glam::DVec3;

use super::rings::{Circle, add_cap, add_lid, add_ring, join_rows};
use super::wired::{WiredFilms, flat};
use crate::surface::LabelledTriangles;

/// A disc with its rim held (metres); its normal points into the outside.
#[must_use]
pub fn disc(centre: DVec3, radius: f64, normal: DVec3, edge: f64) -> LabelledTriangles {
    let circle = Circle::new(centre, normal, radius);
    let mut set = LabelledTriangles { open: vec![1], ..Default::default() };
    let rim = add_ring(&mut set, &circle, circle.vertices_for(edge), 0.0, true);
    add_cap(&mut set, &rim, &circle, 0.0, [1, 0], edge);
    close_behind(&mut set, &rim, centre - 2.0 * radius * circle.axis);
    set
}

/// A rectangle with its rim held (metres), `width` across and `height` along `up`; its normal points into the outside.
///
/// Rows of equilateral triangles, stretched to fit; the smallest angle is that of half a triangle at the ends of rows.
#[must_use]
pub fn rectangle(centre: DVec3, width: f64, height: f64, normal: DVec3, up: DVec3, edge: f64) -> LabelledTriangles {
    let normal = normal.normalize_or(DVec3::Z);
    let up = up.reject_from_normalized(normal).normalize_or(normal.any_orthonormal_vector());
    let across = up.cross(normal);
    let columns = ((width / edge).round() as usize).max(1);
    let rows = ((height / (0.75f64.sqrt() * edge)).round() as usize).max(2);
    let mut set = LabelledTriangles { open: vec![1], ..Default::default() };
    let lines: Vec<Vec<u32>> = (0..=rows)
        .map(|row| {
            let line = centre + height * (row as f64 / rows as f64 - 0.5) * up;
            let is_rim = row == 0 || row == rows;
            let steps = row_steps(columns, !row.is_multiple_of(2));
            let last = steps.len() - 1;
            let place = |step: &f64| line + width * (step / columns as f64 - 0.5) * across;
            let held = |k: usize| is_rim || k == 0 || k == last;
            steps.iter().enumerate().map(|(k, step)| set.add_vertex(place(step), held(k))).collect()
        })
        .collect();
    lines.windows(2).for_each(|pair| join_rows(&mut set, &pair[0], &pair[1], [1, 0]));
    let apex = centre - width.hypot(height) * normal;
    close_behind(&mut set, &rim_of(&lines), apex);
    set
}

/// A regular hexagon with its rim held (metres), a corner along `up`; its normal points into the outside.
#[must_use]
pub fn hexagon(centre: DVec3, radius: f64, normal: DVec3, up: DVec3, edge: f64) -> LabelledTriangles {
    let normal = normal.normalize_or(DVec3::Z);
    let up = up.reject_from_normalized(normal).normalize_or(normal.any_orthonormal_vector());
    let across = normal.cross(up);
    let mut films = WiredFilms::default();
    films.set.open = vec![1];
    let corner = |k: u32| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
        centre + radius * (cos * up + sin * across)
    };
    let rim: Vec<u32> = (0..6).map(|k| films.set.add_vertex(corner(k), true)).collect();
    let middle = films.set.add_vertex(centre, false);
    for (k, a) in rim.iter().enumerate() {
        let b = rim[(k + 1) % 6];
        films.add_wire(*a, b);
        films.set.add_film([*a, b, middle], [1, 0]);
    }
    close_behind(&mut films.set, &rim, centre - 2.0 * radius * normal);
    let frequency = ((radius / edge).round() as u32).max(1);
    films.subdivide(frequency, flat).set
}

/// A dome on a plate with its rim held: half a sphere over the plane through `centre` (metres), around a gas, region 1.
#[must_use]
pub fn half_sphere(centre: DVec3, radius: f64, up: DVec3, edge: f64) -> LabelledTriangles {
    let circle = Circle::new(centre, up, radius);
    let mut set = LabelledTriangles::default();
    let rim = add_ring(&mut set, &circle, circle.vertices_for(edge), 0.0, true);
    add_cap(&mut set, &rim, &circle, radius, [1, 0], edge);
    close_behind(&mut set, &rim, centre);
    set
}

/// Ghosts from a rim, counter-clockwise seen from the outside, to a vertex behind the film: under it is region 1.
fn close_behind(set: &mut LabelledTriangles, rim: &[u32], apex: DVec3) {
    add_lid(set, rim, apex, [0, 1]);
}

/// Places along a row, in steps: whole ones, or halves with both ends.
fn row_steps(columns: usize, is_between: bool) -> Vec<f64> {
    let whole = (0..=columns).map(|k| k as f64);
    if !is_between {
        return whole.collect();
    }
    let halves = (0..columns).map(|k| k as f64 + 0.5);
    std::iter::once(0.0).chain(halves).chain(std::iter::once(columns as f64)).collect()
}

/// The rim of rows, counter-clockwise where rows run to the right and follow each other upwards.
fn rim_of(lines: &[Vec<u32>]) -> Vec<u32> {
    let inner = 1..lines.len() - 1;
    let right = lines[inner.clone()].iter().map(|line| line[line.len() - 1]);
    let left = lines[inner].iter().rev().map(|line| line[0]);
    let top = lines[lines.len() - 1].iter().rev().copied();
    lines[0].iter().copied().chain(right).chain(top).chain(left).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::measure::{assert_second_order, checked, edge_lengths, smallest_angle};
    use std::f64::consts::PI;

    fn held_film_vertices(set: &LabelledTriangles) -> usize {
        set.pinned.iter().filter(|pinned| **pinned).count() - 1
    }

    #[test]
    fn a_hexagon_is_made_of_equilateral_triangles() {
        let set = hexagon(DVec3::X, 1.0, DVec3::Y, DVec3::Z, 0.1);
        let surface = checked(&set);
        assert!((surface.film_area() - 1.5 * 3.0_f64.sqrt()).abs() < 1e-12);
        assert!(smallest_angle(&set) > 59.0, "{}", smallest_angle(&set));
    }

    #[test]
    fn a_disc_holds_its_rim_and_no_more() {
        let normal = DVec3::new(1.0, 2.0, -1.0).normalize();
        let errors = [0.2, 0.1, 0.05].map(|edge| {
            let set = disc(DVec3::X, 1.0, normal, edge);
            assert!(smallest_angle(&set) > 30.0, "{}", smallest_angle(&set));
            assert!((edge_lengths(&set)[1] / edge - 1.0).abs() < 0.05);
            assert_eq!(held_film_vertices(&set), (2.0 * PI / edge).round() as usize);
            let surface = checked(&set);
            assert!(surface.is_open(crate::Region(1)));
            let facing = |(row, _): (crate::FaceRow, &crate::Face)| {
                let [back, _] = surface.mesh.face(row).labels();
                let side = if back.0 == 1 { 1.0 } else { -1.0 };
                side * surface.double_area_normal(row).dot(normal) > 0.0
            };
            assert!(surface.mesh.faces().filter(|(_, f)| !f.is_ghost()).all(facing), "normals point into the outside");
            surface.film_area() / PI - 1.0
        });
        assert_second_order(errors);
    }

    #[test]
    fn a_rectangle_has_its_area_and_no_slivers() {
        for (width, height, edge) in [(1.0, 1.0, 0.1), (3.0, 0.7, 0.2), (0.2, 1.0, 0.07), (1.0, 0.3, 0.5)] {
            let set = rectangle(DVec3::ONE, width, height, DVec3::Y, DVec3::new(0.3, 0.1, 1.0), edge);
            let surface = checked(&set);
            assert!((surface.film_area() - width * height).abs() < 1e-12);
            assert!(smallest_angle(&set) > 25.0, "{}", smallest_angle(&set));
            let rows = ((height / (0.75f64.sqrt() * edge)).round() as usize).max(2);
            let columns = ((width / edge).round() as usize).max(1);
            assert!(
                (held_film_vertices(&set) as i64 - 2 * (rows + columns) as i64).abs() <= 1,
                "an odd last row has one more"
            );
        }
    }

    #[test]
    fn a_dome_holds_gas_over_a_plate() {
        let errors = [0.2, 0.1, 0.05].map(|edge| {
            let set = half_sphere(DVec3::Y, 1.0, DVec3::Z, edge);
            assert!(smallest_angle(&set) > 30.0);
            let surface = checked(&set);
            assert!(!surface.is_open(crate::Region(1)));
            assert!(set.positions.iter().all(|x| x.z > -1e-15));
            [surface.volumes()[1] / (2.0 * PI / 3.0) - 1.0, surface.film_area() / (2.0 * PI) - 1.0]
        });
        assert_second_order(errors.map(|e| e[0]));
        assert_second_order(errors.map(|e| e[1]));
    }
}
