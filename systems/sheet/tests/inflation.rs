//! Gas that comes into bubbles: the air around is pushed away, and takes along what is in it.

mod common;

use std::f64::consts::PI;

use common::spheres::{even_sphere, exact_frequency, legendre, uneven_sphere};
use common::{Film, Settings, report};
use froth_sheet::{Discretisation, Integrator, Sliding};
use froth_surface::shapes::{disc, icosphere, sphere_lattice};
use froth_surface::{LabelledTriangles, Region};
use glam::DVec3;

const BLOWN: Region = Region(1);
const OTHER: Region = Region(2);

/// Films without tension: what moves them is the air around alone.
const LIMP: Settings = Settings {
    discretisation: Discretisation::Variational,
    integrator: Integrator::RungeKutta4,
    sliding: Sliding::NONE,
    diffusivity: 0.0,
    density: 1.0,
    tension: 0.0,
    keeps_volumes: true,
    keeps_impulse: true,
};

fn most_circulation(film: &Film) -> f64 {
    let panels = film.sheet.layout.panels().iter();
    let circulations = panels.flat_map(|panel| froth_sheet::geometry::circulations(panel, &film.state.potentials));
    circulations.fold(0.0, |most, gamma| most.max(gamma.abs()))
}

/// Vertices of films around a region.
fn vertices_of(film: &Film, region: Region) -> Vec<usize> {
    let layout = &film.sheet.layout;
    let sides = (0..layout.side_count()).filter(|side| layout.regions()[*side] == region);
    sides.map(|side| layout.vertex_of(side as u32) as usize).collect()
}

/// Mean over the films of a region by area.
fn mean_over(film: &Film, region: Region, value: impl Fn(usize) -> DVec3) -> DVec3 {
    let areas = &film.sheet.geometry.areas;
    let vertices = vertices_of(film, region);
    let sum: DVec3 = vertices.iter().map(|v| value(*v) * areas[*v]).sum();
    sum / vertices.iter().map(|v| areas[*v]).sum::<f64>()
}

/// Flux out of a region as its vertices move, m^3/s.
fn flux(film: &Film, region: Region, velocities: &[DVec3]) -> f64 {
    let layout = &film.sheet.layout;
    let sides = (0..layout.side_count()).filter(|side| layout.regions()[*side] == region);
    sides.map(|side| film.sheet.geometry.gradients[side].dot(velocities[layout.vertex_of(side as u32) as usize])).sum()
}

/// A bubble of radius 1 and one of radius `r` at a distance `d` along x.
fn pair(r: f64, d: f64, edge: f64) -> LabelledTriangles {
    let mut set = icosphere(DVec3::ZERO, 1.0, edge);
    set.append(&icosphere(DVec3::X * d, r, edge));
    set
}

#[test]
fn a_sphere_that_is_blown_up_stays_a_sphere_in_still_air() {
    for (name, set) in [("even", even_sphere(6)), ("uneven", uneven_sphere(6, 3))] {
        let mut film = Film::new(&set, LIMP);
        let start = film.volumes[&BLOWN];
        let inflow = start;
        film.inflows.insert(BLOWN, inflow);
        let mut largest = 0.0f64;
        for _ in 0..20 {
            film.step(0.1);
            // Beside the way of the film in the step.
            largest =
                largest.max(film.corrected / (0.1 * inflow / (4.0 * PI * film.state.positions[0].length_squared())));
        }
        let radius = (1.0 + inflow * film.time / start).cbrt();
        let off = film.state.positions.iter().map(|x| (x.length() / radius - 1.0).abs()).fold(0.0, f64::max);
        let volume = film.surface.volumes()[1] / (start + inflow * film.time) - 1.0;
        report(format!(
            "{name}: radius {radius:.3} off by {off:.1e}, volume {volume:.1e}, projected {largest:.1e} of the way"
        ));
        assert!(off < 5e-4 && volume.abs() < 1e-12 && largest < 0.01, "{off:e} {volume:e} {largest:e}");
        assert_eq!(most_circulation(&film), 0.0);
    }
}

#[test]
fn the_flux_through_films_is_the_inflow_to_second_order() {
    let off = |frequency| {
        let mut film = Film::new(&uneven_sphere(frequency, 5), LIMP);
        film.reshape(|x| DVec3::new(1.4, 1.0, 0.7) * x);
        film.inflows.insert(BLOWN, 2.0);
        film.evaluate(1.0);
        (flux(&film, BLOWN, &film.sheet.velocities) / 2.0 - 1.0).abs()
    };
    let [coarse, fine] = [4, 8].map(off);
    report(format!("flux of an ellipsoid off by {coarse:.2e}, {fine:.2e}"));
    assert!(coarse < 0.02 && (coarse / fine).log2() > 1.7);
}

