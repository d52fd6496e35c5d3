//! Random operations on small foams, with data on the vertices and every invariant looked at after each.
//!
//! Everything follows from a seed: the same seed gives the same operations, so that a failure is replayed by its seed and number.

#![allow(dead_code, reason = "every test uses another part")]

use std::collections::VecDeque;
use std::fmt::Write as _;

use froth_surface::bodies;
use froth_surface::invariants::{Violation, check_all, check_volumes};
use froth_surface::motion::{MotionSettings, advance};
use froth_surface::operations::{Counts, Mark, Session, contact_candidates, separation_candidates};
use froth_surface::shapes::{catenoid, disc, double_bubble, kelvin_cells, lattice, sphere_lattice};
use froth_surface::transfer::{Amounts, Circulations, Columns, Several, Transfer};
use froth_surface::{FaceRow, LabelledTriangles, PerVertex, Policy, Region, Surface, Tracker, VertexRow};
use glam::DVec3;

use super::voxels::voxels;

/// Random numbers from a seed. Source: Steele, Lea and Flood 2014 (SplitMix).
#[derive(Clone, Debug)]
pub(crate) struct Dice(u64);

impl Dice {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// From 0 up to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() % count.max(1) as u64) as usize
    }

    /// A vector in the cube from -1 to 1.
    pub(crate) fn vector(&mut self) -> DVec3 {
        2.0 * DVec3::new(self.unit(), self.unit(), self.unit()) - DVec3::ONE
    }
}

/// Foams of a few bubbles; `kind` counts up to [`KINDS`]. Gives the target edge length too.
pub(crate) fn small_foam(kind: usize, dice: &mut Dice) -> (LabelledTriangles, f64) {
    let label = |dice: &mut Dice| dice.below(4) as u32;
    match kind {
        0 => (lattice(DVec3::ZERO, [2, 2, 1], 1.0, 0.5), 0.5),
        1 => (sphere_lattice([2, 2, 1], 1.0, 0.02, 0.5), 0.5),
        2 => (double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.4), 0.4),
        3 => (kelvin_cells(DVec3::ZERO, 1.5, 2, 0.6), 0.6),
        4 => (catenoid(DVec3::ZERO, DVec3::Z, 1.0, 1.0, 0.35), 0.35),
        5 => (disc(DVec3::ZERO, 1.0, DVec3::Z, 0.3), 0.3),
        6 => (triple_bubble(), 0.5),
        _ => {
            let labels: Vec<u32> = (0..27).map(|_| label(dice)).collect();
            (voxels([3; 3], 1.0, &labels), 1.0)
        }
    }
}

/// Kinds of [`small_foam`].
pub(crate) const KINDS: usize = 8;

/// Three bubbles around a common line: cubes in an L and one beside both.
fn triple_bubble() -> LabelledTriangles {
    voxels(
        [4, 4, 2],
        0.5,
        &[1, 1, 2, 2, 1, 1, 2, 2, 3, 3, 3, 3, 3, 3, 3, 3, 1, 1, 2, 2, 1, 1, 2, 2, 3, 3, 3, 3, 3, 3, 3, 3],
    )
}

/// What is done to a foam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operation {
    Split,
    FaceSplit,
    Collapse,
    Separate,
    Contact,
    Snap,
    Flip,
    Improve,
    Burst,
    Move,
    Pass,
    CloseUp,
}

/// How often each operation is drawn.
pub(crate) type Weights = [(Operation, u32); 12];

/// Every kind of operation about as often.
pub(crate) const MIXED: Weights = [
    (Operation::Split, 10),
    (Operation::FaceSplit, 4),
    (Operation::Collapse, 40),
    (Operation::Separate, 20),
    (Operation::Contact, 10),
    (Operation::Snap, 8),
    (Operation::Flip, 20),
    (Operation::Improve, 20),
    (Operation::Burst, 1),
    (Operation::Move, 10),
    (Operation::Pass, 3),
    (Operation::CloseUp, 6),
];

