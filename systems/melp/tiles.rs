//! Tiles: runs of rows that lie close together and share one list of the carriers around them.
//!
//! Rows are sorted by Morton code, so a run of consecutive rows is mostly one patch of film. A [`Tile`] packs the
//! carriers in reach of any of its rows, and every row looks for its own among those few, in memory that is at hand.
//!
//! # Discretisation
//! Rows are worked on in pieces of fixed length, one writer each. Sums over carriers ([`gather`](super::gather)) are
//! kept per tile and added in the order of tiles, so the bits do not depend on the number of threads.

use super::links::Carriers;
use super::settings::TRANSFER_SUPPORT;
use crate::neighbours::kernel::Kernel;
use crate::operators::stencil::SAME_SHEET;
use froth_components::identity::InRegion;
use froth_components::motion::{Normal, Position};
use glam::{DVec2, DVec3};
use std::ops::Range;

/// Rows of one parallel piece of work; tiles do not cross pieces.
pub const PIECE: usize = 1024;
/// Most rows of a tile.
const LONGEST: usize = 128;
/// Square of the reach, in its own units, with a margin for single precision.
const NEARLY_ONE: f32 = 1.0 + 1e-5;
/// Widest tile along an axis, in spacings.
const WIDEST: f64 = 2.0;

/// Rows that look for carriers.
#[derive(Clone, Copy)]
pub struct Rows<'a> {
    /// Places.
    pub positions: &'a [Position],
    /// Unit normals.
    pub normals: &'a [Normal],
    /// Regions.
    pub regions: &'a [InRegion],
}

impl<'a> Rows<'a> {
    /// A part of the rows.
    #[must_use]
    pub fn part(&self, range: Range<usize>) -> Self {
        let Self { positions, normals, regions } = self;
        Self { positions: &positions[range.clone()], normals: &normals[range.clone()], regions: &regions[range] }
    }

    /// The rows of a piece.
    #[must_use]
    pub fn piece(&self, piece: usize) -> Self {
        self.part(piece * PIECE..((piece + 1) * PIECE).min(self.positions.len()))
    }

    /// Number of pieces.
    #[must_use]
    pub fn pieces(&self) -> usize {
        self.positions.len().div_ceil(PIECE)
    }

    /// The longest run from `start` that is one tile: one region, at most `widest` metres along each axis.
    fn tile_from(&self, start: usize, widest: f64) -> Range<usize> {
        let first = self.positions[start].0;
        let (mut low, mut high) = (first, first);
        let mut end = start + 1;
        let last = (start + LONGEST).min(self.positions.len());
        while end < last && self.regions[end] == self.regions[start] {
            low = low.min(self.positions[end].0);
            high = high.max(self.positions[end].0);
            if (high - low).max_element() > widest {
                break;
            }
            end += 1;
        }
        start..end
    }
}

/// A row and its tangent plane.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// Place.
    pub place: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// Tangents: what they are depends on the normal alone.
    pub tangents: [DVec3; 2],
}

impl Site {
    /// The frame at a place.
    #[must_use]
    #[inline]
    pub fn new(place: DVec3, normal: DVec3) -> Self {
        Self { place, normal, tangents: normal.any_orthonormal_pair().into() }
    }

    /// The tangential part of `r` in the site's own coordinates.
    #[must_use]
    #[inline]
    pub fn along(&self, r: DVec3) -> DVec2 {
        DVec2::new(r.dot(self.tangents[0]), r.dot(self.tangents[1]))
    }
}

/// A carrier in reach of a row.
#[derive(Clone, Copy, Debug, Default)]
pub struct Hit {
    /// Number of the carrier within the tile.
    pub slot: u32,
    /// Kernel value, 1/m^2.
    pub kernel: f64,
    /// From the row to the carrier, tangential, in the row's coordinates, m.
    pub along: DVec2,
}

/// The carriers around one tile, and work space for its rows.
#[derive(Clone, Debug, Default)]
pub struct Tile {
    /// Rows of the carriers.
    rows: Vec<u32>,
    places: Vec<DVec3>,
    /// Corner of the tile.
    origin: DVec3,
    /// The places again, axis by axis, from the origin in units of the reach: what the search looks through.
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    normals: Vec<DVec3>,
    /// Whether some carrier may be on another sheet than some row.
    is_mixed: bool,
    squares: Vec<f32>,
    near: Vec<u32>,
    hits: Vec<Hit>,
}

impl Tile {
    /// Cuts `rows` into tiles and calls `work` with each, its carriers found.
    pub fn for_each(&mut self, carriers: Carriers, rows: Rows, mut work: impl FnMut(&mut Self, Range<usize>)) {
        let mut start = 0;
        while start < rows.positions.len() {
            let range = rows.tile_from(start, WIDEST * carriers.spacing);
            start = range.end;
            self.find_carriers(carriers, rows.part(range.clone()));
            work(self, range);
        }
    }

