//! Films that burst when their time comes.

use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Query, Res, ResMut};
use bevy_ecs::world::World;
use froth_components::authored::PlaceInScene;
use froth_components::authored::burst::{Burst, BurstOrder};
use froth_components::clock::{Clock, Seed};
use froth_surface::{Region, Surface};
use serde::{Deserialize, Serialize};

use super::films::MeshRules;
use super::remeshing::{Changes, change};
use crate::clock::end_of_step;
use crate::sampling::random::{self, Use};

/// Bursts that every [`Burst`] has done, in the order of the scene. State of a run.
#[derive(Resource, Clone, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct BurstsDone(pub Vec<u64>);

/// Lets no step pass the next burst. One at the horizon but for rounding is no other moment, which would take a step of its own.
pub fn stop_at_bursts(bursts: Query<(&PlaceInScene, &Burst)>, done: Res<BurstsDone>, mut clock: ResMut<Clock>) {
    let mut bursts: Vec<(&PlaceInScene, &Burst)> = bursts.iter().collect();
    bursts.sort_by_key(|(place, _)| **place);
    for (number, (_, burst)) in bursts.into_iter().enumerate() {
        let next = burst.time_of(done.0.get(number).copied().unwrap_or(0));
        let before = clock.horizon - Burst::ROUNDING * burst.every.si();
        if next > clock.time && next < before {
            clock.horizon = next;
        }
    }
}

/// Bursts whatever is due by the end of the step.
pub fn burst_films(world: &mut World) {
    let clock = *world.resource::<Clock>();
    let end = end_of_step(&clock);
    let rules = *world.resource::<MeshRules>();
    let mut query = world.query::<(&PlaceInScene, &Burst)>();
    let mut bursts: Vec<(PlaceInScene, Burst)> =
        query.iter(world).map(|(place, burst)| (*place, burst.clone())).collect();
    bursts.sort_by_key(|(place, _)| *place);
    let mut done = world.resource::<BurstsDone>().0.clone();
    done.resize(bursts.len(), 0);
    for ((place, burst), done) in bursts.iter().zip(&mut done) {
        let seed = world.resource::<Seed>().0;
        while *done < burst.due_by(end) {
            let draw = random::bits(seed_of(burst, seed), u64::from(place.0), *done, Use::Burst);
            let number = *done;
            change(world, |tracker, surface, columns| {
                let pair = choose(surface, &burst.order, number, draw);
                let mut session = tracker.begin(surface, &rules.policy, columns);
                let joined = pair.filter(|(gone, into)| session.burst(*gone, *into).is_ok());
                let (counts, mut events) = (session.counts, session.events);
                let divisions = tracker.divide(surface, columns, &mut events);
                tracker.close_up(surface, columns);
                Changes { counts, events, divisions, joined: joined.into_iter().collect() }
            });
            *done += 1;
        }
    }
    world.resource_mut::<BurstsDone>().0 = done;
}

fn seed_of(burst: &Burst, scene: u64) -> u64 {
    match &burst.order {
        BurstOrder::Random(order) => order.seed.unwrap_or(scene),
        _ => scene,
    }
}

/// The bubble that bursts and the region that it joins: the outside if it shares a film with it, else whatever is beyond its largest.
fn choose(surface: &Surface, order: &BurstOrder, done: u64, draw: u64) -> Option<(Region, Region)> {
    let volumes = surface.volumes();
    let bubbles: Vec<Region> = surface.mesh.regions().into_iter().filter(|region| !surface.is_open(*region)).collect();
    let by_volume = |a: &&Region, b: &&Region| volumes[a.index()].total_cmp(&volumes[b.index()]);
    let gone = match order {
        BurstOrder::Random(_) => bubbles.get((draw % bubbles.len().max(1) as u64) as usize),
        BurstOrder::Smallest => bubbles.iter().min_by(by_volume),
        BurstOrder::Largest => bubbles.iter().max_by(by_volume),
        BurstOrder::Sequence(numbers) => {
            let wanted = numbers.get().get(done as usize).copied();
            bubbles.iter().find(|region| Some(region.0) == wanted)
        }
    };
    let gone = *gone?;
    let mut beyond: Vec<(Region, f64)> = Vec::new();
    for (row, face) in surface.mesh.faces().filter(|(_, face)| face.borders(gone) && !face.is_ghost()) {
        let [back, front] = face.labels();
        let other = if back == gone { front } else { back };
        match beyond.iter_mut().find(|(region, _)| *region == other) {
            Some((_, area)) => *area += surface.area(row),
            None => beyond.push((other, surface.area(row))),
        }
    }
    let outside = beyond.iter().find(|(region, _)| *region == Region::OUTSIDE);
    let largest = || beyond.iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
    outside.or_else(largest).map(|(into, _)| (gone, *into))
}
