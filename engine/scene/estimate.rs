//! What a scene will need, known before anything is allocated.

use std::fs;

use froth_components::authored::method::MethodChoice;
use froth_components::authored::shape::Shape;

use super::Scene;

/// Memory of one Eulerian particle with its share of neighbour lists and matrices, bytes. Peak of `froth bench` at 64 000
/// particles without liquid, rounded up: 2130.
pub const BYTES_PER_EULERIAN: u64 = 2200;
/// Memory of one Lagrangian particle, bytes. What 16 of them per Eulerian one add to that peak, rounded up: 594.
pub const BYTES_PER_LAGRANGIAN: u64 = 600;
/// Rows of boundary particles along a pinned rim.
pub const BOUNDARY_ROWS: f64 = 5.0;
/// Memory assumed where the system does not tell, bytes.
const ASSUMED_MEMORY: u64 = 16 << 30;

/// Numbers of particles and memory, from areas and resolution alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Distance between Eulerian particles, metres.
    pub spacing: f64,
    /// Eulerian particles on all films.
    pub eulerian: u64,
    /// Lagrangian particles on all films.
    pub lagrangian: u64,
    /// Boundary particles along all pinned rims; they are Eulerian ones to the memory.
    pub boundary: u64,
    /// Memory of all of them, bytes.
    pub bytes: u64,
}

impl Estimate {
    pub(super) fn of(scene: &Scene) -> Self {
        let films: Vec<Shape> = scene.films().map(|(_, shape)| shape).collect();
        let area: f64 = films.iter().map(Shape::area).sum();
        let rim: f64 = films.iter().map(Shape::rim).sum();
        let spacing = scene.header.resolution.spacing(area);
        let MethodChoice::Melp(melp) = scene.header.method else { unreachable!("invariant: only Melp is available") };
        // Conversion saturates: 1e30 particles are u64::MAX, and too many in any case.
        let eulerian = (area / spacing.powi(2)).round() as u64;
        let boundary = (BOUNDARY_ROWS * rim / spacing).round() as u64;
        let lagrangian = eulerian.saturating_mul(u64::from(melp.liquid_per_carrier));
        let bytes = (eulerian.saturating_add(boundary).saturating_mul(BYTES_PER_EULERIAN))
            .saturating_add(lagrangian.saturating_mul(BYTES_PER_LAGRANGIAN));
        Self { spacing, eulerian, lagrangian, boundary, bytes }
    }

    /// Eulerian particles that would fit into `available` bytes at the same proportions.
    pub(super) fn fitting(&self, available: u64) -> u64 {
        (self.eulerian as f64 * (available as f64 / self.bytes.max(1) as f64)) as u64
    }
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
