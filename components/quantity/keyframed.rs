//! Values that change over time: one value, or a list of keyframes with straight lines between.

use std::fmt;
use std::marker::PhantomData;

use glam::DVec3;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, DeserializeOwned, Deserializer, MapAccess, SeqAccess, Unexpected, Visitor};

use super::vector::expecting_vector;
use super::{Dimension, Quantity, Refusal, RefusalKind, Time, Vector};

/// A value over time.
///
/// Written as one value, `(0.0, -9.81, 0.0)`, or as keyframes, `[(t: 0, v: (0, 0, 0)), (t: "1 s", v: (0, -9.81, 0))]`,
/// whose times increase. Linear between keyframes, constant before the first and after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframed<T> {
    /// At least one, times strictly increasing.
    frames: Vec<Keyframe<T>>,
}

/// One value at one time.
#[derive(Clone, Copy, Debug, PartialEq, serde::Deserialize)]
#[serde(deny_unknown_fields, bound = "T: DeserializeOwned")]
pub struct Keyframe<T> {
    /// Time since the start of the run.
    #[serde(rename = "t")]
    pub time: Time,
    /// Value at that time.
    #[serde(rename = "v")]
    pub value: T,
}

impl<T: KeyframeValue> Keyframed<T> {
    /// The same value at all times.
    #[must_use]
    pub fn constant(value: T) -> Self {
        Self { frames: vec![Keyframe { time: Time::default(), value }] }
    }

    /// The keyframes; one alone for a constant.
    #[must_use]
    pub fn frames(&self) -> &[Keyframe<T>] {
        &self.frames
    }

    /// The value at a time, seconds since the start of the run.
    #[must_use]
    pub fn at(&self, time: f64) -> T {
        let later = self.frames.partition_point(|frame| frame.time.si() <= time);
        match (later.checked_sub(1).map(|earlier| &self.frames[earlier]), self.frames.get(later)) {
            (Some(a), Some(b)) => {
                let (start, end) = (a.time.si(), b.time.si());
                T::between(a.value, b.value, (time - start) / (end - start))
            }
            (Some(only), None) | (None, Some(only)) => only.value,
            (None, None) => unreachable!("invariant: a keyframed value has at least one frame"),
        }
    }
}

impl<T: KeyframeValue + Default> Default for Keyframed<T> {
    fn default() -> Self {
        Self::constant(T::default())
    }
}

/// What can be keyframed: [`Quantity`] and [`Vector`].
pub trait KeyframeValue: Copy + DeserializeOwned {
    /// Dimension of each part.
    type Dimension: Dimension;

    /// The value from its parts, or `None` for a wrong number of parts.
    fn from_parts(parts: &[Quantity<Self::Dimension>]) -> Option<Self>;

    /// `(1 - fraction) * a + fraction * b`.
    #[must_use]
    fn between(a: Self, b: Self, fraction: f64) -> Self;

    /// Says how one value is written.
    ///
    /// # Errors
    /// As the formatter.
    fn expecting(f: &mut fmt::Formatter<'_>) -> fmt::Result;
}

impl<D: Dimension> KeyframeValue for Quantity<D> {
    type Dimension = D;

    fn from_parts(parts: &[Quantity<D>]) -> Option<Self> {
        let [only] = parts else { return None };
        Some(*only)
    }

    fn between(a: Self, b: Self, fraction: f64) -> Self {
        Self::from_si((1.0 - fraction) * a.si() + fraction * b.si())
    }

    fn expecting(f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, e.g. {}", D::INFO.name, D::INFO.example)
    }
}

impl<D: Dimension> KeyframeValue for Vector<D> {
    type Dimension = D;

    fn from_parts(parts: &[Quantity<D>]) -> Option<Self> {
        let [x, y, z] = parts else { return None };
        Some(Self::from_si(DVec3::new(x.si(), y.si(), z.si())))
    }

    fn between(a: Self, b: Self, fraction: f64) -> Self {
        Self::from_si(a.si().lerp(b.si(), fraction))
    }

    fn expecting(f: &mut fmt::Formatter<'_>) -> fmt::Result {
        expecting_vector::<D>(f)
    }
}

impl<'de, T: KeyframeValue> Deserialize<'de> for Keyframed<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(KeyframedVisitor(PhantomData))
    }
}

struct KeyframedVisitor<T>(PhantomData<T>);

impl<T: KeyframeValue> KeyframedVisitor<T> {
    fn constant<E: serde::de::Error>(&self, parts: &[Quantity<T::Dimension>]) -> Result<Keyframed<T>, E> {
        let value = T::from_parts(parts).ok_or_else(|| E::invalid_length(parts.len(), self))?;
        Ok(Keyframed::constant(value))
    }

    fn scalar<E: serde::de::Error>(&self, value: &Part<T>) -> Result<Keyframed<T>, E> {
        let Part::Number(number) = value else { unreachable!("invariant: a number or a text is no keyframe") };
        T::from_parts(&[*number])
            .map(Keyframed::constant)
            .ok_or_else(|| E::invalid_type(Unexpected::Other("a single value"), self))
    }
}

