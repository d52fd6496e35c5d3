//! Symmetric systems made of pairs: what the implicit solves of a film look like.
//!
//! # Equation
//! `(A x)_i = m_i x_i + sum_j c_ij (x_i - x_j)`, `m_i >= 0`, `c_ij = c_ji >= 0`: positive (semi)definite.

use crate::neighbours::lists::NeighbourLists;
use rayon::prelude::*;

/// A system of pairs; couplings are computed once and used in every iteration.
#[derive(Clone, Debug)]
pub struct PairSystem<'a> {
    /// Who is coupled to whom.
    pub lists: &'a NeighbourLists,
    /// `c_ij`, beside `lists.indices`.
    pub couplings: Vec<f64>,
    /// `m_i`.
    pub reaction: Vec<f64>,
    /// `m_i + sum_j c_ij`.
    pub diagonal: Vec<f64>,
}

impl<'a> PairSystem<'a> {
    /// The system with couplings `coupling(i, j, k)`, `k` being the place of the pair in `lists.indices`.
    #[must_use]
    pub fn new(
        lists: &'a NeighbourLists,
        reaction: Vec<f64>,
        coupling: impl Fn(usize, usize, usize) -> f64 + Sync,
    ) -> Self {
        let mut couplings = vec![0.0; lists.indices.len()];
        lists.pieces_mut(&mut couplings).into_par_iter().for_each(|(rows, piece)| {
            let places = rows.flat_map(|i| lists.range(i).map(move |k| (i, k)));
            let values = places.map(|(i, k)| coupling(i, lists.indices[k] as usize, k));
            piece.iter_mut().zip(values).for_each(|(slot, value)| *slot = value);
        });
        let sum = |i: usize| reaction[i] + couplings[lists.range(i)].iter().sum::<f64>();
        let diagonal = (0..lists.len()).into_par_iter().with_min_len(512).map(sum).collect();
        Self { lists, couplings, reaction, diagonal }
    }

    /// Number of unknowns.
    #[must_use]
    pub fn len(&self) -> usize {
        self.diagonal.len()
    }

    /// Whether there are no unknowns.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.diagonal.is_empty()
    }

    /// `(j, c_ij)` over the neighbours of `i`.
    #[inline]
    pub fn pairs(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.lists.range(i);
        let couplings = self.couplings[range.clone()].iter().copied();
        self.lists.indices[range].iter().map(|&j| j as usize).zip(couplings)
    }

    /// `(A x)_i`.
    #[must_use]
    #[inline]
    pub fn row(&self, x: &[f64], i: usize) -> f64 {
        self.diagonal[i] * x[i] - self.pairs(i).map(|(j, c)| c * x[j]).sum::<f64>()
    }
}
