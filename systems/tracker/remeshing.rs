//! The tracker's pass over the films of a world: columns, gas and events follow.

use bevy_ecs::resource::Resource;
use bevy_ecs::world::World;
use froth_components::column::Column;
use froth_components::film::LiquidVolume;
use froth_surface::bodies::Division;
use froth_surface::operations::Counts;
use froth_surface::smoothing::tangential_displacements;
use froth_surface::transfer::{Several, Transfer};
use froth_surface::{PerVertex, Region, Surface, Tracker};
use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::columns::VertexColumns;
use super::events;
use super::films::{self, MeshRules, TopologyChanged, TrackerState};
use super::followers::Followers;

/// Part of an edge length that a vertex may slide along its film per step.
const LONGEST_SLIDE: f64 = 0.1;

/// The next stable id of a mesh vertex. State of a run.
#[derive(Resource, Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct NextVertexId(pub u64);

/// Operations of the present step. Not part of the state of a run.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub struct StepCounts(pub Counts);

/// What the tracker did to the bubbles in the present step, in the order in which it did it: the method's gas follows.
#[derive(Resource, Clone, Debug, Default)]
pub struct GasChanges(pub Vec<GasChange>);

/// One change of the bubbles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum GasChange {
    /// A region was joined to another: `(gone, into)`.
    Joined(Region, Region),
    /// A body of gas took a label of its own.
    Divided(Division),
}

/// Liquid that went with films that vanished as a whole, m^3. State of a run.
#[derive(Resource, Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct LiquidLost(pub f64);

/// Joins what is near, keeps edges even, pulls apart what meets without a film.
pub fn remesh(world: &mut World) {
    let rules = *world.resource::<MeshRules>();
    if rules.remesh {
        change(world, |tracker, surface, columns| {
            let done = tracker.remesh(surface, &rules.policy, columns);
            Changes { counts: done.counts, events: done.events, divisions: done.divisions, joined: done.joined }
        });
    }
}

/// How far every vertex slides along its film in this step, metres; none where the scene wants no smoothing. The mesh moves with the
/// films; what the vertices carry is theirs at the new places already.
#[derive(Resource, Clone, Debug, Default)]
pub struct Slides(pub PerVertex<DVec3>);

/// Chooses how vertices slide towards the middle of their faces, and looks up there what they carry.
pub fn slide_mesh(world: &mut World) {
    let rules = *world.resource::<MeshRules>();
    let surface = films::take(world);
    let slides = tangential_displacements(&surface, rules.smoothing, LONGEST_SLIDE * rules.policy.edge);
    let mut columns = VertexColumns::take(world, surface.positions.len());
    columns.slide(&surface, &slides);
    columns.put_back(world, &surface, &mut 0);
    for mut follower in Followers::take(world) {
        follower.slide(&surface, &slides);
        follower.put_back(world);
    }
    films::put_back(world, surface);
    world.insert_resource(Slides(slides));
}

/// What a change of the mesh did.
pub(super) struct Changes {
    pub(super) counts: Counts,
    pub(super) events: Vec<froth_surface::Event>,
    pub(super) divisions: Vec<Division>,
    pub(super) joined: Vec<(Region, Region)>,
}

/// Lets the tracker change the films of a world; everything that depends on rows follows.
pub(super) fn change(world: &mut World, operate: impl FnOnce(&mut Tracker, &mut Surface, &mut Several<'_>) -> Changes) {
    let mut surface = films::take(world);
    let mut columns = VertexColumns::take(world, surface.positions.len());
    let mut tracker = std::mem::take(&mut world.resource_mut::<TrackerState>().0);
    let mut followers = Followers::take(world);
    let mut data = Several(vec![&mut columns]);
    data.0.extend(followers.iter_mut().map(|follower| follower.as_mut() as &mut dyn Transfer));
    let changes = operate(&mut tracker, &mut surface, &mut data);
    followers.into_iter().for_each(|follower| follower.put_back(world));
    world.resource_mut::<TrackerState>().0 = tracker;
    let has_operated = changes.counts != (Counts { blocked: changes.counts.blocked, ..Counts::default() });
    if has_operated || !changes.joined.is_empty() {
        world.resource_mut::<TopologyChanged>().0 = true;
        let lost: f64 = columns.lost().filter(|(name, _)| *name == LiquidVolume::NAME).map(|(_, lost)| lost).sum();
        world.resource_mut::<LiquidLost>().0 += lost;
        let mut next = *world.resource::<NextVertexId>();
        columns.put_back(world, &surface, &mut next.0);
        *world.resource_mut::<NextVertexId>() = next;
    }
    films::put_back(world, surface);
    world.resource_mut::<StepCounts>().0 += changes.counts;
    let mut gas = world.resource_mut::<GasChanges>();
    gas.0.extend(changes.joined.into_iter().map(|(gone, into)| GasChange::Joined(gone, into)));
    gas.0.extend(changes.divisions.into_iter().map(GasChange::Divided));
    events::note(world, &changes.events);
}
