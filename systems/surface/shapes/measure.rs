//! Measures of generated films, for the tests of generators.

use glam::DVec3;

use crate::invariants::{check_combinatorial, check_volumes};
use crate::rows::{Region, VertexRow};
use crate::surface::{LabelledTriangles, Surface};

fn films(set: &LabelledTriangles) -> impl Iterator<Item = [DVec3; 3]> {
    let films = set.triangles.iter().zip(&set.ghosts).filter(|(_, ghost)| !**ghost);
    films.map(|(t, _)| t.map(|v| set.positions[v as usize]))
}

/// Smallest angle of the films, degrees.
pub(crate) fn smallest_angle(set: &LabelledTriangles) -> f64 {
    let angle = |[a, b, c]: [DVec3; 3]| (b - a).angle_between(c - a).to_degrees();
    films(set).flat_map(|[a, b, c]| [[a, b, c], [b, c, a], [c, a, b]]).map(angle).fold(180.0, f64::min)
}

/// Shortest, average and longest edge of the films, metres.
pub(crate) fn edge_lengths(set: &LabelledTriangles) -> [f64; 3] {
    let lengths: Vec<f64> = films(set).flat_map(|[a, b, c]| [a.distance(b), b.distance(c), c.distance(a)]).collect();
    let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
    [lengths.iter().copied().fold(f64::MAX, f64::min), mean, lengths.iter().copied().fold(0.0, f64::max)]
}

/// The surface of a set, after all checks.
#[track_caller]
pub(crate) fn checked(set: &LabelledTriangles) -> Surface {
    let surface = Surface::from_triangles(set);
    assert_eq!(check_combinatorial(&surface), Ok(()));
    assert_eq!(check_volumes(&surface), Ok(()));
    assert!((0..set.positions.len() as u32).all(|v| surface.mesh.has_vertex(VertexRow(v))), "a vertex has no face");
    let all: Vec<Region> = (0..set.region_count()).map(Region).collect();
    assert_eq!(surface.mesh.regions(), all, "labels have gaps");
    surface
}

/// Number of edges with so many faces, ghosts counted.
pub(crate) fn edges_with(surface: &Surface, faces: usize) -> usize {
    surface.mesh.edges().iter().filter(|[a, b]| surface.mesh.faces_of_edge(*a, *b).len() == faces).count()
}

/// Asserts that errors at edges `h`, `h / 2`, `h / 4` fall at second order.
#[track_caller]
pub(crate) fn assert_second_order(errors: [f64; 3]) {
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).abs().log2();
        assert!((1.6..2.5).contains(&order), "order {order} of {errors:?}");
    }
}

/// Pairs of a film's edge and another film that cross and share no vertex, by exact predicates; looks at all pairs.
pub(crate) fn crossings(set: &LabelledTriangles) -> usize {
    let side = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| {
        let [a, b, c, d] = [a, b, c, d].map(|x| robust::Coord3D { x: x.x, y: x.y, z: x.z });
        robust::orient3d(a, b, c, d)
    };
    let at = |v: u32| set.positions[v as usize];
    let surface = Surface::from_triangles(set);
    let crosses = |p: u32, q: u32, t: &[u32; 3]| {
        let [a, b, c] = t.map(at);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        if at(p).min(at(q)).cmpgt(high).any() || at(p).max(at(q)).cmplt(low).any() || t.contains(&p) || t.contains(&q) {
            return false;
        }
        let around = [side(at(p), at(q), a, b), side(at(p), at(q), b, c), side(at(p), at(q), c, a)];
        side(a, b, c, at(p)) * side(a, b, c, at(q)) < 0.0
            && (around.iter().all(|s| *s > 0.0) || around.iter().all(|s| *s < 0.0))
    };
    let edges = surface.mesh.edges();
    edges.iter().map(|[p, q]| set.triangles.iter().filter(|t| crosses(p.0, q.0, t)).count()).sum()
}
