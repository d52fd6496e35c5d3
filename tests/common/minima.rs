//! The table of minima that the Surface Evolver found, `assets/evolver/minima.csv`.

use std::fs;
use std::path::PathBuf;

use froth_surface::Region;
use froth_surface::files::evolver::Body;

/// A row of the table, in the unit of length of its datafile.
#[derive(Clone, Debug)]
pub(crate) struct Recorded {
    pub(crate) name: String,
    pub(crate) area: f64,
    /// Relative change of the area from the second finest mesh to the finest.
    pub(crate) last_change: f64,
    /// Volumes and pressures of regions 1, 2, ...
    pub(crate) bodies: Vec<Body>,
}

/// All rows, in the order of the file.
pub(crate) fn recorded_minima() -> Vec<Recorded> {
    let text = fs::read_to_string(folder().join("minima.csv")).unwrap();
    text.lines().skip(1).map(read_row).collect()
}

/// The row of a name.
pub(crate) fn recorded(name: &str) -> Recorded {
    let row = recorded_minima().into_iter().find(|row| row.name == name);
    row.unwrap_or_else(|| panic!("there is no minimum `{name}`"))
}

/// The datafile that the row of a name was found from.
pub(crate) fn datafile_of(name: &str) -> String {
    fs::read_to_string(folder().join(name).with_extension("fe")).unwrap()
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("assets/evolver")
}

fn read_row(line: &str) -> Recorded {
    let cells: Vec<&str> = line.split(',').collect();
    let number = |cell: &str| cell.parse::<f64>().unwrap_or_else(|_| panic!("`{cell}` in {line}"));
    let pairs = cells[3..].chunks_exact(2).filter(|pair| !pair[0].is_empty());
    let bodies = (1..).zip(pairs).map(|(region, pair)| Body {
        region: Region(region),
        volume: number(pair[0]),
        pressure: number(pair[1]),
    });
    Recorded {
        name: cells[0].to_owned(),
        area: number(cells[1]),
        last_change: number(cells[2]),
        bodies: bodies.collect(),
    }
}
