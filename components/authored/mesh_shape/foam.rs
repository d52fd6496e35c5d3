//! Foams: many bubbles that fill a block, or that lie apart and grow or drift into each other.

use std::f64::consts::PI;

use bevy_ecs::component::Component;
use glam::DVec3;
use serde::Deserialize;

use super::bubbles::ball;
use super::{Measured, corners};
use crate::authored::shape::Place;
use crate::quantity::{Length, Ratio, range};

/// Cells along x, y and z, 1 to 1000 each. Written `(5, 5, 5)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(expecting = "three numbers of cells, e.g. (5, 5, 5)")]
pub struct Counts(
    #[serde(deserialize_with = "range::cells")] u32,
    #[serde(deserialize_with = "range::cells")] u32,
    #[serde(deserialize_with = "range::cells")] u32,
);

impl Counts {
    /// Counts along x, y and z; for literals in code.
    #[must_use]
    pub const fn new(x: u32, y: u32, z: u32) -> Self {
        Self(x, y, z)
    }

    /// Counts along x, y and z.
    #[must_use]
    pub const fn get(self) -> [u32; 3] {
        [self.0, self.1, self.2]
    }

    /// Cells in all.
    #[must_use]
    pub fn product(self) -> u64 {
        self.get().map(u64::from).iter().product()
    }

    fn vector(self) -> DVec3 {
        DVec3::from_array(self.get().map(f64::from))
    }
}

/// Kelvin's foam: truncated octahedra with flat walls, all shared, in air.
///
/// `n³` cells at the corners of a cubic grid and the `(n - 1)³` between them: 1, 9, 35, ... Regions count from 1, x fastest, then
/// y, then z; those at the corners first.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KelvinCells {
    /// Centre of the block, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Grid constant, which is the distance between opposite squares of a cell, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub size: Length,
    /// Cells `n` along each edge of the block, 1 to 1000.
    #[serde(deserialize_with = "range::cells")]
    pub count: u32,
}

impl Measured for KelvinCells {
    fn centre(&self) -> DVec3 {
        self.centre.si()
    }

    fn size(&self) -> f64 {
        0.5 * self.size.si()
    }

    /// Exact: six squares and eight hexagons of edge `size / √8` per cell, less what is shared and would be counted twice.
    fn area(&self) -> f64 {
        let (square, hexagon) = (1.0 / 8.0, 3.0 * 3.0_f64.sqrt() / 16.0);
        let (n, between) = (f64::from(self.count), f64::from(self.count - 1));
        let shared_squares = 3.0 * n * n * between + 3.0 * between * between * (between - 1.0).max(0.0);
        let shared_hexagons = 8.0 * between.powi(3);
        let cells = self.bubbles() as f64;
        let squares = 6.0 * cells - shared_squares;
        let hexagons = 8.0 * cells - shared_hexagons;
        (squares * square + hexagons * hexagon) * self.size.si().powi(2)
    }

    /// Those of the eight cells at the corners of the block, whose own are all permutations of (0, ±1/4, ±1/2).
    fn outline(&self) -> Vec<DVec3> {
        let size = self.size.si();
        let flat = |corner: DVec3| [DVec3::new(0.0, 0.5, 1.0), DVec3::new(0.0, 1.0, 0.5)].map(|part| corner * part);
        let turned = |x: DVec3| [x, DVec3::new(x.y, x.z, x.x), DVec3::new(x.z, x.x, x.y)];
        let own: Vec<DVec3> =
            corners(DVec3::ZERO, DVec3::splat(size)).into_iter().flat_map(flat).flat_map(turned).collect();
        let cells = corners(self.centre.si(), DVec3::splat(size * f64::from(self.count - 1)));
        cells.into_iter().flat_map(|cell| own.iter().map(move |corner| cell + *corner)).collect()
    }

    /// Of the squares alone.
    fn flat_normals(&self) -> Vec<DVec3> {
        DVec3::AXES.to_vec()
    }

    fn bubbles(&self) -> u64 {
        let n = u64::from(self.count);
        n.pow(3) + (n - 1).pow(3)
    }
}

/// A block of cubes that share their walls: far from equilibrium, since four films meet at each edge.
///
/// Regions count from 1, x fastest, then y, then z.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lattice {
    /// Centre of the block, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Side of a cube, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub cell: Length,
    /// Cubes along x, y and z.
    pub counts: Counts,
}

impl Measured for Lattice {
    fn centre(&self) -> DVec3 {
        self.centre.si()
    }

    fn size(&self) -> f64 {
        0.5 * self.cell.si()
    }

    /// Exact.
    fn area(&self) -> f64 {
        let n = self.counts.vector();
        let walls = (n.x + 1.0) * n.y * n.z + n.x * (n.y + 1.0) * n.z + n.x * n.y * (n.z + 1.0);
        walls * self.cell.si().powi(2)
    }

    fn outline(&self) -> Vec<DVec3> {
        corners(self.centre.si(), self.cell.si() * self.counts.vector())
    }

    fn flat_normals(&self) -> Vec<DVec3> {
        DVec3::AXES.to_vec()
    }

    fn bubbles(&self) -> u64 {
        self.counts.product()
    }
}

/// Spheres on a cubic lattice, apart from each other. Regions count from 1, x fastest, then y, then z.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SphereLattice {
    /// Centre of the block, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Radius of each sphere, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub radius: Length,
    /// Least distance between neighbours, metres.
    #[serde(deserialize_with = "range::positive")]
    pub gap: Length,
    /// Spheres along x, y and z.
    pub counts: Counts,
}

impl SphereLattice {
    /// Distance between the centres of neighbours, metres.
    #[must_use]
    pub fn pitch(&self) -> f64 {
        2.0 * self.radius.si() + self.gap.si()
    }
}

