//! A double bubble that two rings pull apart becomes two bubbles.

use froth_surface::{EventKind, Region};

use super::finding::Finding;
use super::mesh_run::{MeshRun, unbroken};
use super::scene_run::SceneRun;
use super::{Effort, LawError};

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let edge = effort.choose("4 mm", "2.5 mm");
    let mut run = MeshRun::begin(
        &SceneRun::of("pulled_double_bubble").with("Spacing(\"4 mm\")", &format!("Spacing(\"{edge}\")")),
    )?;
    let before = run.volumes::<2>();
    let end = run.simulation.scene().header.duration.si();
    run.advance_to(end)?;
    let after = run.volumes::<2>();
    let changed = before.iter().zip(&after).map(|(before, after)| (after / before - 1.0).abs()).fold(0.0, f64::max);
    let apart = run.count(EventKind::Pinch) + run.count(EventKind::Window);
    Ok(vec![
        Finding::relative("bubbles in the end", 2.0, run.observed("bubbles"), 0.0),
        Finding::vanishing("area between them in the end, m^2", run.area_between(Region(1), Region(2)), 0.0),
        Finding::vanishing("events of separation missing", f64::from(u8::from(apart == 0)), 0.0),
        Finding::vanishing("volumes, largest relative change", changed, 1e-5),
        unbroken([run.violation()]),
    ])
}
