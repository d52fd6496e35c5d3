//! How a mesh of films is kept fine and even, whatever method moves it.

use serde::{Deserialize, Deserializer};

use crate::quantity::{Ratio, Refusal, RefusalKind, range};

/// What happens where two films touch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Contact {
    /// They become one film.
    #[default]
    Merge,
    /// They stay apart.
    Bounce,
}

/// Where the vertices go that splits of long edges make.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum Placement {
    /// In the middles of their edges: a film bends there only once it moves.
    #[default]
    Midpoint,
    /// Where the smooth film has the middle (modified butterfly), if nothing is in the way. Bubbles get back what that changes of their
    /// volumes, where these are kept.
    Butterfly,
}

/// How the mesh is kept fine and even, and how films meet and part. Lengths are fractions of the edge length that the
/// scene's resolution asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remesh {
    /// Whether edges are split and collapsed at all; without, the mesh is moved as it is until it breaks. Default true.
    pub enabled: bool,
    /// Whether edges are flipped to where they are shorter. Default true.
    pub flips: bool,
    /// Whether vertices are spread evenly within their films. Default true.
    pub smoothing: bool,
    /// Whether bubbles change neighbours (T1) and necks pinch off. Default true.
    pub topology: bool,
    /// What happens where two films touch. Default [`Contact::Merge`].
    pub contact: Contact,
    /// Distance at which films touch, above 0 to 0.5, less than `shortest`. Default 0.1.
    pub snap: Ratio,
    /// Edges shorter than this are collapsed, above 0, at most half of `longest`. Default 0.5.
    pub shortest: Ratio,
    /// Edges longer than this are split, 1 to 4. Default 1.5.
    pub longest: Ratio,
    /// Where the vertices go that splits make. Default [`Placement::Midpoint`].
    pub placement: Placement,
}

impl Default for Remesh {
    fn default() -> Self {
        Self {
            enabled: true,
            flips: true,
            smoothing: true,
            topology: true,
            contact: Contact::Merge,
            snap: Ratio::from_si(0.1),
            shortest: Ratio::from_si(0.5),
            longest: Ratio::from_si(1.5),
            placement: Placement::Midpoint,
        }
    }
}

impl Remesh {
    /// Bounds that leave room between them: the halves of a split edge must not collapse, and films must not touch across
    /// an edge that is allowed.
    fn check(self) -> Result<Self, Refusal> {
        let (snap, shortest, longest) = (self.snap, self.shortest, self.longest);
        let refuse = |message: String, help: &str| Err(Refusal::new(RefusalKind::Contradiction, message, help));
        if 2.0 * shortest.si() > longest.si() {
            let message = format!("halves of an edge of {longest} would be shorter than {shortest}");
            return refuse(message, "write a `shortest` of at most half of `longest`, e.g. 0.5 and 1.5");
        }
        if snap >= shortest {
            let message = format!("films that touch at {snap} would touch along edges of {shortest}");
            return refuse(message, "write a `snap` of less than `shortest`, e.g. 0.1 and 0.5");
        }
        Ok(self)
    }
}

impl<'de> Deserialize<'de> for Remesh {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "Remesh", deny_unknown_fields, default)]
        struct Fields {
            enabled: bool,
            flips: bool,
            smoothing: bool,
            topology: bool,
            contact: Contact,
            #[serde(deserialize_with = "range::half_at_most")]
            snap: Ratio,
            #[serde(deserialize_with = "range::positive")]
            shortest: Ratio,
            #[serde(deserialize_with = "range::one_to_four")]
            longest: Ratio,
            placement: Placement,
        }
        impl Default for Fields {
            fn default() -> Self {
                let Remesh { enabled, flips, smoothing, topology, contact, snap, shortest, longest, placement } =
                    Remesh::default();
                Self { enabled, flips, smoothing, topology, contact, snap, shortest, longest, placement }
            }
        }
        let Fields { enabled, flips, smoothing, topology, contact, snap, shortest, longest, placement } =
            Fields::deserialize(deserializer)?;
        let remesh = Self { enabled, flips, smoothing, topology, contact, snap, shortest, longest, placement };
        remesh.check().map_err(Refusal::into_serde)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_halves_of_a_split_edge_are_long_enough_to_stay() {
        let read = |text: &str| ron::from_str::<Remesh>(text);
        assert_eq!(read("()").unwrap(), Remesh::default());
        assert_eq!(read("(shortest: 0.75)").unwrap().shortest.si(), 0.75);
        assert!(read("(shortest: 0.76)").is_err());
        assert!(read("(snap: 0.3, shortest: 0.3)").is_err());
        assert!(read("(longest: 0.9)").is_err());
    }

    #[test]
    fn new_vertices_go_to_one_of_two_places() {
        let read = |text: &str| ron::from_str::<Remesh>(text).map(|remesh| remesh.placement);
        assert_eq!(read("()").unwrap(), Placement::Midpoint);
        assert_eq!(read("(placement: Butterfly)").unwrap(), Placement::Butterfly);
        assert!(read("(placement: Loop)").is_err());
    }
}
