//! A multigrid cycle as preconditioner: iterations hardly grow with the number of particles.
//!
//! # Equation
//! One symmetric V-cycle for `A x = b`: smooth, correct by the coarse system, smooth. An unknown of the coarse system
//! stands for an aggregate of fine ones, with `m_I = sum m_i` and `c_IJ = sum c_ij / stiffness`.
//!
//! # Discretisation
//! Aggregates are neighbourhoods of strongly coupled rows, found greedily in row order. A function that is constant on
//! aggregates costs more energy than the smooth one it stands for; `stiffness` is by how much, measured on the
//! coordinates: `sum c_ij |X_I - X_J|^2 / sum c_ij |x_i - x_j|^2`. The fine level is smoothed by damped Jacobi in
//! parallel, coarse ones by Gauss-Seidel to and fro, in row order: the bits do not depend on the number of threads.
//!
//! # Source
//! Vanek, Mandel and Brezina 1996 (aggregates); Braess 1995 (the factor on the coarse system).
//!
//! # Limits
//! A preconditioner only: the factor is right for smooth couplings, and elsewhere costs iterations, not accuracy.

use super::pair_system::PairSystem;
use crate::neighbours::lists::NeighbourLists;
use glam::DVec3;
use rayon::prelude::*;

/// Damping of Jacobi sweeps; below 1, since an eigenvalue of `D^-1 A` may reach 2.
const DAMPING: f64 = 0.9;
/// Couplings weaker than this part of a row's strongest do not make an aggregate.
const STRONG: f64 = 0.25;
/// Systems this small are not made coarser.
const SMALL: usize = 40;
/// Gauss-Seidel sweeps to and fro on the coarsest level.
const COARSEST_SWEEPS: usize = 8;
/// Most levels.
const MOST_LEVELS: usize = 12;

/// A coarse system with its work space.
#[derive(Clone, Debug)]
struct Level {
    lists: NeighbourLists,
    couplings: Vec<f64>,
    diagonal: Vec<f64>,
    /// The row of the next level that each row belongs to; empty on the coarsest.
    aggregates: Vec<u32>,
    x: Vec<f64>,
    b: Vec<f64>,
}

/// The coarse systems under a [`PairSystem`].
#[derive(Clone, Debug)]
pub struct Multigrid {
    /// The coarse row of each fine row.
    aggregates: Vec<u32>,
    /// The fine rows of each coarse row.
    members: NeighbourLists,
    levels: Vec<Level>,
    smoothed: Vec<f64>,
}

impl Multigrid {
    /// Makes the coarse systems. `places` are where the unknowns stand.
    #[must_use]
    pub fn new(system: &PairSystem, places: impl Iterator<Item = DVec3>) -> Self {
        let mut places: Vec<DVec3> = places.collect();
        let fine = System { lists: system.lists, couplings: &system.couplings, reaction: &system.reaction };
        let aggregates = fine.aggregates();
        let members = members(&aggregates);
        let mut levels = Vec::new();
        let mut coarse = fine.coarser(&aggregates, &members, &mut places);
        loop {
            let system = System { lists: &coarse.0, couplings: &coarse.1, reaction: &coarse.2 };
            let is_coarsest = system.reaction.len() <= SMALL || levels.len() + 1 == MOST_LEVELS;
            let aggregates = if is_coarsest { Vec::new() } else { system.aggregates() };
            let members = self::members(&aggregates);
            let stalls = members.len() == system.reaction.len();
            if is_coarsest || stalls {
                levels.push(Level::new(coarse, Vec::new()));
                break;
            }
            let next = system.coarser(&aggregates, &members, &mut places);
            levels.push(Level::new(std::mem::replace(&mut coarse, next), aggregates));
        }
        Self { aggregates, members, levels, smoothed: vec![0.0; system.len()] }
    }

