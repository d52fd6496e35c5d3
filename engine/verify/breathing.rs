//! The breathing mode: film mass on the spring of the enclosed gas.
//!
//! # Equation
//! `rho eta d2zeta/dt2 = -(3 gamma p/R - 4 sigma/R^2) zeta`, from `dp = -3 gamma p zeta/R` and
//! `d(4 sigma/R) = -4 sigma zeta/R^2`.
//!
//! # Discretisation
//! The gas is implicit (backward Euler): the frequency is `atan(omega dt)/dt`, second order, and the oscillation is
//! damped at `omega^2 dt/2`. Films never need to resolve this mode; the law does, in steps below a microsecond.

use froth_components::gas::GasVolume;
use froth_components::kind::{EulerianParticle, Region};
use froth_components::motion::NormalSpeed;

use super::finding::{Finding, Refinement};
use super::oscillation::Oscillation;
use super::scene_run::{SceneRun, series};
use super::{Effort, LawError};

const RADIUS: f64 = 0.05;
const TENSION: f64 = 0.03;
const MASS: f64 = 1000.0 * 400e-9;
const OUTSIDE: f64 = 101_325.0;
/// Speed of the film at the start, m/s: an amplitude of 1e-6 of the radius.
const SPEED: f64 = 6e-3;
const PERIODS: f64 = 2.5;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let (count, steps): (u32, [f64; 3]) = effort.choose((500, [8e-7, 4e-7, 2e-7]), (2000, [4e-7, 2e-7, 1e-7]));
    let finding = |(what, exponent, gas): (&str, f64, &str)| {
        let exact = exact_frequency(exponent);
        let mut refinement = Refinement::default();
        let (mut last, mut finest) = (f64::NAN, f64::NAN);
        for step in steps {
            let fit = breathe(count, step, gas, exact)?;
            refinement.add(step, fit.frequency / exact - 1.0);
            (last, finest) = (fit.damping / (0.5 * exact * exact * step), fit.frequency);
        }
        Ok([
            Finding::relative(format!("angular frequency, {what}, rad/s"), exact, finest, 1e-3)
                .converging(&refinement, 1.7),
            Finding::relative(format!("damping by the implicit gas over omega^2 dt/2, {what}"), 1.0, last, 0.02),
        ])
    };
    let cases = [("isothermal", 1.0, "Isothermal"), ("adiabatic", 1.4, "Adiabatic(1.4)")];
    let findings: Result<Vec<_>, LawError> = cases.into_iter().map(finding).collect();
    Ok(findings?.into_iter().flatten().collect())
}

fn exact_frequency(exponent: f64) -> f64 {
    let pressure = OUTSIDE + 4.0 * TENSION / RADIUS;
    ((3.0 * exponent * pressure - 4.0 * TENSION / RADIUS) / (MASS * RADIUS)).sqrt()
}

fn breathe(count: u32, step: f64, gas: &str, exact: f64) -> Result<Oscillation, LawError> {
    let scene = SceneRun::of("shape_mode").with("HarmonicMode(degree: 2, amplitude: \"0.5 %\"),", "");
    let scene = scene.with("Particles(4000)", &format!("Particles({count})"));
    let mut simulation = scene.with("air: None", &format!("air: None, gas: {gas}")).begin()?;
    let rows = simulation.column::<EulerianParticle, NormalSpeed>().len();
    simulation.set_column::<EulerianParticle, _>(&vec![NormalSpeed(SPEED); rows]);
    let rest = simulation.column::<Region, GasVolume>()[0].0;
    let end = PERIODS * std::f64::consts::TAU / exact;
    let samples = series(&mut simulation, step, end, |sim| sim.column::<Region, GasVolume>()[0].0 / rest - 1.0)?;
    Ok(Oscillation::fit(&samples, exact))
}
