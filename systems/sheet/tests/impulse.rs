//! Impulse of free clusters: constant, and forces change it by what they are.
//!
//! With gas as heavy as the air outside, a sphere of volume `V` that moves at `U` has the impulse of its gas and of its added
//! mass, `P = rho sum phi N = 3/2 rho V U` (Lamb 1932, §92).

mod common;

use common::spheres::{even_sphere, uneven_sphere};
use common::{Film, Settings, report};
use froth_sheet::{Integrator, Sliding};
use froth_surface::Region;
use froth_surface::shapes::{double_bubble, sphere_lattice};
use glam::DVec3;

/// Centre of the gas of all closed regions, metres.
fn gas_centre(film: &Film) -> DVec3 {
    let (mut moment, mut volume) = (DVec3::ZERO, 0.0);
    for (_, face) in film.surface.mesh.faces() {
        let [back, front] = face.labels();
        let sign = f64::from(back != Region::OUTSIDE) - f64::from(front != Region::OUTSIDE);
        let [a, b, c] = face.vertices().map(|v| film.state.positions[v.index()]);
        let part = sign * a.dot(b.cross(c)) / 6.0;
        volume += part;
        moment += (a + b + c) * (0.25 * part);
    }
    moment / volume
}

/// An uneven double bubble out of shape, with air in motion about it.
fn shaken_pair(settings: Settings) -> Film {
    let mut film = Film::new(&double_bubble(DVec3::ZERO, DVec3::new(0.6, 0.0, 0.8), 1.0, 0.6, 0.25), settings);
    film.reshape(|x| x + 0.08 * DVec3::new(x.y * x.z, (2.0 * x.z).sin(), x.x * x.x));
    film.set_potential(Region(1), |x| 0.3 * x.x - 0.2 * x.y * x.z);
    film.set_potential(Region(2), |x| 0.1 * x.z + 0.2 * x.x * x.y);
    film
}

#[test]
fn a_shaken_double_bubble_keeps_its_impulse() {
    for integrator in [Integrator::Leapfrog, Integrator::RungeKutta4] {
        let mut film = shaken_pair(Settings { integrator, sliding: Sliding::everywhere(0.05), ..Settings::default() });
        let start = film.sheet.impulses(&film.state.potentials)[0];
        let mut worst = 0.0f64;
        film.run(0.4, 3.0, 1, |film| {
            let now = film.sheet.impulses(&film.state.potentials)[0];
            worst = worst.max(now.distance(start) / start.length());
        });
        report(format!("{integrator:?}: impulse {start:.3?} kept to {worst:.1e}"));
        assert!(worst < 1e-12, "{worst:.1e}");
    }
}

#[test]
fn what_the_correction_gives_back_falls_with_the_mesh() {
    // Forces along the films move nothing: their sum, which is of second order in the edge, is what the impulse loses.
    let loss = |frequency| {
        let settings = Settings { keeps_impulse: false, ..Settings::default() };
        let mut film = Film::new(&uneven_sphere(frequency, 2), settings);
        film.reshape(|x| x + 0.1 * DVec3::new(x.y * x.z, 0.0, x.x * x.x));
        film.set_potential(Region(1), |x| 0.3 * x.x - 0.2 * x.y * x.z);
        let start = film.sheet.impulses(&film.state.potentials)[0];
        film.run(0.4, 2.0, 1, |_| ());
        film.sheet.impulses(&film.state.potentials)[0].distance(start) / start.length()
    };
    let [coarse, fine] = [3, 6].map(loss);
    report(format!("loss of impulse without the correction: {coarse:.2e} to {fine:.2e}"));
    assert!((coarse / fine).log2() > 1.5);
}

#[test]
fn two_clusters_keep_their_own_impulses() {
    let mut film = Film::new(&sphere_lattice([2, 1, 1], 1.0, 0.5, 0.35), Settings::default());
    film.set_potential(Region(1), |x| 0.3 * x.y);
    film.set_potential(Region(2), |x| -0.2 * x.x * x.z - 0.1 * x.z);
    let start = film.sheet.impulses(&film.state.potentials);
    film.run(0.4, 1.0, 1, |_| ());
    let now = film.sheet.impulses(&film.state.potentials);
    assert_eq!(start.len(), 2);
    for (start, now) in start.iter().zip(&now) {
        assert!(now.distance(*start) < 1e-12 * start.length(), "{start} {now}");
    }
}

