//! What meets without a film is pulled apart, until every two sectors at a vertex share a film.

#[path = "common/random.rs"]
mod random;
#[path = "common/scenes.rs"]
mod scenes;
#[path = "common/voxels.rs"]
mod voxels;

use froth_surface::invariants::check_all;
use froth_surface::operations::Session;
use froth_surface::shapes::lattice;
use froth_surface::transfer::NoData;
use froth_surface::{EventKind, LabelledTriangles, PerVertex, Policy, Surface, Tracker, VertexRow};
use glam::DVec3;
use random::Dice;
use scenes::{at, bow_tie, ghosts, hexagon, irregular, operate, share_film, spindle, tetrahedron, tetrahedron_at};
use voxels::voxels;

fn crossed_edges(surface: &Surface) -> usize {
    surface.mesh.edges().into_iter().filter(|[a, b]| surface.mesh.faces_of_edge(*a, *b).len() > 3).count()
}

/// Passes of separations until one does nothing.
fn separate_all(surface: &mut Surface, policy: &Policy) {
    let mut tracker = Tracker::default();
    for _ in 0..12 {
        let mut data = NoData;
        let mut session: Session<'_> = tracker.begin(surface, policy, &mut data);
        session.separate_vertices();
        let separations = session.counts.separations;
        check_all(surface).unwrap();
        if separations == 0 {
            return;
        }
    }
    panic!("separations go on and on");
}

#[test]
fn every_edge_of_a_block_of_cubes_comes_to_have_three_faces() {
    for n in [2, 3] {
        let mut surface = Surface::from_triangles(&lattice(DVec3::ZERO, [n; 3], 1.0, 1.0));
        check_all(&surface).unwrap();
        assert!(crossed_edges(&surface) > 0 && irregular(&surface) > 0);
        separate_all(&mut surface, &Policy::new(1.0));
        assert_eq!((crossed_edges(&surface), irregular(&surface)), (0, 0));
    }
}

#[test]
fn rows_survive_the_closing_of_gaps() {
    let mut surface = Surface::from_triangles(&lattice(DVec3::ZERO, [2; 3], 1.0, 1.0));
    let mut tracker = Tracker::default();
    let report = tracker.remesh(&mut surface, &Policy::new(1.0), &mut NoData);
    assert!(report.counts.separations > 0);
    check_all(&surface).unwrap();
    assert!(surface.mesh.is_compact());
    assert!(surface.mesh.has_vertex(VertexRow(0)));
}

/// The cells around the inner corner (2, 2, 2) of a box of 4^3 cells: 1 and 2 touch there alone, and share a film elsewhere;
/// `c` and `d` are halves of the ring of six cells between them.
fn hourglass_of_four(c: u32, d: u32) -> Surface {
    let mut labels = [0; 64];
    let mut put = |label: u32, cells: &[[usize; 3]]| {
        cells.iter().for_each(|[x, y, z]| labels[x + 4 * (y + 4 * z)] = label);
    };
    put(1, &[[1, 1, 1], [0, 1, 1], [0, 2, 1], [0, 3, 1], [0, 3, 2], [0, 3, 3], [1, 3, 3], [2, 3, 3]]);
    put(2, &[[2, 2, 2], [2, 2, 3]]);
    put(c, &[[2, 1, 1], [2, 2, 1], [1, 2, 1]]);
    put(d, &[[1, 2, 2], [1, 1, 2], [2, 1, 2]]);
    Surface::from_triangles(&voxels([4; 3], 1.0, &labels))
}

fn vertex_at(surface: &Surface, place: DVec3) -> VertexRow {
    surface.mesh.vertices().find(|v| surface.positions[*v].distance(place) < 1e-9).unwrap()
}

