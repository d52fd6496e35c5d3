//! What remeshing may not change: volumes of bubbles, impulses of clusters. It is no motion in time: potentials stay but for the impulse.

use bevy_ecs::world::World;
use froth_sheet::{Potentials, Sheet};
use froth_surface::motion::{MotionSettings, advance};
use froth_surface::{EventKind, Region};
use glam::DVec3;

use super::geometry::lay_out;
use super::motion::unresolved_volume;
use super::work::{SheetWork, with_work};
use crate::bubbles::gas::BubbleGas;
use crate::stage::Stage;
use crate::tracker::events::StepEvents;
use crate::tracker::films::{self, MeshRules, TopologyChanged};

/// Part of an edge length that giving volumes back may move a vertex.
const LONGEST_WAY: f64 = 0.5;

/// Notes the impulse of every free cluster, to be restored when the mesh has changed.
pub fn note_impulses(world: &mut World) {
    with_work(world, Stage::Advance, |_, work, _| {
        let SheetWork { sheet, state, kept_impulses, .. } = work;
        let names = sheet.clusters.names(&sheet.layout).into_iter();
        *kept_impulses = names.zip(sheet.impulses(&state.potentials)).collect();
        Ok(())
    });
}

/// Lays the sheet out on the mended mesh, and gives the bubbles back what remeshing took of their volumes, or takes what it gave.
///
/// A bubble that is too small or too thin for it is left to the next step.
pub fn restore_volumes(world: &mut World) {
    let has_changed = world.resource::<TopologyChanged>().0;
    with_work(world, Stage::Topology, |world, work, _| {
        work.was_mended = has_changed;
        if !has_changed {
            return Ok(());
        }
        let policy = world.resource::<MeshRules>().policy;
        lay_out(world, work);
        work.sheet.measure(&work.state.positions);
        let mut wanted = work.state.positions.clone();
        let targets = &world.resource::<BubbleGas>().targets;
        // Errors are the next step's to report: here nothing has moved yet.
        let way = work.sheet.meet_volumes(&mut wanted, targets, unresolved_volume(&policy));
        if way.is_ok_and(|way| way < LONGEST_WAY * policy.edge) {
            let mut surface = films::take(world);
            // A vertex that is held up here is settled by the next step.
            let _ = advance(&mut surface, &wanted, &MotionSettings::new(policy.edge));
            work.state.positions.clone_from(&surface.positions.0);
            films::put_back(world, surface);
        }
        work.sheet.measure(&work.state.positions);
        Ok(())
    });
}

/// Gives clusters the impulse that they had before remeshing: each its own where they are the same, all together where free clusters joined or
/// parted and nothing holds any. A film that burst took its own along.
pub fn restore_impulses(world: &mut World) {
    let has_burst = world.resource::<StepEvents>().0.iter().any(|event| event.kind == EventKind::Burst);
    with_work(world, Stage::Topology, |world, work, _| {
        if !work.was_mended || has_burst {
            return Ok(());
        }
        let SheetWork { sheet, state, heads, kept_impulses, report, .. } = work;
        let Some(Kept { impulses, touching }) = kept(sheet, kept_impulses) else { return Ok(()) };
        let correction = sheet.keep_impulse(&state.positions, &impulses, &touching, &mut state.potentials);
        report.impulse_correction = report.impulse_correction.max(correction);
        *world.resource_mut::<Potentials>() = Potentials::scattered(&sheet.layout, &state.potentials, heads);
        Ok(())
    });
}

/// Impulses per density that clusters shall have, m^4/s, and the vertices of those that have theirs together.
struct Kept {
    impulses: Vec<DVec3>,
    touching: Vec<bool>,
}

fn kept(sheet: &Sheet, before: &[(Region, DVec3)]) -> Option<Kept> {
    let names = sheet.clusters.names(&sheet.layout);
    let is_alone = names.len() == 1 && before.len() == 1;
    let of = |name: &Region| before.iter().find(|(kept, _)| is_alone || kept == name).map(|(_, impulse)| *impulse);
    if names.len() == before.len()
        && let Some(impulses) = names.iter().map(of).collect()
    {
        return Some(Kept { impulses, touching: Vec::new() });
    }
    if names.is_empty() || sheet.wires.held().contains(&true) {
        return None;
    }
    let mut impulses = vec![DVec3::ZERO; names.len()];
    impulses[0] = before.iter().map(|(_, impulse)| *impulse).sum();
    Some(Kept { impulses, touching: vec![true; sheet.layout.vertex_rows()] })
}
