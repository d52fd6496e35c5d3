//! Reads a unit such as `mN/m` or `m^2/s` as a factor to SI and a row of exponents.
//!
//! Grammar: `factor (('/' | '*' | ' ') factor)*` from left to right, `factor = '1' | [prefix] symbol ['^' integer]`.
//! Hence `m/s/s`, `m/s^2` and `m s^-2` are one unit. `°`, `µ`, `²` and `³` are understood.

use super::dimension::Exponents;

/// A unit: `SI value = factor * value + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// SI units per unit.
    pub factor: f64,
    /// SI value of zero; other than 0 only for `degC`.
    pub offset: f64,
    /// Which dimension.
    pub exponents: Exponents,
}

/// The part of a unit that could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownSymbol(pub String);

struct Symbol {
    text: &'static str,
    factor: f64,
    exponents: [i32; 6],
    prefixed: Prefixed,
}

#[derive(PartialEq)]
enum Prefixed {
    Yes,
    No,
}
use Prefixed::{No, Yes};

#[rustfmt::skip]
const SYMBOLS: &[Symbol] = &[
    Symbol { text: "m",    factor: 1.0,      exponents: [1, 0, 0, 0, 0, 0],   prefixed: Yes },
    Symbol { text: "g",    factor: 1e-3,     exponents: [0, 1, 0, 0, 0, 0],   prefixed: Yes },
    Symbol { text: "s",    factor: 1.0,      exponents: [0, 0, 1, 0, 0, 0],   prefixed: Yes },
    Symbol { text: "K",    factor: 1.0,      exponents: [0, 0, 0, 1, 0, 0],   prefixed: Yes },
    Symbol { text: "degC", factor: 1.0,      exponents: [0, 0, 0, 1, 0, 0],   prefixed: No },
    Symbol { text: "mol",  factor: 1.0,      exponents: [0, 0, 0, 0, 1, 0],   prefixed: Yes },
    Symbol { text: "rad",  factor: 1.0,      exponents: [0, 0, 0, 0, 0, 1],   prefixed: Yes },
    Symbol { text: "deg",  factor: std::f64::consts::PI / 180.0, exponents: [0, 0, 0, 0, 0, 1], prefixed: No },
    Symbol { text: "rpm",  factor: std::f64::consts::PI / 30.0, exponents: [0, 0, -1, 0, 0, 1], prefixed: No },
    Symbol { text: "min",  factor: 60.0,     exponents: [0, 0, 1, 0, 0, 0],   prefixed: No },
    Symbol { text: "h",    factor: 3600.0,   exponents: [0, 0, 1, 0, 0, 0],   prefixed: No },
    Symbol { text: "Hz",   factor: 1.0,      exponents: [0, 0, -1, 0, 0, 0],  prefixed: Yes },
    Symbol { text: "N",    factor: 1.0,      exponents: [1, 1, -2, 0, 0, 0],  prefixed: Yes },
    Symbol { text: "dyn",  factor: 1e-5,     exponents: [1, 1, -2, 0, 0, 0],  prefixed: No },
    Symbol { text: "Pa",   factor: 1.0,      exponents: [-1, 1, -2, 0, 0, 0], prefixed: Yes },
    Symbol { text: "bar",  factor: 1e5,      exponents: [-1, 1, -2, 0, 0, 0], prefixed: Yes },
    Symbol { text: "atm",  factor: 101_325.0, exponents: [-1, 1, -2, 0, 0, 0], prefixed: No },
    Symbol { text: "J",    factor: 1.0,      exponents: [2, 1, -2, 0, 0, 0],  prefixed: Yes },
    Symbol { text: "W",    factor: 1.0,      exponents: [2, 1, -3, 0, 0, 0],  prefixed: Yes },
    Symbol { text: "L",    factor: 1e-3,     exponents: [3, 0, 0, 0, 0, 0],   prefixed: Yes },
    Symbol { text: "l",    factor: 1e-3,     exponents: [3, 0, 0, 0, 0, 0],   prefixed: Yes },
    Symbol { text: "St",   factor: 1e-4,     exponents: [2, 0, -1, 0, 0, 0],  prefixed: Yes },
    Symbol { text: "%",    factor: 1e-2,     exponents: [0, 0, 0, 0, 0, 0],   prefixed: No },
    Symbol { text: "1",    factor: 1.0,      exponents: [0, 0, 0, 0, 0, 0],   prefixed: No },
];

