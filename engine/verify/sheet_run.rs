//! Free films in air for the laws of vortex sheets: variants of one scene, and what is measured where the films are.
//!
//! # Equation
//! Modes of a bubble in air: `omega^2 = n (n - 1)(n + 1)(n + 2) 2 sigma/((2 n + 1) rho R^3)` (Lamb 1932, §275, air on both sides, two
//! interfaces). Energy `K + 2 sigma A`.

use std::f64::consts::TAU;

use froth_sheet::{Potentials, Sheet, Sliding, Summation};
use froth_systems::vortex_sheet::settings::SheetRules;

use super::LawError;
use super::mesh_run::MeshRun;
use super::scene_run::SceneRun;

/// Tension of one interface, N/m.
pub(super) const TENSION: f64 = 0.03;
/// Density of the air, kg/m^3.
pub(super) const DENSITY: f64 = 1.2;
/// No motion of the mesh but that of the films.
pub(super) const AS_IT_IS: &str = "sliding: (strength: 0), remesh: Remesh(enabled: false)";

/// A scene of one free film: `shape` with what changes it, `resolution`, and settings of the method, as scene files write them.
pub(super) fn free_film(shape: &str, resolution: &str, settings: &str) -> SceneRun {
    SceneRun::of("cube_oscillation")
        .with("Cube(side: \"8 cm\")", shape)
        .with("Spacing(\"3.2 mm\")", resolution)
        .with("VortexSheet()", &format!("VortexSheet({settings})"))
}

/// Angular frequency of a mode of a bubble in air, rad/s.
pub(super) fn air_frequency(degree: u32, radius: f64) -> f64 {
    let n = f64::from(degree);
    let stiffness = n * (n - 1.0) * (n + 1.0) * (n + 2.0) * 2.0 * TENSION;
    (stiffness / ((2.0 * n + 1.0) * DENSITY * radius.powi(3))).sqrt()
}

/// Period of a mode of a bubble in air, s.
pub(super) fn air_period(degree: u32, radius: f64) -> f64 {
    TAU / air_frequency(degree, radius)
}

/// Energies of a film and the air, J.
#[derive(Clone, Copy, Debug)]
pub(super) struct Energies {
    /// Of the film, `2 sigma A`.
    pub(super) film: f64,
    /// Of the air's motion.
    pub(super) kinetic: f64,
}

impl Energies {
    /// Both together, J.
    pub(super) fn total(self) -> f64 {
        self.film + self.kinetic
    }
}

/// Energies of the films as they are. What a step observes comes from its last evaluation, before the films have moved.
pub(super) fn energies(run: &mut MeshRun) -> Result<Energies, LawError> {
    let surface = run.surface();
    let world = run.simulation.world();
    let rules = world.resource::<SheetRules>();
    let mut sheet = Sheet::new(rules.kernel, Summation::Direct)?;
    sheet.rebuild(&surface);
    sheet.measure(&surface.positions);
    let (mut potentials, mut heads) = (Vec::new(), Vec::new());
    world.resource::<Potentials>().gather(&sheet.layout, &mut potentials, &mut heads);
    sheet.flow(&surface.positions, &potentials, &[], rules.density, &Sliding::NONE, 1.0)?;
    let film = 2.0 * TENSION * surface.film_area();
    Ok(Energies { film, kinetic: sheet.measured.kinetic_energy })
}
