//! Runs a built-in scene for a law.

use froth_components::film::Area;
use froth_components::kind::Kind;
use froth_components::motion::Position;
use glam::DVec3;

use super::LawError;
use crate::gallery::built_in;
use crate::simulation::Simulation;

/// A built-in scene, changed as a law needs it.
#[derive(Clone)]
pub(super) struct SceneRun {
    name: &'static str,
    text: String,
}

impl SceneRun {
    /// The built-in scene of a name.
    pub(super) fn of(name: &'static str) -> Self {
        let scene = built_in(name).expect("invariant: laws name built-in scenes");
        Self { name, text: scene.text.to_owned() }
    }

    /// Replaces a piece of the scene's text, which must be there.
    pub(super) fn with(mut self, piece: &str, replacement: &str) -> Self {
        assert!(self.text.contains(piece), "invariant: the scene `{}` says `{piece}`", self.name);
        self.text = self.text.replace(piece, replacement);
        self
    }

    /// Makes the particles.
    pub(super) fn begin(&self) -> Result<Simulation, LawError> {
        Ok(Simulation::builder().build_from_text(self.name, &self.text)?)
    }
}

/// Samples `measure` at the start and after every step of at most `step` seconds until `end`, s.
pub(super) fn series(
    simulation: &mut Simulation,
    step: f64,
    end: f64,
    mut measure: impl FnMut(&mut Simulation) -> f64,
) -> Result<Vec<(f64, f64)>, LawError> {
    let mut samples = vec![(simulation.time(), measure(simulation))];
    while !simulation.has_reached(end) {
        let next = (simulation.time() + step).min(end);
        simulation.step_within(next)?;
        samples.push((simulation.time(), measure(simulation)));
    }
    Ok(samples)
}

/// Largest component, relative to `radius`, that the distance of the carriers `K` from the origin has along `pattern`.
pub(super) fn shape_amplitude<K: Kind>(
    simulation: &mut Simulation,
    radius: f64,
    pattern: impl Fn(DVec3) -> f64,
) -> f64 {
    let places = simulation.column::<K, Position>();
    let areas = simulation.column::<K, Area>();
    let terms = places.iter().zip(&areas).map(|(x, a)| {
        // Before the first step no area is measured; carriers are spread evenly then.
        let a = if a.0 > 0.0 { a.0 } else { 1.0 };
        let y = pattern(x.0);
        (a * y * (x.0.length() / radius - 1.0), a * y * y)
    });
    let (along, whole) = terms.fold((0.0, 0.0), |(p, q), (a, b)| (p + a, q + b));
    along / whole
}
