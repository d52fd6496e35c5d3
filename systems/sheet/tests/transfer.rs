//! Potentials through changes of the mesh: linear fields stay linear, gauges do not matter, and no film is ever without a circulation.

use froth_sheet::{Layout, Potentials};
use froth_surface::shapes::random::Random;
use froth_surface::shapes::{cube, double_bubble, icosphere, lattice, sphere_lattice};
use froth_surface::{EventKind, LabelledTriangles, Policy, Region, Surface, Tracker, VertexRow};
use glam::DVec3;
use proptest::prelude::{ProptestConfig, any, proptest};

/// Films whose potentials are known, open for operations.
struct Foam {
    surface: Surface,
    potentials: Potentials,
    tracker: Tracker,
}

impl Foam {
    /// Potential `field(region, x)`, each vertex in a gauge of its own: `gauge` times a random number.
    fn new(set: &LabelledTriangles, gauge: f64, field: impl Fn(Region, DVec3) -> f64) -> Self {
        let surface = Surface::from_triangles(set);
        let layout = Layout::new(&surface);
        let mut dice = Random::new(7);
        let gauges: Vec<f64> = surface.positions.iter().map(|_| gauge * dice.next_signed()).collect();
        let value = |side: usize| {
            let v = layout.vertex_of(side as u32) as usize;
            field(layout.regions()[side], surface.positions.0[v]) + gauges[v]
        };
        let values: Vec<f64> = (0..layout.side_count()).map(value).collect();
        let potentials = Potentials::scattered(&layout, &values, &values);
        Self { surface, potentials, tracker: Tracker::default() }
    }

    fn remesh(&mut self, edge: f64) -> Vec<EventKind> {
        self.remesh_with(&Policy { flips: true, ..Policy::new(edge) })
    }

    fn remesh_with(&mut self, policy: &Policy) -> Vec<EventKind> {
        let done = self.tracker.remesh(&mut self.surface, policy, &mut self.potentials);
        done.events.into_iter().map(|event| event.kind).collect()
    }

    /// Joins a region to another; `false` where that is refused.
    fn burst(&mut self, gone: u32, into: u32, edge: f64) -> bool {
        let policy = Policy::new(edge);
        let mut session = self.tracker.begin(&mut self.surface, &policy, &mut self.potentials);
        let is_done = session.burst(Region(gone), Region(into)).is_ok();
        let mut events = session.events;
        if is_done {
            self.tracker.divide(&mut self.surface, &mut self.potentials, &mut events);
        }
        self.tracker.close_up(&mut self.surface, &mut self.potentials);
        is_done
    }

    /// Every film at every one of its corners: vertex, its regions in the back and in front, its circulation.
    fn circulations(&self) -> Vec<(VertexRow, Region, Region, Option<f64>)> {
        let films = self.surface.mesh.faces().filter(|(_, face)| !face.is_ghost());
        let corners = films.flat_map(|(_, face)| {
            let [i, j] = face.labels();
            face.vertices().map(|v| (v, i, j, self.potentials.circulation(v, i, j)))
        });
        corners.collect()
    }

    /// Largest deviation of circulations from those of a field.
    fn deviation(&self, field: impl Fn(Region, DVec3) -> f64) -> f64 {
        let off = |(v, i, j, gamma): (VertexRow, Region, Region, Option<f64>)| {
            let x = self.surface.positions[v];
            (gamma.unwrap() - field(j, x) + field(i, x)).abs()
        };
        self.circulations().into_iter().map(off).fold(0.0, f64::max)
    }

    fn assert_complete(&self) {
        assert_eq!(self.potentials.vertex_rows(), self.surface.mesh.vertex_rows());
        for (v, i, j, gamma) in self.circulations() {
            assert!(gamma.is_some_and(f64::is_finite), "{v} {i:?} {j:?}: {gamma:?}");
        }
    }
}

