//! The films that frames of wire hold, against the Surface Evolver.

use super::finding::Finding;
use super::mesh_run::{MeshRun, unbroken};
use super::minima::Minimum;
use super::scene_run::SceneRun;
use super::{Effort, LawError};

/// Length of the wires, which is 1 in the table, metres.
const WIRE: f64 = 0.1;
/// The stable films of an octahedron; which one is found depends on the first accidents.
const OCTAHEDRAL: [&str; 5] = ["flat", "hexagon", "skew_quad", "pentagon", "quad"];

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let edge = effort.choose("8 mm", "4 mm");
    let mut findings = Vec::new();
    for name in ["tetrahedral_frame", "cubic_frame", "octahedral_frame"] {
        let scene = SceneRun::of(name).with("Spacing(\"5 mm\")", &format!("Spacing(\"{edge}\")"));
        let mut run = MeshRun::begin(&scene)?;
        let end = run.simulation.scene().header.duration.si();
        run.advance_to(0.5 * end)?;
        let halfway = run.area();
        run.advance_to(end)?;
        let area = run.area() / (WIRE * WIRE);
        let (kind, minimum) =
            if name == "octahedral_frame" { nearest(area) } else { (String::new(), Minimum::of(name)) };
        findings.extend([
            Finding::relative(format!("{name}{kind}: area, squared wires"), minimum.area, area, 5e-3),
            Finding::relative(format!("{name}: area now over that halfway"), 1.0, run.area() / halfway, 1e-3),
            unbroken([run.violation()]),
        ]);
    }
    Ok(findings)
}

/// The octahedral film of an area: the minimum next to it.
pub(super) fn nearest(area: f64) -> (String, Minimum) {
    let minima = OCTAHEDRAL.map(|kind| (format!(" ({kind})"), Minimum::of(&format!("octahedral_frame_{kind}"))));
    let off = |minimum: &Minimum| (area - minimum.area).abs();
    minima.into_iter().min_by(|a, b| off(&a.1).total_cmp(&off(&b.1))).expect("invariant: there are five")
}
