//! A sheet that is run without an ECS: the stages in order, without collisions and without remeshing.
//!
//! | what | where |
//! |---|---|
//! | the driver | [`Film`] |
//! | spheres with regular and irregular meshes, their modes | [`spheres`] |

#![allow(dead_code, unreachable_pub, missing_docs, reason = "each test binary uses its part")]

pub mod spheres;

use std::collections::BTreeMap;

use froth_biot_savart::{SheetKernel, Summation};
use froth_sheet::potentials::centre;
use froth_sheet::step_length::{capillary_time, shortest_edge};
use froth_sheet::{Discretisation, Forcing, Integration, Integrator, Next, Rates, Sheet, SheetState, Sliding};
use froth_surface::calculus::Weights;
use froth_surface::{LabelledTriangles, Region, Surface};
use glam::DVec3;

pub struct Film {
    pub surface: Surface,
    pub sheet: Sheet,
    pub sheet_kernel: SheetKernel,
    pub state: SheetState,
    pub heads: Vec<f64>,
    pub settings: Settings,
    pub volumes: BTreeMap<Region, f64>,
    /// Rates at which gas comes into regions, m^3/s.
    pub inflows: BTreeMap<Region, f64>,
    pub wire_velocities: Vec<DVec3>,
    pub forces: Vec<DVec3>,
    /// Seconds since the start.
    pub time: f64,
    /// How far the farthest vertex went for the sake of volumes in the last step, metres.
    pub corrected: f64,
    integration: Integration,
}

/// Film tension and density are 1 unless said otherwise.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub discretisation: Discretisation,
    pub integrator: Integrator,
    pub sliding: Sliding,
    pub diffusivity: f64,
    pub density: f64,
    pub tension: f64,
    pub keeps_volumes: bool,
    pub keeps_impulse: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            discretisation: Discretisation::default(),
            integrator: Integrator::Leapfrog,
            sliding: Sliding::NONE,
            diffusivity: 0.0,
            density: 1.0,
            tension: 1.0,
            keeps_volumes: true,
            keeps_impulse: true,
        }
    }
}

/// Says what was measured beside its bar; shown with `--nocapture`.
#[allow(clippy::print_stdout, reason = "numbers for those who ask")]
pub fn report(text: impl std::fmt::Display) {
    println!("{text}");
}

/// Mean length of the sides of films, metres.
pub fn mean_edge(surface: &Surface) -> f64 {
    let films = surface.mesh.faces().filter(|(_, face)| !face.is_ghost());
    let perimeters = films.map(|(row, _)| {
        let [a, b, c] = surface.corners(row);
        a.distance(b) + b.distance(c) + c.distance(a)
    });
    let (sum, count) = perimeters.fold((0.0, 0), |(sum, count), perimeter| (sum + perimeter, count + 3));
    sum / f64::from(count)
}

impl Film {
    /// Films at rest, with the default kernel.
    pub fn new(triangles: &LabelledTriangles, settings: Settings) -> Self {
        let surface = Surface::from_triangles(triangles);
        let smoothing = 0.75 * mean_edge(&surface);
        Self::with_kernel(surface, SheetKernel::third_order(smoothing), settings)
    }

    pub fn with_kernel(surface: Surface, kernel: SheetKernel, settings: Settings) -> Self {
        let mut sheet = Sheet::discretised(settings.discretisation, kernel, Summation::Direct).unwrap();
        sheet.rebuild(&surface);
        sheet.measure(&surface.positions);
        let sides = sheet.layout.side_count();
        let state = SheetState { positions: surface.positions.0.clone(), potentials: vec![0.0; sides] };
        let measured = surface.volumes();
        let closed = surface.mesh.regions().into_iter().filter(|region| !surface.is_open(*region));
        let volumes = closed.map(|region| (region, measured[region.index()])).collect();
        let vertices = surface.positions.len();
        Self {
            surface,
            sheet,
            sheet_kernel: kernel,
            state,
            heads: vec![0.0; sides],
            settings,
            volumes,
            inflows: BTreeMap::new(),
            wire_velocities: vec![DVec3::ZERO; vertices],
            forces: Vec::new(),
            time: 0.0,
            corrected: 0.0,
            integration: Integration::default(),
        }
    }

    /// Moves every vertex to `place(x)`; closed regions keep the volumes that they have then.
    pub fn reshape(&mut self, place: impl Fn(DVec3) -> DVec3) {
        self.state.positions.iter_mut().for_each(|x| *x = place(*x));
        self.surface.positions.0.clone_from(&self.state.positions);
        let measured = self.surface.volumes();
        self.volumes.iter_mut().for_each(|(region, volume)| *volume = measured[region.index()]);
        self.sheet.measure(&self.state.positions);
    }

    /// Potential `phi = value(x)` on the sides of a region, nothing else changed.
    pub fn set_potential(&mut self, region: Region, value: impl Fn(DVec3) -> f64) {
        let layout = &self.sheet.layout;
        for side in (0..layout.side_count()).filter(|side| layout.regions()[*side] == region) {
            self.state.potentials[side] = value(self.state.positions[layout.vertex_of(side as u32) as usize]);
        }
    }

