//! The physical dimensions a scene can speak of, each with its name, its SI unit and an example.
//!
//! A dimension is a row of exponents over six base units; [`Dimension`] makes a type of each row that a scene field can have.
//! How a unit is read: [`unit`](super::unit).

use std::fmt;

/// Exponents of the base units metre, kilogram, second, kelvin, mole and radian.
///
/// The radian counts as a base unit here, so that `"30 deg"` where a ratio is wanted is an error and not 0.52.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Exponents(pub [i32; 6]);

impl Exponents {
    /// A plain number.
    pub const NONE: Self = Self([0; 6]);
    /// Symbols of the base units, in the order of the exponents.
    pub const SYMBOLS: [&str; 6] = ["m", "kg", "s", "K", "mol", "rad"];

    /// `self * other^power`, saturating: an absurd power stays an absurd power.
    #[must_use]
    pub fn times(self, other: Self, power: i32) -> Self {
        Self(std::array::from_fn(|i| self.0[i].saturating_add(other.0[i].saturating_mul(power))))
    }
}

impl fmt::Display for Exponents {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        for (symbol, &power) in Self::SYMBOLS.iter().zip(&self.0).filter(|(_, power)| **power != 0) {
            write!(f, "{separator}{symbol}")?;
            if power != 1 {
                write!(f, "^{power}")?;
            }
            separator = " ";
        }
        Ok(())
    }
}

/// What a dimension is called and how its values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DimensionInfo {
    /// Name with its article, such as `a length`.
    pub name: &'static str,
    /// Symbol of the SI unit; empty for a plain number.
    pub si_unit: &'static str,
    /// Exponents of the base units.
    pub exponents: Exponents,
    /// How a value may be written in a scene file.
    pub example: &'static str,
    /// Usual units, which an error lists and searches for the nearest.
    pub units: &'static [&'static str],
}

/// A dimension as a type, so that a length cannot be passed where a time is wanted.
pub trait Dimension: Copy + fmt::Debug + Send + Sync + 'static {
    /// Name, unit and example.
    const INFO: DimensionInfo;
}

