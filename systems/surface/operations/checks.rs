//! What a plan is refused for: films in the way, bad shapes, turned faces, lost volume, tangled sectors.

use glam::DVec3;
use smallvec::SmallVec;

use super::{Plan, Session};
use crate::corners::angles;
use crate::grid::Aabb;
use crate::kernel::crossing::{point_in_tetrahedron, segment_pierces_triangle, triangles_cross};
use crate::mesh::Face;
use crate::policy::Policy;
use crate::rows::{FaceRow, Region, VertexRow};
use crate::sectors::Sectors;
use crate::surface::Surface;

/// Worst shape among some faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    /// Smallest area, m^2.
    pub(super) area: f64,
    /// Smallest angle, radians.
    pub(super) least_angle: f64,
    /// Largest angle, radians.
    pub(super) largest_angle: f64,
}

impl Shape {
    const PERFECT: Self = Self { area: f64::INFINITY, least_angle: f64::INFINITY, largest_angle: 0.0 };

    fn with(self, corners: [DVec3; 3]) -> Self {
        let angles = angles(corners);
        Self {
            area: self.area.min(area(corners)),
            least_angle: angles.iter().copied().fold(self.least_angle, f64::min),
            largest_angle: angles.iter().copied().fold(self.largest_angle, f64::max),
        }
    }

    pub(super) fn of(corners: impl IntoIterator<Item = [DVec3; 3]>) -> Self {
        corners.into_iter().fold(Self::PERFECT, Self::with)
    }

    /// Whether these shapes are within bounds, or no worse than `before`.
    fn is_acceptable_after(&self, before: &Self, edge: f64) -> bool {
        self.area >= before.area.min(Policy::LEAST_AREA * edge * edge)
            && self.least_angle >= before.least_angle.min(Policy::LEAST_ANGLE)
            && self.largest_angle <= before.largest_angle.max(Policy::LARGEST_ANGLE)
    }
}

/// Area of a triangle, m^2.
pub(super) fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// Per corner of a triangle: whether its angle is below 3 degrees. By its tangent, twice the area over the product of its sides.
pub(super) fn narrow_corners([a, b, c]: [DVec3; 3]) -> [bool; 3] {
    let double = (b - a).cross(c - a).length_squared();
    let least = Policy::LEAST_ANGLE.tan();
    [(a, b, c), (b, c, a), (c, a, b)].map(|(at, p, q)| {
        let along = (p - at).dot(q - at);
        along > 0.0 && double < least * least * along * along
    })
}

/// Whether the angles at `c` and `d`, opposite to `(a, b)`, add up to more than 180 degrees and a margin (radians).
///
/// By sine and cosine of their sum: `sin < 0` and, where `cos < 0`, `tan > margin`.
pub(super) fn add_up_to_more_than_half_a_turn([a, b, c, d]: [DVec3; 4], margin: f64) -> bool {
    let parts = |apex: DVec3| {
        let (p, q) = (a - apex, b - apex);
        (p.cross(q).length(), p.dot(q))
    };
    let ((sine_c, cosine_c), (sine_d, cosine_d)) = (parts(c), parts(d));
    let sine = sine_c * cosine_d + cosine_c * sine_d;
    let cosine = cosine_c * cosine_d - sine_c * sine_d;
    sine < margin.tan() * cosine.min(0.0)
}

