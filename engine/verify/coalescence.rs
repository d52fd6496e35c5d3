//! Two equal bubbles that touch become a double bubble.
//!
//! # Equation
//! Two equal volumes `V` with a shared wall have the area `27 pi (V/(9 pi))^(2/3)`, `27 pi R^2/4` with caps of radius `R`:
//! 0.9449 of two spheres'. The wall is flat.
//!
//! # Discretisation
//! Films that face each other are joined where they are nearest, and that is at several places nearly at once: a little of the air
//! between can be cut off, which is a region of its own for a step or two. The bubbles themselves coalesce once; at the end no such
//! pocket is left.

use std::f64::consts::PI;

use froth_components::identity::RegionId;
use froth_surface::calculus::angles::{Deviation, border_angles, border_deviation};
use froth_surface::calculus::borders::Borders;
use froth_surface::{EventKind, Region};
use froth_systems::tracker::events::TopologyEvent;

use super::finding::Finding;
use super::mesh_run::{MeshRun, unbroken};
use super::scene_run::SceneRun;
use super::{Effort, LawError};

/// Nothing moves any more, s.
const END: f64 = 2.5;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let (edge, snap) = effort.choose(("5 mm", "0.45"), ("4.5 mm", "0.49"));
    let scene = SceneRun::of("coalescence").with("Spacing(\"5 mm\")", &format!("Spacing(\"{edge}\")"));
    let mut run = MeshRun::at(&scene.with("snap: 0.45", &format!("snap: {snap}")), END)?;
    let joined = run.events.iter().filter(|event| joins_bubbles(event)).count();
    let volume = run.volumes::<2>().iter().sum::<f64>() / 2.0;
    let radius = (8.0 * volume / (9.0 * PI)).cbrt();
    let across = 0.75 * PI * radius * radius;
    let surface = run.surface();
    let borders = Borders::new(&surface);
    let angles = border_deviation(&border_angles(&surface, &borders)).unwrap_or(Deviation::UNKNOWN);
    let ends = borders.vertices().filter(|v| borders.neighbours(*v).len() != 2).count();
    Ok(vec![
        Finding::relative("times that the bubbles coalesce", 1.0, joined as f64, 0.0),
        Finding::relative("bubbles at the end: no air is caught between", 2.0, run.observed("bubbles"), 0.0),
        Finding::relative("area, m^2", 27.0 * PI * radius * radius / 4.0, run.area(), 3e-3),
        Finding::relative("area of the wall, m^2", across, run.area_between(Region(1), Region(2)), 0.02),
        Finding::vanishing("places where the border ends or forks", ends as f64, 0.0),
        Finding::vanishing("angles of the films less 120 degrees, mean size, degrees", angles.mean.to_degrees(), 1.0),
        Finding::vanishing("largest error of a volume at the end, relative", run.observed("volume_error"), 1e-5),
        unbroken([run.violation()]),
    ])
}

/// Whether the two bubbles came to share a wall.
fn joins_bubbles(event: &TopologyEvent) -> bool {
    event.kind == EventKind::Coalescence && [1, 2].iter().all(|bubble| event.regions[..2].contains(&RegionId(*bubble)))
}
