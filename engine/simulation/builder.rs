//! From a scene to a [`Simulation`]: overrides, plugged-in components and columns, then registration, discretisation, assembly.

use std::path::{Path, PathBuf};

use bevy_ecs::component::Component;
use bevy_ecs::world::World;
use froth_components::authored::method::{MethodChoice, MethodName};
use froth_components::clock::{Clock, Seed};
use froth_components::column::Column;
use froth_components::kind::Kind;
use froth_components::material::{Atmosphere, Liquid};
use froth_systems::clock::{StepLimits, choose_step_length};
use froth_systems::observe::{Faults, Observables, check_finite};
use froth_systems::plan::{Requires, SchedulePlan, StageTimes};
use froth_systems::rows::registry::ColumnRegistry;
use froth_systems::rows::state::StateRegistry;
use froth_systems::stage::Stage;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::error::BuildError;
use super::frames::Frames;
use super::{STEP_LENGTH, Simulation, scene_hash};
use crate::checkpoint;
use crate::method::{DiscretiseError, METHODS, Method, method};
use crate::scene::{AuthoredRegistry, MeshFault, Scene, SceneError, SceneHeader, available_memory, folder_of};

/// What replaces values of a scene file. Part of the identity of a run: another override is another run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Overrides {
    /// Name of the method on the command line, instead of the scene's.
    pub method: Option<String>,
    /// Factor on the resolution: 2 halves the spacing, which makes four times the particles.
    pub resolution: Option<f64>,
    /// Seed, instead of the scene's.
    pub seed: Option<u64>,
}

/// How a [`Simulation`] is made. See [`Simulation::builder`].
#[derive(Default)]
pub struct SimulationBuilder {
    authored: AuthoredRegistry,
    overrides: Overrides,
    method: Option<Method>,
    columns: Vec<fn(&mut World)>,
    mesh_folder: Option<PathBuf>,
}

impl SimulationBuilder {
    /// Runs another method than the scene's: a built-in one, or one of your own.
    #[must_use]
    pub fn method(mut self, method: Method) -> Self {
        self.overrides.method = Some(method.name.to_owned());
        self.method = Some(method);
        self
    }

    /// Scales the scene's resolution: 2 halves the spacing, which makes four times the particles.
    #[must_use]
    pub fn resolution(mut self, factor: f64) -> Self {
        self.overrides.resolution = Some(factor);
        self
    }

