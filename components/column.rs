//! How a component is laid out as scalars.
//!
//! A [`Column`] is a component that every entity of a kind carries: a plain value with a name and a unit. Row
//! permutation, checkpoints, export and pictures all read components through this one description.

use bevy_ecs::component::{Component, Mutable};
use glam::{DMat3, DVec3};

/// A plain value that is made of 8-byte scalars.
pub trait Plain: Copy + Send + Sync + 'static {
    /// What each scalar is called, in storage order; empty for a single scalar.
    const LANES: &'static [&'static str];

    /// Appends the scalars in little-endian order.
    fn write_le(&self, out: &mut Vec<u8>);

    /// Reads what [`Plain::write_le`] wrote; `bytes` has exactly [`Plain::byte_len`] bytes.
    fn read_le(bytes: &[u8]) -> Self;

    /// Appends the scalars as floating-point numbers (for export and pictures).
    fn push_lanes(&self, out: &mut Vec<f64>);

    /// Whether a mean of values is a value: true of quantities, false of numbers that are names.
    const BLENDS: bool = true;

    /// The value of scalars as [`Plain::push_lanes`] gives them.
    fn from_lanes(lanes: &[f64]) -> Self;

    /// Whether every scalar is finite; integers are.
    fn is_finite(&self) -> bool {
        true
    }

    /// Bytes one value takes when written.
    #[must_use]
    fn byte_len() -> usize {
        8 * Self::LANES.len().max(1)
    }
}

/// The `i`-th 8-byte scalar of `bytes`.
fn scalar(bytes: &[u8], i: usize) -> [u8; 8] {
    let mut raw = [0; 8];
    raw.copy_from_slice(&bytes[8 * i..8 * i + 8]);
    raw
}

impl Plain for f64 {
    const LANES: &'static [&'static str] = &[];
    fn write_le(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.to_le_bytes());
    }
    fn read_le(bytes: &[u8]) -> Self {
        Self::from_le_bytes(scalar(bytes, 0))
    }
    fn push_lanes(&self, out: &mut Vec<f64>) {
        out.push(*self);
    }
    fn from_lanes(lanes: &[f64]) -> Self {
        lanes[0]
    }
    fn is_finite(&self) -> bool {
        f64::is_finite(*self)
    }
}

impl Plain for u64 {
    const LANES: &'static [&'static str] = &[];
    fn write_le(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.to_le_bytes());
    }
    fn read_le(bytes: &[u8]) -> Self {
        Self::from_le_bytes(scalar(bytes, 0))
    }
    fn push_lanes(&self, out: &mut Vec<f64>) {
        out.push(*self as f64);
    }
    const BLENDS: bool = false;
    fn from_lanes(lanes: &[f64]) -> Self {
        lanes[0] as Self
    }
}

impl Plain for DVec3 {
    const LANES: &'static [&'static str] = &["x", "y", "z"];
    fn write_le(&self, out: &mut Vec<u8>) {
        self.to_array().iter().for_each(|v| v.write_le(out));
    }
    fn read_le(bytes: &[u8]) -> Self {
        Self::from_array(std::array::from_fn(|i| f64::from_le_bytes(scalar(bytes, i))))
    }
    fn push_lanes(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(&self.to_array());
    }
    fn from_lanes(lanes: &[f64]) -> Self {
        Self::from_slice(lanes)
    }
    fn is_finite(&self) -> bool {
        DVec3::is_finite(*self)
    }
}

impl Plain for DMat3 {
    const LANES: &'static [&'static str] = &["xx", "yx", "zx", "xy", "yy", "zy", "xz", "yz", "zz"];
    fn write_le(&self, out: &mut Vec<u8>) {
        self.to_cols_array().iter().for_each(|v| v.write_le(out));
    }
    fn read_le(bytes: &[u8]) -> Self {
        Self::from_cols_array(&std::array::from_fn(|i| f64::from_le_bytes(scalar(bytes, i))))
    }
    fn push_lanes(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(&self.to_cols_array());
    }
    fn from_lanes(lanes: &[f64]) -> Self {
        Self::from_cols_slice(lanes)
    }
    fn is_finite(&self) -> bool {
        DMat3::is_finite(self)
    }
}

/// A component that every entity of a kind carries: a newtype over a [`Plain`] value, with its name and unit.
pub trait Column: Component<Mutability = Mutable> + Copy + Send + Sync {
    /// The plain value inside.
    type Value: Plain;
    /// Stable name: the column's name in checkpoints, tables and exported files.
    const NAME: &'static str;
    /// SI unit, `"1"` for a dimensionless number.
    const UNIT: &'static str;

    /// The plain value.
    fn value(&self) -> Self::Value;
    /// The component that holds `value`.
    fn from_value(value: Self::Value) -> Self;
}

/// Declares newtype components together with their [`Column`] description.
///
/// ```
/// froth_components::columns! {
///     /// Electric charge per particle, coulomb.
///     pub struct Charge(f64), "charge", "C";
/// }
/// ```
#[macro_export]
macro_rules! columns {
    ($($(#[$doc:meta])* pub struct $name:ident($value:ty), $label:literal, $unit:literal;)+) => {$(
        $(#[$doc])*
        #[derive(::bevy_ecs::component::Component, Clone, Copy, Debug, Default, PartialEq)]
        pub struct $name(pub $value);

        impl $crate::column::Column for $name {
            type Value = $value;
            const NAME: &'static str = $label;
            const UNIT: &'static str = $unit;
            fn value(&self) -> $value {
                self.0
            }
            fn from_value(value: $value) -> Self {
                Self(value)
            }
        }
    )+};
}
