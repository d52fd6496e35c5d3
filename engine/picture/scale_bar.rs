//! The bar that says which colour means which value.
//!
//! ```text
//!   thickness     <- quantity
//!   nm            <- unit
//!   ##-- 800
//!   ##
//!   ##-- 600      <- ticks at 1, 2 or 5 times a power of ten
//!   ##
//!   ##-- 437      <- the ends of the range, where no tick is near
//! ```

use super::colour::to_bytes;
use super::colour_map::ColourMap;
use super::lettering::{GLYPH, draw_text};
use image::{Rgb, RgbImage};

/// Ticks wanted, about.
const TICKS: f64 = 5.0;
const INK: Rgb<u8> = Rgb([226, 228, 232]);

/// A colour map's legend.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaleBar {
    /// Which colours.
    pub colours: ColourMap,
    /// Name of the quantity.
    pub quantity: String,
    /// Unit of the shown numbers.
    pub unit: String,
    /// Values at the lower and the upper end, in the shown unit.
    pub range: (f64, f64),
}

impl ScaleBar {
    /// Width that the bar and its labels need in a picture of this size, pixels; 0 if there is no room for them.
    #[must_use]
    pub fn width_for(&self, width: u32, height: u32) -> u32 {
        let letter = GLYPH * text_scale(height);
        let longest = self.labels().into_iter().map(|(_, label)| label.chars().count() as u32 + 4);
        let titles = [&self.quantity, &self.unit].map(|title| title.chars().count() as u32 + 1);
        let needed = letter * longest.chain(titles).max().unwrap_or(0);
        if 2 * needed > width || 16 * letter > height { 0 } else { needed }
    }

    /// Draws the bar into the rightmost `width` pixels of a picture.
    pub fn draw(&self, picture: &mut RgbImage, width: u32) {
        let scale = text_scale(picture.height());
        let letter = GLYPH * scale;
        let left = picture.width().saturating_sub(width);
        draw_text(picture, (left, letter), scale, INK, &self.quantity);
        draw_text(picture, (left, letter * 5 / 2), scale, INK, &self.unit);
        let (top, bottom) = (letter * 5, picture.height().saturating_sub(letter * 2).max(letter * 5 + 1));
        for y in top..bottom {
            let place = 1.0 - (f64::from(y - top) + 0.5) / f64::from(bottom - top);
            let colour = Rgb(to_bytes(self.colours.linear(place)));
            (left..left + letter * 3 / 2).for_each(|x| put(picture, x, y, colour));
        }
        for (place, label) in self.labels() {
            let y = top + ((1.0 - place) * f64::from(bottom - 1 - top)).round() as u32;
            (left + letter * 3 / 2..left + letter * 2).for_each(|x| put(picture, x, y, INK));
            draw_text(picture, (left + letter * 9 / 4, y.saturating_sub(letter / 2)), scale, INK, &label);
        }
    }

    /// Place (0 to 1) and text of every label, upwards: the ticks, and each end that no tick is near.
    fn labels(&self) -> Vec<(f64, String)> {
        let (low, high) = self.range;
        if high.partial_cmp(&low).is_none_or(|order| order.is_le()) {
            return vec![(0.5, number(low, 1e-3 * low.abs()))];
        }
        let step = nice_step((high - low) / TICKS);
        let place = |value: f64| (value - low) / (high - low);
        let apart = 0.05;
        let mut labels: Vec<_> = ticks(low, high, step)
            .filter(|&tick| tick == low || tick == high || (apart..=1.0 - apart).contains(&place(tick)))
            .map(|tick| (place(tick), number(tick, step)))
            .collect();
        for (end, value) in [(0.0, low), (1.0, high)] {
            if !labels.iter().any(|&(at, _)| at == end) {
                labels.push((end, without_idle_zeros(number(value, 0.1 * step))));
            }
        }
        labels.sort_by(|a, b| a.0.total_cmp(&b.0));
        labels
    }
}

/// Edge of a font dot, pixels.
fn text_scale(height: u32) -> u32 {
    (height / 360).max(1)
}

