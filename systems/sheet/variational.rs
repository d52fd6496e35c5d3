//! The variational discretisation: fluxes through vertex shares, forces as derivatives of energies.
//!
//! Its parts are [`tension`], [`wires`](crate::wires), [`flow`] and [`convection`]; here they become stages of a [sheet](crate::Sheet).

use froth_biot_savart::{PairSum, PanelSums, SheetKernel, Summation};
use froth_surface::calculus::area::area_gradient;
use glam::DVec3;

use crate::SheetError;
use crate::convection::{self, PairSums};
use crate::discretisation::{Films, Scheme, Sources};
use crate::flow;
use crate::layout::Layout;
use crate::sheet::Forcing;
use crate::tension;
use crate::wires::WireSolve;

/// Work space of the variational discretisation.
#[derive(Debug)]
pub(crate) struct Variational {
    loads: Vec<DVec3>,
    sums: PanelSums,
    fluxes: Vec<f64>,
    wire_pairs: PairSum,
}

impl Variational {
    pub(crate) fn new(kernel: SheetKernel) -> Result<Self, SheetError> {
        Ok(Self {
            loads: Vec::new(),
            sums: PanelSums::default(),
            fluxes: Vec::new(),
            // Wires are short: their panels are summed directly.
            wire_pairs: PairSum::new(kernel, Summation::Direct)?,
        })
    }
}

impl Scheme for Variational {
    fn rebuild(&mut self, _: &Layout) {}

    fn load(&mut self, films: Films<'_>, forcing: &Forcing<'_>, pressures: &mut Vec<f64>) -> f64 {
        self.loads.clear();
        self.loads.resize(films.positions.len(), DVec3::ZERO);
        let energy = area_gradient(films.incidence, films.positions, forcing.tension, &mut self.loads);
        self.loads.iter_mut().zip(forcing.forces).for_each(|(load, force)| *load -= *force);
        tension::pressures(films.layout, films.geometry, &self.loads, pressures);
        energy
    }

    fn hold(
        &mut self,
        films: Films<'_>,
        sources: Sources<'_>,
        wire_velocities: &[DVec3],
        potentials: &mut [f64],
    ) -> Result<WireSolve, SheetError> {
        let Films { geometry, wires, positions, .. } = films;
        let places: Vec<DVec3> = wires.panel_rows().iter().map(|row| geometry.centres[*row]).collect();
        let mut around = Vec::new();
        sources.pairs.potentials_at(sources.strengths, &places, &mut around)?;
        wires.solve(geometry, positions, wire_velocities, &around, &mut self.wire_pairs, potentials)
    }

    fn velocities(
        &mut self,
        films: Films<'_>,
        sources: Sources<'_>,
        _: &[f64],
        velocities: &mut Vec<DVec3>,
    ) -> Result<f64, SheetError> {
        sources.pairs.potentials_and_gradients(sources.strengths, &mut self.sums)?;
        flow::fluxes(films.layout, films.positions, &self.sums.potentials, &mut self.fluxes);
        flow::velocities(films.layout, films.geometry, &self.fluxes, velocities);
        Ok(flow::kinetic_energy(sources.strengths, &self.sums.potentials))
    }

    fn heads(&mut self, films: Films<'_>, potentials: &[f64], velocities: &[DVec3], heads: &mut Vec<f64>) {
        let Films { layout, geometry, positions, .. } = films;
        let sums = PairSums { vector_potentials: &self.sums.potentials, attractions: &self.sums.energy_gradients };
        convection::heads(layout, geometry, positions, potentials, velocities, sums, heads);
    }
}
