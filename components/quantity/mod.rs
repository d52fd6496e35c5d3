//! Dimensioned values: SI inside, units at the border.
//!
//! A scene field of type [`Length`] takes a bare number (metres) or text with a unit (`"5 cm"`), and refuses a mass, an unknown
//! unit, NaN and infinity with a [`Refusal`] that says what to write. The loader turns that into an error with file, line and caret.
//!
//! Next: the dimensions ([`dimension`]), how units are read ([`mod@unit`]), vectors ([`Vector`]), values over time ([`Keyframed`]).

mod count;
pub mod dimension;
mod keyframed;
pub mod range;
mod refusal;
pub mod unit;
mod vector;

use std::cmp::Ordering;
use std::fmt;
use std::marker::PhantomData;

use serde::de::{Deserialize, Deserializer, Visitor};

pub use count::Count;
pub use dimension::Dimension;
pub use keyframed::{Keyframe, KeyframeValue, Keyframed};
pub use refusal::{Refusal, RefusalKind};
pub use vector::{Direction, Vector};

/// A finite value of one dimension, in SI units.
pub struct Quantity<D>(f64, PhantomData<D>);

/// A length, metres.
pub type Length = Quantity<dimension::Length>;
/// A volume, cubic metres.
pub type Volume = Quantity<dimension::Volume>;
/// A time, seconds.
pub type Time = Quantity<dimension::Time>;
/// A speed, metres per second.
pub type Speed = Quantity<dimension::Speed>;
/// An acceleration, metres per second squared.
pub type Acceleration = Quantity<dimension::Acceleration>;
/// A pressure, pascals.
pub type Pressure = Quantity<dimension::Pressure>;
/// A surface tension or surface elasticity of one interface, newtons per metre.
pub type SurfaceTension = Quantity<dimension::SurfaceTension>;
/// A density, kilograms per cubic metre.
pub type Density = Quantity<dimension::Density>;
/// A mass per area, kilograms per square metre.
pub type MassPerArea = Quantity<dimension::MassPerArea>;
/// A kinematic viscosity or a diffusivity, square metres per second.
pub type Viscosity = Quantity<dimension::Viscosity>;
/// A mobility, metres per second and pascal.
pub type Mobility = Quantity<dimension::Mobility>;
/// A temperature, kelvins.
pub type Temperature = Quantity<dimension::Temperature>;
/// A rate or frequency, per second.
pub type Rate = Quantity<dimension::Rate>;
/// An angular speed, radians per second.
pub type AngularSpeed = Quantity<dimension::AngularSpeed>;
/// An angle, radians.
pub type Angle = Quantity<dimension::Angle>;
/// A plain number.
pub type Ratio = Quantity<dimension::Ratio>;

/// Longest piece of a scene file an error repeats, characters.
const QUOTE_LENGTH: usize = 40;

impl<D> Quantity<D> {
    /// A value in SI units. For literals in code; text and files go through [`Quantity::parse`] and serde, which refuse what is not finite.
    #[must_use]
    pub const fn from_si(value: f64) -> Self {
        Self(value, PhantomData)
    }

    /// The value in SI units.
    #[must_use]
    pub const fn si(self) -> f64 {
        self.0
    }
}

impl<D: Dimension> Quantity<D> {
    /// Reads a number with its unit, such as `25 mN/m`.
    ///
    /// # Errors
    /// When the text is no number with a unit, the unit is unknown or of another dimension, or the value is not finite.
    pub fn parse(text: &str) -> Result<Self, Refusal> {
        let (number, unit_text) = split_number(text.trim());
        let Ok(number) = number.parse::<f64>() else {
            return Err(Self::not_a_number(text));
        };
        let unit = unit::parse(unit_text).map_err(|unknown| Self::unknown_unit(unit_text, &unknown.0))?;
        if unit.exponents != D::INFO.exponents {
            return Err(Self::wrong_dimension(text, unit.exponents));
        }
        Self::finite(unit.factor * number + unit.offset)
            .map_err(|refusal| Refusal { message: format!("`{}` is not a finite number", quote(text)), ..refusal })
    }

