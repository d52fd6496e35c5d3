//! Where an evaluation takes the films: the next trial state, or the end of the substep.

use bevy_ecs::world::World;
use froth_components::clock::Clock;
use froth_components::kind::MeshVertex;
use froth_components::motion::Position;
use froth_sheet::potentials::centre;
use froth_sheet::{Next, Potentials, Rates};
use froth_surface::motion::{MotionSettings, advance};
use froth_surface::{EventKind, Region, Surface};
use glam::DVec3;

use super::geometry::lay_out;
use super::settings::SheetRules;
use super::work::{SheetFault, SheetWork, Substep, forcing, with_work};
use crate::bubbles::gas::BubbleGas;
use crate::plan::AnotherPass;
use crate::rows::fill_column;
use crate::stage::Stage;
use crate::tracker::events::StepEvents;
use crate::tracker::films::{self, MeshRules, TopologyChanged};
use crate::tracker::wires::{MOST_STOPS, WireLag};

/// Part of an edge length that giving volumes back may move a vertex.
const LONGEST_WAY: f64 = 0.5;

/// Hands the rates to the integrator, and goes where it says.
pub fn move_films(world: &mut World) {
    with_work(world, Stage::Deform, |world, work, substep| {
        let rules = *world.resource::<SheetRules>();
        let mut rates = Vec::new();
        work.sheet.potential_rates(rules.density, &mut rates);
        let taken = Rates { velocities: &work.sheet.velocities, potentials: &rates };
        match work.integration.take(rules.integrator, substep.length, taken, &mut work.state)? {
            Next::Evaluate => {
                let positions: Vec<Position> = work.state.positions.iter().map(|x| Position(*x)).collect();
                fill_column::<MeshVertex, _>(world, &positions);
                world.resource_mut::<AnotherPass>().0 = true;
                Ok(())
            }
            Next::Finish => {
                work.is_under_way = false;
                finish(world, work, substep)
            }
        }
    });
}

/// Moves the films to the end of the substep, as far as none touches another, and completes the potentials there.
fn finish(world: &mut World, work: &mut SheetWork, substep: Substep) -> Result<(), SheetFault> {
    let mut surface = films::take(world);
    surface.positions.0.clone_from(&work.integration.start().positions);
    let moved = carry(world, work, substep, &mut surface);
    work.state.positions.clone_from(&surface.positions.0);
    films::put_back(world, surface);
    moved?;
    settle(world, work, substep)
}