/// Few motions and passes, which take long in large foams.
pub(crate) const LOCAL: Weights = [
    (Operation::Split, 180),
    (Operation::FaceSplit, 40),
    (Operation::Collapse, 800),
    (Operation::Separate, 400),
    (Operation::Contact, 100),
    (Operation::Snap, 80),
    (Operation::Flip, 400),
    (Operation::Improve, 200),
    (Operation::Burst, 1),
    (Operation::Move, 30),
    (Operation::Pass, 15),
    (Operation::CloseUp, 30),
];

/// A foam with data on its vertices.
pub(crate) struct Foam {
    pub(crate) surface: Surface,
    pub(crate) policy: Policy,
    pub(crate) marks: PerVertex<Mark>,
    pub(crate) step: u64,
    pub(crate) next_region: Region,
    pub(crate) velocities: Columns,
    pub(crate) liquid: Amounts,
    pub(crate) jumps: Circulations,
    /// Liquid at the start.
    pub(crate) total: f64,
    pub(crate) counts: Counts,
    pub(crate) number: u64,
    pub(crate) log: VecDeque<String>,
}

impl Foam {
    pub(crate) fn new(set: &LabelledTriangles, edge: f64) -> Self {
        let surface = Surface::from_triangles(set);
        let rows = surface.mesh.vertex_rows();
        let next_region = Region(set.region_count());
        let amount = |v: usize| 1.0 + 0.5 * (v as f64).sin();
        let amounts: Vec<f64> = (0..rows).map(amount).collect();
        let jumps = Circulations::new(&surface, |v, i, j| f64::from(v.0) + f64::from(100 * i.0 + j.0));
        Self {
            velocities: Columns::new(3, surface.positions.iter().flat_map(|x| x.to_array()).collect()),
            total: amounts.iter().sum(),
            liquid: Amounts::new(amounts),
            jumps,
            marks: PerVertex::default(),
            step: 1,
            next_region,
            policy: Policy::new(edge),
            counts: Counts::default(),
            number: 0,
            log: VecDeque::new(),
            surface,
        }
    }

    /// One random operation, and what it may have broken looked at; all of it if `thoroughly`.
    ///
    /// # Errors
    /// What does not hold after it.
    pub(crate) fn operate(
        &mut self,
        dice: &mut Dice,
        weights: &Weights,
        thoroughly: bool,
    ) -> Result<Operation, String> {
        self.number += 1;
        let operation = draw(dice, weights);
        let touched = match operation {
            Operation::Move => self.move_films(dice).map(|()| Vec::new()),
            Operation::CloseUp => self.close_up(dice).map(|()| Vec::new()),
            _ => self.edit(operation, dice),
        };
        let touched = touched.map_err(|violation| format!("after {operation:?}: {violation}"))?;
        let is_whole = matches!(operation, Operation::Move | Operation::CloseUp | Operation::Burst | Operation::Pass);
        let data = if thoroughly || is_whole {
            check_all(&self.surface).map_err(|violation| format!("after {operation:?}: {violation}"))?;
            self.check_data(self.surface.mesh.vertices())
        } else {
            self.check_data(touched.into_iter())
        };
        data.map_err(|problem| format!("after {operation:?}: {problem}"))?;
        Ok(operation)
    }

    fn note(&mut self, what: String) {
        if self.log.len() == 400 {
            self.log.pop_front();
        }
        self.log.push_back(format!("{}: {what}", self.number));
    }