#[test]
fn clusters_in_contact_share_what_they_had_and_films_that_are_stopped_cost_energy_alone() {
    let mut film = Film::new(&sphere_lattice([2, 1, 1], 1.0, 0.5, 0.35), Settings::default());
    film.set_potential(Region(1), |x| 0.3 * x.x + 0.1 * x.y);
    film.set_potential(Region(2), |x| -0.2 * x.x);
    let start: DVec3 = film.sheet.impulses(&film.state.potentials).into_iter().sum();
    let [before, _] = film.energies();
    let near: Vec<bool> = film.state.positions.iter().map(|x| x.x.abs() < 0.4).collect();
    assert!(near.contains(&true) && near.contains(&false));
    let positions = film.state.positions.clone();
    let wanted = film.sheet.impulses(&film.state.potentials);
    let lost = film.sheet.calm(&positions, &near, 1.0, 0.0, &mut film.state.potentials).unwrap();
    let [after, _] = film.energies();
    assert!(lost > 0.01 * before && (before - lost - after).abs() < 1e-9 * before, "{before} {lost} {after}");
    film.sheet.keep_impulse(&positions, &wanted, &near, &mut film.state.potentials);
    let now = film.sheet.impulses(&film.state.potentials);
    let sum: DVec3 = now.iter().sum();
    assert!(sum.distance(start) < 1e-12 * wanted[0].length(), "{sum} {start}");
    assert!(now[0].distance(wanted[0]) > 0.01 * wanted[0].length(), "the impulse that they exchanged");
}

#[test]
fn a_bubble_drifts_with_its_impulse_over_its_mass_and_added_mass() {
    // Second order in the edge: 1.1 % on 162 vertices, 0.1 % on 642.
    for (set, tolerance) in [(even_sphere(4), 0.015), (uneven_sphere(4, 2), 0.015), (even_sphere(8), 0.004)] {
        let mut film = Film::new(&set, Settings::default());
        film.set_potential(Region(1), |x| 0.015 * x.z);
        let impulse = film.sheet.impulses(&film.state.potentials)[0];
        let (start, volume) = (gas_centre(&film), film.volumes[&Region(1)]);
        film.run(0.4, 10.0, 1, |_| ());
        let expected = impulse / (1.5 * volume);
        let off = ((gas_centre(&film) - start) / film.time).distance(expected) / expected.length();
        report(format!("drift of {} vertices: {off:.1e} off P / (3/2 rho V)", film.state.positions.len()));
        assert!(off < tolerance, "{off:.1e}");
    }
}

#[test]
fn forces_give_the_impulse_that_they_have_and_the_bubble_falls() {
    for integrator in [Integrator::Leapfrog, Integrator::RungeKutta4] {
        let mut film = Film::new(&even_sphere(4), Settings { density: 1.3, integrator, ..Settings::default() });
        let (start, force) = (gas_centre(&film), DVec3::new(0.0, 0.001, -0.01));
        let whole: f64 = film.sheet.geometry.areas.iter().sum();
        film.forces = film.sheet.geometry.areas.iter().map(|area| force * (area / whole)).collect();
        film.run(0.4, 5.0, 1, |_| ());
        let gained = film.sheet.impulses(&film.state.potentials)[0] * film.settings.density;
        let off = gained.distance(force * film.time) / gained.length();
        let mass = 1.5 * film.settings.density * film.volumes[&Region(1)];
        let expected = force * (0.5 * film.time * film.time / mass);
        let fall = (gas_centre(&film) - start).distance(expected) / expected.length();
        report(format!("{integrator:?}: impulse of a force {off:.1e} off, way {fall:.1e} off"));
        assert!(off < 1e-12);
        // Second order in the edge; the forces are shared by areas at the start.
        assert!(fall < 0.03, "{fall}");
    }
}