    /// A value in SI units, unless it is NaN or infinite.
    fn finite(value: f64) -> Result<Self, Refusal> {
        if value.is_finite() {
            return Ok(Self::from_si(value));
        }
        Err(Refusal::new(RefusalKind::NotFinite, format!("`{value}` is not a finite number"), Self::wanted()))
    }

    /// What a value of this dimension looks like.
    fn wanted() -> String {
        format!("{} is wanted, e.g. {}", D::INFO.name, D::INFO.example)
    }

    fn not_a_number(text: &str) -> Refusal {
        let lower = text.trim().trim_start_matches(['+', '-']).to_ascii_lowercase();
        let (kind, fault) = if lower.starts_with("nan") || lower.starts_with("inf") {
            (RefusalKind::NotFinite, "is not a finite number")
        } else {
            (RefusalKind::WrongType, "does not begin with a number")
        };
        Refusal::new(kind, format!("`{}` {fault}", quote(text)), Self::wanted())
    }

    fn unknown_unit(unit: &str, symbol: &str) -> Refusal {
        let known = D::INFO.units.join(", ");
        let nearest = nearest(unit.trim(), D::INFO.units.iter().copied());
        let suggestion = nearest.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
        let help = format!("{suggestion}{} is written in {known} and the like, e.g. {}", D::INFO.name, D::INFO.example);
        Refusal::new(RefusalKind::UnknownUnit, format!("unknown unit `{}`", quote(symbol)), help)
    }

    fn wrong_dimension(text: &str, found: dimension::Exponents) -> Refusal {
        let text = quote(text);
        let message = match (found == dimension::Exponents::NONE, text.ends_with('%')) {
            (true, false) => format!("`{text}` has no unit; {}", Self::wanted()),
            _ => format!("`{text}` is {}; {}", dimension::name(found), Self::wanted()),
        };
        let help = if D::INFO.units == ["%"] {
            "leave the unit away".to_owned()
        } else {
            format!("units of {}: {}", D::INFO.name, D::INFO.units.join(", "))
        };
        Refusal::new(RefusalKind::WrongDimension, message, help)
    }
}

/// Splits `25 mN/m` into `25` and ` mN/m`.
fn split_number(text: &str) -> (&str, &str) {
    let bytes = text.as_bytes();
    let mut end = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let is_exponent = |at: usize| match bytes.get(at + 1) {
        Some(b'+' | b'-') => bytes.get(at + 2).is_some_and(u8::is_ascii_digit),
        next => next.is_some_and(u8::is_ascii_digit),
    };
    while let Some(&byte) = bytes.get(end) {
        match byte {
            b'0'..=b'9' | b'.' => end += 1,
            b'e' | b'E' if is_exponent(end) => end += 2,
            _ => break,
        }
    }
    text.split_at(end)
}

/// A piece of a scene file, short enough to repeat.
fn quote(text: &str) -> String {
    let text = text.trim();
    match text.char_indices().nth(QUOTE_LENGTH) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// The known name most like `name`, if any is near enough to be what was meant.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const NEAR_ENOUGH: f64 = 0.7;
    let name = quote(name).to_lowercase();
    let similarity = |candidate: &str| {
        let candidate = candidate.to_lowercase();
        let is_one_slip_away = name.len() > 2 && strsim::osa_distance(&name, &candidate) == 1;
        strsim::jaro_winkler(&name, &candidate).max(if is_one_slip_away { NEAR_ENOUGH } else { 0.0 })
    };
    known
        .into_iter()
        .map(|candidate| (similarity(candidate), candidate))
        .filter(|(similarity, _)| *similarity >= NEAR_ENOUGH)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

impl<D> Clone for Quantity<D> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<D> Copy for Quantity<D> {}

impl<D> PartialEq for Quantity<D> {
    fn eq(&self, other: &Self) -> bool {
        self.0 == other.0
    }
}

impl<D> PartialOrd for Quantity<D> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.0.partial_cmp(&other.0)
    }
}

impl<D> Default for Quantity<D> {
    fn default() -> Self {
        Self::from_si(0.0)
    }
}

impl<D: Dimension> fmt::Display for Quantity<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let separator = if D::INFO.si_unit.is_empty() { "" } else { " " };
        // The debug form of a float switches to exponents where the plain one fills the line with zeros.
        write!(f, "{:?}{separator}{}", self.0, D::INFO.si_unit)
    }
}

