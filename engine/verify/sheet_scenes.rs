//! The scenes of Da 2015, and a ring in the wind, run to their end: nothing stops, no invariant of the mesh breaks, bubbles keep their gas, and what shall happen does.
//!
//! Quick runs a few steps of each on coarse meshes.

use froth_surface::EventKind;
use froth_surface::invariants::Violation;

use super::finding::Finding;
use super::frames::nearest;
use super::mesh_run::{MeshRun, unbroken};
use super::scene_run::SceneRun;
use super::{Effort, LawError};

/// Largest relative error of a bubble's volume.
const VOLUME: f64 = 1e-4;
/// Steps of a quick run.
const STEPS: u64 = 6;
/// Steps between two looks at the invariants.
const EVERY: u64 = 50;
/// Length of the octahedron's wires, m.
const WIRE: f64 = 0.08;

/// A scene with its resolution, the quick one, and what is to be seen in the end.
struct Scene {
    name: &'static str,
    spacing: &'static str,
    coarse: &'static str,
    shown: fn(&mut Story) -> Vec<Finding>,
}

const SCENES: [Scene; 11] = [
    Scene { name: "cube_oscillation", spacing: "3.2 mm", coarse: "8 mm", shown: |story| story.bubbles(1.0) },
    Scene { name: "cube_damped", spacing: "5 mm", coarse: "8 mm", shown: |story| story.bubbles(1.0) },
    Scene { name: "double_bubble_oscillation", spacing: "4.5 mm", coarse: "8 mm", shown: |story| story.bubbles(2.0) },
    Scene { name: "octahedron", spacing: "5 mm", coarse: "8 mm", shown: rests },
    Scene { name: "bubble_in_a_ring", spacing: "5 mm", coarse: "8 mm", shown: |story| story.bubbles(1.0) },
    Scene { name: "catenoid_pinching", spacing: "4 mm", coarse: "8 mm", shown: pinches },
    Scene { name: "pulling_double_bubble", spacing: "5 mm", coarse: "8 mm", shown: parts },
    Scene { name: "bubble_cluster", spacing: "5 mm", coarse: "8 mm", shown: |story| story.bubbles(10.0) },
    Scene { name: "bubble_popping", spacing: "5 mm", coarse: "8 mm", shown: pops },
    Scene { name: "sweeping_ring", spacing: "5 mm", coarse: "8 mm", shown: |story| blows(story, 2) },
    Scene { name: "ring_in_wind", spacing: "5 mm", coarse: "8 mm", shown: |story| blows(story, 1) },
];

/// A run with what was seen on the way.
struct Story {
    run: MeshRun,
    /// Most bubbles at the end of any step.
    most_bubbles: f64,
    /// Area halfway, m^2.
    halfway: f64,
    violations: Vec<Option<Violation>>,
}

pub(super) fn measure(effort: Effort) -> Result<Vec<Finding>, LawError> {
    let mut findings = Vec::new();
    for scene in &SCENES {
        let told = match effort {
            Effort::Quick => begun(scene),
            Effort::Full => whole(scene),
        };
        let mut story = match told {
            Ok(story) => story,
            Err(LawError::Step(error)) => {
                // The other scenes are to be seen all the same.
                findings.push(Finding::vanishing(format!("{}: stopped: {error}", scene.name), 1.0, 0.0));
                continue;
            }
            Err(other) => return Err(other),
        };
        let run = &story.run;
        let seen = format!("{}, {} steps, {} events", scene.name, run.steps, run.events.len());
        let mut about = vec![
            Finding::vanishing("error of a volume in any step, relative", run.volume_error, VOLUME),
            unbroken(std::mem::take(&mut story.violations)),
        ];
        if effort == Effort::Full {
            about.extend((scene.shown)(&mut story));
        }
        findings
            .extend(about.into_iter().map(|finding| Finding { what: format!("{seen}: {}", finding.what), ..finding }));
    }
    Ok(findings)
}

/// The first steps on a coarse mesh.
fn begun(scene: &Scene) -> Result<Story, LawError> {
    let [spacing, coarse] = [scene.spacing, scene.coarse].map(|length| format!("Spacing(\"{length}\")"));
    let mut story = Story::of(MeshRun::begin(&SceneRun::of(scene.name).with(&spacing, &coarse))?);
    while story.run.steps < STEPS {
        story.step(f64::INFINITY)?;
    }
    story.look();
    Ok(story)
}

/// The whole scene.
fn whole(scene: &Scene) -> Result<Story, LawError> {
    let mut story = Story::of(MeshRun::begin(&SceneRun::of(scene.name))?);
    let end = story.run.simulation.scene().header.duration.si();
    for until in [0.5 * end, end] {
        story.halfway = story.run.area();
        while !story.run.simulation.has_reached(until) {
            story.step(until)?;
        }
    }
    story.look();
    Ok(story)
}

impl Story {
    fn of(run: MeshRun) -> Self {
        Self { run, most_bubbles: 0.0, halfway: f64::NAN, violations: Vec::new() }
    }

    fn step(&mut self, until: f64) -> Result<(), LawError> {
        self.run.step_within(until)?;
        self.most_bubbles = self.most_bubbles.max(self.run.observed("bubbles"));
        if self.run.steps.is_multiple_of(EVERY) {
            self.look();
        }
        Ok(())
    }

    /// Looks at the invariants.
    fn look(&mut self) {
        self.violations.push(self.run.violation());
    }

    /// So many bubbles are there in the end.
    fn bubbles(&self, count: f64) -> Vec<Finding> {
        vec![Finding::relative("bubbles in the end", count, self.run.observed("bubbles"), 0.0)]
    }

    /// Something happened at least so many times.
    fn happened(&self, what: &str, count: usize, least: usize) -> Finding {
        Finding::vanishing(format!("{what} missing, of {count}"), least.saturating_sub(count) as f64, 0.0)
    }
}

/// The octahedron's films come to rest at a minimum of their area.
fn rests(story: &mut Story) -> Vec<Finding> {
    let area = story.run.area();
    let (kind, minimum) = nearest(area / (WIRE * WIRE));
    vec![
        Finding::relative(format!("area{kind}, squared wires"), minimum.area, area / (WIRE * WIRE), 0.01),
        Finding::relative("area now over that halfway", 1.0, area / story.halfway, 1e-3),
    ]
}

/// The neck pinches.
fn pinches(story: &mut Story) -> Vec<Finding> {
    vec![story.happened("pinches", story.run.count(EventKind::Pinch), 1)]
}

/// The bubbles come apart.
fn parts(story: &mut Story) -> Vec<Finding> {
    let cuts = story.run.count(EventKind::Pinch) + story.run.count(EventKind::Window);
    let mut findings = story.bubbles(2.0);
    findings.push(story.happened("separations", cuts, 1));
    findings.push(Finding::relative("films in the end", 2.0, story.run.films() as f64, 0.0));
    findings
}

/// One bubble after the other pops.
fn pops(story: &mut Story) -> Vec<Finding> {
    vec![story.happened("bursts", story.run.count(EventKind::Burst), 9)]
}

/// The ring blows so many bubbles at least.
fn blows(story: &mut Story, least: usize) -> Vec<Finding> {
    vec![story.happened("bubbles", story.most_bubbles as usize, least)]
}
