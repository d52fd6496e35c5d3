//! Scene files: a header, and a list of entities, each a list of components (RON).
//!
//! ```
//! use froth::scene::{AuthoredRegistry, Scene, available_memory};
//!
//! let text = r#"Scene(
//!     title: "A bubble", method: Melp(), resolution: Particles(4000), duration: "2 s",
//!     entities: [
//!         [ Name("bubble"), Sphere(radius: "10 cm"), Film(thickness: Uniform("400 nm")) ],
//!         [ Gravity((0.0, -9.81, 0.0)) ],
//!     ],
//! )"#;
//! let scene = Scene::from_text("bubble.ron", text, &AuthoredRegistry::built_in())?;
//! let estimate = scene.check(available_memory())?;
//! assert_eq!(estimate.carriers(), 4000);
//! # Ok::<(), froth::scene::SceneError>(())
//! ```
//!
//! Reading goes from path to text (`file`), from text to components (`parse`, by the [`AuthoredRegistry`]), and then the scene is
//! checked as a whole (`check`, [`Estimate`]). A file is untrusted: length, depth and memory are bounded, and nothing in it panics.
//! Every fault is a [`SceneError`] with a stable code.

mod builtin;
mod check;
mod error;
mod estimate;
mod file;
mod header;
mod honours;
mod mesh_fault;
mod mesh_file;
mod mesh_survey;
mod parse;
mod registry;
mod ron_text;
mod text;

use std::any::Any;
use std::fmt;
use std::ops::Range;
use std::path::Path;

use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use froth_components::authored::film_shape::{FilmShape, Parts};
use froth_components::authored::mesh_shape::MeshFile;
use froth_components::authored::{Name, PlaceInScene};

pub use check::{LEAST_BEND, LEAST_PARTICLES, LEAST_VERTICES, MOST_FRAMES};
pub use error::{Place, SceneError};
pub use estimate::{
    BOUNDARY_ROWS, BYTES_PER_EULERIAN, BYTES_PER_LAGRANGIAN, BYTES_PER_VERTEX, Estimate, Rows, available_memory,
};
pub use file::LONGEST_FILE;
pub use header::SceneHeader;
pub use honours::honours;
pub use mesh_fault::{MeshFault, MeshFaultKind};
pub use mesh_file::{LONGEST_MESHES, folder_of};
pub use registry::{AuthoredRegistry, RegisteredComponent};
pub use ron_text::Block;
pub use text::SceneText;

/// A scene: what a file says, read and in SI units.
#[derive(Debug)]
pub struct Scene {
    /// What the scene says besides its entities. May be changed before the run, as `--method` and `--resolution` do.
    pub header: SceneHeader,
    /// Films, fields and whatever else is registered, in the order of the file.
    entities: Vec<AuthoredEntity>,
    /// The picture's settings, which the picture reads.
    picture: Option<Block>,
    /// Where the file gives the resolution.
    resolution: Range<usize>,
    file: SceneText,
}

impl Scene {
    /// Reads a scene file.
    ///
    /// # Errors
    /// When the file cannot be read or is no scene. The scene as a whole is checked by [`Scene::check`].
    pub fn from_path(path: impl AsRef<Path>, registry: &AuthoredRegistry) -> Result<Self, SceneError> {
        let path = path.as_ref();
        Self::from_path_in(folder_of(path), path, registry)
    }

    /// Reads a scene file, and its mesh files from a folder other than its own.
    ///
    /// # Errors
    /// As [`Scene::from_path`].
    pub fn from_path_in(folder: &Path, path: &Path, registry: &AuthoredRegistry) -> Result<Self, SceneError> {
        Self::from_bytes_in(folder, &path.display().to_string(), &file::read(path)?, registry)
    }

