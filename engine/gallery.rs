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
