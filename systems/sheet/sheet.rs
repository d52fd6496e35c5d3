//! The sheet with its work space, and the stages of one evaluation.
//!
//! | stage | function | equation |
//! |---|---|---|
//! | geometry | [`Sheet::measure`] | area vectors, volume gradients |
//! | gas that comes in | [`Sheet::inflate`] | its flow `u_s` in the [`ambient`] air |
//! | tension | [`Sheet::load`] | `d phi/dt = -p/rho` |
//! | wires | [`Sheet::hold`] | fluxes on wires are given |
//! | Biot-Savart | [`Sheet::flow`] | strengths, vector potential, fluxes, velocities, convection |
//! | integrator | [`Integration`](crate::Integration) | rates to states |
//! | volumes | [`Sheet::meet_volumes`] | projection by the volume gradients |
//! | impulse | [`Sheet::keep_impulse`] | free clusters |
//! | contacts | [`Sheet::calm`] | films in contact give up energy |
//! | damping | [`Sheet::damp`] | diffusion of circulation |
//!
//! What tension, wires and Biot-Savart come to on a mesh is the [discretisation](crate::discretisation)'s to say.

use std::collections::BTreeMap;

use froth_biot_savart::{PairSum, SheetKernel, Summation};
use froth_surface::calculus::volume::{volume_gradients, volumes as measured_volumes};
use froth_surface::calculus::{Incidence, Weights};
use froth_surface::flow::FlowError;
use froth_surface::flow::pressure_system::PressureSystem;
use froth_surface::flow::projection::{Constraint, Multipliers, project};
use froth_surface::{Region, Surface};
use glam::DVec3;

use crate::SheetError;
use crate::ambient::{self, Ambient};
use crate::damping::Damping;
use crate::discretisation::{Discretisation, Films, Scheme, Sources};
use crate::flow;
use crate::geometry::Geometry;
use crate::impulse::Clusters;
use crate::inelastic;
use crate::layout::Layout;
use crate::region_pressures;
use crate::sliding::Sliding;
use crate::wires::{WireSolve, Wires};

/// Largest relative error of a volume after the projection.
const VOLUME_TOLERANCE: f64 = 1e-14;
/// Relative error of a volume that is left to the next step where the projection does not get farther.
const VOLUME_ENOUGH: f64 = 1e-6;
/// Iterations of the projection.
const MOST_SWEEPS: u32 = 50;

/// What acts on the films from outside, and how.
#[derive(Clone, Copy, Debug)]
pub struct Forcing<'a> {
    /// Film tension `2 sigma`, N/m.
    pub tension: Weights<'a>,
    /// Density of the air, kg/m^3.
    pub density: f64,
    /// External forces per vertex, N; empty for none.
    pub forces: &'a [DVec3],
}

/// What the last evaluation measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// Energy of the films, `sum T A`, J.
    pub film_energy: f64,
    /// Kinetic energy of the air, J.
    pub kinetic_energy: f64,
    /// Energy of films and air where the flow was last worked out, J.
    pub energy: f64,
    /// The solve on wires.
    pub wires: WireSolve,
}

/// A sheet: where its numbers lie, and work space.
#[derive(Debug)]
pub struct Sheet {
    /// Where potentials lie.
    pub layout: Layout,
    /// Shape of the films.
    pub geometry: Geometry,
    /// Held vertices.
    pub wires: Wires,
    /// Free clusters.
    pub clusters: Clusters,
    /// Velocities of the air around.
    pub ambient: Ambient,
    /// Pressures per side, Pa.
    pub pressures: Vec<f64>,
    /// Velocities per vertex, m/s.
    pub velocities: Vec<DVec3>,
    /// Rates of the potentials by convection per side, m^2/s^2.
    pub heads: Vec<f64>,
    /// What the last evaluation measured.
    pub measured: Measured,
    incidence: Incidence,
    /// Per label, what potentials of its sides are measured from; open regions have one in common.
    gauge_of: Vec<u32>,
    strengths: Vec<DVec3>,
    pairs: PairSum,
    scheme: Box<dyn Scheme>,
    damping: Damping,
    projection: Projection,
    is_placed: bool,
}

