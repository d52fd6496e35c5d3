//! Spheres of radius 1 on regular and irregular meshes, their modes and exact frequencies.

use froth_surface::shapes::flips::turn_edges;
use froth_surface::shapes::icosphere;
use froth_surface::shapes::random::Random;
use froth_surface::{LabelledTriangles, Surface};
use glam::DVec3;

/// How far vertices of an uneven sphere are moved, in edges: leaves angles down to about 26 degrees.
const UNEVENNESS: f64 = 0.20;

/// An icosphere of `10 f^2 + 2` vertices, region 1.
pub fn even_sphere(frequency: usize) -> LabelledTriangles {
    let set = icosphere(DVec3::ZERO, 1.0, edge_of(frequency));
    assert_eq!(set.positions.len(), 10 * frequency * frequency + 2);
    set
}

/// A sphere of as many vertices that no symmetry orders: those of the icosphere moved about at random, edges turned until
/// the triangulation is that of Delaunay.
pub fn uneven_sphere(frequency: usize, seed: u64) -> LabelledTriangles {
    let mut set = even_sphere(frequency);
    let (mut dice, reach) = (Random::new(seed), UNEVENNESS * edge_of(frequency));
    for x in &mut set.positions {
        let way = DVec3::from(std::array::from_fn(|_| dice.next_signed()));
        *x = (*x + reach * way.reject_from(*x)).normalize();
    }
    turn_edges(&mut set);
    set
}

/// An edge that gives an icosahedron this frequency: that of `20 f^2` equilateral triangles that cover the sphere.
fn edge_of(frequency: usize) -> f64 {
    (16.0 * std::f64::consts::PI / (20.0 * 3f64.sqrt())).sqrt() / frequency as f64
}

/// Smallest angle of all faces, degrees.
pub fn smallest_angle(set: &LabelledTriangles) -> f64 {
    let surface = Surface::from_triangles(set);
    let angle = |row| {
        let [a, b, c] = surface.corners(row);
        [(a, b, c), (b, c, a), (c, a, b)]
            .map(|(at, p, q)| (p - at).angle_between(q - at))
            .into_iter()
            .fold(4.0, f64::min)
    };
    surface.mesh.faces().map(|(row, _)| angle(row)).fold(4.0, f64::min).to_degrees()
}

/// Zonal harmonic of degree `l` at a direction with this `z`, not normalised.
pub fn legendre(l: usize, z: f64) -> f64 {
    let (mut before, mut now) = (1.0, z);
    if l == 0 {
        return 1.0;
    }
    for n in 1..l {
        (before, now) = (now, ((2 * n + 1) as f64 * z * now - n as f64 * before) / (n + 1) as f64);
    }
    now
}

/// Angular frequency of the mode of degree `n` of a bubble with R = rho = T = 1 in its own gas.
///
/// `omega^2 = n(n-1)(n+1)(n+2) T / ((2n+1) rho R^3)` with `T = 2 sigma` (Lamb 1932, §275, with air on both sides).
pub fn exact_frequency(n: usize) -> f64 {
    let n = n as f64;
    (n * (n - 1.0) * (n + 1.0) * (n + 2.0) / (2.0 * n + 1.0)).sqrt()
}