macro_rules! dimensions {
    ($($(#[$doc:meta])* $marker:ident: $name:literal, $si:literal, $exponents:expr, $example:literal, $units:expr;)*) => {
        $($(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $marker {}
        impl Dimension for $marker {
            const INFO: DimensionInfo = DimensionInfo {
                name: $name, si_unit: $si, exponents: Exponents($exponents), example: $example, units: &$units,
            };
        })*
        /// The dimensions a scene field can have.
        pub const AUTHORED: &[DimensionInfo] = &[$($marker::INFO),*];
    };
}

//                                                      m  kg  s  K  mol rad
dimensions! {
    /// Metres.
    Length: "a length", "m",                            [1, 0, 0, 0, 0, 0], "0.05 or \"5 cm\"", ["m", "cm", "mm", "um", "nm"];
    /// Cubic metres.
    Volume: "a volume", "m^3",                          [3, 0, 0, 0, 0, 0], "1e-4 or \"100 ml\"", ["m^3", "L", "ml", "cm^3", "mm^3"];
    /// Seconds.
    Time: "a time", "s",                                [0, 0, 1, 0, 0, 0], "2 or \"20 ms\"", ["s", "ms", "us", "min", "h"];
    /// Metres per second.
    Speed: "a speed", "m/s",                            [1, 0, -1, 0, 0, 0], "0.1 or \"10 cm/s\"", ["m/s", "cm/s", "mm/s"];
    /// Metres per second squared.
    Acceleration: "an acceleration", "m/s^2",           [1, 0, -2, 0, 0, 0], "9.81 or \"9.81 m/s^2\"", ["m/s^2", "cm/s^2", "mm/s^2"];
    /// Pascals.
    Pressure: "a pressure", "Pa",                       [-1, 1, -2, 0, 0, 0], "101325 or \"1 atm\"", ["Pa", "hPa", "kPa", "mbar", "bar", "atm"];
    /// Newtons per metre: tension of one interface, or its elasticity.
    SurfaceTension: "a surface tension", "N/m",         [0, 1, -2, 0, 0, 0], "0.025 or \"25 mN/m\"", ["N/m", "mN/m", "uN/m", "dyn/cm"];
    /// Kilograms per cubic metre.
    Density: "a density", "kg/m^3",                     [-3, 1, 0, 0, 0, 0], "1000 or \"1 g/cm^3\"", ["kg/m^3", "g/cm^3", "g/L"];
    /// Kilograms per square metre.
    MassPerArea: "a mass per area", "kg/m^2",           [-2, 1, 0, 0, 0, 0], "0.05 or \"50 g/m^2\"", ["kg/m^2", "g/m^2", "mg/m^2"];
    /// Square metres per second: kinematic viscosity, diffusivity.
    Viscosity: "a kinematic viscosity", "m^2/s",        [2, 0, -1, 0, 0, 0], "1e-6 or \"1 mm^2/s\"", ["m^2/s", "cm^2/s", "mm^2/s", "cSt"];
    /// Metres per second and pascal: speed of a film per force per area.
    Mobility: "a mobility", "m/s/Pa",                   [2, -1, 1, 0, 0, 0], "0.1 or \"10 cm/s/Pa\"", ["m/s/Pa", "cm/s/Pa", "mm/s/Pa"];
    /// Kelvins.
    Temperature: "a temperature", "K",                  [0, 0, 0, 1, 0, 0], "298.15 or \"25 degC\"", ["K", "degC"];
    /// Events or relaxations per second.
    Rate: "a rate", "1/s",                              [0, 0, -1, 0, 0, 0], "5 or \"5 1/s\"", ["1/s", "Hz", "kHz", "1/min"];
    /// Radians per second.
    AngularSpeed: "an angular speed", "rad/s",          [0, 0, -1, 0, 0, 1], "6.3 or \"360 deg/s\"", ["rad/s", "deg/s", "rpm"];
    /// Radians.
    Angle: "an angle", "rad",                           [0, 0, 0, 0, 0, 1], "0.52 or \"30 deg\"", ["rad", "mrad", "deg"];
    /// A plain number.
    Ratio: "a plain number", "",                        [0, 0, 0, 0, 0, 0], "0.15 or \"15 %\"", ["%"];
}

/// Dimensions that no scene field has, named only to say what a misplaced value is.
const FOREIGN: &[(&str, [i32; 6])] = &[
    ("a mass", [0, 1, 0, 0, 0, 0]),
    ("an amount of substance", [0, 0, 0, 0, 1, 0]),
    ("an area", [2, 0, 0, 0, 0, 0]),
    ("a force", [1, 1, -2, 0, 0, 0]),
    ("an energy", [2, 1, -2, 0, 0, 0]),
    ("a power", [2, 1, -3, 0, 0, 0]),
    ("a dynamic viscosity", [-1, 1, -1, 0, 0, 0]),
    ("a surface viscosity", [0, 1, -1, 0, 0, 0]),
    ("a surface concentration", [-2, 0, 0, 0, 1, 0]),
    ("a concentration", [-3, 0, 0, 0, 1, 0]),
];

/// Name of a dimension with its article, or its base units where it has no name.
#[must_use]
pub fn name(exponents: Exponents) -> String {
    let authored = AUTHORED.iter().find(|info| info.exponents == exponents).map(|info| info.name);
    let foreign = || FOREIGN.iter().find(|(_, foreign)| *foreign == exponents.0).map(|(name, _)| *name);
    authored.or_else(foreign).map_or_else(|| format!("a quantity in {exponents}"), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::unit;

    #[test]
    fn every_listed_unit_has_the_dimension_that_lists_it() {
        for info in AUTHORED {
            for symbol in info.units.iter().chain([&info.si_unit]) {
                let parsed = unit::parse(symbol).unwrap_or_else(|error| panic!("{symbol}: {error:?}"));
                assert_eq!(parsed.exponents, info.exponents, "{symbol} of {}", info.name);
            }
        }
    }

    #[test]
    fn every_si_unit_has_factor_one() {
        for info in AUTHORED {
            let parsed = unit::parse(info.si_unit).unwrap();
            assert_eq!((parsed.factor, parsed.offset), (1.0, 0.0), "{}", info.si_unit);
        }
    }

    #[test]
    fn a_dimension_without_a_name_shows_its_base_units() {
        assert_eq!(name(Exponents([2, 0, -3, 0, 0, 0])), "a quantity in m^2 s^-3");
    }
}
