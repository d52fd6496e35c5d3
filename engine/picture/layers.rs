//! Gathers the ellipses over each sample into the sheets of film seen there.
//!
//! Equation: with weights `w = h (1 - r²)²` of the points at offsets `d` from the sample, the value is that of the
//! straight-line fit `v(0) = v̄ - g·d̄`, `g = C⁻¹ Σ w (d - d̄)(v - v̄) / Σ w`, `C = Σ w (d - d̄)(d - d̄)ᵀ / Σ w`:
//! exact for fields linear across the picture, so uneven points leave no dots. Normals are the weighted mean.
//! A point joins a sheet that faces the same way at a depth within its tolerance; else it opens one.
//! Source: moving least squares after Levin 1998, §3, with linear basis. Limits: at most [`MAX_SHEETS`] sheets per
//! sample; sheets nearer to each other than about 4 spacings that face alike are drawn as one.

use super::camera::View;
use super::error::PictureError;
use super::film::FilmPoints;
use super::raster::{Content, Sight, TileLight};
use super::shade::{Shader, Surface};
use super::splat::{EDGE_WEIGHT, FULL_WEIGHT, Splat};
use super::tiles::{TileGrid, Tiled};
use glam::{Vec2, Vec3};

/// Most sheets of film behind one sample.
pub(super) const MAX_SHEETS: usize = 8;
/// Share of the full weight of detail from which a ground adds nothing to what is shown.
const ENOUGH_DETAIL: f32 = 0.5;
/// Variance added to the fit, samples squared, so that it stays solvable where all points line up.
const FIT_FLOOR: f32 = 0.05;

/// Sums per sheet: weight, `w d` (2), `w d dᵀ` (3), `w v`, `w v d` (2), `w n` (3), `w` depth, slope of the cover (2), and
/// the cover: the weight of the points that tell where the film is.
///
/// One flat array, of a multiple of four, so that the compiler adds four numbers at a time.
type Sums = [f32; 16];

/// Running sums of one sheet at one sample.
#[derive(Clone, Copy, Debug, Default)]
struct Sheet {
    sums: Sums,
    first_depth: f32,
    faces_eye: bool,
}

/// Films of points, listed by tile.
#[derive(Debug)]
pub(super) struct SplatFilms {
    films: Vec<Tiled<Splat>>,
}

impl SplatFilms {
    /// Projects and lists the points of all films.
    ///
    /// # Errors
    /// As [`Tiled::splats`].
    pub(super) fn new(films: &[FilmPoints], view: &View, grid: &TileGrid) -> Result<Self, PictureError> {
        Ok(Self { films: films.iter().map(|film| Tiled::splats(view, film, grid)).collect::<Result<_, _>>()? })
    }
}

impl Content for SplatFilms {
    type Layers = TileLayers;

    fn layers(&self, edge: usize) -> TileLayers {
        TileLayers::new(edge)
    }

    fn gather(&self, tile: usize, corner: (usize, usize), layers: &mut TileLayers) {
        layers.restart(corner);
        self.films.iter().flat_map(|film| film.of_tile(tile)).for_each(|splat| layers.add(splat));
    }
}

impl TileLight for TileLayers {
    fn light(&mut self, (column, row): (usize, usize), sight: &Sight, shader: &Shader) -> Vec3 {
        let mut sheets = [Surface::default(); MAX_SHEETS];
        match self.surfaces(column, row, &mut sheets) {
            0 => sight.background,
            found => shader.shade(sight, &sheets[..found]),
        }
    }
}

/// The sheets at every sample of one square tile.
#[derive(Debug)]
pub(super) struct TileLayers {
    edge: usize,
    corner: (usize, usize),
    counts: Vec<u8>,
    /// `MAX_SHEETS` entries per sample.
    sheets: Vec<Sheet>,
}

impl TileLayers {
    /// Room for a tile of `edge` by `edge` samples.
    pub(super) fn new(edge: usize) -> Self {
        let samples = edge * edge;
        let sheets = vec![Sheet::default(); samples * MAX_SHEETS];
        Self { edge, corner: (0, 0), counts: vec![0; samples], sheets }
    }

    /// Empties the tile and moves it to a place in the picture, samples.
    pub(super) fn restart(&mut self, corner: (usize, usize)) {
        self.corner = corner;
        self.counts.fill(0);
    }

    /// Adds one ellipse to every sample under it.
    pub(super) fn add(&mut self, splat: &Splat) {
        let corner = Vec2::new(self.corner.0 as f32, self.corner.1 as f32);
        let centre = splat.centre - corner;
        let edge = self.edge;
        let cell = |position: f32| (position.max(0.0) as usize).min(edge);
        let rows = cell(centre.y - splat.reach.y)..cell(centre.y + splat.reach.y + 1.0);
        for row in rows {
            let down = centre.y - (row as f32 + 0.5);
            let Some((from, to)) = chord(splat, centre.x, down) else { continue };
            for column in cell(from)..cell(to + 1.0) {
                let offset = Vec2::new(centre.x - (column as f32 + 0.5), down);
                self.add_sample(row * edge + column, splat, offset);
            }
        }
    }

