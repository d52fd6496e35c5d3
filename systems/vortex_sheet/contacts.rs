//! Films in contact: what they cannot do, the air does not do either, and no contact makes the air faster than it was.
//!
//! The mathematics is [`froth_sheet::inelastic`].

use bevy_ecs::world::World;
use froth_sheet::Potentials;
use froth_surface::VertexRow;

use super::settings::SheetRules;
use super::work::{SheetWork, on_arrival, with_work};
use crate::stage::Stage;
use crate::tracker::events::StepEvents;
use crate::tracker::remeshing::StepCounts;

/// Brings films to rest where others are in their way: else the air would go on driving them, and gain energy without end.
pub fn rest_contacts(world: &mut World) {
    on_arrival(world, |world, work, _| {
        let SheetWork { sheet, state, heads, touching, report, .. } = work;
        if !touching.contains(&true) {
            return Ok(());
        }
        let density = world.resource::<SheetRules>().density;
        report.contact_loss += sheet.calm(&state.positions, touching, density, 0.0, &mut state.potentials)?;
        // Convection was worked out for films that move.
        for (side, head) in heads.iter_mut().enumerate() {
            if touching[sheet.layout.vertex_of(side as u32) as usize] {
                *head = 0.0;
            }
        }
        Ok(())
    });
}

/// Works out the air's energy where the tracker joined or parted films: as it was before, since the sheet does not know of it yet.
pub fn recall_energy(world: &mut World) {
    let (counts, has_events) = (world.resource::<StepCounts>().0, !world.resource::<StepEvents>().0.is_empty());
    with_work(world, Stage::Topology, |world, work, _| {
        let density = world.resource::<SheetRules>().density;
        let SheetWork { sheet, state, energy_before, .. } = work;
        let have_met = counts.snaps + counts.separations > 0 || has_events;
        *energy_before =
            have_met.then(|| sheet.kinetic_energy(&state.positions, &state.potentials, density)).transpose()?;
        Ok(())
    });
}

/// Slows films down around the places where they met or parted until the air has no more energy than before.
pub fn calm_contacts(world: &mut World) {
    with_work(world, Stage::Topology, |world, work, _| {
        let SheetWork { sheet, state, heads, energy_before, report, .. } = work;
        let Some(most) = energy_before.take() else { return Ok(()) };
        let density = world.resource::<SheetRules>().density;
        let mut potentials = world.resource_mut::<Potentials>();
        let rows = 0..sheet.layout.vertex_rows() as u32;
        let met: Vec<bool> = rows.map(|v| potentials.has_met(VertexRow(v))).collect();
        report.contact_loss += sheet.calm(&state.positions, &met, density, most, &mut state.potentials)?;
        *potentials = Potentials::scattered(&sheet.layout, &state.potentials, heads);
        Ok(())
    });
}