impl<'de, T: KeyframeValue> Visitor<'de> for KeyframedVisitor<T> {
    type Value = Keyframed<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        T::expecting(f)?;
        f.write_str(", or keyframes [(t: \"0 s\", v: ...), (t: \"1 s\", v: ...)]")
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Self::Value, E> {
        self.scalar(&PartVisitor(PhantomData).visit_f64(value)?)
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Self::Value, E> {
        self.scalar(&PartVisitor(PhantomData).visit_str(text)?)
    }

    /// A vector and a list of keyframes both arrive here: the first element tells which.
    fn visit_seq<A: SeqAccess<'de>>(self, mut elements: A) -> Result<Self::Value, A::Error> {
        let mut numbers = Vec::new();
        let mut frames: Vec<Keyframe<T>> = Vec::new();
        while let Some(part) = elements.next_element::<Part<T>>()? {
            match part {
                Part::Frame(frame) => push_in_order(&mut frames, frame).map_err(Refusal::into_serde)?,
                Part::Number(number) => numbers.push(number),
            }
            // Bounds what a hostile list can make us keep; no vector is longer.
            if numbers.len() > 3 || (!numbers.is_empty() && !frames.is_empty()) {
                return Err(serde::de::Error::invalid_length(numbers.len() + frames.len(), &self));
            }
        }
        if frames.is_empty() { self.constant(&numbers) } else { Ok(Keyframed { frames }) }
    }
}

/// Adds a keyframe, whose time must be later than the one before.
fn push_in_order<T>(frames: &mut Vec<Keyframe<T>>, frame: Keyframe<T>) -> Result<(), Refusal> {
    if let Some(last) = frames.last().filter(|last| last.time >= frame.time) {
        let message = format!("the keyframe at {} comes after the one at {}", frame.time, last.time);
        return Err(Refusal::new(RefusalKind::OutOfRange, message, "write keyframes in order of time, each time once"));
    }
    frames.push(frame);
    Ok(())
}

/// One element of a sequence that is either a vector or a list of keyframes.
enum Part<T: KeyframeValue> {
    Number(Quantity<T::Dimension>),
    Frame(Keyframe<T>),
}

impl<'de, T: KeyframeValue> Deserialize<'de> for Part<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(PartVisitor(PhantomData))
    }
}

struct PartVisitor<T>(PhantomData<T>);

impl<'de, T: KeyframeValue> Visitor<'de> for PartVisitor<T> {
    type Value = Part<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let info = T::Dimension::INFO;
        write!(f, "{}, e.g. {}, or a keyframe (t: \"0 s\", v: ...)", info.name, info.example)
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Self::Value, E> {
        Quantity::finite(value).map(Part::Number).map_err(Refusal::into_serde)
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Self::Value, E> {
        Quantity::parse(text).map(Part::Number).map_err(Refusal::into_serde)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        Keyframe::deserialize(MapAccessDeserializer::new(map)).map(Part::Frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::{Length, dimension};

    type Place = Vector<dimension::Length>;

    fn read<T: DeserializeOwned>(text: &str) -> T {
        ron::from_str(text).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    #[test]
    fn one_value_holds_at_all_times() {
        let length: Keyframed<Length> = read("\"5 cm\"");
        assert_eq!(length.at(-1.0), length.at(100.0));
        let place: Keyframed<Place> = read("(0, \"5 cm\", 0.5)");
        assert_eq!(place.at(3.0).si(), DVec3::new(0.0, 0.05, 0.5));
    }

    #[test]
    fn keyframes_are_joined_by_straight_lines() {
        let length: Keyframed<Length> = read("[(t: 0, v: 1), (t: \"2 s\", v: \"3 m\"), (t: 3, v: 0)]");
        let values = [-1.0, 0.0, 1.0, 2.0, 2.5, 3.0, 9.0].map(|time| length.at(time).si());
        assert_eq!(values, [1.0, 1.0, 2.0, 3.0, 1.5, 0.0, 0.0]);
        let place: Keyframed<Place> = read("[(t: 0, v: (0, 0, 0)), (t: 1, v: (\"2 m\", 0, 0))]");
        assert_eq!(place.at(0.5).si(), DVec3::X);
    }

    #[test]
    fn what_is_neither_is_refused() {
        for text in [
            "(0, 1)",
            "(0, 1, 2, 3)",
            "[]",
            "[(t: 0, v: (0, 0, 0)), 5]",
            "[(t: 1, v: (0, 0, 0)), (t: 1, v: (0, 0, 0))]",
            "[(t: 0, w: (0, 0, 0))]",
            "(0, NaN, 0)",
            "5",
        ] {
            assert!(ron::from_str::<Keyframed<Place>>(text).is_err(), "{text}");
        }
    }
}
