//! Small films built by hand, one for each thing that can happen to them.

#![allow(dead_code, reason = "every test uses another part")]

use froth_surface::operations::{Mark, Session, separation_candidates};
use froth_surface::transfer::NoData;
use froth_surface::{LabelledTriangles, PerVertex, Policy, Region, Surface, VertexRow};
use glam::DVec3;

pub(crate) fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Opens a surface for operations in step 1.
pub(crate) fn operate<R>(surface: &mut Surface, policy: &Policy, act: impl FnOnce(&mut Session<'_>) -> R) -> R {
    let (mut marks, mut data) = (PerVertex::<Mark>::default(), NoData);
    act(&mut Session::new(surface, policy, &mut data, &mut marks, 1))
}

/// A film between `behind` and `ahead`, which is where the point `towards` lies.
pub(crate) fn film(set: &mut LabelledTriangles, v: [u32; 3], behind: u32, ahead: u32, towards: DVec3) {
    let [a, b, c] = v.map(|v| set.positions[v as usize]);
    let is_front = (b - a).cross(c - a).dot(towards - a) > 0.0;
    set.add_film(v, if is_front { [behind, ahead] } else { [ahead, behind] });
}

/// A tetrahedron with region `inside` in region `outside`.
pub(crate) fn tetrahedron(set: &mut LabelledTriangles, v: [u32; 4], inside: u32, outside: u32) {
    for leave in 0..4 {
        let face: Vec<u32> = (0..4).filter(|i| *i != leave).map(|i| v[i]).collect();
        film(set, [face[0], face[1], face[2]], outside, inside, set.positions[v[leave] as usize]);
    }
}

/// A tetrahedron with new corners.
pub(crate) fn tetrahedron_at(set: &mut LabelledTriangles, corners: [DVec3; 4], inside: u32, outside: u32) -> [u32; 4] {
    let rows = corners.map(|x| set.add_vertex(x, false));
    tetrahedron(set, rows, inside, outside);
    rows
}

/// A cone over a regular ring around x, from `tip` (a vertex) to a far point `end`; `inside` in `outside`. Gives the ring.
pub(crate) fn spindle(
    set: &mut LabelledTriangles,
    tip: u32,
    (height, radius, sides): (f64, f64, usize),
    end: DVec3,
    [inside, outside]: [u32; 2],
) -> Vec<u32> {
    let ring: Vec<u32> = (0..sides)
        .map(|i| {
            let angle = std::f64::consts::TAU * i as f64 / sides as f64;
            set.add_vertex(at(height, radius * angle.cos(), radius * angle.sin()), false)
        })
        .collect();
    let far = set.add_vertex(end, false);
    let middle = at(height, 0.0, 0.0);
    for i in 0..sides {
        let [p, q] = [ring[i], ring[(i + 1) % sides]];
        film(set, [tip, p, q], outside, inside, middle);
        film(set, [far, p, q], outside, inside, middle);
    }
    ring
}

/// Two spindles of regions 1 and 2 that touch at vertex 0, along x.
pub(crate) fn bow_tie() -> LabelledTriangles {
    let mut set = LabelledTriangles::default();
    let tip = set.add_vertex(DVec3::ZERO, false);
    spindle(&mut set, tip, (1.0, 0.7, 5), at(2.0, 0.0, 0.0), [1, 0]);
    spindle(&mut set, tip, (-1.0, 0.7, 5), at(-2.0, 0.0, 0.0), [2, 0]);
    set
}

/// A bubble along x with a waist of three vertices (rows 0, 1, 2), each edge of which is `waist` long.
pub(crate) fn hourglass(waist: f64) -> LabelledTriangles {
    let mut set = LabelledTriangles::default();
    let ring = |set: &mut LabelledTriangles, x: f64, radius: f64| {
        [0, 1, 2].map(|i| {
            let angle = std::f64::consts::TAU * f64::from(i) / 3.0;
            set.add_vertex(at(x, radius * angle.cos(), radius * angle.sin()), false)
        })
    };
    let middle = ring(&mut set, 0.0, waist / 3f64.sqrt());
    for (side, reach) in [(1.0, 2.0), (-1.0, 1.8)] {
        let wide = ring(&mut set, side, 0.8);
        let tip = set.add_vertex(at(side * reach, 0.0, 0.0), false);
        let inside = at(0.5 * side, 0.0, 0.0);
        for i in 0..3 {
            let j = (i + 1) % 3;
            film(&mut set, [middle[i], wide[i], wide[j]], 0, 1, inside);
            film(&mut set, [middle[i], middle[j], wide[j]], 0, 1, inside);
            film(&mut set, [tip, wide[i], wide[j]], 0, 1, inside);
        }
    }
    set
}

/// Four regions around a small tetrahedron of region 5 with edges of about `inner` metres, in a large one; rows 0 to 3 are the small one's.
pub(crate) fn decorated_tetrahedron(inner: f64) -> LabelledTriangles {
    let corners = [at(1.0, 1.0, 1.0), at(1.0, -1.0, -1.0), at(-1.0, 1.0, -1.0), at(-1.0, -1.0, 1.0)];
    let mut set = LabelledTriangles::default();
    let small = corners.map(|x| set.add_vertex(x * inner / 8f64.sqrt(), false));
    let large = corners.map(|x| set.add_vertex(x, false));
    tetrahedron(&mut set, small, 5, 0);
    tetrahedron(&mut set, large, 6, 0);
    // Face i of each is opposite to corner i, and borders region i + 1.
    for i in 0..4 {
        set.labels[i] = set.labels[i].map(|label| if label == 0 { i as u32 + 1 } else { label });
        set.labels[4 + i] = set.labels[4 + i].map(|label| if label == 6 { i as u32 + 1 } else { label });
    }
    for i in 0..4 {
        for (j, towards) in corners.iter().copied().enumerate().take(i) {
            let [k, l]: [usize; 2] =
                (0..4).filter(|k| *k != i && *k != j).collect::<Vec<_>>().try_into().expect("two corners are left");
            // Region i + 1 lies away from corner i, that is towards corner j.
            film(&mut set, [small[k], large[k], large[l]], j as u32 + 1, i as u32 + 1, towards);
            film(&mut set, [small[k], large[l], small[l]], j as u32 + 1, i as u32 + 1, towards);
        }
    }
    set
}

/// A hexagon of film over an open pocket 1, its middle (row 0) free, its rim (rows 1 to 6) held, ghosts below.
pub(crate) fn hexagon() -> LabelledTriangles {
    let mut set = LabelledTriangles { open: vec![1], ..LabelledTriangles::default() };
    set.add_vertex(DVec3::ZERO, false);
    for i in 0..6 {
        let angle = std::f64::consts::TAU * f64::from(i) / 6.0;
        set.add_vertex(at(angle.cos(), angle.sin(), 0.0), true);
    }
    let apex = set.add_vertex(at(0.0, 0.0, -1.0), true);
    for i in 0..6 {
        let [p, q] = [1 + i, 1 + (i + 1) % 6];
        film(&mut set, [0, p, q], 1, 0, at(0.0, 0.0, 1.0));
        set.add_face([p, apex, q], [1, 0], true);
    }
    set
}

/// A square of film with held corners (rows 0 to 3) and a diagonal (0, 2), over an open pocket 1 that ghosts close.
pub(crate) fn square() -> LabelledTriangles {
    let mut set = LabelledTriangles { open: vec![1], ..LabelledTriangles::default() };
    for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]] {
        set.add_vertex(at(x, y, 0.0), true);
    }
    let apex = set.add_vertex(at(0.5, 0.5, -1.0), true);
    set.add_film([0, 1, 2], [1, 0]);
    set.add_film([0, 2, 3], [1, 0]);
    for [p, q] in [[0, 1], [1, 2], [2, 3], [3, 0]] {
        set.add_face([p, apex, q], [1, 0], true);
    }
    set
}

/// Edges with a number of faces.
pub(crate) fn edges_with(surface: &Surface, faces: usize) -> Vec<[VertexRow; 2]> {
    let edges = surface.mesh.edges().into_iter();
    edges.filter(|[a, b]| surface.mesh.faces_of_edge(*a, *b).len() == faces).collect()
}

/// Edges of a vertex that have not two faces.
pub(crate) fn junctions(surface: &Surface, v: VertexRow) -> usize {
    let neighbours = surface.mesh.neighbours(v);
    neighbours.iter().filter(|w| surface.mesh.faces_of_edge(v, **w).len() != 2).count()
}

/// Vertices with something to separate.
pub(crate) fn irregular(surface: &Surface) -> usize {
    surface.mesh.vertices().filter(|v| !separation_candidates(surface, *v).is_empty()).count()
}

pub(crate) fn ghosts(surface: &Surface) -> usize {
    surface.mesh.faces().filter(|(_, face)| face.is_ghost()).count()
}

/// Whether a film separates two regions.
pub(crate) fn share_film(surface: &Surface, a: u32, b: u32) -> bool {
    surface.mesh.faces().any(|(_, face)| face.borders(Region(a)) && face.borders(Region(b)))
}
