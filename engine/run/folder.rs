//! The run folder: where its files are, who may write, and how.
//!
//! ```text
//! manifest.json     what ran, how, and how it ended          observables.csv   one line per step
//! scene.ron         copy of the scene                        run.log           what happened, with wall times
//! timings.csv       wall time per stage and step, ms       events.csv        one line per change of topology, of meshes
//! frames/000000.png ...                                      checkpoints/step-00000120-at-1.200000s.ckpt
//! animation.png     all frames, at the end of the run        contact_sheet.png twelve of them on one sheet
//! ```

use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::error::RunError;
use crate::whole_file::write_whole;

/// File names in a run folder.
pub(super) const MANIFEST: &str = "manifest.json";
pub(super) const SCENE: &str = "scene.ron";
/// Folder of copies of the scene's mesh files.
pub(super) const MESHES: &str = "meshes";
pub(super) const OBSERVABLES: &str = "observables.csv";
pub(super) const TIMINGS: &str = "timings.csv";
pub(super) const EVENTS: &str = "events.csv";
const LOG: &str = "run.log";
const CHECKPOINTS: &str = "checkpoints";
const FRAMES: &str = "frames";
/// Checkpoints that are kept: the last one, and one more in case that one is damaged.
const KEPT: usize = 2;

/// A run folder that this process writes.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    /// Locked: no other process writes while this one lives.
    log: File,
    opened: Instant,
}

impl RunFolder {
    /// Makes the folder; one that exists must be empty.
    ///
    /// # Errors
    /// When it cannot be made or written, or is not empty.
    pub fn create(path: &Path) -> Result<Self, RunError> {
        let failed = |cause| RunError::Folder { path: path.to_owned(), cause };
        fs::create_dir_all(path).map_err(failed)?;
        if fs::read_dir(path).map_err(failed)?.next().is_some() {
            return Err(RunError::Occupied { path: path.to_owned() });
        }
        Self::open(path)
    }

    /// Makes `parent/stem-1`, or the next number that is free.
    ///
    /// # Errors
    /// When it cannot be made or written.
    pub fn create_numbered(parent: &Path, stem: &str) -> Result<Self, RunError> {
        fs::create_dir_all(parent).map_err(|cause| RunError::Folder { path: parent.to_owned(), cause })?;
        let mut number = 1_u64;
        loop {
            let path = parent.join(format!("{stem}-{number}"));
            // Whoever makes the folder owns it: two runs that start at once get two numbers.
            match fs::create_dir(&path) {
                Ok(()) => return Self::open(&path),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
                Err(cause) => return Err(RunError::Folder { path, cause }),
            }
        }
    }

    /// Opens a folder to write to it.
    ///
    /// # Errors
    /// When it cannot be written, or another process does.
    pub(super) fn open(path: &Path) -> Result<Self, RunError> {
        let failed = |cause| RunError::Folder { path: path.to_owned(), cause };
        for folder in [FRAMES, CHECKPOINTS] {
            fs::create_dir_all(path.join(folder)).map_err(failed)?;
        }
        let log = File::options().append(true).create(true).open(path.join(LOG)).map_err(failed)?;
        // A file system without locks is no reason not to run.
        if let Err(TryLockError::WouldBlock) = log.try_lock() {
            return Err(RunError::InUse { path: path.to_owned() });
        }
        Ok(Self { path: path.to_owned(), log, opened: Instant::now() })
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The picture of a frame, within the folder.
    #[must_use]
    pub fn frame_file(frame: u64) -> PathBuf {
        Path::new(FRAMES).join(format!("{frame:06}.png"))
    }

    /// Writes a file within the folder, whole or not at all.
    ///
    /// # Errors
    /// When the folder cannot be written or the disk is full.
    pub fn write(&self, file: impl AsRef<Path>, bytes: &[u8]) -> io::Result<()> {
        let path = self.path.join(file);
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent)?;
        }
        write_whole(&path, |file| file.write_all(bytes))
    }

    /// Adds a line to the log. A log that cannot be written is no reason to stop.
    pub fn log(&self, line: &str) {
        let line = format!("[{:10.3} s] {line}\n", self.opened.elapsed().as_secs_f64());
        let _ = (&self.log).write_all(line.as_bytes());
    }

    /// Wall time since the folder was opened.
    pub(super) fn age(&self) -> Duration {
        self.opened.elapsed()
    }

    /// Where the checkpoint after a step goes.
    #[must_use]
    pub fn checkpoint_path(&self, step: u64, time: f64) -> PathBuf {
        self.path.join(CHECKPOINTS).join(format!("step-{step:08}-at-{time:.6}s.ckpt"))
    }

    /// The checkpoints, newest first.
    #[must_use]
    pub fn checkpoints(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.path.join(CHECKPOINTS)).into_iter().flatten().flatten();
        let mut found: Vec<(u64, PathBuf)> =
            entries.filter_map(|entry| Some((step_of(&entry.file_name().to_string_lossy())?, entry.path()))).collect();
        found.sort_unstable_by(|a, b| b.cmp(a));
        found.into_iter().map(|(_, path)| path).collect()
    }

    /// Removes all but the newest checkpoints.
    pub(super) fn prune_checkpoints(&self) {
        for old in self.checkpoints().into_iter().skip(KEPT) {
            if let Err(error) = fs::remove_file(&old) {
                self.log(&format!("the old checkpoint {} stays: {error}", old.display()));
            }
        }
    }
}

/// The step in the name of a checkpoint; `None` for other files.
fn step_of(name: &str) -> Option<u64> {
    name.strip_suffix(".ckpt")?.strip_prefix("step-")?.split('-').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbered_folders_never_meet() {
        let parent = tempfile::tempdir().unwrap();
        let first = RunFolder::create_numbered(parent.path(), "bubble").unwrap();
        let second = RunFolder::create_numbered(parent.path(), "bubble").unwrap();
        assert!(first.path().ends_with("bubble-1") && second.path().ends_with("bubble-2"));
        assert!(matches!(RunFolder::create(first.path()), Err(RunError::Occupied { .. })));
        assert!(matches!(RunFolder::open(first.path()), Err(RunError::InUse { .. })));
    }

    #[test]
    fn the_two_newest_checkpoints_are_kept() {
        let parent = tempfile::tempdir().unwrap();
        let folder = RunFolder::create(&parent.path().join("run")).unwrap();
        for step in [9, 10, 100_000_000] {
            fs::write(folder.checkpoint_path(step, 0.5), b"").unwrap();
        }
        fs::write(folder.path().join("checkpoints/.step-00000011-at-1.000000s.ckpt.part"), b"").unwrap();
        folder.prune_checkpoints();
        assert_eq!(folder.checkpoints(), [folder.checkpoint_path(100_000_000, 0.5), folder.checkpoint_path(10, 0.5)]);
    }
}
