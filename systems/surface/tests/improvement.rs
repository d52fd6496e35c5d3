//! Thin faces are improved: by moves that change no volume, and by insertions with the flips that follow.

#[path = "common/random.rs"]
mod random;
#[path = "common/scenes.rs"]
mod scenes;
#[path = "common/voxels.rs"]
mod voxels;

use froth_surface::invariants::check_all;
use froth_surface::operations::{Mark, Session};
use froth_surface::shapes::{disc, double_bubble, icosphere, lattice};
use froth_surface::transfer::Columns;
use froth_surface::{PerVertex, Policy, Surface, VertexRow};
use glam::DVec3;
use random::Dice;
use scenes::{edges_with, junctions, operate};

fn least_angle(surface: &Surface) -> f64 {
    let films = surface.mesh.faces().filter(|(_, face)| !face.is_ghost());
    let angles = films.flat_map(|(row, _)| {
        let [a, b, c] = surface.corners(row);
        [(a, b, c), (b, c, a), (c, a, b)].map(|(at, p, q)| (p - at).angle_between(q - at).to_degrees())
    });
    angles.fold(180.0, f64::min)
}

/// Puts a vertex most of the way to a neighbour.
fn displace(surface: &mut Surface, [a, b]: [VertexRow; 2], part: f64) {
    let place = surface.positions[a].lerp(surface.positions[b], part);
    surface.positions[a] = place;
}

fn assert_same_volumes(found: &Surface, wanted: &Surface) {
    for (x, y) in found.volumes().iter().zip(&wanted.volumes()) {
        assert!((x - y).abs() < 1e-13, "{x} and {y}");
    }
}

#[test]
fn a_vertex_near_its_neighbour_moves_away_without_changing_a_volume() {
    let mut surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.3));
    let edge = edges_with(&surface, 2)[40];
    displace(&mut surface, edge, 0.6);
    let (before, angle) = (surface.clone(), least_angle(&surface));
    let counts = operate(&mut surface, &Policy::new(0.3), |session| {
        session.improve_faces();
        session.counts
    });
    check_all(&surface).unwrap();
    assert!(counts.moves > 0 && counts.collapses + counts.splits == 0, "{counts:?}");
    assert!(angle < 25.0 && least_angle(&surface) > 30.0, "{angle} {}", least_angle(&surface));
    assert_same_volumes(&surface, &before);
}

#[test]
fn a_vertex_on_a_curve_moves_along_it_without_changing_a_volume() {
    let mut surface = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.2));
    let edge = edges_with(&surface, 3)[5];
    displace(&mut surface, edge, 0.7);
    let (before, curve) = (surface.clone(), edges_with(&surface, 3).len());
    let angle = least_angle(&surface);
    let counts = operate(&mut surface, &Policy::new(0.2), |session| {
        session.improve_faces();
        session.counts
    });
    check_all(&surface).unwrap();
    assert!(counts.moves > 0 && counts.collapses + counts.splits == 0, "{counts:?}");
    assert!(angle < 25.0 && least_angle(&surface) > 25.0, "{angle} {}", least_angle(&surface));
    assert_eq!((edges_with(&surface, 3).len(), junctions(&surface, edge[0])), (curve, 2));
    assert_same_volumes(&surface, &before);
}

#[test]
fn values_are_looked_up_where_a_vertex_arrives() {
    let mut surface = Surface::from_triangles(&disc(DVec3::ZERO, 1.0, DVec3::Z, 0.25));
    let inside = |edge: &&[VertexRow; 2]| edge.iter().all(|v| surface.positions[*v].length() < 0.5);
    let edge = *edges_with(&surface, 2).iter().find(inside).unwrap();
    displace(&mut surface, edge, 0.7);
    let field = |x: DVec3| 3.0 * x.x - 2.0 * x.y + 1.0;
    let mut columns = Columns::new(1, surface.positions.iter().map(|x| field(*x)).collect());
    let mut marks = PerVertex::<Mark>::default();
    let policy = Policy::new(0.25);
    let mut session = Session::new(&mut surface, &policy, &mut columns, &mut marks, 1);
    session.improve_faces();
    assert!(session.counts.moves > 0);
    for v in surface.mesh.vertices() {
        assert!((columns.of(v)[0] - field(surface.positions[v])).abs() < 1e-12, "{v}");
    }
}

#[test]
fn improvement_of_a_shaken_foam_raises_the_smallest_angle_and_comes_to_an_end() {
    let edge = 0.35;
    let mut surface = Surface::from_triangles(&lattice(DVec3::ZERO, [2, 2, 2], 1.0, edge));
    let mut dice = Dice::new(3);
    surface.positions.0.iter_mut().for_each(|x| *x += 0.3 * edge * dice.vector());
    check_all(&surface).unwrap();
    let policy = Policy { flips: true, ..Policy::new(edge) };
    let improve = |surface: &mut Surface| {
        operate(surface, &policy, |session| {
            session.improve_faces();
            session.counts
        })
    };
    let (before, volumes) = (least_angle(&surface), surface.volumes());
    let first = improve(&mut surface);
    check_all(&surface).unwrap();
    assert!(first.moves > 0 && first.splits > 0 && least_angle(&surface) > before.max(20.0));
    let change = surface.volumes().iter().zip(&volumes).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
    assert!(change < 0.05, "{change}");
    improve(&mut surface);
    let last = improve(&mut surface);
    assert_eq!(last.moves + last.splits + last.collapses + last.flips, 0, "{last:?}");
}