#[derive(Debug, Default)]
struct Projection {
    system: PressureSystem,
    multipliers: Multipliers,
    gradients: Vec<DVec3>,
    inverse: Vec<f64>,
}

impl Sheet {
    /// A sheet without a mesh, in the default discretisation.
    ///
    /// # Errors
    /// [`SheetError::Pairs`] where kernel or summation are refused.
    pub fn new(kernel: SheetKernel, summation: Summation) -> Result<Self, SheetError> {
        Self::discretised(Discretisation::default(), kernel, summation)
    }

    /// A sheet without a mesh.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn discretised(
        discretisation: Discretisation,
        kernel: SheetKernel,
        summation: Summation,
    ) -> Result<Self, SheetError> {
        Ok(Self {
            layout: Layout::default(),
            geometry: Geometry::default(),
            wires: Wires::default(),
            clusters: Clusters::default(),
            ambient: Ambient::default(),
            pressures: Vec::new(),
            velocities: Vec::new(),
            heads: Vec::new(),
            measured: Measured::default(),
            incidence: Incidence::default(),
            gauge_of: Vec::new(),
            strengths: Vec::new(),
            pairs: PairSum::new(kernel, summation)?,
            scheme: discretisation.scheme(kernel)?,
            damping: Damping::default(),
            projection: Projection::default(),
            is_placed: false,
        })
    }

    /// Lays the sheet out on a mesh; to be called after every change of the mesh.
    pub fn rebuild(&mut self, surface: &Surface) {
        self.layout.rebuild(surface);
        self.incidence.rebuild(surface);
        self.wires = Wires::new(&self.layout, surface);
        self.clusters = Clusters::new(&self.layout, surface);
        self.ambient.by_sources.clear();
        self.scheme.rebuild(&self.layout);
        self.projection.system.lay_out(&self.incidence);
        self.gauge_of.clear();
        let labels = self.layout.regions().iter().map(|region| region.0).max().map_or(0, |last| last + 1);
        self.gauge_of.extend((0..labels).map(|label| if surface.is_open(Region(label)) { 0 } else { label }));
    }

    /// Measures the films where they are.
    pub fn measure(&mut self, positions: &[DVec3]) {
        self.geometry.measure(&self.layout, positions);
        self.is_placed = false;
    }

    /// Connectivity in flat arrays.
    #[must_use]
    pub fn incidence(&self) -> &Incidence {
        &self.incidence
    }

    fn place_panels(&mut self) {
        if !self.is_placed {
            self.pairs.place(&self.geometry.centres);
            self.is_placed = true;
        }
    }

    /// Works out how gas that comes into closed regions at rates of `inflows` (m^3/s) moves the air around, with the films where they were
    /// last measured: [`ambient`]. Bubbles smaller than `unresolved` m^3 push it as those of that volume.
    pub fn inflate(&mut self, positions: &[DVec3], inflows: &BTreeMap<Region, f64>, unresolved: f64) {
        let Self { layout, geometry, incidence, ambient: Ambient { by_sources, .. }, .. } = self;
        by_sources.clear();
        if inflows.is_empty() {
            return;
        }
        let mut volumes = Vec::new();
        measured_volumes(incidence, positions, &mut volumes);
        let rate = |(region, volume): (&Region, &f64)| Some((*region, inflows.get(region)? / volume.max(unresolved)));
        let dilatations = incidence.closed().iter().zip(&volumes).filter_map(rate).collect();
        ambient::velocities_by_sources(layout, geometry, positions, &dilatations, by_sources);
    }

    /// The pressures that hold the films against tension and external forces.
    pub fn load(&mut self, positions: &[DVec3], forcing: &Forcing<'_>) {
        let Self { layout, geometry, incidence, wires, scheme, pressures, .. } = self;
        let films = Films { layout, geometry, incidence, wires, positions };
        self.measured.film_energy = scheme.load(films, forcing, pressures);
    }

    /// Changes potentials by what pressures and convection do in `dt` seconds; the rim of open films stays continuous.
    pub fn kick(&self, dt: f64, density: f64, heads: &[f64], potentials: &mut [f64]) {
        let mut rates = Vec::new();
        self.rates(density, heads, &mut rates);
        potentials.iter_mut().zip(rates).for_each(|(phi, rate)| *phi += dt * rate);
        self.layout.tie(potentials);
    }

    /// Rates of the potentials by pressures and the convection of the last evaluation, m^2/s^2 per side.
    pub fn potential_rates(&self, density: f64, rates: &mut Vec<f64>) {
        self.rates(density, &self.heads, rates);
        self.layout.tie(rates);
    }

    /// Rates less their mean over each region, which moves nothing and would grow without end.
    fn rates(&self, density: f64, heads: &[f64], rates: &mut Vec<f64>) {
        rates.clear();
        rates.extend(heads.iter().zip(&self.pressures).map(|(head, p)| head - p / density));
        let mut means = vec![[0.0; 2]; self.gauge_of.len()];
        let gauge = |side: usize| self.gauge_of[self.layout.regions()[side].index()] as usize;
        for (side, rate) in rates.iter().enumerate() {
            let weight = self.geometry.gradients[side].length();
            let mean = &mut means[gauge(side)];
            mean[0] += weight * rate;
            mean[1] += weight;
        }
        for (side, rate) in rates.iter_mut().enumerate() {
            let [sum, weight] = means[gauge(side)];
            *rate -= if weight > 0.0 { sum / weight } else { 0.0 };
        }
    }

    /// Changes the circulation on wires so that films go with them; `wire_velocities` per vertex, m/s.
    ///
    /// # Errors
    /// [`SheetError::WireNotSolved`], [`SheetError::Pairs`].
    pub fn hold(
        &mut self,
        positions: &[DVec3],
        wire_velocities: &[DVec3],
        potentials: &mut [f64],
    ) -> Result<(), SheetError> {
        self.layout.tie(potentials);
        self.measured.wires = WireSolve::default();
        if !self.wires.has_unknowns() {
            return Ok(());
        }
        self.place_panels();
        let seen = self.ambient.seen(wire_velocities, positions.len());
        let Self { layout, geometry, incidence, wires, scheme, strengths, pairs, .. } = self;
        flow::strengths(layout, positions, potentials, strengths);
        let films = Films { layout, geometry, incidence, wires, positions };
        self.measured.wires = scheme.hold(films, Sources { strengths, pairs }, &seen, potentials)?;
        Ok(())
    }

    /// Velocities of the films from the potentials, in the air around, with the mesh's own sliding of one part of the way in
    /// `sliding_interval` seconds, and what convection does.
    ///
    /// # Errors
    /// [`SheetError::Pairs`].
    pub fn flow(
        &mut self,
        positions: &[DVec3],
        potentials: &[f64],
        wire_velocities: &[DVec3],
        density: f64,
        sliding: &Sliding,
        sliding_interval: f64,
    ) -> Result<(), SheetError> {
        self.place_panels();
        let seen = self.ambient.seen(wire_velocities, positions.len());
        let Self { layout, geometry, incidence, wires, scheme, strengths, pairs, velocities, .. } = self;
        flow::strengths(layout, positions, potentials, strengths);
        let films = Films { layout, geometry, incidence, wires, positions };
        let energy = scheme.velocities(films, Sources { strengths, pairs }, potentials, velocities)?;
        sliding.add(layout, geometry, positions, wires.held(), sliding_interval, velocities);
        for (v, w) in velocities.iter_mut().enumerate().filter(|(v, _)| wires.held()[*v]) {
            *w = seen[v];
        }
        self.leave_on_wires();
        let Self { layout, geometry, incidence, wires, scheme, velocities, heads, ambient, .. } = self;
        let films = Films { layout, geometry, incidence, wires, positions };
        scheme.heads(films, potentials, velocities, heads);
        velocities.iter_mut().enumerate().for_each(|(v, w)| *w += ambient.at(v));
        self.measured.kinetic_energy = density * energy;
        self.measured.energy = self.measured.film_energy + self.measured.kinetic_energy;
        Ok(())
    }

    /// Takes from the velocities, as the air around sees them, how it flows along films that hang on wires: those stay.
    fn leave_on_wires(&mut self) {
        let Self { geometry, wires, clusters, velocities, ambient, .. } = self;
        for (v, u) in ambient.by_sources.iter().enumerate() {
            if !clusters.is_free(v) && !wires.held()[v] {
                velocities[v] -= *u - geometry.ranges[v].projector * *u;
            }
        }
    }

    /// Lets circulation diffuse, `diffusivity` in m^2/s, for `dt` seconds.
    ///
    /// # Errors
    /// [`SheetError::DampingNotSolved`].
    pub fn damp(
        &mut self,
        positions: &[DVec3],
        diffusivity: f64,
        dt: f64,
        potentials: &mut [f64],
    ) -> Result<(), SheetError> {
        self.damping.diffuse(&self.layout, positions, diffusivity, dt, potentials)?;
        self.layout.tie(potentials);
        Ok(())
    }

    /// Kinetic energy of the air with the films where they were last measured, J; one sum over pairs.
    ///
    /// # Errors
    /// [`SheetError::Pairs`].
    pub fn kinetic_energy(&mut self, positions: &[DVec3], potentials: &[f64], density: f64) -> Result<f64, SheetError> {
        let fluxes = self.fluxes(positions, potentials)?;
        Ok(density * inelastic::energy(potentials, &fluxes))
    }

    /// Fluxes per side, m^3/s; one sum over pairs.
    fn fluxes(&mut self, positions: &[DVec3], potentials: &[f64]) -> Result<Vec<f64>, SheetError> {
        self.place_panels();
        flow::strengths(&self.layout, positions, potentials, &mut self.strengths);
        let (mut vector_potentials, mut fluxes) = (Vec::new(), Vec::new());
        self.pairs.potentials(&self.strengths, &mut vector_potentials)?;
        flow::fluxes(&self.layout, positions, &vector_potentials, &mut fluxes);
        Ok(fluxes)
    }

    /// Slows the films down at the `chosen` vertices until the air's kinetic energy is at most `most` J; gives what was lost, J.
    /// See [`inelastic`].
    ///
    /// # Errors
    /// [`SheetError::Pairs`].
    pub fn calm(
        &mut self,
        positions: &[DVec3],
        chosen: &[bool],
        density: f64,
        most: f64,
        potentials: &mut [f64],
    ) -> Result<f64, SheetError> {
        let areas = &self.geometry.areas;
        let scales: Vec<f64> = (0..self.layout.side_count() as u32)
            .map(|side| self.layout.vertex_of(side) as usize)
            .map(|v| if chosen[v] && areas[v] > 0.0 { areas[v].recip() } else { 0.0 })
            .collect();
        let mut fluxes = |phi: &mut [f64]| {
            self.layout.tie(phi);
            self.fluxes(positions, phi)
        };
        let lost = inelastic::calm(&scales, most / density, &mut fluxes, potentials)?;
        Ok(density * lost)
    }

    /// Impulse per density of each free cluster, m^4/s.
    #[must_use]
    pub fn impulses(&self, potentials: &[f64]) -> Vec<DVec3> {
        self.clusters.impulses(&self.layout, &self.geometry, potentials)
    }

    /// Impulse per density that external forces per vertex (N) give each free cluster in `dt` seconds, m^4/s.
    #[must_use]
    pub fn impulse_gained(&self, forces: &[DVec3], density: f64, dt: f64) -> Vec<DVec3> {
        self.clusters.sums(forces).into_iter().map(|force| force * (dt / density)).collect()
    }

    /// Impulse per density that each free cluster gains in `dt` seconds as gas that comes in strains the air around it, m^4/s.
    #[must_use]
    pub fn impulse_strained(&self, positions: &[DVec3], potentials: &[f64], dt: f64) -> Vec<DVec3> {
        let Self { layout, clusters, ambient: Ambient { by_sources, .. }, .. } = self;
        if by_sources.is_empty() {
            return vec![DVec3::ZERO; clusters.len()];
        }
        let rates = ambient::strained_impulses(layout, positions, potentials, by_sources);
        clusters.sums(&rates).into_iter().map(|rate| rate * dt).collect()
    }

    /// Gives free clusters the impulse per density (m^4/s) that they shall have, at the shape last measured; those with a vertex in `touching`
    /// have theirs together. The largest velocity that this took, m/s.
    pub fn keep_impulse(
        &self,
        positions: &[DVec3],
        wanted: &[DVec3],
        touching: &[bool],
        potentials: &mut [f64],
    ) -> f64 {
        let together = self.clusters.with_any(touching);
        self.clusters.correct(&self.layout, &self.geometry, positions, wanted, &together, potentials)
    }

    /// Moves positions by the least motion that gives every closed region its volume (m^3), and says how far the farthest
    /// vertex went, metres. Bubbles smaller than `unresolved` m^3 keep the volume that they have where theirs is out of reach.
    ///
    /// # Errors
    /// [`SheetError::Volumes`] where a region has no volume to meet, or cannot meet it.
    pub fn meet_volumes(
        &mut self,
        positions: &mut [DVec3],
        volumes: &BTreeMap<Region, f64>,
        unresolved: f64,
    ) -> Result<f64, SheetError> {
        let closed = self.incidence.closed();
        if closed.is_empty() {
            return Ok(0.0);
        }
        let target = |region: &Region| volumes.get(region).copied().ok_or(FlowError::NoTarget { region: *region });
        let mut targets = closed.iter().map(target).collect::<Result<Vec<f64>, _>>()?;
        let before = positions.to_vec();
        let mut present = Vec::new();
        loop {
            let refusal = match self.project(positions, &targets) {
                Ok(()) => break,
                Err(refusal) => refusal,
            };
            let FlowError::VolumeNotReached { region, .. } = refusal else { return Err(refusal.into()) };
            let row = self.incidence.closed().binary_search(&region).expect("invariant: what is missed is closed");
            positions.copy_from_slice(&before);
            measured_volumes(&self.incidence, positions, &mut present);
            if !(targets[row] < unresolved) || targets[row] == present[row] {
                return Err(refusal.into());
            }
            targets[row] = present[row];
        }
        Ok(positions.iter().zip(&before).map(|(x, old)| x.distance(*old)).fold(0.0, f64::max))
    }

    fn project(&mut self, positions: &mut [DVec3], targets: &[f64]) -> Result<(), FlowError> {
        let Projection { system, multipliers, gradients, inverse } = &mut self.projection;
        volume_gradients(&self.incidence, positions, gradients);
        let free = self.geometry.areas.iter().zip(self.wires.held());
        inverse.clear();
        inverse.extend(free.map(|(area, held)| if *held || !(*area > 0.0) { 0.0 } else { area.recip() }));
        system.fill(&self.incidence, gradients, inverse)?;
        let constraint = Constraint {
            incidence: &self.incidence,
            gradients,
            inverse,
            targets,
            tolerance: VOLUME_TOLERANCE,
            max_iterations: MOST_SWEEPS,
        };
        match project(&constraint, system, positions, multipliers) {
            // A bubble of a few faces gets there slowly: the next step goes on.
            Err(FlowError::VolumeNotReached { error, .. }) if error <= VOLUME_ENOUGH => Ok(()),
            other => other.map(drop),
        }
    }

    /// Pressure of each region above the outside, Pa; that of open regions, which are the outside's air, is 0.
    #[must_use]
    pub fn region_pressures(&self) -> BTreeMap<Region, f64> {
        region_pressures::measure(&self.layout, &self.geometry, &self.pressures, &self.gauge_of)
    }
}
