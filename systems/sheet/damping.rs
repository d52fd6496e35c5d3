//! Diffusion of the potentials over each region's own surface: a physical damping with a kinematic coefficient.
//!
//! # Equation
//! `d phi_i/dt = D Lap phi_i` on the closed surface of region `i`, `D` in m^2/s. On borders all regions' values stay consistent, because no
//! rule is needed there: each region's surface runs smoothly past.
//! A mode of degree `l` on a sphere decays as `exp(-D l (l + 1) t / (2 R^2))` in amplitude.
//!
//! # Discretisation
//! Cotangent stiffness `K`, lumped areas `A`, one implicit step: `(A + D dt K) phi' = A phi`, solved by
//! [conjugate gradients](crate::conjugate_gradient) preconditioned by the diagonal. Slivers, which would make explicit steps
//! endlessly short, cost an iteration or two. First order in `dt`: a mode fades by `1 / (1 + r dt)` per step for `exp(-r dt)`.

use froth_surface::calculus::stiffness::half_cotangents;
use glam::DVec3;

use crate::SheetError;
use crate::conjugate_gradient::{self, StopRule, System, Workspace};
use crate::geometry::corners;
use crate::layout::Layout;

/// When the solve ends; the residual is measured by `sqrt(r . r / diagonal)` against `sqrt(phi . A phi)`.
const STOP: StopRule = StopRule {
    tolerance: 1e-12,
    max_iterations: 2000,
    refusal: |iterations, residual| SheetError::DampingNotSolved { iterations, residual },
};

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

    /// Weights per panel and opposite corner, times `amount` (m^2); areas and inverse diagonals per side.
    fn weigh(&mut self, layout: &Layout, positions: &[DVec3], amount: f64) {
        for list in [&mut self.areas, &mut self.inverse] {
            list.clear();
            list.resize(layout.side_count(), 0.0);
        }
        self.weights.clear();
        for panel in layout.panels() {
            let x = corners(panel, positions);
            let half = half_cotangents(x).map(|half| amount * half);
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

    /// Solves for the change of the potentials: right-hand side `-D dt K phi`.
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

/// Adds `D dt K x` per side.
fn add_stiffness(layout: &Layout, weights: &[[f64; 3]], x: &[f64], sums: &mut [f64]) {
    for (panel, half) in layout.panels().iter().zip(weights) {
        for sides in [panel.back, panel.front] {
            for k in 0..3 {
                let (a, b) = (sides[(k + 1) % 3] as usize, sides[(k + 2) % 3] as usize);
                let flow = half[k] * (x[b] - x[a]);
                sums[a] -= flow;
                sums[b] += flow;
            }
        }
    }
}
