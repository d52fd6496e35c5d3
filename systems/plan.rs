//! The plan of a step: which systems run in which stage, in which order, and what each requires.
//!
//! A method is a list of [`SchedulePlan::add`] calls. Inside a stage, systems run in the order in which they are added:
//! nothing is ambiguous, and the order of floating-point sums is fixed. Run conditions of the ECS are opaque; a [`Requires`]
//! carries its reason in words, so that [`SchedulePlan::explain`] can say why a system runs or rests. [`StageTimes`] says where the time goes.
//!
//! ```
//! use froth_components::kind::LagrangianParticle;
//! use froth_systems::{plan::{Requires, SchedulePlan}, stage::Stage};
//! # use bevy_ecs::world::World;
//! fn gather_liquid() {}
//! fn fit_frames() {}
//!
//! let mut plan = SchedulePlan::new();
//! plan.add(Stage::Geometry, "fit frames", fit_frames, Requires::nothing());
//! plan.add(Stage::Gather, "gather liquid (L2E)", gather_liquid, Requires::kind::<LagrangianParticle>());
//! let explained = plan.explain(&World::new());
//! assert_eq!(explained[0].name, "gather liquid (L2E)"); // in the order of the stages
//! assert_eq!(explained[0].unmet, ["lagrangian particles"]);
//! ```

mod stage_times;

use std::borrow::Cow;
use std::sync::Arc;

use bevy_ecs::component::Component;
use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::{IntoScheduleConfigs, Schedule, SystemSet};
use bevy_ecs::system::IntoSystem;
use bevy_ecs::world::World;
use froth_components::clock::Clock;
use froth_components::kind::Kind;

pub use stage_times::StageTimes;

use crate::observe::Faults;
use crate::stage::{Part, Stage, staged_schedule};

/// A system's wish to see the present substep once more: integrators that evaluate several trial states set it.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AnotherPass(pub bool);

impl AnotherPass {
    /// Whether the wish was there; it is gone then. After a fault there is no other pass.
    fn taken(world: &mut World) -> bool {
        let wished = world.get_resource_mut::<Self>().is_some_and(|mut pass| std::mem::take(&mut pass.0));
        wished && Faults::none(world)
    }
}

/// Place of one system in its stage, counted over the whole plan.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Slot(Stage, usize);

/// The schedules of a step together with the reasons of their systems.
pub struct SchedulePlan {
    /// One per [`Part::ALL`].
    schedules: [Schedule; Part::ALL.len()],
    systems: Vec<PlannedSystem>,
}

struct PlannedSystem {
    stage: Stage,
    name: Cow<'static, str>,
    requires: Requires,
}

/// Whether a system runs in a world, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExplainedSystem {
    /// The stage it is in.
    pub stage: Stage,
    /// What it does, as the method calls it.
    pub name: String,
    /// Requirements that hold, in words that complete "has ...".
    pub met: Vec<&'static str>,
    /// Requirements that do not hold; the system runs if there are none.
    pub unmet: Vec<&'static str>,
}

impl ExplainedSystem {
    /// Whether the system runs.
    #[must_use]
    pub fn runs(&self) -> bool {
        self.unmet.is_empty()
    }
}

impl SchedulePlan {
    /// A plan without systems.
    #[must_use]
    pub fn new() -> Self {
        Self { schedules: Part::ALL.map(staged_schedule), systems: Vec::new() }
    }

    /// Adds a system to a stage, after those that the stage has already. `name` says what it does in physics words.
    ///
    /// The system runs in a step where `requires` holds and no system before it has reported a [fault](Faults).
    pub fn add<M, S>(
        &mut self,
        stage: Stage,
        name: impl Into<Cow<'static, str>>,
        system: S,
        requires: Requires,
    ) -> &mut Self
    where
        S: IntoSystem<(), (), M> + Send + Sync + 'static,
    {
        let before = self.systems.iter().rposition(|planned| planned.stage == stage);
        let slot = Slot(stage, self.systems.len());
        let condition = requires.clone();
        let configured = IntoSystem::into_system(system)
            .in_set(stage)
            .in_set(slot)
            .run_if(move |world: &World| Faults::none(world) && condition.hold(world));
        self.schedules[stage.part() as usize].add_systems(match before {
            Some(before) => configured.after(Slot(stage, before)),
            None => configured,
        });
        self.systems.push(PlannedSystem { stage, name: name.into(), requires });
        self
    }

