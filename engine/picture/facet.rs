//! Turns each triangle of a film into a facet on the picture, and tells what it covers of a sample.
//!
//! Equation: with the edge functions `Eᵢ(p) = (b - a) × (p - a)` of the edge opposite to corner `i`, a place is inside where all
//! are positive, and `Eᵢ / ΣE` are its weights. Values and normals are interpolated with weights over depth, which is exact
//! in perspective. Corners are rounded to 1/256 of a sample, so that edge functions are exact integers and neighbours
//! share every place of their common edge out among them: no gaps, no doubles.
//! Source: Pineda 1988. Limits: triangles that reach behind the eye, or farther than a million samples, are not drawn.

use super::camera::View;
use super::film_network::FilmNetwork;
use super::subsamples::{Mask, REACH, STEPS, WHOLE, mask, middle};
use super::tiles::Flat;
use super::triangles::FilmTriangles;
use glam::{DVec3, Vec2, Vec3};

/// Farthest corner that is drawn, samples: products of two coordinates in steps stay far within 64 bits.
pub(super) const FARTHEST: f64 = 1_048_576.0;

/// A triangle as drawn, in steps and camera axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    /// Corners, steps, in the order that makes the area positive.
    corners: [[i32; 2]; 3],
    /// One over the sum of the edge functions.
    per_area: f64,
    /// Per corner: one over the depth, 1/m.
    nearness: [f32; 3],
    values: [f32; 3],
    /// Normals in camera axes, turned to the eye's side of the film.
    normals: [Vec3; 3],
    /// Number of the film.
    pub film: u32,
    /// Whether the film's own normal points to the eye.
    pub faces_eye: bool,
}

/// What a shape shows in the part of a sample that it covers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fragment {
    pub mask: Mask,
    pub value: f32,
    /// Normal in camera axes, any length.
    pub normal: Vec3,
    /// How much the normal of a line changes from the middle of the sample to its edge; zero for films.
    pub spread: Vec3,
    /// Distance along the view, metres.
    pub depth: f32,
}

/// A point in samples, rounded to steps; `None` for one behind the eye or too far off.
pub(super) fn projected(view: &View, placed: DVec3) -> Option<[f64; 2]> {
    let (x, y) = view.project(placed);
    (placed.z < 0.0 && x.abs() < FARTHEST && y.abs() < FARTHEST).then_some([x, y])
}

/// Whether the box around some points meets the picture.
pub(super) fn meets_picture(view: &View, low: Vec2, high: Vec2) -> bool {
    high.cmpge(Vec2::ZERO).all() && low.cmple(Vec2::new(view.width as f32, view.height as f32)).all()
}

/// The facet of one triangle; nothing if it lies outside the picture or is seen exactly edge-on.
pub(super) fn facet_of_triangle(view: &View, mesh: &FilmTriangles, network: &FilmNetwork, row: usize) -> Option<Facet> {
    let vertices = mesh.triangles[row].map(|vertex| vertex as usize);
    let placed = vertices.map(|vertex| view.place(mesh.positions[vertex]));
    let mut corners = [[0; 2]; 3];
    for (corner, placed) in corners.iter_mut().zip(placed) {
        *corner = projected(view, placed)?.map(|x| (x * STEPS as f64).round() as i32);
    }
    let area = cross(corners[0], corners[1], corners[2]);
    if area == 0 {
        return None;
    }
    // Rows run downwards: an area below zero is counter-clockwise to the eye.
    let [back, front] = mesh.labels[row];
    let faces_eye = (area < 0) == (back >= front);
    let turned = if faces_eye { 1.0 } else { -1.0 };
    let normals = network.normals[row].map(|normal| (turned * view.turn(normal)).as_vec3());
    let order = if area > 0 { [0, 1, 2] } else { [0, 2, 1] };
    let facet = Facet {
        corners: order.map(|k| corners[k]),
        per_area: 1.0 / area.unsigned_abs() as f64,
        nearness: order.map(|k| (-1.0 / placed[k].z) as f32),
        values: order.map(|k| mesh.values[vertices[k]] as f32),
        normals: order.map(|k| normals[k]),
        film: network.films[row],
        faces_eye,
    };
    let (low, high) = facet.bounds();
    meets_picture(view, low, high).then_some(facet)
}

/// Twice the signed area of a triangle, square steps.
fn cross([ax, ay]: [i32; 2], [bx, by]: [i32; 2], [cx, cy]: [i32; 2]) -> i64 {
    i64::from(bx - ax) * i64::from(cy - ay) - i64::from(by - ay) * i64::from(cx - ax)
}

impl Flat for Facet {
    fn bounds(&self) -> (Vec2, Vec2) {
        let corners = self.corners.map(|[x, y]| Vec2::new(x as f32, y as f32) / STEPS as f32);
        let [a, b, c] = corners;
        (a.min(b).min(c), a.max(b).max(c))
    }
}