impl Session<'_> {
    /// Whether films are in the way of a plan: a face of new shape crosses another, a vertex lies in what is swept, or a vertex
    /// goes through a face.
    ///
    /// The three tests suffice: whatever enters the volume swept by a star has to leave it through the old or the new faces, or end
    /// inside, or span it from rim to rim, so that the way of the star's vertex goes through it.
    pub(super) fn is_blocked(&mut self, plan: &Plan) -> bool {
        let shaped: SmallVec<[(Face, [DVec3; 3]); 32]> = plan
            .shaped(self.surface)
            .filter(|(face, _)| !face.is_ghost())
            .map(|(face, _)| (face, plan.corners(self.surface, &face)))
            .collect();
        let crosses =
            |a: &(Face, [DVec3; 3]), b: &(Face, [DVec3; 3])| triangles_cross(a.0.vertices(), a.1, b.0.vertices(), b.1);
        let blocked = (0..shaped.len()).any(|i| shaped[..i].iter().any(|other| crosses(other, &shaped[i])))
            || shaped.iter().any(|face| self.crosses_rest(plan, face.0, face.1))
            || self.sweeps_over_vertex(plan)
            || self.goes_through_face(plan)
            || self.inverts_speck(plan);
        self.counts.blocked += u64::from(blocked);
        blocked
    }

    /// Whether a face of new shape crosses one that the plan leaves alone.
    fn crosses_rest(&mut self, plan: &Plan, face: Face, corners: [DVec3; 3]) -> bool {
        let found: SmallVec<[FaceRow; 64]> = SmallVec::from_slice(self.near(Aabb::of(&corners)));
        let stays = |row: &FaceRow| !plan.removed.contains(row) && !plan.reshaped.contains(row);
        found.into_iter().filter(stays).any(|row| {
            let other = self.surface.mesh.face(row);
            triangles_cross(face.vertices(), corners, other.vertices(), self.surface.corners(row))
        })
    }

    fn sweeps_over_vertex(&mut self, plan: &Plan) -> bool {
        let Some(reach) = swept_box(self.surface, plan) else { return false };
        let found: SmallVec<[FaceRow; 64]> = SmallVec::from_slice(self.near(reach));
        let mut vertices: SmallVec<[VertexRow; 64]> =
            found.into_iter().flat_map(|row| self.surface.mesh.face(row).vertices()).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let places = |v: VertexRow| self.surface.positions[v];
        plan.sweeps.iter().any(|sweep| {
            let corners = [places(sweep.vertex), sweep.to, places(sweep.base[0]), places(sweep.base[1])];
            let reach = Aabb::of(&corners);
            let is_other = |v: &VertexRow| {
                *v != sweep.vertex && !sweep.base.contains(v) && !plan.moved.iter().any(|(moved, _)| moved == v)
            };
            let inside = |v: VertexRow| reach.contains(places(v)) && point_in_tetrahedron(places(v), corners);
            vertices.iter().copied().filter(is_other).any(inside)
        })
    }

    /// Whether a vertex that moves goes through a face; vertices that moved before it, and their faces, are out of its way.
    fn goes_through_face(&mut self, plan: &Plan) -> bool {
        let mut ways: SmallVec<[(VertexRow, DVec3); 4]> = plan.sweeps.iter().map(|s| (s.vertex, s.to)).collect();
        ways.dedup();
        (0..ways.len()).any(|i| {
            let (from, to) = (self.surface.positions[ways[i].0], ways[i].1);
            let found: SmallVec<[FaceRow; 64]> = SmallVec::from_slice(self.near(Aabb::of(&[from, to])));
            let in_way = |row: &FaceRow| !ways[..=i].iter().any(|(v, _)| self.surface.mesh.face(*row).has(*v));
            let mut faces = found.into_iter().filter(in_way);
            faces.any(|row| segment_pierces_triangle(from, to, self.surface.corners(row)))
        })
    }

    /// Whether a closed region of a few films would be turned inside out: its films share so many vertices that none crosses another.
    fn inverts_speck(&self, plan: &Plan) -> bool {
        let changes = plan.volume_changes(self.surface);
        changes.into_iter().filter(|(region, change)| *change < 0.0 && !self.surface.is_open(*region)).any(
            |(region, change)| {
                let Some(films) = self.films_of_speck(plan, region) else { return false };
                let is_left = films.iter().any(|row| !plan.removed.contains(row));
                let ends = !is_left && plan.added.iter().all(|added| !added.face.borders(region));
                let volume = self.volume_within(&films, region);
                // A negative volume is the hole around another region.
                !ends && volume > 0.0 && volume + change <= 0.0
            },
        )
    }

    /// All films of a region that hang together with those of a plan, if they are few.
    fn films_of_speck(&self, plan: &Plan, region: Region) -> Option<SmallVec<[FaceRow; 32]>> {
        const FEW: usize = 32;
        let mesh = &self.surface.mesh;
        let borders = |row: &FaceRow| mesh.face(*row).borders(region);
        let mut films: SmallVec<[FaceRow; 32]> =
            plan.removed.iter().chain(&plan.reshaped).copied().filter(borders).collect();
        let mut done = 0;
        while done < films.len() {
            for vertex in mesh.face(films[done]).vertices() {
                for row in mesh.faces_of(vertex).iter().filter(|row| borders(row)) {
                    if !films.contains(row) {
                        films.push(*row);
                    }
                }
            }
            if films.len() > FEW {
                return None;
            }
            done += 1;
        }
        (!films.is_empty()).then_some(films)
    }

    /// Volume of a region out of all its films, m^3.
    fn volume_within(&self, films: &[FaceRow], region: Region) -> f64 {
        let origin = self.surface.corners(films[0])[0];
        let part = |row: &FaceRow| {
            let [a, b, c] = self.surface.corners(*row).map(|x| x - origin);
            let part = a.dot(b.cross(c)) / 6.0;
            if self.surface.mesh.face(*row).labels()[0] == region { part } else { -part }
        };
        films.iter().map(part).sum()
    }

    /// Whether the faces of a plan are of acceptable shape, or no worse than what they replace.
    pub(super) fn is_well_shaped(&self, plan: &Plan) -> bool {
        let old = plan.removed.iter().chain(&plan.reshaped).map(|row| self.surface.corners(*row));
        let new = plan.shaped(self.surface).map(|(face, _)| plan.corners(self.surface, &face));
        Shape::of(new).is_acceptable_after(&Shape::of(old), self.edge())
    }

    /// Whether a face of the plan turns by more than a right angle.
    pub(super) fn turns_over(&self, plan: &Plan) -> bool {
        plan.shaped(self.surface).any(|(face, origin)| {
            let Some(origin) = origin else { return false };
            let (old, new) = (self.surface.mesh.face(origin), face);
            let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
            let sides_kept = same_winding(&old, &new);
            let turn = normal(self.surface.corners(origin)).dot(normal(plan.corners(self.surface, &new)));
            turn * sides_kept < 0.0
        })
    }

    /// Whether some region's volume changes by more than an operation may.
    pub(super) fn loses_volume(&self, plan: &Plan) -> bool {
        self.changes_volume(plan, Policy::LARGEST_VOLUME_CHANGE)
    }

    /// Whether some region's volume changes by more than this many `L^3`.
    pub(super) fn changes_volume(&self, plan: &Plan, most: f64) -> bool {
        let most = most * self.edge().powi(3);
        plan.volume_changes(self.surface).iter().any(|(_, change)| change.abs() > most)
    }

    /// Whether a vertex that was not tangled becomes so, or films of a junction come to lie so flat on each other that rounding would
    /// decide their order; looks at what the plan touches.
    pub(super) fn tangles(&self, plan: &Plan) -> bool {
        plan.touched(self.surface).into_iter().any(|v| {
            let after = self.sectors_after(plan, v);
            if !after.is_tangled() && after.narrowest() >= Policy::LEAST_WEDGE {
                return false;
            }
            let existed = v.index() < self.surface.mesh.vertex_rows();
            let before = existed.then(|| self.sectors(v));
            after.is_tangled() && !before.as_ref().is_some_and(Sectors::is_tangled)
                || after.narrowest()
                    < before.map_or(f64::INFINITY, |before| before.narrowest()).min(Policy::LEAST_WEDGE)
        })
    }
}

