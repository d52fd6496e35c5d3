//! Ranges that a scene field demands, for `#[serde(deserialize_with = "...")]`.
//!
//! A check at the field, not after the whole component, lets an error point at the value.

use std::fmt::Display;
use std::ops::RangeInclusive;

use serde::de::{Deserialize, Deserializer};

use super::{Count, Dimension, Length, Quantity, Ratio, Refusal, RefusalKind, SurfaceTension, Vector, dimension};

/// Greater than zero.
///
/// # Errors
/// As the quantity, or when it is zero or negative.
pub fn positive<'de, D: Dimension, De: Deserializer<'de>>(deserializer: De) -> Result<Quantity<D>, De::Error> {
    let value = Quantity::<D>::deserialize(deserializer)?;
    let rule = format!("{} greater than 0 is wanted, e.g. {}", D::INFO.name, D::INFO.example);
    demand(value.si() > 0.0, value, value, rule)
}

/// Nothing, or [`positive`].
///
/// # Errors
/// As [`positive`].
pub fn positive_if_given<'de, D: Dimension, De: Deserializer<'de>>(
    deserializer: De,
) -> Result<Option<Quantity<D>>, De::Error> {
    struct Positive<D>(Quantity<D>);
    impl<'de, D: Dimension> Deserialize<'de> for Positive<D> {
        fn deserialize<De: Deserializer<'de>>(deserializer: De) -> Result<Self, De::Error> {
            positive(deserializer).map(Self)
        }
    }
    Ok(Option::<Positive<D>>::deserialize(deserializer)?.map(|positive| positive.0))
}

/// Zero or greater.
///
/// # Errors
/// As the quantity, or when it is negative.
pub fn not_negative<'de, D: Dimension, De: Deserializer<'de>>(deserializer: De) -> Result<Quantity<D>, De::Error> {
    let value = Quantity::<D>::deserialize(deserializer)?;
    let rule = format!("{} of 0 or more is wanted, e.g. {}", D::INFO.name, D::INFO.example);
    demand(value.si() >= 0.0, value, value, rule)
}

/// What a film may measure, metres. Wide enough for all that exists; narrow enough that areas and volumes neither vanish nor overflow.
const FILM_SIZE: RangeInclusive<f64> = 1e-6..=1e3;
const FILM_SIZE_RULE: &str = "a film measures 1 um to 1 km, e.g. 0.05 or \"5 cm\"";

/// Radius or side of a film: 1 um to 1 km.
///
/// # Errors
/// As the quantity, or when it is outside.
pub fn film_size<'de, De: Deserializer<'de>>(deserializer: De) -> Result<Length, De::Error> {
    within(deserializer, FILM_SIZE, FILM_SIZE_RULE)
}

/// Three of [`film_size`].
///
/// # Errors
/// As the vector, or when one is outside.
pub fn film_sizes<'de, De: Deserializer<'de>>(deserializer: De) -> Result<Vector<dimension::Length>, De::Error> {
    let sizes = Vector::deserialize(deserializer)?;
    match sizes.si().to_array().into_iter().find(|size| !FILM_SIZE.contains(size)) {
        Some(wrong) => demand(false, sizes, Length::from_si(wrong), FILM_SIZE_RULE.to_owned()),
        None => Ok(sizes),
    }
}

/// From 0 to 1, both included.
///
/// # Errors
/// As the quantity, or when it is outside.
pub fn fraction<'de, De: Deserializer<'de>>(deserializer: De) -> Result<Ratio, De::Error> {
    within(deserializer, 0.0..=1.0, "a number from 0 to 1 is wanted")
}

/// A part of an edge: above 0, at most 0.5.
///
/// # Errors
/// As the quantity, or when it is outside.
pub fn half_at_most<'de, De: Deserializer<'de>>(deserializer: De) -> Result<Ratio, De::Error> {
    within(deserializer, f64::MIN_POSITIVE..=0.5, "a number above 0, at most 0.5, is wanted, e.g. 0.25")
}

/// From 1 to 4, both included.
///
/// # Errors
/// As the quantity, or when it is outside.
pub fn one_to_four<'de, De: Deserializer<'de>>(deserializer: De) -> Result<Ratio, De::Error> {
    within(deserializer, 1.0..=4.0, "a number from 1 to 4 is wanted, e.g. 1.5")
}

/// Factor on the lengths of a mesh file: 1e-9 (nanometres) to 1e6.
///
/// # Errors
/// As the quantity, or when it is outside.
pub fn mesh_scale<'de, De: Deserializer<'de>>(deserializer: De) -> Result<Ratio, De::Error> {
    within(deserializer, 1e-9..=1e6, "a factor of 1e-9 to 1e6 is wanted, e.g. 0.01 for a mesh in centimetres")
}

/// Relative deviation of a quantity that must stay positive: from 0 to 0.9.
///
/// # Errors
/// As the quantity, or when it is outside.
pub fn relative_deviation<'de, De: Deserializer<'de>>(deserializer: De) -> Result<Ratio, De::Error> {
    within(deserializer, 0.0..=0.9, "a relative deviation from 0 to 0.9 is wanted, e.g. 0.15 or \"15 %\"")
}

