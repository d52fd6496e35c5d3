//! Diffusion of circulation over the films: a physical damping with a kinematic coefficient.
//!
//! # Equation
//! `d Gamma/dt = D Lap Gamma` over a film, `D` in m^2/s. In potentials per side `A d phi/dt = -D/2 B^T K B phi`, with `B phi` the circulation
//! of each film, the difference of its sides. What is the same for all regions at a vertex changes nothing and is not changed; on a border
//! circulations go on adding up to zero.
//! A mode of degree `l` on a sphere decays as `exp(-D l (l + 1) t / (2 R^2))` in amplitude.
//!
//! # Discretisation
//! Cotangent stiffness `K` per film, lumped areas `A` per side, one implicit step: `(A + dt D/2 B^T K B) phi' = A phi`, solved by
//! [conjugate gradients](crate::conjugate_gradient) preconditioned by the diagonal. Slivers, which would make explicit steps
//! endlessly short, cost some iterations. First order in `dt`: a mode fades by `1 / (1 + r dt)` per step for `exp(-r dt)`.

use froth_surface::calculus::stiffness::half_cotangents;
use glam::DVec3;

use crate::SheetError;
use crate::conjugate_gradient::{self, StopRule, System, Workspace};
use crate::geometry::{circulations, corners};
use crate::layout::Layout;

/// When the solve ends; the residual is measured by `sqrt(r . r / diagonal)` against `sqrt(phi . A phi)`.
const STOP: StopRule = StopRule {
    tolerance: 1e-10,
    max_iterations: 2000,
    refusal: |iterations, residual| SheetError::DampingNotSolved { iterations, residual },
};

/// Largest half cotangent that counts: that of an angle of half a degree. Thinner faces, as films that meet leave them for a step, would make
/// the system singular to rounding.
const STEEPEST: f64 = 50.0;

/// Work space of the diffusion.
#[derive(Clone, Debug, Default)]
pub struct Damping {
    weights: Vec<[f64; 3]>,
    areas: Vec<f64>,
    inverse: Vec<f64>,
    work: Workspace,
}

impl Damping {
    /// Lets potentials per side diffuse for `dt` seconds with `diffusivity` m^2/s.
    ///
    /// # Errors
    /// [`SheetError::DampingNotSolved`] if the iteration does not converge.
    pub fn diffuse(
        &mut self,
        layout: &Layout,
        positions: &[DVec3],
        diffusivity: f64,
        dt: f64,
        potentials: &mut [f64],
    ) -> Result<(), SheetError> {
        if !(diffusivity > 0.0) || layout.panels().is_empty() {
            return Ok(());
        }
        self.weigh(layout, positions, diffusivity * dt);
        self.solve(layout, potentials)
    }

    /// Weights per panel and opposite corner, times half of `amount` (m^2); areas and inverse diagonals per side.
    fn weigh(&mut self, layout: &Layout, positions: &[DVec3], amount: f64) {
        for list in [&mut self.areas, &mut self.inverse] {
            list.clear();
            list.resize(layout.side_count(), 0.0);
        }
        self.weights.clear();
        for panel in layout.panels() {
            let x = corners(panel, positions);
            let half = moderate(half_cotangents(x)).map(|half| 0.5 * amount * half);
            let third = (x[1] - x[0]).cross(x[2] - x[0]).length() / 6.0;
            for k in 0..3 {
                for side in [panel.back[k], panel.front[k]] {
                    self.areas[side as usize] += third;
                    self.inverse[side as usize] += third + half[(k + 1) % 3] + half[(k + 2) % 3];
                }
            }
            self.weights.push(half);
        }
        self.inverse.iter_mut().for_each(|d| *d = if *d > 0.0 { d.recip() } else { 0.0 });
    }

