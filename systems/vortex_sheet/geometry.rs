//! Shape of the films at the present evaluation, as the sheet and as columns.

use bevy_ecs::world::World;
use froth_sheet::Potentials;

use super::work::{SheetWork, with_work};
use crate::stage::Stage;
use crate::tracker::films::{self, TopologyChanged};
use crate::tracker::shape;

/// Lays the sheet out on the films as they are, if the mesh changed, and gathers their positions and potentials.
pub(super) fn lay_out(world: &mut World, work: &mut SheetWork) {
    let surface = films::take(world);
    if world.resource_mut::<TopologyChanged>().taken() {
        work.sheet.rebuild(&surface);
    }
    work.state.positions.clone_from(&surface.positions.0);
    films::put_back(world, surface);
    world.resource::<Potentials>().gather(&work.sheet.layout, &mut work.state.potentials, &mut work.heads);
}

/// Begins a substep with its first evaluation, and measures the films.
pub fn measure_films(world: &mut World) {
    with_work(world, Stage::Geometry, |world, work, _| {
        if !work.is_under_way {
            lay_out(world, work);
            work.report.substeps += 1;
        }
        work.sheet.measure(&work.state.positions);
        if !work.is_under_way {
            work.impulses = work.sheet.impulses(&work.state.potentials);
        }
        shape::write(world, work.sheet.incidence(), &work.state.positions);
        Ok(())
    });
}

/// Writes the shape of the films as they are at the end of a step.
pub fn write_shape(world: &mut World) {
    with_work(world, Stage::Observe, |world, work, _| {
        lay_out(world, work);
        work.sheet.measure(&work.state.positions);
        shape::write(world, work.sheet.incidence(), &work.state.positions);
        Ok(())
    });
}
