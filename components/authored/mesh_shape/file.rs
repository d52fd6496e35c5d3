//! A mesh that another program made.

use std::sync::Arc;

use bevy_ecs::component::Component;
use glam::DVec3;
use serde::Deserialize;

use super::{Measured, corners};
use crate::authored::shape::Place;
use crate::quantity::{Ratio, range};

/// A mesh from a Wavefront OBJ or Stanford PLY file: triangles, and which regions they part.
///
/// The file lies in the folder of the scene or below it. The loader reads it; a method finds its bytes in [`MeshFile::bytes`].
#[derive(Component, Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeshFile {
    /// Where the file is, from the scene's folder: `"bubbles.ply"`, `"meshes/bubbles.obj"`.
    pub path: String,
    /// Metres per unit of length of the file. Default 1.
    #[serde(default = "one", deserialize_with = "range::mesh_scale")]
    pub scale: Ratio,
    /// Where the file's origin comes to lie, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    #[serde(skip)]
    content: MeshContent,
}

impl MeshFile {
    /// A mesh file with its content, for code.
    #[must_use]
    pub fn new(path: impl Into<String>, scale: Ratio, centre: Place, content: MeshContent) -> Self {
        Self { path: path.into(), scale, centre, content }
    }

    /// The same with the file's content.
    #[must_use]
    pub fn with_content(&self, content: MeshContent) -> Self {
        Self { content, ..self.clone() }
    }

    /// The bytes of the file; none before the loader has read it.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.content.bytes
    }
}

/// What is in a mesh file.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshContent {
    /// Its bytes. Shared: scene and world hold them once.
    pub bytes: Arc<[u8]>,
    /// Number of its vertices.
    pub vertices: u64,
    /// Area of its triangles, in the file's unit of length squared.
    pub area: f64,
    /// Lowest and highest corner of its bounding box, in the file's unit of length.
    pub bounds: [DVec3; 2],
}

impl Default for MeshContent {
    fn default() -> Self {
        Self { bytes: Arc::from([]), vertices: 0, area: 0.0, bounds: [DVec3::ZERO; 2] }
    }
}

impl Measured for MeshFile {
    /// That of the bounding box.
    fn centre(&self) -> DVec3 {
        let [low, high] = self.content.bounds;
        self.centre.si() + 0.5 * self.scale.si() * (low + high)
    }

    /// Half the longest side of the bounding box.
    fn size(&self) -> f64 {
        let [low, high] = self.content.bounds;
        0.5 * self.scale.si() * (high - low).max_element()
    }

    /// Exact.
    fn area(&self) -> f64 {
        self.content.area * self.scale.si().powi(2)
    }

    fn outline(&self) -> Vec<DVec3> {
        let [low, high] = self.content.bounds;
        corners(self.centre(), self.scale.si() * (high - low))
    }

    fn own_vertices(&self) -> u64 {
        self.content.vertices
    }
}

fn one() -> Ratio {
    Ratio::from_si(1.0)
}
