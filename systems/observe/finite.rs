//! The guard that every method runs: no registered column holds a NaN or an infinity.

use bevy_ecs::world::World;

use super::faults::{Fault, Faults};
use crate::rows::registry::ColumnRegistry;
use crate::stage::Stage;

/// Reports the first value that is not finite in every column that has one. One pass over each column, without copies.
pub fn check_finite(world: &mut World) {
    let entries = world.resource::<ColumnRegistry>().entries().to_vec();
    for entry in entries {
        let Some(row) = entry.first_not_finite(world) else { continue };
        let fault = Fault::new(Stage::Observe, entry.name, format!("is not finite in row {row}"));
        let fault = fault.on_particle(entry.kind, row, entry.stable_id(world, row));
        world.get_resource_or_init::<Faults>().report(fault);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rows::{fill_column, spawn_rows};
    use froth_components::identity::StableId;
    use froth_components::kind::EulerianParticle;
    use froth_components::motion::Velocity;
    use glam::DVec3;

    #[test]
    fn a_value_that_is_not_finite_is_named_by_its_particle() {
        let mut world = World::new();
        ColumnRegistry::register::<EulerianParticle, StableId>(&mut world);
        ColumnRegistry::register::<EulerianParticle, Velocity>(&mut world);
        spawn_rows::<EulerianParticle>(&mut world, 2);
        fill_column::<EulerianParticle, _>(&mut world, &[StableId(40), StableId(41)]);
        check_finite(&mut world);
        assert!(Faults::none(&world));
        let spoilt = Velocity(DVec3::new(0.0, f64::INFINITY, 0.0));
        fill_column::<EulerianParticle, _>(&mut world, &[Velocity::default(), spoilt]);
        check_finite(&mut world);
        let message = world.resource::<Faults>().all()[0].to_string();
        assert_eq!(message, "Observe: `velocity` of eulerian particle 41 is not finite in row 1");
    }
}
