//! Splits change neither shape nor topology, whatever number of faces an edge has.

#[path = "common/scenes.rs"]
mod scenes;

use froth_surface::invariants::check_all;
use froth_surface::shapes::{disc, double_bubble, icosphere, lattice};
use froth_surface::transfer::{Columns, Transfer};
use froth_surface::{FaceRow, LabelledTriangles, PerVertex, Placement, Policy, Surface, VertexRow};
use glam::DVec3;
use scenes::{at, edges_with, film, ghosts, hexagon, operate, square, tetrahedron_at};

fn labels(surface: &Surface) -> Vec<[u32; 2]> {
    let mut labels: Vec<[u32; 2]> = surface.mesh.faces().map(|(_, face)| face.labels().map(|l| l.0)).collect();
    labels.iter_mut().for_each(|pair| pair.sort_unstable());
    labels.sort_unstable();
    labels.dedup();
    labels
}

#[test]
fn a_split_in_the_middle_keeps_shape_volumes_and_labels() {
    let shapes = [
        (2, 0.4, icosphere(DVec3::ZERO, 1.0, 0.4)),
        (3, 0.3, double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.3)),
        (4, 0.5, lattice(DVec3::ZERO, [2; 3], 1.0, 0.5)),
    ];
    for (faces, edge, set) in shapes {
        let mut surface = Surface::from_triangles(&set);
        let (volumes, area, pairs) = (surface.volumes(), surface.film_area(), labels(&surface));
        let [a, b] = edges_with(&surface, faces)[0];
        let new = operate(&mut surface, &Policy::new(edge), |session| session.split_at_midpoint(a, b)).unwrap();
        check_all(&surface).unwrap();
        assert_eq!(surface.mesh.faces_of(new).len(), 2 * faces);
        assert!(!surface.mesh.has_edge(a, b) && surface.mesh.has_edge(a, new) && surface.mesh.has_edge(new, b));
        assert_eq!(surface.mesh.faces_of_edge(a, new).len(), faces);
        assert_eq!(labels(&surface), pairs);
        for (before, after) in volumes.iter().zip(surface.volumes()) {
            assert!((before - after).abs() < 1e-14, "{before} {after}");
        }
        assert!((surface.film_area() - area).abs() < 1e-13);
    }
}

#[test]
fn an_edge_of_exactly_the_longest_length_stays_and_a_longer_one_is_halved() {
    let mut set = LabelledTriangles::default();
    tetrahedron_at(&mut set, [DVec3::ZERO, 1.5 * DVec3::X, 1.5 * DVec3::Y, 1.5 * DVec3::Z], 1, 0);
    for (edge, is_kept) in [(1.0, true), (1.0 - 1e-12, false)] {
        let mut surface = Surface::from_triangles(&set);
        operate(&mut surface, &Policy::new(edge), |session| session.split_long_edges());
        check_all(&surface).unwrap();
        assert_eq!(surface.mesh.has_edge(VertexRow(0), VertexRow(1)), is_kept, "L = {edge}");
        assert!(!surface.mesh.has_edge(VertexRow(1), VertexRow(2)), "the long sides are halved in both");
    }
}

#[test]
fn a_rim_is_refined_with_its_ghosts_and_stays_held() {
    let mut surface = Surface::from_triangles(&hexagon());
    let policy = Policy::new(0.8);
    let before = ghosts(&surface);
    let on_rim =
        operate(&mut surface, &policy, |session| session.split_at_midpoint(VertexRow(1), VertexRow(2))).unwrap();
    let inside =
        operate(&mut surface, &policy, |session| session.split_at_midpoint(VertexRow(0), VertexRow(4))).unwrap();
    check_all(&surface).unwrap();
    assert_eq!((surface.pinned[on_rim], surface.pinned[inside]), (true, false));
    assert_eq!(ghosts(&surface), before + 1);
}

#[test]
fn an_edge_between_two_held_vertices_without_a_ghost_is_not_split() {
    let mut surface = Surface::from_triangles(&square());
    let (a, b) = (VertexRow(0), VertexRow(2));
    for edge in [0.9, 0.4, 0.1] {
        let policy = Policy::new(edge);
        let split = operate(&mut surface, &policy, |session| session.split(a, b, 0.5, at(0.5, 0.5, 0.0)));
        assert_eq!(split, None, "a wire would lose its film");
    }
}

