//! Which method, with which settings, honours which built-in component.
//!
//! What a method cannot honour changes the meaning of a scene, and is an error. Components of the user's own are the user's affair.

use froth_components::authored::mesh_shape::MeshShape;
use froth_components::authored::method::MethodName;
use froth_components::authored::shape::Shape;

/// What geometric flow honours besides shapes. Its films have thickness, hence weight and colour, but no liquid that flows.
const BY_GEOMETRIC_FLOW: &[&str] = &["Name", "Film", "Bumps", "HarmonicMode", "Drift", "Gravity"];

/// What vortex sheets honour besides shapes. Films have weight; the air starts at rest, or as the wind has it.
const BY_VORTEX_SHEET: &[&str] = &["Name", "Film", "Bumps", "HarmonicMode", "Gravity", "Wind"];

/// What takes a mesh, besides [`MeshShape`].
const ON_MESH: &[&str] = &["Wire", "Moves", "Burst", "Volumes", "Tension", "Stretch"];

/// What acts on the liquid within a film alone.
const ON_LIQUID: &[&str] = &["HeatSource", "Spin", "Swirl"];

/// What acts through inertia alone.
const ON_INERTIA: &[&str] = &["Drift"];

/// Whether a component has nothing to act on where films have no liquid that flows.
pub(super) fn needs_liquid(component: &str) -> bool {
    ON_LIQUID.contains(&component)
}

/// Whether a component has no effect on films without inertia.
pub(super) fn needs_inertia(component: &str) -> bool {
    ON_INERTIA.contains(&component)
}

/// Whether a method honours a built-in component.
#[must_use]
pub fn honours(method: MethodName, component: &str) -> bool {
    let takes_mesh = MeshShape::NAMES.contains(&component) || ON_MESH.contains(&component);
    match method {
        MethodName::Melp => !takes_mesh,
        MethodName::GeometricFlow => {
            takes_mesh || Shape::NAMES.contains(&component) || BY_GEOMETRIC_FLOW.contains(&component)
        }
        MethodName::VortexSheet => {
            takes_mesh || Shape::NAMES.contains(&component) || BY_VORTEX_SHEET.contains(&component)
        }
        _ => true,
    }
}

/// Available methods that honour a built-in component, by their names in scene files.
pub(super) fn methods_that_honour(component: &str) -> Vec<&'static str> {
    let honouring = MethodName::ALL.into_iter().filter(|method| method.is_available() && honours(*method, component));
    honouring.map(MethodName::in_scene).collect()
}
