//! Changes of topology as entities: an observer system reads them, `events.csv` lists them.

use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::With;
use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::clock::Clock;
use froth_components::identity::RegionId;
use froth_surface::{Event, EventKind};
use glam::DVec3;

use crate::clock::end_of_step;

/// One change of topology, in the step that is being finished. It lives until the next step's events are noted.
#[derive(Component, Clone, Debug, PartialEq)]
pub struct TopologyEvent {
    /// What happened.
    pub kind: EventKind,
    /// Step in which it happened, from 1.
    pub step: u64,
    /// Time at the end of that step, s.
    pub time: f64,
    /// Where, metres.
    pub place: DVec3,
    /// Between which regions; see [`EventKind`] for their order.
    pub regions: Vec<RegionId>,
}

/// Events of the present step, for whoever writes tables. Not part of the state of a run.
#[derive(Resource, Clone, Debug, Default)]
pub struct StepEvents(pub Vec<TopologyEvent>);

/// Forgets the events of the step before.
pub fn forget(world: &mut World) {
    let mut old = world.query_filtered::<Entity, With<TopologyEvent>>();
    let old: Vec<Entity> = old.iter(world).collect();
    for event in old {
        world.despawn(event);
    }
    world.get_resource_or_init::<StepEvents>().0.clear();
}

/// Notes events of the present step, and spawns an entity for each.
pub fn note(world: &mut World, events: &[Event]) {
    let clock = *world.resource::<Clock>();
    let (step, time) = (clock.steps + 1, end_of_step(&clock));
    for event in events {
        let regions = event.regions.iter().map(|region| RegionId(region.0)).collect();
        let noted = TopologyEvent { kind: event.kind, step, time, place: event.place, regions };
        world.resource_mut::<StepEvents>().0.push(noted.clone());
        world.spawn(noted);
    }
}
