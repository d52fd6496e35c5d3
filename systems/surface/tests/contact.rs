//! The two ways on from a vertex with five sectors: an edge where it is stretched, a film where it is squashed.

use froth_surface::invariants::check_all;
use froth_surface::operations::{Session, contact_candidates, separation_candidates};
use froth_surface::transfer::NoData;
use froth_surface::{Event, EventKind, LabelledTriangles, Policy, Region, Surface, Tracker, VertexRow};
use glam::DVec3;

const TOP: u32 = 1;
const BOTTOM: u32 = 2;

/// Films from the centre (vertex 0) to the edges of a prism with `sides` sides of unit radius: regions 1 above, 2 below, 3 and up around.
fn prism(sides: u32, half_height: f64) -> Surface {
    let mut films = LabelledTriangles::default();
    let centre = films.add_vertex(DVec3::ZERO, false);
    for height in [half_height, -half_height] {
        for i in 0..sides {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(sides);
            films.add_vertex(DVec3::new(angle.cos(), angle.sin(), height), true);
        }
    }
    let top = |i: u32| 1 + i % sides;
    let bottom = |i: u32| 1 + sides + i % sides;
    for i in 0..sides {
        let around = |i: u32| 3 + i % sides;
        films.add_film([centre, top(i), top(i + 1)], [around(i), TOP]);
        films.add_film([centre, bottom(i), bottom(i + 1)], [BOTTOM, around(i)]);
        films.add_film([centre, top(i), bottom(i)], [around(i + sides - 1), around(i)]);
        films.add_film([bottom(i), bottom(i + 1), top(i + 1)], [around(i), 0]);
        films.add_film([bottom(i), top(i + 1), top(i)], [around(i), 0]);
    }
    for i in 1..sides - 1 {
        films.add_film([top(0), top(i), top(i + 1)], [TOP, 0]);
        films.add_film([bottom(0), bottom(i + 1), bottom(i)], [BOTTOM, 0]);
    }
    Surface::from_triangles(&films)
}

/// Separates the centre; gives what happened.
fn separate(surface: &mut Surface) -> Vec<Event> {
    let (mut tracker, mut data, policy) = (Tracker::default(), NoData, Policy::new(0.5));
    let mut session: Session<'_> = tracker.begin(surface, &policy, &mut data);
    assert!(session.separate(VertexRow(0)));
    session.events
}

fn share_film(surface: &Surface, a: u32, b: u32) -> bool {
    surface.mesh.faces().any(|(_, face)| face.borders(Region(a)) && face.borders(Region(b)))
}

#[test]
fn five_sectors_can_be_pulled_apart_or_given_a_film() {
    let surface = prism(3, 1.0);
    check_all(&surface).unwrap();
    assert_eq!(separation_candidates(&surface, VertexRow(0)).len(), 2);
    let [contact] = &contact_candidates(&surface, VertexRow(0))[..] else { panic!("one contact") };
    assert_eq!(contact.poles.map(|region| region.0 <= 2), [true; 2]);
    assert_eq!(contact.around.len(), 3);
}

#[test]
fn a_stretched_vertex_becomes_an_edge() {
    let mut surface = prism(3, 2.0);
    let area = surface.film_area();
    let events = separate(&mut surface);
    check_all(&surface).unwrap();
    assert!(surface.film_area() < area && !share_film(&surface, TOP, BOTTOM));
    assert_eq!(events[0].kind, EventKind::T1);
    assert!(events[0].regions[..2].iter().all(|region| region.0 <= 2));
}

#[test]
fn a_squashed_vertex_becomes_a_film() {
    for sides in [3, 4, 5] {
        let mut surface = prism(sides, 0.25);
        let area = surface.film_area();
        let events = separate(&mut surface);
        check_all(&surface).unwrap();
        assert!(surface.film_area() < area && share_film(&surface, TOP, BOTTOM));
        assert_eq!((events.len(), events[0].kind), (1, EventKind::T1));
        let (around, poles) = events[0].regions.split_at(sides as usize);
        assert!(around.iter().all(|region| region.0 > 2) && poles.iter().all(|region| region.0 <= 2));
    }
}