    /// An operation in a session of its own; gives the vertices it touched.
    fn edit(&mut self, operation: Operation, dice: &mut Dice) -> Result<Vec<VertexRow>, Violation> {
        let mut data = Several(vec![&mut self.velocities, &mut self.liquid, &mut self.jumps]);
        let policy = Policy { flips: dice.below(2) == 0, ..self.policy };
        let mut session = Session::new(&mut self.surface, &policy, &mut data, &mut self.marks, self.step);
        let dirty: Vec<bool> = session.marks.iter().map(|mark| mark.dirty).collect();
        if operation != Operation::Pass {
            session.marks.iter_mut().for_each(|mark| mark.dirty = false);
        }
        let what = apply(&mut session, operation, dice);
        let rows = (0..session.marks.len() as u32).map(VertexRow);
        let touched: Vec<VertexRow> = rows.filter(|v| session.marks[*v].dirty).collect();
        session.marks.iter_mut().zip(dirty).for_each(|(mark, was)| mark.dirty |= was);
        let holds = session.check_around(&touched);
        let counts = session.counts;
        add(&mut self.counts, &counts);
        self.note(what);
        holds.map(|()| touched)
    }

    /// Liquid stays, and circulations are there for exactly the pairs whose films meet.
    pub(crate) fn check_data(&self, mut vertices: impl Iterator<Item = VertexRow>) -> Result<(), String> {
        let total = self.liquid.values().iter().sum::<f64>() + self.liquid.lost();
        if (total - self.total).abs() > 1e-12 * self.total {
            return Err(format!("liquid {total} of {}", self.total));
        }
        let wrong = |v: &VertexRow| self.jumps.pairs(*v).ne(pairs_at(&self.surface, *v));
        match vertices.find(wrong) {
            Some(v) => {
                let has: Vec<_> = self.jumps.pairs(v).collect();
                Err(format!("{v} has circulations {has:?} for films {:?}", pairs_at(&self.surface, v)))
            }
            None => Ok(()),
        }
    }

    /// Random motion of up to a fifth of `L`, now and then of up to 3 `L`, with a pull towards the neighbours.
    fn move_films(&mut self, dice: &mut Dice) -> Result<(), Violation> {
        let wild = dice.below(8) == 0;
        let reach = self.policy.edge * if wild { 3.0 } else { 0.2 };
        let pull = 0.3 * dice.unit();
        let proposed: Vec<DVec3> = (0..self.surface.mesh.vertex_rows() as u32)
            .map(VertexRow)
            .map(|v| {
                let (x, random) = (self.surface.positions[v], dice.vector());
                if self.surface.pinned[v] || !self.surface.mesh.has_vertex(v) {
                    return x;
                }
                x + reach * random + pull * (middle_of_neighbours(&self.surface, v) - x)
            })
            .collect();
        let report = advance(&mut self.surface, &proposed, &MotionSettings::new(self.policy.edge));
        self.note(format!("Move wild {wild}: {report:?}"));
        self.step += 1;
        check_volumes(&self.surface)
    }

    /// Labels for what came apart, and no vacant rows.
    fn close_up(&mut self, _: &mut Dice) -> Result<(), Violation> {
        let divisions = bodies::divide(&mut self.surface, &mut self.next_region);
        let mut data = Several(vec![&mut self.velocities, &mut self.liquid, &mut self.jumps]);
        data.divide(&self.surface, &divisions);
        let remap = self.surface.compact();
        self.marks.resize(remap.vertices.len(), Mark { dirty: true, ..Mark::default() });
        self.marks = remap.carry(&self.marks);
        data.compact(&remap);
        self.note(format!("CloseUp: {} divisions", divisions.len()));
        Ok(())
    }

    /// Bubbles that are left.
    pub(crate) fn bubbles(&self) -> usize {
        self.surface.mesh.regions().len().saturating_sub(1)
    }

    /// The last operations, one a line.
    pub(crate) fn history(&self) -> String {
        self.log.iter().fold(String::new(), |mut text, line| {
            let _ = writeln!(text, "{line}");
            text
        })
    }
}

fn draw(dice: &mut Dice, weights: &Weights) -> Operation {
    let whole: u32 = weights.iter().map(|(_, weight)| weight).sum();
    let mut left = dice.below(whole as usize) as u32;
    for (operation, weight) in weights {
        if left < *weight {
            return *operation;
        }
        left -= weight;
    }
    unreachable!("weights add up")
}