    /// Every system in running order: whether it runs in `world` as it is, and why.
    #[must_use]
    pub fn explain(&self, world: &World) -> Vec<ExplainedSystem> {
        let of_stage = |stage| self.systems.iter().filter(move |planned| planned.stage == stage);
        Stage::ALL.into_iter().flat_map(of_stage).map(|planned| planned.explain(world)).collect()
    }

    /// The schedules, to add what belongs to no stage.
    pub fn schedules_mut(&mut self) -> impl Iterator<Item = (Part, &mut Schedule)> {
        Part::ALL.into_iter().zip(&mut self.schedules)
    }

    /// Runs one step: the first part, as many substeps as the [`Clock`] says, each once and [again](AnotherPass) as often as its systems
    /// wish, the last part. A substep may end the step early ([`Clock::end_after`]).
    pub fn run(&mut self, world: &mut World) {
        let [begin, substep, end] = &mut self.schedules;
        begin.run(world);
        let mut done = 0;
        while done < world.get_resource::<Clock>().map_or(1, |clock| clock.substeps.max(1)) {
            substep.run(world);
            while AnotherPass::taken(world) {
                substep.run(world);
            }
            done += 1;
        }
        end.run(world);
    }
}

impl Default for SchedulePlan {
    fn default() -> Self {
        Self::new()
    }
}

impl PlannedSystem {
    fn explain(&self, world: &World) -> ExplainedSystem {
        let words = |holds: bool| {
            let those = self.requires.0.iter().filter(move |requirement| (requirement.holds)(world) == holds);
            those.map(|requirement| requirement.what).collect()
        };
        ExplainedSystem { stage: self.stage, name: self.name.to_string(), met: words(true), unmet: words(false) }
    }
}

/// What a system needs of the world in order to run: any number of requirements, all of which must hold.
#[derive(Clone, Default)]
pub struct Requires(Vec<Requirement>);

#[derive(Clone)]
struct Requirement {
    what: &'static str,
    holds: Arc<dyn Fn(&World) -> bool + Send + Sync>,
}

impl Requires {
    /// The system runs in every step.
    #[must_use]
    pub fn nothing() -> Self {
        Self::default()
    }

    /// There is at least one entity of the kind.
    #[must_use]
    pub fn kind<K: Kind>() -> Self {
        Self::that(K::PLURAL, has_component::<K>)
    }

    /// There is at least one entity with the component; `what` names it, such as "a wind".
    #[must_use]
    pub fn component<C: Component>(what: &'static str) -> Self {
        Self::that(what, has_component::<C>)
    }

    /// There is such a resource; `what` names it.
    #[must_use]
    pub fn resource<R: Resource>(what: &'static str) -> Self {
        Self::that(what, World::contains_resource::<R>)
    }

    /// A condition on the world. `what` completes the sentence "it needs ...", such as "surfactant elasticity above 0".
    #[must_use]
    pub fn that(what: &'static str, holds: impl Fn(&World) -> bool + Send + Sync + 'static) -> Self {
        Self(vec![Requirement { what, holds: Arc::new(holds) }])
    }

    /// Both these requirements and the others.
    #[must_use]
    pub fn and(mut self, others: Self) -> Self {
        self.0.extend(others.0);
        self
    }

    fn hold(&self, world: &World) -> bool {
        self.0.iter().all(|requirement| (requirement.holds)(world))
    }
}

