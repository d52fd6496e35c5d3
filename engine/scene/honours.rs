//! Which method, with which settings, honours which built-in component.
//!
//! What a method cannot honour changes the meaning of a scene, and is an error. Components of the user's own are the user's affair.

use froth_components::authored::method::{MethodChoice, MethodName};

/// What a method without inertia can start from.
const STATICS: &[&str] =
    &["Name", "Sphere", "Ellipsoid", "HalfSphere", "Disc", "Rectangle", "Hexagon", "Film", "Bumps", "HarmonicMode"];

/// What acts on the liquid within a film alone.
const ON_LIQUID: &[&str] = &["HeatSource", "Spin", "Swirl"];

/// Whether a component has nothing to act on where films have no liquid that flows.
pub(super) fn needs_liquid(component: &str) -> bool {
    ON_LIQUID.contains(&component)
}

/// Whether films have liquid that flows, under a method with its settings.
pub(super) fn has_liquid(method: &MethodChoice) -> bool {
    match method {
        MethodChoice::Melp(settings) => settings.liquid_per_carrier > 0,
        _ => true,
    }
}

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
