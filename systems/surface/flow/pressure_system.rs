//! The system between pressures and volumes: how much each pressure changes each volume.
//!
//! # Equation
//! `S_ij = Σ_v ∂V_i/∂x_v · ∂V_j/∂x_v / m_v` over the free vertices: symmetric, and positive definite as long as every set
//! of regions can change its volume as a whole.
//!
//! # Discretisation
//! Entries exist for regions that share a vertex. Up to [`MOST_DENSE`] regions Cholesky's factorisation, above it
//! conjugate gradients with the diagonal as preconditioner.

use glam::DVec3;
use smallvec::SmallVec;

use super::error::FlowError;
use crate::calculus::Incidence;

/// Up to this many regions the system is factorised as a dense matrix.
pub const MOST_DENSE: usize = 200;

/// A pivot below this part of its diagonal means a singular system, dimensionless.
const SMALLEST_PIVOT: f64 = 1e-12;

/// The system, laid out for one connectivity.
#[derive(Clone, Debug, Default)]
pub struct PressureSystem {
    /// Pairs `[i, j]`, `i <= j`, ascending.
    pairs: Vec<[u32; 2]>,
    /// Per vertex, for each pair of its entries in order, the row in `pairs`.
    slots: Vec<u32>,
    values: Vec<f64>,
    diagonal: Vec<f64>,
    factor: Vec<f64>,
    work: [Vec<f64>; 3],
}

impl PressureSystem {
    /// Lays it out.
    pub fn lay_out(&mut self, incidence: &Incidence) {
        // Per region the higher ones that share a vertex with it, ascending.
        let mut above: Vec<SmallVec<[u32; 16]>> = vec![SmallVec::new(); incidence.closed().len()];
        for [i, j] in (0..incidence.vertex_rows()).flat_map(|v| pairs_of(incidence, v)) {
            let list = &mut above[i as usize];
            if let Err(place) = list.binary_search(&j) {
                list.insert(place, j);
            }
        }
        self.pairs.clear();
        let mut starts = Vec::with_capacity(above.len());
        for (i, list) in (0..).zip(&above) {
            starts.push(self.pairs.len() as u32);
            self.pairs.extend(list.iter().map(|j| [i, *j]));
        }
        let place = |[i, j]: [u32; 2]| {
            let place = above[i as usize].binary_search(&j).expect("invariant: pairs of entries are listed");
            starts[i as usize] + place as u32
        };
        self.slots.clear();
        self.slots.extend((0..incidence.vertex_rows()).flat_map(|v| pairs_of(incidence, v)).map(place));
    }

    /// Sets the values; vertices with `inverse_mass` 0 are held.
    ///
    /// # Errors
    /// [`FlowError::SingularPressure`] names the first region whose volume cannot be changed by itself.
    pub fn fill(&mut self, incidence: &Incidence, gradients: &[DVec3], inverse_mass: &[f64]) -> Result<(), FlowError> {
        self.values.clear();
        self.values.resize(self.pairs.len(), 0.0);
        let mut slots = self.slots.iter();
        for (v, inverse) in inverse_mass.iter().enumerate() {
            let own = &gradients[incidence.entries_of(v)];
            for (i, a) in own.iter().enumerate() {
                for (b, slot) in own[i..].iter().zip(&mut slots) {
                    self.values[*slot as usize] += a.dot(*b) * inverse;
                }
            }
        }
        self.diagonal.clear();
        let on_diagonal = self.pairs.iter().zip(&self.values).filter(|([i, j], _)| i == j);
        self.diagonal.extend(on_diagonal.map(|(_, value)| *value));
        match self.diagonal.iter().position(|value| !(*value > 0.0)) {
            Some(i) => Err(FlowError::SingularPressure { region: incidence.closed()[i], pivot: 0.0 }),
            None if self.diagonal.len() <= MOST_DENSE => self.factorise(incidence),
            None => Ok(()),
        }
    }