/// Whether any entity has the component.
fn has_component<C: Component>(world: &World) -> bool {
    let Some(id) = world.component_id::<C>() else { return false };
    world.archetypes().iter().any(|archetype| !archetype.is_empty() && archetype.contains(id))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy_ecs::system::ResMut;
    use froth_components::kind::{EulerianParticle, LagrangianParticle};

    #[derive(Resource, Default)]
    struct Log(Vec<&'static str>);

    fn write(word: &'static str) -> impl FnMut(ResMut<Log>) + Send + Sync {
        move |mut log: ResMut<Log>| log.0.push(word)
    }

    fn ran(plan: &mut SchedulePlan, world: &mut World) -> Vec<&'static str> {
        world.insert_resource(Log::default());
        plan.run(world);
        world.resource::<Log>().0.clone()
    }

    #[test]
    fn systems_run_in_the_order_of_stages_and_then_of_adding() {
        let mut plan = SchedulePlan::new();
        plan.add(Stage::Observe, "f", write("f"), Requires::nothing());
        plan.add(Stage::Forces, "b", write("b"), Requires::nothing());
        plan.add(Stage::Clock, "a", write("a"), Requires::nothing());
        plan.add(Stage::Forces, "c", |mut log: ResMut<Log>| log.0.push("c"), Requires::nothing());
        plan.add(Stage::Forces, "d", |world: &mut World| world.resource_mut::<Log>().0.push("d"), Requires::nothing());
        let mut world = World::new();
        assert_eq!(ran(&mut plan, &mut world), ["a", "b", "c", "d", "f"]);
        plan.add(Stage::Forces, "e", write("e"), Requires::nothing());
        assert_eq!(ran(&mut plan, &mut world), ["a", "b", "c", "d", "e", "f"]);
    }

    #[test]
    fn a_system_rests_where_the_scene_does_not_require_it() {
        let mut plan = SchedulePlan::new();
        let elastic = Requires::that("elasticity above 0", |_| true);
        plan.add(Stage::Gather, "gather", write("gather"), Requires::kind::<LagrangianParticle>().and(elastic));
        let mut world = World::new();
        world.spawn(EulerianParticle);
        assert!(ran(&mut plan, &mut world).is_empty());
        let explained = plan.explain(&world);
        assert_eq!(explained[0].unmet, ["lagrangian particles"]);
        assert_eq!(explained[0].met, ["elasticity above 0"]);
        let particle = world.spawn(LagrangianParticle).id();
        assert_eq!(ran(&mut plan, &mut world), ["gather"]);
        world.despawn(particle);
        assert!(ran(&mut plan, &mut world).is_empty());
    }

    #[test]
    fn substeps_repeat_the_stages_between_gathering_and_scattering() {
        let mut plan = SchedulePlan::new();
        plan.add(Stage::Clock, "c", |mut clock: ResMut<Clock>| clock.substeps = 2, Requires::nothing());
        for (stage, word) in [(Stage::Gather, "g"), (Stage::Forces, "f"), (Stage::Deform, "d"), (Stage::Scatter, "s")] {
            plan.add(stage, word, write(word), Requires::nothing());
        }
        let mut world = World::new();
        world.init_resource::<Clock>();
        assert_eq!(ran(&mut plan, &mut world), ["g", "f", "d", "f", "d", "s"]);
    }

    #[test]
    fn a_substep_is_repeated_as_often_as_a_system_wishes() {
        let mut plan = SchedulePlan::new();
        plan.add(Stage::Clock, "c", |mut clock: ResMut<Clock>| clock.substeps = 2, Requires::nothing());
        let evaluate = |mut log: ResMut<Log>, mut pass: ResMut<AnotherPass>| {
            log.0.push("v");
            pass.0 = !log.0.len().is_multiple_of(3);
        };
        plan.add(Stage::Velocity, "v", evaluate, Requires::nothing());
        let mut world = World::new();
        world.init_resource::<Clock>();
        world.init_resource::<AnotherPass>();
        assert_eq!(ran(&mut plan, &mut world), ["v"; 6]);
    }

    #[test]
    fn nothing_runs_after_a_fault() {
        let mut plan = SchedulePlan::new();
        let break_down = |mut faults: ResMut<Faults>| {
            faults.report(crate::observe::Fault::new(Stage::Forces, "the test", "breaks down"));
        };
        plan.add(Stage::Forces, "break", break_down, Requires::nothing());
        plan.add(Stage::Forces, "go on", write("went on"), Requires::nothing());
        plan.add(Stage::Advance, "move", write("moved"), Requires::nothing());
        let mut world = World::new();
        world.init_resource::<Faults>();
        assert!(ran(&mut plan, &mut world).is_empty());
    }
}
