//! Turns edges until the two angles opposite each of them add up to at most 180 degrees.
//!
//! ```text
//!      c               c          Only inside a film: two faces with the same regions on the same sides. An edge stays where
//!     / \             /|\         the four vertices bend by more than 60 degrees, where the other diagonal would fold a
//!    a---b    -->    a | b        face over, and where it is an edge already.
//!     \ /             \|/
//!      d               d
//! ```

use std::collections::BTreeMap;

use glam::DVec3;
use smallvec::SmallVec;

use super::wired::sorted;
use crate::surface::LabelledTriangles;

/// How often all edges are looked at; on curved films turning could go round in a circle.
const PASSES: usize = 8;
/// Angles this far over 180 degrees (radians) turn an edge.
const SLACK: f64 = 1e-6;

type FacesOf = BTreeMap<[u32; 2], SmallVec<[u32; 3]>>;

/// Turns edges of films, ghosts left alone; gives how many.
pub fn turn_edges(set: &mut LabelledTriangles) -> usize {
    let mut faces_of = FacesOf::new();
    for (face, [a, b, c]) in (0..).zip(&set.triangles) {
        [sorted(*a, *b), sorted(*b, *c), sorted(*c, *a)]
            .iter()
            .for_each(|e| faces_of.entry(*e).or_default().push(face));
    }
    let mut turned = 0;
    for _ in 0..PASSES {
        let edges: Vec<[u32; 2]> = faces_of.keys().copied().collect();
        let in_pass = edges.into_iter().filter(|edge| turn(set, &mut faces_of, *edge)).count();
        turned += in_pass;
        if in_pass == 0 {
            break;
        }
    }
    turned
}

/// Turns one edge if it should be; gives whether it was.
fn turn(set: &mut LabelledTriangles, faces_of: &mut FacesOf, edge: [u32; 2]) -> bool {
    let Some([first, second]) = faces_of.get(&edge).and_then(|faces| <[u32; 2]>::try_from(faces.as_slice()).ok())
    else {
        return false;
    };
    // Seen so that the first face has a -> b.
    let [mut a, mut b] = edge;
    if !has_directed(set.triangles[first as usize], a, b) {
        (a, b) = (b, a);
    }
    let [c, d] = [first, second].map(|face| opposite(set.triangles[face as usize], edge));
    let is_inside = is_same_film(set, first, second) && has_directed(set.triangles[second as usize], b, a);
    if !is_inside
        || c == d
        || faces_of.contains_key(&sorted(c, d))
        || !is_better([a, b, c, d].map(|v| set.positions[v as usize]))
    {
        return false;
    }
    set.triangles[first as usize] = [c, a, d];
    set.triangles[second as usize] = [d, b, c];
    faces_of.remove(&edge);
    faces_of.insert(sorted(c, d), SmallVec::from_slice(&[first, second]));
    for (outer, from, to) in [(sorted(b, c), first, second), (sorted(a, d), second, first)] {
        let faces = faces_of.get_mut(&outer).expect("invariant: edges of a face are listed");
        faces.iter_mut().filter(|face| **face == from).for_each(|face| *face = to);
    }
    true
}

fn is_same_film(set: &LabelledTriangles, first: u32, second: u32) -> bool {
    let [first, second] = [first as usize, second as usize];
    set.labels[first] == set.labels[second] && !set.ghosts[first] && !set.ghosts[second]
}

fn has_directed(triangle: [u32; 3], a: u32, b: u32) -> bool {
    (0..3).any(|k| triangle[k] == a && triangle[(k + 1) % 3] == b)
}

fn opposite(triangle: [u32; 3], edge: [u32; 2]) -> u32 {
    triangle.into_iter().find(|v| !edge.contains(v)).unwrap_or(triangle[0])
}

/// Whether `c d` is the better diagonal of the quadrangle `a d b c`.
fn is_better([a, b, c, d]: [DVec3; 4]) -> bool {
    let angles = (a - c).angle_between(b - c) + (a - d).angle_between(b - d);
    if !(angles > std::f64::consts::PI + SLACK) {
        return false;
    }
    let normal = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).normalize_or_zero();
    let (old, new) = ([normal(a, b, c), normal(b, a, d)], [normal(c, a, d), normal(d, b, c)]);
    let is_flat = old[0].dot(old[1]) > 0.5;
    is_flat && new.iter().all(|n| old.iter().all(|o| n.dot(*o) > 0.5))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::measure::{checked, smallest_angle};
    use crate::shapes::{cube, icosphere};

    #[test]
    fn a_sphere_pulled_along_its_surface_gets_better_and_stays_closed() {
        let mut set = icosphere(DVec3::ZERO, 1.0, 0.15);
        for x in &mut set.positions {
            *x = (*x + DVec3::new(0.0, 0.0, 0.6)).normalize();
            *x = DVec3::new(x.x, x.y + 0.5 * x.x * x.z, x.z).normalize();
        }
        let before = smallest_angle(&set);
        assert!(turn_edges(&mut set) > 0);
        checked(&set);
        assert!(smallest_angle(&set) >= before, "{before} {}", smallest_angle(&set));
        assert_eq!(turn_edges(&mut set), 0, "a second time there is nothing to do");
    }

    #[test]
    fn a_cube_keeps_its_edges() {
        let mut set = cube(DVec3::ZERO, 1.0, 0.2);
        turn_edges(&mut set);
        let surface = checked(&set);
        assert!((surface.volumes()[1] - 1.0).abs() < 1e-14);
    }
}
