//! Faces that come to lie on each other are trimmed by the sum of their labels, in whatever order and winding they are written.

#[path = "common/scenes.rs"]
mod scenes;

use froth_surface::invariants::check_all;
use froth_surface::operations::{Trimmed, trim};
use froth_surface::{EventKind, Face, Policy, Region, Surface, VertexRow};
use scenes::{edges_with, hourglass, operate};

fn face(labels: [u32; 2]) -> Face {
    Face::new([1, 2, 3].map(VertexRow), labels.map(Region))
}

/// The same face in each of its six windings.
fn windings(labels: [u32; 2]) -> Vec<Face> {
    let orders = [[1, 2, 3], [2, 3, 1], [3, 1, 2], [2, 1, 3], [1, 3, 2], [3, 2, 1]];
    let is_turned = |i: usize| i > 2;
    let labels_of = |i: usize| if is_turned(i) { [labels[1], labels[0]] } else { labels };
    (0..6).map(|i| Face::new(orders[i].map(VertexRow), labels_of(i).map(Region))).collect()
}

#[test]
fn two_coincident_faces_of_every_winding_cancel_or_fuse() {
    let film = |back, front| Trimmed::Film([Region(back), Region(front)]);
    let cases = [
        ([1, 0], [0, 1], Trimmed::Nothing),
        ([0, 1], [1, 0], Trimmed::Nothing),
        ([1, 0], [0, 2], film(1, 2)),
        ([0, 2], [1, 0], film(1, 2)),
        ([2, 0], [0, 1], film(2, 1)),
        ([3, 7], [7, 0], film(3, 0)),
        ([1, 0], [1, 0], Trimmed::Refused),
        ([1, 0], [2, 0], Trimmed::Refused),
        ([1, 2], [3, 4], Trimmed::Refused),
    ];
    for (first, second, wanted) in cases {
        for a in windings(first) {
            for b in windings(second) {
                assert_eq!(trim(&[a, b]), wanted, "{first:?} {second:?}");
                assert_eq!(trim(&[b, a]), wanted, "{second:?} {first:?}");
            }
        }
    }
}

#[test]
fn three_and_four_coincident_faces_add_up_in_any_order() {
    let film = |back, front| Trimmed::Film([Region(back), Region(front)]);
    let stacks: [(&[[u32; 2]], Trimmed); 5] = [
        (&[[1, 0], [0, 2], [2, 3]], film(1, 3)),
        (&[[1, 0], [0, 1], [1, 2]], film(1, 2)),
        (&[[1, 0], [0, 2], [2, 0], [0, 1]], Trimmed::Nothing),
        (&[[1, 0], [0, 2], [2, 0], [0, 3]], film(1, 3)),
        (&[[1, 0], [2, 0], [3, 0]], Trimmed::Refused),
    ];
    for (labels, wanted) in stacks {
        let faces: Vec<Face> = labels.iter().map(|labels| face(*labels)).collect();
        for turn in 0..faces.len() {
            let mut turned = faces.clone();
            turned.rotate_left(turn);
            assert_eq!(trim(&turned), wanted, "{labels:?} from {turn}");
            turned.reverse();
            assert_eq!(trim(&turned), wanted, "{labels:?} backwards from {turn}");
        }
    }
}

#[test]
fn a_ghost_and_a_film_are_not_trimmed_but_two_ghosts_are() {
    let (film, ghost) = (face([1, 0]), face([0, 1]).as_ghost(true));
    assert_eq!(trim(&[film, ghost]), Trimmed::Refused);
    assert_eq!(trim(&[ghost, film]), Trimmed::Refused);
    assert_eq!(trim(&[face([1, 0]).as_ghost(true), ghost]), Trimmed::Nothing);
}

#[test]
fn a_single_face_is_left_as_it_is() {
    assert_eq!(trim(&[face([4, 2])]), Trimmed::Film([Region(4), Region(2)]));
    assert_eq!(trim(&[]), Trimmed::Nothing);
}