fn apply(session: &mut Session<'_>, operation: Operation, dice: &mut Dice) -> String {
    let Some((row, [a, b])) = any_edge(session.surface, dice) else { return format!("{operation:?}: no faces") };
    match operation {
        Operation::Split => {
            let t = dice.unit();
            let place = session.surface.positions[a].lerp(session.surface.positions[b], t);
            let is_long = session.length(a, b) > 0.5 * session.edge();
            let done = if is_long { session.split(a, b, t, place) } else { None };
            format!("Split {a} {b} {t}: {done:?}")
        }
        Operation::FaceSplit => {
            let (s, t) = (dice.unit(), dice.unit());
            let weights = if s + t < 1.0 { [s, t, 1.0 - s - t] } else { [1.0 - s, 1.0 - t, s + t - 1.0] };
            let is_large = session.surface.area(row) > 0.2 * session.edge().powi(2);
            let done = if is_large { session.split_face(row, weights) } else { None };
            format!("FaceSplit {row} {weights:?}: {done:?}")
        }
        Operation::Collapse => {
            let edges = (0..12).filter_map(|_| any_edge(session.surface, dice)).map(|(_, edge)| edge);
            let shortest = edges.min_by(|x, y| session.length(x[0], x[1]).total_cmp(&session.length(y[0], y[1])));
            let [a, b] = if dice.below(4) == 0 { [a, b] } else { shortest.unwrap_or([a, b]) };
            format!("Collapse {a} {b}: {:?}", session.collapse(a, b))
        }
        Operation::Separate => {
            let vertices = (0..40).filter_map(|_| any_edge(session.surface, dice)).map(|(_, [a, _])| a);
            let vertices: Vec<VertexRow> = vertices.collect();
            let v = vertices.into_iter().find(|v| !separation_candidates(session.surface, *v).is_empty()).unwrap_or(a);
            format!("Separate {v}: {}", session.separate(v))
        }
        Operation::Contact => {
            let vertices = (0..40).filter_map(|_| any_edge(session.surface, dice)).map(|(_, [v, _])| v);
            let vertices: Vec<VertexRow> = vertices.collect();
            let mut meeting = vertices.into_iter().filter(|v| !contact_candidates(session.surface, *v).is_empty());
            let Some(v) = meeting.next() else { return "Contact: none".to_owned() };
            // As if an edge had just shrunk to it: then the film is preferred.
            session.marks[v].squeezed = session.marks[v].separated + 1;
            format!("Contact {v}: {}", session.separate(v))
        }
        Operation::Snap => {
            let near = nearest_stranger(session.surface, a);
            let near = near.filter(|v| session.length(a, *v) < 0.6 * session.edge());
            let done = near.and_then(|v| session.snap_vertices(a, v));
            format!("Snap {a} {near:?}: {done:?}")
        }
        Operation::Flip => format!("Flip {a} {b}: {:?}", session.flip(a, b)),
        Operation::Improve => {
            let faces: Vec<FaceRow> =
                (0..12).filter_map(|_| any_edge(session.surface, dice)).map(|(row, _)| row).collect();
            let done = faces.into_iter().find(|row| session.improve_face(*row));
            format!("Improve: {done:?}")
        }
        Operation::Burst => {
            let [mut gone, mut into] = session.surface.mesh.face(row).labels();
            if gone == Region::OUTSIDE {
                (gone, into) = (into, gone);
            }
            format!("Burst {gone} {into}: {:?}", session.burst(gone, into))
        }
        _ => {
            match dice.below(6) {
                0 => _ = session.snap_films(),
                1 => session.split_long_edges(),
                2 => session.collapse_short_edges(),
                3 => _ = session.flip_edges(),
                4 => session.improve_faces(),
                _ => _ = session.separate_vertices(),
            }
            format!("Pass {:?}", session.counts)
        }
    }
}

