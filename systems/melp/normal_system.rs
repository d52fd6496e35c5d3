//! The implicit part of the films' normal motion: contacts that yield, and gas that answers.
//!
//! # Equation
//! `[M + J^T Y J + sum_r K_r d^2 N_r N_r^T] s = b`: inertia `M` of every carrier, yielding `Y` of every gap (`Y_i = d a_i (c + d phi'')`,
//! damping and stiffness over a substep `d`), `J` from speeds along normals to rates of gaps ([`Contacts`]), gas stiffness
//! `K_r = -dp/dV` of every region with the areas `N_r` of its own carriers.
//!
//! # Discretisation
//! Symmetric and positive definite. Regions have no carrier in common, so inertia and gas together are inverted in closed form (one
//! rank-one system each); that is the preconditioner. Films that touch nothing are solved by it exactly, in one iteration.

use super::contact::Contacts;
use crate::operators::conjugate_gradient::SymmetricSystem;
use crate::rows::reduce::ordered_sum;
use rayon::prelude::*;
use std::ops::Range;

/// Gas of one region, as it stiffens its film.
#[derive(Clone, Debug)]
pub struct GasSpring {
    /// Rows of the region's carriers.
    pub rows: Range<usize>,
    /// `K d^2`, kg/m^4.
    pub stiffness: f64,
}

/// The system; all slices are per carrier.
pub struct NormalSystem<'a> {
    /// Contacts of the carriers.
    pub contacts: &'a Contacts,
    /// Inertia, kg.
    pub mass: &'a [f64],
    /// Areas, m^2.
    pub areas: &'a [f64],
    /// `Y`, kg: 0 where there is no contact. Empty where there is none at all.
    pub yielding: &'a [f64],
    /// Gas by region.
    pub gases: &'a [GasSpring],
    /// Diagonal of the whole but for the gas, kg.
    diagonal: Vec<f64>,
    /// For each gas, `K d^2 / (1 + K d^2 sum a^2/D)`.
    answers: Vec<f64>,
}

impl<'a> NormalSystem<'a> {
    /// The system of these parts.
    #[must_use]
    pub fn new(
        contacts: &'a Contacts,
        mass: &'a [f64],
        areas: &'a [f64],
        yielding: &'a [f64],
        gases: &'a [GasSpring],
    ) -> Self {
        let diagonal: Vec<f64> = (0..mass.len())
            .into_par_iter()
            .with_min_len(512)
            .map(|i| mass[i] + if yielding.is_empty() { 0.0 } else { contacts.yielding_on(i, yielding) })
            .collect();
        let answer = |gas: &GasSpring| {
            let start = gas.rows.start;
            let mobility = ordered_sum(gas.rows.len(), 0.0, |k| areas[start + k].powi(2) / diagonal[start + k]);
            gas.stiffness / (1.0 + gas.stiffness * mobility)
        };
        let answers = gases.iter().map(answer).collect();
        Self { contacts, mass, areas, yielding, gases, diagonal, answers }
    }

    /// `sum a x` over the rows of a gas.
    fn flux(&self, gas: &GasSpring, x: impl Fn(usize) -> f64 + Sync) -> f64 {
        let start = gas.rows.start;
        ordered_sum(gas.rows.len(), 0.0, |k| self.areas[start + k] * x(start + k))
    }
}

impl SymmetricSystem for NormalSystem<'_> {
    fn multiply(&self, x: &[f64], image: &mut [f64]) {
        let per_row = |image: &mut [f64], value: &(dyn Fn(usize) -> f64 + Sync)| {
            image.par_iter_mut().enumerate().with_min_len(512).for_each(|(i, slot)| *slot = value(i));
        };
        if self.yielding.is_empty() {
            per_row(image, &|i| self.mass[i] * x[i]);
        } else {
            let mut yielded = vec![0.0; x.len()];
            per_row(&mut yielded, &|i| match self.yielding[i] {
                0.0 => 0.0,
                y => y * self.contacts.opening(i, x),
            });
            per_row(image, &|i| self.mass[i] * x[i] + self.contacts.pressed(i, &yielded));
        }
        for gas in self.gases {
            let pressure = gas.stiffness * self.flux(gas, |i| x[i]);
            gas.rows.clone().for_each(|i| image[i] += pressure * self.areas[i]);
        }
    }

    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn precondition(&mut self, r: &[f64], corrected: &mut [f64]) {
        corrected.iter_mut().zip(r).zip(&self.diagonal).for_each(|((z, r), d)| *z = r / d);
        for (gas, answer) in self.gases.iter().zip(&self.answers) {
            let pressure = answer * self.flux(gas, |i| r[i] / self.diagonal[i]);
            gas.rows.clone().for_each(|i| corrected[i] -= pressure * self.areas[i] / self.diagonal[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operators::conjugate_gradient::{StopRule, Workspace, solve_system};

    #[test]
    fn gas_at_one_atmosphere_is_solved_in_one_iteration_and_keeps_the_volume() {
        let count = 500;
        let (areas, mass) = (vec![1e-5; count], vec![2e-7; count]);
        let gases = [GasSpring { rows: 0..200, stiffness: 1e3 }, GasSpring { rows: 200..count, stiffness: 4e3 }];
        let contacts = Contacts::default();
        let system = NormalSystem::new(&contacts, &mass, &areas, &[], &gases);
        let b: Vec<f64> = (0..count).map(|i| 1e-7 * (1.0 + (0.3 * i as f64).cos())).collect();
        let (mut x, stop) = (vec![0.0; count], StopRule { tolerance: 1e-9, max_iterations: 3 });
        let info = solve_system(system, &b, &mut x, stop, &mut Workspace::default()).expect("solved");
        assert_eq!(info.iterations, 1);
        for gas in &gases {
            let flux: f64 = gas.rows.clone().map(|i| areas[i] * x[i]).sum();
            let free: f64 = gas.rows.clone().map(|i| areas[i] * b[i] / mass[i]).sum();
            let mobility = gas.rows.len() as f64 * areas[0] * areas[0] / mass[0];
            assert!((flux / (free / (1.0 + gas.stiffness * mobility)) - 1.0).abs() < 1e-9, "{flux:e}");
        }
    }
}
