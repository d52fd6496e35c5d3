//! Where an evaluation takes the films: the next trial state, or the end of the substep.

use bevy_ecs::world::World;
use froth_components::clock::Clock;
use froth_components::kind::MeshVertex;
use froth_components::motion::Position;
use froth_sheet::{Next, Rates};
use froth_surface::Surface;
use froth_surface::motion::{MotionSettings, advance};
use glam::DVec3;

use super::settings::SheetRules;
use super::work::{SheetFault, SheetWork, Substep, on_arrival, with_work};
use crate::bubbles::gas::BubbleGas;
use crate::clock::StepLimits;
use crate::plan::AnotherPass;
use crate::rows::fill_column;
use crate::stage::Stage;
use crate::tracker::films::{self, MeshRules};
use crate::tracker::wires::{MOST_STOPS, WireLag};

/// Part of its way that a vertex may fall short of by rounding.
const ROUNDING: f64 = 1e-9;

/// Hands the rates to the integrator, which asks for rates elsewhere or says where the substep ends.
pub fn integrate(world: &mut World) {
    with_work(world, Stage::Deform, |world, work, substep| {
        if !work.is_under_way {
            return Ok(()); // The substep begins again, or is not taken.
        }
        let rules = *world.resource::<SheetRules>();
        let mut rates = Vec::new();
        work.sheet.potential_rates(rules.density, &mut rates);
        let taken = Rates { velocities: &work.sheet.velocities, potentials: &rates };
        match work.integration.take(rules.integrator, substep.length, taken, &mut work.state)? {
            Next::Evaluate => {
                let positions: Vec<Position> = work.state.positions.iter().map(|x| Position(*x)).collect();
                fill_column::<MeshVertex, _>(world, &positions);
                world.resource_mut::<AnotherPass>().0 = true;
            }
            Next::Finish => (work.is_under_way, work.has_arrived) = (false, true),
        }
        Ok(())
    });
}

/// Gives the bubbles the volumes that they shall have at the end of the substep.
pub fn fill_bubbles(world: &mut World) {
    on_arrival(world, |world, _, substep| {
        world.resource_mut::<BubbleGas>().fill(substep.time, substep.time + substep.length);
        Ok(())
    });
}

/// Moves the films to the end of the substep with the volumes that they shall have, as far as none touches another.
pub fn move_films(world: &mut World) {
    on_arrival(world, |world, work, substep| {
        let mut surface = films::take(world);
        surface.positions.0.clone_from(&work.integration.start().positions);
        let moved = carry(world, work, substep, &mut surface);
        work.state.positions.clone_from(&surface.positions.0);
        films::put_back(world, surface);
        moved?;
        work.sheet.measure(&work.state.positions);
        Ok(())
    });
}

fn carry(world: &mut World, work: &mut SheetWork, substep: Substep, surface: &mut Surface) -> Result<(), SheetFault> {
    let SheetWork { sheet, state, integration, wire_velocities, touching, report, .. } = work;
    let start = &integration.start().positions;
    let held = surface.pinned.iter().zip(wire_velocities).zip(&surface.positions.0);
    for (proposed, ((_, u), x)) in state.positions.iter_mut().zip(held).filter(|(_, ((held, _), _))| **held) {
        *proposed = *x + *u * substep.length;
    }
    let policy = world.resource::<MeshRules>().policy;
    let targets = &world.resource::<BubbleGas>().targets;
    let correction = sheet.meet_volumes(&mut state.positions, targets, unresolved_volume(&policy))?;
    report.volume_correction = report.volume_correction.max(correction);
    let went = advance(surface, &state.positions, &MotionSettings::new(policy.edge));
    let whole = went.pinned_fraction * (1.0 - ROUNDING);
    let ways = surface.positions.0.iter().zip(&state.positions).zip(start).zip(&surface.pinned.0);
    let is_held_up = |x: &DVec3, proposed: &DVec3, from: &DVec3| x.distance(*from) < whole * proposed.distance(*from);
    touching.clear();
    touching.extend(ways.map(|(((x, proposed), from), held)| !held && is_held_up(x, proposed, from)));
    report.limited = report.limited.max(went.limited_vertices);
    report.least_fraction = report.least_fraction.min(went.least_fraction).min(went.pinned_fraction);
    if went.limited_vertices > 0 || went.pinned_fraction < 1.0 {
        // Films that meet are the tracker's to join; until then the air would go on driving them at each other.
        world.resource_mut::<Clock>().end_after(report.substeps);
        let length = world.resource::<Clock>().step_length;
        world.resource_mut::<StepLimits>().propose("contact", length);
    }
    let patience = MOST_STOPS * world.resource::<Clock>().substeps.max(1);
    let mut lag = world.resource_mut::<WireLag>();
    if went.pinned_fraction < 1.0 {
        lag.stopped(substep.length, went.pinned_fraction * substep.length, patience)?;
    } else {
        lag.went_on(substep.length);
    }
    Ok(())
}

/// Volume of bubbles that are too small to be resolved, about two edges across, m^3.
pub(super) fn unresolved_volume(policy: &froth_surface::Policy) -> f64 {
    8.0 * policy.least_volume()
}