const PREFIXES: &[(char, f64)] = &[
    ('p', 1e-12),
    ('n', 1e-9),
    ('u', 1e-6),
    ('m', 1e-3),
    ('c', 1e-2),
    ('d', 1e-1),
    ('h', 1e2),
    ('k', 1e3),
    ('M', 1e6),
    ('G', 1e9),
];

/// Kelvins at zero degrees Celsius.
const CELSIUS_ZERO: f64 = 273.15;

/// Reads a unit; the empty text is the unit of plain numbers.
///
/// # Errors
/// The first factor that is no known unit.
pub fn parse(text: &str) -> Result<Unit, UnknownSymbol> {
    let text = plain_spelling(text.trim());
    if text == "degC" {
        return Ok(Unit { factor: 1.0, offset: CELSIUS_ZERO, exponents: Exponents([0, 0, 0, 1, 0, 0]) });
    }
    let mut unit = Unit { factor: 1.0, offset: 0.0, exponents: Exponents::NONE };
    let mut sign = 1;
    let mut rest = text.as_str();
    while !rest.is_empty() {
        let end = rest.find(['/', '*', ' ']).unwrap_or(rest.len());
        if end > 0 {
            unit = multiply(unit, &rest[..end], sign)?;
            sign = 1;
        }
        sign = if rest[end..].starts_with('/') { -1 } else { sign };
        rest = &rest[end..];
        rest = rest.get(1..).unwrap_or("");
    }
    if sign < 0 { Err(UnknownSymbol(text)) } else { Ok(unit) }
}

/// `unit * factor^sign`, where the factor is written like `mm^2`.
fn multiply(unit: Unit, factor: &str, sign: i32) -> Result<Unit, UnknownSymbol> {
    let unknown = || UnknownSymbol(factor.to_owned());
    let (symbol, power) = factor.split_once('^').unwrap_or((factor, "1"));
    let power = sign * power.parse::<i8>().map(i32::from).map_err(|_| unknown())?;
    let (scale, exponents) = find(symbol).ok_or_else(unknown)?;
    Ok(Unit { factor: unit.factor * scale.powi(power), exponents: unit.exponents.times(exponents, power), ..unit })
}

/// A symbol by its full name first (`min` is a minute), then as prefix and symbol (`mm` is a millimetre).
fn find(text: &str) -> Option<(f64, Exponents)> {
    let whole =
        SYMBOLS.iter().find(|symbol| symbol.text == text).map(|symbol| (symbol.factor, Exponents(symbol.exponents)));
    whole.or_else(|| {
        let first = text.chars().next()?;
        let &(_, scale) = PREFIXES.iter().find(|(prefix, _)| *prefix == first)?;
        let symbol =
            SYMBOLS.iter().find(|symbol| symbol.prefixed == Yes && symbol.text == &text[first.len_utf8()..])?;
        Some((scale * symbol.factor, Exponents(symbol.exponents)))
    })
}

/// Replaces the letters a keyboard lacks by those it has.
fn plain_spelling(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            'µ' | 'μ' => plain.push('u'),
            '·' | '×' => plain.push('*'),
            '²' => plain.push_str("^2"),
            '³' => plain.push_str("^3"),
            '°' => plain.push_str("deg"),
            other => plain.push(other),
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(text: &str) -> f64 {
        parse(text).unwrap().factor
    }

    #[test]
    fn one_unit_may_be_spelt_in_several_ways() {
        for spelling in ["m/s^2", "m/s/s", "m s^-2", "m*s^-2", "m/s²", " m / s^2 "] {
            assert_eq!(parse(spelling).unwrap(), parse("m/s^2").unwrap(), "{spelling}");
        }
        assert_eq!(parse("µm"), parse("um"));
        assert_eq!(parse("°C"), parse("degC"));
    }

    #[test]
    fn a_prefix_multiplies_its_unit() {
        assert_eq!(factor("nm"), 1e-9);
        assert_eq!(factor("mN/m"), 1e-3);
        assert_eq!(factor("g/cm^3").round(), 1000.0);
        assert_eq!(factor("hPa"), 100.0);
    }

    #[test]
    fn a_minute_is_not_a_milli_inch() {
        assert_eq!(factor("min"), 60.0);
    }

    #[test]
    fn what_is_no_unit_is_named() {
        assert_eq!(parse("nmm"), Err(UnknownSymbol("nmm".into())));
        assert_eq!(parse("m/sec"), Err(UnknownSymbol("sec".into())));
        assert_eq!(parse("m^x"), Err(UnknownSymbol("m^x".into())));
        assert_eq!(parse("m/"), Err(UnknownSymbol("m/".into())));
        assert_eq!(parse("kdegC"), Err(UnknownSymbol("kdegC".into())));
    }
}