    /// `z` becomes an approximate solution of `A z = r`, linear and symmetric in `r`.
    pub fn apply(&mut self, system: &PairSystem, r: &[f64], z: &mut [f64]) {
        let Self { aggregates, members, levels, smoothed } = self;
        let relaxed = |i: usize| if system.diagonal[i] > 0.0 { DAMPING / system.diagonal[i] } else { 0.0 };
        smoothed.par_iter_mut().enumerate().with_min_len(4096).for_each(|(i, s)| *s = relaxed(i) * r[i]);
        let residual = |i: u32| r[i as usize] - system.row(smoothed, i as usize);
        let first = &mut levels[0];
        first.b.par_iter_mut().enumerate().with_min_len(32).for_each(|(aggregate, b)| {
            *b = members.of(aggregate).iter().map(|&i| residual(i)).sum();
        });
        cycle(levels);
        let correction = &levels[0].x;
        smoothed.par_iter_mut().zip(&*aggregates).with_min_len(4096).for_each(|(s, &a)| *s += correction[a as usize]);
        z.par_iter_mut().enumerate().with_min_len(512).for_each(|(i, z)| {
            *z = smoothed[i] + relaxed(i) * (r[i] - system.row(smoothed, i));
        });
    }
}

/// One V-cycle on the coarse levels: sets `x` of the first from its `b`.
fn cycle(levels: &mut [Level]) {
    let Some((level, coarser)) = levels.split_first_mut() else { return };
    level.x.fill(0.0);
    if coarser.is_empty() {
        for _ in 0..COARSEST_SWEEPS {
            level.sweep(true);
            level.sweep(false);
        }
        return;
    }
    level.sweep(true);
    coarser[0].b.fill(0.0);
    for (i, &aggregate) in level.aggregates.iter().enumerate() {
        coarser[0].b[aggregate as usize] += level.b[i] - level.diagonal[i] * level.x[i] + level.pull(i);
    }
    cycle(coarser);
    for (x, &aggregate) in level.x.iter_mut().zip(&level.aggregates) {
        *x += coarser[0].x[aggregate as usize];
    }
    level.sweep(false);
}

impl Level {
    fn new((lists, couplings, reaction): Coarse, aggregates: Vec<u32>) -> Self {
        let count = reaction.len();
        let diagonal = (0..count).map(|i| reaction[i] + couplings[lists.range(i)].iter().sum::<f64>()).collect();
        Self { lists, couplings, diagonal, aggregates, x: vec![0.0; count], b: vec![0.0; count] }
    }

    /// `sum_j c_ij x_j`.
    fn pull(&self, i: usize) -> f64 {
        let range = self.lists.range(i);
        let near = self.lists.indices[range.clone()].iter().zip(&self.couplings[range]);
        near.map(|(&j, c)| c * self.x[j as usize]).sum()
    }

    /// One Gauss-Seidel sweep, in row order or against it.
    fn sweep(&mut self, forward: bool) {
        let count = self.x.len();
        for k in 0..count {
            let i = if forward { k } else { count - 1 - k };
            if self.diagonal[i] > 0.0 {
                self.x[i] = (self.b[i] + self.pull(i)) / self.diagonal[i];
            }
        }
    }
}

/// Lists, couplings and reactions of a coarse system.
type Coarse = (NeighbourLists, Vec<f64>, Vec<f64>);

/// A system to be made coarser.
struct System<'a> {
    lists: &'a NeighbourLists,
    couplings: &'a [f64],
    reaction: &'a [f64],
}

/// A row that belongs to no aggregate yet.
const FREE: u32 = u32::MAX;

