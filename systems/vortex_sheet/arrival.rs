//! The end of a substep, where the films have come to: what its second half does to the potentials.

use bevy_ecs::world::World;
use froth_sheet::Potentials;
use froth_sheet::potentials::centre;
use glam::DVec3;

use super::settings::SheetRules;
use super::work::{SheetWork, load, on_arrival, with_work};
use crate::bubbles::gas::BubbleGas;
use crate::stage::Stage;

/// The second kick by tension, external forces and convection. Integrators that do not kick have done all of it.
pub fn kick_again(world: &mut World) {
    on_arrival(world, |world, work, substep| {
        let rules = *world.resource::<SheetRules>();
        load(world, work);
        let SheetWork { sheet, state, heads, .. } = work;
        heads.clone_from(&sheet.heads);
        if let Some([_, after]) = rules.integrator.kicks() {
            sheet.kick(after * substep.length, rules.density, heads, &mut state.potentials);
        }
        Ok(())
    });
}

/// Gives every free cluster the impulse that it had, and what external forces and gas that comes in have given it since; clusters in contact have theirs together.
pub fn keep_impulse(world: &mut World) {
    on_arrival(world, |world, work, substep| {
        let SheetWork { sheet, state, forces, impulses, touching, report, .. } = work;
        let gained = sheet.impulse_gained(forces, world.resource::<SheetRules>().density, substep.length);
        let strained = sheet.impulse_strained(&state.positions, &state.potentials, substep.length);
        let gains = gained.into_iter().zip(strained).map(|(gain, strained)| gain + strained);
        let wanted: Vec<DVec3> = impulses.iter().zip(gains).map(|(p, gain)| *p + gain).collect();
        let correction = sheet.keep_impulse(&state.positions, &wanted, touching, &mut state.potentials);
        report.impulse_correction = report.impulse_correction.max(correction);
        Ok(())
    });
}

/// Lets circulation diffuse and fade.
pub fn damp(world: &mut World) {
    on_arrival(world, |world, work, substep| {
        let rules = *world.resource::<SheetRules>();
        let SheetWork { sheet, state, .. } = work;
        sheet.damp(&state.positions, rules.diffusivity, substep.length, &mut state.potentials)?;
        let kept = (-rules.damping * substep.length).exp();
        state.potentials.iter_mut().for_each(|phi| *phi *= kept);
        Ok(())
    });
}

/// Writes the potentials of the end of the substep, which ends with that.
pub fn write_potentials(world: &mut World) {
    on_arrival(world, |world, work, _| {
        centre(&work.sheet.layout, &mut work.state.potentials);
        *world.resource_mut::<Potentials>() =
            Potentials::scattered(&work.sheet.layout, &work.state.potentials, &work.heads);
        work.has_arrived = false;
        Ok(())
    });
}

/// Fits one pressure per bubble to those that the films show where the step has taken them.
pub fn fit_pressures(world: &mut World) {
    with_work(world, Stage::Advance, |world, work, _| {
        let pressures = work.sheet.region_pressures();
        for (region, pressure) in &mut world.resource_mut::<BubbleGas>().pressures {
            *pressure = pressures.get(region).copied().unwrap_or(0.0);
        }
        Ok(())
    });
}