    /// Reads a scene from bytes, which may be anything. `name` stands for the file in errors; mesh files are looked for in
    /// its folder.
    ///
    /// # Errors
    /// When the bytes are no scene, or a mesh file cannot be read.
    pub fn from_bytes(name: &str, bytes: &[u8], registry: &AuthoredRegistry) -> Result<Self, SceneError> {
        Self::from_bytes_in(folder_of(Path::new(name)), name, bytes, registry)
    }

    /// Reads a scene from bytes, and its mesh files from a folder. `name` stands for the file in errors.
    ///
    /// # Errors
    /// As [`Scene::from_bytes`].
    pub fn from_bytes_in(
        folder: &Path,
        name: &str,
        bytes: &[u8],
        registry: &AuthoredRegistry,
    ) -> Result<Self, SceneError> {
        let mut scene = parse::scene(&SceneText::new(name, file::text(name, bytes)?), registry)?;
        scene.read_mesh_files(folder)?;
        Ok(scene)
    }

    /// Reads a scene from text. `name` stands for the file in errors; mesh files are looked for in its folder.
    ///
    /// # Errors
    /// When the text is no scene.
    pub fn from_text(name: &str, text: &str, registry: &AuthoredRegistry) -> Result<Self, SceneError> {
        Self::from_bytes(name, text.as_bytes(), registry)
    }

    /// The text the scene was read from, with its name.
    #[must_use]
    pub fn source(&self) -> &SceneText {
        &self.file
    }

    /// Films, fields and whatever else is registered, in the order of the file.
    #[must_use]
    pub fn entities(&self) -> &[AuthoredEntity] {
        &self.entities
    }

    /// The picture's settings as text, for [`Block::read`] with the picture's own type; `None` where the scene gives none.
    #[must_use]
    pub fn picture(&self) -> Option<&Block> {
        self.picture.as_ref()
    }

    /// The mesh files of the scene with their content, in the order of the scene.
    pub fn mesh_files(&self) -> impl Iterator<Item = &MeshFile> {
        self.entities.iter().filter_map(|entity| entity.get::<MeshFile>())
    }

    /// Numbers of carriers and memory, without allocating any.
    #[must_use]
    pub fn estimate(&self) -> Estimate {
        Estimate::of(self)
    }

    /// Spawns every entity with its components and its [`PlaceInScene`], in the order of the file.
    pub fn spawn_into(&self, world: &mut World) -> Vec<Entity> {
        let places = (0..).map(PlaceInScene);
        self.entities.iter().zip(places).map(|(entity, place)| entity.spawn(place, world)).collect()
    }
}

/// One entity of a scene file: a list of components, each kind at most once.
#[derive(Debug)]
pub struct AuthoredEntity {
    components: Vec<AuthoredComponent>,
}

impl AuthoredEntity {
    /// The component of a type, if the entity has one.
    #[must_use]
    pub fn get<T: Any>(&self) -> Option<&T> {
        self.components.iter().find_map(|component| (component.value.as_ref() as &dyn Any).downcast_ref())
    }

    /// Names of the components, in the order of the file.
    pub fn component_names(&self) -> impl Iterator<Item = &'static str> {
        self.components.iter().map(|component| component.name)
    }

    /// The user's name for the entity.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        self.get::<Name>().map(|name| name.0.as_str())
    }

    /// The shape, if the entity has one.
    #[must_use]
    pub fn shape(&self) -> Option<FilmShape> {
        FilmShape::of(self)
    }

    fn spawn(&self, place: PlaceInScene, world: &mut World) -> Entity {
        let mut entity = world.spawn(place);
        for component in &self.components {
            component.value.insert_into(&mut entity);
        }
        entity.id()
    }
}

impl Parts for AuthoredEntity {
    fn part<T: Component>(&self) -> Option<&T> {
        self.get()
    }
}

struct AuthoredComponent {
    name: &'static str,
    is_built_in: bool,
    value: Box<dyn registry::Authored>,
    /// Where the file gives it.
    range: Range<usize>,
}

impl fmt::Debug for AuthoredComponent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}