impl Facet {
    /// What the facet shows in a sample of the picture.
    #[inline]
    pub(super) fn fragment(&self, column: usize, row: usize) -> Option<Fragment> {
        let half = STEPS as i32 / 2;
        let centre = [column as i32 * STEPS as i32 + half, row as i32 * STEPS as i32 + half];
        let edges = [0, 1, 2].map(|k| Edge::new(self.corners[(k + 1) % 3], self.corners[(k + 2) % 3], centre));
        let mask = covered(&edges)?;
        let off = middle(mask).as_dvec2() * STEPS as f64;
        let weights = [0, 1, 2].map(|k| {
            let [along_x, along_y] = edges[k].along;
            let function = edges[k].at_centre as f64 + along_x as f64 * off.y - along_y as f64 * off.x;
            (function * self.per_area) as f32 * self.nearness[k]
        });
        let nearness: f32 = weights.iter().sum();
        let [a, b, c] = weights.map(|weight| weight / nearness);
        let value = a * self.values[0] + b * self.values[1] + c * self.values[2];
        let normal = a * self.normals[0] + b * self.normals[1] + c * self.normals[2];
        Some(Fragment { mask, value, normal, spread: Vec3::ZERO, depth: nearness.recip() })
    }
}

/// An edge function around the centre of a sample.
#[derive(Clone, Copy)]
struct Edge {
    along: [i64; 2],
    at_centre: i64,
    /// Least value that is inside: a place on the edge belongs to one of its two sides.
    least: i64,
}

impl Edge {
    #[inline]
    fn new(from: [i32; 2], to: [i32; 2], centre: [i32; 2]) -> Self {
        let along = [i64::from(to[0] - from[0]), i64::from(to[1] - from[1])];
        let owns = along[1] < 0 || (along[1] == 0 && along[0] > 0);
        Self { along, at_centre: cross(from, to, centre), least: i64::from(!owns) }
    }

    /// Most that the function changes between the centre and a place of the sample.
    #[inline]
    fn reach(&self) -> i64 {
        REACH * (self.along[0].abs() + self.along[1].abs())
    }

    #[inline]
    fn has(&self, [x, y]: [i64; 2]) -> bool {
        self.at_centre + self.along[0] * y - self.along[1] * x >= self.least
    }
}

/// The places of a sample inside three edges; `None` if there are none.
#[inline]
fn covered(edges: &[Edge; 3]) -> Option<Mask> {
    if edges.iter().any(|edge| edge.at_centre + edge.reach() < edge.least) {
        return None;
    }
    if edges.iter().all(|edge| edge.at_centre - edge.reach() >= edge.least) {
        return Some(WHOLE);
    }
    let mask = mask(|offset| edges.iter().all(|edge| edge.has(offset)));
    (mask != 0).then_some(mask)
}

#[cfg(test)]
mod tests {
    use super::facet_of_triangle;
    use crate::picture::camera::{Camera, View};
    use crate::picture::film_network::FilmNetwork;
    use crate::picture::subsamples::WHOLE;
    use crate::picture::test_meshes::{Mesh, grid, sphere};
    use glam::DVec3;

    const EDGE: usize = 60;

    fn view(field_of_view: f64) -> View {
        let position = DVec3::new(0.03, -0.05, 4.0);
        let camera = Camera { position, target: DVec3::ZERO, up: DVec3::new(0.2, 1.0, 0.0), field_of_view };
        camera.view(EDGE as f64, EDGE as f64).unwrap()
    }

    fn facets(view: &View, mesh: &Mesh) -> Vec<super::Facet> {
        let network = FilmNetwork::new(&mesh.film());
        (0..mesh.triangles.len()).filter_map(|row| facet_of_triangle(view, &mesh.film(), &network, row)).collect()
    }

    #[test]
    fn neighbours_share_every_place_out_among_them() {
        let facets = facets(&view(20.0), &grid(13));
        for (column, row) in (0..EDGE * EDGE).map(|sample| (sample % EDGE, sample / EDGE)) {
            let mut union = 0;
            for fragment in facets.iter().filter_map(|facet| facet.fragment(column, row)) {
                assert_eq!(union & fragment.mask, 0, "doubled at {column}, {row}");
                union |= fragment.mask;
            }
            assert_eq!(union, WHOLE, "a gap at {column}, {row}");
        }
    }

    #[test]
    fn half_of_a_sphere_faces_the_eye() {
        let facets = facets(&view(40.0), &sphere(3));
        let facing = facets.iter().filter(|facet| facet.faces_eye).count();
        // sin⁻¹(1/4) of the front is hidden behind the horizon.
        assert!((0.36..0.4).contains(&(facing as f64 / facets.len() as f64)), "{facing} of {}", facets.len());
        assert!(facets.iter().all(|facet| facet.normals.iter().map(|n| n.z).sum::<f32>() > -0.9));
    }

    #[test]
    fn a_linear_field_on_a_tilted_plane_is_drawn_as_it_is() {
        let mut mesh = grid(3);
        mesh.positions.iter_mut().for_each(|p| p.z = 0.9 * p.x);
        mesh.values = mesh.positions.iter().map(|p| 2.0 + p.x - 0.5 * p.y).collect();
        let view = view(40.0);
        for facet in facets(&view, &mesh) {
            for (column, row) in (0..EDGE * EDGE).map(|sample| (sample % EDGE, sample / EDGE)) {
                let Some(fragment) = facet.fragment(column, row).filter(|fragment| fragment.mask == WHOLE) else {
                    continue;
                };
                let ray = view.ray(column as f32 + 0.5, row as f32 + 0.5).as_dvec3();
                let ahead = ray / -ray.z * f64::from(fragment.depth);
                let place = view.position + ahead.x * view.right + ahead.y * view.up + ahead.z * view.back;
                let expected = 2.0 + place.x - 0.5 * place.y;
                assert!((place.z - 0.9 * place.x).abs() < 1e-3 && (f64::from(fragment.value) - expected).abs() < 1e-3);
            }
        }
    }
}
