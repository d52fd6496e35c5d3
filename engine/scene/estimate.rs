//! What a scene will need, known before anything is allocated.

use std::fmt;
use std::fs;

use froth_components::authored::film_shape::FilmShape;
use froth_components::authored::method::MethodChoice;
use froth_components::authored::resolution::VERTEX_AREA;

use super::Scene;

/// Memory of one Eulerian particle with its share of neighbour lists and matrices, bytes. Peak of `froth bench` at 64 000
/// particles without liquid, rounded up: 2130.
pub const BYTES_PER_EULERIAN: u64 = 2200;
/// Memory of one Lagrangian particle, bytes. What 16 of them per Eulerian one add to that peak, rounded up: 594.
pub const BYTES_PER_LAGRANGIAN: u64 = 600;
/// Memory of one mesh vertex with its two faces, bytes: columns, incidence, collision boxes, and its rows of the sparse system
/// of an implicit step with the factors. A bound from counting them.
pub const BYTES_PER_VERTEX: u64 = 4000;
/// Rows of boundary particles along a pinned rim.
pub const BOUNDARY_ROWS: f64 = 5.0;
/// Memory assumed where the system does not tell, bytes.
const ASSUMED_MEMORY: u64 = 16 << 30;

/// Numbers of carriers and memory, from areas and resolution alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Distance between carriers, metres: of Eulerian particles, or the length of a mesh's edges.
    pub spacing: f64,
    /// What the films are made of.
    pub rows: Rows,
    /// Memory of all of them, bytes.
    pub bytes: u64,
}

/// What films are made of, by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rows {
    /// Particles.
    Particles {
        /// Eulerian ones, on all films.
        eulerian: u64,
        /// Lagrangian ones, on all films.
        lagrangian: u64,
        /// Boundary particles along all pinned rims; they are Eulerian ones to the memory.
        boundary: u64,
    },
    /// Mesh vertices, and the faces between them.
    Mesh {
        /// Vertices of all films.
        vertices: u64,
        /// Faces of all films.
        faces: u64,
    },
}

impl Rows {
    /// Particles that `spacing²` of film each makes. Conversion saturates: 1e30 particles are `u64::MAX`, and too many in any case.
    fn particles(films: &[FilmShape], spacing: f64, liquid_per_carrier: u32) -> Self {
        let eulerian = (area(films) / spacing.powi(2)).round() as u64;
        let rim: f64 = films.iter().map(FilmShape::rim).sum();
        Self::Particles {
            eulerian,
            lagrangian: eulerian.saturating_mul(u64::from(liquid_per_carrier)),
            boundary: (BOUNDARY_ROWS * rim / spacing).round() as u64,
        }
    }

    /// Vertices of equilateral triangles, or of the mesh that a file brings where it is finer.
    fn mesh(films: &[FilmShape], edge: f64) -> Self {
        let vertices = |film: &FilmShape| {
            let even = (film.area() / (VERTEX_AREA * edge.powi(2))).round() as u64;
            even.max(film.own_vertices())
        };
        let vertices = films.iter().map(vertices).fold(0, u64::saturating_add);
        Self::Mesh { vertices, faces: vertices.saturating_mul(2) }
    }

    /// Eulerian particles or vertices: what carries the film.
    #[must_use]
    pub fn carriers(&self) -> u64 {
        match *self {
            Self::Particles { eulerian, .. } => eulerian,
            Self::Mesh { vertices, .. } => vertices,
        }
    }

    /// What carriers are called in a sentence about all of them.
    pub(super) fn carrier_name(&self) -> &'static str {
        match self {
            Self::Particles { .. } => "Eulerian particles",
            Self::Mesh { .. } => "vertices",
        }
    }

    /// The same in short, where no other kind is spoken of.
    pub(super) fn noun(&self) -> &'static str {
        match self {
            Self::Particles { .. } => "particles",
            Self::Mesh { .. } => "vertices",
        }
    }

    /// Area of film per carrier, in squares of the spacing.
    fn carrier_area(&self) -> f64 {
        match self {
            Self::Particles { .. } => 1.0,
            Self::Mesh { .. } => VERTEX_AREA,
        }
    }

    fn bytes(&self) -> u64 {
        match *self {
            Self::Particles { eulerian, lagrangian, boundary } => {
                let carriers = eulerian.saturating_add(boundary).saturating_mul(BYTES_PER_EULERIAN);
                carriers.saturating_add(lagrangian.saturating_mul(BYTES_PER_LAGRANGIAN))
            }
            Self::Mesh { vertices, .. } => vertices.saturating_mul(BYTES_PER_VERTEX),
        }
    }
}

impl fmt::Display for Rows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Particles { eulerian, lagrangian, boundary } => {
                write!(f, "{eulerian} eulerian, {lagrangian} lagrangian, {boundary} boundary")
            }
            Self::Mesh { vertices, faces } => write!(f, "{vertices} vertices, {faces} faces"),
        }
    }
}

impl Estimate {
    pub(super) fn of(scene: &Scene) -> Self {
        let films: Vec<FilmShape> = scene.films().map(|(_, shape)| shape).collect();
        let resolution = scene.header.resolution;
        let (spacing, rows) = match scene.header.method {
            MethodChoice::Melp(melp) => {
                let spacing = resolution.spacing(area(&films));
                (spacing, Rows::particles(&films, spacing, melp.liquid_per_carrier))
            }
            _ => {
                let edge = resolution.edge(area(&films));
                (edge, Rows::mesh(&films, edge))
            }
        };
        Self { spacing, rows, bytes: rows.bytes() }
    }

    /// Eulerian particles or mesh vertices on all films.
    #[must_use]
    pub fn carriers(&self) -> u64 {
        self.rows.carriers()
    }

    /// Carriers on a film of some area, square metres.
    pub(super) fn carriers_on(&self, area: f64) -> u64 {
        (area / (self.rows.carrier_area() * self.spacing.powi(2))).round() as u64
    }

    /// Largest spacing that puts so many carriers on a film of some area, metres. `area` in square metres.
    pub(super) fn spacing_for(&self, carriers: u64, area: f64) -> f64 {
        (area / (self.rows.carrier_area() * carriers as f64)).sqrt()
    }

    /// Carriers that would fit into `available` bytes at the same proportions.
    pub(super) fn fitting(&self, available: u64) -> u64 {
        (self.carriers() as f64 * (available as f64 / self.bytes.max(1) as f64)) as u64
    }
}

/// Area of all films together, square metres.
fn area(films: &[FilmShape]) -> f64 {
    films.iter().map(FilmShape::area).sum()
}

/// Memory that this machine can give, bytes.
#[must_use]
pub fn available_memory() -> u64 {
    fs::read_to_string("/proc/meminfo").ok().and_then(|text| available_in(&text)).unwrap_or(ASSUMED_MEMORY)
}

/// The line `MemAvailable:  12345 kB`.
fn available_in(meminfo: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    kilobytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_available_memory_is_read() {
        assert_eq!(available_in("MemTotal:  9 kB\nMemAvailable:    2048 kB\nBuffers: 1 kB\n"), Some(2 << 20));
        assert_eq!(available_in("nothing"), None);
    }
}
