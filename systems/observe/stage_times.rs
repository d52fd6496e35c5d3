//! Wall time per stage, by markers on the borders between stages.

use std::time::{Duration, Instant};

use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::{IntoScheduleConfigs, Schedule, SystemSet};
use bevy_ecs::system::ResMut;
use bevy_ecs::world::World;

use crate::stage::Stage;

/// Wall time of each stage, of the last step and of all steps. Not part of the state of a run.
#[derive(Resource, Clone, Debug, Default)]
pub struct StageTimes {
    border: Option<Instant>,
    last: [Duration; Stage::ALL.len()],
    total: [Duration; Stage::ALL.len()],
    steps: u64,
}

/// The border before a stage; that before `Stage::ALL.len()` ends the step.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Border(usize);

impl StageTimes {
    /// Adds the resource, and the markers to a [staged](crate::stage::staged_schedule) schedule.
    ///
    /// Each marker is ordered against the stages on both sides, hence against every system of a stage.
    pub fn install(world: &mut World, schedule: &mut Schedule) {
        world.init_resource::<Self>();
        for border in 0..=Stage::ALL.len() {
            let mark = move |mut times: ResMut<Self>| times.cross(border);
            let mut marker = mark.in_set(Border(border));
            if let Some(before) = border.checked_sub(1) {
                marker = marker.after(Stage::ALL[before]).after(Border(before));
            }
            if let Some(&after) = Stage::ALL.get(border) {
                marker = marker.before(after);
            }
            schedule.add_systems(marker);
        }
    }

    /// Closes the stage before the border.
    fn cross(&mut self, border: usize) {
        let now = Instant::now();
        match (border.checked_sub(1), self.border) {
            (Some(stage), Some(since)) => {
                self.last[stage] = now - since;
                self.total[stage] += now - since;
            }
            _ => self.steps += 1,
        }
        self.border = Some(now);
    }

    /// Time of each stage in the last step.
    pub fn last(&self) -> impl Iterator<Item = (Stage, Duration)> {
        Stage::ALL.into_iter().zip(self.last)
    }

    /// Time of each stage in all steps together.
    pub fn total(&self) -> impl Iterator<Item = (Stage, Duration)> {
        Stage::ALL.into_iter().zip(self.total)
    }

    /// Steps that were timed.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Requires, SchedulePlan};
    use std::thread::sleep;

    #[test]
    fn time_is_counted_for_the_stage_that_takes_it() {
        let mut world = World::new();
        let mut plan = SchedulePlan::new();
        // An exclusive system conflicts with every marker unless the two are ordered.
        let dawdle = |_: &mut World| sleep(Duration::from_millis(20));
        plan.add(Stage::Dynamics, "dawdle", dawdle, Requires::nothing());
        StageTimes::install(&mut world, plan.schedule_mut());
        plan.run(&mut world);
        plan.run(&mut world);
        let times = world.resource::<StageTimes>();
        let of = |stage| times.total().find(|(other, _)| *other == stage).unwrap().1;
        assert_eq!(times.steps(), 2);
        assert!(of(Stage::Dynamics) >= Duration::from_millis(40));
        assert!(of(Stage::Forces) < Duration::from_millis(20));
    }
}