impl<D: Dimension> fmt::Debug for Quantity<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl<D> serde::Serialize for Quantity<D> {
    /// As the bare SI number.
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_f64(self.0)
    }
}

impl<'de, D: Dimension> Deserialize<'de> for Quantity<D> {
    fn deserialize<De: Deserializer<'de>>(deserializer: De) -> Result<Self, De::Error> {
        deserializer.deserialize_any(QuantityVisitor(PhantomData))
    }
}

struct QuantityVisitor<D>(PhantomData<D>);

impl<D: Dimension> Visitor<'_> for QuantityVisitor<D> {
    type Value = Quantity<D>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, e.g. {}", D::INFO.name, D::INFO.example)
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Self::Value, E> {
        Quantity::finite(value).map_err(Refusal::into_serde)
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<Self::Value, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Self::Value, E> {
        Quantity::parse(text).map_err(Refusal::into_serde)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn length(text: &str) -> f64 {
        Length::parse(text).unwrap().si()
    }

    #[test]
    fn a_number_with_a_unit_becomes_si() {
        assert_eq!(length("5 cm"), 0.05);
        assert_eq!(length("500nm"), 500.0 * 1e-9);
        assert_eq!(length("-1.5e-2 m"), -0.015);
        assert_eq!(Pressure::parse("1 atm").unwrap().si(), 101_325.0);
        assert_eq!(Temperature::parse("25 degC").unwrap().si(), 298.15);
        assert_eq!(Rate::parse("5 1/s"), Rate::parse("5 Hz"));
        assert_eq!(Rate::parse("5/s"), Rate::parse("5 Hz"));
        assert_eq!(Ratio::parse("15 %").unwrap().si(), 0.15);
    }

    #[test]
    fn a_wrong_dimension_is_named() {
        let refusal = Length::parse("5 kg").unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::WrongDimension);
        assert_eq!(refusal.message, "`5 kg` is a mass; a length is wanted, e.g. 0.05 or \"5 cm\"");
        assert!(Length::parse("5").unwrap_err().message.starts_with("`5` has no unit; a length is wanted"));
        assert!(Ratio::parse("30 deg").unwrap_err().message.starts_with("`30 deg` is an angle; a plain number"));
    }

    #[test]
    fn an_unknown_unit_suggests_the_nearest() {
        let refusal = SurfaceTension::parse("25 nM/m").unwrap_err();
        assert_eq!(refusal.kind, RefusalKind::UnknownUnit);
        assert_eq!(refusal.message, "unknown unit `nM`");
        assert!(refusal.help.starts_with("did you mean `mN/m`?"), "{}", refusal.help);
    }

    #[test]
    fn what_is_not_finite_is_refused() {
        for text in ["NaN m", "inf m", "-inf", "1e400 m"] {
            assert_eq!(Length::parse(text).unwrap_err().kind, RefusalKind::NotFinite, "{text}");
        }
    }

    #[test]
    fn text_without_a_number_is_refused() {
        for text in ["", "wide", "cm 5", ".", "- 5 m"] {
            assert_eq!(Length::parse(text).unwrap_err().kind, RefusalKind::WrongType, "{text:?}");
        }
    }

    proptest! {
        #[test]
        fn the_printed_form_reads_back(value in prop::num::f64::NORMAL) {
            prop_assert_eq!(Length::parse(&Length::from_si(value).to_string()).unwrap().si(), value);
            prop_assert_eq!(Ratio::parse(&Ratio::from_si(value).to_string()).unwrap().si(), value);
        }

        #[test]
        fn every_unit_round_trips(value in -1e6..1e6_f64, which in 0..dimension::Length::INFO.units.len()) {
            let symbol = dimension::Length::INFO.units[which];
            let si = length(&format!("{value} {symbol}"));
            let back = si / unit::parse(symbol).unwrap().factor;
            prop_assert!((back - value).abs() <= 4.0 * f64::EPSILON * value.abs());
        }

        #[test]
        fn no_text_panics(text in ".*") {
            let _ = Length::parse(&text);
            let _ = Temperature::parse(&format!("3 {text}"));
        }
    }
}
