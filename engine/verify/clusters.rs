//! Three and four bubbles of unequal volumes, against the Surface Evolver.
//!
//! # Equation
//! A cluster of volumes `s^3 V_i` has the area `s^2 A` and, at a tension `T = 2 sigma` of its films, pressures `T p_i/s`.

use super::finding::Finding;
use super::mesh_run::{MeshRun, unbroken};
use super::minima::Minimum;
use super::scene_run::SceneRun;
use super::{Effort, LawError};

const TENSION: f64 = 0.03;
/// Metres to the unit of length of the table: the largest bubble has the volume 1 there, and 100 ml here.
const SCALE: f64 = 0.046_415_888_336_127_79;
/// Nothing moves any more, s.
const END: f64 = 2.0;

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let edge = effort.choose("4.5 mm", "2 mm");
    let mut findings = Vec::new();
    for (scene, name) in [("triple_bubble", "triple_bubble_unequal"), ("quadruple_bubble", "quadruple_bubble_unequal")]
    {
        let mut run =
            MeshRun::at(&SceneRun::of(scene).with("Spacing(\"3 mm\")", &format!("Spacing(\"{edge}\")")), END)?;
        findings.extend(held_against(scene, &mut run, &Minimum::of(name), effort));
    }
    Ok(findings)
}

fn held_against(scene: &str, run: &mut MeshRun, minimum: &Minimum, effort: Effort) -> Vec<Finding> {
    let (area, pressure) = effort.choose((5e-3, 1e-2), (1e-3, 5e-3));
    let mut findings =
        vec![Finding::relative(format!("{scene}: area, m^2"), SCALE * SCALE * minimum.area, run.area(), area)];
    findings.extend((1..).zip(&minimum.bodies).map(|(region, [_, expected])| {
        let measured = run.observed(&format!("excess_pressure_{region}"));
        let what = format!("{scene}: excess pressure in bubble {region}, Pa");
        Finding::relative(what, 2.0 * TENSION * expected / SCALE, measured, pressure)
    }));
    findings.push(Finding::vanishing(
        format!("{scene}: largest error of a volume, relative"),
        run.observed("volume_error"),
        1e-6,
    ));
    findings.push(unbroken([run.violation()]));
    findings
}