#[test]
fn bubbles_that_share_a_film_elsewhere_still_separate_where_they_meet_in_a_point() {
    for (c, d) in [(3, 4), (0, 0)] {
        let mut surface = hourglass_of_four(c, d);
        check_all(&surface).unwrap();
        assert!(share_film(&surface, 1, 2), "far away");
        let v = vertex_at(&surface, DVec3::splat(3.0));
        assert!(
            surface.mesh.regions_of(v).iter().any(|r| r.0 == 1) && surface.mesh.regions_of(v).iter().any(|r| r.0 == 2)
        );
        separate_all(&mut surface, &Policy::new(1.0));
        assert_eq!(irregular(&surface), 0, "{c} {d}");
        let both = |v: &VertexRow| [1, 2].iter().all(|r| surface.mesh.regions_of(*v).iter().any(|other| other.0 == *r));
        let near = surface.mesh.vertices().filter(|v| surface.positions[*v].distance(DVec3::splat(3.0)) < 0.6);
        assert_eq!(near.filter(both).count(), 0, "1 and 2 are apart");
    }
}

#[test]
fn bubbles_that_touch_in_a_point_or_an_edge_are_pinched_apart() {
    let mut by_edge = LabelledTriangles::default();
    tetrahedron_at(&mut by_edge, [-DVec3::X, DVec3::X, at(0.5, -0.8, -1.0), at(-0.5, 0.8, -1.0)], 1, 0);
    let above = [at(0.5, -0.8, 1.0), at(-0.5, 0.8, 1.0)].map(|x| by_edge.add_vertex(x, false));
    tetrahedron(&mut by_edge, [0, 1, above[0], above[1]], 2, 0);
    for set in [bow_tie(), by_edge] {
        let mut surface = Surface::from_triangles(&set);
        check_all(&surface).unwrap();
        let (area, volumes) = (surface.film_area(), surface.volumes());
        let events = operate(&mut surface, &Policy::new(1.0), |session| {
            for _ in 0..4 {
                session.step += 1;
                session.separate_vertices();
            }
            session.events.clone()
        });
        check_all(&surface).unwrap();
        assert!(!events.is_empty() && events.iter().all(|event| event.kind == EventKind::Pinch), "{events:?}");
        assert!(surface.mesh.vertices().all(|v| surface.mesh.regions_of(v).len() == 2));
        assert!(surface.film_area() < area);
        assert_eq!(surface.volumes().len(), volumes.len());
        assert_eq!(froth_surface::bodies::shells(&surface).len(), 4, "two closed films have two sides each");
    }
}

#[test]
fn a_vertex_on_a_wire_is_not_separated() {
    let mut surface = Surface::from_triangles(&bow_tie());
    surface.pinned[VertexRow(0)] = true;
    let before = surface.clone();
    assert!(!operate(&mut surface, &Policy::new(1.0), |session| session.separate(VertexRow(0))));
    assert_eq!(surface, before);
}

#[test]
fn a_separation_with_films_in_the_way_is_postponed_and_leaves_no_trace() {
    let mut set = bow_tie();
    let speck = [at(0.0, 0.0, 1.0), at(1.0, 0.0, -0.3), at(-0.5, 0.8, -0.3), at(-0.5, -0.8, -0.3)];
    let free = set.clone();
    for (side, around) in [(1.0, 1), (-1.0, 2)] {
        tetrahedron_at(&mut set, speck.map(|x| at(0.06 * side, 0.0, 0.0) + 0.01 * x), 2 + around, around);
    }
    let mut surface = Surface::from_triangles(&set);
    check_all(&surface).unwrap();
    let before = surface.clone();
    let (mut marks, mut data, policy) = (PerVertex::default(), NoData, Policy::new(1.0));
    let mut session = Session::new(&mut surface, &policy, &mut data, &mut marks, 1);
    assert_eq!(session.separate_vertices(), 0);
    assert!(session.counts.blocked > 0 && session.events.is_empty());
    assert!(marks[VertexRow(0)].dirty, "it is tried again in the next pass");
    assert_eq!(surface, before);
    assert!(operate(&mut Surface::from_triangles(&free), &policy, |session| session.separate(VertexRow(0))));
}