    /// Solves for the change of the potentials: right-hand side `-dt D/2 B^T K B phi`.
    fn solve(&mut self, layout: &Layout, potentials: &mut [f64]) -> Result<(), SheetError> {
        let Self { weights, areas, inverse, work } = self;
        work.residual.clear();
        work.residual.resize(potentials.len(), 0.0);
        add_stiffness(layout, weights, potentials, &mut work.residual);
        work.residual.iter_mut().for_each(|r| *r = -*r);
        // Against the potentials themselves: a sheet without gradients has nothing to solve.
        let whole = potentials.iter().zip(areas.iter()).map(|(x, area)| x * x * area).sum::<f64>();
        let product = |x: &[f64], image: &mut Vec<f64>| {
            image.clear();
            image.extend(x.iter().zip(areas.iter()).map(|(x, area)| x * area));
            add_stiffness(layout, weights, x, image);
            Ok(())
        };
        conjugate_gradient::solve(System { product, inverse, whole }, STOP, potentials, work)?;
        Ok(())
    }
}

/// The half cotangents of a face, all scaled alike where one is beyond [`STEEPEST`]: the stiffness of the face stays semidefinite.
fn moderate(half: [f64; 3]) -> [f64; 3] {
    let steepest = half.into_iter().fold(0.0f64, |most, c| most.max(c.abs()));
    let scale = if steepest > STEEPEST { STEEPEST / steepest } else { 1.0 };
    // Corners that coincide have no cotangents: nothing flows there.
    if scale.is_finite() && scale > 0.0 { half.map(|c| c * scale) } else { [0.0; 3] }
}

/// Adds `dt D/2 B^T K B x` per side.
fn add_stiffness(layout: &Layout, weights: &[[f64; 3]], x: &[f64], sums: &mut [f64]) {
    for (panel, half) in layout.panels().iter().zip(weights) {
        let gamma = circulations(panel, x);
        for (k, half) in half.iter().enumerate() {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            let flow = half * (gamma[b] - gamma[a]);
            sums[panel.front[a] as usize] -= flow;
            sums[panel.back[a] as usize] += flow;
            sums[panel.front[b] as usize] += flow;
            sums[panel.back[b] as usize] -= flow;
        }
    }
}

#[cfg(test)]
mod tests {
    use froth_surface::Surface;
    use froth_surface::shapes::double_bubble;
    use froth_surface::shapes::random::Random;

    use super::*;

    /// Circulations after a while of diffusion, m^2/s per panel and corner.
    fn diffused(value: impl Fn(u32, DVec3) -> f64, gauge: impl Fn(usize) -> f64) -> (Vec<[f64; 3]>, Vec<[f64; 3]>) {
        let surface = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.7, 0.25));
        let layout = Layout::new(&surface);
        let phi = |side: usize| {
            let v = layout.vertex_of(side as u32) as usize;
            value(layout.regions()[side].0, surface.positions.0[v]) + gauge(v)
        };
        let mut potentials: Vec<f64> = (0..layout.side_count()).map(phi).collect();
        let of = |phi: &[f64]| layout.panels().iter().map(|panel| circulations(panel, phi)).collect::<Vec<_>>();
        let before = of(&potentials);
        Damping::default().diffuse(&layout, &surface.positions, 0.1, 1.0, &mut potentials).unwrap();
        (before, of(&potentials))
    }

    fn farthest(some: &[[f64; 3]], others: &[[f64; 3]]) -> f64 {
        some.iter().flatten().zip(others.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn what_is_the_same_for_all_regions_at_a_vertex_makes_no_difference() {
        let value = |region: u32, x: DVec3| f64::from(region) * x.x * x.y + x.z;
        let mut dice = Random::new(3);
        let gauges: Vec<f64> = (0..10_000).map(|_| dice.next_signed()).collect();
        let ((start, one), (_, other)) = (diffused(value, |_| 0.0), diffused(value, |v| gauges[v]));
        assert!(farthest(&start, &one) > 0.05);
        assert!(farthest(&one, &other) < 1e-8, "{:e}", farthest(&one, &other));
    }

    #[test]
    fn a_constant_per_region_does_not_diffuse_across_borders_either() {
        let (start, end) = diffused(|region, _| [0.3, -1.2, 2.0][region as usize], |v| v as f64);
        assert!(farthest(&start, &end) < 1e-8, "{:e}", farthest(&start, &end));
    }
}
