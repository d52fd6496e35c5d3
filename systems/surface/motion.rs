//! Moves vertices without letting films pass through each other: every vertex goes as far along its proposed way as is safe.
//!
//! # Discretisation
//! Given places without crossings and proposed places, fractions `alpha` per vertex are sought such that no vertex comes nearer
//! than a gap to a face, and no edge to another edge, on the way from `x` to `x + alpha (proposed - x)`.
//! 1. Gather all faces that could fold over (`motion/faces.rs`), and limit their vertices as below. Where all move wildly, this
//!    leaves ways shorter than faces, that few others cross.
//! 2. Gather all stencils of four vertices that some choice of fractions up to those could bring together (`motion/stencils.rs`).
//! 3. Round by round: where a stencil meets at time `t < 1`, its free vertices get at most `0.8 t` of what they had. Stencils whose
//!    vertices kept their fractions stay clear and are not looked at again.
//! 4. After [`MotionSettings::scaling_rounds`], the connected patch of limited vertices around a hit is halved as a whole; after
//!    twice as many, vertices of a hit stay where they are. All at rest is safe, so this ends.
//!
//! Stencils include those between faces that share a vertex or an edge; only a face by itself needs a guard of its own.
//! Pinned vertices are carried by wires and follow their proposals. Where the free vertices of a stencil are at rest already and
//! it still meets, the motion as a whole is cut short of the meeting: truncating all ways at one time keeps every other stencil clear.
//!
//! # Limits
//! Two vertices of one stencil limit each other even if one of them flees: fractions are safe, not the largest possible.
//! The result does not depend on the number of threads.

use std::collections::VecDeque;

use glam::DVec3;
use rayon::prelude::*;

use crate::rows::VertexRow;
use crate::surface::Surface;

mod crossings;
mod faces;
mod stencils;
#[cfg(test)]
mod tests;

pub use crossings::find_crossings;
use faces::Guard;
use stencils::Stencil;

/// Part of the way to a meeting that is gone.
const SAFETY: f64 = 0.8;
/// Elements below which threads cost more than they give; also the elements of one piece of parallel work.
const CHUNK: usize = 2048;

/// How far vertices may go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSettings {
    /// Target edge length `L`, metres.
    pub edge: f64,
    /// Distance that is kept where it is there, metres: `1e-3 L`. Nearer pairs keep half of theirs.
    pub gap: f64,
    /// Rounds of scaling vertex by vertex before patches are halved; twice that before vertices are stopped.
    pub scaling_rounds: usize,
    /// Whether ghost faces collide. They are no films: by default they do not.
    pub ghosts_collide: bool,
}

impl MotionSettings {
    /// Settings for edges of about `edge` metres.
    #[must_use]
    pub const fn new(edge: f64) -> Self {
        Self { edge, gap: 1e-3 * edge, scaling_rounds: 6, ghosts_collide: false }
    }
}

/// What became of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct MotionReport {
    /// Free vertices that went less far than [`Self::pinned_fraction`] of their proposed way.
    pub limited_vertices: usize,
    /// Least fraction of its proposed way that a free vertex went; 1 if all went all the way; dimensionless.
    pub least_fraction: f64,
    /// Fraction of their proposed way that pinned vertices went; dimensionless. Below 1 the motion as a whole was cut,
    /// and the rest of the step is still to be done.
    pub pinned_fraction: f64,
    /// Rounds of checks, 1 if nothing met.
    pub rounds: usize,
    /// Stencils that could have met, and were looked at closely.
    pub stencils: usize,
}

/// Moves the vertices of a surface without crossings towards `proposed` (per vertex, metres), and leaves it without crossings.
///
/// # Panics
/// When `proposed` is not one place per vertex.
pub fn advance(surface: &mut Surface, proposed: &[DVec3], settings: &MotionSettings) -> MotionReport {
    assert_eq!(proposed.len(), surface.positions.len(), "one proposed place per vertex");
    let shift: Vec<DVec3> = proposed.iter().zip(surface.positions.iter()).map(|(to, from)| *to - *from).collect();
    let mut limiter = Limiter::new(surface, &shift, settings);
    let guards = stencils::guards(surface, &shift, settings);
    let folding = (1..=settings.scaling_rounds).take_while(|round| limiter.round(*round, &[], &guards)).count();
    let stencils = stencils::gather(surface, &limiter.ways(), settings);
    limiter.changed.fill(true);
    let meeting = (1..).take_while(|round| limiter.round(*round, &stencils, &guards)).count();
    let rounds = 1 + folding + meeting;
    let Limiter { fractions, pinned_fraction, .. } = limiter;
    let mut report =
        MotionReport { limited_vertices: 0, least_fraction: 1.0, pinned_fraction, rounds, stencils: stencils.len() };
    for v in (0..shift.len()).filter(|v| shift[*v] != DVec3::ZERO) {
        let is_whole = fractions[v] == 1.0;
        surface.positions.0[v] = if is_whole { proposed[v] } else { surface.positions.0[v] + shift[v] * fractions[v] };
        if !surface.pinned.0[v] {
            report.limited_vertices += usize::from(fractions[v] < pinned_fraction);
            report.least_fraction = report.least_fraction.min(fractions[v]);
        }
    }
    report
}

