//! The paper's discretisation: curvature and velocity at the vertices, which move with the air.
//!
//! | stage | module | equation |
//! |---|---|---|
//! | tension | [`curvature`] | `d phi_i/dt = -(sigma/rho) H_i`, so that `dGamma(i,j)/dt = (sigma/rho)(H_i - H_j)` |
//! | wires | `wires` | `(B^T B + lambda^2) dGamma = B^T du` |
//! | Biot-Savart | here | `u(x_v) = 1/(4 pi) sum_f G_f x (x_v - c_f) k_u` |
//! | convection | `slip` | only where a vertex slides beside the air |
//!
//! State, stages and knobs are those of the variational discretisation. Smoothing that does well here: third order with 1.0 edge
//! lengths; the paper's is first order with 0.5.
//!
//! # What it is for
//! To run the paper's method, and to compare. `tests/pointwise.rs` measures (R = rho = 2 sigma = 1):
//!
//! | | paper's kernel | third order | variational |
//! |---|---|---|---|
//! | frequencies l = 2, 3, 4 over exact, 642 vertices | .911 .872 .833 | .9992 .988 .973 | 1.0007 .989 .974 |
//! | drum over exact, 244 vertices | .919 | 1.0000 | .9995 |
//! | double bubbles at rest, off 120 degrees; 201 vertices, 412, unequal 284 | | 1.9 .5 1.8 | .7 .4 1.4 |
//! | kinetic energy of an irregular bubble in its fifth period over the first, undamped | | 2900 | 1.00 |
//!
//! The growth is linear instability of the shortest waves: curvature and velocity at points are not each other's transpose. It is slow
//! with the paper's kernel, whose short waves hardly move, and `D` of 0.002 `sqrt(2 sigma R / rho)` ends it.
//!
//! # Deviations from the paper, mended
//! * The sign of eq. 10: with `Gamma = phi_j - phi_i` it is plus. The frequencies test it.
//! * `|x - x'|` in the print of eq. 12 is `|x - x'|^2`.
//! * Potentials per region instead of circulations per pair: antisymmetric, and closed round a Plateau border, by construction.
//! * The area at a Plateau border: see [`AreaShare`]. This, not the idea, is why angles of the paper's method come out wrong.
//! * Open films: `Gamma` is the circulation round a loop about the rim. It is zero there, because the air is the same on both
//!   sides, and air may flow past the rim. The paper solves for vorticity on rims since it lets `Gamma` there be anything. The drum tests it.
//! * Wires on Plateau borders take part in the solve.
//! * Volumes are kept by projection, and steps follow the capillary waves.
//!
//! # Deviations of the equations, kept
//! * At Plateau borders potentials are carried by one velocity, the mean over the films. Each region's air has a speed `s_i` of its
//!   own along the border, and `d phi_i/dt` lacks `-1/2 (s_i - w)^2`: of second order in how the speeds differ. The variational
//!   discretisation has the term.
//! * The small weight on changes in the solve on wires: velocities at points through a smoothed kernel make a matrix that
//!   may be nearly singular. Air lags behind wires by some part in a thousand.
//!
//! # Source
//! Da, Batty, Wojtan, Grinspun 2015, §§4.3 to 4.6.

pub mod curvature;
mod hinges;
mod slip;
mod wires;

use froth_biot_savart::{PairSum, SheetKernel, Summation};
use glam::DVec3;

use crate::SheetError;
use crate::discretisation::{Films, Scheme, Sources};
use crate::layout::Layout;
use crate::pointwise::curvature::AreaShare;
use crate::pointwise::hinges::Hinges;
use crate::pointwise::wires::Grip;
use crate::sheet::Forcing;
use crate::tension;
use crate::wires::WireSolve;

/// Work space of the pointwise discretisation.
#[derive(Debug)]
pub(crate) struct Pointwise {
    hinges: Hinges,
    bending: Vec<f64>,
    areas: Vec<f64>,
    loads: Vec<DVec3>,
    /// Velocity of the air at the vertices, m/s: the mean of both sides.
    air: Vec<DVec3>,
    /// Panels around wires, and held vertices: few enough for direct sums.
    wire_pairs: [PairSum; 2],
}

