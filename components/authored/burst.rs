//! Films that burst, one at a time.

use bevy_ecs::component::Component;
use serde::{Deserialize, Deserializer};

use crate::quantity::{Refusal, RefusalKind, Time, range};

/// Bursts films: at [`first`](Self::first) and then after every [`every`](Self::every), one bubble is chosen by
/// [`order`](Self::order), and a film of it pops. The film towards the outside, if it has one; otherwise its largest. The bubble
/// becomes one region with what is beyond that film, at the sum of both volumes.
///
/// It ends when no bubble is left. Times that differ by rounding alone, a [billionth](Self::ROUNDING) of an interval, are the same.
#[derive(Component, Clone, Debug, PartialEq)]
pub struct Burst {
    /// Time between bursts, seconds.
    pub every: Time,
    /// Time of the first, seconds. Default: `every`.
    pub first: Time,
    /// Which bubble is next. Default: at random.
    pub order: BurstOrder,
}

impl Burst {
    /// Part of an interval by which times may differ and still be the same, dimensionless.
    pub const ROUNDING: f64 = 1e-9;

    /// Number of bursts that are due by a time, seconds since the start.
    #[must_use]
    pub fn due_by(&self, time: f64) -> u64 {
        let intervals = (time - self.first.si()) / self.every.si() + Self::ROUNDING;
        if intervals < 0.0 { 0 } else { 1 + intervals as u64 }
    }

    /// Time of the next burst after `done` of them, seconds since the start.
    #[must_use]
    pub fn time_of(&self, done: u64) -> f64 {
        self.first.si() + done as f64 * self.every.si()
    }
}

impl<'de> Deserialize<'de> for Burst {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(rename = "Burst", deny_unknown_fields)]
        struct Fields {
            #[serde(deserialize_with = "range::positive")]
            every: Time,
            #[serde(default, deserialize_with = "range::positive_if_given")]
            first: Option<Time>,
            #[serde(default)]
            order: BurstOrder,
        }
        let Fields { every, first, order } = Fields::deserialize(deserializer)?;
        Ok(Self { every, first: first.unwrap_or(every), order })
    }
}

/// Which bubble bursts next.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub enum BurstOrder {
    /// Any, each as likely.
    Random(RandomOrder),
    /// The one of least volume.
    Smallest,
    /// The one of greatest volume.
    Largest,
    /// These, one after the other; a region that is gone by then is passed over. Regions are numbered as
    /// [`mesh_shape`](super::mesh_shape) says.
    Sequence(RegionNumbers),
}

impl Default for BurstOrder {
    fn default() -> Self {
        Self::Random(RandomOrder::default())
    }
}

/// Settings of [`BurstOrder::Random`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RandomOrder {
    /// Seed of the choice. Default: made from the scene's seed and the entity's place in the file.
    pub seed: Option<u64>,
}

/// Regions by their numbers, at least one; the outside, 0, is none of them. Written `[3, 1, 2]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RegionNumbers(Vec<u32>);

impl RegionNumbers {
    /// The numbers, in the order of the file.
    #[must_use]
    pub fn get(&self) -> &[u32] {
        &self.0
    }
}

impl<'de> Deserialize<'de> for RegionNumbers {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let numbers = Vec::<u32>::deserialize(deserializer)?;
        if numbers.is_empty() || numbers.contains(&0) {
            let message = if numbers.is_empty() { "no region is named" } else { "region 0 is the outside" };
            let help = "write the numbers of bubbles, from 1, e.g. Sequence([3, 1, 2])";
            return Err(Refusal::new(RefusalKind::OutOfRange, message, help).into_serde());
        }
        Ok(Self(numbers))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn burst(text: &str) -> Burst {
        let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
        options.from_str(text).unwrap()
    }

    #[test]
    fn bursts_are_due_at_the_first_time_and_after_every_interval() {
        let bursts = burst("(every: 0.5, first: 2)");
        let due: Vec<u64> = [0.0, 1.99, 2.0, 2.49, 2.5, 4.0].map(|time| bursts.due_by(time)).to_vec();
        assert_eq!(due, [0, 0, 1, 1, 2, 5]);
        assert_eq!((bursts.time_of(0), bursts.time_of(4)), (2.0, 4.0));
        assert_eq!(burst("(every: 0.5)").first.si(), 0.5);
    }

    #[test]
    fn a_burst_is_due_at_its_time_however_that_is_rounded() {
        let bursts = burst("(every: 0.1)");
        for done in 0..1000 {
            let time = bursts.time_of(done);
            for at in [time.next_down(), time, time.next_up(), 0.1 * (done + 1) as f64] {
                assert_eq!(bursts.due_by(at), done + 1, "{done}");
            }
        }
    }

    #[test]
    fn the_outside_cannot_burst() {
        let read = |text: &str| ron::from_str::<BurstOrder>(text);
        assert!(matches!(read("Sequence([2, 1])"), Ok(BurstOrder::Sequence(regions)) if regions.get() == [2, 1]));
        assert!(read("Sequence([2, 0])").is_err());
        assert!(read("Sequence([])").is_err());
    }
}
