//! One moving picture per run: an animated PNG, written frame by frame.
//!
//! An animated PNG is lossless: a GIF has 256 colours per frame, and the soft gradients of a film show that as grain
//! or bands. Every browser shows both. Frames are shrunk by area average to a largest edge, to keep files small.
//! Layout (PNG specification, third edition, §11.3.4): signature, `IHDR`, `acTL` (number of frames, repeats), then per
//! frame `fcTL` (size, delay) and its data: `IDAT` for the first frame, `fdAT` for the rest; `IEND`.
//! The number of frames is written again after each frame, so a stopped run needs to know no length beforehand.

use super::error::PictureError;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ImageEncoder, RgbImage, imageops};
use serde::Deserialize;
use std::io::{Seek, SeekFrom, Write};

const SIGNATURE: [u8; 8] = [0x89, b'P', b'N', b'G', b'\r', b'\n', 0x1a, b'\n'];
/// Place of the `acTL` chunk: after the signature and `IHDR`.
const CONTROL_AT: u64 = 33;

/// Choices for an animation.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AnimationSettings {
    /// Frames shown per second, 1 to 1000.
    pub frames_per_second: u16,
    /// Longest edge of a frame, pixels; larger pictures are shrunk, smaller ones kept.
    pub largest_edge: u32,
    /// How often the animation plays; 0 for without end.
    pub plays: u32,
}

impl Default for AnimationSettings {
    fn default() -> Self {
        Self { frames_per_second: 25, largest_edge: 384, plays: 0 }
    }
}

/// An animated PNG that is being written.
#[derive(Debug)]
pub struct Animation<W: Write + Seek> {
    out: W,
    settings: AnimationSettings,
    /// Width and height of the pictures as given, pixels.
    size: Option<(u32, u32)>,
    frames: u32,
    /// Number of the next `fcTL` or `fdAT` chunk.
    sequence: u32,
}

impl<W: Write + Seek> Animation<W> {
    /// Starts an animation at the beginning of `out`.
    ///
    /// # Errors
    /// [`PictureError::OutOfRange`] for a rate or size of 0.
    pub fn new(out: W, settings: AnimationSettings) -> Result<Self, PictureError> {
        for (name, value) in [
            ("the animation's frames per second", u32::from(settings.frames_per_second)),
            ("the animation's largest edge", settings.largest_edge),
        ] {
            if value == 0 {
                return Err(PictureError::OutOfRange { name, value: 0.0, allowed: "at least 1" });
            }
        }
        Ok(Self { out, settings, size: None, frames: 0, sequence: 0 })
    }

    /// Number of frames so far.
    #[must_use]
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Adds a picture of the same size as the first.
    ///
    /// # Errors
    /// [`PictureError`] if the size differs or the writer fails.
    pub fn push(&mut self, picture: &RgbImage) -> Result<(), PictureError> {
        let expected = *self.size.get_or_insert(picture.dimensions());
        if picture.dimensions() != expected {
            return Err(PictureError::FrameSize { expected, found: picture.dimensions() });
        }
        let frame = shrink(picture, self.settings.largest_edge);
        let encoded = encode(&frame)?;
        if self.frames == 0 {
            self.out.write_all(&SIGNATURE)?;
            for (kind, data) in chunks(&encoded).filter(|(kind, _)| *kind == b"IHDR") {
                self.chunk(kind, data)?;
            }
            self.chunk(b"acTL", &self.control())?;
        }
        self.frame_control(frame.dimensions())?;
        for (_, data) in chunks(&encoded).filter(|(kind, _)| *kind == b"IDAT") {
            self.frame_data(data)?;
        }
        self.frames += 1;
        self.rewrite_control()
    }