/// `+1` if the stored windings of two faces that differ in one vertex agree, `-1` if not, judged by their labels and by the vertices
/// they share.
fn same_winding(old: &Face, new: &Face) -> f64 {
    let shared: SmallVec<[VertexRow; 3]> = old.vertices().into_iter().filter(|v| new.has(*v)).collect();
    match shared.as_slice() {
        [a, b] => f64::from(old.direction(*a, *b) * new.direction(*a, *b)),
        _ => 1.0,
    }
}

fn swept_box(surface: &Surface, plan: &Plan) -> Option<Aabb> {
    let corner = |sweep: &super::Sweep| {
        [surface.positions[sweep.vertex], sweep.to, surface.positions[sweep.base[0]], surface.positions[sweep.base[1]]]
    };
    let points: SmallVec<[DVec3; 64]> = plan.sweeps.iter().flat_map(corner).collect();
    (!points.is_empty()).then(|| Aabb::of(&points))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use proptest::prelude::*;

    use super::*;

    fn points() -> impl Strategy<Value = [DVec3; 4]> {
        let point = (prop::array::uniform2(-1.0..1.0f64), prop_oneof![Just(1.0), Just(0.02)]);
        prop::array::uniform4(point.prop_map(|([x, y], flat)| DVec3::new(x, y * flat, 0.3 * x * y)))
    }

    proptest! {
        #[test]
        fn narrow_corners_are_those_whose_angle_is_below_three_degrees(x in points()) {
            let corners = [x[0], x[1], x[2]];
            for (angle, is_narrow) in angles(corners).into_iter().zip(narrow_corners(corners)) {
                prop_assert!((angle < Policy::LEAST_ANGLE) == is_narrow || (angle - Policy::LEAST_ANGLE).abs() < 1e-9);
            }
        }

        #[test]
        fn opposite_angles_are_added_without_taking_angles([a, b, c, d] in points()) {
            let sum = angles([c, a, b])[0] + angles([d, a, b])[0];
            let margin = 1e-6;
            prop_assert!(
                (sum > PI + margin) == add_up_to_more_than_half_a_turn([a, b, c, d], margin)
                    || (sum - PI - margin).abs() < 1e-9
                    || sum > 2.0 * PI - 1e-9
            );
        }
    }
}
