//! Collapses keep junctions in place, close necks, and let regions vanish; what they must not do they refuse without a trace.

#[path = "common/scenes.rs"]
mod scenes;
#[path = "common/voxels.rs"]
mod voxels;

use froth_surface::invariants::check_all;
use froth_surface::operations::separation_candidates;
use froth_surface::shapes::{disc, double_bubble, icosphere, kelvin_cells, lattice};
use froth_surface::transfer::NoData;
use froth_surface::{EventKind, Policy, Region, Surface, Tracker, VertexRow};
use glam::DVec3;
use scenes::{at, decorated_tetrahedron, edges_with, ghosts, hourglass, junctions, operate, share_film};
use voxels::voxels;

/// Collapses each edge that is wanted in a copy of its own; gives edge, vertex kept and outcome of those that went through.
fn collapse_each(
    surface: &Surface,
    edge: f64,
    wanted: impl Fn(VertexRow, VertexRow) -> bool,
) -> Vec<([VertexRow; 2], VertexRow, Surface)> {
    let mut done = Vec::new();
    for [a, b] in surface.mesh.edges().into_iter().filter(|[a, b]| wanted(*a, *b)) {
        let mut copy = surface.clone();
        match operate(&mut copy, &Policy::new(edge), |session| session.collapse(a, b)) {
            Some(kept) => {
                check_all(&copy).unwrap();
                done.push(([a, b], kept, copy));
            }
            None => assert_eq!(copy, *surface, "a refused collapse leaves no trace"),
        }
    }
    done
}

#[test]
fn an_edge_inside_a_film_collapses_with_hardly_any_change_of_volume() {
    let surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.3));
    let done = collapse_each(&surface, 0.6, |_, _| true);
    assert!(done.len() > 100, "{}", done.len());
    for (_, kept, after) in done {
        assert_eq!(after.mesh.face_count(), surface.mesh.face_count() - 2);
        assert!((after.volumes()[1] - surface.volumes()[1]).abs() < 0.01 * 0.6f64.powi(3));
        assert!(after.positions[kept].length() < 1.1);
    }
}

#[test]
fn films_collapse_onto_junctions_and_do_not_drag_them() {
    let surface = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.25));
    let is_curve = |v| junctions(&surface, v) == 2;
    let done = collapse_each(&surface, 0.5, |a, b| is_curve(a) != is_curve(b));
    assert!(done.len() > 10, "{}", done.len());
    for ([a, b], kept, after) in done {
        assert_eq!(kept, if is_curve(a) { a } else { b });
        assert_eq!(after.positions[kept], surface.positions[kept]);
        assert_eq!(edges_with(&after, 3).len(), edges_with(&surface, 3).len());
    }
}

#[test]
fn a_junction_collapses_along_itself() {
    let surface = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.25));
    let done = collapse_each(&surface, 0.5, |a, b| surface.mesh.faces_of_edge(a, b).len() == 3);
    assert!(done.len() > 10, "{}", done.len());
    for (_, kept, after) in done {
        assert_eq!(junctions(&after, kept), 2);
        assert_eq!(edges_with(&after, 3).len(), edges_with(&surface, 3).len() - 1);
    }
}

#[test]
fn a_point_where_four_films_meet_keeps_its_place() {
    let surface = Surface::from_triangles(&kelvin_cells(DVec3::ZERO, 1.0, 2, 0.25));
    let rank = |v| junctions(&surface, v);
    let done = collapse_each(&surface, 0.45, |a, b| (rank(a) == 4) != (rank(b) == 4));
    assert!(done.len() > 10, "{}", done.len());
    for ([a, b], kept, after) in done {
        assert_eq!(kept, if rank(a) == 4 { a } else { b });
        assert_eq!(after.positions[kept], surface.positions[kept]);
    }
}

/// Three boxes in a row, the middle one `width` wide.
fn slab(width: f64) -> Surface {
    let mut set = voxels([3, 1, 1], 1.0, &[1, 2, 3]);
    set.positions.iter_mut().filter(|x| x.x > 2.5).for_each(|x| x.x -= 1.0 - width);
    Surface::from_triangles(&set)
}

