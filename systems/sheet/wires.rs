//! Wires: the circulation on a wire is what carries the film along with it.
//!
//! # Equation
//! At a held vertex with velocity `u` the fluxes are given: `F_iv = N_iv . u` for each region there. Unknown are the differences of the
//! potentials, one fewer than there are regions (regions that ghosts join count once). The matrix is the wire's block of
//! `dF/dphi`, symmetric and positive definite: [conjugate gradients](crate::conjugate_gradient) converge in about
//! ten iterations, and nothing is regularised.
//! On the rim of an open film there is one region and nothing to solve: the potential is continuous round the wire.
//!
//! # Discretisation
//! Only panels that touch a wire carry unknowns: the products sum over those alone.
//!
//! # Source
//! Da 2015, eqs 13 and 14, without the Tikhonov term, and on Plateau borders too.

use froth_biot_savart::PairSum;
use froth_surface::Surface;
use glam::DVec3;
use smallvec::SmallVec;

use crate::SheetError;
use crate::conjugate_gradient::{self, SolveInfo, StopRule, System, Workspace};
use crate::flow;
use crate::geometry::Geometry;
use crate::layout::Layout;

/// When the solve ends; the residual is measured against the right-hand side.
const STOP: StopRule = StopRule {
    tolerance: 1e-10,
    max_iterations: 200,
    refusal: |iterations, residual| SheetError::WireNotSolved { iterations, residual },
};

/// What a solve took; its residual is over the right-hand side.
pub type WireSolve = SolveInfo;

/// An unknown: the potential that some sides of one vertex have in common, relative to the vertex's first group of sides.
pub(crate) type Unknown = SmallVec<[u32; 4]>;

/// Held vertices of a mesh and the panels around them; built once per change of the mesh.
#[derive(Clone, Debug, Default)]
pub struct Wires {
    held: Vec<bool>,
    unknowns: Vec<Unknown>,
    /// Panels that touch an unknown, as a layout of their own over the same sides.
    around: Layout,
    rows: Vec<usize>,
}

impl Wires {
    /// The wires of a surface.
    #[must_use]
    pub fn new(layout: &Layout, surface: &Surface) -> Self {
        let held = surface.pinned.0.clone();
        let mut unknowns = Vec::new();
        for v in (0..layout.vertex_rows()).filter(|v| held[*v]) {
            unknowns.extend(layout.groups_of(v).into_iter().skip(1));
        }
        let mut is_unknown = vec![false; layout.side_count()];
        unknowns.iter().flatten().for_each(|side| is_unknown[*side as usize] = true);
        let touches = |row: &usize| {
            let panel = &layout.panels()[*row];
            panel.back.iter().chain(&panel.front).any(|side| is_unknown[*side as usize])
        };
        let rows: Vec<usize> = (0..layout.panels().len()).filter(touches).collect();
        Self { held, unknowns, around: layout.restricted(&rows), rows }
    }

    /// Per vertex: whether a wire holds it.
    #[must_use]
    pub fn held(&self) -> &[bool] {
        &self.held
    }

    /// Whether circulations on wires are to be solved for.
    #[must_use]
    pub fn has_unknowns(&self) -> bool {
        !self.unknowns.is_empty()
    }

    /// Rows of the panels around wires.
    #[must_use]
    pub fn panel_rows(&self) -> &[usize] {
        &self.rows
    }

    /// What is solved for.
    pub(crate) fn unknowns(&self) -> &[Unknown] {
        &self.unknowns
    }

    /// Panels that touch an unknown, as a layout over all sides.
    pub(crate) fn around(&self) -> &Layout {
        &self.around
    }

    /// Changes potentials on wires so that films go with them; `vector_potentials` are those of the potentials as they come, at the
    /// panels of [`Self::panel_rows`], m^2/s; `wire_velocities` per vertex, m/s.
    ///
    /// # Errors
    /// [`SheetError::WireNotSolved`] if the iteration does not converge; faults of the pair sum.
    pub fn solve(
        &self,
        geometry: &Geometry,
        positions: &[DVec3],
        wire_velocities: &[DVec3],
        vector_potentials: &[DVec3],
        pairs: &mut PairSum,
        potentials: &mut [f64],
    ) -> Result<WireSolve, SheetError> {
        let mut product = Product::new(self, geometry, positions, pairs)?;
        flow::fluxes(&self.around, positions, vector_potentials, &mut product.fluxes);
        let mut residual = self.gathered(&product.fluxes);
        for (lack, unknown) in residual.iter_mut().zip(&self.unknowns) {
            let wanted = |side: &u32| {
                geometry.gradients[*side as usize].dot(wire_velocities[self.around.vertex_of(*side) as usize])
            };
            *lack = unknown.iter().map(wanted).sum::<f64>() - *lack;
        }
        let (mut solution, inverse) = (vec![0.0; residual.len()], vec![1.0; residual.len()]);
        let whole = residual.iter().map(|lack| lack * lack).sum::<f64>();
        let mut work = Workspace::of(residual);
        let system =
            System { product: |x: &[f64], image: &mut Vec<f64>| product.times(x, image), inverse: &inverse, whole };
        let info = conjugate_gradient::solve(system, STOP, &mut solution, &mut work)?;
        for (unknown, value) in self.unknowns.iter().zip(solution) {
            unknown.iter().for_each(|side| potentials[*side as usize] += value);
        }
        Ok(info)
    }

    /// Sum of the values of each unknown's sides.
    pub(crate) fn gathered(&self, sides: &[f64]) -> Vec<f64> {
        self.unknowns.iter().map(|unknown| unknown.iter().map(|side| sides[*side as usize]).sum()).collect()
    }
}

/// The matrix as a product.
struct Product<'a> {
    wires: &'a Wires,
    positions: &'a [DVec3],
    pairs: &'a mut PairSum,
    potentials: Vec<f64>,
    strengths: Vec<DVec3>,
    vector_potentials: Vec<DVec3>,
    fluxes: Vec<f64>,
}

impl<'a> Product<'a> {
    fn new(
        wires: &'a Wires,
        geometry: &Geometry,
        positions: &'a [DVec3],
        pairs: &'a mut PairSum,
    ) -> Result<Self, SheetError> {
        let centres: Vec<DVec3> = wires.rows.iter().map(|row| geometry.centres[*row]).collect();
        pairs.place(&centres);
        Ok(Self {
            wires,
            positions,
            pairs,
            potentials: vec![0.0; wires.around.side_count()],
            strengths: Vec::new(),
            vector_potentials: Vec::new(),
            fluxes: Vec::new(),
        })
    }

    fn times(&mut self, x: &[f64], image: &mut Vec<f64>) -> Result<(), SheetError> {
        for (unknown, value) in self.wires.unknowns.iter().zip(x) {
            unknown.iter().for_each(|side| self.potentials[*side as usize] = *value);
        }
        let layout = &self.wires.around;
        flow::strengths(layout, self.positions, &self.potentials, &mut self.strengths);
        self.pairs.potentials(&self.strengths, &mut self.vector_potentials)?;
        flow::fluxes(layout, self.positions, &self.vector_potentials, &mut self.fluxes);
        *image = self.wires.gathered(&self.fluxes);
        Ok(())
    }
}
