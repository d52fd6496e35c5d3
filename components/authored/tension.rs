//! Films of other soap than the scene's liquid.

use bevy_ecs::component::Component;
use serde::{Deserialize, Deserializer};

use crate::quantity::{SurfaceTension, range};

/// Tension `σ` of each interface of the films of an entity, newtons per metre, instead of that of the scene's liquid.
///
/// It goes with the bubbles of the entity. A film between two bubbles that have different ones has the mean of both; a bubble that
/// another joins keeps its own, and parts of one that divides have the same.
///
/// ```ron
/// [ Sphere(radius: "4 cm"), Tension("20 mN/m"), Film(thickness: Uniform("400 nm")) ]
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Tension(pub SurfaceTension);

impl<'de> Deserialize<'de> for Tension {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "Tension")]
        struct Checked(#[serde(deserialize_with = "range::interface_tension")] SurfaceTension);
        Checked::deserialize(deserializer).map(|checked| Self(checked.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tension_is_that_of_one_interface_and_neither_none_nor_negative() {
        let read = |text: &str| ron::from_str::<Tension>(text);
        assert_eq!(read("(\"20 mN/m\")").unwrap().0.si(), 0.02);
        assert!(["(0)", "(\"-20 mN/m\")", "(25)", "(\"20 mN\")"].iter().all(|wrong| read(wrong).is_err()));
    }
}
