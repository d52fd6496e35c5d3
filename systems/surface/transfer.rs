//! What becomes of data on vertices when the mesh changes: every operation says which values blend and which areas moved.
//!
//! A method that keeps data per vertex implements [`Transfer`]; the tracker calls it once per committed operation, with the mesh as
//! it is afterwards. Three implementations cover what the methods need: [`Columns`] for values that are
//! interpolated (velocity), [`Amounts`] for conserved ones (liquid, surfactant), and
//! [`Circulations`] for one value per pair of regions.

mod amounts;
mod circulations;
mod columns;
mod sliding;

use glam::DVec3;
use smallvec::SmallVec;

pub use amounts::Amounts;
pub use circulations::Circulations;
pub use columns::Columns;
pub(crate) use sliding::weights_at;

use crate::bodies::Division;
use crate::mesh::Remap;
use crate::rows::{PerVertex, Region, VertexRow};
use crate::surface::Surface;

/// The value of a vertex after an operation as a mean of values before it: `sum of weight * value(parent)`, weights add up to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Blend {
    /// The vertex that takes the value; it may be new, and it may be one of the parents.
    pub vertex: VertexRow,
    /// Where the value comes from.
    pub parents: SmallVec<[(VertexRow, f64); 3]>,
}

/// A vertex whose lumped film area (a third of its faces) an operation changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaChange {
    /// The vertex; 0 before where it is new, 0 after where it is gone.
    pub vertex: VertexRow,
    /// Area before, m^2.
    pub before: f64,
    /// Area after, m^2.
    pub after: f64,
}

/// One committed operation, as data sees it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    /// Values that blend.
    pub blends: SmallVec<[Blend; 2]>,
    /// Vertices whose area changes, each once, ascending.
    pub areas: SmallVec<[AreaChange; 12]>,
    /// A film that closes a gap: `(back, between, front)` where `(back, between)` and `(between, front)` became one film.
    pub fused: SmallVec<[(Region, Region, Region); 2]>,
    /// A region that was joined to another: `(gone, into)`.
    pub joined: Option<(Region, Region)>,
    /// Whether films met or parted, or a neck or window between films of the same regions closed or opened.
    pub meets: bool,
}

/// Data on vertices.
pub trait Transfer {
    /// Called after each operation, with the surface as it is then.
    fn transfer(&mut self, surface: &Surface, change: &Change);

    /// Called when bodies of gas have taken labels of their own, with the surface as it is then. Data without labels has nothing to do.
    fn divide(&mut self, _surface: &Surface, _divisions: &[Division]) {}

    /// Called when the mesh is about to slide along the films, which stay, by a displacement per vertex (metres); `surface` is
    /// as before.
    fn slide(&mut self, _surface: &Surface, _slides: &PerVertex<DVec3>) {}

    /// Called when rows are renumbered.
    fn compact(&mut self, remap: &Remap);
}

/// No data.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoData;

impl Transfer for NoData {
    fn transfer(&mut self, _: &Surface, _: &Change) {}
    fn compact(&mut self, _: &Remap) {}
}

/// Several kinds of data at once.
#[derive(Default)]
pub struct Several<'a>(pub Vec<&'a mut dyn Transfer>);

impl Transfer for Several<'_> {
    fn transfer(&mut self, surface: &Surface, change: &Change) {
        self.0.iter_mut().for_each(|data| data.transfer(surface, change));
    }

    fn divide(&mut self, surface: &Surface, divisions: &[Division]) {
        self.0.iter_mut().for_each(|data| data.divide(surface, divisions));
    }

    fn slide(&mut self, surface: &Surface, slides: &PerVertex<DVec3>) {
        self.0.iter_mut().for_each(|data| data.slide(surface, slides));
    }

    fn compact(&mut self, remap: &Remap) {
        self.0.iter_mut().for_each(|data| data.compact(remap));
    }
}
