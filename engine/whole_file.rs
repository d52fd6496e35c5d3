//! Whole files only: written under a temporary name, flushed to the disk, renamed.
//!
//! Whoever is killed in between leaves the old file, or none, and a hidden `.part` file that the next write replaces.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes a file through `write`. When anything fails, a file that was there before stays as it was.
///
/// # Errors
/// When the folder cannot be written, the disk is full, or `write` fails.
pub fn write_whole(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let part = part_name(path);
    let written = write_part(&part, write).and_then(|()| fs::rename(&part, path));
    if written.is_err() {
        // The cause matters to the user, not whether the rubble could be cleared.
        let _ = fs::remove_file(&part);
    }
    written?;
    sync_folder(path)
}

fn write_part(part: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(part)?);
    write(&mut file)?;
    file.flush()?;
    file.get_ref().sync_all()
}

/// Makes the rename last: it is an entry of the folder.
fn sync_folder(path: &Path) -> io::Result<()> {
    match path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        Some(folder) => File::open(folder)?.sync_all(),
        None => Ok(()),
    }
}

fn part_name(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.part"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_rubble() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("numbers.txt");
        write_whole(&path, |file| file.write_all(b"old")).unwrap();
        let failure = write_whole(&path, |file| {
            file.write_all(b"ne")?;
            Err(io::Error::other("no more"))
        });
        assert_eq!(failure.unwrap_err().to_string(), "no more");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
