//! Volumes: kept to round-off by a correction that vanishes with the step.
//!
//! A cube of gas swings through an octahedron and back: the films that move farthest. Without remeshing the projection is all that
//! acts on volumes.

mod common;

use common::{Film, Settings, report};
use froth_sheet::{Integrator, Sliding};
use froth_surface::Region;
use froth_surface::shapes::{cube, double_bubble};
use glam::DVec3;

/// Largest relative error of the volumes until `end` (s), and the largest correction of a step in its second half, metres.
fn run(mut film: Film, courant: f64, end: f64) -> [f64; 2] {
    let (mut worst, mut corrected) = (0.0f64, 0.0f64);
    while film.time < end {
        film.step(film.capillary_step(courant).min(end - film.time));
        let measured = film.surface.volumes();
        let off = |(region, volume): (&Region, &f64)| (measured[region.index()] / volume - 1.0).abs();
        worst = film.volumes.iter().map(off).fold(worst, f64::max);
        if film.time > 0.5 * end {
            corrected = corrected.max(film.corrected);
        }
    }
    [worst, corrected]
}

/// A cube with the volume of the unit sphere.
fn swinging_cube(integrator: Integrator) -> Film {
    let side = (4.0 / 3.0 * std::f64::consts::PI).cbrt();
    let settings = Settings { integrator, sliding: Sliding::default(), ..Settings::default() };
    Film::new(&cube(DVec3::ZERO, side, side / 8.0), settings)
}

#[test]
fn a_swinging_cube_keeps_its_volume() {
    for (integrator, courant) in [(Integrator::Leapfrog, 0.4), (Integrator::RungeKutta4, 0.4)] {
        // A period of l = 2 and a little more.
        let [off, corrected] = run(swinging_cube(integrator), courant, 3.0);
        report(format!("cube, {integrator:?}: volume {off:.1e} off, correction of a step {corrected:.1e} R"));
        assert!(off < 1e-12, "the projection ends at round-off");
        assert!(corrected < 1e-3, "{corrected:.1e}");
    }
}

#[test]
fn the_correction_of_a_step_falls_with_the_step() {
    // Volumes are cubic in the positions: a straight move errs by the square of the step, one of RK4 by the fifth power.
    for (integrator, least) in [(Integrator::Leapfrog, 1.8), (Integrator::RungeKutta4, 4.0)] {
        let correction = |courant| {
            let settings = Settings { integrator, ..Settings::default() };
            let mut film = Film::new(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.7, 0.3), settings);
            film.reshape(|x| x + 0.1 * DVec3::new(0.0, x.z, -x.x * x.y));
            run(film, courant, 1.0)[1]
        };
        let [coarse, fine] = [0.4, 0.1].map(correction);
        let order = (coarse / fine).log2() / 2.0;
        report(format!("{integrator:?}: correction of a step {coarse:.1e} to {fine:.1e}, order {order:.2}"));
        assert!(order > least, "{integrator:?}: {order:.2}");
    }
}