/// A random edge of a random face.
fn any_edge(surface: &Surface, dice: &mut Dice) -> Option<(FaceRow, [VertexRow; 2])> {
    if surface.mesh.face_count() == 0 {
        return None;
    }
    loop {
        let row = FaceRow(dice.below(surface.mesh.face_rows()) as u32);
        if let Some(face) = surface.mesh.get(row) {
            let corner = face.vertices()[dice.below(3)];
            let [a, b] = [corner, face.around(corner)[dice.below(2)]];
            return Some((row, [a, b]));
        }
    }
}

/// The nearest vertex that shares no edge with a vertex.
fn nearest_stranger(surface: &Surface, vertex: VertexRow) -> Option<VertexRow> {
    let x = surface.positions[vertex];
    let strangers = surface.mesh.vertices().filter(|v| *v != vertex && !surface.mesh.has_edge(*v, vertex));
    let by_distance = strangers.map(|v| (surface.positions[v].distance_squared(x), v));
    by_distance.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, v)| v)
}

fn middle_of_neighbours(surface: &Surface, vertex: VertexRow) -> DVec3 {
    let neighbours = surface.mesh.neighbours(vertex);
    neighbours.iter().map(|v| surface.positions[*v]).sum::<DVec3>() / neighbours.len() as f64
}

/// Pairs of regions whose films meet at a vertex.
pub(crate) fn pairs_at(surface: &Surface, vertex: VertexRow) -> Vec<[Region; 2]> {
    let labels = surface.mesh.faces_of(vertex).iter().map(|row| surface.mesh.face(*row).labels());
    let mut pairs: Vec<[Region; 2]> = labels.map(|[i, j]| [i.min(j), i.max(j)]).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

fn add(sum: &mut Counts, part: &Counts) {
    sum.splits += part.splits;
    sum.face_splits += part.face_splits;
    sum.collapses += part.collapses;
    sum.separations += part.separations;
    sum.snaps += part.snaps;
    sum.flips += part.flips;
    sum.bursts += part.bursts;
    sum.blocked += part.blocked;
}

/// Motions of up to 3 `L` in random directions, each followed by a whole remeshing pass; gives the mean part of limited vertices.
///
/// # Errors
/// What does not hold after a motion or a pass, or a motion in which nothing moves.
pub(crate) fn wild_motions(
    foam: &mut Foam,
    tracker: &mut Tracker,
    dice: &mut Dice,
    motions: u64,
) -> Result<f64, String> {
    let mut limited = 0.0;
    let policy = Policy { flips: true, ..foam.policy };
    for _ in 0..motions {
        foam.number += 1;
        let number = foam.number;
        let shift = |x: &DVec3, dice: &mut Dice| *x + 3.0 * foam.policy.edge * dice.vector().normalize_or_zero();
        let proposed: Vec<DVec3> = foam.surface.positions.iter().map(|x| shift(x, dice)).collect();
        let before = foam.surface.positions.clone();
        let report = advance(&mut foam.surface, &proposed, &MotionSettings::new(policy.edge));
        limited += report.limited_vertices as f64 / before.len() as f64;
        check_all(&foam.surface).map_err(|violation| format!("after motion {number}, {report:?}: {violation}"))?;
        let moved: f64 = before.iter().zip(foam.surface.positions.iter()).map(|(x, y)| x.distance(*y)).sum();
        if !(moved / before.len() as f64 > 1e-4 * policy.edge) {
            return Err(format!("motion {number} stood still: {report:?}"));
        }
        let mut data = Several(vec![&mut foam.velocities, &mut foam.liquid, &mut foam.jumps]);
        let done = tracker.remesh(&mut foam.surface, &policy, &mut data);
        foam.note(format!("motion {number}: {report:?} {:?}", done.counts));
        check_all(&foam.surface).map_err(|violation| format!("after pass {number}: {violation}"))?;
        foam.check_data(foam.surface.mesh.vertices())?;
    }
    Ok(limited / motions.max(1) as f64)
}