#[test]
fn a_bubble_on_a_film_beside_ghosts_is_pinched_off() {
    let mut set = hexagon();
    let above = [at(0.6, 0.0, 0.8), at(-0.3, 0.5, 0.8), at(-0.3, -0.5, 0.8)].map(|x| set.add_vertex(x, false));
    let labels = set.triangles.len();
    tetrahedron(&mut set, [0, above[0], above[1], above[2]], 2, 0);
    set.ghosts.resize(labels + 4, false);
    let mut surface = Surface::from_triangles(&set);
    check_all(&surface).unwrap();
    let closed = ghosts(&surface);
    assert!(operate(&mut surface, &Policy::new(0.5), |session| session.separate(VertexRow(0))));
    check_all(&surface).unwrap();
    assert_eq!(ghosts(&surface), closed);
    assert_eq!(irregular(&surface), 0);
}

#[test]
fn a_star_whose_halves_have_one_middle_and_one_pull_gives_no_nan() {
    // A cone with four sides in one with eight: rings at the same height, radii such that both pull the tip equally.
    let (height, inner) = (1.0, 0.6);
    let pull = |sides: f64, apothem: f64| {
        let radius = apothem / (std::f64::consts::PI / sides).cos();
        sides * radius * (std::f64::consts::PI / sides).sin() * height / f64::hypot(height, apothem)
    };
    let ratio = pull(4.0, inner) / (8.0 * (std::f64::consts::PI / 8.0).tan());
    let outer = ratio / (1.0 - ratio * ratio).sqrt();
    assert!((pull(8.0, outer) - pull(4.0, inner)).abs() < 1e-12);
    let mut set = LabelledTriangles::default();
    let tip = set.add_vertex(DVec3::ZERO, false);
    let radius = |sides: f64, apothem: f64| apothem / (std::f64::consts::PI / sides).cos();
    spindle(&mut set, tip, (height, radius(4.0, inner), 4), at(1.5, 0.0, 0.0), [2, 1]);
    spindle(&mut set, tip, (height, radius(8.0, outer), 8), at(2.0, 0.0, 0.0), [1, 0]);
    let mut surface = Surface::from_triangles(&set);
    check_all(&surface).unwrap();
    operate(&mut surface, &Policy::new(0.5), |session| session.separate(VertexRow(0)));
    assert!(surface.positions.iter().all(|x| x.is_finite()));
    check_all(&surface).unwrap();
}

#[test]
fn random_neighbourhoods_of_up_to_eight_regions_come_apart_whole() {
    let mut dice = Dice::new(5);
    for regions in 2..9 {
        for _ in 0..6 {
            let labels: Vec<u32> = (0..27).map(|_| dice.below(regions) as u32).collect();
            let mut surface = Surface::from_triangles(&voxels([3; 3], 1.0, &labels));
            check_all(&surface).unwrap();
            separate_all(&mut surface, &Policy::new(1.0));
            assert!(crossed_edges(&surface) <= 2, "{regions} regions: {} crossed edges", crossed_edges(&surface));
        }
    }
}

#[test]
fn a_tie_is_decided_the_same_way_every_time() {
    let separated = || {
        let mut surface = Surface::from_triangles(&lattice(DVec3::ZERO, [2, 2, 1], 1.0, 1.0));
        separate_all(&mut surface, &Policy::new(1.0));
        surface
    };
    assert_eq!(separated(), separated());
}

#[test]
fn passes_without_motion_come_to_rest() {
    let mut surface = Surface::from_triangles(&lattice(DVec3::ZERO, [2; 3], 1.0, 0.5));
    let (mut tracker, policy) = (Tracker::default(), Policy::new(0.5));
    let passes: Vec<_> = (0..30).map(|_| tracker.remesh(&mut surface, &policy, &mut NoData).counts).collect();
    check_all(&surface).unwrap();
    let late: u64 = passes[20..].iter().map(|c| c.separations + c.collapses + c.splits + c.snaps).sum();
    assert_eq!(late, 0, "{passes:?}");
    assert!(passes[0].separations > 0);
}
