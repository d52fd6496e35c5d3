//! What an entity is: marker components.
//!
//! All entities of one kind have one archetype, so their components are contiguous columns addressed by row.

use bevy_ecs::component::Component;

/// A kind of entity that is stored as rows of contiguous columns.
pub trait Kind: Component + Copy + Default {
    /// Stable name, used in checkpoints and messages.
    const NAME: &'static str;
    /// What several of them are called in messages.
    const PLURAL: &'static str;
}

macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident = $label:literal, $plural:literal;)+) => {$(
        $(#[$doc])*
        #[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $name;

        impl Kind for $name {
            const NAME: &'static str = $label;
            const PLURAL: &'static str = $plural;
        }
    )+};
}

kinds! {
    /// Tracks the film and is the stencil on which its equations are solved (Deng 2022, §4). Moves with the film's
    /// normal velocity; its tangential place is free and is kept uniform by redistribution.
    EulerianParticle = "eulerian", "eulerian particles";
    /// Carries liquid, surfactant and momentum with the flow (Deng 2022, §4).
    LagrangianParticle = "lagrangian", "lagrangian particles";
    /// A fixed particle beyond the rim of an open film, which fills the kernels there (Deng 2022, §4.8).
    BoundaryParticle = "boundary", "boundary particles";
    /// A corner of the triangles that a film is made of, where films are meshes; its row is its row in the mesh.
    MeshVertex = "vertex", "mesh vertices";
    /// A gas volume enclosed by films, or the air on one side of an open film.
    Region = "region", "regions";
}
