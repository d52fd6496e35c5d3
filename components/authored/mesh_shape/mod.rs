//! Shapes that only a mesh can take: films that share walls ([`bubbles`], [`foam`]), that hang between wires ([`framed`]),
//! that have edges, and meshes from a file ([`file`](mod@file)).
//!
//! Each knows its area and its hull, [`Measured`], before any vertex is made. Regions are numbered over the whole scene: those of the
//! first entity with a film come first, from 1, each shape's own in the order its type documents. The air at an open film, which
//! a rim sets apart from the outside, is a region too.

pub mod bubbles;
pub mod file;
pub mod foam;
pub mod framed;

use glam::DVec3;

pub use bubbles::{Cube, DoubleBubble, QuadrupleBubble, TripleBubble, TwoRadii};
pub use file::{MeshContent, MeshFile};
pub use foam::{Counts, KelvinCells, Lattice, Packing, SphereLattice};
pub use framed::{Catenoid, FrameKind, WireFrame};

use super::film_shape::Parts;

/// What is known of a shape before it is made.
pub trait Measured {
    /// Centre, metres.
    fn centre(&self) -> DVec3;

    /// Size that relative amplitudes and noise frequencies refer to, metres: about the radius of its largest bubble.
    fn size(&self) -> f64;

    /// Area of all films, square metres, a shared wall counted once. Within 10 % where not said otherwise.
    fn area(&self) -> f64;

    /// Length of the pinned rims, metres.
    fn rim(&self) -> f64 {
        0.0
    }

    /// Points whose convex hull is the shape's hull, metres.
    fn outline(&self) -> Vec<DVec3>;

    /// Directions across films that are flat at the start; none where all are curved or lie at random.
    fn flat_normals(&self) -> Vec<DVec3> {
        Vec::new()
    }

    /// Number of bubbles; of films between wires, 1.
    fn bubbles(&self) -> u64 {
        1
    }

    /// Vertices that it brings along, however coarse the resolution.
    fn own_vertices(&self) -> u64 {
        0
    }

    /// Whether its films enclose gas volumes by themselves.
    fn is_closed(&self) -> bool {
        true
    }
}

macro_rules! mesh_shapes {
    ($($(#[$doc:meta])* $shape:ident,)*) => {
        /// Any one shape that takes a mesh.
        #[derive(Clone, Debug, PartialEq)]
        #[non_exhaustive]
        pub enum MeshShape {
            $($(#[$doc])* $shape($shape),)*
        }

        impl MeshShape {
            /// Names of the shape components, as scene files write them.
            pub const NAMES: [&str; [$(stringify!($shape)),*].len()] = [$(stringify!($shape)),*];

            /// The shape among the components of an entity, if it has one.
            #[must_use]
            pub fn of(entity: &impl Parts) -> Option<Self> {
                $(if let Some(shape) = entity.part::<$shape>() {
                    return Some(Self::$shape(shape.clone()));
                })*
                None
            }

            /// What is known of it before it is made.
            #[must_use]
            pub fn measured(&self) -> &dyn Measured {
                match self {
                    $(Self::$shape(shape) => shape,)*
                }
            }
        }
    };
}

mesh_shapes! {
    /// A closed cube.
    Cube,
    /// Two bubbles that share a wall.
    DoubleBubble,
    /// Three bubbles that share three walls.
    TripleBubble,
    /// Four bubbles that share six walls.
    QuadrupleBubble,
    /// A block of Kelvin's cells.
    KelvinCells,
    /// A block of cubes.
    Lattice,
    /// Spheres on a lattice, apart from each other.
    SphereLattice,
    /// A random foam.
    Packing,
    /// A film between two rings.
    Catenoid,
    /// The films that a frame of wire holds.
    WireFrame,
    /// A mesh from a file.
    MeshFile,
}

/// The eight corners of a box, metres.
pub(super) fn corners(centre: DVec3, sides: DVec3) -> Vec<DVec3> {
    let side = |corner: u32, axis: u32| f64::from(corner >> axis & 1) - 0.5;
    (0..8).map(|corner| centre + sides * DVec3::from_array([0, 1, 2].map(|axis| side(corner, axis)))).collect()
}
