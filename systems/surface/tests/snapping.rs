//! Films that come near are joined: from a point to a line to a film.

#[path = "common/scenes.rs"]
mod scenes;
#[path = "common/voxels.rs"]
mod voxels;

use froth_surface::invariants::check_all;
use froth_surface::operations::{Pair, Session};
use froth_surface::transfer::NoData;
use froth_surface::{Contact, EventKind, LabelledTriangles, Policy, Region, Surface, Tracker, VertexRow};
use glam::DVec3;
use scenes::{at, edges_with, hourglass, operate, share_film, tetrahedron_at};
use voxels::voxels;

const GAP: f64 = 0.05;

/// A bubble with a flat top face (rows 0, 1, 2) and a bubble whose tip (row 4) hangs `GAP` above the point with these weights.
fn tip_above(weights: [f64; 3]) -> Surface {
    let mut set = LabelledTriangles::default();
    let top = [at(0.0, 0.0, 0.0), at(2.0, 0.0, 0.0), at(0.0, 2.0, 0.0)];
    tetrahedron_at(&mut set, [top[0], top[1], top[2], at(0.6, 0.6, -2.0)], 1, 0);
    let foot = top[0] * weights[0] + top[1] * weights[1] + top[2] * weights[2];
    let tip = foot + at(0.0, 0.0, GAP);
    let lifted = [at(0.8, 0.0, 2.0), at(-0.5, 0.7, 2.0), at(-0.5, -0.7, 2.0)].map(|x| tip + x);
    tetrahedron_at(&mut set, [tip, lifted[0], lifted[1], lifted[2]], 2, 0);
    Surface::from_triangles(&set)
}

fn nearest(session: &mut Session<'_>) -> Pair {
    session.near_pairs()[0].1
}

#[test]
fn a_tip_above_the_inside_of_a_face_splits_the_face() {
    let mut surface = tip_above([0.3, 0.3, 0.4]);
    operate(&mut surface, &Policy::new(1.0), |session| {
        let pair = nearest(session);
        assert!(matches!(pair, Pair::VertexFace(VertexRow(4), _)), "{pair:?}");
        let kept = session.snap(pair).unwrap();
        assert_eq!((session.counts.face_splits, session.counts.splits, session.counts.snaps), (1, 0, 1));
        assert!((session.surface.positions[kept].z - 0.5 * GAP).abs() < 1e-15, "both move half of the way");
    });
    check_all(&surface).unwrap();
}

#[test]
fn a_tip_near_a_side_or_a_corner_takes_it() {
    for (weights, splits) in [([0.02, 0.49, 0.49], 1), ([0.97, 0.015, 0.015], 0)] {
        let mut surface = tip_above(weights);
        let counts = operate(&mut surface, &Policy::new(1.0), |session| {
            let pair = Pair::VertexFace(VertexRow(4), froth_surface::FaceRow(3));
            assert!(session.near_pairs().iter().any(|(_, other)| *other == pair));
            session.snap(pair).unwrap();
            session.counts
        });
        check_all(&surface).unwrap();
        assert_eq!((counts.face_splits, counts.splits, counts.snaps), (0, splits, 1), "{weights:?}");
    }
}

/// Two wedges with ridges (rows 0, 1 and 4, 5), the second turned about z and moved along x.
fn ridges(turn: f64, shift: f64) -> Surface {
    let mut set = LabelledTriangles::default();
    tetrahedron_at(&mut set, [-DVec3::X, DVec3::X, at(0.0, -1.0, -1.5), at(0.0, 1.0, -1.5)], 1, 0);
    let turned = |x: DVec3| glam::DQuat::from_rotation_z(turn) * x + at(shift, 0.0, GAP);
    let upper = [-DVec3::X, DVec3::X, at(0.0, -1.0, 1.5), at(0.0, 1.0, 1.5)].map(turned);
    tetrahedron_at(&mut set, upper, 2, 0);
    Surface::from_triangles(&set)
}

#[test]
fn ridges_that_cross_are_joined_where_they_are_nearest() {
    let half_turn = std::f64::consts::FRAC_PI_2;
    for (turn, shift, splits) in
        [(half_turn, 0.3, 2), (half_turn, 0.99, 1), (0.7, 0.0, 2), (0.0, 0.0, 0), (0.0, 0.7, 1)]
    {
        let mut surface = ridges(turn, shift);
        let (counts, kept) = operate(&mut surface, &Policy::new(1.0), |session| {
            let pair = Pair::EdgeEdge([VertexRow(0), VertexRow(1)], [VertexRow(4), VertexRow(5)]);
            assert!(session.near_pairs().iter().any(|(_, other)| *other == pair), "{turn} {shift}");
            let kept = session.snap(pair);
            (session.counts, kept)
        });
        check_all(&surface).unwrap();
        let place = surface.positions[kept.unwrap()];
        assert!(place.is_finite() && (place.z - 0.5 * GAP).abs() < 0.02, "{turn} {shift}: {place}");
        assert_eq!(counts.splits, splits, "{turn} {shift}");
    }
}