fn put(picture: &mut RgbImage, x: u32, y: u32, colour: Rgb<u8>) {
    if let Some(pixel) = picture.get_pixel_mut_checked(x, y) {
        *pixel = colour;
    }
}

/// The multiple 1, 2, 5 or 10 of a power of ten next above `rough`.
fn nice_step(rough: f64) -> f64 {
    let power = 10f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0].map(|digit| digit * power).into_iter().find(|&step| step >= 0.999 * rough).unwrap_or(10.0 * power)
}

/// Multiples of `step` from `low` to `high`.
fn ticks(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    let slack = 1e-9 * step;
    let first = ((low - slack) / step).ceil();
    (0..64).map(move |count| (first + f64::from(count)) * step).take_while(move |&tick| tick <= high + slack)
}

/// A number with the decimals that tell steps of `step` apart.
fn number(value: f64, step: f64) -> String {
    let step = if step > 0.0 { step } else { 1.0 };
    if value.abs() >= 1e5 || (value != 0.0 && step < 1e-4) {
        let digits = (value.abs().max(step).log10().floor() - step.log10().floor()).clamp(0.0, 9.0) as usize;
        return format!("{value:.digits$e}");
    }
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') { "0".to_owned() } else { text }
}

/// `1.30` as `1.3`; whole numbers and powers of ten stay as they are.
fn without_idle_zeros(text: String) -> String {
    let trimmed = text.trim_end_matches('0').trim_end_matches('.');
    if text.contains('.') && !text.contains('e') { trimmed.to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::{ScaleBar, nice_step, number};
    use crate::picture::colour_map::ColourMap;
    use image::{Rgb, RgbImage};
    use proptest::prelude::{prop_assert, proptest};

    fn bar(low: f64, high: f64) -> ScaleBar {
        ScaleBar { colours: ColourMap::Viridis, quantity: "thickness".into(), unit: "nm".into(), range: (low, high) }
    }

    #[test]
    fn ticks_fall_on_round_numbers_and_both_ends_are_named() {
        let labels: Vec<_> = bar(0.0, 800.0).labels().into_iter().map(|(_, text)| text).collect();
        assert_eq!(labels, ["0", "200", "400", "600", "800"]);
        let labels: Vec<_> = bar(0.12, 0.53).labels().into_iter().map(|(_, text)| text).collect();
        assert_eq!(labels, ["0.12", "0.2", "0.3", "0.4", "0.5", "0.53"]);
    }

    #[test]
    fn steps_are_one_two_or_five() {
        for (rough, step) in [(0.9, 1.0), (1.3, 2.0), (2.1, 5.0), (7.0, 10.0), (3e-9, 5e-9)] {
            assert!((nice_step(rough) / step - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn very_large_and_small_numbers_use_powers_of_ten() {
        assert_eq!(number(101_300.0, 100.0), "1.013e5");
        assert_eq!(number(2e-9, 1e-9), "2e-9");
        assert_eq!(number(-0.001, 0.5), "0");
    }

    #[test]
    fn the_bar_runs_from_the_low_colour_up_to_the_high_one() {
        let mut picture = RgbImage::new(400, 400);
        let width = bar(0.0, 800.0).width_for(400, 400);
        bar(0.0, 800.0).draw(&mut picture, width);
        let at = |y| picture.get_pixel(400 - width + 2, y).0;
        assert!(at(380)[2] > at(380)[1] && at(45)[1] > at(45)[2]);
        assert!(picture.pixels().filter(|&&p| p == Rgb([226, 228, 232])).count() > 200);
    }

    proptest! {
        #[test]
        fn any_range_has_a_few_labels_in_order(low in -1e9..1e9_f64, span in 1e-9..1e9_f64) {
            let labels = bar(low, low + span).labels();
            prop_assert!((1..=9).contains(&labels.len()));
            prop_assert!(labels.windows(2).all(|pair| pair[0].0 < pair[1].0));
        }
    }
}
