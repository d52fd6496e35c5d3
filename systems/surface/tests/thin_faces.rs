//! Thin faces where the mesh is at its sparsest.

#[path = "common/scenes.rs"]
mod scenes;

use std::f64::consts::PI;

use froth_surface::corners::{LeastAngles, is_own};
use froth_surface::invariants::check_all;
use froth_surface::{LabelledTriangles, Policy, Surface, VertexRow};
use scenes::{at, film, operate};

/// A tetrahedron whose base is drawn out to a vertex (row 4) with three faces, at `tip`; the base edge (0, 1) is `width` long and held,
/// so that it stays.
fn pyramid(width: f64, tip: [f64; 3]) -> LabelledTriangles {
    let mut set = LabelledTriangles::default();
    let base = [at(-0.5 * width, 0.0, 0.0), at(0.5 * width, 0.0, 0.0), at(0.3, -1.2, 0.0)];
    for (v, x) in base.into_iter().chain([at(0.0, -0.4, 1.2), at(tip[0], tip[1], tip[2])]).enumerate() {
        set.add_vertex(x, v < 2);
    }
    let inside = at(0.0, -0.4, 0.2);
    for [a, b] in [[0, 1], [1, 2], [2, 0]] {
        film(&mut set, [a, b, 3], 0, 1, inside);
        film(&mut set, [a, b, 4], 0, 1, inside);
    }
    set
}

/// Two tetrahedra on a triangle (rows 0, 1, 2) with a tip at row 0, `width` wide at its other end: three films meet at each of its edges.
fn tip(width: f64) -> Surface {
    let mut set = LabelledTriangles::default();
    for x in [at(0.0, 0.0, 0.0), at(1.0, -0.5 * width, 0.0), at(1.0, 0.5 * width, 0.0)] {
        set.add_vertex(x, false);
    }
    film(&mut set, [0, 1, 2], 2, 1, at(0.6, 0.0, 0.8));
    for (region, height) in [(1, 0.8), (2, -0.8)] {
        let far = set.add_vertex(at(0.6, 0.0, height), false);
        for [a, b] in [[0, 1], [1, 2], [2, 0]] {
            film(&mut set, [a, b, far], 0, region, at(0.6, 0.0, 0.1 * height));
        }
    }
    Surface::from_triangles(&set)
}

#[test]
fn the_corner_between_two_junction_edges_is_the_films_own() {
    let surface = tip(0.2);
    let row = surface.mesh.face_with([0, 1, 2].map(VertexRow)).unwrap();
    let face = surface.mesh.face(row);
    let own = face.vertices().map(|v| is_own(&surface.mesh, &face, v));
    assert_eq!(own, [true; 3]);
    let least = LeastAngles::NONE.with_face_of(&surface, row);
    assert!((least.own - 2.0 * 0.1_f64.atan()).abs() < 1e-12, "{least:?}");
    assert!((least.rest - (0.5 * PI - 0.1_f64.atan())).abs() < 1e-12, "{least:?}");
    let outer = surface.mesh.face_with([0, 1, 3].map(VertexRow)).unwrap();
    let face = surface.mesh.face(outer);
    assert!(face.vertices().iter().all(|v| !is_own(&surface.mesh, &face, *v)));
}

#[test]
fn the_junction_edges_of_a_narrow_tip_are_halved_and_stay() {
    let policy = Policy { flips: true, ..Policy::new(1.2) };
    let mut surface = tip(0.2);
    let volumes = surface.volumes();
    let [point, a, b] = [0, 1, 2].map(VertexRow);
    operate(&mut surface, &policy, |session| session.improve_faces());
    check_all(&surface).unwrap();
    for (x, y) in surface.volumes().iter().zip(&volumes) {
        // Splits change none; flips that follow may, a little.
        assert!((x - y).abs() < 1e-4, "{x} and {y}");
    }
    // One at least: where the split of the other would leave too narrow an angle beside it, it waits.
    assert!([a, b].iter().any(|end| !surface.mesh.has_edge(point, *end)));
    let sides: Vec<VertexRow> = surface.mesh.neighbours(point).to_vec();
    let sides = sides.into_iter().filter(|v| surface.mesh.faces_of_edge(point, *v).len() == 3);
    for side in sides.collect::<Vec<_>>() {
        let mut tried = surface.clone();
        assert_eq!(operate(&mut tried, &policy, |session| session.collapse(point, side)), None);
    }
}

#[test]
fn the_junction_edges_of_a_wide_tip_are_left_alone() {
    let policy = Policy { flips: true, ..Policy::new(1.2) };
    let mut surface = tip(0.6);
    let before = surface.clone();
    operate(&mut surface, &policy, |session| session.improve_faces());
    assert_eq!(surface, before);
}

#[test]
fn improving_a_face_at_a_vertex_of_three_faces_keeps_everything_in_order() {
    let policy = Policy { flips: true, ..Policy::new(1.0) };
    let mut improved = 0;
    for (width, depth) in [0.05, 0.1, 0.2, 0.35].into_iter().flat_map(|w| [0.0, 0.2, 0.4, 0.7, 1.0].map(|d| (w, d))) {
        for (i, j) in (0..9).flat_map(|i| (0..9).map(move |j| (i, j))) {
            let tip = [0.15 * f64::from(i) - 0.5, 0.2 - 0.2 * f64::from(j), -depth];
            let start = Surface::from_triangles(&pyramid(width, tip));
            if check_all(&start).is_err() {
                continue;
            }
            for row in start.mesh.faces().map(|(row, _)| row) {
                let mut surface = start.clone();
                improved += u32::from(operate(&mut surface, &policy, |session| session.improve_face(row)));
                assert_eq!(check_all(&surface), Ok(()), "{width} {tip:?} {row}");
            }
        }
    }
    assert!(improved > 20, "{improved}");
}
