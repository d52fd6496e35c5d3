//! A film bursts: two regions become one, and nothing else changes.

#[path = "common/scenes.rs"]
mod scenes;

use froth_surface::invariants::check_all;
use froth_surface::operations::BurstRefused;
use froth_surface::shapes::{disc, double_bubble, icosphere, lattice};
use froth_surface::{EventKind, LabelledTriangles, Policy, Region, Surface};
use glam::DVec3;
use scenes::{edges_with, operate, share_film};

fn burst(surface: &mut Surface, gone: u32, into: u32) -> Result<DVec3, BurstRefused> {
    operate(surface, &Policy::new(0.5), |session| session.burst(Region(gone), Region(into)))
}

#[test]
fn the_wall_of_a_double_bubble_bursts_and_one_bubble_is_left() {
    let mut surface = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.3));
    let volumes = surface.volumes();
    let (place, events) = operate(&mut surface, &Policy::new(0.3), |session| {
        (session.burst(Region(2), Region(1)).unwrap(), session.events.clone())
    });
    check_all(&surface).unwrap();
    assert_eq!(surface.mesh.regions(), [Region(0), Region(1)]);
    assert!((surface.volumes()[1] - volumes[1] - volumes[2]).abs() < 1e-13);
    assert!(edges_with(&surface, 3).is_empty());
    assert_eq!(events.len(), 1);
    assert_eq!((events[0].kind, events[0].place), (EventKind::Burst, place));
    assert!(place.is_finite() && place.length() < 2.0);
}

#[test]
fn every_film_of_a_block_of_cubes_can_burst() {
    let whole = Surface::from_triangles(&lattice(DVec3::ZERO, [2; 3], 1.0, 0.5));
    let volumes = whole.volumes();
    for gone in 1..9 {
        for into in (0..9).filter(|into| *into != gone) {
            let mut surface = whole.clone();
            if !share_film(&surface, gone, into) {
                assert_eq!(burst(&mut surface, gone, into), Err(BurstRefused::NoFilm(Region(gone), Region(into))));
                assert_eq!(surface, whole);
                continue;
            }
            burst(&mut surface, gone, into).unwrap();
            check_all(&surface).unwrap();
            assert!(!surface.mesh.regions().contains(&Region(gone)));
            let after = surface.volumes();
            let wanted = volumes[into as usize] + volumes[gone as usize];
            assert!((after[into as usize] - wanted).abs() < 1e-13);
            let others = (1..after.len()).filter(|r| *r != gone as usize && *r != into as usize);
            others.for_each(|r| assert!((after[r] - volumes[r]).abs() < 1e-13));
        }
    }
}

#[test]
fn bubble_after_bubble_bursts_until_nothing_is_left() {
    let mut surface = Surface::from_triangles(&lattice(DVec3::ZERO, [2; 3], 1.0, 0.5));
    for gone in 1..9 {
        burst(&mut surface, gone, 0).unwrap();
        check_all(&surface).unwrap();
    }
    assert_eq!((surface.mesh.face_count(), surface.mesh.vertices().count()), (0, 0));
    surface.compact();
    check_all(&surface).unwrap();
    assert_eq!(surface.positions.len(), 0);
}

#[test]
fn the_outside_and_open_pockets_do_not_join_a_bubble() {
    let mut surface = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.3));
    let before = surface.clone();
    assert_eq!(burst(&mut surface, 0, 1), Err(BurstRefused::Outside(Region(1))));
    surface.open = vec![Region(1)];
    assert_eq!(burst(&mut surface, 1, 2), Err(BurstRefused::Outside(Region(2))));
    assert!(burst(&mut surface, 2, 1).is_ok(), "a bubble may join a pocket");
    assert_ne!(surface.mesh, before.mesh);
}

#[test]
fn an_open_film_bursts_with_the_ghosts_behind_it() {
    let mut surface = Surface::from_triangles(&disc(DVec3::ZERO, 1.0, DVec3::Z, 0.4));
    let pocket = surface.open[0].0;
    burst(&mut surface, pocket, 0).unwrap();
    check_all(&surface).unwrap();
    assert_eq!(surface.mesh.face_count(), 0);
}

/// A bubble of radius 1, and far from it one that the mesh of edges `L` can hardly hold, of `times` the least volume.
fn with_speck(times: f64) -> Surface {
    let least = Policy::new(0.3).least_volume();
    let radius = (times * least * 3.0 / (4.0 * std::f64::consts::PI)).cbrt();
    let mut speck = icosphere(3.0 * DVec3::X, radius, 0.8 * radius);
    // Flat faces hold less than the sphere.
    let held = Surface::from_triangles(&speck).volumes()[1];
    let scale = (times * least / held).cbrt();
    speck.positions.iter_mut().for_each(|x| *x = 3.0 * DVec3::X + (*x - 3.0 * DVec3::X) * scale);
    let mut both: LabelledTriangles = icosphere(DVec3::ZERO, 1.0, 0.3);
    both.append(&speck);
    Surface::from_triangles(&both)
}

#[test]
fn a_bubble_smaller_than_the_mesh_can_hold_vanishes_and_a_larger_one_stays() {
    for (times, regions) in [(0.99, 2), (1.01, 3)] {
        let mut surface = with_speck(times);
        let (joined, events) =
            operate(&mut surface, &Policy::new(0.3), |session| (session.dissolve_specks(), session.events.clone()));
        check_all(&surface).unwrap();
        assert_eq!(surface.mesh.regions().len(), regions, "{times}");
        assert_eq!(joined, if regions == 2 { vec![(Region(2), Region(0))] } else { vec![] });
        assert!(
            events.iter().all(|event| event.kind == EventKind::Vanished && event.place.distance(3.0 * DVec3::X) < 0.1)
        );
        assert_eq!(events.len(), joined.len());
    }
}

#[test]
fn a_speck_between_bubbles_joins_the_one_that_it_shares_most_film_with() {
    let mut surface = Surface::from_triangles(&lattice(DVec3::ZERO, [2, 1, 1], 1.0, 0.5));
    let volumes = surface.volumes();
    let policy = Policy::new(3.0 * volumes[1].cbrt());
    let joined = operate(&mut surface, &policy, |session| session.dissolve_specks());
    check_all(&surface).unwrap();
    // Both are specks for such a mesh: five of the six sides of each are towards the outside.
    assert_eq!(joined, [(Region(1), Region(0)), (Region(2), Region(0))]);
    assert_eq!(surface.mesh.face_count(), 0);
}
