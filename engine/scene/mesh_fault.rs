//! Faults of a mesh that only making it shows: from what a method found, to an error that points into the scene file.

use froth_components::authored::PlaceInScene;
use thiserror::Error;

use super::Scene;
use super::error::SceneError;

/// What is wrong with a mesh. Each kind has a stable code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFaultKind {
    /// A file that is no mesh (`F0062`).
    NotAMesh,
    /// Films that do not part regions: open, or with labels that do not fit (`F0063`).
    Labels,
    /// Faces that are double or without area, vertices without faces (`F0064`).
    Faces,
    /// Films that pass through each other (`F0065`).
    Crossing,
    /// A wire that passes through a film (`F0066`).
    WirePierces,
    /// A wire with no film near it (`F0067`).
    WireFar,
    /// Volumes for more or fewer bubbles than there are (`F0068`).
    Volumes,
    /// A burst of a bubble that is not there (`F0069`).
    Burst,
}

/// A fault of the films, the wire or the burst of one entity. As the error of a method's `discretise` it becomes a [`SceneError`] at the
/// entity's place in the file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{message}")]
pub struct MeshFault {
    /// Whose films, wire or burst.
    pub entity: PlaceInScene,
    /// What is wrong.
    pub kind: MeshFaultKind,
    /// Where in the mesh, and what does not hold there: part of a sentence.
    pub message: String,
}

impl Scene {
    /// The error that points at the shape, the wire or the burst of the faulty entity.
    #[must_use]
    pub fn explain(&self, fault: &MeshFault) -> SceneError {
        let entity = self.entities.get(fault.entity.0 as usize);
        let range = entity.map_or(0..0, |entity| match fault.kind {
            MeshFaultKind::WirePierces | MeshFaultKind::WireFar => entity.range_of(&["Wire"]),
            MeshFaultKind::Burst => entity.range_of(&["Burst"]),
            _ => entity.shape_range(),
        });
        let (message, file, at) = (fault.message.clone(), self.file.clone(), self.file.span(range));
        match fault.kind {
            MeshFaultKind::NotAMesh => SceneError::NotAMesh { message, file, at },
            MeshFaultKind::Labels => SceneError::MeshLabels { message, file, at },
            MeshFaultKind::Faces => SceneError::MeshFaces { message, file, at },
            MeshFaultKind::Crossing => SceneError::FilmsCross { message, file, at },
            MeshFaultKind::WirePierces => SceneError::WirePierces { message, file, at },
            MeshFaultKind::WireFar => SceneError::WireFar { message, file, at },
            MeshFaultKind::Volumes => SceneError::VolumesMisfit { message, file, at },
            MeshFaultKind::Burst => SceneError::UnknownBubble { message, file, at },
        }
    }
}
