//! Surfaces as files of other programs: meshes with region labels from OBJ and PLY, and datafiles for the Surface Evolver
//! ([`evolver`]).
//!
//! | | OBJ | PLY |
//! |---|---|---|
//! | labels of a face | the last `g BACK FRONT` before it | properties `back` and `front` |
//! | ghost | `g BACK FRONT ghost` | property `ghost`, not 0 |
//! | held vertices | those of `l` lines | property `pinned` of vertices, not 0 |
//! | open regions | `# open 2 3` | `comment open 2 3` |
//!
//! Labels are whole numbers; the right-hand normal of a face points from BACK to FRONT. A file without labels is one closed
//! bubble: back 1, front 0. Polygons are cut into fans where they are nearly flat. Vertices come before the faces that use
//! them. Files are not trusted: nothing is sized by what a header says, lines and polygons have a largest length, and every
//! fault names the place. What is read is then checked by [`validate`](crate::fault::validate).

pub mod evolver;
mod obj;
mod ply;

use std::fmt;
use std::io::BufRead;
use std::path::Path;

use glam::DVec3;
use thiserror::Error;

use crate::surface::LabelledTriangles;

pub use obj::read_obj;
pub use ply::read_ply;

/// Longest line, bytes.
const LONGEST_LINE: u64 = 1 << 16;
/// Most corners of a polygon.
const MOST_CORNERS: usize = 256;
/// How far corners may lie off the plane of their polygon, in its greatest extent.
const BEND: f64 = 0.05;

/// What a file has at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// What it is: `vertex`, `face`, `line`.
    pub what: &'static str,
    /// Its number in the file, from 0.
    pub row: u64,
    /// Its line, from 1; none in a binary file.
    pub line: Option<u64>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{} {} (line {line})", self.what, self.row),
            None => write!(f, "{} {}", self.what, self.row),
        }
    }
}

/// A fault of a file. Vertices and faces count from 0, lines from 1.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileFault {
    /// The file could not be read.
    #[error("the file cannot be read: {0}")]
    Read(#[from] std::io::Error),
    /// Neither `.obj` nor `.ply`.
    #[error("the extension of {name:?} is not known: .obj and .ply are read")]
    Extension {
        /// Name of the file.
        name: String,
    },
    /// No faces.
    #[error("the file has no faces")]
    Empty,
    /// A line without end.
    #[error(
        "line {line} is longer than {LONGEST_LINE} bytes: this is not a mesh in text, or not the format its name says"
    )]
    LongLine {
        /// The line.
        line: u64,
    },
    /// A word that is not what has to be there.
    #[error("{place}: {word:?} is no {wanted}")]
    Word {
        /// Where.
        place: Place,
        /// The word.
        word: String,
        /// What it should be.
        wanted: &'static str,
    },
    /// Something is not there.
    #[error("{place} has no {wanted}: the line or the file ends too early")]
    Missing {
        /// Where.
        place: Place,
        /// What is not there.
        wanted: &'static str,
    },
    /// A header that cannot be read.
    #[error("line {line} of the header: {reason}")]
    Header {
        /// The line.
        line: u64,
        /// What is wrong.
        reason: &'static str,
    },
    /// A position that is not finite.
    #[error("{place} lies at no finite place: {position}")]
    NotFinite {
        /// The vertex.
        place: Place,
        /// Its position.
        position: DVec3,
    },
    /// An index out of range.
    #[error("{place} names vertex {index}, but {count} vertices come before it, {}", if *from == 0 { "counted from 0" } else { "counted from 1" })]
    NoSuchVertex {
        /// The face or wire.
        place: Place,
        /// The index in the file.
        index: i64,
        /// Vertices before it.
        count: usize,
        /// What the format counts from: 0 or 1.
        from: u8,
    },
    /// Too few corners, or too many.
    #[error("{place} has {corners} corners: from 3 to {MOST_CORNERS} can be cut into triangles")]
    Corners {
        /// The face.
        place: Place,
        /// Its corners.
        corners: usize,
    },
    /// A polygon that is far from flat, or not convex enough to be cut into a fan.
    #[error("{place} has {corners} corners that are not those of a nearly flat, convex polygon: cut it into triangles")]
    Bent {
        /// The face.
        place: Place,
        /// Its corners.
        corners: usize,
    },
    /// More rows than can be numbered.
    #[error("{place}: no more than {} {} can be numbered", u32::MAX, place.what)]
    TooMany {
        /// The row.
        place: Place,
    },
}

/// Reads a mesh by the extension of its name, `.obj` or `.ply`.
///
/// # Errors
/// A [`FileFault`]; faces are in the order of the file.
pub fn read(path: &Path) -> Result<LabelledTriangles, FileFault> {
    let name = path.to_string_lossy();
    reader_of(&name)?;
    read_named(&name, std::io::BufReader::new(std::fs::File::open(path)?))
}

/// The format that a name's extension says.
fn reader_of(name: &str) -> Result<Format, FileFault> {
    let extension = Path::new(name).extension().map(|text| text.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("obj") => Ok(Format::Obj),
        Some("ply") => Ok(Format::Ply),
        _ => Err(FileFault::Extension { name: name.to_owned() }),
    }
}

/// A format that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Obj,
    Ply,
}