#[test]
fn a_split_at_an_end_or_of_no_edge_is_refused() {
    let mut surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.5));
    let before = surface.clone();
    let [a, b] = surface.mesh.edges()[0];
    let stranger = surface.mesh.vertices().find(|v| *v != a && !surface.mesh.has_edge(a, *v)).unwrap();
    let (x, y) = (surface.positions[a], surface.positions[b]);
    operate(&mut surface, &Policy::new(0.5), |session| {
        assert_eq!(session.split(a, b, 0.0, x), None);
        assert_eq!(session.split(a, b, 1.0, y), None);
        assert_eq!(session.split(a, b, 1e-20, x), None, "rounded to the end");
        assert_eq!(session.split(a, b, f64::NAN, x), None);
        assert_eq!(session.split(a, stranger, 0.5, DVec3::ZERO), None);
        assert_eq!(session.split_at_midpoint(a, stranger), None);
        assert_eq!(session.split_face(FaceRow(0), [0.0, 0.5, 0.5]), None);
        assert_eq!(session.split_face(FaceRow(9999), [0.2, 0.3, 0.5]), None);
    });
    assert_eq!(surface, before);
}

#[test]
fn a_short_edge_is_not_halved() {
    let mut surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.3));
    let [a, b] = surface.mesh.edges()[0];
    assert_eq!(operate(&mut surface, &Policy::new(0.8), |session| session.split_at_midpoint(a, b)), None);
}

#[test]
fn a_sliver_is_split_at_the_foot_of_its_wide_corner() {
    let mut set = LabelledTriangles::default();
    tetrahedron_at(&mut set, [DVec3::ZERO, 2.0 * DVec3::X, at(1.0, 0.0087, 0.0), at(1.0, 0.3, 1.0)], 1, 0);
    let mut surface = Surface::from_triangles(&set);
    let volume = surface.volumes()[1];
    operate(&mut surface, &Policy::new(1.0), |session| session.split_wide_angles());
    check_all(&surface).unwrap();
    assert!(!surface.mesh.has_edge(VertexRow(0), VertexRow(1)));
    assert!((surface.positions[VertexRow(4)] - DVec3::X).length() < 1e-12);
    assert!((surface.volumes()[1] - volume).abs() < 1e-15);
}

#[test]
fn a_face_becomes_three_and_its_new_vertex_takes_the_mean() {
    let mut surface = Surface::from_triangles(&disc(DVec3::ZERO, 1.0, DVec3::Z, 0.4));
    let film = surface.mesh.faces().find(|(_, face)| !face.is_ghost()).map(|(row, _)| row).unwrap();
    let (area, count) = (surface.film_area(), surface.mesh.face_count());
    let mut data = Columns::new(3, surface.positions.iter().flat_map(|x| x.to_array()).collect());
    let (policy, mut marks) = (Policy::new(0.4), PerVertex::default());
    let transfer = &mut data as &mut dyn Transfer;
    let mut session = froth_surface::operations::Session::new(&mut surface, &policy, transfer, &mut marks, 1);
    let new = session.split_face(film, [0.2, 0.3, 0.5]).unwrap();
    check_all(&surface).unwrap();
    assert_eq!(surface.mesh.face_count(), count + 2);
    assert!((surface.film_area() - area).abs() < 1e-14);
    assert!(DVec3::from_slice(data.of(new)).distance(surface.positions[new]) < 1e-15);
}

