//! Thin faces where the mesh is at its sparsest.

#[path = "common/scenes.rs"]
mod scenes;

use froth_surface::invariants::check_all;
use froth_surface::{LabelledTriangles, Policy, Surface};
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
