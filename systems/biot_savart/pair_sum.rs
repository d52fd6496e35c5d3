//! The pair sum as its users see it: place panels, then sum their strengths as often as needed.

use glam::DVec3;

use crate::blocks::Frame;
use crate::direct::Direct;
use crate::error::PairSumError;
use crate::fast::accuracy::{self, Accuracy};
use crate::fast::{Fast, Fineness};
use crate::instructions::Instructions;
use crate::sheet_kernel::SheetKernel;
use crate::targets::{self, Quantity};

/// How pairs are summed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Summation {
    /// Every pair, exact to round-off; cost grows with the square of the number of panels.
    #[default]
    Direct,
    /// Near pairs one by one, distant groups by expansions, as fine as a bound on the error asks for. Cost grows little faster than
    /// the number of panels.
    ///
    /// The bound was measured on spheres, discs, cubes, double bubbles, foams and bubbles of very different size, with smooth and
    /// random strengths and smoothing lengths of 0.25 to 2 edge lengths: a tenth to two thirds of it is used.
    Fast {
        /// Bound on the relative error of normal velocities worked out from fluxes (root mean square), dimensionless;
        /// 1e-6 to 0.1.
        tolerance: f64,
    },
    /// As `Fast`, with order and opening angle set by hand.
    Expansions(Accuracy),
    /// Directly for few panels, fast for many: whichever is cheaper.
    Auto {
        /// As for `Fast`.
        tolerance: f64,
    },
}

impl Summation {
    fn check(self) -> Result<(), PairSumError> {
        match self {
            Self::Direct => Ok(()),
            Self::Fast { tolerance } | Self::Auto { tolerance } => accuracy::check_tolerance(tolerance),
            Self::Expansions(accuracy) => accuracy.check(),
        }
    }

    /// How finely to expand, unless this many panels are summed directly.
    fn fineness_for(self, panels: usize) -> Option<Fineness> {
        match self {
            Self::Direct => None,
            Self::Auto { tolerance } if panels < accuracy::break_even(tolerance) => None,
            Self::Fast { tolerance } | Self::Auto { tolerance } => Some(Fineness::Bound(tolerance)),
            Self::Expansions(accuracy) => Some(Fineness::Set(accuracy)),
        }
    }
}

/// Sums at panels, one of each per panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PanelSums {
    /// Vector potential `A_f = 1/(4π) Σ_g G_g k`, m²/s for strengths in m³/s; the panel's own part included.
    pub potentials: Vec<DVec3>,
    /// Gradient of the kinetic energy over density, `½ Σ G_f·A_f`, when the panel's centre moves and strengths stay:
    /// `S_f = 1/(4π) Σ_g (G_f·G_g) ∇k`, m⁴/s².
    pub energy_gradients: Vec<DVec3>,
}

/// Sums over pairs of panels with scratch of its own.
///
/// ```
/// # use froth_biot_savart::{PairSum, SheetKernel, Summation};
/// # use glam::DVec3;
/// let mut pairs = PairSum::new(SheetKernel::third_order(0.1), Summation::Direct)?;
/// pairs.place(&[DVec3::ZERO, DVec3::X]);
/// let mut potentials = Vec::new();
/// pairs.potentials(&[DVec3::Z, DVec3::ZERO], &mut potentials)?;
/// assert!((potentials[1].z * 4.0 * std::f64::consts::PI - 1.0).abs() < 2e-4); // 1/r, and 9/8 (α/r)⁴ more
/// # Ok::<(), froth_biot_savart::PairSumError>(())
/// ```
#[derive(Debug)]
pub struct PairSum {
    kernel: SheetKernel,
    summation: Summation,
    instructions: Instructions,
    frame: Frame,
    panels: usize,
    placed: Placed,
}

/// Panels in their places, for one way to sum.
#[derive(Debug)]
enum Placed {
    Direct(Direct),
    Fast(Box<Fast>),
}

impl PairSum {
    /// A sum without panels.
    ///
    /// # Errors
    /// [`PairSumError::SmoothingLength`], [`PairSumError::Tolerance`], [`PairSumError::Accuracy`].
    pub fn new(kernel: SheetKernel, summation: Summation) -> Result<Self, PairSumError> {
        kernel.check()?;
        summation.check()?;
        Ok(Self {
            kernel,
            summation,
            instructions: Instructions::default(),
            frame: Frame::default(),
            panels: 0,
            placed: Placed::Direct(Direct::default()),
        })
    }

    /// The same with other instructions: results agree to 1e-12 of their largest.
    #[must_use]
    pub fn with_instructions(self, instructions: Instructions) -> Self {
        Self { instructions, ..self }
    }

    /// The kernel.
    #[must_use]
    pub fn kernel(&self) -> SheetKernel {
        self.kernel
    }

    /// How pairs are summed.
    #[must_use]
    pub fn summation(&self) -> Summation {
        self.summation
    }

    /// Number of panels placed.
    #[must_use]
    pub fn panels(&self) -> usize {
        self.panels
    }

    /// How finely the panels placed are expanded; none if they are summed directly.
    #[must_use]
    pub fn accuracy(&self) -> Option<Accuracy> {
        match &self.placed {
            Placed::Direct(_) => None,
            Placed::Fast(fast) => Some(fast.accuracy()),
        }
    }

