//! What clusters of bubbles and films in frames come to rest at, as the Surface Evolver finds it: the table of `assets/evolver`.

/// A row of the table, in the unit of length of its datafile, with films of tension 1.
pub(super) struct Minimum {
    /// Area of all films.
    pub(super) area: f64,
    /// Volume and pressure of regions 1, 2, ...
    pub(super) bodies: Vec<[f64; 2]>,
}

impl Minimum {
    /// The row of a name.
    pub(super) fn of(name: &str) -> Self {
        let rows = include_str!("../../assets/evolver/minima.csv").lines();
        let mut cells =
            rows.map(|row| row.split(',')).find_map(|mut cells| (cells.next() == Some(name)).then_some(cells));
        let cells = cells.as_mut().expect("invariant: laws name rows of the table");
        let number = |cell: &str| cell.parse().unwrap_or(f64::NAN);
        let numbers: Vec<f64> = cells.filter(|cell| !cell.is_empty()).map(number).collect();
        // The second is how well the first is known.
        let bodies = numbers[2..].chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        Self { area: numbers[0], bodies }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_keep_the_virial_law() {
        for name in ["double_bubble", "triple_bubble_unequal", "quadruple_bubble_unequal"] {
            let minimum = Minimum::of(name);
            // Scale all lengths: 2 A = 3 sum p V.
            let work: f64 = minimum.bodies.iter().map(|[volume, pressure]| 3.0 * volume * pressure).sum();
            assert!((2.0 * minimum.area / work - 1.0).abs() < 1e-6, "{name}");
        }
        assert!(Minimum::of("cubic_frame").bodies.is_empty());
    }
}
