//! `froth scenes`.

use super::{DONE, say};
use crate::gallery::GALLERY;

/// Name and summary of every built-in scene.
pub(super) fn list() -> u8 {
    let width = GALLERY.iter().map(|scene| scene.name.len()).max().unwrap_or(0);
    for scene in GALLERY {
        say(format!("{:width$}  {}", scene.name, scene.summary));
    }
    DONE
}