/// A gradient per region, different in all.
fn linear(region: Region, x: DVec3) -> f64 {
    let k = f64::from(region.0) + 1.0;
    k + x.dot(DVec3::new(k, 0.5 * k * k, -2.0 / k))
}

/// A number per region.
fn constant(region: Region, _: DVec3) -> f64 {
    3.0 * f64::from(region.0).sqrt() - 1.0
}

/// A circulation from the lower label to the higher.
fn signed(i: Region, j: Region, gamma: Option<f64>) -> f64 {
    if i < j { gamma.unwrap() } else { -gamma.unwrap() }
}

#[test]
fn splits_of_flat_films_keep_a_linear_field_exactly() {
    let mut foam = Foam::new(&lattice(DVec3::ZERO, [1; 3], 1.0, 0.25), 1.0, linear);
    let before = foam.surface.positions.len();
    foam.remesh(0.1);
    assert!(foam.surface.positions.len() > 3 * before);
    assert!(foam.deviation(linear) < 1e-12, "{:.1e}", foam.deviation(linear));
}

#[test]
fn remeshing_keeps_a_linear_field_to_second_order() {
    // To finer and to coarser edges than those of the start: vertices blend over chords of a sphere of radius 1.
    for factor in [0.5, 1.9] {
        let error = |edge: f64| {
            let mut foam = Foam::new(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.9, edge), 1.0, linear);
            let before = foam.surface.positions.len();
            foam.remesh(factor * edge);
            assert_ne!(foam.surface.positions.len(), before);
            foam.assert_complete();
            foam.deviation(linear)
        };
        // Largest errors of meshes that are not similar scatter: over two halvings the order shows.
        let [coarse, fine] = [0.3, 0.075].map(error);
        let order = (coarse / fine).log2() / 2.0;
        assert!(order > 1.6, "{factor}: {coarse:.2e}, {fine:.2e}, order {order:.2}");
    }
}

#[test]
fn a_gauge_per_vertex_changes_no_circulation() {
    let start = [lattice(DVec3::ZERO, [2, 2, 1], 1.0, 0.34), double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.7, 0.3)];
    for set in &start {
        let [mut plain, mut shifted] = [0.0, 10.0].map(|gauge| Foam::new(set, gauge, linear));
        for foam in [&mut plain, &mut shifted] {
            foam.remesh(0.2);
            foam.remesh(0.5);
            assert!(foam.burst(2, 1, 0.5));
            foam.remesh(0.4);
        }
        for (a, b) in plain.circulations().into_iter().zip(shifted.circulations()) {
            assert_eq!((a.0, a.1, a.2), (b.0, b.1, b.2));
            assert!((a.3.unwrap() - b.3.unwrap()).abs() < 1e-11, "{a:?} {b:?}");
        }
    }
}

#[test]
fn regions_that_newly_meet_get_what_their_neighbours_say() {
    // Edges of four films come apart: pairs that never met share films.
    // Of a linear field they are a neighbour's value, an edge away: gradients here are up to 42.
    for (field, tolerance) in [(constant as fn(Region, DVec3) -> f64, 1e-12), (linear, 0.34 * 42.0)] {
        let mut foam = Foam::new(&lattice(DVec3::ZERO, [2, 2, 2], 1.0, 0.34), 1.0, field);
        let mut events = Vec::new();
        for _ in 0..3 {
            events.extend(foam.remesh(0.34));
            foam.assert_complete();
        }
        assert!(events.contains(&EventKind::T1), "{events:?}");
        assert!(foam.deviation(field) < tolerance, "{:.1e}", foam.deviation(field));
    }
}