    /// Puts panels at their centroids (m). Sums after this take one strength per panel, as many times as needed: all that depends
    /// on places alone is done here.
    ///
    /// A centroid that is not finite spoils the sums and nothing else.
    pub fn place(&mut self, centres: &[DVec3]) {
        self.frame = Frame::about(centres, self.kernel.smoothing_length);
        self.panels = centres.len();
        self.placed = match self.summation.fineness_for(centres.len()) {
            Some(fineness) => Placed::Fast(Box::new(Fast::place(centres, &self.frame, fineness))),
            None => Placed::Direct(Direct::place(centres, &self.frame)),
        };
    }

    /// Vector potentials at the panels (m²/s), for strengths integrated over panels (m³/s).
    ///
    /// # Errors
    /// [`PairSumError::StrengthCount`].
    pub fn potentials(&mut self, strengths: &[DVec3], potentials: &mut Vec<DVec3>) -> Result<(), PairSumError> {
        self.set_strengths(strengths)?;
        self.sum::<false>();
        let factor = self.frame.potential_factor();
        potentials.clear();
        potentials.resize(self.panels, DVec3::ZERO);
        self.placed.read(|row, [potential, _]| potentials[row] = factor * potential);
        Ok(())
    }

    /// Vector potentials and energy gradients at the panels, for strengths integrated over panels (m³/s).
    ///
    /// # Errors
    /// [`PairSumError::StrengthCount`].
    pub fn potentials_and_gradients(&mut self, strengths: &[DVec3], sums: &mut PanelSums) -> Result<(), PairSumError> {
        self.set_strengths(strengths)?;
        self.sum::<true>();
        let factors = [self.frame.potential_factor(), self.frame.gradient_factor()];
        let PanelSums { potentials, energy_gradients } = sums;
        for values in [&mut *potentials, energy_gradients] {
            values.clear();
            values.resize(self.panels, DVec3::ZERO);
        }
        self.placed.read(|row, [potential, gradient]| {
            potentials[row] = factors[0] * potential;
            energy_gradients[row] = factors[1] * gradient;
        });
        Ok(())
    }

    /// Velocities `u(x) = 1/(4π) Σ_g G_g × (x - c_g) k_u` at places in space (m), m/s.
    ///
    /// On a sheet this is the mean of both sides.
    ///
    /// # Errors
    /// [`PairSumError::StrengthCount`].
    pub fn velocities_at(
        &mut self,
        strengths: &[DVec3],
        places: &[DVec3],
        velocities: &mut Vec<DVec3>,
    ) -> Result<(), PairSumError> {
        self.gather_at(Quantity::Velocity, strengths, places, velocities)
    }

    /// Vector potentials at places in space (m), m²/s.
    ///
    /// # Errors
    /// [`PairSumError::StrengthCount`].
    pub fn potentials_at(
        &mut self,
        strengths: &[DVec3],
        places: &[DVec3],
        potentials: &mut Vec<DVec3>,
    ) -> Result<(), PairSumError> {
        self.gather_at(Quantity::Potential, strengths, places, potentials)
    }

    fn gather_at(
        &mut self,
        quantity: Quantity,
        strengths: &[DVec3],
        places: &[DVec3],
        values: &mut Vec<DVec3>,
    ) -> Result<(), PairSumError> {
        self.set_strengths(strengths)?;
        let scaled: Vec<DVec3> = places.iter().map(|x| self.frame.scaled(*x)).collect();
        let (series, instructions) = (self.kernel.order.series(), self.instructions);
        let sums = match &mut self.placed {
            Placed::Direct(direct) => {
                let blocks: Vec<_> = direct.blocks().collect();
                targets::gather(quantity, &series, instructions, &blocks, &scaled)
            }
            Placed::Fast(fast) => fast.gather(quantity, &series, instructions, &scaled),
        };
        let factor = match quantity {
            Quantity::Potential => self.frame.potential_factor(),
            Quantity::Velocity => self.frame.gradient_factor(),
        };
        values.clear();
        values.extend(sums.into_iter().map(|sum| factor * sum));
        Ok(())
    }

    fn set_strengths(&mut self, strengths: &[DVec3]) -> Result<(), PairSumError> {
        if strengths.len() != self.panels {
            return Err(PairSumError::StrengthCount { panels: self.panels, strengths: strengths.len() });
        }
        match &mut self.placed {
            Placed::Direct(direct) => direct.set_strengths(strengths),
            Placed::Fast(fast) => fast.set_strengths(strengths),
        }
        Ok(())
    }

    fn sum<const GRADIENT: bool>(&mut self) {
        let (series, instructions) = (self.kernel.order.series(), self.instructions);
        match &mut self.placed {
            Placed::Direct(direct) => direct.sum::<GRADIENT>(&series, instructions),
            Placed::Fast(fast) => fast.sum::<GRADIENT>(&series, instructions),
        }
    }
}

impl Placed {
    /// Hands out each panel's row, and its potential and gradient sums without their factors.
    fn read(&self, mut take: impl FnMut(usize, [DVec3; 2])) {
        match self {
            Self::Direct(direct) => direct.sums().enumerate().for_each(|(row, sums)| take(row, sums)),
            Self::Fast(fast) => fast.sums().for_each(|(row, sums)| take(row, sums)),
        }
    }
}
