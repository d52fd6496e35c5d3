//! Warms and cools the material particles.
//!
//! # Equation
//! `dT/dt = w (1 - T)/warming - (1 - w) T/cooling`, `w = exp(-|x - position|^2 / radius^2)`.
//!
//! # Discretisation
//! Exact over a step for the `w` at its start: stable for any step.

use crate::rows::columns_mut;
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res};
use froth_components::authored::field::HeatSource;
use froth_components::clock::Clock;
use froth_components::film::Warmth;
use froth_components::kind::LagrangianParticle;
use froth_components::motion::Position;
use rayon::prelude::*;

/// Relaxes the warmth of every material particle toward its surroundings.
pub fn warm_liquid(
    sources: Query<&HeatSource>,
    mut material: Query<(&Position, &mut Warmth), With<LagrangianParticle>>,
    clock: Res<Clock>,
) {
    let sources: Vec<HeatSource> = sources.iter().copied().collect();
    let (positions, mut warmth) = columns_mut(&mut material);
    warmth.bypass_change_detection().par_iter_mut().zip(positions).with_min_len(1024).for_each(|(warmth, x)| {
        for source in &sources {
            let distance = x.0.distance_squared(source.position.si()) / source.radius.si().powi(2);
            let share = (-distance).exp();
            warmth.0 =
                relaxed(warmth.0, share / source.warming.si(), (1.0 - share) / source.cooling.si(), clock.step_length);
        }
    });
}

/// Solution after `step` of `dT/dt = heating (1 - T) - cooling T`.
fn relaxed(warmth: f64, heating: f64, cooling: f64, step: f64) -> f64 {
    let rate = heating + cooling;
    let rest = if rate > 0.0 { heating / rate } else { warmth };
    rest + (warmth - rest) * (-rate * step).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warmth_tends_to_the_balance_of_heating_and_cooling() {
        assert_eq!(relaxed(0.3, 0.0, 0.0, 5.0), 0.3);
        assert!((relaxed(0.0, 3.0, 1.0, 100.0) - 0.75).abs() < 1e-12);
        assert!((relaxed(0.0, 2.0, 0.0, 0.01) - 0.02).abs() < 3e-4);
    }
}
