//! Laws of free films and of the forces on them: what they do to the momentum of a bubble as a whole.

use froth::Simulation;
use froth_components::film::{Area, LiquidVolume, Thickness};
use froth_components::kind::{EulerianParticle as E, LagrangianParticle as L};
use froth_components::motion::{Normal, NormalSpeed, Position, Velocity};
use glam::DVec3;

const DENSITY: f64 = 1000.0;
const GRAVITY: f64 = 9.81;
const RADIUS: f64 = 0.05;
/// Air that moves with the film, kg/m^2.
const AIR: f64 = 1e-3;

/// A bubble of 5 cm with more components on its film, and more entities.
fn bubble(on_film: &str, entities: &str) -> Simulation {
    let scene = format!(
        r#"Scene(
    title: "",
    method: Melp(liquid_per_carrier: 6, air: Fixed("1 g/m^2")),
    resolution: Particles(500),
    duration: "1 s",
    entities: [ [ Sphere(radius: "5 cm"), {on_film} ], {entities} ],
)"#
    );
    Simulation::builder().build_from_text("bubble.ron", &scene).unwrap()
}

const FILM: &str = r#"Film(thickness: Uniform("400 nm"))"#;

/// `sum m (u + s n) + m_air s n` and the mass of the liquid.
fn momentum(simulation: &mut Simulation) -> (DVec3, f64) {
    let volumes = simulation.column::<L, LiquidVolume>();
    let along =
        simulation.column::<L, Velocity>().iter().zip(&volumes).map(|(u, v)| u.0 * v.0 * DENSITY).sum::<DVec3>();
    let (normals, speeds) = (simulation.column::<E, Normal>(), simulation.column::<E, NormalSpeed>());
    let (areas, thickness) = (simulation.column::<E, Area>(), simulation.column::<E, Thickness>());
    let mass = |i: usize| (DENSITY * thickness[i].0 + AIR) * areas[i].0;
    let across = (0..normals.len()).map(|i| normals[i].0 * (speeds[i].0 * mass(i))).sum::<DVec3>();
    (along + across, volumes.iter().map(|v| v.0 * DENSITY).sum())
}

/// The force on a bubble, over the mass of its liquid, from the momentum it has after a while.
fn mean_acceleration(on_film: &str, entities: &str, time: f64) -> DVec3 {
    let mut simulation = bubble(on_film, entities);
    simulation.advance_to(time).unwrap();
    let (momentum, mass) = momentum(&mut simulation);
    momentum / (mass * time)
}

#[test]
fn a_drifting_bubble_is_a_resting_one_elsewhere() {
    let drift = DVec3::new(0.5, 0.0, -0.2);
    let mut simulation = bubble(&format!("{FILM}, Drift((0.5, 0, -0.2))"), "");
    while !simulation.has_reached(0.5) {
        simulation.step_within(0.5).unwrap();
        assert_eq!(simulation.observables().get("carriers_limited"), Some(0.0));
        let excess = simulation.observables().get("excess_pressure_1").unwrap();
        assert!((excess - 2.4).abs() < 0.01, "{excess} Pa at {} s", simulation.time());
    }
    let positions = simulation.column::<E, Position>();
    let centre = positions.iter().map(|x| x.0).sum::<DVec3>() / positions.len() as f64;
    assert!(centre.distance(drift * 0.5) < 2e-3 * 0.25, "{centre}");
    let (low, high) = positions
        .iter()
        .map(|x| x.0.distance(centre))
        .fold((1.0_f64, 0.0_f64), |(low, high), r| (low.min(r), high.max(r)));
    assert!(high - low < 1e-3 * RADIUS, "{low} to {high}");
    let speed = simulation.column::<L, Velocity>();
    let normals = simulation.column::<L, Normal>();
    let strayed = |(u, n): (&Velocity, &Normal)| (u.0 - drift.reject_from_normalized(n.0)).length();
    let strayed = speed.iter().zip(&normals).map(strayed).sum::<f64>() / normals.len() as f64;
    assert!(strayed < 5e-3, "{strayed} m/s");
}

#[test]
fn a_bubble_that_nothing_pushes_keeps_its_momentum() {
    let mut simulation = bubble(&format!("{FILM}, Bumps(amplitude: 0.06, frequency: 1.5), Drift((0.1, 0, 0))"), "");
    let at = |simulation: &mut Simulation, time: f64| {
        simulation.advance_to(time).unwrap();
        let (momentum, mass) = momentum(simulation);
        momentum / mass
    };
    let (early, late) = (at(&mut simulation, 0.02), at(&mut simulation, 0.3));
    // It wobbles at 0.3 m/s; transfers between tangent planes and the spreading of carriers pass on all but a little of that.
    assert!(early.distance(late) < 0.025, "{early} to {late} m/s");
}

#[test]
fn gravity_gives_a_bubble_its_weight() {
    let found = mean_acceleration(FILM, "[ Gravity((0, -9.81, 0)) ]", 0.1);
    assert!(found.distance(DVec3::NEG_Y * GRAVITY) < 0.02 * GRAVITY, "{found}");
}

#[test]
fn warm_film_is_lighter() {
    let warm = r#"Film(thickness: Uniform("400 nm"), warmth: 0.5)"#;
    let source =
        r#"[ HeatSource(position: (0, -10, 0), radius: "1 cm", warming: "1 s", cooling: 1e9, expansion: 0.4) ]"#;
    let found = mean_acceleration(warm, &format!("[ Gravity((0, -9.81, 0)) ], {source}"), 0.1);
    assert!((found.y / (-GRAVITY * (1.0 - 0.4 * 0.5)) - 1.0).abs() < 0.02, "{found}");
}

#[test]
fn hover_carries_the_weight_and_nothing_else() {
    let hovering = mean_acceleration(FILM, "[ Gravity((0, -9.81, 0)) ], [ Hover() ]", 0.1);
    assert!(hovering.length() < 0.02 * GRAVITY, "{hovering}");
    let wind = r#"[ Wind(velocity: (3, 0, 0), drag: "2 1/s") ]"#;
    let blown = mean_acceleration(FILM, wind, 0.1);
    // The wind begins with 2/s times 3 m/s, and less as the bubble gains speed.
    assert!(blown.x > 4.0 && blown.x < 6.0 && blown.y.abs() + blown.z.abs() < 0.05, "{blown}");
    let both = mean_acceleration(FILM, &format!("[ Gravity((0, -9.81, 0)) ], [ Hover() ], {wind}"), 0.1);
    assert!((both - blown).length() < 0.02 * GRAVITY, "{both} but {blown} without weight");
}

#[test]
fn still_air_brakes_the_flow_at_its_rate() {
    let speed = |rate: &str| {
        let drag = format!("[ AirDrag(rate: \"{rate}\", normal: 0) ]");
        let mut simulation = bubble(&format!("{FILM}, Spin(rate: \"10 rad/s\")"), &drag);
        simulation.advance_to(0.1).unwrap();
        simulation.observables().get("mean_speed").unwrap()
    };
    let left = speed("5 1/s") / speed("0 1/s");
    assert!((left.ln() / -0.5 - 1.0).abs() < 0.02, "{left}");
}
