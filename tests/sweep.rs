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
    let (coarse, fine) = (bow("400 nm", 200), bow("400 nm", 800));
    let expected = membrane();
    // The particles that hold the rim stand half a spacing or more outside it: the film acts wider by about 1.2 spacings.
    let spacing = SIDE / 800_f64.sqrt();
    assert!((fine / expected - 1.0).abs() < 2.6 * spacing / SIDE, "{fine} m, not {expected} m");
    // First order in the spacing: what two spacings, one twice the other, point to is the membrane itself.
    let limit = 2.0 * fine - coarse;
    assert!((limit / expected - 1.0).abs() < 0.015, "{coarse} m and {fine} m point to {limit} m, not {expected} m");
}

#[test]
fn a_thick_film_bows_like_a_thin_one() {
    let (thin, thick) = (bow("200 nm", 200), bow("1 um", 200));
    assert!((thick / thin - 1.0).abs() < 0.01, "{thick} m and {thin} m");
}
