//! Who draws and exports frames: the run loop knows when, a [`FrameSink`] knows what.

use bevy_ecs::world::World;

use super::error::FrameError;
use super::folder::RunFolder;

/// Draws or exports frames into a run folder. A closure `|world, frame, folder| ...` is one, too.
///
/// A frame may be drawn twice, when a run is resumed from before it: the file must not depend on what was drawn before.
pub trait FrameSink {
    /// Writes what a frame needs, by [`RunFolder::write`].
    ///
    /// # Errors
    /// When it cannot be drawn or written: the run says that the frame is lost, and stops.
    fn frame(&mut self, world: &mut World, frame: u64, folder: &RunFolder) -> Result<(), FrameError>;

    /// Writes what is made of all frames (an animation, an index), from the files in the folder.
    ///
    /// # Errors
    /// When it cannot be written.
    fn finish(&mut self, folder: &RunFolder) -> Result<(), FrameError> {
        let _ = folder;
        Ok(())
    }
}

impl<F: FnMut(&mut World, u64, &RunFolder) -> Result<(), FrameError>> FrameSink for F {
    fn frame(&mut self, world: &mut World, frame: u64, folder: &RunFolder) -> Result<(), FrameError> {
        self(world, frame, folder)
    }
}

/// Draws nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoFrames;

impl FrameSink for NoFrames {
    fn frame(&mut self, _: &mut World, _: u64, _: &RunFolder) -> Result<(), FrameError> {
        Ok(())
    }
}
