//! What a discretisation of vortex sheets has to say: one function for each stage in which discretisations differ.
//!
//! State ([`Potentials`](crate::Potentials)), strengths, integration, volumes, impulse and diffusion are shared: see
//! [`Sheet`](crate::Sheet).
//!
//! | | [`Variational`](Discretisation::Variational) | [`Pointwise`](Discretisation::Pointwise) |
//! |---|---|---|
//! | tension | derivative of the area on the volume gradients | dihedral angles over an area |
//! | motion | least velocities with the fluxes through vertex shares | Biot-Savart at the vertices, along the films too |
//! | convection | derivative of the kinetic energy | none but for what the mesh slides |
//! | wires | symmetric block, conjugate gradients | least squares with a small weight on the change |
//! | modules | [`variational`](crate::variational) | [`pointwise`](crate::pointwise) |

use std::fmt::Debug;

use froth_biot_savart::{PairSum, SheetKernel};
use froth_surface::calculus::Incidence;
use glam::DVec3;

use crate::SheetError;
use crate::geometry::Geometry;
use crate::layout::Layout;
use crate::pointwise::Pointwise;
use crate::sheet::Forcing;
use crate::variational::Variational;
use crate::wires::{WireSolve, Wires};

/// How the equations of a sheet become numbers on a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Discretisation {
    /// A discrete Hamiltonian system: neutral on any mesh, at rest in states of least area.
    #[default]
    Variational,
    /// The paper's: curvature and velocity at the vertices. For comparison; needs diffusion on irregular meshes.
    Pointwise,
}

impl Discretisation {
    /// Its stages.
    pub(crate) fn scheme(self, kernel: SheetKernel) -> Result<Box<dyn Scheme>, SheetError> {
        Ok(match self {
            Self::Variational => Box::new(Variational::new(kernel)?),
            Self::Pointwise => Box::new(Pointwise::new(kernel)?),
        })
    }
}

/// The films as a stage finds them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Films<'a> {
    pub(crate) layout: &'a Layout,
    pub(crate) geometry: &'a Geometry,
    pub(crate) incidence: &'a Incidence,
    pub(crate) wires: &'a Wires,
    /// Per vertex, metres.
    pub(crate) positions: &'a [DVec3],
}

/// What moves the air: strengths of all panels (m^3/s), with the sum in which they are placed.
#[derive(Debug)]
pub(crate) struct Sources<'a> {
    pub(crate) strengths: &'a [DVec3],
    pub(crate) pairs: &'a mut PairSum,
}

/// The stages in which discretisations differ, with their work space.
pub(crate) trait Scheme: Debug + Send + Sync {
    /// Prepares for another mesh.
    fn rebuild(&mut self, layout: &Layout);

    /// Pressures per side (Pa) that hold the films against tension and external forces; energy of the films, J.
    fn load(&mut self, films: Films<'_>, forcing: &Forcing<'_>, pressures: &mut Vec<f64>) -> f64;

    /// Changes potentials on wires so that films go with them; `sources` are those of the potentials as they come.
    fn hold(
        &mut self,
        films: Films<'_>,
        sources: Sources<'_>,
        wire_velocities: &[DVec3],
        potentials: &mut [f64],
    ) -> Result<WireSolve, SheetError>;

    /// Velocities that the air gives the vertices, m/s; kinetic energy of the air per density, m^5/s^2.
    fn velocities(
        &mut self,
        films: Films<'_>,
        sources: Sources<'_>,
        potentials: &[f64],
        velocities: &mut Vec<DVec3>,
    ) -> Result<f64, SheetError>;

    /// Rates of the potentials by convection where vertices move with `velocities`, after [`Self::velocities`]; m^2/s^2 per side.
    fn heads(&mut self, films: Films<'_>, potentials: &[f64], velocities: &[DVec3], heads: &mut Vec<f64>);
}
