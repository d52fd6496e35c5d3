//! Evens out triangles: vertices slide to the middle of their neighbours, and stay on what they belong to.
//!
//! A vertex inside a film moves among all its neighbours; one on a border, where three or more regions meet, moves between
//! its two neighbours along that border; ends of borders and held vertices stay. Each sweep goes half of the way.

use std::collections::BTreeMap;

use glam::DVec3;
use smallvec::SmallVec;

use super::flips::turn_edges;
use super::wired::sorted;
use crate::surface::LabelledTriangles;

/// Twice the area of a triangle in squares of its longest edge, from where on it is good: two angles of 27 degrees.
const GOOD: f64 = 0.5;

/// Where a vertex is put back after it has moved, from its place and the regions it touches, ascending.
pub trait Snap: Fn(DVec3, &[u32]) -> DVec3 {}
impl<F: Fn(DVec3, &[u32]) -> DVec3> Snap for F {}

/// Nothing to stay on: smooths the films themselves too.
#[must_use]
pub fn freely(place: DVec3, _regions: &[u32]) -> DVec3 {
    place
}

/// Moves vertices `sweeps` times, one after the other; a move that spoils a triangle is left out.
///
/// Spoilt is a triangle that turns by more than 60 degrees, or is both poor (angles under 27 degrees) and worse than the
/// worst around the vertex was.
pub fn fair(set: &mut LabelledTriangles, sweeps: usize, snap: impl Snap) {
    let moving: Vec<Option<Moving>> = moving_vertices(set);
    let faces_of = faces_of_vertices(set);
    for _ in 0..sweeps {
        for (vertex, (moving, faces)) in moving.iter().zip(&faces_of).enumerate() {
            let Some(Moving { regions, partners }) = moving else { continue };
            let old = set.positions[vertex];
            let middle = partners.iter().map(|v| set.positions[*v as usize]).sum::<DVec3>() / partners.len() as f64;
            let before: Vec<DVec3> = faces.iter().map(|face| shape(set, *face)).collect();
            set.positions[vertex] = snap(old.midpoint(middle), regions);
            if !is_sound(&before, faces.iter().map(|face| shape(set, *face))) {
                set.positions[vertex] = old;
            }
        }
    }
}

/// Normal of a triangle, as long as twice its area in squares of its longest edge: from 0 to 0.87.
fn shape(set: &LabelledTriangles, face: u32) -> DVec3 {
    let [a, b, c] = set.triangles[face as usize].map(|v| set.positions[v as usize]);
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    ((b - a) / longest).cross((c - a) / longest)
}

fn is_sound(before: &[DVec3], after: impl Iterator<Item = DVec3>) -> bool {
    let worst = before.iter().map(|shape| shape.length()).fold(GOOD, f64::min);
    let is_kept = |(old, new): (&DVec3, DVec3)| {
        let length = new.length();
        length >= worst && new.dot(*old) > 0.5 * length * old.length()
    };
    before.iter().zip(after).all(is_kept)
}

fn faces_of_vertices(set: &LabelledTriangles) -> Vec<SmallVec<[u32; 8]>> {
    let mut faces_of = vec![SmallVec::new(); set.positions.len()];
    for (face, triangle) in (0..).zip(&set.triangles) {
        triangle.iter().for_each(|v| faces_of[*v as usize].push(face));
    }
    faces_of
}

/// Turns edges and moves vertices in turn: so many rounds of eight sweeps.
pub fn even_out(set: &mut LabelledTriangles, rounds: usize, snap: impl Snap) {
    for _ in 0..rounds {
        turn_edges(set);
        fair(set, 8, &snap);
    }
    turn_edges(set);
}

struct Moving {
    regions: SmallVec<[u32; 4]>,
    partners: SmallVec<[u32; 8]>,
}

fn insert_sorted<const N: usize>(list: &mut SmallVec<[u32; N]>, value: u32)
where
    [u32; N]: smallvec::Array<Item = u32>,
{
    if let Err(place) = list.binary_search(&value) {
        list.insert(place, value);
    }
}

/// Per vertex: what it touches and the neighbours between which it moves; none where it stays.
fn moving_vertices(set: &LabelledTriangles) -> Vec<Option<Moving>> {
    let mut edges: BTreeMap<[u32; 2], SmallVec<[u32; 4]>> = BTreeMap::new();
    let mut regions = vec![SmallVec::<[u32; 4]>::new(); set.positions.len()];
    for (triangle, labels) in set.triangles.iter().zip(&set.labels) {
        for k in 0..3 {
            let edge = edges.entry(sorted(triangle[k], triangle[(k + 1) % 3])).or_default();
            for label in labels {
                insert_sorted(edge, *label);
                insert_sorted(&mut regions[triangle[k] as usize], *label);
            }
        }
    }
    let mut partners = vec![[SmallVec::<[u32; 8]>::new(), SmallVec::new()]; set.positions.len()];
    for ([a, b], around) in &edges {
        let is_border = usize::from(around.len() > 2);
        for (from, to) in [(*a, *b), (*b, *a)] {
            partners[from as usize][is_border].push(to);
        }
    }
    let vertices = regions.into_iter().zip(partners).zip(&set.pinned);
    vertices.map(|((regions, partners), pinned)| moving(regions, partners, *pinned)).collect()
}

fn moving(regions: SmallVec<[u32; 4]>, partners: [SmallVec<[u32; 8]>; 2], is_held: bool) -> Option<Moving> {
    let [inside, border] = partners;
    match (is_held, regions.len(), border.len()) {
        (false, 2, 0) => Some(Moving { regions, partners: inside }),
        (false, 3, 2) => Some(Moving { regions, partners: border }),
        _ => None,
    }
}
