//! Whole numbers that people write as `4000` or `1e6`.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Visitor};

use super::{Refusal, RefusalKind};

/// A number of things, at least one. `1e6` is understood: it is a whole number, if not an integer literal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(transparent)]
pub struct Count(u64);

impl Count {
    /// Above this a float has no exact ones left: `2^53`.
    const LARGEST_FLOAT: f64 = 9_007_199_254_740_992.0;

    /// A count from code.
    #[must_use]
    pub const fn new(count: u64) -> Self {
        Self(count)
    }

    /// The number.
    #[must_use]
    pub const fn get(self) -> u64 {
        self.0
    }

    /// A whole number that may also be zero, for [`range`](super::range).
    pub(super) fn or_zero<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
        deserializer.deserialize_any(CountVisitor { least: 0 }).map(Self::get)
    }
}

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CountVisitor { least: 1 })
    }
}

struct CountVisitor {
    least: u64,
}

impl Visitor<'_> for CountVisitor {
    type Value = Count;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a whole number greater than 0, e.g. 4000 or 1e6")
    }

    fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<Count, E> {
        if value >= self.least { Ok(Count(value)) } else { Err(out_of_range(value).into_serde()) }
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Count, E> {
        u64::try_from(value).map_err(|_| out_of_range(value).into_serde()).and_then(|value| self.visit_u64(value))
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Count, E> {
        if !value.is_finite() {
            let message = format!("`{value}` is not a finite number");
            return Err(
                Refusal::new(RefusalKind::NotFinite, message, "write a whole number, e.g. 4000 or 1e6").into_serde()
            );
        }
        if value.fract() != 0.0 || !(self.least as f64..=Count::LARGEST_FLOAT).contains(&value) {
            return Err(out_of_range(value).into_serde());
        }
        Ok(Count(value as u64))
    }
}

fn out_of_range(value: impl fmt::Display) -> Refusal {
    let message = format!("`{value}` is not a number of things");
    Refusal::new(RefusalKind::OutOfRange, message, "write a whole number greater than 0, e.g. 4000 or 1e6")
}