    /// Replaces the scene's seed.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.overrides.seed = Some(seed);
        self
    }

    /// Overrides as a run folder remembers them; a method of your own must be given by [`SimulationBuilder::method`].
    #[must_use]
    pub fn overrides(mut self, overrides: Overrides) -> Self {
        let named = METHODS.iter().find(|method| Some(method.name) == overrides.method.as_deref());
        self.method = self.method.or(named.copied());
        self.overrides = overrides;
        self
    }

    /// Lets the scene write `name(...)` for a component of your own. `summary`: what it does, in one line.
    #[must_use]
    pub fn component<T: Component + Clone + DeserializeOwned>(
        mut self,
        name: &'static str,
        summary: &'static str,
    ) -> Self {
        self.authored.register::<T>(name, summary);
        self
    }

    /// Gives every particle of kind `K` a column of your own, at its default. It is sorted, saved and exported like the others.
    #[must_use]
    pub fn column<K: Kind, C: Column + Default>(mut self) -> Self {
        self.columns.push(ColumnRegistry::register::<K, C>);
        self
    }

    /// Looks for the scene's mesh files in this folder, and not in the scene's own.
    #[must_use]
    pub fn mesh_folder(mut self, folder: impl Into<PathBuf>) -> Self {
        self.mesh_folder = Some(folder.into());
        self
    }

    /// Reads a scene file and makes its particles.
    ///
    /// # Errors
    /// When the file is no scene, or the scene cannot be simulated.
    pub fn build(self, path: impl AsRef<Path>) -> Result<Simulation, BuildError> {
        let path = path.as_ref();
        let folder = self.mesh_folder.as_deref().unwrap_or_else(|| folder_of(path));
        let scene = Scene::from_path_in(folder, path, &self.authored)?;
        self.begin(scene)
    }

    /// Reads a scene from text and makes its particles. `name` stands for the file in errors.
    ///
    /// # Errors
    /// When the text is no scene, or the scene cannot be simulated.
    pub fn build_from_text(self, name: &str, text: &str) -> Result<Simulation, BuildError> {
        let scene = self.read(name, text)?;
        self.begin(scene)
    }

    /// Reads a scene from text, and its particles from a checkpoint of the same scene and overrides.
    ///
    /// # Errors
    /// When the text is no scene, or the checkpoint is damaged or of another run.
    pub fn restore(self, name: &str, text: &str, checkpoint: impl AsRef<Path>) -> Result<Simulation, BuildError> {
        let scene = self.read(name, text)?;
        let mut simulation = self.prepare(scene)?;
        checkpoint::load(&mut simulation, checkpoint.as_ref())?;
        Ok(simulation)
    }

    /// Reads a scene from text and makes everything but its particles, which tells whether the rest could be made.
    pub(crate) fn build_without_particles(self, name: &str, text: &str) -> Result<Simulation, BuildError> {
        let scene = self.read(name, text)?;
        self.prepare(scene)
    }

    fn read(&self, name: &str, text: &str) -> Result<Scene, SceneError> {
        let folder = self.mesh_folder.as_deref().unwrap_or_else(|| folder_of(Path::new(name)));
        Scene::from_bytes_in(folder, name, text.as_bytes(), &self.authored)
    }

    fn begin(self, scene: Scene) -> Result<Simulation, BuildError> {
        let mut simulation = self.prepare(scene)?;
        let discretise = simulation.method.discretise;
        let world = &mut simulation.world;
        let discretised = rayon::scope(|_| discretise(world));
        discretised.map_err(|error| explain(&simulation.scene, error))?;
        Ok(simulation)
    }

    /// Everything but the rows.
    fn prepare(self, mut scene: Scene) -> Result<Simulation, BuildError> {
        let method = self.override_header(&mut scene)?;
        let checked = scene.check(available_memory());
        checked.map_err(|error| error.refined_by(self.overrides.resolution))?;
        let scene_hash = scene_hash(&scene, &self.overrides);
        let frames = Frames::per_second(scene.header.frames_per_second.si());
        let mut world = empty_world(&scene);
        (method.register)(&mut world);
        self.columns.iter().for_each(|register| register(&mut world));
        ColumnRegistry::create_tables(&mut world);
        let plan = assemble(&method, &mut world);
        let overrides = self.overrides;
        Ok(Simulation { world, plan, method, scene, overrides, scene_hash, frames, failure: None, is_checked: false })
    }

    /// Puts the overrides into the header, and says which method runs.
    fn override_header(&self, scene: &mut Scene) -> Result<Method, BuildError> {
        let header = &mut scene.header;
        if let Some(factor) = self.overrides.resolution {
            if !(factor.is_finite() && factor > 0.0) {
                return Err(BuildError::ResolutionFactor { factor });
            }
            header.resolution = header.resolution.refined(factor);
        }
        header.seed = self.overrides.seed.unwrap_or(header.seed);
        let chosen =
            MethodName::ALL.into_iter().find(|name| Some(name.on_command_line()) == self.overrides.method.as_deref());
        let name = chosen.unwrap_or(header.method.name());
        if let Some(choice) = (name != header.method.name()).then(|| MethodChoice::with_defaults(name)).flatten() {
            header.method = choice;
        }
        self.method.or(method(name).copied()).ok_or_else(|| BuildError::MethodNotAvailable {
            method: name.on_command_line(),
            available: METHODS.iter().map(|method| method.name).collect(),
        })
    }
}

/// A fault of an authored entity's mesh is a fault of the scene file.
fn explain(scene: &Scene, error: DiscretiseError) -> BuildError {
    match error.downcast::<MeshFault>() {
        Ok(fault) => BuildError::Scene(scene.explain(&fault)),
        Err(other) => BuildError::Discretise(other),
    }
}

/// A world with the authored entities and what every method finds there.
fn empty_world(scene: &Scene) -> World {
    let SceneHeader { liquid, atmosphere, seed, .. } = scene.header;
    let mut world = World::new();
    world.insert_resource(scene.header.clone());
    world.insert_resource(Liquid::from(liquid));
    world.insert_resource(Atmosphere::from(atmosphere));
    world.insert_resource(Seed(seed));
    world.init_resource::<Clock>();
    world.init_resource::<StepLimits>();
    world.init_resource::<Observables>();
    // The first column of every run, whatever a method measures.
    world.resource_mut::<Observables>().record(STEP_LENGTH, "s", 0.0);
    world.init_resource::<Faults>();
    world.init_resource::<ColumnRegistry>();
    StateRegistry::register::<Clock>(&mut world, "clock");
    StateRegistry::register::<Seed>(&mut world, "seed");
    StateRegistry::register::<Observables>(&mut world, "observables");
    scene.spawn_into(&mut world);
    world
}

/// The method's systems, and those that every method runs.
fn assemble(method: &Method, world: &mut World) -> SchedulePlan {
    let mut plan = SchedulePlan::new();
    (method.assemble)(&mut plan);
    plan.add(Stage::Clock, "choose the step length", choose_step_length, Requires::nothing());
    plan.add(Stage::Observe, "check for finite values", check_finite, Requires::nothing());
    StageTimes::install(world, &mut plan);
    plan
}
