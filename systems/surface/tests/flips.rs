//! Flips make triangles rounder, and touch neither junctions nor ghosts nor shape.

#[path = "common/scenes.rs"]
mod scenes;

use froth_surface::invariants::check_all;
use froth_surface::shapes::{disc, double_bubble, lattice};
use froth_surface::{LabelledTriangles, Policy, Surface, VertexRow};
use glam::DVec3;
use scenes::{at, edges_with, film, ghosts, operate, tetrahedron_at};

/// A bubble under a long diamond (rows 0 to 3) whose edge (0, 1) is its long diagonal; corners 2 and 3 are `lift` higher.
fn diamond(lift: f64) -> LabelledTriangles {
    let mut set = LabelledTriangles::default();
    for x in [at(-1.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, 0.4, lift), at(0.0, -0.4, lift), at(0.0, 0.0, -1.0)] {
        set.add_vertex(x, false);
    }
    let above = at(0.0, 0.0, 5.0);
    film(&mut set, [0, 1, 2], 1, 0, above);
    film(&mut set, [0, 1, 3], 1, 0, above);
    for [p, q] in [[0, 2], [2, 1], [1, 3], [3, 0]] {
        film(&mut set, [p, q, 4], 0, 1, at(0.0, 0.0, -0.1));
    }
    set
}

fn flip(surface: &mut Surface, a: u32, b: u32) -> bool {
    operate(surface, &Policy::new(1.0), |session| session.flip(VertexRow(a), VertexRow(b)).is_some())
}

#[test]
fn a_long_diagonal_is_flipped_without_any_change_of_volume() {
    let mut surface = Surface::from_triangles(&diamond(0.0));
    check_all(&surface).unwrap();
    let volume = surface.volumes()[1];
    assert!(flip(&mut surface, 0, 1));
    check_all(&surface).unwrap();
    assert!(surface.mesh.has_edge(VertexRow(2), VertexRow(3)) && !surface.mesh.has_edge(VertexRow(0), VertexRow(1)));
    assert!((surface.volumes()[1] - volume).abs() < 1e-15);
    assert!(!flip(&mut surface, 2, 3), "and not back");
}

#[test]
fn a_sharp_bend_is_not_flipped() {
    let mut surface = Surface::from_triangles(&diamond(0.3));
    check_all(&surface).unwrap();
    let before = surface.clone();
    assert!(!flip(&mut surface, 0, 1));
    assert_eq!(surface, before);
}

#[test]
fn a_flip_does_not_sweep_over_a_bubble() {
    // The slight roof and the flipped pair enclose a flat tetrahedron; a speck of gas is inside it.
    let (lift, mut set) = (-0.03, diamond(-0.03));
    let middle = at(0.0, 0.0, 0.5 * lift);
    let size = 2e-3;
    let corners = [at(0.0, 0.0, 1.0), at(1.0, 0.0, -0.3), at(-0.5, 0.8, -0.3), at(-0.5, -0.8, -0.3)];
    tetrahedron_at(&mut set, corners.map(|x| middle + size * x), 2, 1);
    let mut surface = Surface::from_triangles(&set);
    check_all(&surface).unwrap();
    let before = surface.clone();
    assert!(!flip(&mut surface, 0, 1), "the speck would be outside of its bubble");
    assert_eq!(surface, before);
    let mut free = Surface::from_triangles(&diamond(lift));
    assert!(flip(&mut free, 0, 1));
}

#[test]
fn junctions_ghosts_and_wires_are_not_flipped() {
    let bubbles = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.3));
    let blocks = Surface::from_triangles(&lattice(DVec3::ZERO, [2; 3], 1.0, 0.5));
    for (surface, faces) in [(&bubbles, 3), (&blocks, 3), (&blocks, 4)] {
        for [a, b] in edges_with(surface, faces) {
            assert!(!flip(&mut surface.clone(), a.0, b.0));
        }
    }
    let mut film = Surface::from_triangles(&disc(DVec3::ZERO, 1.0, DVec3::Z, 0.25));
    let (rim, closed) = (film.pinned.iter().filter(|pinned| **pinned).count(), ghosts(&film));
    let of_ghosts = |surface: &Surface| {
        surface.mesh.faces().filter(|(_, f)| f.is_ghost()).map(|(_, f)| f.vertices()).collect::<Vec<_>>()
    };
    let before = of_ghosts(&film);
    film.positions.iter_mut().for_each(|x| *x = at(x.x * (1.0 + 0.8 * x.x * (1.0 - x.x * x.x)), x.y, x.z));
    let _ = operate(&mut film, &Policy::new(0.25), |session| session.flip_edges());
    assert_eq!((film.pinned.iter().filter(|pinned| **pinned).count(), ghosts(&film)), (rim, closed));
    assert_eq!(of_ghosts(&film), before);
}

#[test]
fn flips_raise_the_smallest_angle_and_come_to_an_end() {
    let mut surface = Surface::from_triangles(&lattice(DVec3::ZERO, [2, 1, 1], 1.0, 0.2));
    surface.positions.iter_mut().for_each(|x| x.x += 0.9 * x.y);
    let least = |surface: &Surface| {
        let angle = |[a, b, c]: [DVec3; 3]| (b - a).angle_between(c - a);
        let corners = surface.mesh.faces().map(|(row, _)| surface.corners(row));
        corners.flat_map(|[a, b, c]| [angle([a, b, c]), angle([b, c, a]), angle([c, a, b])]).fold(4.0, f64::min)
    };
    let (before, area) = (least(&surface), surface.film_area());
    let flips = operate(&mut surface, &Policy::new(0.2), |session| session.flip_edges());
    check_all(&surface).unwrap();
    assert!(flips > 10, "{flips}");
    assert!(least(&surface) >= before);
    assert!((surface.film_area() - area).abs() < 1e-12, "flat films stay flat");
    assert_eq!(operate(&mut surface, &Policy::new(0.2), |session| session.flip_edges()), 0);
}