impl Pointwise {
    pub(crate) fn new(kernel: SheetKernel) -> Result<Self, SheetError> {
        let direct = || PairSum::new(kernel, Summation::Direct);
        Ok(Self {
            hinges: Hinges::default(),
            bending: Vec::new(),
            areas: Vec::new(),
            loads: Vec::new(),
            air: Vec::new(),
            wire_pairs: [direct()?, direct()?],
        })
    }

    /// Pressures against external forces alone, as in the variational discretisation: a force is not a curvature.
    fn load_by_forces(&mut self, films: Films<'_>, forces: &[DVec3], pressures: &mut Vec<f64>) {
        self.loads.clear();
        self.loads.resize(films.positions.len(), DVec3::ZERO);
        self.loads.iter_mut().zip(forces).for_each(|(load, force)| *load = -*force);
        tension::pressures(films.layout, films.geometry, &self.loads, pressures);
    }
}

impl Scheme for Pointwise {
    fn rebuild(&mut self, layout: &Layout) {
        self.hinges = Hinges::new(layout);
    }

    fn load(&mut self, films: Films<'_>, forcing: &Forcing<'_>, pressures: &mut Vec<f64>) -> f64 {
        let Films { layout, geometry, positions, .. } = films;
        self.load_by_forces(films, forcing.forces, pressures);
        curvature::bending(&self.hinges, layout, geometry, positions, forcing.tension, &mut self.bending);
        curvature::areas(layout, positions, AreaShare::default(), &mut self.areas);
        for ((pressure, bending), area) in pressures.iter_mut().zip(&self.bending).zip(&self.areas) {
            *pressure += if *area > 0.0 { bending / area } else { 0.0 };
        }
        let energy = |(panel, area): (&crate::layout::Panel, &DVec3)| forcing.tension.of(panel.row) * area.length();
        layout.panels().iter().zip(&geometry.area_vectors).map(energy).sum()
    }

    fn hold(
        &mut self,
        films: Films<'_>,
        sources: Sources<'_>,
        wire_velocities: &[DVec3],
        potentials: &mut [f64],
    ) -> Result<WireSolve, SheetError> {
        let mut grip = Grip::new(films, &mut self.wire_pairs);
        let mut air = Vec::new();
        sources.pairs.velocities_at(sources.strengths, grip.places(), &mut air)?;
        let (changes, info) = grip.solve(grip.lack(&air, wire_velocities))?;
        for (unknown, change) in films.wires.unknowns().iter().zip(changes) {
            unknown.iter().for_each(|side| potentials[*side as usize] += change);
        }
        Ok(info)
    }

    fn velocities(
        &mut self,
        films: Films<'_>,
        sources: Sources<'_>,
        potentials: &[f64],
        velocities: &mut Vec<DVec3>,
    ) -> Result<f64, SheetError> {
        let Films { layout, geometry, positions, .. } = films;
        sources.pairs.velocities_at(sources.strengths, positions, &mut self.air)?;
        // A vertex without films stays where it is.
        let sides = (0..layout.vertex_rows()).map(|v| layout.sides_of(v));
        self.air.iter_mut().zip(sides).filter(|(_, sides)| sides.is_empty()).for_each(|(u, _)| *u = DVec3::ZERO);
        velocities.clone_from(&self.air);
        // K = rho/2 sum phi_iv N_iv.u_v: the work of the potentials on what flows through the films.
        let work = |(side, phi): (usize, &f64)| {
            phi * geometry.gradients[side].dot(self.air[layout.vertex_of(side as u32) as usize])
        };
        Ok(0.5 * potentials.iter().enumerate().map(work).sum::<f64>())
    }

    fn heads(&mut self, films: Films<'_>, potentials: &[f64], velocities: &[DVec3], heads: &mut Vec<f64>) {
        let slips: Vec<DVec3> = velocities
            .iter()
            .zip(&self.air)
            .zip(films.wires.held())
            .map(|((w, u), held)| if *held { DVec3::ZERO } else { *w - *u })
            .collect();
        slip::heads(films, potentials, &slips, heads);
    }
}