    #[inline]
    fn add_sample(&mut self, sample: usize, splat: &Splat, offset: Vec2) {
        let Vec3 { x: xx, y: xy, z: yy } = splat.conic;
        let along = Vec2::new(xx * offset.x + xy * offset.y, xy * offset.x + yy * offset.y);
        let inside = 1.0 - offset.dot(along);
        if inside <= 0.0 {
            return;
        }
        let Some(sheet) = self.sheet_for(sample, splat) else { return };
        if splat.cover > 1.0 && sheet.sums[0] > FULL_WEIGHT * ENOUGH_DETAIL {
            let steepness = 4.0 * splat.cover * splat.height * inside;
            sheet.sums[13] += steepness * along.x;
            sheet.sums[14] += steepness * along.y;
            sheet.sums[15] += splat.cover * splat.height * inside * inside;
            return;
        }
        sheet.sums.iter_mut().zip(terms(splat, offset, inside, along)).for_each(|(sum, term)| *sum += term);
    }

    #[inline]
    fn sheet_for(&mut self, sample: usize, splat: &Splat) -> Option<&mut Sheet> {
        let count = usize::from(self.counts[sample]);
        let sheets = &mut self.sheets[sample * MAX_SHEETS..(sample + 1) * MAX_SHEETS];
        let joins = |sheet: &Sheet| {
            sheet.faces_eye == splat.faces_eye && (sheet.first_depth - splat.depth).abs() <= splat.depth_tolerance
        };
        if let Some(found) = sheets[..count].iter().position(joins) {
            return Some(&mut sheets[found]);
        }
        let opened = sheets.get_mut(count)?;
        self.counts[sample] += 1;
        *opened = Sheet { first_depth: splat.depth, faces_eye: splat.faces_eye, ..Sheet::default() };
        Some(opened)
    }

    /// The sheets at a sample of the tile, farthest first, written to `out`; returns how many.
    pub(super) fn surfaces(&self, column: usize, row: usize, out: &mut [Surface; MAX_SHEETS]) -> usize {
        let sample = row * self.edge + column;
        let count = usize::from(self.counts[sample]);
        let mut found = 0;
        for sheet in &self.sheets[sample * MAX_SHEETS..sample * MAX_SHEETS + count] {
            let coverage = sheet.coverage();
            if coverage > 0.0 {
                out[found] = sheet.surface(coverage);
                found += 1;
            }
        }
        out[..found].sort_by(|a, b| b.depth.total_cmp(&a.depth));
        found
    }
}

/// Where the row `down` samples above the centre cuts the ellipse: from and to, in the frame of `centre_x`.
fn chord(splat: &Splat, centre_x: f32, down: f32) -> Option<(f32, f32)> {
    let Vec3 { x: xx, y: xy, z: yy } = splat.conic;
    let middle = -xy * down / xx;
    let square = middle * middle - (yy * down * down - 1.0) / xx;
    (square > 0.0).then(|| (centre_x - middle - square.sqrt(), centre_x - middle + square.sqrt()))
}

/// What one ellipse adds to the sums at a sample: `inside` is `1 - r²`, `along` is `C⁻¹ d`.
#[inline]
fn terms(splat: &Splat, offset: Vec2, inside: f32, along: Vec2) -> Sums {
    let weight = splat.height * inside * inside;
    let steepness = 4.0 * splat.cover * splat.height * inside;
    let (x, y) = (weight * offset.x, weight * offset.y);
    let (value, normal) = (splat.value, weight * splat.normal);
    [
        weight,
        x,
        y,
        x * offset.x,
        x * offset.y,
        y * offset.y,
        weight * value,
        x * value,
        y * value,
        normal.x,
        normal.y,
        normal.z,
        weight * splat.depth,
        steepness * along.x,
        steepness * along.y,
        splat.cover * weight,
    ]
}

impl Sheet {
    /// Share of the sample on the film's side of the line where the cover falls to [`EDGE_WEIGHT`].
    fn coverage(&self) -> f32 {
        let [.., slope_x, slope_y, cover] = self.sums;
        let above = cover - EDGE_WEIGHT * FULL_WEIGHT;
        let steepness = Vec2::new(slope_x, slope_y).length().max(1e-6);
        (0.5 + above / steepness).clamp(0.0, 1.0)
    }

