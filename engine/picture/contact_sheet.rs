//! One still that shows a whole run: a few frames in a grid, each with its label.
//!
//! ```text
//!   +------+ +------+ +------+
//!   |      | |      | |      |     rows from the top, frames from the left
//!   +------+ +------+ +------+
//!    0 s      0.4 s    0.8 s
//! ```

use super::lettering::{GLYPH, draw_text};
use image::{Rgb, RgbImage, imageops};

/// Most frames on a sheet.
pub const MOST_FRAMES: usize = 12;
/// Largest width of a sheet, pixels.
const WIDTH: u32 = 1600;
/// Space between and around the frames, pixels.
const GAP: u32 = 8;
/// Edge of a font dot, pixels.
const DOT: u32 = 2;
const PAPER: Rgb<u8> = Rgb([18, 19, 22]);
const INK: Rgb<u8> = Rgb([226, 228, 232]);

/// At most [`MOST_FRAMES`] of `0..frames`, evenly spread, the first and the last among them.
#[must_use]
pub fn evenly_chosen(frames: u64) -> Vec<u64> {
    let count = frames.min(MOST_FRAMES as u64);
    match count {
        0 | 1 => (0..count).collect(),
        _ => (0..count).map(|k| (k * (frames - 1) + (count - 1) / 2) / (count - 1)).collect(),
    }
}

/// Frames that are being laid out.
#[derive(Clone, Debug)]
pub struct ContactSheet {
    columns: u32,
    cells: Vec<(RgbImage, String)>,
}

impl ContactSheet {
    /// A sheet for this many frames.
    #[must_use]
    pub fn for_frames(count: usize) -> Self {
        // Three columns look best up to nine frames; a last row with one frame only does not.
        let columns = match count {
            0..=3 => count.max(1),
            4 => 2,
            5..=6 | 9 => 3,
            _ => 4,
        };
        Self { columns: columns as u32, cells: Vec::new() }
    }

    /// Adds a frame, shrunk to its place on the sheet, and the label below it.
    pub fn push(&mut self, frame: &RgbImage, label: impl Into<String>) {
        let place = ((WIDTH - GAP) / self.columns - GAP).min(frame.width()).max(1);
        let height = (u64::from(frame.height()) * u64::from(place) / u64::from(frame.width().max(1))).max(1) as u32;
        let cell = if place == frame.width() { frame.clone() } else { imageops::thumbnail(frame, place, height) };
        self.cells.push((cell, label.into()));
    }

    /// The sheet as one picture; one empty pixel if there are no frames.
    #[must_use]
    pub fn picture(&self) -> RgbImage {
        let largest = |of: fn(&RgbImage) -> u32| self.cells.iter().map(|(cell, _)| of(cell)).max().unwrap_or(0);
        let (width, height) = (largest(RgbImage::width), largest(RgbImage::height));
        if self.cells.is_empty() {
            return RgbImage::from_pixel(1, 1, PAPER);
        }
        let (across, down) = (width + GAP, height + 2 * GAP + GLYPH * DOT);
        let columns = self.columns.min(self.cells.len() as u32);
        let rows = (self.cells.len() as u32).div_ceil(columns);
        let mut sheet = RgbImage::from_pixel(GAP + columns * across, GAP + rows * down, PAPER);
        for (place, (cell, label)) in (0_u32..).zip(&self.cells) {
            let (left, top) = (GAP + place % columns * across, GAP + place / columns * down);
            imageops::replace(&mut sheet, cell, i64::from(left), i64::from(top));
            draw_text(&mut sheet, (left, top + height + GAP / 2), DOT, INK, label);
        }
        sheet
    }
}

#[cfg(test)]
mod tests {
    use super::{ContactSheet, INK, MOST_FRAMES, WIDTH, evenly_chosen};
    use image::{Rgb, RgbImage};

    #[test]
    fn the_first_and_the_last_frame_are_on_the_sheet_and_the_others_evenly_between() {
        assert!(evenly_chosen(0).is_empty());
        assert_eq!(evenly_chosen(1), [0]);
        assert_eq!(evenly_chosen(5), [0, 1, 2, 3, 4]);
        for frames in 12..400 {
            let chosen = evenly_chosen(frames);
            assert!(chosen.len() == MOST_FRAMES && chosen[0] == 0 && chosen[11] == frames - 1);
            let steps: Vec<u64> = chosen.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let (least, most) = (steps.iter().min().unwrap(), steps.iter().max().unwrap());
            assert!(*least > 0 && most - least <= 1, "{chosen:?}");
        }
    }

    #[test]
    fn twelve_frames_are_a_sheet_of_four_by_three_with_a_label_below_each() {
        let mut sheet = ContactSheet::for_frames(12);
        for shade in 0..12 {
            sheet.push(&RgbImage::from_pixel(1280, 720, Rgb([20 * shade as u8, 0, 200])), format!("{shade} s"));
        }
        let picture = sheet.picture();
        assert_eq!(picture.dimensions(), (WIDTH, 8 + 3 * (219 + 16 + 16)));
        for shade in 0..12 {
            let (left, top) = (8 + shade % 4 * 398, 8 + shade / 4 * 251);
            assert_eq!(picture.get_pixel(left + 195, top + 109).0, [20 * shade as u8, 0, 200]);
            let label = image::imageops::crop_imm(&picture, left, top + 219, 390, 24).to_image();
            assert!(label.pixels().filter(|&&pixel| pixel == INK).count() > 20, "{shade}");
        }
    }

    #[test]
    fn small_frames_keep_their_size() {
        let mut sheet = ContactSheet::for_frames(2);
        (0..2).for_each(|_| sheet.push(&RgbImage::new(30, 40), ""));
        assert_eq!(sheet.picture().dimensions(), (8 + 2 * 38, 8 + 40 + 32));
        assert_eq!(ContactSheet::for_frames(0).picture().dimensions(), (1, 1));
    }
}
