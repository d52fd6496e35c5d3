//! Reads Wavefront OBJ: `v`, `f`, `l`, `g`, and `# open`; all other lines are passed over.

use std::io::BufRead;

use glam::DVec3;

use super::{FileFault, Kind, Lines, Place, add_polygon, add_vertex, finished, open_regions, parse};
use crate::surface::LabelledTriangles;

/// Reads an OBJ; see [`super`] for how it says labels.
///
/// Corners may be `1`, `1/2`, `1//3`, `1/2/3` or count back from the last vertex, `-1`; textures and normals are passed over.
/// A group with another name than two whole numbers leaves the labels as they are.
///
/// # Errors
/// A [`FileFault`] that names the line.
pub fn read_obj(source: impl BufRead) -> Result<LabelledTriangles, FileFault> {
    let mut lines = Lines { source, number: 0 };
    let mut reader = Reader { set: LabelledTriangles::default(), kind: Kind::default(), faces: 0, wires: 0, line: 0 };
    while let Some(line) = lines.next_line()? {
        reader.line = lines.number;
        if let Some(remark) = line.strip_prefix('#') {
            reader.set.open.extend(open_regions(remark));
            continue;
        }
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => reader.add_vertex(words)?,
            Some("f") => reader.add_face(words)?,
            Some("l") => reader.hold_wire(words)?,
            Some("g") => reader.change_group(&words.collect::<Vec<_>>()),
            _ => {}
        }
    }
    finished(reader.set)
}

struct Reader {
    set: LabelledTriangles,
    kind: Kind,
    faces: u64,
    wires: u64,
    line: u64,
}

impl Reader {
    fn place(&self, what: &'static str, row: u64) -> Place {
        Place { what, row, line: Some(self.line) }
    }

    fn add_vertex<'a>(&mut self, mut words: impl Iterator<Item = &'a str>) -> Result<(), FileFault> {
        let place = self.place("vertex", self.set.positions.len() as u64);
        let mut next = || parse::<f64>(words.next(), place, "coordinate");
        let position = DVec3::new(next()?, next()?, next()?);
        add_vertex(&mut self.set, position, false, place)
    }

    fn add_face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Result<(), FileFault> {
        let place = self.place("face", self.faces);
        self.faces += 1;
        let corners: Vec<u32> = words.map(|word| self.corner(word, place)).collect::<Result<_, _>>()?;
        add_polygon(&mut self.set, &corners, self.kind, place)
    }

    fn hold_wire<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Result<(), FileFault> {
        let place = self.place("wire", self.wires);
        self.wires += 1;
        for word in words {
            let vertex = self.corner(word, place)?;
            self.set.pinned[vertex as usize] = true;
        }
        Ok(())
    }

    fn change_group(&mut self, words: &[&str]) {
        let (numbers, ghost) = match words {
            [back, front] => ([back, front], false),
            [back, front, "ghost"] => ([back, front], true),
            _ => return,
        };
        if let [Ok(back), Ok(front)] = numbers.map(|word| word.parse()) {
            self.kind = Kind { labels: [back, front], ghost };
        }
    }

    /// Row of a corner: from 1, or back from the last vertex.
    fn corner(&self, word: &str, place: Place) -> Result<u32, FileFault> {
        let index: i64 = parse(word.split('/').next(), place, "index of a vertex")?;
        let count = self.set.positions.len();
        let row = if index < 0 { index.checked_add(count as i64) } else { index.checked_sub(1) };
        let row = row.filter(|row| (0..count as i64).contains(row));
        row.map(|row| row as u32).ok_or(FileFault::NoSuchVertex { place, index, count, from: 1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::validate;
    use proptest::prelude::{any, proptest};

    const CUBE: &str = "# a cube of quadrangles\n\
        v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\no box\n\
        f 4 3 2 1\nf 5/1 6/2/3 7//4 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf -5 -8 -4 -1\n";

    fn read(text: &str) -> Result<LabelledTriangles, FileFault> {
        read_obj(text.as_bytes())
    }

    #[test]
    fn a_closed_mesh_without_labels_is_one_bubble() {
        let surface = validate(&read(CUBE).unwrap()).unwrap();
        assert!((surface.volumes()[1] - 1.0).abs() < 1e-15);
        assert_eq!(surface.mesh.face_count(), 12);
    }

    #[test]
    fn groups_give_labels_ghosts_and_wires_hold() {
        let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 -1\n# open 1\nl 1 2 3 1\ng 1 0\nf 1 2 3\ng 0 1 ghost\nf 1 2 4\nf 2 3 4\nf 3 1 4\ng rest\n";
        let set = read(text).unwrap();
        assert_eq!((set.ghosts.as_slice(), set.open.as_slice()), (&[false, true, true, true][..], &[1][..]));
        assert_eq!(set.pinned, [true, true, true, false]);
        assert_eq!(validate(&set).unwrap().film_area(), 0.5);
    }

    #[test]
    fn one_bad_index_among_a_million_faces_is_named_with_face_and_line() {
        let mut text = String::from("v 0 0 0\nv 1 0 0\nv 0 1 0\n");
        (0..1_000_000).for_each(|_| text.push_str("f 1 2 3\n"));
        text.push_str("f 1 2 9\n");
        let message = read(&text).unwrap_err().to_string();
        assert_eq!(
            message,
            "face 1000000 (line 1000004) names vertex 9, but 3 vertices come before it, counted from 1"
        );
    }

    #[test]
    fn faults_name_their_line() {
        for (text, wanted) in [
            ("v 0 0 zero\n", "vertex 0 (line 1): \"zero\" is no coordinate"),
            ("v 0 0\n", "vertex 0 (line 1) has no coordinate: the line or the file ends too early"),
            ("\nv 0 nan 0\n", "vertex 0 (line 2) lies at no finite place: [0, NaN, 0]"),
            ("v 0 0 0\nf 1 1\n", "face 0 (line 2) has 2 corners: from 3 to 256 can be cut into triangles"),
            ("v 0 0 0\nf 0 1 1\n", "face 0 (line 2) names vertex 0, but 1 vertices come before it, counted from 1"),
            ("v 0 0 0\nf 1 1 -2\n", "face 0 (line 2) names vertex -2, but 1 vertices come before it, counted from 1"),
            ("v 0 0 0\nf 1 1 x\n", "face 0 (line 2): \"x\" is no index of a vertex"),
            ("# nothing\n", "the file has no faces"),
        ] {
            assert_eq!(read(text).unwrap_err().to_string(), wanted);
        }
        let bent = read("v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\nf 1 2 3 4\n").unwrap_err();
        assert!(matches!(bent, FileFault::Bent { corners: 4, .. }), "{bent}");
        let endless = format!("v 0 0 0\nf {}", "1 ".repeat(100_000));
        assert!(matches!(read(&endless), Err(FileFault::LongLine { line: 2 })));
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400), words in "([vflg#] [-0-9. /a-z]{0,12}\n){0,30}") {
            drop(read_obj(bytes.as_slice()));
            drop(read_obj(words.as_bytes()));
        }
    }
}