impl Measured for SphereLattice {
    fn centre(&self) -> DVec3 {
        self.centre.si()
    }

    fn size(&self) -> f64 {
        self.radius.si()
    }

    /// Exact.
    fn area(&self) -> f64 {
        self.bubbles() as f64 * 4.0 * PI * self.radius.si().powi(2)
    }

    fn outline(&self) -> Vec<DVec3> {
        let outermost = self.pitch() * (self.counts.vector() - 1.0);
        corners(self.centre.si(), outermost).into_iter().flat_map(|centre| ball(centre, self.radius.si())).collect()
    }

    fn bubbles(&self) -> u64 {
        self.counts.product()
    }
}

/// A random foam: bubbles in a cluster that share their walls, all space between them theirs.
#[derive(Component, Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Packing {
    /// Centre of the cluster, metres. Default: the origin.
    #[serde(default)]
    pub centre: Place,
    /// Number of bubbles, 1 to 100 000.
    #[serde(deserialize_with = "range::bubbles")]
    pub count: u32,
    /// Mean radius of the spheres that are packed, metres.
    #[serde(deserialize_with = "range::film_size")]
    pub radius: Length,
    /// Radii are drawn evenly from `radius (1 - spread)` to `radius (1 + spread)`, 0 to 0.6. Default 0.
    #[serde(default, deserialize_with = "range::radius_spread")]
    pub spread: Ratio,
    /// Seed of places and radii. Default: made from the scene's seed and the entity's place in the file.
    #[serde(default)]
    pub seed: Option<u64>,
}

impl Packing {
    /// Radius of the cluster, metres, within about 10 %: that of a ball of all packed spheres' volume.
    fn cluster_radius(&self) -> f64 {
        let spread = self.spread.si();
        // The mean of r³ over an even draw is 1 + spread².
        self.radius.si() * (f64::from(self.count) * (1.0 + spread * spread)).cbrt()
    }
}

impl Measured for Packing {
    fn centre(&self) -> DVec3 {
        self.centre.si()
    }

    fn size(&self) -> f64 {
        self.radius.si()
    }

    /// Half of all bubbles' areas, as walls are shared, and half of the cluster's surface, which is not. A bubble of volume `V`
    /// in a foam has about the area `5.3 V^(2/3)`. Within 20 %.
    fn area(&self) -> f64 {
        let (count, spread, radius) = (f64::from(self.count), self.spread.si(), self.radius.si());
        // The mean of r² over an even draw is 1 + spread² / 3.
        let bubbles = count * 5.3 * (4.0 * PI / 3.0).powf(2.0 / 3.0) * (1.0 + spread * spread / 3.0) * radius * radius;
        0.5 * (bubbles + 4.0 * PI * self.cluster_radius().powi(2))
    }

    fn outline(&self) -> Vec<DVec3> {
        ball(self.centre.si(), 1.1 * self.cluster_radius()).collect()
    }

    fn bubbles(&self) -> u64 {
        u64::from(self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_of_one_cube_has_the_area_of_a_cube() {
        let lattice =
            |counts| Lattice { centre: Place::ZERO, cell: Length::from_si(0.02), counts }.area() / 0.02_f64.powi(2);
        assert!((lattice(Counts::new(1, 1, 1)) - 6.0).abs() < 1e-12);
        assert!((lattice(Counts::new(2, 1, 1)) - 11.0).abs() < 1e-12);
    }

    #[test]
    fn blocks_of_kelvin_cells_have_the_area_of_their_walls() {
        let block = |count| KelvinCells { centre: Place::ZERO, size: Length::from_si(1.0), count };
        let cell = (6.0 + 12.0 * 3.0_f64.sqrt()) / 8.0;
        assert!((block(1).area() / cell - 1.0).abs() < 1e-12);
        // The cell between eight others shares its eight hexagons, and those twelve squares among each other.
        let nine = 9.0 * cell - 8.0 * 3.0 * 3.0_f64.sqrt() / 16.0 - 12.0 / 8.0;
        assert!((block(2).area() / nine - 1.0).abs() < 1e-12);
        // A cell of volume V has the area 5.315 V^(2/3) (Weaire and Phelan 1994, for flat faces), in a large block half of it.
        let per_cell = block(1000).area() / block(1000).bubbles() as f64;
        assert!((per_cell / (0.5 * 5.315 * 0.5_f64.powf(2.0 / 3.0)) - 1.0).abs() < 0.003, "{per_cell}");
    }

    #[test]
    fn the_corners_of_kelvins_cells_are_where_four_of_them_meet() {
        let block = KelvinCells { centre: Place::ZERO, size: Length::from_si(1.0), count: 1 };
        let mut corners = block.outline();
        corners.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap());
        corners.dedup();
        assert_eq!(corners.len(), 24);
        // As far from the centre as from the two cells beyond a hexagon and the one beyond a square.
        let cells = [DVec3::X, DVec3::new(0.5, 0.5, 0.5), DVec3::new(0.5, 0.5, -0.5)];
        let corner = *corners.iter().find(|x| x.x == 0.5 && x.y == 0.25).unwrap();
        assert!(cells.iter().all(|cell| (cell.distance(corner) - corner.length()).abs() < 1e-15));
    }

    #[test]
    fn counts_are_whole_and_at_least_one() {
        let read = |text: &str| ron::from_str::<Counts>(text);
        assert_eq!(read("(5, 4, 3)").unwrap().product(), 60);
        for wrong in ["(5, 4)", "(5, 4, 0)", "(5, 4, -3)", "(5, 4, 1001)", "5", "(1, 1, 1, 1)"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }
}
