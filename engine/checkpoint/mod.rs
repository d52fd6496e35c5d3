//! Checkpoints: every registered column and every registered resource in one file, from which a run goes on bit for bit.
//!
//! [`save`] and [`load`] know what is state, from [`ColumnRegistry`] and [`StateRegistry`]; the layout of the file is in `container`.
//! Columns are their little-endian scalars, resources RON text with floats that read back exactly.

mod container;
mod error;

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::Path;

use bevy_ecs::world::World;
use froth_components::clock::Clock;
use froth_systems::rows::registry::{ColumnEntry, ColumnRegistry, KindEntry};
use froth_systems::rows::state::{StateEntry, StateRegistry};
use serde::{Deserialize, Serialize};

pub use error::CheckpointError;

use self::container::{Container, Writer};
use crate::simulation::Simulation;
use crate::whole_file::write_whole;

/// Version of this engine, which checkpoints and manifests name.
pub const ENGINE_VERSION: &str = env!("CARGO_PKG_VERSION");

/// The section that describes the others.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct About {
    engine: String,
    scene_hash: String,
    method: String,
    steps: u64,
    time: f64,
    kinds: Vec<AboutKind>,
    columns: Vec<AboutColumn>,
    states: Vec<String>,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct AboutKind {
    name: String,
    rows: usize,
}

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct AboutColumn {
    kind: String,
    name: String,
    unit: String,
    lanes: Vec<String>,
    row_bytes: usize,
}

/// What a simulation saves: the registries' entries, copied out of the world.
struct Content {
    kinds: Vec<KindEntry>,
    columns: Vec<ColumnEntry>,
    states: Vec<StateEntry>,
}

impl Content {
    fn of(world: &World) -> Self {
        let registry = world.resource::<ColumnRegistry>();
        let states = world.resource::<StateRegistry>().entries().to_vec();
        Self { kinds: registry.kinds().to_vec(), columns: registry.entries().to_vec(), states }
    }
}

fn column_section(column: &ColumnEntry) -> String {
    format!("column/{}/{}", column.kind, column.name)
}

fn state_section(state: &str) -> String {
    format!("state/{state}")
}

/// Writes a checkpoint.
///
/// # Errors
/// When the file cannot be written, or a resource cannot be written as text. An older file of that name is then still there.
pub fn save(simulation: &mut Simulation, path: &Path) -> Result<(), CheckpointError> {
    let content = Content::of(simulation.world());
    let states = states_as_text(&content.states, simulation.world())?;
    let about = ron::to_string(&About::of(simulation, &content, &states)).expect("invariant: plain data is RON");
    let sections = 1 + content.columns.len() + states.len();
    let world = simulation.world_mut();
    write_whole(path, |file: &mut BufWriter<File>| {
        let mut writer = Writer::begin(file, sections as u32)?;
        writer.section("about", about.as_bytes())?;
        for column in &content.columns {
            writer.section(&column_section(column), &column.save(world))?;
        }
        for (name, text) in &states {
            writer.section(&state_section(name), text.as_bytes())?;
        }
        writer.end()
    })
    .map_err(|cause| CheckpointError::Unwritable { path: path.to_owned(), cause })
}

/// Name and text of every state that the world has.
fn states_as_text(entries: &[StateEntry], world: &World) -> Result<Vec<(&'static str, String)>, CheckpointError> {
    let present = entries.iter().filter_map(|entry| Some((entry.name, entry.get(world)?)));
    present
        .map(|(name, state)| match ron::to_string(state) {
            Ok(text) => Ok((name, text)),
            Err(error) => Err(CheckpointError::Unsayable { name, message: error.to_string() }),
        })
        .collect()
}

