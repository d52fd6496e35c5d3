//! Gas that comes apart takes labels of its own, and volumes add up.

#[path = "common/scenes.rs"]
mod scenes;

use froth_surface::bodies::{divide, shells};
use froth_surface::invariants::check_all;
use froth_surface::shapes::{catenoid, icosphere, lattice};
use froth_surface::transfer::{Circulations, NoData};
use froth_surface::{EventKind, LabelledTriangles, Policy, Region, Surface, Tracker};
use glam::DVec3;
use scenes::{at, hourglass};

#[test]
fn a_pinched_bubble_becomes_two_whose_volumes_add_up() {
    let mut surface = Surface::from_triangles(&hourglass(0.1));
    let mut jumps = Circulations::new(&surface, |v, _, _| f64::from(v.0));
    let policy = Policy { longest: 9.0, snap: 1e-3, ..Policy::new(1.0) };
    let mut tracker = Tracker::default();
    let (mut events, mut divisions) = (Vec::new(), Vec::new());
    for _ in 0..6 {
        let before = surface.volumes()[1];
        let done = tracker.remesh(&mut surface, &policy, &mut jumps);
        check_all(&surface).unwrap();
        events.extend(done.events);
        if let [division] = done.divisions[..] {
            let whole = surface.volumes()[1] + surface.volumes()[2];
            assert!((division.volume - surface.volumes()[2]).abs() < 1e-14);
            assert!((division.rest - surface.volumes()[1]).abs() < 1e-14);
            // The pinch pulls two tips 0.4 L apart, on cones that are 1 L high: it takes about a seventh.
            assert!((whole - before).abs() < 0.2 * before, "{whole} of {before}");
            assert!(division.rest >= division.volume, "the larger body keeps its label");
        }
        divisions.extend(done.divisions);
    }
    assert_eq!(divisions.len(), 1, "{events:?}");
    assert_eq!((divisions[0].from, divisions[0].to), (Region(1), Region(2)));
    let kinds: Vec<EventKind> = events.iter().map(|event| event.kind).collect();
    assert!(kinds.contains(&EventKind::Pinch) && kinds.contains(&EventKind::Division), "{kinds:?}");
    for v in surface.mesh.vertices() {
        let region = surface.mesh.regions_of(v)[1];
        assert!(jumps.pairs(v).eq([[Region(0), region]]), "{v}: its circulation moved to the new label");
        assert!(jumps.get(v, Region(0), region).is_some_and(|value| value != 0.0 || v.0 == 0));
    }
}

/// Spheres by centre, radius, inside and outside.
fn balls(of: &[(f64, f64, u32, u32)]) -> Surface {
    let mut set = LabelledTriangles::default();
    for (x, radius, inside, outside) in of {
        let ball = icosphere(at(*x, 0.0, 0.0), *radius, 0.5 * radius);
        let first = set.positions.len() as u32;
        ball.positions.iter().for_each(|x| _ = set.add_vertex(*x, false));
        ball.triangles.iter().for_each(|t| set.add_film(t.map(|v| v + first), [*inside, *outside]));
    }
    Surface::from_triangles(&set)
}

#[test]
fn the_largest_body_keeps_the_label_and_holes_go_with_their_bodies() {
    // Two balls of region 1; the smaller one holds a bubble of region 2.
    let mut surface = balls(&[(0.0, 1.0, 1, 0), (3.0, 0.8, 1, 0), (3.1, 0.3, 2, 1)]);
    let volumes = surface.volumes();
    assert_eq!(shells(&surface).len(), 6);
    let mut next = Region(7);
    let divisions = divide(&mut surface, &mut next);
    check_all(&surface).unwrap();
    assert_eq!((divisions.len(), next), (1, Region(8)));
    assert_eq!((divisions[0].from, divisions[0].to), (Region(1), Region(7)));
    let after = surface.volumes();
    assert!((after[1] + after[7] - volumes[1]).abs() < 1e-13);
    assert!((after[2] - volumes[2]).abs() < 1e-15);
    assert!(surface.mesh.faces().all(|(_, face)| !(face.borders(Region(2)) && face.borders(Region(1)))));
    assert!(divide(&mut surface, &mut next).is_empty(), "once is enough");
}

#[test]
fn a_pocket_of_outside_air_that_is_cut_off_becomes_a_bubble() {
    let mut surface = balls(&[(0.0, 1.0, 1, 0), (0.1, 0.4, 0, 1)]);
    let mut next = Region(2);
    let divisions = divide(&mut surface, &mut next);
    check_all(&surface).unwrap();
    assert_eq!(divisions.len(), 1);
    assert_eq!((divisions[0].from, divisions[0].to), (Region::OUTSIDE, Region(2)));
    assert!((surface.volumes()[2] - divisions[0].volume).abs() < 1e-15);
}

#[test]
fn what_hangs_together_is_not_divided() {
    for set in [lattice(DVec3::ZERO, [2; 3], 1.0, 0.5), catenoid(DVec3::ZERO, DVec3::Z, 1.0, 1.0, 0.3)] {
        let mut surface = Surface::from_triangles(&set);
        let before = surface.clone();
        assert!(divide(&mut surface, &mut Region(99)).is_empty());
        assert_eq!(surface, before);
    }
}

#[test]
fn labels_of_vanished_regions_are_not_given_again() {
    let mut surface = balls(&[(0.0, 1.0, 1, 0), (3.0, 0.8, 1, 0), (6.0, 0.5, 9, 0)]);
    let (mut tracker, mut events) = (Tracker::default(), Vec::new());
    let first = tracker.divide(&mut surface, &mut NoData, &mut events);
    assert_eq!((first.len(), first[0].to, events.len()), (1, Region(10), 1));
    let faces: Vec<_> = surface.mesh.faces().filter(|(_, f)| f.borders(Region(10))).map(|(row, _)| row).collect();
    faces.into_iter().for_each(|row| _ = surface.mesh.remove_face(row));
    let again: Vec<_> = surface.mesh.faces().filter(|(_, f)| f.borders(Region(9))).map(|(row, _)| row).collect();
    again
        .into_iter()
        .for_each(|row| surface.mesh.relabel(row, |label| if label == Region(9) { Region(1) } else { label }));
    let second = tracker.divide(&mut surface, &mut NoData, &mut events);
    assert_eq!(second[0].to, Region(11));
}