/// Reads a mesh from what is in a file of this name, by the name's extension.
///
/// # Errors
/// A [`FileFault`]; faces are in the order of the file.
pub fn read_named(name: &str, source: impl BufRead) -> Result<LabelledTriangles, FileFault> {
    match reader_of(name)? {
        Format::Obj => read_obj(source),
        Format::Ply => read_ply(source),
    }
}

/// Lines of a text, of bounded length.
struct Lines<R> {
    source: R,
    number: u64,
}

impl<R: BufRead> Lines<R> {
    /// The next line without its end; none where the text ends.
    fn next_line(&mut self) -> Result<Option<String>, FileFault> {
        let mut bytes = Vec::new();
        let read = std::io::Read::take(&mut self.source, LONGEST_LINE).read_until(b'\n', &mut bytes)?;
        self.number += 1;
        if read as u64 == LONGEST_LINE && bytes.last() != Some(&b'\n') {
            return Err(FileFault::LongLine { line: self.number });
        }
        Ok((read > 0).then(|| String::from_utf8_lossy(&bytes).trim().to_owned()))
    }
}

fn parse<T: std::str::FromStr>(word: Option<&str>, place: Place, wanted: &'static str) -> Result<T, FileFault> {
    let word = word.ok_or(FileFault::Missing { place, wanted })?;
    word.parse().map_err(|_| FileFault::Word { place, word: word.to_owned(), wanted })
}

fn add_vertex(set: &mut LabelledTriangles, position: DVec3, pinned: bool, place: Place) -> Result<(), FileFault> {
    if !position.is_finite() {
        return Err(FileFault::NotFinite { place, position });
    }
    if set.positions.len() >= u32::MAX as usize {
        return Err(FileFault::TooMany { place });
    }
    set.add_vertex(position, pinned);
    Ok(())
}

/// What all triangles of a polygon have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Kind {
    labels: [u32; 2],
    ghost: bool,
}

impl Default for Kind {
    fn default() -> Self {
        Self { labels: [1, 0], ghost: false }
    }
}

/// Adds a polygon of vertices that exist.
fn add_polygon(set: &mut LabelledTriangles, corners: &[u32], kind: Kind, place: Place) -> Result<(), FileFault> {
    let count = corners.len();
    if !(3..=MOST_CORNERS).contains(&count) {
        return Err(FileFault::Corners { place, corners: count });
    }
    if set.triangles.len() + count > u32::MAX as usize {
        return Err(FileFault::TooMany { place });
    }
    let places: Vec<DVec3> = corners.iter().map(|v| set.positions[*v as usize]).collect();
    let first = if count == 3 { Some(0) } else { fan_start(&places) };
    let first = first.ok_or(FileFault::Bent { place, corners: count })?;
    let at = |k: usize| corners[(first + k) % count];
    (1..count - 1).for_each(|k| set.add_face([at(0), at(k), at(k + 1)], kind.labels, kind.ghost));
    Ok(())
}

/// The first corner from which a fan covers a polygon without folds; none where it is not flat enough.
fn fan_start(places: &[DVec3]) -> Option<usize> {
    let count = places.len();
    let middle = places.iter().sum::<DVec3>() / count as f64;
    let ways: Vec<DVec3> = places.iter().map(|x| *x - middle).collect();
    let normal = (0..count).map(|k| ways[k].cross(ways[(k + 1) % count])).sum::<DVec3>().try_normalize()?;
    let extent = ways.iter().map(|way| way.length()).fold(0.0, f64::max);
    if ways.iter().any(|way| way.dot(normal).abs() > BEND * extent) {
        return None;
    }
    let is_covered = |first: usize| {
        let at = |k: usize| ways[(first + k) % count];
        (1..count - 1).all(|k| (at(k) - at(0)).cross(at(k + 1) - at(0)).dot(normal) > 0.0)
    };
    (0..count).find(|first| is_covered(*first))
}

/// Open regions that a remark names: `open 2 3`.
fn open_regions(remark: &str) -> impl Iterator<Item = u32> + '_ {
    let mut words = remark.split_whitespace();
    let is_open = words.next() == Some("open");
    words.filter(move |_| is_open).map_while(|word| word.parse().ok())
}

fn finished(set: LabelledTriangles) -> Result<LabelledTriangles, FileFault> {
    if set.triangles.is_empty() { Err(FileFault::Empty) } else { Ok(set) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fans_start_where_they_cover_the_polygon() {
        let dart = [
            DVec3::new(1.0, 0.0, 0.0),
            DVec3::new(0.0, 2.0, 0.0),
            DVec3::new(-1.0, 0.0, 0.0),
            DVec3::new(0.0, 0.5, 0.0),
        ];
        assert_eq!(fan_start(&dart), Some(1), "from the tip or the notch only");
        let bent = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.5), DVec3::Y];
        assert_eq!(fan_start(&bent), None);
        let pentagon: Vec<DVec3> =
            (0..5).map(|k| DVec3::new((1.2 * f64::from(k)).cos(), (1.2 * f64::from(k)).sin(), 7.0)).collect();
        assert_eq!(fan_start(&pentagon), Some(0));
    }

    #[test]
    fn an_unknown_extension_is_refused_by_name() {
        let fault = read(Path::new("bubble.stl")).unwrap_err();
        assert!(fault.to_string().contains("bubble.stl"), "{fault}");
    }
}
