//! Circulation along material loops without tension: carried by the air, to the order of the mesh.
//!
//! A loop that leaves through one point of a film and comes back through another has the circulation `Gamma(q) - Gamma(p)`. Without
//! tension it is constant when `p` and `q` go with the air, that is with the mean of the velocities of both sides (Kelvin).
//! The variational scheme has no such points: vertices move with the films' normal velocity and `Gamma` is changed by the convection
//! that the discrete energy asks for. What it keeps exactly is that energy; circulations of material loops it keeps to second
//! order in the edge, in a norm over the film. Vertices of the pointwise scheme are material points, and keep theirs.

mod common;

use std::iter::Sum;
use std::ops::Mul;

use common::spheres::even_sphere;
use common::{Film, Settings, report};
use froth_biot_savart::{PairSum, Summation};
use froth_sheet::{Discretisation, Integrator, flow};
use froth_surface::Region;
use froth_surface::kernel::closest::point_triangle;
use glam::DVec3;

/// Points that go with the air, and the circulation that each had at the start.
struct Tracers {
    places: Vec<DVec3>,
    circulations: Vec<f64>,
    pairs: PairSum,
}

impl Tracers {
    /// One on every vertex, where circulations need no interpolation.
    fn new(film: &Film) -> Self {
        let places = film.state.positions.clone();
        let circulations = places.iter().map(|x| circulation(film, *x)).collect();
        let pairs = PairSum::new(film.sheet_kernel, Summation::Direct).unwrap();
        Self { places, circulations, pairs }
    }

    /// Velocities of the air on the film per vertex, the mean of both sides and of the panels around.
    ///
    /// Sums over panels are taken at panels: vertices of a curved film lie outside of those by a part of the smoothing length
    /// that vanishes with the edge to first order alone.
    fn velocities(&mut self, film: &Film) -> Vec<DVec3> {
        let (layout, geometry) = (&film.sheet.layout, &film.sheet.geometry);
        let (mut strengths, mut at_panels) = (Vec::new(), Vec::new());
        flow::strengths(layout, &film.state.positions, &film.state.potentials, &mut strengths);
        self.pairs.place(&geometry.centres);
        self.pairs.velocities_at(&strengths, &geometry.centres, &mut at_panels).unwrap();
        let mut velocities = vec![DVec3::ZERO; film.state.positions.len()];
        for ((panel, u), area) in layout.panels().iter().zip(&at_panels).zip(&geometry.area_vectors) {
            for v in panel.corners {
                velocities[v as usize] += *u * (area.length() / 3.0 / geometry.areas[v as usize]);
            }
        }
        velocities
    }

    /// A step of the film and, by the mean of the velocities before and after it (Heun), of the tracers.
    fn step(&mut self, film: &mut Film, dt: f64) {
        let velocities = self.velocities(film);
        let before: Vec<DVec3> = self.places.iter().map(|x| at(film, *x, |v| velocities[v])).collect();
        film.step(dt);
        let velocities = self.velocities(film);
        for (x, u) in self.places.iter_mut().zip(before) {
            let after = at(film, *x + u * dt, |v| velocities[v]);
            let gone = *x + 0.5 * dt * (u + after);
            *x = at(film, gone, |v| film.state.positions[v]);
        }
    }

    /// Root of the mean square of the change of circulations, over the largest circulation.
    fn change(&self, film: &Film) -> f64 {
        let changes: Vec<f64> =
            self.places.iter().zip(&self.circulations).map(|(x, old)| circulation(film, *x) - old).collect();
        // Loops go from point to point: a constant is none.
        let mean = changes.iter().sum::<f64>() / changes.len() as f64;
        let square = changes.iter().map(|change| (change - mean).powi(2)).sum::<f64>() / changes.len() as f64;
        square.sqrt() / self.circulations.iter().map(|gamma| gamma.abs()).fold(0.0, f64::max)
    }
}

/// A quantity on vertices at the place of the film nearest to `x`.
fn at<T: Mul<f64, Output = T> + Sum>(film: &Film, x: DVec3, value: impl Fn(usize) -> T) -> T {
    let nearest = film.sheet.layout.panels().iter().map(|panel| {
        let corners = panel.corners.map(|v| film.state.positions[v as usize]);
        (point_triangle(x, corners), panel.corners)
    });
    let (point, corners) = nearest.min_by(|a, b| a.0.distance_squared.total_cmp(&b.0.distance_squared)).unwrap();
    (0..3).map(|k| value(corners[k] as usize) * point.barycentric[k]).sum()
}

/// Circulation of the bubble against the outside at the place of the film nearest to `x`.
fn circulation(film: &Film, x: DVec3) -> f64 {
    let jump = |v: usize| {
        let sides = film.sheet.layout.sides_of(v);
        film.state.potentials[sides.start + 1] - film.state.potentials[sides.start]
    };
    at(film, x, jump)
}

/// A sphere of air that is set moving by no tension at all.
fn pushed(frequency: usize, discretisation: Discretisation) -> Film {
    let integrator = Integrator::RungeKutta4;
    let settings = Settings { discretisation, integrator, tension: 0.0, keeps_impulse: false, ..Settings::default() };
    let mut film = Film::new(&even_sphere(frequency), settings);
    film.set_potential(Region(1), |x| 0.5 * x.z + 0.3 * (x.x * x.x - x.y * x.y));
    film
}

#[test]
fn material_loops_keep_their_circulation_to_second_order() {
    let changes = [4, 8].map(|frequency| {
        let mut film = pushed(frequency, Discretisation::Variational);
        let start: f64 = film.energies().iter().sum();
        let mut tracers = Tracers::new(&film);
        // Steps are long enough: twice as many change the third digit.
        (0..10).for_each(|_| tracers.step(&mut film, 0.03));
        let energy = (film.energies().iter().sum::<f64>() / start - 1.0).abs();
        let change = tracers.change(&film);
        report(format!("{} vertices: circulations {change:.1e}, energy {energy:.1e}", film.state.positions.len()));
        assert!(energy < 1e-8, "the energy of the air alone is kept: {energy:.1e}");
        change
    });
    let order = (changes[0] / changes[1]).log2();
    assert!(changes[1] < 5e-3 && order > 1.6, "{changes:?}, order {order:.2}");
}

#[test]
fn vertices_of_the_pointwise_scheme_go_with_the_air_and_keep_their_circulation() {
    let mut film = pushed(6, Discretisation::Pointwise);
    let places = film.state.positions.clone();
    let circulations = |film: &Film| -> Vec<f64> {
        let of = |v: usize| film.sheet.layout.sides_of(v).map(|side| film.state.potentials[side]);
        (0..places.len()).map(|v| of(v).reduce(|a, b| b - a).unwrap()).collect()
    };
    let start = circulations(&film);
    (0..10).for_each(|_| film.step(0.03));
    let changes: Vec<f64> = circulations(&film).iter().zip(&start).map(|(now, old)| now - old).collect();
    // Loops go from vertex to vertex: a constant is none.
    let [least, most] = [f64::min, f64::max].map(|of| changes.iter().copied().reduce(of).unwrap());
    let largest = start.iter().map(|gamma| gamma.abs()).fold(0.0, f64::max);
    let way = film.state.positions.iter().zip(&places).map(|(x, old)| x.distance(*old)).fold(0.0, f64::max);
    report(format!("pointwise: circulations change by {:.1e}, vertices move by {way:.2}", (most - least) / largest));
    assert!(way > 0.1 && most - least < 1e-6 * largest, "{way} {:e}", (most - least) / largest);
}
