//! What is in a mesh file, as far as estimates need it: vertices, area, bounds. The reader is the tracker's own.

use std::sync::Arc;

use froth_components::authored::mesh_shape::MeshContent;
use froth_surface::Surface;
use froth_surface::files::read_named;
use glam::DVec3;

/// Surveys a file by the ending of its name.
///
/// # Errors
/// When it is no mesh: part of a sentence that says where and why.
pub(super) fn survey(path: &str, bytes: Arc<[u8]>) -> Result<MeshContent, String> {
    let triangles = read_named(path, &bytes[..]).map_err(|fault| fault.to_string())?;
    let area = Surface::from_triangles(&triangles).film_area();
    if !(area > 0.0 && area.is_finite()) {
        return Err(format!("its faces have an area of {area}"));
    }
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for x in &triangles.positions {
        (low, high) = (low.min(*x), high.max(*x));
    }
    Ok(MeshContent { bytes, vertices: triangles.positions.len() as u64, area, bounds: [low, high] })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

    #[test]
    fn a_tetrahedron_is_surveyed() {
        let content = survey("a.obj", TETRAHEDRON.as_bytes().into()).unwrap();
        assert!((content.area - (1.5 + 0.75_f64.sqrt())).abs() < 1e-12);
        assert_eq!((content.vertices, content.bounds), (4, [DVec3::ZERO, DVec3::ONE]));
    }

    #[test]
    fn what_is_no_mesh_is_said_with_its_place() {
        let said = |path: &str, text: &str| survey(path, text.as_bytes().into()).unwrap_err();
        assert!(said("a.stl", "").contains("a.stl"));
        assert!(said("a.obj", "v 0 0 0\n").contains("no faces"));
        assert!(said("a.obj", &TETRAHEDRON.replace("f 2 3 4", "f 2 3 5")).contains("face 3"));
        assert!(said("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").contains("area"));
    }
}
