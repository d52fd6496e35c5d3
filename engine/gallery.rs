//! The built-in scenes, in one table: the command line lists them, and takes their names instead of paths.

use froth_components::quantity::nearest;

/// A scene that is part of the engine.
#[derive(Clone, Copy, Debug)]
pub struct BuiltInScene {
    /// Name on the command line.
    pub name: &'static str,
    /// What it shows, in one line.
    pub summary: &'static str,
    /// The scene file.
    pub text: &'static str,
}

/// Every built-in scene, in the order of listings. The first is what `froth` alone runs.
pub const GALLERY: &[BuiltInScene] = &[
    BuiltInScene {
        name: "giant_bubble",
        summary: "a giant bubble wobbles back to a sphere while its liquid drains and swirls",
        text: include_str!("../scenes/giant_bubble.ron"),
    },
    BuiltInScene {
        name: "deforming_rectangle",
        summary: "a vertical film, thick above thin, turns over while a push of air sweeps across it",
        text: include_str!("../scenes/deforming_rectangle.ron"),
    },
    BuiltInScene {
        name: "half_bubble",
        summary: "a half bubble on a plate, warmed from below, leans in a breeze",
        text: include_str!("../scenes/half_bubble.ron"),
    },
    BuiltInScene {
        name: "drainage",
        summary: "a vertical film drains into Newton's fringes",
        text: include_str!("../scenes/drainage.ron"),
    },
    BuiltInScene {
        name: "equilibrium_disc",
        summary: "an uneven disc evens out by the Marangoni effect",
        text: include_str!("../scenes/equilibrium_disc.ron"),
    },
    BuiltInScene {
        name: "resting_bubble",
        summary: "a bubble at rest at 1 atm stays at rest",
        text: include_str!("../scenes/resting_bubble.ron"),
    },
    BuiltInScene {
        name: "two_bubbles_contact",
        summary: "two bubbles drift together and share a wall",
        text: include_str!("../scenes/two_bubbles_contact.ron"),
    },
    BuiltInScene {
        name: "double_bubble_sizes",
        summary: "a small bubble on a large one: their wall is curved",
        text: include_str!("../scenes/double_bubble_sizes.ron"),
    },
    BuiltInScene {
        name: "three_bubbles_contact",
        summary: "three bubbles close up around a border",
        text: include_str!("../scenes/three_bubbles_contact.ron"),
    },
    BuiltInScene {
        name: "four_bubbles_contact",
        summary: "four bubbles close up around a point where four borders meet",
        text: include_str!("../scenes/four_bubbles_contact.ron"),
    },
    BuiltInScene {
        name: "sphere",
        summary: "a bumpy bubble becomes a sphere",
        text: include_str!("../scenes/sphere.ron"),
    },
    BuiltInScene {
        name: "double_bubble",
        summary: "gas passes between two bubbles that share a wall",
        text: include_str!("../scenes/double_bubble.ron"),
    },
    BuiltInScene {
        name: "triple_bubble",
        summary: "three bubbles are blown to unequal volumes",
        text: include_str!("../scenes/triple_bubble.ron"),
    },
    BuiltInScene {
        name: "quadruple_bubble",
        summary: "four bubbles are blown to unequal volumes",
        text: include_str!("../scenes/quadruple_bubble.ron"),
    },
    BuiltInScene {
        name: "coalescence",
        summary: "two bubbles touch and become a double bubble",
        text: include_str!("../scenes/coalescence.ron"),
    },
    BuiltInScene {
        name: "unequal_tensions",
        summary: "two bubbles of different soaps share a wall, and not at 120 degrees",
        text: include_str!("../scenes/unequal_tensions.ron"),
    },
    BuiltInScene {
        name: "pulled_double_bubble",
        summary: "two rings pull a double bubble apart",
        text: include_str!("../scenes/pulled_double_bubble.ron"),
    },
    BuiltInScene {
        name: "catenoid",
        summary: "a film between two rings necks, pinches off, and leaves two discs",
        text: include_str!("../scenes/catenoid.ron"),
    },
    BuiltInScene {
        name: "tetrahedral_frame",
        summary: "six flat films in a tetrahedron of wire",
        text: include_str!("../scenes/tetrahedral_frame.ron"),
    },
    BuiltInScene {
        name: "cubic_frame",
        summary: "thirteen films in a cube of wire",
        text: include_str!("../scenes/cubic_frame.ron"),
    },
    BuiltInScene {
        name: "octahedral_frame",
        summary: "films in an octahedron of wire find a minimum by themselves",
        text: include_str!("../scenes/octahedral_frame.ron"),
    },
    BuiltInScene {
        name: "kelvin",
        summary: "35 of Kelvin's cells: flat walls bend, then the skin of the block squeezes them",
        text: include_str!("../scenes/kelvin.ron"),
    },
    BuiltInScene {
        name: "foam_lattice",
        summary: "a block of 125 cubes becomes a foam",
        text: include_str!("../scenes/foam_lattice.ron"),
    },
    BuiltInScene {
        name: "bursting_foam",
        summary: "ten bubbles burst one by one",
        text: include_str!("../scenes/bursting_foam.ron"),
    },
    // For `froth verify` alone.
    BuiltInScene {
        name: "shape_mode",
        summary: "law: a bubble of film mass alone rings in its lowest shape mode",
        text: include_str!("../scenes/shape_mode.ron"),
    },
    BuiltInScene {
        name: "elastic_shape_mode",
        summary: "law: a bubble with liquid, surfactant and air rings in its lowest shape mode",
        text: include_str!("../scenes/elastic_shape_mode.ron"),
    },
    BuiltInScene {
        name: "marangoni_wave",
        summary: "law: liquid and surfactant slosh to and fro in a flat film",
        text: include_str!("../scenes/marangoni_wave.ron"),
    },
    BuiltInScene {
        name: "cube_oscillation",
        summary: "a cube of film lets go and rings in air",
        text: include_str!("../scenes/cube_oscillation.ron"),
    },
    BuiltInScene {
        name: "cube_damped",
        summary: "a cube of film lets go and settles to a sphere",
        text: include_str!("../scenes/cube_damped.ron"),
    },
    BuiltInScene {
        name: "double_bubble_oscillation",
        summary: "a stretched double bubble wobbles",
        text: include_str!("../scenes/double_bubble_oscillation.ron"),
    },
    BuiltInScene {
        name: "triple_bubble_oscillation",
        summary: "a squeezed triple bubble wobbles",
        text: include_str!("../scenes/triple_bubble_oscillation.ron"),
    },
    BuiltInScene {
        name: "octahedron",
        summary: "films on an octahedron of wire settle",
        text: include_str!("../scenes/octahedron.ron"),
    },
    BuiltInScene {
        name: "bubble_in_a_ring",
        summary: "a bubble squeezed through a ring slips to one side",
        text: include_str!("../scenes/bubble_in_a_ring.ron"),
    },
    BuiltInScene {
        name: "catenoid_pinching",
        summary: "two rings draw a film apart until it pinches",
        text: include_str!("../scenes/catenoid_pinching.ron"),
    },
    BuiltInScene {
        name: "pulling_double_bubble",
        summary: "two rings pull a double bubble apart, against the air",
        text: include_str!("../scenes/pulling_double_bubble.ron"),
    },
    BuiltInScene {
        name: "bubble_cluster",
        summary: "ten bubbles, packed at random, swing towards rest",
        text: include_str!("../scenes/bubble_cluster.ron"),
    },
    BuiltInScene {
        name: "bubble_popping",
        summary: "a cluster of ten bubbles pops one by one",
        text: include_str!("../scenes/bubble_popping.ron"),
    },
    BuiltInScene {
        name: "sweeping_ring",
        summary: "a ring that sweeps through the air blows bubbles",
        text: include_str!("../scenes/sweeping_ring.ron"),
    },
    BuiltInScene {
        name: "inflating_bubble",
        summary: "a bubble that is blown up pushes bubbles and a film on a ring away",
        text: include_str!("../scenes/inflating_bubble.ron"),
    },
    BuiltInScene {
        name: "ring_in_wind",
        summary: "the wind blows a bubble out of a film on a ring",
        text: include_str!("../scenes/ring_in_wind.ron"),
    },
];

/// The built-in scene of a name.
#[must_use]
pub fn built_in(name: &str) -> Option<&'static BuiltInScene> {
    GALLERY.iter().find(|scene| scene.name == name)
}

/// The built-in name most like `name`, if any is near enough to be what was meant.
#[must_use]
pub fn nearest_name(name: &str) -> Option<&'static str> {
    nearest(name, GALLERY.iter().map(|scene| scene.name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{AuthoredRegistry, Scene};

    #[test]
    fn every_built_in_scene_is_a_scene() {
        for scene in GALLERY {
            let read = Scene::from_text(scene.name, scene.text, &AuthoredRegistry::built_in());
            read.and_then(|scene| scene.check(16 << 30)).unwrap_or_else(|error| panic!("{}: {error}", scene.name));
        }
    }
}