#[test]
fn another_bubble_moves_with_the_air_that_is_pushed_away() {
    let (d, inflow) = (4.0f64, 2.0);
    let mut film = Film::new(&pair(0.5, d, 0.2), Settings::default());
    film.inflows.insert(BLOWN, inflow);
    film.evaluate(1.0);
    // Mean of a harmonic field over a sphere: that at its middle.
    let speed = mean_over(&film, OTHER, |v| film.sheet.velocities[v]);
    let expected = inflow / (4.0 * PI * d * d);
    report(format!("speed of the other {:.5} of Q/(4 pi d^2)", speed.x / expected));
    assert!((speed.x / expected - 1.0).abs() < 2e-3 && speed.with_x(0.0).length() < 1e-3 * expected, "{speed}");
    assert!(flux(&film, OTHER, &film.sheet.velocities).abs() < 1e-2 * expected);
    // Its own pulse does the rest of the way.
    film.run(0.4, 1.0, 1, |_| ());
    let way = mean_over(&film, OTHER, |v| film.state.positions[v]).x - d;
    let expected = (d.powi(3) + 3.0 * inflow * film.time / (4.0 * PI)).cbrt() - d;
    report(format!("way of the other {:.4} of exact; volumes {:?}", way / expected, film.surface.volumes()));
    assert!((way / expected - 1.0).abs() < 0.02, "{way} {expected}");
    for (region, volume) in &film.volumes {
        assert!((film.surface.volumes()[region.index()] / volume - 1.0).abs() < 1e-12);
    }
}

#[test]
fn inflows_add_up() {
    let velocities = |inflows: [f64; 2]| {
        let mut film = Film::new(&sphere_lattice([2, 1, 1], 1.0, 0.3, 0.4), Settings::default());
        film.inflows.extend([(BLOWN, inflows[0]), (OTHER, inflows[1])]);
        film.evaluate(1.0);
        film.sheet.velocities.clone()
    };
    let [one, two, both] = [[1.0, 0.0], [0.0, -0.4], [1.0, -0.4]].map(velocities);
    for ((one, two), both) in one.iter().zip(&two).zip(&both) {
        assert!((*one + *two).distance(*both) < 1e-13);
    }
}

#[test]
fn a_film_on_a_ring_bulges_away_from_a_bubble_that_is_blown_up() {
    let mut set = disc(DVec3::Z * 2.0, 1.0, DVec3::Z, 0.2);
    let rim: Vec<usize> = (0..set.positions.len()).filter(|v| set.pinned[*v]).collect();
    set.append(&icosphere(DVec3::ZERO, 0.7, 0.2));
    let mut film = Film::new(&set, Settings::default());
    let blown = *film.volumes.keys().next().unwrap();
    film.inflows.insert(blown, 0.5);
    let start = film.state.positions.clone();
    let middle = (0..start.len()).min_by(|a, b| {
        let off = |v: &usize| start[*v].distance(DVec3::Z * 2.0);
        off(a).total_cmp(&off(b))
    });
    let middle = middle.unwrap();
    film.evaluate(1.0);
    let speed = film.sheet.velocities[middle].z / (0.5 / (4.0 * PI * 4.0));
    report(format!("film at the middle of the ring moves at {speed:.4} of the air's speed"));
    assert!((speed - 1.0).abs() < 0.02);
    film.run(0.4, 0.5, 1, |_| ());
    let bulge = film.state.positions[middle].z - 2.0;
    report(format!("bulge {bulge:.2e}"));
    assert!(bulge > 1e-3 && rim.iter().all(|v| film.state.positions[*v] == start[*v]));
}

