//! How much of a proposed motion films can take before the mesh has to be mended.
//!
//! A stable step may still carry a vertex of a fast rim so far that a face beside it goes flat. Stability does not see that, nor does a
//! limit on speed: a film that moves as a whole keeps its faces.
//!
//! # Equation
//! Face `f` with least angle `a` keeps its shape at the part `s` of the way, `x + s (proposed - x)`, as long as its least angle there
//! is at least `min(0.98 a, 21 degrees)`: remeshing leaves 25 degrees where it can. [`even_part`] is the largest `s`, at most 1,
//! up to which all faces do.
//!
//! # Use
//! A step of `dt` whose proposal keeps shapes for a part `s < 1` alone is proposed again for `s dt`, and the mesh mended before the rest
//! of the time. [`LEAST_PART`] bounds the number of pieces: where films close on purpose, time goes on.

use glam::DVec3;

use crate::corners::{angles, has_angle_below};
use crate::policy::Policy;
use crate::surface::Surface;

/// Part of its least angle that a face keeps where that is not enough, dimensionless.
const KEPT: f64 = 0.98;
/// No step is cut into pieces shorter than this part of it, dimensionless.
pub const LEAST_PART: f64 = 1.0 / 16.0;
/// To how much of itself the part is known, dimensionless.
const HALVINGS: u32 = 6;

/// Largest part of the way to `proposed` (per vertex, metres) on which every film keeps its shape, 0 to 1.
///
/// # Panics
/// When `proposed` is not one place per vertex.
#[must_use]
pub fn even_part(surface: &Surface, proposed: &[DVec3]) -> f64 {
    assert_eq!(proposed.len(), surface.positions.len(), "one proposed place per vertex");
    let square = Policy::NARROW_ANGLE.tan().powi(2);
    let films = surface.mesh.faces().filter(|(_, face)| !face.is_ghost());
    let moved = films.map(|(row, face)| (row, face.vertices().map(|v| proposed[v.index()])));
    let narrow = moved.filter(|(_, corners)| has_angle_below(*corners, square));
    narrow.fold(1.0, |part, (row, corners)| {
        let from = surface.corners(row);
        even_part_of(from, [0, 1, 2].map(|i| corners[i] - from[i]), part)
    })
}

/// The same of one face, at most `most`.
fn even_part_of(from: [DVec3; 3], ways: [DVec3; 3], most: f64) -> f64 {
    let at = |part: f64| [0, 1, 2].map(|i| from[i] + ways[i] * part);
    let kept = Policy::NARROW_ANGLE.min(KEPT * least(from));
    if least(at(most)) >= kept {
        return most;
    }
    let (mut even, mut thin) = (0.0, most);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (even + thin);
        if least(at(middle)) >= kept { even = middle } else { thin = middle }
    }
    even
}

fn least(corners: [DVec3; 3]) -> f64 {
    angles(corners).into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::icosphere;

    fn sphere() -> Surface {
        Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.3))
    }

    #[test]
    fn films_that_move_turn_or_grow_as_a_whole_keep_their_shapes() {
        let surface = sphere();
        let turn = glam::DMat3::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), 0.1);
        let proposed: Vec<DVec3> = surface.positions.iter().map(|x| turn * *x * 1.5 + DVec3::X).collect();
        assert_eq!(even_part(&surface, &proposed), 1.0);
    }

    #[test]
    fn films_that_are_flattened_keep_their_shapes_part_of_the_way() {
        let surface = sphere();
        let flat: Vec<DVec3> = surface.positions.iter().map(|x| DVec3::new(x.x, x.y, 0.05 * x.z)).collect();
        let part = even_part(&surface, &flat);
        let least_at = |part: f64| {
            let at = |v: crate::VertexRow| surface.positions[v].lerp(flat[v.index()], part);
            let films = surface.mesh.faces().map(|(_, face)| least(face.vertices().map(at)));
            films.fold(f64::INFINITY, f64::min)
        };
        assert!((0.1..0.95).contains(&part), "{part}");
        assert!(least_at(part) >= Policy::NARROW_ANGLE);
        assert!(least_at(part + 0.05) < Policy::NARROW_ANGLE);
    }

    #[test]
    fn a_thin_face_may_lose_a_part_of_its_angle_and_no_more() {
        let from = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 0.1, 0.0)];
        let ways = [DVec3::ZERO, DVec3::ZERO, DVec3::new(0.0, -0.05, 0.0)];
        let part = even_part_of(from, ways, 1.0);
        assert!((part - 0.04).abs() < 0.02, "{part}");
    }
}