#[test]
fn a_chord_between_two_junctions_collapses_only_when_it_is_tiny() {
    for (width, is_done) in [(0.3, false), (0.21, false), (0.19, true), (0.05, true)] {
        let surface = slab(width);
        let is_chord = |a: VertexRow, b: VertexRow| (surface.positions[a].x - surface.positions[b].x).abs() - width;
        let rows = |a: VertexRow, b: VertexRow| {
            let [x, y] = [a, b].map(|v| surface.positions[v]);
            is_chord(a, b).abs() < 1e-9 && (x.y, x.z) == (y.y, y.z)
        };
        let done = collapse_each(&surface, 1.0, rows);
        let straight = done.iter().filter(|(_, kept, after)| !separation_candidates(after, *kept).is_empty()).count();
        assert_eq!(straight > 0, is_done, "width {width}: {} collapses, {straight} irregular", done.len());
    }
}

#[test]
fn a_tetrahedral_bubble_vanishes_with_an_event() {
    let mut set = froth_surface::LabelledTriangles::default();
    let corners = [at(0.0, 0.0, 0.0), at(0.15, 0.0, 0.0), at(0.0, 0.15, 0.0), at(0.0, 0.0, 0.15)];
    scenes::tetrahedron_at(&mut set, corners, 1, 0);
    scenes::tetrahedron_at(&mut set, corners.map(|x| 9.0 * x + at(3.0, 0.0, 0.0)), 2, 0);
    let mut surface = Surface::from_triangles(&set);
    let events = operate(&mut surface, &Policy::new(1.0), |session| {
        session.collapse_short_edges();
        session.events.clone()
    });
    check_all(&surface).unwrap();
    assert_eq!(surface.mesh.regions(), vec![Region(0), Region(2)]);
    let vanished: Vec<_> = events.iter().filter(|event| event.kind == EventKind::Vanished).collect();
    assert_eq!(vanished.len(), 1, "{events:?}");
    assert_eq!(vanished[0].regions.as_slice(), [Region(1)]);
    assert!(vanished[0].place.length() < 0.15);
}

#[test]
fn a_tetrahedral_bubble_among_four_others_vanishes_into_their_films() {
    let mut surface = Surface::from_triangles(&decorated_tetrahedron(0.15));
    check_all(&surface).unwrap();
    let before = surface.volumes();
    let events = operate(&mut surface, &Policy::new(1.0), |session| {
        assert!(session.collapse(VertexRow(0), VertexRow(1)).is_some());
        session.events.clone()
    });
    check_all(&surface).unwrap();
    assert!(!surface.mesh.regions().contains(&Region(5)));
    assert!(
        events.iter().any(|event| event.kind == EventKind::Vanished && event.regions[0] == Region(5)),
        "{events:?}"
    );
    assert!((1..5).all(|i| (i + 1..5).all(|j| share_film(&surface, i, j))));
    let after = surface.volumes();
    assert!((1..5).all(|i| (after[i] - before[i]).abs() < 0.15f64.powi(2)));
}

#[test]
fn a_region_that_is_more_than_a_speck_does_not_vanish() {
    let mut surface = Surface::from_triangles(&decorated_tetrahedron(0.45));
    let before = surface.clone();
    // Edges of 0.45 m are tiny for L = 2.5 m; the volume of 0.0107 m^3 is above 1 % of 1 m^3, for L = 1 m.
    assert_eq!(operate(&mut surface, &Policy::new(1.0), |session| session.collapse(VertexRow(0), VertexRow(1))), None);
    assert_eq!(surface, before);
}

#[test]
fn closing_a_waist_makes_an_edge_with_four_faces() {
    let mut surface = Surface::from_triangles(&hourglass(0.15));
    check_all(&surface).unwrap();
    let kept =
        operate(&mut surface, &Policy::new(1.0), |session| session.collapse(VertexRow(0), VertexRow(1))).unwrap();
    check_all(&surface).unwrap();
    assert_eq!(surface.mesh.faces_of_edge(kept, VertexRow(2)).len(), 4);
}

