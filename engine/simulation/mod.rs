//! A scene under a method, ready to step: the library's entrance.
//!
//! ```no_run
//! use bevy_ecs::prelude::*;
//! use froth::Simulation;
//! use froth_components::{kind::EulerianParticle, film::Thickness, motion::ExternalAcceleration};
//! use glam::DVec3;
//!
//! fn updraught(mut films: Query<&mut ExternalAcceleration>) {
//!     films.iter_mut().for_each(|mut acceleration| acceleration.0 += DVec3::Y);
//! }
//!
//! let mut simulation = Simulation::from_scene("scenes/giant_bubble.ron")?;
//! simulation.add_force("blow upwards", updraught);
//! simulation.advance_to(0.5)?;
//! let thinnest = simulation.column::<EulerianParticle, Thickness>().iter().map(|t| t.0).fold(f64::INFINITY, f64::min);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod builder;
mod error;
mod frames;

use std::path::Path;

use bevy_ecs::system::IntoSystem;
use bevy_ecs::world::World;
use froth_components::clock::Clock;
use froth_components::column::Column;
use froth_components::kind::Kind;
use froth_systems::clock::{StepLimits, end_of_step};
use froth_systems::observe::{Faults, Observables};
use froth_systems::plan::{ExplainedSystem, Requires, SchedulePlan, StageTimes};
use froth_systems::rows::registry::ColumnRegistry;
use froth_systems::rows::{fill_column, read_column};
use froth_systems::stage::Stage;
use xxhash_rust::xxh3::Xxh3;

pub use builder::{Overrides, SimulationBuilder};
pub use error::{BuildError, StepError};
pub use frames::Frames;

use crate::method::Method;
use crate::scene::Scene;

/// Part of a time by which a target may be missed: less than any step, more than rounding.
const ROUNDING: f64 = 1e-12;

/// What the run itself measures.
const STEP_LENGTH: &str = "step_length";

/// A scene under a method, ready to step.
pub struct Simulation {
    world: World,
    plan: SchedulePlan,
    method: Method,
    scene: Scene,
    overrides: Overrides,
    scene_hash: u64,
    frames: Frames,
    failure: Option<StepError>,
    /// Whether the tables were checked since the world was last open to changes.
    is_checked: bool,
}

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// Steps finished, this one included.
    pub step: u64,
    /// Time at its end, s.
    pub time: f64,
    /// Its length, s.
    pub step_length: f64,
    /// What asked for the shortest step; none if the next frame alone does.
    pub limited_by: Option<&'static str>,
    /// The frame that the step ends on, if any.
    pub frame: Option<u64>,
}

impl Simulation {
    /// Reads a scene file and makes its particles.
    ///
    /// # Errors
    /// When the file is no scene, or the scene cannot be simulated.
    pub fn from_scene(path: impl AsRef<Path>) -> Result<Self, BuildError> {
        Self::builder().build(path)
    }

    /// Reads a scene from text and makes its particles.
    ///
    /// # Errors
    /// When the text is no scene, or the scene cannot be simulated.
    pub fn from_scene_text(text: &str) -> Result<Self, BuildError> {
        Self::builder().build_from_text("scene.ron", text)
    }

    /// Overrides, components and columns come before the scene: `Simulation::builder().seed(3).build("scene.ron")`.
    #[must_use]
    pub fn builder() -> SimulationBuilder {
        SimulationBuilder::default()
    }

