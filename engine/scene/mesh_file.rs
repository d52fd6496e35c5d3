//! Reads the mesh files that a scene names: from its own folder only, plain files of bounded length.

use std::any::Any;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use froth_components::authored::mesh_shape::MeshFile;

use super::error::SceneError;
use super::file::{FileFault, nearest_file, read_whole};
use super::mesh_survey::survey;
use super::{AuthoredComponent, Scene};

/// Longest that all mesh files of a scene may be together, bytes: some five million vertices.
pub const LONGEST_MESHES: u64 = 256 << 20;

/// The folder in which mesh files of a scene are looked for.
#[must_use]
pub fn folder_of(scene: &Path) -> &Path {
    scene.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

impl Scene {
    /// Gives every [`MeshFile`] its content.
    pub(super) fn read_mesh_files(&mut self, folder: &Path) -> Result<(), SceneError> {
        let mut left = LONGEST_MESHES;
        let file = self.file.clone();
        for component in self.entities.iter_mut().flat_map(|entity| &mut entity.components) {
            let AuthoredComponent { value, range, .. } = component;
            let Some(mesh) = (value.as_mut() as &mut dyn Any).downcast_mut::<MeshFile>() else { continue };
            let at = file.span(range.clone());
            let bytes = read(folder, &mesh.path, left).map_err(|fault| match fault {
                MeshFileFault::Outside => SceneError::MeshOutside { path: mesh.path.clone(), file: file.clone(), at },
                MeshFileFault::Unreadable { problem, help } => {
                    SceneError::MeshUnreadable { path: mesh.path.clone(), problem, help, file: file.clone(), at }
                }
            })?;
            left -= bytes.len() as u64;
            let bytes: Arc<[u8]> = bytes.into();
            let content = survey(&mesh.path, bytes);
            *mesh = mesh.with_content(content.map_err(|message| SceneError::NotAMesh {
                message,
                file: file.clone(),
                at,
            })?);
        }
        Ok(())
    }
}

enum MeshFileFault {
    Outside,
    Unreadable { problem: String, help: String },
}

/// The bytes of a file within a folder.
fn read(folder: &Path, path: &str, limit: u64) -> Result<Vec<u8>, MeshFileFault> {
    let whole = within(folder, path).ok_or(MeshFileFault::Outside)?;
    let unreadable = |problem: &str, help: String| MeshFileFault::Unreadable { problem: problem.to_owned(), help };
    let read = read_whole(&whole, limit).map_err(|fault| match fault {
        FileFault::Cause(cause) if cause.kind() == io::ErrorKind::NotFound => {
            let near = nearest_file(&whole).and_then(|near| {
                Path::new(path).with_file_name(Path::new(&near).file_name()?).to_str().map(str::to_owned)
            });
            let help = match near {
                Some(near) => format!("did you mean `{near}`?"),
                None => "write its path from the scene's own folder".to_owned(),
            };
            unreadable("is not there", help)
        }
        FileFault::Cause(cause) => unreadable("cannot be read", cause.to_string()),
        FileFault::Directory => unreadable("is a folder", "name a file in it".to_owned()),
        FileFault::TooLong(bytes) => {
            let help =
                format!("meshes of a scene have at most {LONGEST_MESHES} bytes together, and this alone has {bytes}");
            unreadable("is too long", help)
        }
    })?;
    // A link may lead out of the folder. The file exists, so that both paths can be resolved.
    let resolved = whole.canonicalize().ok().zip(folder.canonicalize().ok());
    if resolved.is_some_and(|(file, folder)| file.starts_with(folder)) { Ok(read) } else { Err(MeshFileFault::Outside) }
}

/// The path of a file within a folder; `None` if it leads out, or into a hidden place of the system such as a drive.
fn within(folder: &Path, path: &str) -> Option<PathBuf> {
    let inward = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
    let stays = !path.is_empty() && Path::new(path).components().all(inward);
    stays.then(|| folder.join(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_that_lead_out_of_a_folder_are_refused() {
        for path in ["foam.ply", "meshes/foam.ply", "./foam.ply"] {
            assert_eq!(within(Path::new("scenes"), path), Some(Path::new("scenes").join(path)));
        }
        for path in ["/etc/passwd", "../foam.ply", "meshes/../../foam.ply", "..", ""] {
            assert_eq!(within(Path::new("scenes"), path), None, "{path}");
        }
    }
}
