//! A film between two rings holds up to the widest gap that a catenoid spans, and not beyond.
//!
//! # Equation
//! `r = c cosh(z/c)` through rings of radius `R` at `z = -h, h`; there is one for `2h < 1.3254868 R` (Lindelöf 1863), of area
//! `2 pi c^2 (h/c + sinh(2h/c)/2)`. Beyond, the film pinches off and leaves two discs, `2 pi R^2`.

use std::f64::consts::PI;

use froth_components::authored::mesh_shape::Catenoid;
use froth_surface::EventKind;

use super::finding::Finding;
use super::mesh_run::{MeshRun, unbroken};
use super::scene_run::SceneRun;
use super::{Effort, LawError};

const RADIUS: f64 = 0.05;
/// Gaps on both sides of the widest, relative: the threshold is between them.
const BRACKET: f64 = 0.005;
/// Twice as long as the wider film takes, s.
const END: f64 = 24.0;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let edge = effort.choose(0.1, 0.05) * RADIUS;
    let widest = Catenoid::WIDEST_GAP * RADIUS;
    let mut below = hang((1.0 - BRACKET) * widest, edge)?;
    let mut above = hang((1.0 + BRACKET) * widest, edge)?;
    let cuts = |run: &MeshRun| (run.count(EventKind::Pinch) + run.count(EventKind::Window)) as f64;
    let per_cent = 100.0 * BRACKET;
    let narrow = (1.0 - BRACKET) * widest;
    Ok(vec![
        Finding::vanishing(
            format!("gap {per_cent} % below the limit: times that the film comes apart"),
            cuts(&below),
            0.0,
        ),
        Finding::relative(format!("gap {per_cent} % below: area, m^2"), area(narrow), below.area(), 5e-3),
        Finding::relative(format!("gap {per_cent} % above: films in the end"), 2.0, above.films() as f64, 0.0),
        Finding::vanishing(
            format!("gap {per_cent} % above: events missing"),
            f64::from(u8::from(cuts(&above) == 0.0)),
            0.0,
        ),
        Finding::relative(
            format!("gap {per_cent} % above: area, two discs, m^2"),
            2.0 * PI * RADIUS * RADIUS,
            above.area(),
            2e-3,
        ),
        unbroken([below.violation(), above.violation()]),
    ])
}

fn hang(gap: f64, edge: f64) -> Result<MeshRun, LawError> {
    let scene = SceneRun::of("catenoid").with("\"67.5 mm\"", &gap.to_string());
    let scene = scene
        .with("Spacing(\"4 mm\")", &format!("Spacing({edge})"))
        .with("frames_per_second: 25", "frames_per_second: 5");
    MeshRun::at(&scene, END)
}

/// Area of the wider of the two catenoids, m^2.
fn area(gap: f64) -> f64 {
    let half = 0.5 * gap;
    // `c cosh(h/c)` grows with c above the widest, where h/c = 1.19968.
    let (mut thin, mut wide) = (half / 1.199_678_640_257_733_8, RADIUS);
    for _ in 0..100 {
        let middle = 0.5 * (thin + wide);
        if middle * (half / middle).cosh() < RADIUS { thin = middle } else { wide = middle }
    }
    2.0 * PI * wide * wide * (half / wide + 0.5 * (2.0 * half / wide).sinh())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_of_a_catenoid_is_the_one_in_the_literature() {
        // Rings of radius 1 at a distance 1.
        assert!((area(RADIUS) / (RADIUS * RADIUS) - 5.991_797).abs() < 1e-6);
    }
}
