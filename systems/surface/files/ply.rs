//! Reads PLY, as text or binary with the low byte first; unknown elements and properties are passed over.

use std::io::BufRead;

use glam::DVec3;

use super::{FileFault, Kind, Lines, MOST_CORNERS, Place, add_polygon, add_vertex, finished, open_regions, parse};
use crate::surface::LabelledTriangles;

/// Most elements and properties of a header.
const MOST_DECLARED: usize = 256;

/// Reads a PLY; see [`super`] for how it says labels.
///
/// # Errors
/// A [`FileFault`] that names the vertex or face, and its line in a text.
pub fn read_ply(source: impl BufRead) -> Result<LabelledTriangles, FileFault> {
    let mut lines = Lines { source, number: 0 };
    let header = read_header(&mut lines)?;
    let mut set = LabelledTriangles { open: header.open, ..Default::default() };
    let mut body = Body { lines, is_text: header.is_text, words: Vec::new().into_iter(), line: None };
    // Rows without properties hold nothing, however many there are.
    for element in header.elements.iter().filter(|element| !element.properties.is_empty()) {
        for row in 0..element.count {
            body.begin_row(element, row)?;
            match element.name.as_str() {
                "vertex" => read_vertex(&mut body, element, row, &mut set)?,
                "face" => read_face(&mut body, element, row, &mut set)?,
                _ => element.properties.iter().try_for_each(|p| body.skip(p, element.place(row, None)))?,
            }
        }
    }
    finished(set)
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

struct Property {
    name: String,
    /// Type of the length, for a list.
    length: Option<Number>,
    value: Number,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

impl Element {
    fn place(&self, row: u64, line: Option<u64>) -> Place {
        let what = match self.name.as_str() {
            "vertex" => "vertex",
            "face" => "face",
            _ => "row of an unknown element",
        };
        Place { what, row, line }
    }
}

struct Header {
    is_text: bool,
    elements: Vec<Element>,
    open: Vec<u32>,
}

fn read_header<R: BufRead>(lines: &mut Lines<R>) -> Result<Header, FileFault> {
    let mut header = Header { is_text: true, elements: Vec::new(), open: Vec::new() };
    if lines.next_line()?.as_deref() != Some("ply") {
        return Err(FileFault::Header { line: 1, reason: "a PLY begins with the word ply" });
    }
    let mut has_format = false;
    let mut declared = 0;
    while let Some(text) = lines.next_line()? {
        let fault = |reason| FileFault::Header { line: lines.number, reason };
        let words: Vec<&str> = text.split_whitespace().collect();
        declared += usize::from(matches!(words.first(), Some(&("element" | "property"))));
        if declared > MOST_DECLARED {
            return Err(fault("more than 256 elements and properties"));
        }
        match words[..] {
            ["format", "ascii", "1.0"] => has_format = true,
            ["format", "binary_little_endian", "1.0"] => (has_format, header.is_text) = (true, false),
            ["format", ..] => return Err(fault("the formats ascii 1.0 and binary_little_endian 1.0 are read")),
            ["comment", ..] => header.open.extend(open_regions(&text["comment".len()..])),
            ["obj_info", ..] => {}
            ["element", name, count] => {
                let count =
                    count.parse::<u32>().map_err(|_| fault("the count of an element is no whole number below 2^32"))?;
                header.elements.push(Element { name: name.to_owned(), count: count.into(), properties: Vec::new() });
            }
            ["property", ..] => {
                let property =
                    parse_property(&words[1..]).ok_or_else(|| fault("a property has a type that is not known"))?;
                let element =
                    header.elements.last_mut().ok_or_else(|| fault("a property comes before every element"))?;
                element.properties.push(property);
            }
            ["end_header"] if has_format => return Ok(header),
            ["end_header"] => return Err(fault("the header ends without a format")),
            [] => {}
            _ => return Err(fault("no such word in a header: format, comment, element, property, end_header")),
        }
    }
    Err(FileFault::Header { line: lines.number, reason: "the file ends within the header" })
}

fn parse_property(words: &[&str]) -> Option<Property> {
    match words {
        ["list", length, value, name] => {
            let length = Some(number(length)?).filter(|n| !matches!(n, Number::F32 | Number::F64))?;
            Some(Property { name: (*name).to_owned(), length: Some(length), value: number(value)? })
        }
        [value, name] => Some(Property { name: (*name).to_owned(), length: None, value: number(value)? }),
        _ => None,
    }
}

fn number(word: &str) -> Option<Number> {
    Some(match word {
        "char" | "int8" => Number::I8,
        "uchar" | "uint8" => Number::U8,
        "short" | "int16" => Number::I16,
        "ushort" | "uint16" => Number::U16,
        "int" | "int32" => Number::I32,
        "uint" | "uint32" => Number::U32,
        "float" | "float32" => Number::F32,
        "double" | "float64" => Number::F64,
        _ => return None,
    })
}

/// What follows the header: rows of numbers.
struct Body<R> {
    lines: Lines<R>,
    is_text: bool,
    words: std::vec::IntoIter<String>,
    line: Option<u64>,
}

impl<R: BufRead> Body<R> {
    /// In a text, a row is a line; empty lines are passed over.
    fn begin_row(&mut self, element: &Element, row: u64) -> Result<(), FileFault> {
        while self.is_text {
            let Some(text) = self.lines.next_line()? else {
                return Err(FileFault::Missing { place: element.place(row, Some(self.lines.number)), wanted: "line" });
            };
            self.line = Some(self.lines.number);
            if !text.is_empty() {
                self.words = text.split_whitespace().map(str::to_owned).collect::<Vec<_>>().into_iter();
                break;
            }
        }
        Ok(())
    }

    /// The next number; all types of whole numbers are exact.
    fn next(&mut self, kind: Number, place: Place, wanted: &'static str) -> Result<f64, FileFault> {
        if self.is_text {
            return parse(self.words.next().as_deref(), place, wanted);
        }
        Ok(match kind {
            Number::I8 => i8::from_le_bytes(self.bytes(place, wanted)?).into(),
            Number::U8 => u8::from_le_bytes(self.bytes(place, wanted)?).into(),
            Number::I16 => i16::from_le_bytes(self.bytes(place, wanted)?).into(),
            Number::U16 => u16::from_le_bytes(self.bytes(place, wanted)?).into(),
            Number::I32 => i32::from_le_bytes(self.bytes(place, wanted)?).into(),
            Number::U32 => u32::from_le_bytes(self.bytes(place, wanted)?).into(),
            Number::F32 => f32::from_le_bytes(self.bytes(place, wanted)?).into(),
            Number::F64 => f64::from_le_bytes(self.bytes(place, wanted)?),
        })
    }

    fn bytes<const N: usize>(&mut self, place: Place, wanted: &'static str) -> Result<[u8; N], FileFault> {
        let mut bytes = [0; N];
        self.lines.source.read_exact(&mut bytes).map_err(|error| match error.kind() {
            std::io::ErrorKind::UnexpectedEof => FileFault::Missing { place, wanted },
            _ => FileFault::Read(error),
        })?;
        Ok(bytes)
    }

    /// The next whole number from 0.
    fn next_whole(&mut self, kind: Number, place: Place, wanted: &'static str) -> Result<u32, FileFault> {
        let value = self.next(kind, place, wanted)?;
        let is_whole = value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value);
        if is_whole { Ok(value as u32) } else { Err(FileFault::Word { place, word: value.to_string(), wanted }) }
    }

    fn skip(&mut self, property: &Property, place: Place) -> Result<(), FileFault> {
        let count = match property.length {
            Some(length) => self.next_whole(length, place, "length of a list")?,
            None => 1,
        };
        (0..count).try_for_each(|_| self.next(property.value, place, "number").map(drop))
    }
}

fn read_vertex<R: BufRead>(
    body: &mut Body<R>,
    element: &Element,
    row: u64,
    set: &mut LabelledTriangles,
) -> Result<(), FileFault> {
    let place = element.place(row, body.line);
    let (mut position, mut seen, mut pinned) = (DVec3::ZERO, [false; 3], false);
    for property in &element.properties {
        let axis = ["x", "y", "z"].iter().position(|name| *name == property.name);
        match (axis, property.name.as_str(), property.length) {
            (Some(axis), _, None) => {
                position[axis] = body.next(property.value, place, "coordinate")?;
                seen[axis] = true;
            }
            (_, "pinned", None) => pinned = body.next(property.value, place, "pin")? != 0.0,
            _ => body.skip(property, place)?,
        }
    }
    if seen.contains(&false) {
        return Err(FileFault::Missing { place, wanted: "property x, y or z" });
    }
    add_vertex(set, position, pinned, place)
}

fn read_face<R: BufRead>(
    body: &mut Body<R>,
    element: &Element,
    row: u64,
    set: &mut LabelledTriangles,
) -> Result<(), FileFault> {
    let place = element.place(row, body.line);
    let (mut corners, mut kind) = (Vec::new(), Kind::default());
    for property in &element.properties {
        match (property.name.as_str(), property.length) {
            ("vertex_indices" | "vertex_index", Some(length)) => {
                let count = body.next_whole(length, place, "number of corners")? as usize;
                if count > MOST_CORNERS {
                    return Err(FileFault::Corners { place, corners: count });
                }
                corners =
                    (0..count).map(|_| read_corner(body, property.value, place, set)).collect::<Result<_, _>>()?;
            }
            ("back", None) => kind.labels[0] = body.next_whole(property.value, place, "label")?,
            ("front", None) => kind.labels[1] = body.next_whole(property.value, place, "label")?,
            ("ghost", None) => kind.ghost = body.next(property.value, place, "ghost flag")? != 0.0,
            _ => body.skip(property, place)?,
        }
    }
    add_polygon(set, &corners, kind, place)
}

fn read_corner<R: BufRead>(
    body: &mut Body<R>,
    kind: Number,
    place: Place,
    set: &LabelledTriangles,
) -> Result<u32, FileFault> {
    let (value, count) = (body.next(kind, place, "index of a vertex")?, set.positions.len());
    if value.fract() == 0.0 && (0.0..count as f64).contains(&value) {
        return Ok(value as u32);
    }
    Err(FileFault::NoSuchVertex { place, index: value as i64, count, from: 0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::validate;
    use crate::shapes::{disc, double_bubble};
    use proptest::prelude::{any, proptest};

    const HEADER: &str = "comment made for a test\ncomment open OPEN\nelement vertex V\nproperty double x\nproperty float64 y\n\
        property double z\nproperty uchar pinned\nelement face F\nproperty list uchar int vertex_indices\nproperty ushort back\n\
        property int front\nproperty uint8 ghost\nelement edge 1\nproperty int a\nproperty list uchar float b\nend_header\n";

    fn header(set: &LabelledTriangles, format: &str) -> String {
        let open: Vec<String> = set.open.iter().map(u32::to_string).collect();
        let counts =
            HEADER.replace("OPEN", &open.join(" ")).replace("vertex V", &format!("vertex {}", set.positions.len()));
        format!("ply\nformat {format} 1.0\n{}", counts.replace("face F", &format!("face {}", set.triangles.len())))
    }

    fn written_as_text(set: &LabelledTriangles) -> String {
        let mut text = header(set, "ascii");
        for (x, pinned) in set.positions.iter().zip(&set.pinned) {
            text += &format!("{:e} {:e} {:e} {}\n", x.x, x.y, x.z, u8::from(*pinned));
        }
        for (k, [a, b, c]) in set.triangles.iter().enumerate() {
            let [back, front] = set.labels[k];
            text += &format!("3 {a} {b} {c} {back} {front} {}\n", u8::from(set.ghosts[k]));
        }
        text + "7 2 0.5 0.25\n"
    }

    fn written_as_bytes(set: &LabelledTriangles) -> Vec<u8> {
        let mut bytes = header(set, "binary_little_endian").into_bytes();
        for (x, pinned) in set.positions.iter().zip(&set.pinned) {
            x.to_array().iter().for_each(|c| bytes.extend(c.to_le_bytes()));
            bytes.push(u8::from(*pinned));
        }
        for (k, triangle) in set.triangles.iter().enumerate() {
            bytes.push(3);
            triangle.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
            bytes.extend((set.labels[k][0] as u16).to_le_bytes());
            bytes.extend(set.labels[k][1].to_le_bytes());
            bytes.push(u8::from(set.ghosts[k]));
        }
        bytes.extend([7, 0, 0, 0, 1]);
        bytes.extend(0.5f32.to_le_bytes());
        bytes
    }

    fn sets() -> [LabelledTriangles; 2] {
        [double_bubble(DVec3::X, DVec3::ONE, 1.0, 0.7, 0.3), disc(DVec3::ZERO, 1.0, DVec3::Y, 0.3)]
    }

    #[test]
    fn text_and_bytes_give_back_what_was_written() {
        for set in sets() {
            assert_eq!(read_ply(written_as_text(&set).as_bytes()).unwrap(), set);
            assert_eq!(read_ply(written_as_bytes(&set).as_slice()).unwrap(), set);
            assert!(validate(&set).is_ok());
        }
    }

    #[test]
    fn a_file_cut_short_says_where() {
        let bytes = written_as_bytes(&sets()[0]);
        let faces = sets()[0].triangles.len();
        let fault = read_ply(&bytes[..bytes.len() - 10]).unwrap_err().to_string();
        assert_eq!(fault, format!("face {} has no ghost flag: the line or the file ends too early", faces - 1));
        for end in (0..bytes.len() - 1).step_by(7) {
            assert!(read_ply(&bytes[..end]).is_err());
        }
    }

    #[test]
    fn a_header_that_promises_too_much_costs_nothing() {
        let text = "ply\nformat binary_little_endian 1.0\nelement vertex 4294967295\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
        assert!(matches!(read_ply(text.as_bytes()), Err(FileFault::Missing { .. })));
    }

    #[test]
    fn faults_name_face_and_line() {
        let text = written_as_text(&sets()[1]);
        let bad = text.replacen("\n3 0 1 ", "\n3 0 9999 ", 1);
        let message = read_ply(bad.as_bytes()).unwrap_err().to_string();
        assert!(message.starts_with("face 0 (line ") && message.contains("names vertex 9999"), "{message}");
        for (from, to, wanted) in [
            ("ply\n", "play\n", "line 1 of the header: a PLY begins with the word ply"),
            (
                "ascii",
                "binary_big_endian",
                "line 2 of the header: the formats ascii 1.0 and binary_little_endian 1.0 are read",
            ),
            ("property double x", "property half x", "line 6 of the header: a property has a type that is not known"),
            ("property double x\n", "", "property x, y or z"),
        ] {
            let message = read_ply(text.replacen(from, to, 1).as_bytes()).unwrap_err().to_string();
            assert!(message.contains(wanted), "{message}");
        }
    }

    proptest! {
        #[test]
        fn spoilt_bytes_never_make_it_panic(place in any::<usize>(), byte in any::<u8>(), is_text in any::<bool>()) {
            let set = &sets()[1];
            let mut bytes = if is_text { written_as_text(set).into_bytes() } else { written_as_bytes(set) };
            let place = place % bytes.len();
            bytes[place] = byte;
            drop(read_ply(bytes.as_slice()).map(|set| validate(&set)));
        }
    }
}