/// Closes the waist of an hourglass by two collapses: the faces around it come to lie on each other.
#[test]
fn trimming_leaves_no_edge_with_a_single_face_and_no_vertex_without_any() {
    let mut surface = Surface::from_triangles(&hourglass(0.1));
    let events = operate(&mut surface, &Policy::new(1.0), |session| {
        session.collapse(VertexRow(0), VertexRow(1)).unwrap();
        session.collapse_short_edges();
        session.events.clone()
    });
    check_all(&surface).unwrap();
    assert!(edges_with(&surface, 1).is_empty());
    assert_eq!(surface.mesh.vertices().filter(|v| surface.positions[*v].x.abs() < 0.5).count(), 1, "{events:?}");
    assert!(events.iter().all(|event| event.kind != EventKind::Vanished));
    let rows = surface.mesh.vertex_rows();
    let remap = surface.compact();
    assert_eq!(remap.vertices.iter().flatten().count(), surface.positions.len());
    assert!(surface.positions.len() < rows);
    check_all(&surface).unwrap();
}

#[test]
fn a_window_is_named_by_the_region_between_its_films() {
    use froth_surface::LabelledTriangles;
    use scenes::{at, film};
    // Two pyramids of one bubble that share the edge (0, 1) and show the air between them two faces, (0, 1, 2) and (0, 1, 3).
    for (inside, outside) in [(1, 0), (0, 1)] {
        let mut set = LabelledTriangles::default();
        let places = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.5, 0.1, 1.0), at(0.5, -0.1, 1.0)];
        places.iter().for_each(|x| _ = set.add_vertex(*x, false));
        let far = [at(0.5, 1.0, 0.2), at(0.5, -1.0, 0.2)].map(|x| set.add_vertex(x, false));
        for (near, far) in [(2, far[0]), (3, far[1])] {
            scenes::tetrahedron(&mut set, [0, 1, near, far], inside, outside);
        }
        if inside == 0 {
            // A ball of gas around, so that what is between is the bubble itself.
            let ball = froth_surface::shapes::icosphere(at(0.5, 0.0, 0.5), 4.0, 2.0);
            let first = set.positions.len() as u32;
            ball.positions.iter().for_each(|x| _ = set.add_vertex(*x, false));
            ball.triangles.iter().for_each(|t| set.add_film(t.map(|v| v + first), [1, 0]));
        }
        let mut surface = Surface::from_triangles(&set);
        check_all(&surface).unwrap();
        let events = operate(&mut surface, &Policy { snap: 0.3, ..Policy::new(1.0) }, |session| {
            session.snap_vertices(VertexRow(2), VertexRow(3)).unwrap();
            session.events.clone()
        });
        check_all(&surface).unwrap();
        assert_eq!(events.len(), 1, "{events:?}");
        assert_eq!(
            (events[0].kind, events[0].regions.as_slice()),
            (EventKind::Window, &[Region(inside), Region(outside)][..])
        );
        let _ = film;
    }
}

#[test]
fn a_dent_that_folds_flat_opens_no_window() {
    // A ball with one face split in three: where an edge of that face shrinks, the two other parts come to lie on each other.
    let ball = froth_surface::shapes::icosphere(glam::DVec3::ZERO, 1.0, 0.5);
    let mut set = froth_surface::LabelledTriangles::default();
    ball.positions.iter().for_each(|x| _ = set.add_vertex(*x, false));
    let [a, b, c] = ball.triangles[0];
    let middle = [a, b, c].map(|v| ball.positions[v as usize]).iter().sum::<glam::DVec3>() / 3.0;
    let middle = set.add_vertex(middle * 1.05, false);
    [[a, b, middle], [b, c, middle], [c, a, middle]].iter().for_each(|t| set.add_film(*t, [1, 0]));
    ball.triangles[1..].iter().for_each(|t| set.add_film(*t, [1, 0]));
    let mut surface = Surface::from_triangles(&set);
    check_all(&surface).unwrap();
    let count = surface.mesh.face_count();
    let events = operate(&mut surface, &Policy::new(10.0), |session| {
        session.collapse(VertexRow(a), VertexRow(b)).unwrap();
        session.events.clone()
    });
    check_all(&surface).unwrap();
    assert_eq!((surface.mesh.face_count(), events.as_slice()), (count - 4, &[][..]));
}
