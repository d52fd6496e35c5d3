//! Which method honours which built-in component.
//!
//! What a method cannot honour changes the meaning of a scene, and is an error. Components of the user's own are the user's affair.

use froth_components::authored::method::MethodName;

/// What a method without inertia can start from.
const STATICS: &[&str] =
    &["Name", "Sphere", "Ellipsoid", "HalfSphere", "Disc", "Rectangle", "Hexagon", "Film", "Bumps", "HarmonicMode"];

/// Components a method honours; `None` for all of them.
fn honoured_by(method: MethodName) -> Option<&'static [&'static str]> {
    match method {
        MethodName::GeometricFlow => Some(STATICS),
        _ => None,
    }
}

/// Whether a method honours a built-in component.
#[must_use]
pub fn honours(method: MethodName, component: &str) -> bool {
    honoured_by(method).is_none_or(|honoured| honoured.contains(&component))
}

/// Available methods that honour a built-in component, by their names in scene files.
pub(super) fn methods_that_honour(component: &str) -> Vec<&'static str> {
    let honouring = MethodName::ALL.into_iter().filter(|method| method.is_available() && honours(*method, component));
    honouring.map(MethodName::in_scene).collect()
}