#[test]
fn ridges_in_one_line_are_joined_at_their_ends() {
    let mut set = LabelledTriangles::default();
    for (side, region) in [(1.0, 1), (-1.0, 2)] {
        let along = |x: f64, y: f64, z: f64| at(side * (x + 0.5 * GAP), y, z);
        tetrahedron_at(
            &mut set,
            [along(0.0, 0.0, 0.0), along(1.0, 0.0, 0.0), along(0.8, 0.5, -1.0), along(0.8, -0.5, -1.0)],
            region,
            0,
        );
    }
    let mut surface = Surface::from_triangles(&set);
    let snaps = operate(&mut surface, &Policy::new(1.0), |session| session.snap_films());
    check_all(&surface).unwrap();
    assert_eq!(snaps, 1);
    assert!(surface.mesh.vertices().any(|v| surface.mesh.regions_of(v).len() == 3));
}

#[test]
fn three_snaps_of_facing_faces_make_one_film_between_the_two_bubbles() {
    let mut set = LabelledTriangles::default();
    let ground = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.3, 1.0, 0.0)];
    for (side, region) in [(-1.0, 1), (1.0, 2)] {
        let [a, b, c] = ground.map(|x| x + at(0.0, 0.0, 0.5 * side * GAP));
        tetrahedron_at(&mut set, [a, b, c, at(0.4, 0.4, side)], region, 0);
    }
    let mut surface = Surface::from_triangles(&set);
    let events = operate(&mut surface, &Policy::new(1.0), |session| {
        for (number, [p, q]) in [[0, 4], [1, 5], [2, 6]].into_iter().enumerate() {
            session.snap_vertices(VertexRow(p), VertexRow(q)).unwrap();
            check_all(session.surface).unwrap();
            let crossed = edges_with(session.surface, 4).len();
            assert_eq!(crossed, [0, 1, 0][number], "a point, a line, a film");
        }
        session.events.clone()
    });
    assert!(share_film(&surface, 1, 2));
    assert_eq!(edges_with(&surface, 3).len(), 3);
    assert_eq!(events.len(), 1, "{events:?}");
    assert_eq!(events[0].kind, EventKind::Coalescence);
    let mut pair = [events[0].regions[0], events[0].regions[1]];
    pair.sort_unstable();
    assert_eq!((pair, events[0].regions[2]), ([Region(1), Region(2)], Region(0)));
}

/// A bubble in the shape of a U whose arms are `gap` apart, but for their feet, which are apart by 1.
fn horseshoe(gap: f64) -> LabelledTriangles {
    let mut set = voxels([3, 1, 3], 1.0, &[1, 1, 1, 1, 0, 1, 1, 0, 1]);
    set.positions.iter_mut().filter(|x| x.x > 2.5 && x.z > 2.5).for_each(|x| x.x -= 1.0 - gap);
    set
}

#[test]
fn a_bubble_that_touches_itself_opens_a_window() {
    let mut surface = Surface::from_triangles(&horseshoe(GAP));
    check_all(&surface).unwrap();
    let (mut tracker, policy) = (Tracker::default(), Policy::new(1.0));
    let mut events = Vec::new();
    for _ in 0..5 {
        events.extend(tracker.remesh(&mut surface, &policy, &mut NoData).events);
        check_all(&surface).unwrap();
    }
    let windows: Vec<_> = events.iter().filter(|event| event.kind == EventKind::Window).collect();
    assert_eq!(windows.len(), 1, "{events:?}");
    assert_eq!(windows[0].regions.as_slice(), [Region(1), Region(0)]);
}

#[test]
fn vertices_of_one_edge_are_not_joined_on_a_closing_waist() {
    let mut surface = Surface::from_triangles(&hourglass(0.08));
    let before = surface.clone();
    operate(&mut surface, &Policy::new(1.0), |session| {
        for [p, q] in [[0, 1], [1, 2], [0, 2], [0, 0]] {
            assert_eq!(session.snap_vertices(VertexRow(p), VertexRow(q)), None);
        }
    });
    assert_eq!(surface, before);
    operate(&mut surface, &Policy::new(1.0), |session| session.snap_films());
    check_all(&surface).unwrap();
}