    /// Circulation `Gamma = value(x)` from the region in the back of a film to that in front: half on either side.
    pub fn set_circulation(&mut self, value: impl Fn(DVec3) -> f64) {
        for panel in self.sheet.layout.panels() {
            for k in 0..3 {
                let gamma = value(self.state.positions[panel.corners[k] as usize]);
                self.state.potentials[panel.front[k] as usize] = 0.5 * gamma;
                self.state.potentials[panel.back[k] as usize] = -0.5 * gamma;
            }
        }
    }

    /// Evaluates flow and rates at the state as it is.
    pub fn evaluate(&mut self, dt: f64) {
        let Self { sheet, state, settings, forces, wire_velocities, inflows, .. } = self;
        let forcing = Forcing { tension: Weights::Uniform(settings.tension), density: settings.density, forces };
        sheet.measure(&state.positions);
        sheet.inflate(&state.positions, inflows, 0.0);
        sheet.load(&state.positions, &forcing);
        sheet.hold(&state.positions, wire_velocities, &mut state.potentials).unwrap();
        let SheetState { positions, potentials } = &*state;
        sheet.flow(positions, potentials, wire_velocities, settings.density, &settings.sliding, dt).unwrap();
    }

    pub fn step(&mut self, dt: f64) {
        let settings = self.settings;
        self.sheet.measure(&self.state.positions);
        let impulses = self.sheet.impulses(&self.state.potentials);
        let kicks = settings.integrator.kicks();
        if let Some([before, _]) = kicks {
            self.kick(before * dt);
        }
        self.integration.begin(&self.state);
        let mut rates = Vec::new();
        loop {
            self.evaluate(dt);
            self.sheet.potential_rates(settings.density, &mut rates);
            let taken = Rates { velocities: &self.sheet.velocities, potentials: &rates };
            let next = self.integration.take(settings.integrator, dt, taken, &mut self.state).unwrap();
            if next == Next::Finish {
                break;
            }
        }
        self.heads.clone_from(&self.sheet.heads);
        for (region, inflow) in &self.inflows {
            *self.volumes.get_mut(region).unwrap() += inflow * dt;
        }
        if settings.keeps_volumes {
            self.corrected = self.sheet.meet_volumes(&mut self.state.positions, &self.volumes, 0.0).unwrap();
        }
        self.sheet.measure(&self.state.positions);
        if let Some([_, after]) = kicks {
            self.kick(after * dt);
        }
        self.sheet.damp(&self.state.positions, settings.diffusivity, dt, &mut self.state.potentials).unwrap();
        if settings.keeps_impulse {
            let forcing = Forcing {
                tension: Weights::Uniform(settings.tension),
                density: settings.density,
                forces: &self.forces,
            };
            let gained = self.sheet.impulse_gained(forcing.forces, forcing.density, dt);
            let strained = self.sheet.impulse_strained(&self.state.positions, &self.state.potentials, dt);
            let gains = gained.into_iter().zip(strained).map(|(gain, strained)| gain + strained);
            let wanted: Vec<DVec3> = impulses.iter().zip(gains).map(|(p, gain)| *p + gain).collect();
            self.sheet.keep_impulse(&self.state.positions, &wanted, &[], &mut self.state.potentials);
        }
        centre(&self.sheet.layout, &mut self.state.potentials);
        self.time += dt;
        self.surface.positions.0.clone_from(&self.state.positions);
    }

    fn kick(&mut self, dt: f64) {
        let Self { sheet, state, settings, forces, .. } = self;
        let forcing = Forcing { tension: Weights::Uniform(settings.tension), density: settings.density, forces };
        sheet.load(&state.positions, &forcing);
        sheet.kick(dt, settings.density, &self.heads, &mut state.potentials);
    }

    /// Kinetic and film energy of the state, evaluated afresh.
    pub fn energies(&mut self) -> [f64; 2] {
        self.evaluate(1.0);
        [self.sheet.measured.kinetic_energy, self.sheet.measured.film_energy]
    }

    /// `C` times the capillary time of the shortest edge, s.
    pub fn capillary_step(&self, courant: f64) -> f64 {
        let Settings { density, tension, .. } = self.settings;
        courant * capillary_time(shortest_edge(&self.sheet.layout, &self.state.positions), density, 0.5 * tension)
    }

    /// Steps of at most `courant` capillary times until `end` (s); calls `look` after every `stride`-th.
    pub fn run(&mut self, courant: f64, end: f64, stride: usize, mut look: impl FnMut(&mut Self)) {
        let count = ((end - self.time) / self.capillary_step(courant)).ceil();
        let dt = (end - self.time) / count;
        for number in 1..=count as usize {
            self.step(dt);
            if number % stride == 0 {
                look(self);
            }
        }
    }

    /// Mean of `value(v)` over vertices by area.
    pub fn mean(&self, value: impl Fn(usize) -> f64) -> f64 {
        let areas = &self.sheet.geometry.areas;
        areas.iter().enumerate().map(|(v, area)| area * value(v)).sum::<f64>() / areas.iter().sum::<f64>()
    }
}