    fn surface(&self, coverage: f32) -> Surface {
        let [weight, _, _, _, _, _, _, _, _, normal_x, normal_y, normal_z, depth, ..] = self.sums;
        let normal = Vec3::new(normal_x, normal_y, normal_z).normalize_or(Vec3::Z);
        Surface { value: self.fitted_value(), normal, depth: depth / weight, coverage, ..Surface::default() }
    }

    fn fitted_value(&self) -> f32 {
        let [weight, x, y, xx, xy, yy, value, value_x, value_y, ..] = self.sums;
        let per_weight = weight.recip();
        let (mean, centre) = (value * per_weight, Vec2::new(x, y) * per_weight);
        let covariance = Vec2::new(value_x, value_y) * per_weight - mean * centre;
        let xx = xx * per_weight - centre.x * centre.x + FIT_FLOOR;
        let xy = xy * per_weight - centre.x * centre.y;
        let yy = yy * per_weight - centre.y * centre.y + FIT_FLOOR;
        let determinant = (xx * yy - xy * xy).max(FIT_FLOOR * FIT_FLOOR);
        let gradient = Vec2::new(yy * covariance.x - xy * covariance.y, xx * covariance.y - xy * covariance.x);
        mean - gradient.dot(centre) / determinant
    }
}

#[cfg(test)]
mod tests {
    use super::{MAX_SHEETS, TileLayers};
    use crate::picture::camera::{Camera, View};
    use crate::picture::film::{FilmPoints, Part};
    use crate::picture::shade::Surface;
    use crate::picture::splat::splat_of_point;
    use glam::{DVec3, Vec2};
    use std::f64::consts::PI;

    const EDGE: usize = 160;

    fn view() -> View {
        let camera =
            Camera { position: DVec3::new(0.0, 0.0, 4.0), target: DVec3::ZERO, up: DVec3::Y, field_of_view: 35.0 };
        camera.view(EDGE as f64, EDGE as f64).unwrap()
    }

    fn drawn(film: &FilmPoints) -> TileLayers {
        drawn_all(std::slice::from_ref(film))
    }

    fn drawn_all(films: &[FilmPoints]) -> TileLayers {
        let mut layers = TileLayers::new(EDGE);
        layers.restart((0, 0));
        let view = view();
        for film in films {
            (0..film.positions.len()).filter_map(|row| splat_of_point(&view, film, row)).for_each(|s| layers.add(&s));
        }
        layers
    }

    fn surfaces(layers: &TileLayers, column: usize, row: usize) -> Vec<Surface> {
        let mut out = [Surface::default(); MAX_SHEETS];
        let found = layers.surfaces(column, row, &mut out);
        out[..found].to_vec()
    }

    /// A number in -0.5 to 0.5 for each step of an even sequence.
    fn jitter(step: usize) -> f64 {
        (step as f64 * 0.618_033_988_75).fract() - 0.5
    }

    /// An unevenly sampled square in the plane z = 0, half edge 1.
    fn square(across: usize) -> (Vec<DVec3>, f64) {
        let spacing = 2.0 / across as f64;
        let place = |cell: usize, seed: usize| -1.0 + spacing * (cell as f64 + 0.5 + 0.6 * jitter(seed));
        let points = (0..across * across)
            .map(|i| DVec3::new(place(i % across, 3 * i + 1), place(i / across, 7 * i + 2), 0.0))
            .collect();
        (points, spacing)
    }

    /// A sphere of radius 1 sampled along a spiral.
    fn sphere(points: usize) -> (Vec<DVec3>, f64) {
        let directions = (0..points)
            .map(|i| {
                let height = 1.0 - (2 * i + 1) as f64 / points as f64;
                let (sin, cos) = (2.399_963_229_7 * i as f64).sin_cos();
                DVec3::new(cos, 0.0, sin) * (1.0 - height * height).sqrt() + height * DVec3::Y
            })
            .collect();
        (directions, (4.0 * PI / points as f64).sqrt())
    }

    /// Where the ray of a sample meets the plane z = 0.
    fn on_plane(column: usize, row: usize) -> DVec3 {
        let ray = view().ray(column as f32 + 0.5, row as f32 + 0.5).as_dvec3();
        DVec3::new(0.0, 0.0, 4.0) + ray * (4.0 / -ray.z)
    }

    #[test]
    fn a_linear_field_is_drawn_as_it_is_from_uneven_points() {
        let (positions, spacing) = square(60);
        let field = |p: DVec3| 3.0 + 2.0 * p.x - 0.7 * p.y;
        let values: Vec<f64> = positions.iter().map(|&p| field(p)).collect();
        let film = FilmPoints {
            positions: &positions,
            normals: &vec![DVec3::Z; values.len()],
            values: &values,
            spacing,
            part: Part::Whole,
        };
        let layers = drawn(&film);
        for sample in 0..EDGE * EDGE {
            let (column, row) = (sample % EDGE, sample / EDGE);
            let place = on_plane(column, row);
            if place.abs().max_element() < 0.9 {
                let found = surfaces(&layers, column, row);
                assert_eq!(found.len(), 1);
                // The field changes by 2.1 per length; a fiftieth of a spacing is far below one fringe.
                let error = (f64::from(found[0].value) - field(place)).abs();
                assert!(error < 0.02 * 2.1 * spacing, "{error} at {place}");
            }
        }
    }

