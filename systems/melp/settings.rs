//! What the user chose, as numbers.

use crate::operators::conjugate_gradient::StopRule;
use bevy_ecs::resource::Resource;
use froth_components::authored::method::{MelpSettings, Transfer};

/// Support of the transfer kernel between the particle sets, in particle spacings. DEVIATION from Deng 2022, §4.8
/// (4): over a round trip 4 spacings lose six times more kinetic energy.
pub const TRANSFER_SUPPORT: f64 = 2.5;

/// The settings of MELP, with the numerical ones that scenes do not write.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct Melp {
    /// Fraction of the particle spacing that the fastest particle may cross in a step.
    pub cfl: f64,
    /// Whether transfers carry velocity gradients (APIC) or not (PIC).
    pub affine: bool,
    /// Part of a material particle's velocity that is its old one plus the carriers' change (FLIP), 0 to 1.
    pub flip: f64,
    /// Smoothing of tangential velocity between neighbouring carriers per step (XSPH), 0 to 1.
    pub xsph: f64,
    /// Most substeps of the film's own motion in one step of the liquid.
    pub substeps: u32,
    /// When the Marangoni solve may stop.
    pub marangoni: StopRule,
    /// When the redistribution's Poisson solve may stop.
    pub redistribution: StopRule,
    /// Steps between sortings of the material rows.
    pub sort_interval: u64,
}

impl Melp {
    /// The settings a scene gives.
    #[must_use]
    pub fn new(authored: &MelpSettings) -> Self {
        Self {
            cfl: authored.cfl.si(),
            affine: authored.transfer == Transfer::Affine,
            flip: authored.flip.si(),
            xsph: authored.xsph.si(),
            // Without liquid there is nothing that could move less often.
            substeps: if authored.liquid_per_carrier == 0 { 1 } else { authored.substeps },
            marangoni: StopRule { tolerance: 1e-6, max_iterations: 4000 },
            redistribution: StopRule { tolerance: 1e-3, max_iterations: 4000 },
            sort_interval: 8,
        }
    }
}