#[test]
fn an_open_waist_is_not_closed() {
    let mut surface = Surface::from_triangles(&hourglass(0.3));
    assert_eq!(operate(&mut surface, &Policy::new(1.0), |session| session.collapse(VertexRow(0), VertexRow(1))), None);
}

#[test]
fn held_vertices_keep_their_places_and_ghosts_their_number() {
    let surface = Surface::from_triangles(&disc(DVec3::ZERO, 1.0, DVec3::Z, 0.25));
    let pinned = |v: VertexRow| surface.pinned[v];
    assert!(collapse_each(&surface, 3.0, |a, b| pinned(a) && pinned(b)).is_empty());
    let done = collapse_each(&surface, 0.5, |a, b| pinned(a) != pinned(b));
    assert!(!done.is_empty());
    for ([a, b], kept, after) in done {
        assert_eq!(kept, if pinned(a) { a } else { b });
        assert_eq!(after.positions[kept], surface.positions[kept]);
        assert_eq!(ghosts(&after), ghosts(&surface));
    }
    let beside = |a: VertexRow, b: VertexRow| {
        let others = surface.mesh.faces_of_edge(a, b).into_iter().map(|row| surface.mesh.face(row).opposite(a, b));
        !pinned(a) && !pinned(b) && others.into_iter().any(pinned)
    };
    let done = collapse_each(&surface, 0.5, beside);
    assert!(done.iter().all(|(_, _, after)| ghosts(after) == ghosts(&surface)));
}

#[test]
fn an_edge_without_length_collapses() {
    let mut surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.4));
    let [a, b] = surface.mesh.edges()[7];
    surface.positions[a] = surface.positions[b];
    let kept = operate(&mut surface, &Policy::new(0.4), |session| session.collapse(a, b)).unwrap();
    check_all(&surface).unwrap();
    assert!(surface.positions[kept].is_finite());
}

#[test]
fn a_face_without_area_goes_in_a_pass() {
    let mut surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.4));
    let face = surface.mesh.faces().next().map(|(_, face)| *face).unwrap();
    let [a, b, c] = face.vertices();
    surface.positions[a] = surface.positions[b].midpoint(surface.positions[c]);
    let mut tracker = Tracker::default();
    for _ in 0..3 {
        let _ = tracker.remesh(&mut surface, &Policy::new(0.4), &mut NoData);
    }
    check_all(&surface).unwrap();
    let least = surface.mesh.faces().map(|(row, _)| surface.area(row)).fold(f64::INFINITY, f64::min);
    assert!(least > 1e-3 * 0.4 * 0.4, "{least}");
}

#[test]
fn an_edge_with_four_faces_collapses_along_its_line() {
    let surface = Surface::from_triangles(&lattice(DVec3::ZERO, [2; 3], 1.0, 1.0));
    for [a, b] in edges_with(&surface, 4) {
        let mut copy = surface.clone();
        let place = copy.positions[a].lerp(copy.positions[b], 0.1);
        let (new, kept) = operate(&mut copy, &Policy::new(1.0), |session| {
            let new = session.split(a, b, 0.1, place).unwrap();
            (new, session.collapse(a, new))
        });
        check_all(&copy).unwrap();
        assert_eq!(kept, Some(a), "{new}");
        assert_eq!(copy.mesh.faces_of_edge(a, b).len(), 4);
        assert_eq!(copy.positions[a], surface.positions[a]);
    }
}

#[test]
fn a_collapse_does_not_undo_a_separation_for_three_steps() {
    let mut surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.4));
    let [a, b] = surface.mesh.edges()[7];
    let (policy, mut data) = (Policy::new(0.8), NoData);
    let mut marks = froth_surface::PerVertex::default();
    for step in 10..=14 {
        let mut session = froth_surface::operations::Session::new(&mut surface, &policy, &mut data, &mut marks, step);
        if step == 10 {
            session.marks[a].separated = 10;
            session.marks[b].separated = 10;
        }
        assert_eq!(session.collapse(a, b).is_some(), step == 14, "step {step}");
    }
}