impl System<'_> {
    /// The aggregate of each row: first whole neighbourhoods of rows that are still free, then what is left over joins
    /// its strongest neighbour.
    fn aggregates(&self) -> Vec<u32> {
        let count = self.reaction.len();
        let mut aggregates = vec![FREE; count];
        let mut next = 0;
        for i in 0..count {
            let strong = || self.strong(i);
            if aggregates[i] == FREE && strong().all(|j| aggregates[j] == FREE) {
                aggregates[i] = next;
                strong().for_each(|j| aggregates[j] = next);
                next += 1;
            }
        }
        let seeds = aggregates.clone();
        for i in (0..count).filter(|&i| seeds[i] == FREE) {
            let near = self.pairs(i).filter(|&(j, _)| seeds[j] != FREE);
            let strongest = near.max_by(|a, b| a.1.total_cmp(&b.1));
            aggregates[i] = strongest.map_or_else(
                || {
                    next += 1;
                    next - 1
                },
                |(j, _)| seeds[j],
            );
        }
        aggregates
    }

    fn pairs(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.lists.range(i);
        self.lists.indices[range.clone()].iter().map(|&j| j as usize).zip(self.couplings[range].iter().copied())
    }

    fn strong(&self, i: usize) -> impl Iterator<Item = usize> + '_ {
        let least = STRONG * self.couplings[self.lists.range(i)].iter().copied().fold(0.0, f64::max);
        self.pairs(i).filter(move |&(_, c)| c >= least).map(|(j, _)| j)
    }

    /// The system of the aggregates; `places` become their centres.
    fn coarser(&self, aggregates: &[u32], members: &NeighbourLists, places: &mut Vec<DVec3>) -> Coarse {
        let centre = |aggregate: usize| {
            let rows = members.of(aggregate);
            rows.iter().map(|&i| places[i as usize]).sum::<DVec3>() / rows.len() as f64
        };
        let centres: Vec<DVec3> = (0..members.len()).map(centre).collect();
        let softening = 1.0 / self.stiffness(aggregates, places, &centres);
        let mut lists = NeighbourLists { offsets: vec![0], indices: Vec::new() };
        let mut couplings: Vec<f64> = Vec::new();
        // Where the couplings of the present aggregate to each other one stand.
        let mut slots = vec![(FREE, 0); members.len()];
        for aggregate in 0..members.len() {
            for (j, c) in members.of(aggregate).iter().flat_map(|&i| self.pairs(i as usize)) {
                let other = aggregates[j];
                if other as usize == aggregate {
                    continue;
                }
                let slot = &mut slots[other as usize];
                if slot.0 != aggregate as u32 {
                    *slot = (aggregate as u32, couplings.len());
                    lists.indices.push(other);
                    couplings.push(0.0);
                }
                couplings[slot.1] += c * softening;
            }
            lists.offsets.push(couplings.len());
        }
        let reaction = (0..members.len()).map(|a| members.of(a).iter().map(|&i| self.reaction[i as usize]).sum());
        let reaction = reaction.collect();
        *places = centres;
        (lists, couplings, reaction)
    }

    /// Energy of the coordinates as functions that are constant on aggregates, over their own energy; at least 1.
    fn stiffness(&self, aggregates: &[u32], places: &[DVec3], centres: &[DVec3]) -> f64 {
        let centre = |i: usize| centres[aggregates[i] as usize];
        let (mut stepped, mut smooth) = (0.0, 0.0);
        for i in 0..places.len() {
            for (j, c) in self.pairs(i) {
                stepped += c * centre(i).distance_squared(centre(j));
                smooth += c * places[i].distance_squared(places[j]);
            }
        }
        if stepped > smooth { stepped / smooth } else { 1.0 }
    }
}

/// The rows of each aggregate, ascending.
fn members(aggregates: &[u32]) -> NeighbourLists {
    let count = aggregates.iter().max().map_or(0, |&last| last as usize + 1);
    let mut offsets = vec![0; count + 1];
    aggregates.iter().for_each(|&a| offsets[a as usize + 1] += 1);
    for a in 0..count {
        offsets[a + 1] += offsets[a];
    }
    let mut next = offsets.clone();
    let mut indices = vec![0; aggregates.len()];
    for (row, &a) in aggregates.iter().enumerate() {
        indices[next[a as usize]] = row as u32;
        next[a as usize] += 1;
    }
    NeighbourLists { offsets, indices }
}