#[test]
fn faces_on_a_hinge_are_joined_only_when_folded_onto_each_other() {
    // The hinge is (0, 1); corner 3 is near the face (0, 1, 2) if the angle between the faces is small.
    for (angle, is_near) in [(0.08_f64, true), (3.06, false)] {
        let mut set = LabelledTriangles::default();
        let flap = at(0.5, 0.6 * angle.cos(), 0.6 * angle.sin());
        tetrahedron_at(&mut set, [DVec3::ZERO, DVec3::X, at(0.5, 1.0, 0.0), flap], 1, 0);
        let mut surface = Surface::from_triangles(&set);
        let near = operate(&mut surface, &Policy::new(1.0), |session| {
            let pairs = session.near_pairs();
            pairs.iter().any(|(_, pair)| *pair == Pair::VertexFace(VertexRow(3), froth_surface::FaceRow(3)))
        });
        assert_eq!(near, is_near, "angle {angle}");
        operate(&mut surface, &Policy::new(1.0), |session| {
            let done = session.snap(Pair::VertexFace(VertexRow(3), froth_surface::FaceRow(3)));
            assert!(is_near || done.is_none());
            let is_gone = !session.surface.mesh.regions().contains(&Region(1));
            let is_noted = session.events.iter().any(|event| event.kind == EventKind::Vanished);
            assert_eq!(is_gone, is_noted, "a region vanishes with an event: {:?}", session.events);
        });
        check_all(&surface).unwrap();
    }
}

#[test]
fn a_held_vertex_keeps_its_place_and_two_held_ones_stay_apart() {
    for held in [[true, false], [false, true], [true, true]] {
        let mut surface = tip_above([0.97, 0.015, 0.015]);
        let (corner, tip) = (VertexRow(0), VertexRow(4));
        (surface.pinned[corner], surface.pinned[tip]) = (held[0], held[1]);
        let before = surface.clone();
        let kept = operate(&mut surface, &Policy::new(1.0), |session| session.snap_vertices(corner, tip));
        check_all(&surface).unwrap();
        match held {
            [true, true] => assert_eq!((kept, &surface), (None, &before)),
            [is_corner, _] => {
                let wanted = if is_corner { corner } else { tip };
                assert_eq!(kept, Some(wanted));
                assert_eq!(surface.positions[wanted], before.positions[wanted]);
                assert!(surface.pinned[wanted]);
            }
        }
    }
}

#[test]
fn a_snap_with_something_between_leaves_its_splits_and_sound_films() {
    let mut surface = tip_above([0.3, 0.3, 0.4]);
    let foot = surface.positions[VertexRow(4)] - at(0.0, 0.0, 0.6 * GAP);
    let mut set = LabelledTriangles::default();
    let size = 0.005;
    let corners = [at(0.0, 0.0, 1.0), at(1.0, 0.0, -0.3), at(-0.5, 0.8, -0.3), at(-0.5, -0.8, -0.3)];
    tetrahedron_at(&mut set, corners.map(|x| foot + size * x), 3, 0);
    let speck = Surface::from_triangles(&set);
    let first = surface.mesh.vertex_rows() as u32;
    for v in speck.mesh.vertices() {
        surface.mesh.add_vertex();
        surface.positions.push(speck.positions[v]);
        surface.pinned.push(false);
    }
    for (_, face) in speck.mesh.faces() {
        let vertices = face.vertices().map(|v| VertexRow(v.0 + first));
        surface.mesh.add_face(froth_surface::Face::new(vertices, face.labels()));
    }
    let face = surface.mesh.face_with([0, 1, 2].map(VertexRow)).unwrap();
    let (kept, counts) = operate(&mut surface, &Policy::new(1.0), |session| {
        (session.snap(Pair::VertexFace(VertexRow(4), face)), session.counts)
    });
    check_all(&surface).unwrap();
    assert_eq!((kept, counts.face_splits, counts.snaps), (None, 1, 0));
    assert!(counts.blocked > 0);
}

#[test]
fn films_that_bounce_are_not_joined() {
    let mut surface = tip_above([0.3, 0.3, 0.4]);
    let policy = Policy { contact: Contact::Bounce, ..Policy::new(1.0) };
    assert_eq!(operate(&mut surface, &policy, |session| session.snap_films()), 0);
}