#[test]
fn a_split_lays_no_film_flat_on_another_of_the_same_junction() {
    // Bubbles 1 and 2 share the wall (0, 1, 2); the new vertex dents bubble 1 down to a height above the wall.
    let mut set = LabelledTriangles::default();
    for x in [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0), at(0.3, 0.3, 1.0), at(0.3, 0.3, -1.0)] {
        set.add_vertex(x, false);
    }
    film(&mut set, [0, 1, 2], 2, 1, at(0.3, 0.3, 1.0));
    for (apex, region) in [(3, 1), (4, 2)] {
        for [a, b] in [[0, 1], [1, 2], [2, 0]] {
            film(&mut set, [a, b, apex], 0, region, at(0.3, 0.3, 0.0));
        }
    }
    let split = |height: f64| {
        let mut surface = Surface::from_triangles(&set);
        check_all(&surface).unwrap();
        let place = at(0.3, 0.3, height);
        let done = operate(&mut surface, &Policy::new(1.0), |session| {
            session.split(VertexRow(0), VertexRow(3), 0.5, place).is_some()
        });
        check_all(&surface).unwrap();
        done
    };
    assert!(split(1e-2) && split(1e-4));
    assert!(!split(1e-8) && !split(1e-16) && !split(0.0));
}

/// Splits all edges of a bubble of radius 1 that are longer than 1.5 `edge`; how far vertices are from the sphere at most.
fn roundness_after_splits(mut surface: Surface, edge: f64, placement: Placement) -> (Surface, f64) {
    operate(&mut surface, &Policy { placement, ..Policy::new(edge) }, |session| session.split_long_edges());
    check_all(&surface).unwrap();
    let off = surface.positions.iter().map(|x| (x.length() - 1.0).abs()).fold(0.0, f64::max);
    (surface, off)
}

#[test]
fn butterfly_splits_of_a_bubble_lie_nearer_to_the_sphere_and_refine_to_the_same_mesh() {
    let bubble = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.3));
    let (flat, chord) = roundness_after_splits(bubble.clone(), 0.13, Placement::Midpoint);
    let (round, smooth) = roundness_after_splits(bubble.clone(), 0.13, Placement::Butterfly);
    assert!(flat.mesh.vertex_rows() > 3 * bubble.mesh.vertex_rows());
    assert!(smooth < 0.3 * chord, "{smooth:e} {chord:e}");
    // Half as long edges leave out a quarter of what a sphere has more than its mesh.
    let missing = |surface: &Surface| 4.0 / 3.0 * std::f64::consts::PI - surface.volumes()[1];
    assert!((missing(&flat) / missing(&bubble) - 1.0).abs() < 1e-9);
    assert!(missing(&round) < 0.4 * missing(&bubble), "{} {}", missing(&round), missing(&bubble));
}

#[test]
fn a_butterfly_split_falls_back_to_the_middle_where_it_would_cross_a_nearby_film() {
    let bubble = icosphere(DVec3::ZERO, 1.0, 0.3);
    let surface = Surface::from_triangles(&bubble);
    let [a, b] = surface.mesh.edges()[0];
    let middle = surface.positions[a].midpoint(surface.positions[b]);
    // A small bubble just outside the edge, in the way of the bulge.
    let outside = middle.normalize() * (middle.length() + 0.6 * (1.0 - middle.length()));
    let (u, v) = middle.normalize().any_orthonormal_pair();
    let reach = 0.2 * (1.0 - middle.length());
    let mut both = bubble.clone();
    let corners = [u, v, -u - v].map(|way| outside + reach * way);
    tetrahedron_at(&mut both, [corners[0], corners[1], corners[2], outside + 0.3 * middle.normalize()], 2, 0);
    let placed = |set: &LabelledTriangles| {
        let mut surface = Surface::from_triangles(set);
        check_all(&surface).unwrap();
        let length = surface.positions[a].distance(surface.positions[b]);
        // Just short enough an `L` that this edge is split; longer ones are, too.
        let policy = Policy { placement: Placement::Butterfly, ..Policy::new(length / 1.5 * (1.0 - 1e-9)) };
        operate(&mut surface, &policy, |session| session.split_long_edges());
        check_all(&surface).unwrap();
        let nearest = surface.positions.iter().map(|x| x.distance(middle)).fold(f64::INFINITY, f64::min);
        nearest / (1.0 - middle.length())
    };
    assert!(placed(&bubble) > 0.5, "the vertex goes out to the sphere");
    assert!(placed(&both) < 1e-12, "the vertex stays in the middle");
}
