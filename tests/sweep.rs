//! Law: a film under an even pressure bows like a membrane of tension `2σ`, however thick it is.

use froth::Simulation;
use froth_components::kind::EulerianParticle;
use froth_components::motion::Position;

const SIDE: f64 = 0.08;
const PRESSURE: f64 = 0.2;
const TENSION: f64 = 2.0 * 0.03;

/// How far a square film stands out at its middle when a pulse much wider than it rests on it, metres.
fn bow(thickness: &str, particles: u32) -> f64 {
    let scene = format!(
        r#"Scene(
    title: "",
    method: Melp(),
    resolution: Particles({particles}),
    duration: "0.4 s",
    liquid: (surface_tension: "30 mN/m"),
    entities: [
        [ Rectangle(width: {SIDE}, height: {SIDE}), Film(thickness: Uniform("{thickness}")) ],
        [ Sweep(pressure: [(t: 0, v: 0), (t: 0.1, v: {PRESSURE})], width: 10, speed: 0) ],
        [ AirDrag(rate: 20, normal: 40) ],
    ],
)"#
    );
    let mut simulation = Simulation::builder().build_from_text("square.ron", &scene).unwrap();
    simulation.run().unwrap();
    let positions = simulation.column::<EulerianParticle, Position>();
    positions.iter().map(|x| x.0.z).fold(0.0, f64::max)
}

/// Middle of a square membrane of side `a`: `16 p a² / (π⁴ T) Σ ± 1 / (m n (m² + n²))` over odd `m`, `n`.
fn membrane() -> f64 {
    let odd = || (0..50).map(|i| (f64::from(2 * i + 1), 1.0 - 2.0 * f64::from(i % 2)));
    let sum: f64 = odd().flat_map(|(m, s)| odd().map(move |(n, t)| s * t / (m * n * (m * m + n * n)))).sum();
    16.0 * PRESSURE * SIDE.powi(2) / (std::f64::consts::PI.powi(4) * TENSION) * sum
}

#[test]
fn an_even_pressure_bows_a_film_like_a_membrane() {
    let [coarse, fine] = [200, 800].map(|particles| bow("400 nm", particles) / membrane() - 1.0);
    assert!(coarse.abs() < 0.04 && fine.abs() < 0.015, "{coarse} and {fine} off");
    // At least first order: half the spacing, less than half the error.
    assert!(fine.abs() < 0.5 * coarse.abs(), "{coarse} and {fine} off");
}

#[test]
fn a_thick_film_bows_like_a_thin_one() {
    let (thin, thick) = (bow("200 nm", 200), bow("1 um", 200));
    assert!((thick / thin - 1.0).abs() < 0.01, "{thick} m and {thin} m");
}
