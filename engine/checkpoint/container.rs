//! The file format of a checkpoint: named sections with a checksum.
//!
//! ```text
//! "FROTH\r\n\x1a"   8 bytes   magic; shows damage by text-mode transfer
//! version           u32       of this layout
//! sections          u32       how many follow
//!   name length     u32
//!   name            UTF-8
//!   length          u64
//!   bytes
//! checksum          u64       xxh3 of everything before
//! "FROTHEND"        8 bytes   shows truncation
//! ```
//! Integers are little-endian.

use std::collections::HashMap;
use std::io::{self, Write};
use std::ops::Range;
use std::path::Path;

use xxhash_rust::xxh3::{Xxh3, xxh3_64};

use super::error::CheckpointError;

const MAGIC: &[u8; 8] = b"FROTH\r\n\x1a";
const END: &[u8; 8] = b"FROTHEND";
/// Version of the layout.
pub(super) const FORMAT: u32 = 1;
/// Checksum and end mark.
const FOOTER: usize = 16;

/// Writes sections one by one, so that only one of them is in memory.
pub(super) struct Writer<W> {
    out: W,
    hash: Xxh3,
}

impl<W: Write> Writer<W> {
    pub(super) fn begin(out: W, sections: u32) -> io::Result<Self> {
        let mut writer = Self { out, hash: Xxh3::new() };
        writer.put(MAGIC)?;
        writer.put(&FORMAT.to_le_bytes())?;
        writer.put(&sections.to_le_bytes())?;
        Ok(writer)
    }

    pub(super) fn section(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        self.put(&(name.len() as u32).to_le_bytes())?;
        self.put(name.as_bytes())?;
        self.put(&(bytes.len() as u64).to_le_bytes())?;
        self.put(bytes)
    }

    pub(super) fn end(mut self) -> io::Result<()> {
        let checksum = self.hash.digest();
        self.put(&checksum.to_le_bytes())?;
        self.put(END)
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hash.update(bytes);
        self.out.write_all(bytes)
    }
}

/// A checkpoint file in memory, whole and undamaged.
pub(super) struct Container {
    bytes: Vec<u8>,
    sections: HashMap<String, Range<usize>>,
}

impl Container {
    /// Checks magic, version, end mark and checksum, in this order, and finds the sections.
    pub(super) fn read(path: &Path, bytes: Vec<u8>) -> Result<Self, CheckpointError> {
        let path = || path.to_owned();
        if !bytes.starts_with(MAGIC) {
            return Err(CheckpointError::NotACheckpoint { path: path() });
        }
        let truncated = || CheckpointError::Truncated { path: path(), bytes: bytes.len() as u64 };
        let mut cursor = Cursor { bytes: &bytes, at: MAGIC.len() };
        let version = cursor.u32().ok_or_else(truncated)?;
        if version != FORMAT {
            return Err(CheckpointError::Format { path: path(), found: version, known: FORMAT });
        }
        let body = bytes.len().checked_sub(FOOTER).filter(|_| bytes.ends_with(END)).ok_or_else(truncated)?;
        let checksum = (Cursor { bytes: &bytes, at: body }).u64().ok_or_else(truncated)?;
        let found = xxh3_64(&bytes[..body]);
        if found != checksum {
            return Err(CheckpointError::Damaged { path: path(), expected: checksum, found });
        }
        let sections = cursor.sections(body).ok_or_else(truncated)?;
        Ok(Self { bytes, sections })
    }

    pub(super) fn section(&self, name: &str) -> Option<&[u8]> {
        self.sections.get(name).map(|range| &self.bytes[range.clone()])
    }
}

struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let piece = self.bytes.get(self.at..self.at.checked_add(length)?)?;
        self.at += length;
        Some(piece)
    }

    fn u32(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.take(4)?.try_into().ok()?))
    }

    fn u64(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(self.take(8)?.try_into().ok()?))
    }

    /// The sections up to `end`; `None` if they do not end there.
    fn sections(&mut self, end: usize) -> Option<HashMap<String, Range<usize>>> {
        let mut sections = HashMap::new();
        for _ in 0..self.u32()? {
            let name_length = self.u32()? as usize;
            let name = String::from_utf8(self.take(name_length)?.to_vec()).ok()?;
            let length = usize::try_from(self.u64()?).ok()?;
            let start = self.at;
            self.take(length)?;
            sections.insert(name, start..start + length);
        }
        (self.at == end).then_some(sections)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sample() -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut writer = Writer::begin(&mut bytes, 2).unwrap();
        writer.section("column/eulerian/position", &[1, 2, 3]).unwrap();
        writer.section("state/clock", b"(time:0.1)").unwrap();
        writer.end().unwrap();
        bytes
    }

    fn read(bytes: Vec<u8>) -> Result<Container, CheckpointError> {
        Container::read(Path::new("a.ckpt"), bytes)
    }

    #[test]
    fn sections_are_read_back() {
        let container = read(sample()).unwrap();
        assert_eq!(container.section("column/eulerian/position"), Some(&[1, 2, 3][..]));
        assert_eq!(container.section("state/clock"), Some(&b"(time:0.1)"[..]));
        assert_eq!(container.section("state/seed"), None);
    }

    #[test]
    fn another_file_and_another_version_are_told_apart() {
        assert!(matches!(read(b"Scene(title".to_vec()), Err(CheckpointError::NotACheckpoint { .. })));
        let mut newer = sample();
        newer[8] = 2;
        assert!(matches!(read(newer), Err(CheckpointError::Format { found: 2, .. })));
    }

    proptest! {
        #[test]
        fn any_flipped_bit_is_seen(at in 0..sample().len(), bit in 0..8_u32) {
            let mut bytes = sample();
            bytes[at] ^= 1 << bit;
            prop_assert!(read(bytes).is_err());
        }

        #[test]
        fn any_missing_end_is_seen(length in 0..sample().len()) {
            prop_assert!(read(sample()[..length].to_vec()).is_err());
        }

        #[test]
        fn no_bytes_panic(tail in prop::collection::vec(any::<u8>(), 0..200)) {
            let mut bytes = sample()[..16].to_vec();
            bytes.extend(tail);
            let checksum = xxh3_64(&bytes);
            bytes.extend(checksum.to_le_bytes());
            bytes.extend(END);
            let _ = read(bytes);
        }
    }
}
