//! Films to begin with: bubbles, clusters, foams, and films on wires.
//!
//! Every generator gives [`LabelledTriangles`](crate::LabelledTriangles) with gas regions numbered from 1, labels that fit and
//! edges of about the length asked for (metres).
//!
//! | file | what | exact in |
//! |---|---|---|
//! | [`sphere`] | spheres, ellipsoids, separate spheres in a grid | vertices on the surface |
//! | [`block`] | a cube; a block of cubes with shared walls | shape |
//! | [`kelvin`] | truncated octahedra | shape |
//! | [`double_bubble`](mod@double_bubble) | two bubbles at rest | vertices on the surface |
//! | [`cluster`] | three and four equal bubbles at rest | vertices on the surface |
//! | [`open_film`] | a disc, a rectangle, a dome on a plate | shape; vertices on the surface |
//! | [`catenoid`](mod@catenoid) | a film between two rings | vertices on the surface |
//! | [`frame`](mod@frame) | Plateau's frames | topology of the films |
//! | [`packing`](mod@packing) | random foams | flat walls |
//!
//! [`label_interface`] makes films between any labels of space. They stand on [`wired`] (coarse triangles refined), [`rings`] (films of revolution) [`fairing`] and [`flips`] (even triangles).

pub mod block;
pub mod catenoid;
pub mod cluster;
pub mod double_bubble;
pub mod fairing;
pub mod flips;
pub mod frame;
pub mod kelvin;
pub mod label_interface;
#[cfg(test)]
pub(crate) mod measure;
pub mod open_film;
pub mod packing;
pub mod random;
pub mod rings;
pub mod sphere;
pub mod wired;

pub use block::{cube, lattice};
pub use catenoid::catenoid;
pub use cluster::{quadruple_bubble, triple_bubble};
pub use double_bubble::{DoubleBubble, double_bubble};
pub use frame::{Frame, frame};
pub use kelvin::kelvin_cells;
pub use open_film::{disc, half_sphere, hexagon, rectangle};
pub use packing::packing;
pub use sphere::{ellipsoid, icosphere, sphere_lattice};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::validate;
    use crate::surface::LabelledTriangles;
    use glam::DVec3;

    /// One of every kind, of extent `scale` about the origin.
    fn all(scale: f64) -> Vec<(&'static str, LabelledTriangles)> {
        let (at, edge) = (DVec3::ZERO, 0.4 * scale);
        let up = DVec3::new(0.3, 1.0, 0.2);
        vec![
            ("sphere", icosphere(at, scale, edge)),
            ("ellipsoid", ellipsoid(at, scale * DVec3::new(1.0, 0.8, 0.6), edge)),
            ("two spheres", sphere_lattice([2, 1, 1], scale, 0.04 * scale, edge)),
            ("cube", cube(at, scale, edge)),
            ("lattice", lattice(at, [2, 2, 1], scale, edge)),
            ("kelvin", kelvin_cells(at, scale, 2, edge)),
            ("disc", disc(at, scale, up, edge)),
            ("rectangle", rectangle(at, 2.0 * scale, scale, up, DVec3::Z, edge)),
            ("dome", half_sphere(at, scale, up, edge)),
            ("double bubble", double_bubble(at, up, scale, 0.6 * scale, edge)),
            ("triple bubble", triple_bubble(at, up, scale, edge)),
            ("quadruple bubble", quadruple_bubble(at, scale, edge)),
            ("catenoid", catenoid(at, up, scale, 1.2 * scale, edge)),
            ("cylinder", catenoid(at, up, scale, 1.5 * scale, edge)),
            ("tetrahedron frame", frame(Frame::Tetrahedron, at, scale, 0.5 * edge)),
            ("cube frame", frame(Frame::Cube, at, scale, 0.5 * edge)),
            ("octahedron frame", frame(Frame::Octahedron, at, scale, 0.5 * edge)),
            ("packing", packing(at, 3, scale, 0.3, 1, edge)),
        ]
    }

    #[test]
    fn no_shape_crosses_itself_ghosts_included() {
        for (name, set) in all(1.0) {
            assert_eq!(measure::crossings(&set), 0, "{name}");
        }
    }

    #[test]
    fn shapes_are_sound_and_the_same_at_every_scale() {
        // Powers of two: scaling by them is exact.
        let (small, middle, large) = (all(2f64.powi(-20)), all(1.0), all(2f64.powi(20)));
        for ((name, middle), (small, large)) in middle.iter().zip(small.iter().zip(&large)) {
            for (_, set) in [small, large] {
                assert!(validate(set).is_ok(), "{name}: {:?}", validate(set));
                assert_eq!(set.triangles, middle.triangles, "{name}");
            }
            assert!(validate(middle).is_ok(), "{name}");
        }
    }
}
