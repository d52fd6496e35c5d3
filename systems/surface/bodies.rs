//! Bodies of gas: which parts of a region hang together, and new labels for parts that came apart.
//!
//! A neck that closes leaves one label on two bodies of gas. They must not share a volume constraint, or gas would pass between
//! them through nothing. Face sides that look at each other around an edge belong to the same shell; a shell that encloses
//! positive volume is the outer boundary of a body, one of negative volume that of a hole in one.
//! Limits: a hole is given to the body whose shell winds around its first corner.

use glam::DVec3;

use crate::calculus::solid_angle::solid_angle;
use crate::links::Links;
use crate::rows::{FaceRow, Region};
use crate::sectors::facing_sides;
use crate::surface::Surface;

/// A connected piece of the boundary of a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Shell {
    /// The region on its inner side.
    pub region: Region,
    /// Its faces, ascending, and which side of each: false the back, true the front.
    pub sides: Vec<(FaceRow, bool)>,
    /// Volume it encloses, m^3; negative for the boundary of a hole.
    pub volume: f64,
    /// Whether ghosts are part of it.
    pub has_ghosts: bool,
}

/// A body of gas that took a label of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Division {
    /// The region it was part of.
    pub from: Region,
    /// Its own label.
    pub to: Region,
    /// Its volume, m^3.
    pub volume: f64,
    /// What is left of the region it was part of, m^3; negative for the outside.
    pub rest: f64,
    /// A place on its boundary, metres.
    pub place: DVec3,
}

/// The shells of all regions, by region and first face.
#[must_use]
pub fn shells(surface: &Surface) -> Vec<Shell> {
    let mut sides = Links::new(2 * surface.mesh.face_rows());
    for [a, b] in surface.mesh.edges() {
        for (after, before) in facing_sides(&surface.mesh, [a, b], &|v| surface.positions[v]) {
            sides.join(after, before);
        }
    }
    let mut shell_of_root: Vec<Option<usize>> = vec![None; 2 * surface.mesh.face_rows()];
    let mut shells: Vec<Shell> = Vec::new();
    for (row, face) in surface.mesh.faces() {
        for side in [false, true] {
            let root = sides.root(2 * row.index() + usize::from(side));
            let place = *shell_of_root[root].get_or_insert_with(|| {
                let region = face.labels()[usize::from(side)];
                shells.push(Shell { region, sides: Vec::new(), volume: 0.0, has_ghosts: false });
                shells.len() - 1
            });
            shells[place].sides.push((row, side));
            shells[place].has_ghosts |= face.is_ghost();
        }
    }
    shells.iter_mut().for_each(|shell| shell.volume = enclosed(surface, shell));
    shells.sort_by_key(|shell| (shell.region, shell.sides[0]));
    shells
}

/// Volume inside a shell, from one of its own corners: far from the origin a sum would lose digits.
fn enclosed(surface: &Surface, shell: &Shell) -> f64 {
    let origin = surface.corners(shell.sides[0].0)[0];
    let part = |(row, is_front): &(FaceRow, bool)| {
        let [a, b, c] = surface.corners(*row).map(|x| x - origin);
        a.dot(b.cross(c)) / if *is_front { -6.0 } else { 6.0 }
    };
    shell.sides.iter().map(part).sum()
}

/// Gives every body of gas that came apart from its region a label of its own, from `next` on, which is moved on.
///
/// The largest body of a closed region keeps the label. Of an open region and of the outside, whatever ghosts close or nothing
/// does keeps it: a bubble that pinches off from a wand becomes a closed region.
pub fn divide(surface: &mut Surface, next: &mut Region) -> Vec<Division> {
    let shells = shells(surface);
    let mut divisions = Vec::new();
    for of_region in shells.chunk_by(|a, b| a.region == b.region) {
        let region = of_region[0].region;
        let mut leaving: Vec<&Shell> =
            of_region.iter().filter(|shell| shell.volume > 0.0 && !shell.has_ghosts).collect();
        if !surface.is_open(region) {
            let bodies = of_region.iter().filter(|shell| shell.volume > 0.0);
            let Some(largest) = bodies.max_by(|a, b| a.volume.total_cmp(&b.volume)) else { continue };
            leaving.retain(|shell| shell.sides[0] != largest.sides[0]);
        }
        let mut rest: f64 = of_region.iter().map(|shell| shell.volume).sum();
        for body in leaving {
            let holes = of_region.iter().filter(|hole| hole.volume < 0.0 && is_inside(surface, hole, body));
            let parts: Vec<&Shell> = std::iter::once(body).chain(holes).collect();
            let volume = parts.iter().map(|part| part.volume).sum();
            rest -= volume;
            parts.iter().for_each(|part| relabel(surface, part, *next));
            divisions.push(Division {
                from: region,
                to: *next,
                volume,
                rest,
                place: surface.corners(body.sides[0].0)[0],
            });
            next.0 += 1;
        }
    }
    divisions
}

fn relabel(surface: &mut Surface, shell: &Shell, region: Region) {
    for (row, is_front) in &shell.sides {
        let face = surface.mesh.face(*row);
        let mut labels = face.labels();
        labels[usize::from(*is_front)] = region;
        surface.mesh.set_labels(*row, labels);
    }
}

/// Whether a hole lies inside a body: its first corner is wound around once by the body's shell.
fn is_inside(surface: &Surface, hole: &Shell, body: &Shell) -> bool {
    let corners = surface.corners(hole.sides[0].0);
    let point = corners.iter().sum::<DVec3>() / 3.0;
    let winding = |(row, is_front): &(FaceRow, bool)| {
        let angle = solid_angle(surface.corners(*row).map(|x| x - point));
        if *is_front { -angle } else { angle }
    };
    body.sides.iter().map(winding).sum::<f64>() > std::f64::consts::TAU
}
