//! Vectors of quantities, `(0.0, "5 cm", 0)`, and directions.

use std::fmt;
use std::marker::PhantomData;

use glam::DVec3;
use serde::de::{Deserialize, Deserializer, IgnoredAny, SeqAccess, Visitor};

use super::{Dimension, Quantity, Ratio, Refusal, RefusalKind};

/// Three finite values of one dimension, in SI units.
pub struct Vector<D>(DVec3, PhantomData<D>);

impl<D> Vector<D> {
    /// The zero vector.
    pub const ZERO: Self = Self::from_si(DVec3::ZERO);

    /// A vector in SI units. For literals in code; files go through serde, which refuses what is not finite.
    #[must_use]
    pub const fn from_si(value: DVec3) -> Self {
        Self(value, PhantomData)
    }

    /// The vector in SI units.
    #[must_use]
    pub const fn si(self) -> DVec3 {
        self.0
    }
}

impl<D> Clone for Vector<D> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<D> Copy for Vector<D> {}

impl<D> PartialEq for Vector<D> {
    fn eq(&self, other: &Self) -> bool {
        self.0 == other.0
    }
}

impl<D> Default for Vector<D> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<D: Dimension> fmt::Debug for Vector<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({:?}, {:?}, {:?}) {}", self.0.x, self.0.y, self.0.z, D::INFO.si_unit)
    }
}

impl<D> serde::Serialize for Vector<D> {
    /// As three bare SI numbers.
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.to_array().serialize(serializer)
    }
}

impl<'de, D: Dimension> Deserialize<'de> for Vector<D> {
    fn deserialize<De: Deserializer<'de>>(deserializer: De) -> Result<Self, De::Error> {
        deserializer.deserialize_any(VectorVisitor(PhantomData))
    }
}

struct VectorVisitor<D>(PhantomData<D>);

impl<'de, D: Dimension> Visitor<'de> for VectorVisitor<D> {
    type Value = Vector<D>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        expecting_vector::<D>(f)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut parts: A) -> Result<Self::Value, A::Error> {
        let mut vector = [0.0; 3];
        for (found, value) in vector.iter_mut().enumerate() {
            let part: Quantity<D> =
                parts.next_element()?.ok_or_else(|| serde::de::Error::invalid_length(found, &self))?;
            *value = part.si();
        }
        if parts.next_element::<IgnoredAny>()?.is_some() {
            return Err(serde::de::Error::invalid_length(4, &self));
        }
        Ok(Vector::from_si(DVec3::from_array(vector)))
    }
}

/// How a vector is written, for errors.
pub(super) fn expecting_vector<D: Dimension>(f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let kind = D::INFO.name.split_once(' ').map_or(D::INFO.name, |(_article, name)| name);
    match D::INFO.units.first() {
        Some(unit) => write!(f, "a vector of three values, {kind} each, e.g. (0.0, \"-1 {unit}\", 0.0)"),
        None => write!(f, "a vector of three values, {kind} each, e.g. (0.0, -1.0, 0.0)"),
    }
}

/// A unit vector. A scene may give any length but zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction(DVec3);

impl Direction {
    /// Along x.
    pub const X: Self = Self(DVec3::X);
    /// Along y, which is up unless gravity says otherwise.
    pub const Y: Self = Self(DVec3::Y);
    /// Along z.
    pub const Z: Self = Self(DVec3::Z);
    /// Against z.
    pub const MINUS_Z: Self = Self(DVec3::NEG_Z);

    /// The direction of a vector, or `None` if it has none.
    #[must_use]
    pub fn of(vector: DVec3) -> Option<Self> {
        vector.try_normalize().map(Self)
    }

    /// The unit vector.
    #[must_use]
    pub const fn unit(self) -> DVec3 {
        self.0
    }
}

impl serde::Serialize for Direction {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.to_array().serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Direction {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let vector = Vector::<super::dimension::Ratio>::deserialize(deserializer)?.si();
        Self::of(vector).ok_or_else(|| {
            let [x, y, z] = vector.to_array().map(Ratio::from_si);
            let message = format!("`({x}, {y}, {z})` points nowhere");
            Refusal::new(RefusalKind::OutOfRange, message, "a direction is a vector other than zero, e.g. (0, 1, 0)")
                .into_serde()
        })
    }
}