    /// Cholesky: `S = C Cᵀ`, lower triangle in rows.
    fn factorise(&mut self, incidence: &Incidence) -> Result<(), FlowError> {
        let n = self.diagonal.len();
        self.factor.clear();
        self.factor.resize(n * n, 0.0);
        for ([i, j], value) in self.pairs.iter().zip(&self.values) {
            self.factor[*j as usize * n + *i as usize] = *value;
        }
        for i in 0..n {
            for j in 0..=i {
                let (upper, row) = self.factor.split_at_mut(i * n);
                let other = if j < i { &upper[j * n..j * n + j] } else { &row[..j] };
                let sum = row[j] - row[..j].iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
                if j < i {
                    row[j] = sum / upper[j * n + j];
                    continue;
                }
                let pivot = sum / self.diagonal[i];
                if !(pivot > SMALLEST_PIVOT) {
                    return Err(FlowError::SingularPressure { region: incidence.closed()[i], pivot });
                }
                row[i] = sum.sqrt();
            }
        }
        Ok(())
    }

    /// Solves `S x = b` in place.
    ///
    /// # Errors
    /// [`FlowError::SingularPressure`] for large systems that turn out to be singular.
    pub fn solve(&mut self, incidence: &Incidence, b: &mut [f64]) -> Result<(), FlowError> {
        if self.diagonal.len() <= MOST_DENSE {
            self.substitute(b);
            return Ok(());
        }
        self.iterate(incidence, b)
    }

    fn substitute(&self, b: &mut [f64]) {
        let n = b.len();
        for i in 0..n {
            let row = &self.factor[i * n..i * n + i];
            b[i] = (b[i] - row.iter().zip(&b[..i]).map(|(a, x)| a * x).sum::<f64>()) / self.factor[i * n + i];
        }
        for i in (0..n).rev() {
            b[i] /= self.factor[i * n + i];
            let (before, from) = b.split_at_mut(i);
            let row = &self.factor[i * n..i * n + i];
            before.iter_mut().zip(row).for_each(|(x, a)| *x -= a * from[0]);
        }
    }

    /// Conjugate gradients to 1e-14 of the right-hand side: the projection around it repairs what is left.
    fn iterate(&mut self, incidence: &Incidence, b: &mut [f64]) -> Result<(), FlowError> {
        let n = b.len();
        let Self { pairs, values, diagonal, work: [x, direction, image], .. } = self;
        x.clear();
        x.resize(n, 0.0);
        direction.clear();
        direction.extend(b.iter().zip(diagonal.iter()).map(|(r, d)| r / d));
        let norm = |r: &[f64]| -> f64 { r.iter().zip(diagonal.iter()).map(|(r, d)| r * r / d).sum() };
        let whole = norm(b);
        let mut rho = whole;
        for _ in 0..10 * n {
            if !(rho > 1e-28 * whole) {
                b.copy_from_slice(x);
                return Ok(());
            }
            multiply(pairs, values, direction, image);
            let curvature: f64 = direction.iter().zip(image.iter()).map(|(d, i)| d * i).sum();
            let alpha = rho / curvature;
            for i in 0..n {
                x[i] += alpha * direction[i];
                b[i] -= alpha * image[i];
            }
            let next = norm(b);
            for i in 0..n {
                direction[i] = b[i] / diagonal[i] + next / rho * direction[i];
            }
            rho = next;
        }
        let part = |i: usize| b[i] * b[i] / diagonal[i];
        let worst = (0..n).max_by(|i, j| part(*i).total_cmp(&part(*j))).unwrap_or(0);
        Err(FlowError::SingularPressure { region: incidence.closed()[worst], pivot: (rho / whole).sqrt() })
    }
}

fn multiply(pairs: &[[u32; 2]], values: &[f64], x: &[f64], image: &mut Vec<f64>) {
    image.clear();
    image.resize(x.len(), 0.0);
    for ([i, j], value) in pairs.iter().zip(values) {
        image[*i as usize] += value * x[*j as usize];
        if i != j {
            image[*j as usize] += value * x[*i as usize];
        }
    }
}

