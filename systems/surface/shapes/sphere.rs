//! Spheres, ellipsoids, and separate spheres in a grid.

use glam::DVec3;

use super::wired::WiredFilms;
use crate::surface::LabelledTriangles;

/// Golden ratio.
const PHI: f64 = 1.618_033_988_749_895;
/// Faces of an icosahedron whose corners are the cyclic permutations of `(0, +-1, +-PHI)`.
const ICOSAHEDRON: [[u32; 3]; 20] = [
    [0, 11, 5],
    [0, 5, 1],
    [0, 1, 7],
    [0, 7, 10],
    [0, 10, 11],
    [1, 5, 9],
    [5, 11, 4],
    [11, 10, 2],
    [10, 7, 6],
    [7, 1, 8],
    [3, 9, 4],
    [3, 4, 2],
    [3, 2, 6],
    [3, 6, 8],
    [3, 8, 9],
    [4, 9, 5],
    [2, 4, 11],
    [6, 2, 10],
    [8, 6, 7],
    [9, 8, 1],
];

/// A sphere, region 1: an icosahedron of a frequency that fits `edge`, with vertices exactly on the sphere (metres).
///
/// `10 f^2 + 2` vertices; edges of the icosahedron become great arcs in equal steps, points inside are weighted likewise.
#[must_use]
pub fn icosphere(centre: DVec3, radius: f64, edge: f64) -> LabelledTriangles {
    let mut set = unit_sphere(edge / radius);
    set.positions.iter_mut().for_each(|x| *x = centre + radius * *x);
    set
}

/// An ellipsoid along the axes, region 1: the image of a sphere, so that no edge is longer than one of the largest radius.
#[must_use]
pub fn ellipsoid(centre: DVec3, radii: DVec3, edge: f64) -> LabelledTriangles {
    let mut set = unit_sphere(edge / radii.max_element());
    set.positions.iter_mut().for_each(|x| *x = centre + radii * *x);
    set
}

/// Separate spheres in a grid about the origin, `gap` apart (metres); regions from 1, along x first, then y, then z.
#[must_use]
pub fn sphere_lattice(counts: [usize; 3], radius: f64, gap: f64, edge: f64) -> LabelledTriangles {
    let step = 2.0f64.mul_add(radius, gap);
    let mut set = LabelledTriangles::default();
    for (k, j, i) in grid(counts) {
        let along = |place: usize, count: usize| step * (place as f64 - 0.5 * (count as f64 - 1.0));
        let centre = DVec3::new(along(i, counts[0]), along(j, counts[1]), along(k, counts[2]));
        set.append(&icosphere(centre, radius, edge));
    }
    set
}

/// Places of a grid, the last index fastest.
fn grid([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (k, j, i))))
}

fn unit_sphere(edge: f64) -> LabelledTriangles {
    let mut set = LabelledTriangles::default();
    let corners = [[-1.0, PHI, 0.0], [1.0, PHI, 0.0], [-1.0, -PHI, 0.0], [1.0, -PHI, 0.0]];
    for turn in 0..3 {
        for [x, y, z] in corners {
            // Cyclic: (x, y, 0), (0, x, y), (y, 0, x).
            let place = [DVec3::new(x, y, z), DVec3::new(z, x, y), DVec3::new(y, z, x)][turn];
            set.add_vertex(place.normalize(), false);
        }
    }
    ICOSAHEDRON.iter().for_each(|triangle| set.add_film(*triangle, [1, 0]));
    let angle = set.positions[0].angle_between(set.positions[1]);
    let round = |corners: [DVec3; 3], weights: [f64; 3], _: &[u32]| {
        let parts: [DVec3; 3] = std::array::from_fn(|k| (weights[k] * angle).sin() * corners[k]);
        (parts[0] + parts[1] + parts[2]).normalize()
    };
    // Average edge of 20 f^2 nearly equilateral triangles that cover the sphere.
    let coarse = (16.0 * std::f64::consts::PI / (20.0 * 3f64.sqrt())).sqrt();
    WiredFilms::new(set).subdivide(((coarse / edge).round() as u32).max(1), round).set
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::measure::{assert_second_order, checked, edge_lengths, smallest_angle};
    use std::f64::consts::PI;

    #[test]
    fn a_sphere_has_edges_of_the_length_asked_for() {
        for edge in [0.5, 0.21, 0.1, 0.063] {
            let set = icosphere(DVec3::new(3.0, 1.0, -2.0), 2.0, 2.0 * edge);
            checked(&set);
            let [shortest, mean, longest] = edge_lengths(&set);
            assert!((mean / (2.0 * edge) - 1.0).abs() < 0.2, "{mean}");
            assert!(longest / shortest < 1.3, "{longest} / {shortest}");
            assert!(smallest_angle(&set) > 50.0, "{}", smallest_angle(&set));
        }
    }

    #[test]
    fn volume_and_area_of_a_sphere_converge_at_second_order() {
        let errors = [0.2, 0.1, 0.05].map(|edge| {
            let surface = checked(&icosphere(DVec3::X, 1.0, edge));
            [surface.volumes()[1] / (4.0 * PI / 3.0) - 1.0, surface.film_area() / (4.0 * PI) - 1.0]
        });
        assert_second_order(errors.map(|e| e[0]));
        assert_second_order(errors.map(|e| e[1]));
        assert!(errors[2][0].abs() < 1e-3, "{errors:?}");
    }

    #[test]
    fn an_ellipsoid_has_the_volume_of_its_radii() {
        let errors = [0.2, 0.1, 0.05].map(|edge| {
            let surface = checked(&ellipsoid(DVec3::Y, DVec3::new(1.0, 0.7, 0.5), edge));
            surface.volumes()[1] / (4.0 * PI / 3.0 * 0.35) - 1.0
        });
        assert_second_order(errors);
    }

    #[test]
    fn spheres_in_a_grid_are_apart_and_numbered_along_x_first() {
        let surface = checked(&sphere_lattice([2, 1, 3], 1.0, 0.04, 0.3));
        assert_eq!(surface.volumes().len(), 7);
        let first_of = |region: u32| {
            let mut faces = surface.mesh.faces().filter(|(_, f)| f.borders(crate::Region(region)));
            surface.corners(faces.next().expect("has faces").0)[0]
        };
        assert!(first_of(1).x < 0.0 && first_of(2).x > 0.0 && first_of(1).z < -1.0 && first_of(6).z > 1.0);
    }
}