/// Vertices that meet or fold at a time of the motion as it is; the last may be there twice.
struct Hit {
    vertices: [VertexRow; 4],
    time: f64,
}

/// Fractions of the proposed ways while they are sought.
struct Limiter<'a> {
    surface: &'a Surface,
    shift: &'a [DVec3],
    settings: &'a MotionSettings,
    /// Per vertex, pinned ones too.
    fractions: Vec<f64>,
    /// Per vertex: whether the last round changed the fraction in a way that may bring stencils together.
    changed: Vec<bool>,
    pinned_fraction: f64,
}

impl<'a> Limiter<'a> {
    fn new(surface: &'a Surface, shift: &'a [DVec3], settings: &'a MotionSettings) -> Self {
        let count = shift.len();
        let (fractions, changed) = (vec![1.0; count], vec![true; count]);
        Self { surface, shift, settings, fractions, changed, pinned_fraction: 1.0 }
    }

    /// Checks what has changed, and limits what meets; whether anything did.
    fn round(&mut self, round: usize, stencils: &[Stencil], guards: &[Guard]) -> bool {
        let mut hits = in_chunks(stencils, |stencil| self.meeting(stencil));
        hits.extend(in_chunks(guards, |guard| self.folding(guard)));
        if hits.is_empty() {
            return false;
        }
        let mut next = self.fractions.clone();
        let mut cut = 1.0f64;
        for hit in &hits {
            self.limit(hit, round, &mut next, &mut cut);
        }
        if (self.settings.scaling_rounds + 1..=2 * self.settings.scaling_rounds).contains(&round) {
            self.halve_patches(&hits, &mut next);
        }
        for ((own, changed), next) in self.fractions.iter_mut().zip(&mut self.changed).zip(next) {
            *changed = next != *own;
            *own = next * cut;
        }
        self.pinned_fraction *= cut;
        true
    }

    /// Ways as far as they are open yet, metres, per vertex.
    fn ways(&self) -> Vec<DVec3> {
        self.shift.iter().zip(&self.fractions).map(|(shift, fraction)| *shift * *fraction).collect()
    }

    fn moved(&self, v: VertexRow) -> DVec3 {
        self.shift[v.index()] * self.fractions[v.index()]
    }

    fn has_changed(&self, vertices: &[VertexRow]) -> bool {
        vertices.iter().any(|v| self.changed[v.index()])
    }

    fn meeting(&self, stencil: &Stencil) -> Option<Hit> {
        let vertices = stencil.vertices;
        if !self.has_changed(&vertices) {
            return None;
        }
        let x = vertices.map(|v| self.surface.positions[v]);
        let time = stencil.impact(x, vertices.map(|v| self.moved(v)), self.settings.gap)?;
        Some(Hit { vertices, time })
    }

    fn folding(&self, guard: &Guard) -> Option<Hit> {
        let [a, b, c] = guard.vertices;
        if !self.has_changed(&guard.vertices) {
            return None;
        }
        let x = guard.vertices.map(|v| self.surface.positions[v]);
        let time = faces::folding_time(x, guard.vertices.map(|v| self.moved(v)))?;
        Some(Hit { vertices: [a, b, c, c], time })
    }

    /// Limits the free vertices of a hit; where they are at rest, the motion as a whole.
    fn limit(&self, hit: &Hit, round: usize, next: &mut [f64], cut: &mut f64) {
        let free = hit.vertices.iter().filter(|v| !self.surface.pinned[**v] && self.moved(**v) != DVec3::ZERO);
        let factor = if round > 2 * self.settings.scaling_rounds { 0.0 } else { SAFETY * hit.time };
        let mut is_limited = false;
        for v in free.map(|v| v.index()) {
            next[v] = next[v].min(factor * self.fractions[v]);
            is_limited = true;
        }
        if !is_limited {
            *cut = cut.min(SAFETY * hit.time);
        }
    }

    /// Halves the fractions of all limited vertices that are connected to a hit through limited vertices.
    fn halve_patches(&self, hits: &[Hit], next: &mut [f64]) {
        let is_limited = |v: VertexRow| self.fractions[v.index()] < self.pinned_fraction && !self.surface.pinned[v];
        let mut is_seen = vec![false; next.len()];
        let mut queue: VecDeque<VertexRow> = hits.iter().flat_map(|hit| hit.vertices).collect();
        while let Some(v) = queue.pop_front() {
            if is_seen[v.index()] || !is_limited(v) {
                continue;
            }
            is_seen[v.index()] = true;
            next[v.index()] = next[v.index()].min(0.5 * self.fractions[v.index()]);
            queue.extend(self.surface.mesh.neighbours(v));
        }
    }
}

/// Applies `test` to all items, in fixed pieces on all threads if they are many; answers stay in order.
fn in_chunks<T: Sync, R: Send>(items: &[T], test: impl Fn(&T) -> Option<R> + Sync) -> Vec<R> {
    if items.len() <= CHUNK {
        return items.iter().filter_map(test).collect();
    }
    let parts: Vec<Vec<R>> = items.par_chunks(CHUNK).map(|part| part.iter().filter_map(&test).collect()).collect();
    parts.into_iter().flatten().collect()
}
