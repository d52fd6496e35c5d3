//! Small meshes for tests: sphere, double bubble, disc, catenoid.

use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

use crate::surface::{LabelledTriangles, Surface};

/// A sphere around the origin, region 1: an icosahedron whose faces are split in four `levels` times.
pub(crate) fn icosphere(radius: f64, levels: u32) -> Surface {
    let phi = f64::midpoint(1.0, 5f64.sqrt());
    let mut points: Vec<DVec3> = Vec::new();
    for (s, t) in [(-1.0, phi), (1.0, phi), (-1.0, -phi), (1.0, -phi)] {
        points.push(DVec3::new(s, t, 0.0));
    }
    for (s, t) in [(-1.0, phi), (1.0, phi), (-1.0, -phi), (1.0, -phi)] {
        points.push(DVec3::new(0.0, s, t));
    }
    for (s, t) in [(-1.0, phi), (1.0, phi), (-1.0, -phi), (1.0, -phi)] {
        points.push(DVec3::new(t, 0.0, s));
    }
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for a in 0..12_usize {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let near = |i: usize, j: usize| points[i].distance(points[j]) < 2.1;
                if near(a, b) && near(b, c) && near(a, c) {
                    let normal = (points[b] - points[a]).cross(points[c] - points[a]);
                    let outwards = normal.dot(points[a]) > 0.0;
                    faces.push(if outwards { [a, b, c] } else { [a, c, b] }.map(|v| v as u32));
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = BTreeMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let [d, e, f] = [(a, b), (b, c), (c, a)].map(|(i, j)| {
                *middles.entry([i.min(j), i.max(j)]).or_insert_with(|| {
                    points.push((points[i as usize].normalize() + points[j as usize].normalize()).normalize());
                    points.len() as u32 - 1
                })
            });
            finer.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
        }
        faces = finer;
    }
    let mut triangles = LabelledTriangles::default();
    for p in points {
        triangles.add_vertex(p.normalize() * radius, false);
    }
    faces.into_iter().for_each(|face| triangles.add_film(face, [1, 0]));
    Surface::from_triangles(&triangles)
}

/// A disc of `6 k` points on ring `k`, all but the outermost ring new: `place(k / n, angle)`; its triangles turn with the angle.
fn add_disc(triangles: &mut LabelledTriangles, rim: &[u32], labels: [u32; 2], place: impl Fn(f64, f64) -> DVec3) {
    let n = rim.len() / 6;
    let mut rings: Vec<Vec<u32>> = Vec::new();
    for k in 0..n {
        let count = (6 * k).max(1);
        let angle = |j: usize| TAU * j as f64 / count as f64;
        rings.push((0..count).map(|j| triangles.add_vertex(place(k as f64 / n as f64, angle(j)), false)).collect());
    }
    rings.push(rim.to_vec());
    for k in 1..=n {
        let (inner, outer) = (&rings[k - 1], &rings[k]);
        for sector in 0..6 {
            for j in 0..k {
                let out = |j: usize| outer[(sector * k + j) % outer.len()];
                let inn = |j: usize| inner[(sector * (k - 1) + j) % inner.len()];
                triangles.add_film([out(j), out(j + 1), inn(j)], labels);
                if j + 1 < k {
                    triangles.add_film([inn(j), out(j + 1), inn(j + 1)], labels);
                }
            }
        }
    }
}

fn add_rim(triangles: &mut LabelledTriangles, radius: f64, n: usize, pinned: bool) -> Vec<u32> {
    let place =
        |j: usize| DVec3::new((TAU * j as f64 / (6 * n) as f64).cos(), (TAU * j as f64 / (6 * n) as f64).sin(), 0.0);
    (0..6 * n).map(|j| triangles.add_vertex(place(j) * radius, pinned)).collect()
}

/// A flat disc in the plane z = 0 with its rim held, between the outside and the open region 1.
pub(crate) fn flat_disc(radius: f64, n: usize) -> Surface {
    let mut triangles = LabelledTriangles { open: vec![1], ..Default::default() };
    let rim = add_rim(&mut triangles, radius, n, true);
    add_disc(&mut triangles, &rim, [1, 0], |k, angle| DVec3::new(angle.cos(), angle.sin(), 0.0) * (k * radius));
    Surface::from_triangles(&triangles)
}

