//! From a path to text: the file is untrusted, so its length is bounded and each way to be no text has its own error.

use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use froth_components::quantity::nearest;

use super::error::SceneError;

/// Longest scene file, bytes: room for some ten thousand entities, and read within seconds whatever it holds.
pub const LONGEST_FILE: u64 = 4 << 20;

/// Most names of a folder that are searched for one like a missing file.
const MOST_NEIGHBOURS: usize = 10_000;

/// Why the bytes of a file cannot be had.
pub(super) enum FileFault {
    /// What the system said.
    Cause(io::Error),
    /// It is a folder.
    Directory,
    /// It has so many bytes, or one more than the limit where it does not say.
    TooLong(u64),
}

/// All bytes of a plain file, unless they are more than `limit`.
pub(super) fn read_whole(path: &Path, limit: u64) -> Result<Vec<u8>, FileFault> {
    let about = fs::metadata(path).map_err(FileFault::Cause)?;
    if about.is_dir() {
        return Err(FileFault::Directory);
    }
    // A pipe or a device may never end, or never begin.
    if !about.is_file() {
        let cause = io::Error::new(io::ErrorKind::InvalidInput, "it is a pipe, a device or the like");
        return Err(FileFault::Cause(cause));
    }
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(FileFault::Cause)?;
    file.take(limit + 1).read_to_end(&mut bytes).map_err(FileFault::Cause)?;
    // The length read may differ from the length announced: the file may grow.
    let length = about.len().max(bytes.len() as u64);
    if length > limit { Err(FileFault::TooLong(length)) } else { Ok(bytes) }
}

/// The bytes of a scene file.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, SceneError> {
    read_whole(path, LONGEST_FILE).map_err(|fault| match fault {
        FileFault::Cause(cause) if cause.kind() == io::ErrorKind::NotFound => {
            SceneError::Missing { path: path.to_owned(), nearest: nearest_file(path) }
        }
        FileFault::Cause(cause) => SceneError::Unreadable { path: path.to_owned(), cause },
        FileFault::Directory => SceneError::Directory { path: path.to_owned() },
        FileFault::TooLong(bytes) => {
            SceneError::TooLong { name: path.display().to_string(), bytes, limit: LONGEST_FILE }
        }
    })
}

/// The text of a scene file. A byte order mark is dropped; a zero byte means a binary file.
pub(super) fn text(name: &str, bytes: &[u8]) -> Result<String, SceneError> {
    let not_text = |offset| SceneError::NotText { name: name.to_owned(), offset };
    if let Some(zero) = bytes.iter().position(|byte| *byte == 0) {
        return Err(not_text(zero));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| not_text(error.valid_up_to()))?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text).to_owned())
}

/// A file in the same folder whose name is nearly that of a missing one.
pub(super) fn nearest_file(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = fs::read_dir(folder).ok()?.take(MOST_NEIGHBOURS).flatten();
    let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort_unstable();
    let near = nearest(name, names.iter().map(String::as_str))?;
    Some(path.with_file_name(near).display().to_string())
}