fn carry(world: &mut World, work: &mut SheetWork, substep: Substep, surface: &mut Surface) -> Result<(), SheetFault> {
    let SheetWork { sheet, state, wire_velocities, report, .. } = work;
    let held = surface.pinned.iter().zip(wire_velocities).zip(&surface.positions.0);
    for (proposed, ((_, u), x)) in state.positions.iter_mut().zip(held).filter(|(_, ((held, _), _))| **held) {
        *proposed = *x + *u * substep.length;
    }
    let correction = sheet.meet_volumes(&mut state.positions, &world.resource::<BubbleGas>().targets)?;
    report.volume_correction = report.volume_correction.max(correction);
    let settings = MotionSettings::new(world.resource::<MeshRules>().policy.edge);
    let went = advance(surface, &state.positions, &settings);
    report.limited = report.limited.max(went.limited_vertices);
    report.least_fraction = report.least_fraction.min(went.least_fraction).min(went.pinned_fraction);
    if went.limited_vertices > 0 || went.pinned_fraction < 1.0 {
        // Films that meet are the tracker's to join; until then the air would go on driving them at each other.
        world.resource_mut::<Clock>().end_after(report.substeps);
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

/// The second kick, damping and impulse, where the films have come to.
fn settle(world: &mut World, work: &mut SheetWork, substep: Substep) -> Result<(), SheetFault> {
    let rules = *world.resource::<SheetRules>();
    let SheetWork { sheet, state, heads, forces, impulses, report, .. } = work;
    let forcing = forcing(world, forces);
    heads.clone_from(&sheet.heads);
    sheet.measure(&state.positions);
    sheet.load(&state.positions, &forcing);
    if let Some([_, after]) = rules.integrator.kicks() {
        sheet.kick(after * substep.length, rules.density, heads, &mut state.potentials);
    }
    let gained = sheet.impulse_gained(&forcing, substep.length);
    let wanted: Vec<DVec3> = impulses.iter().zip(gained).map(|(p, gain)| *p + gain).collect();
    let correction = sheet.keep_impulse(&state.positions, &wanted, &mut state.potentials);
    report.impulse_correction = report.impulse_correction.max(correction);
    sheet.damp(&state.positions, rules.diffusivity, substep.length, &mut state.potentials)?;
    let kept = (-rules.damping * substep.length).exp();
    state.potentials.iter_mut().for_each(|phi| *phi *= kept);
    centre(&sheet.layout, &mut state.potentials);
    let potentials = Potentials::scattered(&sheet.layout, &state.potentials, heads);
    *world.resource_mut::<Potentials>() = potentials;
    Ok(())
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

/// Notes the impulse of every free cluster, to be restored when the mesh has changed.
pub fn note_impulses(world: &mut World) {
    with_work(world, Stage::Advance, |_, work, _| {
        let SheetWork { sheet, state, kept_impulses, .. } = work;
        let names = sheet.clusters.names(&sheet.layout).into_iter();
        *kept_impulses = names.zip(sheet.impulses(&state.potentials)).collect();
        Ok(())
    });
}

/// Gives the bubbles back what remeshing took of their volumes and the clusters what it took of their impulse, or takes what it gave. It
/// is no motion in time: potentials stay but for the impulse.
///
/// A bubble that is too small or too thin for it is left to the next step.
pub fn restore_volumes(world: &mut World) {
    if !world.resource::<TopologyChanged>().0 {
        return;
    }
    with_work(world, Stage::Topology, |world, work, _| {
        let edge = world.resource::<MeshRules>().policy.edge;
        lay_out(world, work);
        work.sheet.measure(&work.state.positions);
        let mut wanted = work.state.positions.clone();
        // Errors are the next step's to report: here nothing has moved yet.
        let way = work.sheet.meet_volumes(&mut wanted, &world.resource::<BubbleGas>().targets);
        if way.is_ok_and(|way| way < LONGEST_WAY * edge) {
            let mut surface = films::take(world);
            // A vertex that is held up here is settled by the next step.
            let _ = advance(&mut surface, &wanted, &MotionSettings::new(edge));
            work.state.positions.clone_from(&surface.positions.0);
            films::put_back(world, surface);
        }
        restore_impulses(world, work);
        Ok(())
    });
}

/// Gives clusters that are the same as before remeshing the impulse that they had. A film that burst took its own along.
fn restore_impulses(world: &mut World, work: &mut SheetWork) {
    let SheetWork { sheet, state, heads, kept_impulses, report, .. } = work;
    let names = sheet.clusters.names(&sheet.layout);
    if names.len() != kept_impulses.len()
        || world.resource::<StepEvents>().0.iter().any(|event| event.kind == EventKind::Burst)
    {
        return;
    }
    let is_alone = names.len() == 1;
    let of =
        |name: &Region| kept_impulses.iter().find(|(kept, _)| is_alone || kept == name).map(|(_, impulse)| *impulse);
    let Some(wanted) = names.iter().map(of).collect::<Option<Vec<DVec3>>>() else { return };
    sheet.measure(&state.positions);
    let correction = sheet.keep_impulse(&state.positions, &wanted, &mut state.potentials);
    report.impulse_correction = report.impulse_correction.max(correction);
    *world.resource_mut::<Potentials>() = Potentials::scattered(&sheet.layout, &state.potentials, heads);
}