/// Spread of radii about their mean: from 0 to 0.6; more, and the smallest would be lost between the largest.
///
/// # Errors
/// As the quantity, or when it is outside.
pub fn radius_spread<'de, De: Deserializer<'de>>(deserializer: De) -> Result<Ratio, De::Error> {
    within(deserializer, 0.0..=0.6, "a spread of radii from 0 to 0.6 is wanted, e.g. 0.2")
}

/// Thickness of a film: 1 nm to 1 mm. A bare `500` is 500 metres, hardly what was meant.
///
/// # Errors
/// As the quantity, or when it is outside.
pub fn film_thickness<'de, De: Deserializer<'de>>(deserializer: De) -> Result<Length, De::Error> {
    within(deserializer, 1e-9..=1e-3, "a film is 1 nm to 1 mm thick, e.g. \"500 nm\"; a bare number is in metres")
}

/// Tension of one interface: 1 uN/m to 1 N/m. A bare `25` is 25 N/m, hardly what was meant.
///
/// # Errors
/// As the quantity, or when it is outside.
pub fn interface_tension<'de, De: Deserializer<'de>>(deserializer: De) -> Result<SurfaceTension, De::Error> {
    let rule = "an interface has a tension of 1e-6 to 1 N/m, e.g. \"25 mN/m\"; a bare number is in N/m";
    within(deserializer, 1e-6..=1.0, rule)
}

/// Number of noise octaves: 1 to 12; each halves the length scale, and 12 halvings are below any resolution.
///
/// # Errors
/// As the count, or when it is outside.
pub fn octaves<'de, De: Deserializer<'de>>(deserializer: De) -> Result<u32, De::Error> {
    small_count(deserializer, 12, "1 to 12 octaves are wanted")
}

/// Degree of a spherical harmonic: 1 to 64.
///
/// # Errors
/// As the count, or when it is outside.
pub fn harmonic_degree<'de, De: Deserializer<'de>>(deserializer: De) -> Result<u32, De::Error> {
    small_count(deserializer, 64, "a spherical harmonic has a degree of 1 to 64 here")
}

/// Cells of a foam along one direction: 1 to 1000.
///
/// # Errors
/// As the count, or when it is outside.
pub fn cells<'de, De: Deserializer<'de>>(deserializer: De) -> Result<u32, De::Error> {
    small_count(deserializer, 1000, "1 to 1000 cells along each direction are wanted, e.g. (5, 5, 5)")
}

/// Bubbles of a packing: 1 to 100 000.
///
/// # Errors
/// As the count, or when it is outside.
pub fn bubbles<'de, De: Deserializer<'de>>(deserializer: De) -> Result<u32, De::Error> {
    small_count(deserializer, 100_000, "1 to 100000 bubbles are wanted, e.g. 30")
}

/// Material particles per carrier: 0 (a film whose liquid does not flow) to 1000.
///
/// # Errors
/// As the count, or when it is outside.
pub fn particles_per_carrier<'de, De: Deserializer<'de>>(deserializer: De) -> Result<u32, De::Error> {
    let count = Count::or_zero(deserializer)?;
    at_most(
        count,
        1000,
        "0 to 1000 material particles per carrier are wanted, e.g. 16; 0 is a film whose liquid does not flow",
    )
}

/// Substeps of a step: 1 to 1000.
///
/// # Errors
/// As the count, or when it is outside.
pub fn substeps<'de, De: Deserializer<'de>>(deserializer: De) -> Result<u32, De::Error> {
    small_count(deserializer, 1000, "a step has 1 to 1000 substeps")
}

fn small_count<'de, De: Deserializer<'de>>(deserializer: De, largest: u32, rule: &str) -> Result<u32, De::Error> {
    at_most(Count::deserialize(deserializer)?.get(), largest, rule)
}

fn at_most<E: serde::de::Error>(count: u64, largest: u32, rule: &str) -> Result<u32, E> {
    let small = u32::try_from(count).unwrap_or(u32::MAX);
    demand(small <= largest, small, count, rule.to_owned())
}

fn within<'de, D: Dimension, De: Deserializer<'de>>(
    deserializer: De,
    range: RangeInclusive<f64>,
    rule: &str,
) -> Result<Quantity<D>, De::Error> {
    let value = Quantity::<D>::deserialize(deserializer)?;
    demand(range.contains(&value.si()), value, value, rule.to_owned())
}

/// `value` if `fulfilled`; otherwise the error that `shown` breaks `rule`.
fn demand<T, E: serde::de::Error>(fulfilled: bool, value: T, shown: impl Display, rule: String) -> Result<T, E> {
    if fulfilled {
        return Ok(value);
    }
    Err(Refusal::new(RefusalKind::OutOfRange, format!("`{shown}` is out of range"), rule).into_serde())
}
