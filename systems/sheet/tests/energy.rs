//! The energy `K + T A` of a free bubble that rings with an amplitude at which everything is nonlinear.
//!
//! Without sliding and without the impulse's correction the discrete energy is constant in continuous time: what is left is the
//! integrator's, and falls with its order. The correction of the impulse does a little work at a rate of its own, whatever the
//! step: that is the floor of free bubbles.

mod common;

use common::spheres::{even_sphere, exact_frequency, legendre, uneven_sphere};
use common::{Film, Settings, report};
use froth_sheet::{Integrator, Sliding};
use froth_surface::LabelledTriangles;

/// Steps between two looks at the energy.
const STRIDE: usize = 4;

/// A bubble out of shape by `amplitude` in `l = 2` along z and `l = 3` along x.
fn shaken(set: &LabelledTriangles, amplitude: f64, settings: Settings) -> Film {
    let mut film = Film::new(set, settings);
    film.reshape(|x| x * (1.0 + amplitude * (legendre(2, x.z) + legendre(3, x.x))));
    film
}

/// Largest deviation of the energy over its largest kinetic part, in a number of periods of `l = 2`.
fn drift(mut film: Film, courant: f64, periods: f64) -> f64 {
    let start: f64 = film.energies().iter().sum();
    let (mut largest, mut worst) = (0.0f64, 0.0f64);
    film.run(courant, periods * std::f64::consts::TAU / exact_frequency(2), STRIDE, |film| {
        let [kinetic, surface] = film.energies();
        largest = largest.max(kinetic);
        worst = worst.max((kinetic + surface - start).abs());
    });
    worst / largest
}

fn with(integrator: Integrator, sliding: Sliding) -> Settings {
    Settings { integrator, sliding, ..Settings::default() }
}

fn assert_drift(what: &str, drift: f64, bar: f64) {
    report(format!("{what}: {drift:.2e} of the largest kinetic energy, bar {bar:.0e}"));
    assert!(drift < bar, "{what}: {drift:.2e}");
}

fn free(integrator: Integrator) -> Settings {
    Settings { keeps_impulse: false, ..with(integrator, Sliding::NONE) }
}

#[test]
fn runge_kutta_keeps_the_energy_over_three_periods() {
    // The bar is 2e-3; most of what is left is work of the impulse's correction.
    let film = shaken(&even_sphere(8), 0.12, with(Integrator::RungeKutta4, Sliding::NONE));
    assert_drift("RK4, C = .3", drift(film, 0.3, 3.0), 1e-4);
}

#[test]
fn the_leapfrog_keeps_the_energy_over_ten_periods_of_a_mesh_that_slides() {
    let film = shaken(&even_sphere(8), 0.15, with(Integrator::Leapfrog, Sliding::default()));
    assert_drift("leapfrog, C = .4", drift(film, 0.4, 10.0), 3e-2);
}

#[test]
fn the_midpoint_rule_keeps_the_energy_on_an_uneven_mesh() {
    // 162 vertices: the impulse's correction does 16 times the work that it does at 642.
    let film = shaken(&uneven_sphere(4, 1), 0.1, with(Integrator::ImplicitMidpoint, Sliding::NONE));
    assert_drift("midpoint, C = .4", drift(film, 0.4, 2.0), 2e-3);
}

#[test]
fn the_drift_of_the_energy_falls_with_the_order_of_the_integrator() {
    // The drift of RK4 is its dissipation of the shortest waves, which falls with the fifth power of the step.
    for (integrator, courant, least) in [
        (Integrator::RungeKutta4, 0.8, 3.8),
        (Integrator::ImplicitMidpoint, 0.4, 1.8),
        // One evaluation: convection is that of the step before, and volumes are met after the move.
        (Integrator::Leapfrog, 0.4, 1.2),
    ] {
        let at = |courant| drift(shaken(&uneven_sphere(4, 1), 0.1, free(integrator)), courant, 2.0);
        let [coarse, fine] = [at(courant), at(0.25 * courant)];
        let order = (coarse / fine).log2() / 2.0;
        report(format!("{integrator:?}: {coarse:.2e} to {fine:.2e}, order {order:.2}"));
        assert!(order > least, "{integrator:?}: order {order:.2}");
    }
}

#[test]
fn the_energy_stands_still_but_for_the_step_where_nothing_corrects_it() {
    let settings = Settings { keeps_volumes: false, ..free(Integrator::RungeKutta4) };
    assert_drift("RK4, C = .2, nothing corrected", drift(shaken(&uneven_sphere(4, 1), 0.1, settings), 0.2, 2.0), 2e-5);
}
