//! Numbers, names and limits as messages and helps say them.

use std::fmt::Write;

use crate::scene::estimate::Rows;

/// What a factor on the resolution did to the scene's own number of carriers.
pub(super) fn refinement(factor: Option<f64>, noun: &str) -> String {
    let say = |factor: f64| {
        let times = factor * factor;
        let times = if (0.01..1e6).contains(&times) { times.to_string() } else { format!("{times:.1e}") };
        format!("; `--resolution {factor}` makes {times} times as many {noun} as the file says")
    };
    factor.map(say).unwrap_or_default()
}

pub(super) fn missing_help(nearest: Option<&str>) -> String {
    match nearest {
        Some(nearest) => format!("did you mean `{nearest}`?"),
        None => "write the path of a scene file; `froth scenes` lists those built in".to_owned(),
    }
}

pub(super) fn names_help(nearest: Option<&str>, kind: &str, known: &[String]) -> String {
    let mut help = String::new();
    if let Some(nearest) = nearest {
        let _ = write!(help, "did you mean `{nearest}`? ");
    }
    let _ = match known {
        [] => write!(help, "there are no {kind} here"),
        known => write!(help, "{kind}: {}", known.join(", ")),
    };
    help
}

/// `field: `, or nothing where there is no field.
pub(super) fn prefix(field: &str) -> String {
    if field.is_empty() { String::new() } else { format!("`{field}`: ") }
}

pub(super) fn one_of(names: &[&str]) -> String {
    match names {
        [only] => format!("`{only}`"),
        names => format!("one of {}", names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")),
    }
}

/// Bytes as a person says them.
pub(super) fn memory(bytes: u64) -> String {
    const UNITS: [(&str, f64); 6] = [("EB", 1e18), ("PB", 1e15), ("TB", 1e12), ("GB", 1e9), ("MB", 1e6), ("kB", 1e3)];
    let bytes = bytes as f64;
    let (unit, size) = UNITS.into_iter().find(|(_, size)| bytes >= *size).unwrap_or(("bytes", 1.0));
    format!("{:.1} {unit}", bytes / size)
}

/// A number of particles as a person says it.
pub(super) fn count(number: u64) -> String {
    if number < 10_000_000 { number.to_string() } else { format!("{:.1e}", number as f64) }
}

/// What films are made of as a person says it.
pub(super) fn all_of(rows: &Rows) -> String {
    match *rows {
        Rows::Particles { eulerian, lagrangian, .. } => {
            format!("{} Eulerian and {} Lagrangian particles", count(eulerian), count(lagrangian))
        }
        Rows::Mesh { vertices, faces } => format!("{} vertices and {} faces", count(vertices), count(faces)),
    }
}

/// Metres as a scene file would have them.
pub(super) fn length(metres: f64) -> String {
    const UNITS: [(&str, f64); 5] = [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("nm", 1e-9)];
    let (unit, size) = UNITS.into_iter().find(|(_, size)| metres >= 0.999 * size).unwrap_or(("nm", 1e-9));
    // Three digits are enough, without the zeros that would fill them.
    let digits = format!("{:.2}", metres / size);
    format!("{} {unit}", digits.trim_end_matches('0').trim_end_matches('.'))
}

/// The next lower number of two digits, so that a limit that is printed still holds.
pub(super) fn rounded_down(value: f64) -> f64 {
    let digit = 10_f64.powf(value.log10().floor() - 1.0);
    (value / digit).floor() * digit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_said_as_people_do() {
        assert_eq!(length(0.05), "5 cm");
        assert_eq!(length(rounded_down(0.045_76)), "4.5 cm");
        assert_eq!(length(1.5e-6), "1.5 um");
        assert_eq!(memory(860_000_000), "860.0 MB");
        assert_eq!(count(4000), "4000");
        assert_eq!(count(1_000_000_000_000), "1.0e12");
    }
}
