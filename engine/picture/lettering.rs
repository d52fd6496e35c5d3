//! Short texts in a picture, in the public-domain 8 by 8 dot font of the crate `font8x8`.

use font8x8::legacy::{BASIC_LEGACY, GREEK_LEGACY, LATIN_LEGACY};
use image::{Rgb, RgbImage};

/// Edge of a letter, dots.
pub(super) const GLYPH: u32 = 8;

/// Writes a text with its upper left corner at `corner`, pixels; `scale` is the edge of a dot, pixels.
///
/// Letters the font lacks are shown as `?`; what lies outside the picture is cut off.
pub(super) fn draw_text(picture: &mut RgbImage, corner: (u32, u32), scale: u32, ink: Rgb<u8>, text: &str) {
    for (place, letter) in (0_u32..).zip(text.chars()) {
        let left = corner.0 + place * GLYPH * scale;
        for (row, dots) in (0_u32..).zip(glyph(letter)) {
            for column in (0..GLYPH).filter(|column| dots >> column & 1 == 1) {
                fill_dot(picture, (left + column * scale, corner.1 + row * scale), scale, ink);
            }
        }
    }
}

fn fill_dot(picture: &mut RgbImage, corner: (u32, u32), scale: u32, ink: Rgb<u8>) {
    for (x, y) in (0..scale * scale).map(|dot| (corner.0 + dot % scale, corner.1 + dot / scale)) {
        if let Some(pixel) = picture.get_pixel_mut_checked(x, y) {
            *pixel = ink;
        }
    }
}

/// Rows of a letter, top first; the lowest bit is the leftmost dot.
///
/// The plain tables are used, because the font's lookup by letter confuses `²` and `³`.
fn glyph(letter: char) -> [u8; 8] {
    let letter = if letter == '\u{2212}' { '-' } else { letter };
    [(' ', &BASIC_LEGACY[32..]), ('\u{a0}', &LATIN_LEGACY[..]), ('\u{390}', &GREEK_LEGACY[..])]
        .into_iter()
        .find_map(|(first, glyphs)| glyphs.get((letter as usize).checked_sub(first as usize)?))
        .copied()
        .unwrap_or(BASIC_LEGACY['?' as usize])
}

#[cfg(test)]
mod tests {
    use super::{draw_text, glyph};
    use image::{Rgb, RgbImage};

    #[test]
    fn units_have_letters() {
        for letter in "mN/kgsPaµμ²³°".chars() {
            assert!(glyph(letter) != [0; 8] && glyph(letter) != glyph('?'), "{letter}");
        }
    }

    #[test]
    fn text_beyond_the_edge_is_cut_off() {
        let mut picture = RgbImage::new(20, 10);
        draw_text(&mut picture, (15, 5), 3, Rgb([255; 3]), "long text");
        assert!(picture.pixels().any(|p| p.0 == [255; 3]));
    }
}