    /// Adds a system that writes [`ExternalAcceleration`](froth_components::motion::ExternalAcceleration) or
    /// [`ExternalPressure`](froth_components::motion::ExternalPressure). It runs after the forces that are there already, which
    /// fixes the order of summation. A resumed run needs the same forces, added in the same order.
    pub fn add_force<M, S>(&mut self, name: &'static str, system: S) -> &mut Self
    where
        S: IntoSystem<(), (), M> + Send + Sync + 'static,
    {
        self.add_system(Stage::Forces, name, system, Requires::nothing())
    }

    /// Adds a system to a stage, after those that are there already.
    pub fn add_system<M, S>(&mut self, stage: Stage, name: &'static str, system: S, requires: Requires) -> &mut Self
    where
        S: IntoSystem<(), (), M> + Send + Sync + 'static,
    {
        self.plan.add(stage, name, system, requires);
        self
    }

    /// One step. It never passes the next frame, and ends on it exactly.
    ///
    /// # Errors
    /// When a system reports a fault. The world is then as the fault left it, and every further step gives the same error.
    pub fn step(&mut self) -> Result<StepReport, StepError> {
        self.step_within(f64::INFINITY)
    }

    /// Steps until `time`, s. The last step ends there exactly, as steps do on every frame on the way.
    ///
    /// # Errors
    /// See [`Simulation::step`].
    pub fn advance_to(&mut self, time: f64) -> Result<(), StepError> {
        while !self.has_reached(time) {
            self.step_within(time)?;
        }
        Ok(())
    }

    /// Steps until the scene's duration.
    ///
    /// # Errors
    /// See [`Simulation::step`].
    pub fn run(&mut self) -> Result<(), StepError> {
        self.advance_to(self.scene.header.duration.si())
    }

    /// Whether `time` is reached, but for rounding.
    #[must_use]
    pub fn has_reached(&self, time: f64) -> bool {
        time - self.time() <= ROUNDING * time.abs()
    }

    /// One step that passes neither the next frame nor `limit`, s.
    ///
    /// # Errors
    /// See [`Simulation::step`].
    pub fn step_within(&mut self, limit: f64) -> Result<StepReport, StepError> {
        if let Some(failure) = &self.failure {
            return Err(failure.clone());
        }
        let report = self.try_step(limit);
        self.failure = report.as_ref().err().cloned();
        report
    }

    fn try_step(&mut self, limit: f64) -> Result<StepReport, StepError> {
        if !self.is_checked {
            ColumnRegistry::check_tables(&mut self.world)?;
            self.is_checked = true;
        }
        self.begin_step(limit);
        let Self { plan, world, .. } = self;
        // Inside the pool: a loop begun outside it would put this thread to sleep and wake another.
        rayon::scope(|_| plan.run(world));
        self.world.clear_trackers();
        let faults = self.world.resource::<Faults>().all();
        if !faults.is_empty() {
            let (clock, faults) = (self.clock(), faults.to_vec());
            let Clock { time, step_length, steps, .. } = *clock;
            return Err(StepError::Fault { faults, step: steps + 1, time, step_length });
        }
        Ok(self.end_step())
    }

    fn begin_step(&mut self, limit: f64) {
        let next_frame = self.frames.time(self.frames.next_after(self.time()));
        let mut clock = self.world.resource_mut::<Clock>();
        clock.horizon = if limit < next_frame * (1.0 - ROUNDING) { limit } else { next_frame };
        self.world.resource_mut::<Observables>().begin_step();
        let longest = self.scene.header.maximum_step.map_or(f64::INFINITY, |longest| longest.si());
        let mut limits = self.world.resource_mut::<StepLimits>();
        limits.begin_step();
        limits.propose("maximum_step", longest);
    }

    fn end_step(&mut self) -> StepReport {
        let mut clock = self.world.resource_mut::<Clock>();
        clock.time = end_of_step(&clock);
        clock.steps += 1;
        let Clock { time, step_length, steps, .. } = *clock;
        self.world.resource_mut::<Observables>().record(STEP_LENGTH, "s", step_length);
        let tightest = self.world.resource::<StepLimits>().tightest();
        let limited_by = tightest.filter(|(_, limit)| limit.is_finite()).map(|(name, _)| name);
        StepReport { step: steps, time, step_length, limited_by, frame: self.frames.at(time) }
    }

    /// Time, steps and the last step's length.
    #[must_use]
    pub fn clock(&self) -> &Clock {
        self.world.resource::<Clock>()
    }

    /// Simulated time, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.clock().time
    }

    /// A column of a kind, row after row; empty if there are no such particles.
    #[must_use]
    pub fn column<K: Kind, C: Column>(&mut self) -> Vec<C> {
        read_column::<K, C>(&mut self.world)
    }

    /// Overwrites a column of a kind, one value per row.
    ///
    /// # Panics
    /// When there are not as many values as rows.
    pub fn set_column<K: Kind, C: Column>(&mut self, values: &[C]) {
        fill_column::<K, C>(&mut self.world, values);
    }

    /// What the last step measured.
    #[must_use]
    pub fn observables(&self) -> &Observables {
        self.world.resource::<Observables>()
    }

    /// Wall time per stage.
    #[must_use]
    pub fn stage_times(&self) -> &StageTimes {
        self.world.resource::<StageTimes>()
    }

    /// Every system in running order: whether it runs in the world as it is, and why.
    #[must_use]
    pub fn explain(&self) -> Vec<ExplainedSystem> {
        self.plan.explain(&self.world)
    }

    /// Rows of every kind.
    pub fn rows(&mut self) -> Vec<(&'static str, usize)> {
        let kinds = self.world.resource::<ColumnRegistry>().kinds().to_vec();
        kinds.iter().map(|kind| (kind.name, kind.count(&mut self.world))).collect()
    }

    /// The world. Nothing in it is hidden.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The world, open to changes. What a checkpoint must hold has to be a registered column or registered state.
    pub fn world_mut(&mut self) -> &mut World {
        self.is_checked = false;
        &mut self.world
    }

    /// The scene, with the overrides in its header.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The method that runs.
    #[must_use]
    pub fn method(&self) -> &Method {
        &self.method
    }

    /// What replaces values of the scene file.
    #[must_use]
    pub fn overrides(&self) -> &Overrides {
        &self.overrides
    }

    /// The moments at which pictures are made.
    #[must_use]
    pub fn frames(&self) -> Frames {
        self.frames
    }

    /// Hash of the scene's text and the overrides: checkpoints of another one are refused.
    #[must_use]
    pub fn scene_hash(&self) -> u64 {
        self.scene_hash
    }
}

fn scene_hash(scene: &Scene, overrides: &Overrides) -> u64 {
    let mut hash = Xxh3::new();
    hash.update(scene.source().text().as_bytes());
    scene.mesh_files().for_each(|mesh| hash.update(mesh.bytes()));
    hash.update(format!("{overrides:?}").as_bytes());
    hash.digest()
}