#[test]
fn no_air_goes_through_a_wire_beside_a_bubble_that_is_blown_up() {
    for discretisation in [Discretisation::Variational, Discretisation::Pointwise] {
        let mut set = pair(0.8, 2.5, 0.25);
        set.pinned = set.positions.iter().map(|x| x.x > 2.8).collect();
        let held = set.pinned.clone();
        let mut film = Film::new(&set, Settings { discretisation, ..Settings::default() });
        film.inflows.insert(BLOWN, 1.0);
        film.evaluate(1.0);
        assert!(most_circulation(&film) > 1e-3);
        let around = film.sheet.ambient.by_sources.clone();
        let stopped = film.sheet.velocities.iter().zip(&held).filter(|(_, held)| **held);
        assert!(stopped.into_iter().all(|(w, _)| w.length() < 1e-15));
        // The sheet's own flux out of the bubble is nothing, so where wires stop the air the rest of the film goes faster.
        let [moved, carried] = [&film.sheet.velocities, &around].map(|u| flux(&film, OTHER, u));
        let stopped = (0..held.len()).filter(|v| held[*v]).map(|v| around[v].x).sum::<f64>();
        report(format!("{discretisation:?}: flux {moved:.3e} for {carried:.3e}, wires stop {stopped:.2}"));
        let bar = if discretisation == Discretisation::Variational { 1e-10 } else { 1e-2 };
        assert!((moved - carried).abs() < bar, "{moved:e} {carried:e}");
    }
}

/// Largest size of the mode of degree 2 in a period, metres, with gas shut off.
fn swing(film: &mut Film) -> f64 {
    let radius = (film.volumes[&BLOWN] / (4.0 / 3.0 * PI)).cbrt();
    let period = 2.0 * PI / exact_frequency(2) * radius.powf(1.5);
    let mut largest = 0.0f64;
    film.run(0.2, film.time + period, 1, |film| {
        let size = |v: usize| film.state.positions[v].length() * legendre(2, film.state.positions[v].normalize().z);
        largest = largest.max(5.0 * film.mean(size).abs());
    });
    largest
}

#[test]
fn a_pulsing_bubble_that_is_blown_up_slowly_swings_as_it_should() {
    // A bulge `a P_l` holds gas that expands too: by sources alone `a' = -k R'/R a`, with `k = 3 l/(2l + 1) - 1` = 1/5. Circulation is carried:
    // gamma' = b a/R^2, and (a R^k)' = -c gamma R^(k - 1) with omega^2 = b c/R^3. Slowly, a goes as R^(-3/4 + (2 - k)/2).
    // Without the gas in the bulge k is 2, and energy over frequency, the action, would be kept.
    let mut film = Film::new(&even_sphere(4), Settings::default());
    film.reshape(|x| x * (1.0 + 0.05 * legendre(2, x.z)));
    let start = film.volumes[&BLOWN];
    let before = swing(&mut film);
    let time = 10.0 * 2.0 * PI / exact_frequency(2);
    film.inflows.insert(BLOWN, start / time);
    film.run(0.2, film.time + time, 1, |_| ());
    film.inflows.clear();
    let ratio = swing(&mut film) / before / 2f64.powf((-0.75 + 0.9) / 3.0);
    report(format!("swing after doubling the volume {ratio:.4} of theory"));
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

#[test]
fn a_bubble_that_moves_gains_the_impulse_that_the_strain_gives_it() {
    let run = |keeps_impulse| {
        let mut film = Film::new(&pair(0.5, 2.5, 0.2), Settings { keeps_impulse, ..LIMP });
        // The start of a sphere that moves as a whole: phi = U.x within, and the dipole without.
        for (region, value) in [(OTHER, 1.0), (Region::OUTSIDE, -0.5)] {
            let sides: Vec<usize> = {
                let layout = &film.sheet.layout;
                let is_of = |side: &usize| {
                    layout.regions()[*side] == region
                        && film.state.positions[layout.vertex_of(*side as u32) as usize].x > 1.5
                };
                (0..layout.side_count()).filter(is_of).collect()
            };
            for side in sides {
                let x = film.state.positions[film.sheet.layout.vertex_of(side as u32) as usize];
                film.state.potentials[side] = 0.05 * value * (x.x - 2.5);
            }
        }
        film.inflows.insert(BLOWN, 3.0);
        let mut predicted: DVec3 = film.sheet.impulses(&film.state.potentials).iter().sum();
        let start = predicted;
        for _ in 0..40 {
            film.step(0.02);
            let gained = film.sheet.impulse_strained(&film.state.positions, &film.state.potentials, 0.02);
            predicted += gained.iter().sum::<DVec3>();
        }
        let now: DVec3 = film.sheet.impulses(&film.state.potentials).iter().sum();
        (start.x, (now - start).x, (predicted - start).x)
    };
    let (start, kept, predicted) = run(true);
    let (_, free, _) = run(false);
    report(format!("impulse {start:.4}: gains {kept:.3e} corrected, {free:.3e} not, {predicted:.3e} by strain"));
    assert!((kept / predicted - 1.0).abs() < 1e-2);
    assert!((free / predicted - 1.0).abs() < 0.1 && free.abs() > 0.02 * start, "{free} {predicted} {start}");
}
