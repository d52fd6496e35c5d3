//! Components of your own: `Magnet(...)` that a scene can write, and `Charge` that every particle carries.
//!
//! `cargo run --example custom_component`
#![expect(clippy::print_stdout, reason = "an example prints")]

use bevy_ecs::prelude::*;
use froth::Simulation;
use froth_components::columns;
use froth_components::kind::EulerianParticle;
use froth_components::motion::{ExternalAcceleration, Position};
use glam::DVec3;
use serde::Deserialize;

/// Pulls charged film towards a place. In a scene: `[ Magnet(place: (0, 0.2, 0), strength: 3) ]`.
#[derive(Component, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Magnet {
    /// Metres.
    place: DVec3,
    /// Acceleration per charge, m/s^2 per coulomb.
    strength: f64,
}

columns! {
    /// Charge, coulombs. Sorted, saved and exported with the particles.
    pub struct Charge(f64), "charge", "C";
}

const SCENE: &str = r#"Scene(
    title: "A charged bubble",
    method: Melp(liquid_per_carrier: 4),
    resolution: Particles(600),
    duration: "0.1 s",
    entities: [
        [ Sphere(radius: "5 cm"), Film(thickness: Uniform("400 nm")) ],
        [ Magnet(place: (0.0, 0.2, 0.0), strength: 3.0) ],
    ],
)"#;

fn attract(mut films: Query<(&Position, &Charge, &mut ExternalAcceleration)>, magnets: Query<&Magnet>) {
    for (position, charge, mut acceleration) in &mut films {
        for magnet in &magnets {
            acceleration.0 += magnet.strength * charge.0 * (magnet.place - position.0).normalize_or_zero();
        }
    }
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let builder = Simulation::builder().component::<Magnet>("Magnet", "field: pulls charged films");
    let mut simulation = builder.column::<EulerianParticle, Charge>().build_from_text("charged.ron", SCENE)?;
    let count = simulation.column::<EulerianParticle, Charge>().len();
    simulation.set_column::<EulerianParticle, _>(&vec![Charge(1.0); count]);
    simulation.add_force("attract", attract);
    simulation.run()?;
    let height = simulation.observables().get("centre_y").unwrap_or_default();
    println!("after {} s the magnet has lifted the bubble by {:.2} mm", simulation.time(), 1e3 * height);
    Ok(())
}