fn pairs_of(incidence: &Incidence, vertex: usize) -> impl Iterator<Item = [u32; 2]> + '_ {
    let regions = &incidence.entry_regions()[incidence.entries_of(vertex)];
    regions.iter().enumerate().flat_map(|(i, a)| regions[i..].iter().map(|b| [*a, *b]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calculus::test_shapes::{double_bubble, icosphere};
    use crate::calculus::volume::volume_gradients;
    use crate::rows::Region;
    use crate::surface::{LabelledTriangles, Surface};

    fn filled(surface: &Surface, inverse: f64) -> (Incidence, Result<PressureSystem, FlowError>) {
        let incidence = Incidence::new(surface);
        let mut gradients = Vec::new();
        volume_gradients(&incidence, &surface.positions, &mut gradients);
        let mut system = PressureSystem::default();
        system.lay_out(&incidence);
        let result = system.fill(&incidence, &gradients, &vec![inverse; surface.positions.len()]);
        (incidence, result.map(|()| system))
    }

    #[test]
    fn both_ways_of_solving_agree() {
        let (incidence, system) = filled(&double_bubble(1.0, 0.7, 4), 2.0);
        let mut system = system.unwrap();
        let (mut dense, mut sparse) = ([1.0, -2.0], [1.0, -2.0]);
        system.solve(&incidence, &mut dense).unwrap();
        system.iterate(&incidence, &mut sparse).unwrap();
        assert!((0..2).all(|i| (dense[i] - sparse[i]).abs() < 1e-12 * dense[i].abs()), "{dense:?} {sparse:?}");
        let mut image = Vec::new();
        multiply(&system.pairs, &system.values, &dense, &mut image);
        assert!((image[0] - 1.0).abs() < 1e-13 && (image[1] + 2.0).abs() < 1e-13, "{image:?}");
    }

    #[test]
    fn a_region_that_is_held_on_all_sides_is_named() {
        let (_, system) = filled(&icosphere(1.0, 1), 0.0);
        assert_eq!(system.unwrap_err(), FlowError::SingularPressure { region: Region(1), pivot: 0.0 });
    }

    #[test]
    fn two_regions_in_a_shell_that_does_not_move_are_singular() {
        let mut surface = double_bubble(1.0, 0.7, 4);
        let outer: Vec<_> = surface.mesh.faces().filter(|(_, f)| f.borders(Region(0))).collect();
        outer.iter().for_each(|(_, f)| f.vertices().iter().for_each(|v| surface.pinned.0[v.index()] = true));
        let incidence = Incidence::new(&surface);
        let mut gradients = Vec::new();
        volume_gradients(&incidence, &surface.positions, &mut gradients);
        let inverse: Vec<f64> = surface.pinned.iter().map(|held| if *held { 0.0 } else { 1.0 }).collect();
        let mut system = PressureSystem::default();
        system.lay_out(&incidence);
        let error = system.fill(&incidence, &gradients, &inverse).unwrap_err();
        assert!(matches!(error, FlowError::SingularPressure { region: Region(2), .. }), "{error}");
    }

    #[test]
    fn more_than_two_hundred_regions_are_solved_sparsely() {
        let one = icosphere(1.0, 0);
        let mut part = LabelledTriangles::default();
        one.positions.iter().for_each(|x| assert!(part.add_vertex(*x, false) < 12));
        one.mesh.faces().for_each(|(_, f)| part.add_film(f.vertices().map(|v| v.0), f.labels().map(|l| l.0)));
        let mut all = LabelledTriangles::default();
        (0..MOST_DENSE + 1).for_each(|_| all.append(&part));
        let (incidence, system) = filled(&Surface::from_triangles(&all), 1.0);
        let mut b: Vec<f64> = (0..MOST_DENSE + 1).map(|i| 1.0 + i as f64).collect();
        let mut system = system.unwrap();
        system.solve(&incidence, &mut b).unwrap();
        assert!(b.iter().enumerate().all(|(i, x)| (x / b[0] / (1.0 + i as f64) - 1.0).abs() < 1e-12));
    }
}
