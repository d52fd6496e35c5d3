//! Foams: Plateau's rule that no more than three films meet, and gas that stays in its bubbles while others burst.

use froth_surface::EventKind;
use froth_surface::calculus::borders::Borders;

use super::finding::Finding;
use super::mesh_run::{MeshRun, unbroken};
use super::scene_run::SceneRun;
use super::{Effort, LawError};

/// A block of cubes, four films at each inner edge, parts into borders of three.
pub(super) fn measure_lattice(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let (counts, bubbles, edge) = effort.choose(("(3, 3, 3)", 27.0, "3 mm"), ("(5, 5, 5)", 125.0, "2.5 mm"));
    let scene = SceneRun::of("foam_lattice").with("(5, 5, 5)", counts);
    let mut run = MeshRun::begin(&scene.with("Spacing(\"2.5 mm\")", &format!("Spacing(\"{edge}\")")))?;
    let crowded = |run: &mut MeshRun| Borders::new(&run.surface()).crowded.len() as f64;
    let before = crowded(&mut run);
    while run.steps < 50 {
        run.step_within(f64::INFINITY)?;
    }
    Ok(vec![
        Finding::vanishing(
            format!("edges with more than three films after 50 steps, of {before}"),
            crowded(&mut run),
            0.0,
        ),
        Finding::relative("bubbles", bubbles, run.observed("bubbles"), 0.0),
        Finding::vanishing("largest error of a volume in any step, relative", run.volume_error, 1e-6),
        unbroken([run.violation()]),
    ])
}

/// Ten bubbles, one of which bursts every half second.
pub(super) fn measure_bursts(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let (edge, every) = effort.choose(("6 mm", 50), ("4 mm", 10));
    let mut run =
        MeshRun::begin(&SceneRun::of("bursting_foam").with("Spacing(\"4 mm\")", &format!("Spacing(\"{edge}\")")))?;
    let mut violations = Vec::new();
    while run.steps < 1000 {
        run.step_within(f64::INFINITY)?;
        if run.steps % every == 0 {
            violations.push(run.violation());
        }
    }
    let due = (run.simulation.time() / 0.5).floor();
    Ok(vec![
        Finding::relative(
            format!("bursts in {} steps, {:.3} s", run.steps, run.simulation.time()),
            due,
            run.count(EventKind::Burst) as f64,
            0.0,
        ),
        Finding::vanishing("largest error of a survivor's volume in any step, relative", run.volume_error, 1e-5),
        unbroken(violations),
    ])
}
