//! Nothing has a length of its own: bubbles of a micrometre and of a kilometre do the same in their own units, here and far away.

mod common;

use common::{Film, Settings};
use froth_biot_savart::SheetKernel;
use froth_sheet::{Integrator, Sliding};
use froth_surface::shapes::double_bubble;
use froth_surface::{Region, Surface};
use glam::{DQuat, DVec3};

/// Units of a run, SI.
#[derive(Clone, Copy)]
struct Units {
    length: f64,
    density: f64,
    tension: f64,
}

impl Units {
    const ONE: Self = Self { length: 1.0, density: 1.0, tension: 1.0 };

    /// s.
    fn time(self) -> f64 {
        (self.density * self.length.powi(3) / self.tension).sqrt()
    }
}

/// Where and how a run is done.
#[derive(Clone, Copy)]
struct Frame {
    turn: DQuat,
    place: DVec3,
}

impl Frame {
    const HERE: Self = Self { turn: DQuat::IDENTITY, place: DVec3::ZERO };
}

/// A double bubble out of shape, ten steps on: places and potentials in its own units and frame.
fn result(units: Units, frame: Frame, integrator: Integrator) -> (Vec<DVec3>, Vec<f64>) {
    let triangles = double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.7, 0.35);
    let mut surface = Surface::from_triangles(&triangles);
    let shaken = |x: DVec3| x + 0.1 * DVec3::new(x.y * x.z, 0.0, x.x * x.y);
    let there = |x: DVec3| frame.place + units.length * (frame.turn * x);
    surface.positions.0.iter_mut().for_each(|x| *x = there(shaken(*x)));
    let settings = Settings {
        integrator,
        sliding: Sliding::everywhere(0.1),
        diffusivity: 0.01 * units.length.powi(2) / units.time(),
        density: units.density,
        tension: units.tension,
        ..Settings::default()
    };
    let mut film = Film::with_kernel(surface, SheetKernel::third_order(0.26 * units.length), settings);
    let back = |x: DVec3| frame.turn.inverse() * (x - frame.place) / units.length;
    film.set_potential(Region(1), |x| 0.2 * back(x).x * units.length.powi(2) / units.time());
    for _ in 0..10 {
        film.step(0.03 * units.time());
    }
    let places = film.state.positions.iter().map(|x| back(*x)).collect();
    let potentials = film.state.potentials.iter().map(|phi| phi * units.time() / units.length.powi(2)).collect();
    (places, potentials)
}

/// Largest differences of places and potentials.
fn difference(a: &(Vec<DVec3>, Vec<f64>), b: &(Vec<DVec3>, Vec<f64>)) -> f64 {
    let places = a.0.iter().zip(&b.0).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    a.1.iter().zip(&b.1).map(|(a, b)| (a - b).abs()).fold(places, f64::max)
}

#[test]
fn results_are_the_same_in_all_units() {
    for integrator in [Integrator::Leapfrog, Integrator::RungeKutta4, Integrator::ImplicitMidpoint] {
        let plain = result(Units::ONE, Frame::HERE, integrator);
        for units in [
            Units { length: 1e-3, density: 1.2, tension: 0.06 },
            Units { length: 1e3, density: 1.0, tension: 1.0 },
            Units { length: 1e-6, density: 1e-3, tension: 1e3 },
        ] {
            let off = difference(&plain, &result(units, Frame::HERE, integrator));
            common::report(format!("{integrator:?}, length {:.0e}: {off:.1e}", units.length));
            assert!(off < 1e-11, "{integrator:?}, {:.0e}: {off:.1e}", units.length);
        }
    }
}

#[test]
fn results_are_the_same_wherever_and_however_turned() {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.1);
    let plain = result(Units::ONE, Frame::HERE, Integrator::Leapfrog);
    for (distance, tolerance) in [(0.0, 1e-12), (1e3, 1e-10), (1e6, 1e-7)] {
        // Coordinates lose the digits of the distance, a few times over in ten steps.
        let frame = Frame { turn, place: distance * DVec3::new(0.6, -0.8, 0.5) };
        let off = difference(&plain, &result(Units::ONE, frame, Integrator::Leapfrog));
        common::report(format!("{distance:.0e} R away: {off:.1e}"));
        assert!(off < tolerance, "{distance:.0e}: {off:.1e}");
    }
}
