//! How sheets run: the scene's settings in SI units.

use bevy_ecs::resource::Resource;
use froth_components::authored::method;
use froth_components::authored::method::{Integrator as Authored, Kernel, PairSummation, VortexSheetSettings};
use froth_components::material::Atmosphere;
use froth_sheet::{Discretisation, Integrator, Sliding};
use froth_sheet::{KernelOrder, SheetKernel, Summation};

/// Settings of a sheet. Constant in a run.
#[derive(Resource, Clone, Copy, Debug)]
pub struct SheetRules {
    /// How the equations become numbers on the mesh.
    pub discretisation: Discretisation,
    /// Kernel of the Biot-Savart sum.
    pub kernel: SheetKernel,
    /// How pairs are summed.
    pub summation: Summation,
    /// How steps are made of evaluations.
    pub integrator: Integrator,
    /// Longest substep in capillary times, dimensionless.
    pub courant: f64,
    /// Part of an edge length that a vertex may move in one step, and part of itself by which an edge may change.
    pub cfl: f64,
    /// Diffusivity of circulation, m^2/s.
    pub diffusivity: f64,
    /// Rate at which circulation fades, 1/s.
    pub damping: f64,
    /// How the mesh slides along the films.
    pub sliding: Sliding,
    /// Density of the air, kg/m^3.
    pub density: f64,
}

impl SheetRules {
    /// The rules of a scene with edges of about `edge` metres.
    #[must_use]
    pub fn new(authored: &VortexSheetSettings, air: Atmosphere, edge: f64) -> Self {
        let order = match authored.kernel {
            Kernel::First => KernelOrder::First,
            Kernel::Second => KernelOrder::Second,
            Kernel::Third => KernelOrder::Third,
        };
        Self {
            discretisation: match authored.discretisation {
                method::Discretisation::Variational => Discretisation::Variational,
                method::Discretisation::Pointwise => Discretisation::Pointwise,
            },
            kernel: SheetKernel { order, smoothing_length: authored.smoothing.si() * edge },
            summation: match authored.summation {
                PairSummation::Direct => Summation::Direct,
                PairSummation::Fast(tolerance) => Summation::Fast { tolerance: tolerance.si() },
                PairSummation::Auto(tolerance) => Summation::Auto { tolerance: tolerance.si() },
            },
            integrator: match authored.integrator {
                Authored::Leapfrog => Integrator::Leapfrog,
                Authored::SymplecticEuler => Integrator::SymplecticEuler,
                Authored::RungeKutta4 => Integrator::RungeKutta4,
                Authored::ImplicitMidpoint => Integrator::ImplicitMidpoint,
            },
            courant: authored.courant.si(),
            cfl: authored.cfl.si(),
            diffusivity: authored.diffusivity.si(),
            damping: authored.damping.si(),
            sliding: Sliding {
                strength: authored.sliding.strength.si(),
                full_below: authored.sliding.full_below.si(),
                none_above: authored.sliding.none_above.si(),
            },
            density: air.density,
        }
    }
}
