//! Edges of films with the panels that meet there, and the dihedral angles of the regions between these.
//!
//! ```text
//!        \  i  /           Looking along a hinge from its first to its second end: panels f, g, h and the regions in the
//!       f \   / g          sectors between. theta_i = pi - (sector of i): positive where region i is convex, and
//!     j    \ /             pi/3 in each of three regions that meet at 120 degrees.
//!           o    k
//!           |              counter-clockwise as seen from the second end
//!           h
//! ```

use froth_surface::calculus::Weights;
use glam::DVec3;
use smallvec::SmallVec;

use crate::geometry::Geometry;
use crate::layout::{Layout, Panel};

/// A panel at a hinge.
#[derive(Clone, Copy, Debug)]
struct Wing {
    panel: u32,
    /// Corners of the panel at the first and second end.
    corners: [u8; 2],
}

impl Wing {
    /// Whether the panel's winding runs from the first end to the second: its front then lies counter-clockwise.
    fn is_forward(&self) -> bool {
        self.corners[1] == (self.corners[0] + 1) % 3
    }

    /// Sides at both ends of the region that lies counter-clockwise of the panel.
    fn ahead(&self, panel: &Panel) -> [u32; 2] {
        let sides = if self.is_forward() { panel.front } else { panel.back };
        self.corners.map(|k| sides[k as usize])
    }

    /// Sides at both ends of the region that lies clockwise of the panel.
    fn behind(&self, panel: &Panel) -> [u32; 2] {
        let sides = if self.is_forward() { panel.back } else { panel.front };
        self.corners.map(|k| sides[k as usize])
    }

    /// The panel's area vector, turned counter-clockwise.
    fn turning(&self, geometry: &Geometry) -> DVec3 {
        let area = geometry.area_vectors[self.panel as usize];
        if self.is_forward() { area } else { -area }
    }
}

#[derive(Clone, Debug)]
struct Hinge {
    ends: [u32; 2],
    wings: SmallVec<[Wing; 3]>,
}

/// A region at a hinge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sector {
    /// Its sides at both ends.
    pub(super) sides: [u32; 2],
    /// Length of the hinge, metres.
    pub(super) length: f64,
    /// Dihedral angle `theta`, radians, -pi to pi; positive where the region is convex.
    pub(super) angle: f64,
    /// Mean film tension of the two panels, N/m.
    pub(super) tension: f64,
}

/// All hinges of a mesh, ascending by their ends; built once per change of the mesh.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hinges {
    hinges: Vec<Hinge>,
}

impl Hinges {
    pub(crate) fn new(layout: &Layout) -> Self {
        let mut wings: Vec<([u32; 2], Wing)> = Vec::with_capacity(3 * layout.panels().len());
        for (row, panel) in layout.panels().iter().enumerate() {
            for k in 0..3u8 {
                let (a, b) = (k, (k + 1) % 3);
                let [v, w] = [a, b].map(|corner| panel.corners[corner as usize]);
                let (ends, corners) = if v < w { ([v, w], [a, b]) } else { ([w, v], [b, a]) };
                wings.push((ends, Wing { panel: row as u32, corners }));
            }
        }
        wings.sort_unstable_by_key(|(ends, wing)| (*ends, wing.panel));
        let hinge = |wings: &[([u32; 2], Wing)]| Hinge {
            ends: wings[0].0,
            wings: wings.iter().map(|(_, wing)| *wing).collect(),
        };
        Self { hinges: wings.chunk_by(|a, b| a.0 == b.0).map(hinge).collect() }
    }

    /// Calls `visit` for every region at every hinge. On a rim, where one panel ends, there is none.
    pub(super) fn for_each_sector(
        &self,
        layout: &Layout,
        geometry: &Geometry,
        positions: &[DVec3],
        tension: Weights<'_>,
        mut visit: impl FnMut(Sector),
    ) {
        for Hinge { ends, wings } in &self.hinges {
            let [a, b] = ends.map(|v| positions[v as usize]);
            let length = a.distance(b);
            let axis = (b - a).normalize_or_zero();
            for (place, wing) in wings.iter().enumerate() {
                let panel = |wing: &Wing| &layout.panels()[wing.panel as usize];
                let sides = wing.ahead(panel(wing));
                let others = wings.iter().enumerate().filter(|(other, _)| *other != place).map(|(_, other)| other);
                let partners = others.filter(|other| other.behind(panel(other)) == sides);
                // Where a region comes to a hinge twice, the nearer panel bounds the sector.
                let nearest = partners
                    .map(|other| (dihedral(axis, wing.turning(geometry), other.turning(geometry)), other))
                    .max_by(|(a, _), (b, _)| a.total_cmp(b));
                if let Some((angle, other)) = nearest {
                    let tension = 0.5 * [wing, other].map(|wing| tension.of(panel(wing).row)).iter().sum::<f64>();
                    visit(Sector { sides, length, angle, tension });
                }
            }
        }
    }
}

/// `pi` less the angle by which `from` turns counter-clockwise about `axis` into `to`.
fn dihedral(axis: DVec3, from: DVec3, to: DVec3) -> f64 {
    axis.dot(from.cross(to)).atan2(-from.dot(to))
}
