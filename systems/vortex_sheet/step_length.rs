//! Steps and substeps of a sheet: capillary waves as short as the mesh limit substeps, speed and strain limit steps.
//!
//! Both are those of the step before, so a step is at most half as long again as the one before it; the first holds a few substeps. Where a
//! substep turns out to be faster all the same, as when films meet, it is taken again, shorter ([`shorten_substep`]).

use bevy_ecs::query::With;
use bevy_ecs::system::{Query, Res, ResMut};
use bevy_ecs::world::World;
use froth_components::clock::Clock;
use froth_components::kind::MeshVertex;
use froth_components::material::Liquid;
use froth_components::motion::{Position, Velocity};
use froth_sheet::step_length::{capillary_time, limiting_edge, straining};
use froth_sheet::{Potentials, geometry};
use froth_surface::SurfaceMesh;

use super::settings::SheetRules;
use super::work::{SheetWork, load, with_work};
use crate::clock::StepLimits;
use crate::plan::AnotherPass;
use crate::rows::reduce::ordered_max;
use crate::rows::{columns, fill_column};
use crate::stage::Stage;
use crate::tracker::films::MeshRules;
use crate::tracker::tension::BubbleTensions;

/// Longest step in steps before.
const GROWTH: f64 = 1.5;
/// Substeps of the first step.
const FIRST: f64 = 4.0;
/// Substeps that a step may hold: enough for any mesh that the tracker keeps.
const MOST_SUBSTEPS: u32 = 1000;
/// A substep that would carry or strain films more than this many times as far as a step may is not taken.
const TOO_FAR: f64 = 2.0;
/// Least part of a substep that is tried in its stead.
const LEAST_PART: f64 = 1e-6;

/// Proposes the lengths of step and substeps.
pub fn limit_step(
    vertices: Query<(&Position, &Velocity), With<MeshVertex>>,
    films: Res<SurfaceMesh>,
    rules: Res<SheetRules>,
    mesh: Res<MeshRules>,
    liquid: Res<Liquid>,
    tensions: Res<BubbleTensions>,
    clock: Res<Clock>,
    mut limits: ResMut<StepLimits>,
) {
    if vertices.is_empty() {
        return; // The last film has burst.
    }
    let (positions, velocities) = columns(&vertices);
    let sides = films.faces().filter(|(_, face)| !face.is_ghost()).flat_map(|(_, face)| {
        let [a, b, c] = face.vertices().map(|v| positions[v.index()].0);
        [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)]
    });
    let shortest = sides.fold(f64::INFINITY, f64::min).sqrt();
    let shortest = limiting_edge(shortest, rules.kernel.smoothing_length);
    let capillary = rules.courant * capillary_time(shortest, rules.density, tensions.largest(liquid.surface_tension));
    limits.propose_for_substeps("capillary waves", capillary, MOST_SUBSTEPS);
    let fastest = ordered_max(velocities.len(), 0.0, |v| velocities[v].0.length());
    limits.propose("cfl", rules.cfl * mesh.policy.edge / fastest);
    let faces = films.faces().filter(|(_, face)| !face.is_ghost()).map(|(_, face)| {
        let corners = face.vertices().map(|v| (positions[v.index()].0, velocities[v.index()].0));
        (corners.map(|(x, _)| x), corners.map(|(_, w)| w))
    });
    limits.propose("strain", rules.cfl / straining(faces, limiting_edge(0.0, rules.kernel.smoothing_length)));
    if clock.steps > 0 {
        limits.propose("growth", GROWTH * clock.step_length);
    } else {
        limits.propose("first step", FIRST * capillary);
    }
}

/// Begins the substep again, shorter, or ends the step before it, where films turn out to be faster than the step before let expect.
pub fn shorten_substep(world: &mut World) {
    with_work(world, Stage::Velocity, |world, work, substep| {
        let part = world.resource::<SheetRules>().cfl / (rate(world, work) * substep.length);
        if !(part * TOO_FAR < 1.0) {
            return Ok(());
        }
        let SheetWork { sheet, state, heads, integration, is_under_way, report, .. } = work;
        state.positions.clone_from(&integration.start().positions);
        world.resource::<Potentials>().gather(&sheet.layout, &mut state.potentials, heads);
        *is_under_way = false;
        report.substeps -= 1;
        let start: Vec<Position> = state.positions.iter().map(|x| Position(*x)).collect();
        fill_column::<MeshVertex, _>(world, &start);
        let taken = report.substeps;
        let mut clock = world.resource_mut::<Clock>();
        if taken > 0 {
            clock.end_after(taken);
            // No other pass does it.
            work.sheet.measure(&work.state.positions);
            load(world, work);
        } else {
            (clock.step_length, clock.substeps) = (substep.length * part.max(LEAST_PART), 1);
            world.resource_mut::<AnotherPass>().0 = true;
        }
        let length = world.resource::<Clock>().step_length;
        world.resource_mut::<StepLimits>().propose("speed within the step", length);
        Ok(())
    });
}

/// How fast films move, in edges of the scene, and change their shape, whichever is more, 1/s.
fn rate(world: &World, work: &SheetWork) -> f64 {
    let SheetWork { sheet, state, .. } = work;
    let least = limiting_edge(0.0, world.resource::<SheetRules>().kernel.smoothing_length);
    let fastest = sheet.velocities.iter().map(|w| w.length()).fold(0.0, f64::max);
    let faces = sheet.layout.panels().iter();
    let faces = faces.map(|panel| [&state.positions, &sheet.velocities].map(|column| geometry::corners(panel, column)));
    (fastest / world.resource::<MeshRules>().policy.edge).max(straining(faces.map(|[x, w]| (x, w)), least))
}