    /// Packs the carriers of the rows' region within reach of the box around the rows.
    fn find_carriers(&mut self, carriers: Carriers, rows: Rows) {
        let reach = TRANSFER_SUPPORT * carriers.spacing;
        let (region, normal) = (rows.regions[0], rows.normals[0].0);
        let places = rows.positions.iter().map(|p| p.0);
        let (low, high) = places.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        let turned = rows.normals.iter().map(|n| n.0.distance_squared(normal)).fold(0.0, f64::max).sqrt();
        self.clear();
        self.origin = low;
        carriers.cells.for_each_in_box(low - reach, high + reach, |row| {
            let place = carriers.positions[row].0;
            let outside = (low - place).max(place - high).max(DVec3::ZERO);
            let agreement = carriers.normals[row].0.dot(normal);
            // n.m differs from n.m' by at most |m - m'|: beyond `turned`, all rows agree on the sheet.
            if outside.length_squared() < reach * reach
                && carriers.regions[row] == region
                && agreement + turned > SAME_SHEET
            {
                self.is_mixed |= agreement - turned <= SAME_SHEET;
                self.push(row, place, carriers.normals[row].0, reach);
            }
        });
        self.squares.resize(self.rows.len(), 0.0);
        self.near.resize(self.rows.len(), 0);
    }

    fn clear(&mut self) {
        self.is_mixed = false;
        self.rows.clear();
        self.places.clear();
        self.normals.clear();
        [&mut self.x, &mut self.y, &mut self.z].into_iter().for_each(Vec::clear);
    }

    fn push(&mut self, row: usize, place: DVec3, normal: DVec3, reach: f64) {
        let scaled = ((place - self.origin) / reach).as_vec3();
        self.rows.push(row as u32);
        self.places.push(place);
        self.x.push(scaled.x);
        self.y.push(scaled.y);
        self.z.push(scaled.z);
        self.normals.push(normal);
    }

    /// Rows of the tile's carriers, by slot.
    #[must_use]
    pub fn carriers(&self) -> &[u32] {
        &self.rows
    }

    /// Row and unit normal of the carrier in a slot.
    #[must_use]
    #[inline]
    pub fn carrier(&self, slot: u32) -> (usize, DVec3) {
        (self.rows[slot as usize] as usize, self.normals[slot as usize])
    }

    /// What [`Tile::find_hits`] found.
    #[must_use]
    #[inline]
    pub fn hits(&self) -> &[Hit] {
        &self.hits
    }

    /// Puts the slots of the carriers in reach of a row in front of `near`; their number.
    ///
    /// Single precision decides, with a margin: a carrier just out of reach may be among them, where kernels vanish.
    #[inline]
    fn find_near(&mut self, kernel: &Kernel, place: DVec3, normal: DVec3) -> usize {
        let Self { origin, x, y, z, squares, near, normals, .. } = self;
        let place = ((place - *origin) / kernel.support).as_vec3();
        for (((square, x), y), z) in squares.iter_mut().zip(&*x).zip(&*y).zip(&*z) {
            let (dx, dy, dz) = (x - place.x, y - place.y, z - place.z);
            *square = dx * dx + dy * dy + dz * dz;
        }
        let mut count = 0;
        for (slot, square) in squares.iter().enumerate() {
            near[count] = slot as u32;
            count += usize::from(*square < NEARLY_ONE);
        }
        if self.is_mixed {
            let mut kept = 0;
            for k in 0..count {
                near[kept] = near[k];
                kept += usize::from(normals[near[k] as usize].dot(normal) > SAME_SHEET);
            }
            count = kept;
        }
        count
    }

    /// Calls `visit(row, offset to the carrier, kernel value)` for every carrier of the same sheet in reach.
    #[inline]
    pub fn for_each_near(
        &mut self,
        kernel: &Kernel,
        place: DVec3,
        normal: DVec3,
        mut visit: impl FnMut(usize, DVec3, f64),
    ) {
        let count = self.find_near(kernel, place, normal);
        for &slot in &self.near[..count] {
            let k = slot as usize;
            let r = self.places[k] - place;
            visit(self.rows[k] as usize, r, kernel.value(r.length_squared()));
        }
    }

    /// Finds the carriers of the same sheet in reach of a site.
    #[inline]
    pub fn find_hits(&mut self, kernel: &Kernel, site: &Site) {
        let count = self.find_near(kernel, site.place, site.normal);
        let Self { places, near, hits, .. } = self;
        hits.clear();
        hits.extend(near[..count].iter().map(|&slot| {
            let r = places[slot as usize] - site.place;
            Hit { slot, kernel: kernel.value(r.length_squared()), along: site.along(r) }
        }));
    }
}
