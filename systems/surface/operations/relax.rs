//! Moves of single vertices for the sake of the angles around them: the films stay, volumes stay exactly.
//!
//! Equation: where one vertex goes by `d`, the volume of region `r` changes by `d . N_r / 3`, `N_r` the sum of the area normals of its
//! faces, outwards from `r`. So a vertex inside a film may go in the plane `d . N = 0`, and one on a curve of three films along
//! `N_r x N_s`, without changing any volume. Junction points and held vertices stay.
//! Discretisation: compass search for the place with the largest least angle of the star, with steps that are halved.
//! Limits: not for vertices with ghosts, and only as long as no face turns away from where it looks.

use glam::DVec3;
use smallvec::{SmallVec, smallvec};

use super::collapse::{Rank, rank};
use super::plan::Plan;
use super::{Session, checks};
use crate::policy::Policy;
use crate::rows::{Region, VertexRow};
use crate::transfer::{Blend, weights_at};

/// Angles that differ by less are taken as equal, radians: rounding must not decide.
const TIE: f64 = 1e-9;
/// The ring of a vertex: per face the two other corners, and its normal as it is.
type Ring = SmallVec<[([DVec3; 2], DVec3); 12]>;

impl Session<'_> {
    /// Moves a vertex within its film or along its curve, if that makes the least angle around it larger by a factor.
    pub(super) fn relax(&mut self, vertex: VertexRow, growth: f64) -> bool {
        let directions = self.free_directions(vertex);
        if directions.is_empty() {
            return false;
        }
        let place = self.best_place(vertex, &directions);
        let Some(plan) = self.plan_move(vertex, place) else { return false };
        if !self.improves(&plan, growth)
            || self.turns_over(&plan)
            || self.loses_volume(&plan)
            || self.tangles(&plan)
            || self.is_blocked(&plan)
        {
            return false;
        }
        self.counts.moves += 1;
        self.commit(&plan);
        true
    }

    /// A move within the film; values are looked up where the vertex arrives. `None` if it stays.
    fn plan_move(&self, vertex: VertexRow, place: DVec3) -> Option<Plan> {
        let parents = weights_at(self.surface, vertex, place - self.surface.positions[vertex])?;
        let mut plan = Plan { blends: smallvec![Blend { vertex, parents }], ..Plan::default() };
        plan.move_vertex(self.surface, vertex, place);
        plan.note_reshaped(self.surface);
        Some(plan)
    }

    /// Unit vectors along which a vertex may go: two inside a film, one on a curve of three films, else none.
    fn free_directions(&self, vertex: VertexRow) -> SmallVec<[DVec3; 2]> {
        let faces = self.surface.mesh.faces_of(vertex);
        let normals = self.outward_normals(vertex);
        if faces.iter().any(|row| self.surface.mesh.face(*row).is_ghost()) {
            return SmallVec::new();
        }
        match (rank(self.surface, vertex), normals.as_slice()) {
            (Rank::Film, [(_, normal), _]) => self.frame_within(vertex, *normal),
            (Rank::Curve, [(_, one), (_, two), _]) => one.cross(*two).try_normalize().into_iter().collect(),
            _ => SmallVec::new(),
        }
    }

    /// Two directions square to a normal, the first towards the nearest neighbour.
    fn frame_within(&self, vertex: VertexRow, normal: DVec3) -> SmallVec<[DVec3; 2]> {
        let x = self.surface.positions[vertex];
        let neighbours = self.surface.mesh.neighbours(vertex);
        let ways = neighbours.into_iter().map(|v| self.surface.positions[v] - x);
        let nearest = ways.min_by(|p, q| p.length_squared().total_cmp(&q.length_squared()));
        let normal = normal.normalize_or_zero();
        let first = nearest.and_then(|way| way.reject_from_normalized(normal).try_normalize());
        first.into_iter().flat_map(|first| [first, normal.cross(first)]).collect()
    }

    /// Per region around a vertex, ascending: the sum of the area normals of its faces, outwards, m^2.
    fn outward_normals(&self, vertex: VertexRow) -> SmallVec<[(Region, DVec3); 4]> {
        let mut sums: SmallVec<[(Region, DVec3); 4]> = SmallVec::new();
        for row in self.surface.mesh.faces_of(vertex) {
            let [back, front] = self.surface.mesh.face(*row).labels();
            let normal = 0.5 * self.surface.double_area_normal(*row);
            for (region, part) in [(back, normal), (front, -normal)] {
                match sums.iter_mut().find(|(other, _)| *other == region) {
                    Some((_, sum)) => *sum += part,
                    None => sums.push((region, part)),
                }
            }
        }
        sums.sort_unstable_by_key(|(region, _)| *region);
        sums
    }

    /// The place with the largest least angle that a compass search finds.
    fn best_place(&self, vertex: VertexRow, directions: &[DVec3]) -> DVec3 {
        let (first, last) = (0.2 * self.edge(), 0.01 * self.edge());
        let compass: SmallVec<[DVec3; 8]> = match directions {
            [u, v] => [(1, 0), (0, 1), (1, 1), (1, -1)]
                .map(|(i, j)| (*u * f64::from(i) + *v * f64::from(j)).normalize())
                .into_iter()
                .flat_map(|way| [way, -way])
                .collect(),
            ways => ways.iter().flat_map(|way| [*way, -*way]).collect(),
        };
        let ring = self.ring(vertex);
        let from = self.surface.positions[vertex];
        let (mut best, mut rating, mut step) = (from, least_angle_at(from, &ring), first);
        while step > last {
            let places = compass.iter().map(|way| best + *way * step);
            let near = places.filter(|place| place.distance(from) <= Policy::LARGEST_MOVE * self.edge());
            let rated = near.map(|place| (least_angle_at(place, &ring), place));
            match rated.reduce(|x, y| if y.0 > x.0 + TIE { y } else { x }).filter(|next| next.0 > rating + TIE) {
                Some(next) => (rating, best) = next,
                None => step *= 0.5,
            }
        }
        best
    }

    fn ring(&self, vertex: VertexRow) -> Ring {
        let x = self.surface.positions[vertex];
        let face = |row: &crate::rows::FaceRow| {
            let [p, q] = self.surface.mesh.face(*row).around(vertex).map(|v| self.surface.positions[v]);
            ([p, q], (p - x).cross(q - x))
        };
        self.surface.mesh.faces_of(vertex).iter().map(face).collect()
    }
}

/// Least angle of a star with its middle at a place, radians; negative where a face would look the other way.
fn least_angle_at(place: DVec3, ring: &Ring) -> f64 {
    let least = ring.iter().map(|([p, q], normal)| {
        let looks_away = (*p - place).cross(*q - place).dot(*normal) <= 0.0;
        if looks_away { -1.0 } else { checks::Shape::of([[place, *p, *q]]).least_angle }
    });
    least.fold(f64::INFINITY, f64::min)
}
