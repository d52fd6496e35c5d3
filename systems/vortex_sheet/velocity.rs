//! Velocities of the films from their circulations: the Biot-Savart law.

use bevy_ecs::world::World;
use froth_components::kind::MeshVertex;
use froth_components::material::Liquid;
use froth_components::motion::Velocity;
use froth_sheet::step_length::capillary_time;

use super::settings::SheetRules;
use super::work::{SheetWork, with_work};
use crate::rows::fill_column;
use crate::stage::Stage;
use crate::tracker::films::MeshRules;
use crate::tracker::tension::BubbleTensions;

/// Time in which the mesh slides its part of the way: a substep of a mesh whose edges have the length that the scene asks for, s.
///
/// Short edges make substeps short; vertices that slid as far in each of those would race along the films.
fn sliding_interval(world: &World) -> f64 {
    let tension = world.resource::<BubbleTensions>().largest(world.resource::<Liquid>().surface_tension);
    let (rules, edge) = (world.resource::<SheetRules>(), world.resource::<MeshRules>().policy.edge);
    rules.courant * capillary_time(edge, rules.density, tension)
}

/// Works out sheet strengths, vector potentials, fluxes and velocities, and what convection does to the potentials.
pub fn flow_by_biot_savart(world: &mut World) {
    with_work(world, Stage::Velocity, |world, work, substep| {
        let rules = *world.resource::<SheetRules>();
        let SheetWork { sheet, state, wire_velocities, report, .. } = work;
        sheet.flow(
            &state.positions,
            &state.potentials,
            wire_velocities,
            rules.density,
            &rules.sliding,
            sliding_interval(world).max(substep.length),
        )?;
        report.evaluations += 1;
        let velocities: Vec<Velocity> = sheet.velocities.iter().map(|w| Velocity(*w)).collect();
        fill_column::<MeshVertex, _>(world, &velocities);
        Ok(())
    });
}
