//! Meshes of known shape for the tests of this folder.

use super::triangles::FilmTriangles;
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Columns of a mesh.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub positions: Vec<DVec3>,
    pub values: Vec<f64>,
    pub triangles: Vec<[u32; 3]>,
    pub labels: Vec<[u32; 2]>,
    pub pinned: Vec<bool>,
}

impl Mesh {
    pub(super) fn film(&self) -> FilmTriangles<'_> {
        FilmTriangles {
            positions: &self.positions,
            values: &self.values,
            triangles: &self.triangles,
            labels: &self.labels,
            pinned: &self.pinned,
        }
    }

    fn add(&mut self, position: DVec3) -> u32 {
        self.positions.push(position);
        self.values.push(4e-7);
        self.positions.len() as u32 - 1
    }

    fn add_film(&mut self, triangle: [u32; 3], labels: [u32; 2]) {
        self.triangles.push(triangle);
        self.labels.push(labels);
    }
}

/// The unit sphere: an icosahedron, each triangle cut in four `cuts` times.
pub(super) fn sphere(cuts: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        for corner in [DVec3::new(0.0, a, b), DVec3::new(a, b, 0.0), DVec3::new(b, 0.0, a)] {
            mesh.add(corner.normalize());
        }
    }
    let edge = 2.0 / (golden * 5.0_f64.sqrt()).sqrt();
    let near = |a: u32, b: u32| (mesh.positions[a as usize].distance(mesh.positions[b as usize]) - edge).abs() < 1e-6;
    let all = (0..12).flat_map(|a| (a + 1..12).flat_map(move |b| (b + 1..12).map(move |c| [a, b, c])));
    mesh.triangles = all.filter(|&[a, b, c]| near(a, b) && near(b, c) && near(c, a)).collect();
    for triangle in &mut mesh.triangles {
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        if a.dot(b.cross(c)) < 0.0 {
            triangle.swap(1, 2);
        }
    }
    (0..cuts).for_each(|_| cut_in_four(&mut mesh));
    mesh.labels = vec![[1, 0]; mesh.triangles.len()];
    mesh
}

fn cut_in_four(mesh: &mut Mesh) {
    let mut middles = BTreeMap::new();
    let mut cut = Vec::new();
    for [a, b, c] in std::mem::take(&mut mesh.triangles) {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(a, b)| {
            let middle = (mesh.positions[a as usize] + mesh.positions[b as usize]).normalize();
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| mesh.add(middle))
        });
        cut.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    mesh.triangles = cut;
}

/// Two unit bubbles with centres at `x = -0.5` and `0.5` and their flat wall: an exact double bubble, `around` edges on
/// its border.
pub(super) fn double_bubble(around: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let border: Vec<u32> = (0..around).map(|k| mesh.add(ring(0.0, 0.75_f64.sqrt(), k, around))).collect();
    let rings = around / 3;
    for (side, labels) in [(-1.0, [1, 0]), (1.0, [2, 0])] {
        let place = |ring_number: u32, k| {
            let (sin, cos) = (PI / 3.0 + 2.0 * PI / 3.0 * f64::from(ring_number) / f64::from(rings)).sin_cos();
            ring(side * (0.5 - cos), sin, k, around)
        };
        close(&mut mesh, &border, rings, DVec3::X * 1.5 * side, place, |[a, b, c]| {
            (if side < 0.0 { [b, a, c] } else { [a, b, c] }, labels)
        });
    }
    let flat =
        |ring_number: u32, k| ring(0.0, 0.75_f64.sqrt() * (1.0 - f64::from(ring_number) / f64::from(rings)), k, around);
    close(&mut mesh, &border, rings, DVec3::ZERO, flat, |[a, b, c]| ([b, a, c], [2, 1]));
    mesh
}

fn ring(x: f64, radius: f64, k: u32, around: u32) -> DVec3 {
    let (sin, cos) = (TAU * f64::from(k) / f64::from(around)).sin_cos();
    DVec3::new(x, radius * cos, radius * sin)
}

/// Closes a ring of vertices by `rings - 1` more rings and a pole.
fn close(
    mesh: &mut Mesh,
    first: &[u32],
    rings: u32,
    pole: DVec3,
    place: impl Fn(u32, u32) -> DVec3,
    finish: impl Fn([u32; 3]) -> ([u32; 3], [u32; 2]),
) {
    let around = first.len();
    let mut last = first.to_vec();
    for number in 1..rings {
        let next: Vec<u32> = (0..around as u32).map(|k| mesh.add(place(number, k))).collect();
        for k in 0..around {
            let m = (k + 1) % around;
            for triangle in [[last[k], last[m], next[k]], [last[m], next[m], next[k]]] {
                let (triangle, labels) = finish(triangle);
                mesh.add_film(triangle, labels);
            }
        }
        last = next;
    }
    let pole = mesh.add(pole);
    for k in 0..around {
        let (triangle, labels) = finish([last[k], last[(k + 1) % around], pole]);
        mesh.add_film(triangle, labels);
    }
}

/// The square `z = 0`, `|x|, |y| <= 1`, as `cells` by `cells` squares of two triangles; its normal is z.
pub(super) fn grid(cells: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let place = |k: u32| 2.0 * f64::from(k) / f64::from(cells) - 1.0;
    for k in 0..(cells + 1) * (cells + 1) {
        mesh.add(DVec3::new(place(k % (cells + 1)), place(k / (cells + 1)), 0.0));
    }
    for (x, y) in (0..cells * cells).map(|cell| (cell % cells, cell / cells)) {
        let [a, b] = [y * (cells + 1) + x, (y + 1) * (cells + 1) + x];
        mesh.add_film([a, a + 1, b], [1, 0]);
        mesh.add_film([a + 1, b + 1, b], [1, 0]);
    }
    mesh
}