    /// Closes the file and hands the writer back.
    ///
    /// # Errors
    /// [`PictureError::NoFrames`] if nothing was pushed; [`PictureError::Write`] if the writer fails.
    pub fn finish(mut self) -> Result<W, PictureError> {
        if self.frames == 0 {
            return Err(PictureError::NoFrames);
        }
        self.chunk(b"IEND", &[])?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn control(&self) -> [u8; 8] {
        concat(self.frames.to_be_bytes(), self.settings.plays.to_be_bytes())
    }

    fn rewrite_control(&mut self) -> Result<(), PictureError> {
        self.out.seek(SeekFrom::Start(CONTROL_AT))?;
        self.chunk(b"acTL", &self.control())?;
        self.out.seek(SeekFrom::End(0))?;
        Ok(())
    }

    fn frame_control(&mut self, (width, height): (u32, u32)) -> Result<(), PictureError> {
        let mut data = Vec::with_capacity(26);
        for number in [self.take_sequence(), width, height, 0, 0] {
            data.extend(number.to_be_bytes());
        }
        data.extend(1_u16.to_be_bytes());
        data.extend(self.settings.frames_per_second.to_be_bytes());
        data.extend([0, 0]); // dispose: leave; blend: replace
        self.chunk(b"fcTL", &data)
    }

    fn frame_data(&mut self, data: &[u8]) -> Result<(), PictureError> {
        if self.frames == 0 {
            return self.chunk(b"IDAT", data);
        }
        let numbered = [&self.take_sequence().to_be_bytes()[..], data].concat();
        self.chunk(b"fdAT", &numbered)
    }

    fn take_sequence(&mut self) -> u32 {
        self.sequence += 1;
        self.sequence - 1
    }

    fn chunk(&mut self, kind: &[u8; 4], data: &[u8]) -> Result<(), PictureError> {
        let mut sum = crc32fast::Hasher::new();
        sum.update(kind);
        sum.update(data);
        self.out.write_all(&(data.len() as u32).to_be_bytes())?;
        self.out.write_all(kind)?;
        self.out.write_all(data)?;
        self.out.write_all(&sum.finalize().to_be_bytes())?;
        Ok(())
    }
}

fn concat(first: [u8; 4], second: [u8; 4]) -> [u8; 8] {
    let [a, b, c, d] = first;
    let [e, f, g, h] = second;
    [a, b, c, d, e, f, g, h]
}

/// A copy whose longer edge is at most `largest_edge` pixels, each pixel an area average.
fn shrink(picture: &RgbImage, largest_edge: u32) -> RgbImage {
    let (width, height) = picture.dimensions();
    let longer = width.max(height);
    if longer <= largest_edge {
        return picture.clone();
    }
    let scaled = |edge: u32| ((u64::from(edge) * u64::from(largest_edge) / u64::from(longer)) as u32).max(1);
    imageops::thumbnail(picture, scaled(width), scaled(height))
}

fn encode(frame: &RgbImage) -> Result<Vec<u8>, PictureError> {
    let mut encoded = Vec::new();
    PngEncoder::new_with_quality(&mut encoded, CompressionType::Default, FilterType::Adaptive).write_image(
        frame.as_raw(),
        frame.width(),
        frame.height(),
        image::ExtendedColorType::Rgb8,
    )?;
    Ok(encoded)
}

/// The chunks of a PNG file in memory: kind and data.
fn chunks(file: &[u8]) -> impl Iterator<Item = (&[u8; 4], &[u8])> {
    let mut rest = &file[SIGNATURE.len()..];
    std::iter::from_fn(move || {
        let (length, after) = rest.split_first_chunk::<4>()?;
        let (kind, after) = after.split_first_chunk::<4>()?;
        let (data, after) = after.split_at_checked(u32::from_be_bytes(*length) as usize)?;
        rest = after.get(4..)?;
        Some((kind, data))
    })
}

#[cfg(test)]
mod tests {
    use super::{Animation, AnimationSettings};
    use crate::picture::error::PictureError;
    use image::codecs::png::PngDecoder;
    use image::{AnimationDecoder, Rgb, RgbImage};
    use std::io::Cursor;

    fn frame(shade: u8) -> RgbImage {
        RgbImage::from_fn(60, 40, |x, y| Rgb([x as u8 * 4, y as u8 * 6, shade]))
    }

    #[test]
    fn a_foreign_reader_finds_every_frame_as_it_was_given() {
        let mut animation = Animation::new(Cursor::new(Vec::new()), AnimationSettings::default()).unwrap();
        let frames = [frame(0), frame(90), frame(255)];
        frames.iter().for_each(|f| animation.push(f).unwrap());
        let file = animation.finish().unwrap().into_inner();
        let decoder = PngDecoder::new(Cursor::new(file)).unwrap().apng().unwrap();
        let read: Vec<_> = decoder.into_frames().collect_frames().unwrap();
        assert_eq!(read.len(), 3);
        for (read, given) in read.iter().zip(&frames) {
            assert_eq!(read.delay().numer_denom_ms(), (40, 1));
            assert!(read.buffer().pixels().zip(given.pixels()).all(|(a, b)| a.0[..3] == b.0));
        }
    }

    #[test]
    fn large_pictures_are_shrunk_and_keep_their_shape() {
        let settings = AnimationSettings { largest_edge: 30, ..AnimationSettings::default() };
        let mut animation = Animation::new(Cursor::new(Vec::new()), settings).unwrap();
        animation.push(&frame(7)).unwrap();
        let file = animation.finish().unwrap().into_inner();
        assert_eq!(image::load_from_memory(&file).unwrap().to_rgb8().dimensions(), (30, 20));
    }

    #[test]
    fn a_frame_of_another_size_is_refused() {
        let mut animation = Animation::new(Cursor::new(Vec::new()), AnimationSettings::default()).unwrap();
        animation.push(&frame(7)).unwrap();
        let error = animation.push(&RgbImage::new(3, 3));
        assert!(matches!(error, Err(PictureError::FrameSize { expected: (60, 40), found: (3, 3) })));
    }

    #[test]
    fn an_animation_without_frames_is_an_error() {
        let animation = Animation::new(Cursor::new(Vec::new()), AnimationSettings::default()).unwrap();
        assert!(matches!(animation.finish(), Err(PictureError::NoFrames)));
    }
}
