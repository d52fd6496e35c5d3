//! Films that burst when their time comes.

use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Query, Res, ResMut};
use bevy_ecs::world::World;
use froth_components::authored::PlaceInScene;
use froth_components::authored::burst::{Burst, BurstOrder};
use froth_components::clock::{Clock, Seed};
use froth_surface::operations::BurstRefused;
use froth_surface::{Region, Surface};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::films::MeshRules;
use super::remeshing::{Changes, change};
use crate::clock::end_of_step;
use crate::observe::{Fault, Faults};
use crate::sampling::random::{self, Use};
use crate::stage::Stage;

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

/// A bubble that is to burst and that the films do not enclose.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("region {} is to burst; the bubbles are {}", number, listed(bubbles))]
pub struct UnknownBubble {
    /// The entity with the [`Burst`].
    pub place: PlaceInScene,
    /// Number of the region.
    pub number: u32,
    /// The bubbles that there are.
    pub bubbles: Vec<Region>,
}

/// Checks that the films enclose every bubble that is to burst by its number.
///
/// # Errors
/// The first one that is not there.
pub fn check_bursts(world: &mut World, surface: &Surface) -> Result<(), UnknownBubble> {
    let bubbles = bubbles_of(surface);
    for (place, burst) in in_order(world) {
        let BurstOrder::Sequence(numbers) = &burst.order else { continue };
        if let Some(number) = numbers.get().iter().copied().find(|number| !bubbles.contains(&Region(*number))) {
            return Err(UnknownBubble { place, number, bubbles });
        }
    }
    Ok(())
}

/// Bursts whatever is due by the end of the step. A bubble that cannot burst is a fault; where none is left, or the one whose turn it is
/// has gone, nothing happens.
pub fn burst_films(world: &mut World) {
    let end = end_of_step(world.resource::<Clock>());
    let bursts = in_order(world);
    let mut done = world.resource::<BurstsDone>().0.clone();
    done.resize(bursts.len(), 0);
    for ((place, burst), done) in bursts.iter().zip(&mut done) {
        let seed = seed_of(burst, world.resource::<Seed>().0);
        while *done < burst.due_by(end) {
            let draw = random::bits(seed, u64::from(place.0), *done, Use::Burst);
            if let Err(refused) = burst_next(world, &burst.order, *done, draw) {
                world.resource_mut::<Faults>().report(Fault::new(Stage::Topology, "Burst", refused.to_string()));
                return;
            }
            *done += 1;
        }
    }
    world.resource_mut::<BurstsDone>().0 = done;
}

/// The bursts in the order of the scene.
fn in_order(world: &mut World) -> Vec<(PlaceInScene, Burst)> {
    let mut query = world.query::<(&PlaceInScene, &Burst)>();
    let mut bursts: Vec<(PlaceInScene, Burst)> =
        query.iter(world).map(|(place, burst)| (*place, burst.clone())).collect();
    bursts.sort_by_key(|(place, _)| *place);
    bursts
}

/// Bursts the bubble whose turn it is, if there is one.
fn burst_next(world: &mut World, order: &BurstOrder, number: u64, draw: u64) -> Result<(), BurstRefused> {
    let policy = world.resource::<MeshRules>().policy;
    let mut done = Ok(None);
    change(world, |tracker, surface, columns| {
        let pair = choose(surface, order, number, draw).map(|gone| beyond(surface, gone)).transpose();
        let mut session = tracker.begin(surface, &policy, columns);
        done =
            pair.and_then(|pair| pair.map(|(gone, into)| session.burst(gone, into).map(|_| (gone, into))).transpose());
        let (counts, mut events) = (session.counts, session.events);
        let divisions = tracker.divide(surface, columns, &mut events);
        tracker.close_up(surface, columns);
        Changes { counts, events, divisions, joined: done.ok().flatten().into_iter().collect() }
    });
    done.map(|_| ())
}

fn seed_of(burst: &Burst, scene: u64) -> u64 {
    match &burst.order {
        BurstOrder::Random(order) => order.seed.unwrap_or(scene),
        _ => scene,
    }
}

/// Closed regions, in ascending order.
fn bubbles_of(surface: &Surface) -> Vec<Region> {
    surface.mesh.regions().into_iter().filter(|region| !surface.is_open(*region)).collect()
}

/// The bubble that bursts.
fn choose(surface: &Surface, order: &BurstOrder, done: u64, draw: u64) -> Option<Region> {
    let (bubbles, volumes) = (bubbles_of(surface), surface.volumes());
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
    gone.copied()
}

/// A bubble and the region that it joins: the outside if it shares a film with it, else whatever is beyond its largest.
fn beyond(surface: &Surface, gone: Region) -> Result<(Region, Region), BurstRefused> {
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
    let into = outside.or_else(largest).map(|(into, _)| (gone, *into));
    into.ok_or(BurstRefused::NoFilm(gone, Region::OUTSIDE))
}

/// Regions by their numbers, as a sentence has them.
fn listed(regions: &[Region]) -> String {
    match regions {
        [] => "none".to_owned(),
        [one] => one.0.to_string(),
        [first, .., last] if (last.0 - first.0) as usize + 1 == regions.len() => format!("{} to {}", first.0, last.0),
        _ => regions.iter().map(|region| region.0.to_string()).collect::<Vec<_>>().join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bubbles_are_listed_in_short() {
        let said = |numbers: &[u32]| listed(&numbers.iter().copied().map(Region).collect::<Vec<_>>());
        assert_eq!([said(&[]), said(&[2]), said(&[1, 2, 3]), said(&[1, 3])], ["none", "2", "1 to 3", "1, 3"]);
    }
}