/// The exact double bubble with outer radii `r1 >= r2` (regions 1 and 2), its ring in the plane z = 0, bubble 2 above.
pub(crate) fn double_bubble(r1: f64, r2: f64, n: usize) -> Surface {
    let c = (r1 * r1 + r2 * r2 - r1 * r2).sqrt();
    let ring = 0.75f64.sqrt() * r1 * r2 / c;
    let mut triangles = LabelledTriangles::default();
    let rim = add_rim(&mut triangles, ring, n, false);
    // Heights of the centres: the ring lies on both spheres, and the angle between their normals there is 60 degrees.
    let z1 = -(r1 - 0.5 * r2) * r1 / c;
    let z2 = (r2 - 0.5 * r1) * r2 / c;
    cap(&mut triangles, &rim, [0, 1], r1, z1, -1.0);
    cap(&mut triangles, &rim, [2, 0], r2, z2, 1.0);
    if (r1 - r2).abs() < 1e-9 * r1 {
        add_disc(&mut triangles, &rim, [1, 2], |k, angle| DVec3::new(angle.cos(), angle.sin(), 0.0) * (k * ring));
    } else {
        let rp = r1 * r2 / (r1 - r2);
        let zp = (rp * rp - ring * ring).sqrt();
        cap(&mut triangles, &rim, [1, 2], rp, zp, -1.0);
    }
    Surface::from_triangles(&triangles)
}

/// A cap of the sphere of radius `r` around `(0, 0, z)`, from the ring in z = 0 to the pole on side `pole`.
fn cap(triangles: &mut LabelledTriangles, rim: &[u32], labels: [u32; 2], r: f64, z: f64, pole: f64) {
    let ring = triangles.positions[rim[0] as usize].x;
    let reach = ring.atan2(-z * pole);
    add_disc(triangles, rim, labels, |k, angle| {
        let theta = reach * k;
        DVec3::new(r * theta.sin() * angle.cos(), r * theta.sin() * angle.sin(), z + pole * r * theta.cos())
    });
}

/// A film between two rings of the given radius at `z = -h` and `z = h`, at first a cylinder; `n` points around.
pub(crate) fn tube(radius: f64, h: f64, n: usize, rows: usize) -> Surface {
    let mut triangles = LabelledTriangles { open: vec![1], ..Default::default() };
    for row in 0..=rows {
        for j in 0..n {
            let angle = TAU * (j as f64 + 0.5 * (row % 2) as f64) / n as f64;
            let z = h * (2.0 * row as f64 / rows as f64 - 1.0);
            triangles.add_vertex(DVec3::new(radius * angle.cos(), radius * angle.sin(), z), row == 0 || row == rows);
        }
    }
    let at = |row: usize, j: usize| (row * n + j % n) as u32;
    for row in 0..rows {
        for j in 0..n {
            let (a, b, c, d) = (at(row, j), at(row, j + 1), at(row + 1, j), at(row + 1, j + 1));
            let split = if row % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, b, d], [a, d, c]] };
            split.into_iter().for_each(|t| triangles.add_film(t, [1, 0]));
        }
    }
    Surface::from_triangles(&triangles)
}

/// The surface with every free vertex moved by up to `amount`, always the same way.
pub(crate) fn shaken(surface: &Surface, amount: f64) -> Surface {
    let mut moved = surface.clone();
    for v in surface.mesh.vertices().filter(|v| !surface.pinned[*v]) {
        let s = f64::from(v.0);
        moved.positions[v] += amount * DVec3::new((1.3 * s).sin(), (2.1 * s + 1.0).sin(), (3.7 * s + 2.0).sin());
    }
    moved
}

/// Area of the exact double bubble.
pub(crate) fn double_bubble_area(r1: f64, r2: f64) -> f64 {
    let c = (r1 * r1 + r2 * r2 - r1 * r2).sqrt();
    let ring = 0.75f64.sqrt() * r1 * r2 / c;
    let outer = |r: f64, z: f64| TAU * r * (r + z);
    let caps = outer(r1, (r1 - 0.5 * r2) * r1 / c) + outer(r2, (r2 - 0.5 * r1) * r2 / c);
    let wall = if r1 - r2 < 1e-9 * r1 {
        0.5 * TAU * ring * ring
    } else {
        let rp = r1 * r2 / (r1 - r2);
        TAU * rp * (rp - (rp * rp - ring * ring).sqrt())
    };
    caps + wall
}