#[test]
fn circulations_add_up_where_two_films_become_one() {
    let mut set = cube(DVec3::ZERO, 1.0, 0.34);
    // Its mirror image, so that diagonals face each other.
    let mut mirrored = set.clone();
    mirrored.positions.iter_mut().for_each(|x| x.x = 1.02 - x.x);
    mirrored.triangles.iter_mut().for_each(|triangle| triangle.reverse());
    set.append(&mirrored);
    let mut foam = Foam::new(&set, 1.0, |region, _| [0.0, 5.0, 7.0][region.0 as usize]);
    let places = foam.surface.positions.clone();
    let rows = || (0..places.len() as u32).map(VertexRow);
    let near = |p: VertexRow| rows().filter(move |q| p < *q).find(|q| places[p].distance(places[*q]) < 0.021);
    let policy = Policy::new(0.34);
    let mut session = foam.tracker.begin(&mut foam.surface, &policy, &mut foam.potentials);
    let snapped = rows().filter_map(|p| session.snap_vertices(p, near(p)?)).count();
    assert_eq!(snapped, 16);
    foam.tracker.close_up(&mut foam.surface, &mut foam.potentials);
    foam.assert_complete();
    let walls = foam.circulations().into_iter().filter(|(_, i, j, _)| i.0 + j.0 == 3);
    let walls: Vec<f64> = walls.map(|(_, i, j, gamma)| signed(i, j, gamma)).collect();
    assert!(!walls.is_empty());
    assert!(walls.iter().all(|gamma| (gamma - 2.0).abs() < 1e-12), "{walls:?}");
}

#[test]
fn a_burst_shifts_the_films_that_stay_by_one_constant_each() {
    let mut foam = Foam::new(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.3), 1.0, linear);
    // Where only one of the two films was: rows stay, but for those of the wall.
    let before = foam.circulations();
    let place = |foam: &Foam, v: VertexRow| foam.surface.positions[v];
    let old: Vec<(DVec3, u32, f64)> = before
        .iter()
        .filter(|(v, _, _, _)| foam.potentials.of(*v).len() == 2)
        .map(|(v, i, j, gamma)| (place(&foam, *v), i.0.max(j.0), signed(*i, *j, *gamma)))
        .collect();
    assert!(foam.burst(2, 1, 0.3));
    let new = foam.circulations();
    let mut shifts = [Vec::new(), Vec::new()];
    for (v, i, j, gamma) in new {
        let gamma = signed(i, j, gamma);
        if let Some((_, region, was)) = old.iter().find(|(x, _, _)| *x == place(&foam, v)) {
            shifts[*region as usize - 1].push(gamma - was);
        }
    }
    for shifts in shifts {
        assert!(shifts.len() > 20);
        assert!(shifts.iter().all(|shift| (shift - shifts[0]).abs() < 1e-12), "{shifts:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_film_is_ever_without_a_circulation(seed in any::<u64>(), kind in 0usize..4) {
        let set = match kind {
            0 => lattice(DVec3::ZERO, [2, 2, 1], 1.0, 0.5),
            1 => double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.7, 0.4),
            2 => sphere_lattice([2, 2, 1], 1.0, 0.05, 0.5),
            _ => icosphere(DVec3::ZERO, 1.0, 0.5),
        };
        let mut dice = Random::new(seed);
        let mut foam = Foam::new(&set, 1.0, constant);
        let mut has_burst = false;
        for _ in 0..8 {
            match dice.next() % 4 {
                0 => {
                    let [gone, into] = [dice.next(), dice.next()].map(|n| (n % 5) as u32);
                    has_burst |= gone != into && gone != 0 && foam.burst(gone, into, 0.5);
                }
                n => {
                    let flips = n == 1;
                    let edge = 0.4 + 0.3 * dice.next_signed();
                    foam.remesh_with(&Policy { flips, ..Policy::new(edge) });
                }
            }
            foam.assert_complete();
            // Numbers per region stay to the last digits, whatever meets; new labels have those of their origin.
            let has_new_labels = foam.surface.mesh.regions().iter().any(|region| region.0 > 4);
            assert!(has_burst || has_new_labels || foam.deviation(constant) < 1e-10);
        }
    }
}
