//! A force of your own: a rising wind that blows only on the right half of a bubble.
//!
//! `cargo run --example custom_force`
#![expect(clippy::print_stdout, reason = "an example prints")]

use bevy_ecs::prelude::*;
use froth::Simulation;
use froth_components::clock::Clock;
use froth_components::motion::{ExternalAcceleration, Position};

const SCENE: &str = r#"Scene(
    title: "A bubble in a draught",
    method: Melp(liquid_per_carrier: 4),
    resolution: Particles(600),
    duration: "0.1 s",
    entities: [ [ Sphere(radius: "5 cm"), Film(thickness: Uniform("400 nm")) ] ],
)"#;

/// Any system is a force that adds to `ExternalAcceleration`, m/s^2. It works in every method.
fn draught(mut films: Query<(&Position, &mut ExternalAcceleration)>, clock: Res<Clock>) {
    for (position, mut acceleration) in &mut films {
        if position.0.x > 0.0 {
            acceleration.0.y += 20.0 * clock.time;
        }
    }
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut simulation = Simulation::from_scene_text(SCENE)?;
    simulation.add_force("draught", draught);
    simulation.run()?;
    let height = simulation.observables().get("centre_y").unwrap_or_default();
    println!("after {} s the bubble has risen by {:.2} mm", simulation.time(), 1e3 * height);
    Ok(())
}