    #[test]
    fn halving_the_spacing_quarters_the_error_of_a_curved_field() {
        let field = |p: DVec3| (2.0 * p.x).sin() + (3.0 * p.y).cos();
        let error = |across: usize| {
            let (positions, spacing) = square(across);
            let values: Vec<f64> = positions.iter().map(|&p| field(p)).collect();
            let normals = vec![DVec3::Z; values.len()];
            let layers = drawn(&FilmPoints {
                positions: &positions,
                normals: &normals,
                values: &values,
                spacing,
                part: Part::Whole,
            });
            let inside = (0..EDGE * EDGE)
                .map(|s| (s % EDGE, s / EDGE))
                .filter(|&(column, row)| on_plane(column, row).abs().max_element() < 0.7);
            let errors: Vec<f64> = inside
                .map(|(column, row)| f64::from(surfaces(&layers, column, row)[0].value) - field(on_plane(column, row)))
                .collect();
            (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
        };
        let order = (error(20) / error(40)).log2();
        assert!((1.7..2.5).contains(&order), "observed order {order}");
    }

    #[test]
    fn a_sphere_shows_a_front_and_a_back_sheet_without_holes() {
        for points in [2_000, 20_000] {
            let (directions, spacing) = sphere(points);
            let film = FilmPoints {
                positions: &directions,
                normals: &directions,
                values: &vec![1.0; points],
                spacing,
                part: Part::Whole,
            };
            let layers = drawn(&film);
            // The sphere's silhouette: sin(angle) = 1/4, seen at the focal length.
            let silhouette = (view().focal * (1.0_f64 / 4.0).asin().tan()) as f32;
            for sample in 0..EDGE * EDGE {
                let (column, row) = (sample % EDGE, sample / EDGE);
                let from_centre = (Vec2::new(column as f32, row as f32) + 0.5 - 0.5 * EDGE as f32).length();
                let found = surfaces(&layers, column, row);
                if from_centre < silhouette - 3.0 {
                    assert_eq!(found.len(), 2, "{points} points, {from_centre} of {silhouette}");
                    assert!(found.iter().all(|sheet| sheet.coverage == 1.0 && (sheet.value - 1.0).abs() < 1e-4));
                    assert!(found[0].depth > found[1].depth);
                }
                if from_centre > silhouette + 3.0 {
                    assert!(found.is_empty(), "{points} points, {from_centre} of {silhouette}");
                }
            }
        }
    }

    #[test]
    fn the_ground_shows_where_the_detail_has_a_hole() {
        let (mut detail, spacing) = square(80);
        detail.retain(|p| p.length() > 0.3);
        let (ground, wide) = square(20);
        let film = |positions, values, spacing, part| FilmPoints {
            positions,
            normals: &[DVec3::Z; 6400][..positions.len()],
            values,
            spacing,
            part,
        };
        let (ones, twos) = (vec![1.0; detail.len()], vec![2.0; ground.len()]);
        let films = [film(&detail[..], &ones[..], spacing, Part::Detail), film(&ground, &twos, wide, Part::Ground)];
        let layers = drawn_all(&films);
        for (column, row) in (0..EDGE * EDGE).map(|s| (s % EDGE, s / EDGE)) {
            let (place, found) = (on_plane(column, row), surfaces(&layers, column, row));
            if place.abs().max_element() < 0.9 {
                assert!(found.len() == 1 && found[0].coverage == 1.0, "{place}: {found:?}");
                let shown = if place.length() < 0.2 { 2.0 } else { 1.0 };
                let is_clear = place.length() < 0.2 || place.length() > 0.35;
                assert!(!is_clear || (found[0].value - shown).abs() < 0.03, "{place}: {found:?}");
            }
        }
    }

    #[test]
    fn the_edge_of_an_open_film_is_one_sample_wide() {
        let (positions, spacing) = square(20);
        let normals = vec![DVec3::Z; positions.len()];
        let values = vec![1.0; positions.len()];
        let layers = drawn(&FilmPoints {
            positions: &positions,
            normals: &normals,
            values: &values,
            spacing,
            part: Part::Whole,
        });
        let partly = (0..EDGE)
            .flat_map(|column| surfaces(&layers, column, EDGE / 2))
            .filter(|sheet| sheet.coverage > 0.0 && sheet.coverage < 1.0)
            .count();
        assert!(partly <= 4, "{partly} samples are partly covered");
    }
}
