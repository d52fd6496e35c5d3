//! What moves the air and changes the potentials: wind, gas that comes in, tension and external forces, wires.

use bevy_ecs::world::World;
use froth_components::authored::field::Wind;
use froth_components::kind::MeshVertex;
use froth_components::motion::{Pinned, Position};
use glam::DVec3;

use super::motion::unresolved_volume;
use super::settings::SheetRules;
use super::work::{SheetWork, external_forces, load, with_work};
use crate::bubbles::gas::BubbleGas;
use crate::rows::read_column;
use crate::stage::Stage;
use crate::tracker::films::MeshRules;
use crate::tracker::wires::{Holders, WireLag};

/// Looks up how fast the wind is.
///
/// Air that moves as a whole is seen from a frame that goes with it: there films and wires have the velocities that they have against
/// the wind, and a wind that changes presses on both sides of a film alike.
pub fn let_wind_blow(world: &mut World) {
    with_work(world, Stage::Forces, |world, work, substep| {
        let mut winds = world.query::<&Wind>();
        work.sheet.ambient.wind = winds.iter(world).map(|wind| wind.velocity.at(substep.time).si()).sum();
        Ok(())
    });
}

/// Works out how gas that comes into bubbles pushes the air around away.
pub fn push_by_gas(world: &mut World) {
    with_work(world, Stage::Forces, |world, work, substep| {
        let inflows = world.resource::<BubbleGas>().inflows(substep.time, substep.time + substep.length);
        let unresolved = unresolved_volume(&world.resource::<MeshRules>().policy);
        work.sheet.inflate(&work.state.positions, &inflows, unresolved);
        Ok(())
    });
}

/// Works out the pressures that hold the films against tension and external forces; integrators that kick change the potentials by them.
pub fn press_by_tension(world: &mut World) {
    let forces = external_forces(world);
    with_work(world, Stage::Dynamics, |world, work, substep| {
        work.forces = forces;
        let rules = *world.resource::<SheetRules>();
        load(world, work);
        let SheetWork { sheet, state, heads, integration, is_under_way, .. } = work;
        if let Some([before, _]) = rules.integrator.kicks() {
            sheet.kick(before * substep.length, rules.density, heads, &mut state.potentials);
        }
        if !*is_under_way {
            integration.begin(state);
            *is_under_way = true;
        }
        Ok(())
    });
}

/// Chooses the circulation on wires so that films go with them.
pub fn carry_by_wires(world: &mut World) {
    let velocities = |world: &mut World, time: f64, length: f64| {
        let lag = *world.resource::<WireLag>();
        let (from, to) = lag.window(time, length, 0.0, length);
        let pins = read_column::<MeshVertex, Pinned>(world);
        let positions = read_column::<MeshVertex, Position>(world);
        let targets = world.resource::<Holders>().targets(&positions, &pins, from, to);
        targets.iter().zip(&positions).map(|(to, x)| (*to - x.0) / length).collect::<Vec<DVec3>>()
    };
    with_work(world, Stage::Dynamics, |world, work, substep| {
        work.wire_velocities = velocities(world, substep.time, substep.length);
        let SheetWork { sheet, state, wire_velocities, report, .. } = work;
        sheet.hold(&state.positions, wire_velocities, &mut state.potentials)?;
        report.wire_iterations = report.wire_iterations.max(sheet.measured.wires.iterations);
        Ok(())
    });
}