impl About {
    fn of(simulation: &mut Simulation, content: &Content, states: &[(&'static str, String)]) -> Self {
        let Clock { steps, time, .. } = *simulation.clock();
        let rows = simulation.rows();
        Self {
            engine: ENGINE_VERSION.to_owned(),
            scene_hash: format!("{:016x}", simulation.scene_hash()),
            method: simulation.method().name.to_owned(),
            steps,
            time,
            kinds: rows.into_iter().map(|(name, rows)| AboutKind { name: name.to_owned(), rows }).collect(),
            columns: content.columns.iter().map(AboutColumn::of).collect(),
            states: states.iter().map(|(name, _)| (*name).to_owned()).collect(),
        }
    }
}

impl AboutColumn {
    fn of(column: &ColumnEntry) -> Self {
        Self {
            kind: column.kind.to_owned(),
            name: column.name.to_owned(),
            unit: column.unit.to_owned(),
            lanes: column.lanes.iter().map(|lane| (*lane).to_owned()).collect(),
            row_bytes: column.row_bytes,
        }
    }

    /// As messages show it: what must agree.
    fn signature(&self) -> String {
        format!("column {} of {} ({}, {} bytes)", self.name, self.kind, self.unit, self.row_bytes)
    }
}

/// Replaces all rows and all state of a simulation by those of a checkpoint.
///
/// # Errors
/// When the file is damaged, or of another version, scene, or set of columns. Nothing has changed then, but for a
/// [`CheckpointError::State`].
pub fn load(simulation: &mut Simulation, path: &Path) -> Result<(), CheckpointError> {
    let bytes = fs::read(path).map_err(|cause| CheckpointError::Unreadable { path: path.to_owned(), cause })?;
    let container = Container::read(path, bytes)?;
    let content = Content::of(simulation.world());
    let about = about(path, &container)?;
    check_identity(simulation, path, &about)?;
    check_content(&content, path, &about)?;
    let world = simulation.world_mut();
    load_columns(world, path, &content, &about, &container)?;
    load_states(world, path, &content, &container)
}

fn about(path: &Path, container: &Container) -> Result<About, CheckpointError> {
    let unreadable =
        |message: String| CheckpointError::State { path: path.to_owned(), name: "about".to_owned(), message };
    let bytes = container.section("about").ok_or_else(|| unreadable("it is missing".to_owned()))?;
    ron::de::from_bytes(bytes).map_err(|error| unreadable(error.to_string()))
}

fn check_identity(simulation: &Simulation, path: &Path, about: &About) -> Result<(), CheckpointError> {
    let path = path.to_owned();
    if about.engine != ENGINE_VERSION {
        return Err(CheckpointError::OtherEngine { path, found: about.engine.clone(), this: ENGINE_VERSION });
    }
    let wanted = format!("{:016x}", simulation.scene_hash());
    if about.scene_hash != wanted {
        return Err(CheckpointError::OtherScene { path, found: about.scene_hash.clone(), wanted });
    }
    Ok(())
}

fn check_content(content: &Content, path: &Path, about: &About) -> Result<(), CheckpointError> {
    let here: Vec<String> = content.columns.iter().map(|column| AboutColumn::of(column).signature()).collect();
    let there: Vec<String> = about.columns.iter().map(AboutColumn::signature).collect();
    let without = |a: &[String], b: &[String]| a.iter().filter(|x| !b.contains(x)).cloned().collect::<Vec<_>>();
    let (missing, mut unknown) = (without(&here, &there), without(&there, &here));
    let known = |state: &&String| content.states.iter().any(|entry| entry.name == **state);
    unknown.extend(about.states.iter().filter(|state| !known(state)).map(|state| format!("state {state}")));
    if missing.is_empty() && unknown.is_empty() {
        return Ok(());
    }
    Err(CheckpointError::OtherContent { path: path.to_owned(), missing, unknown })
}

fn load_columns(
    world: &mut World,
    path: &Path,
    content: &Content,
    about: &About,
    container: &Container,
) -> Result<(), CheckpointError> {
    let rows_of = |kind: &str| about.kinds.iter().find(|about| about.name == kind).map_or(0, |about| about.rows);
    let mut sections = Vec::with_capacity(content.columns.len());
    for column in &content.columns {
        let name = column_section(column);
        let bytes = container.section(&name).filter(|bytes| bytes.len() == rows_of(column.kind) * column.row_bytes);
        let Some(bytes) = bytes else {
            let missing = vec![format!("whole rows of {name}")];
            return Err(CheckpointError::OtherContent { path: path.to_owned(), missing, unknown: Vec::new() });
        };
        sections.push((column, bytes));
    }
    for kind in &content.kinds {
        kind.respawn(world, rows_of(kind.name));
    }
    sections.into_iter().for_each(|(column, bytes)| column.load(world, bytes));
    Ok(())
}

fn load_states(
    world: &mut World,
    path: &Path,
    content: &Content,
    container: &Container,
) -> Result<(), CheckpointError> {
    for state in &content.states {
        let Some(bytes) = container.section(&state_section(state.name)) else {
            state.remove(world);
            continue;
        };
        let loaded = ron::Deserializer::from_bytes(bytes).map_err(|error| error.to_string()).and_then(|mut text| {
            let mut erased = <dyn erased_serde::Deserializer<'_>>::erase(&mut text);
            state.load(world, &mut erased).map_err(|error| error.to_string())
        });
        loaded.map_err(|message| {
            let name = state.name.to_owned();
            CheckpointError::State { path: path.to_owned(), name, message }
        })?;
    }
    Ok(())
}
