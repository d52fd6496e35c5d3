//! Volumes that bubbles grow or shrink to.

use bevy_ecs::component::Component;
use serde::{Deserialize, Deserializer};

use crate::quantity::{Refusal, RefusalKind, Time, Volume, range};

/// Blows the bubbles of a film up, or lets them shrink, to volumes of their own: evenly, from what they have at the start.
///
/// A shape makes its bubbles as its closed form says, mostly equal ones; this makes any others of them.
///
/// ```ron
/// [ TripleBubble(radius: "4 cm"), Volumes(of: ["100 ml", "60 ml", "35 ml"], within: "0.2 s"), Film(thickness: Uniform("400 nm")) ]
/// ```
///
/// The gas is given, so it goes with the bubble: one that bursts leaves what it should have had by then to the region that it
/// joins, and parts of one that divides share what is still to come.
///
/// Under vortex sheets the air feels it: what comes into a bubble pushes everything else away, other bubbles and films on wires too, as a
/// source of `Q` m^3/s does, at `Q/(4 pi d^2)` from afar. It comes in evenly all over the bubble; there is no jet. Under geometric flow
/// the films of the bubble itself move, and nothing else.
#[derive(Component, Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Volumes {
    /// Volumes that the bubbles of the entity shall have in the end, cubic metres: one for each, in the order that its shape
    /// numbers them.
    pub of: BubbleVolumes,
    /// Time that they take, seconds from the start. The films follow each step's change, so a short time makes short steps.
    #[serde(deserialize_with = "range::positive")]
    pub within: Time,
}

/// Volumes of several bubbles, each greater than 0. Written `["100 ml", "60 ml"]`.
#[derive(Clone, Debug, PartialEq)]
pub struct BubbleVolumes(Vec<Volume>);

impl BubbleVolumes {
    /// Cubic metres, in the order of the file.
    pub fn si(&self) -> impl ExactSizeIterator<Item = f64> {
        self.0.iter().map(|volume| volume.si())
    }
}

impl<'de> Deserialize<'de> for BubbleVolumes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(transparent)]
        struct Positive(#[serde(deserialize_with = "range::positive")] Volume);
        let volumes = Vec::<Positive>::deserialize(deserializer)?;
        if volumes.is_empty() {
            let help = "write one for each bubble, e.g. [\"100 ml\", \"60 ml\"]";
            return Err(Refusal::new(RefusalKind::OutOfRange, "no volume is given", help).into_serde());
        }
        Ok(Self(volumes.into_iter().map(|volume| volume.0).collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bubble_has_a_volume_greater_than_nothing() {
        let read = |text: &str| ron::from_str::<Volumes>(text);
        let volumes = read(r#"(of: ["100 ml", "0.06 L", 1e-5], within: "0.2 s")"#).unwrap();
        let ml: Vec<f64> = volumes.of.si().map(|volume| (volume * 1e12).round() * 1e-6).collect();
        assert_eq!(ml, [100.0, 60.0, 10.0]);
        for wrong in [
            r#"(of: [], within: 1)"#,
            r#"(of: ["0 ml"], within: 1)"#,
            r#"(of: ["-1 ml"], within: 1)"#,
            r#"(of: ["1 cm"], within: 1)"#,
            r#"(of: ["1 ml"], within: 0)"#,
            r#"(of: ["1 ml"])"#,
        ] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
