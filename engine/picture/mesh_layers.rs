//! Gathers the facets and tubes over each sample into the sheets of film seen there.
//!
//! Facets of one film that face alike and cover different places of a sample are one sheet; so a film's inner edges leave no
//! trace. Where all sheets cover a sample, they are composited once; where some cover part of it, each of its sixteen places
//! is composited for itself: opaque and clear films have clean borders alike. The number of sheets is not limited.
//! Source: Carpenter 1984 (A-buffer). Limits: films that intersect within one sample are sorted by their mean depth there.

use super::camera::View;
use super::facet::{Facet, Fragment, facet_of_triangle};
use super::film_network::{FilmNetwork, LineKind};
use super::raster::{Content, Sight, TileLight};
use super::shade::{Layer, Matter, Shader, Surface};
use super::subsamples::{Mask, WHOLE};
use super::tiles::{Flat, TileGrid, Tiled};
use super::triangles::FilmTriangles;
use super::tube::{Tube, tube_of_line};
use glam::Vec3;

/// Marks the end of a list of sheets.
const END: u32 = u32::MAX;
/// Radius of a wire over that of a Plateau border.
const WIRE: f64 = 1.2;
/// Least cosine between a sheet's normal and the view: smooth normals near an outline may point away from the eye.
const SHALLOWEST: f32 = 0.01;

/// Films of triangles, listed by tile.
#[derive(Debug)]
pub(super) struct MeshFilms {
    facets: Tiled<Facet>,
    tubes: Tiled<Tube>,
}

impl MeshFilms {
    /// Projects and lists the triangles and, with a radius in metres, the lines of a mesh.
    pub(super) fn new(
        mesh: &FilmTriangles,
        network: &FilmNetwork,
        border_radius: Option<f64>,
        view: &View,
        grid: &TileGrid,
    ) -> Self {
        let facets = Tiled::new(mesh.triangles.len(), grid, |row| facet_of_triangle(view, mesh, network, row));
        let lines = if border_radius.is_some() { &network.lines[..] } else { &[] };
        let tubes = Tiled::new(lines.len(), grid, |row| {
            let wider = if lines[row].kind == LineKind::Wire { WIRE } else { 1.0 };
            tube_of_line(view, mesh.positions, &lines[row], wider * border_radius?)
        });
        Self { facets, tubes }
    }
}

impl Content for MeshFilms {
    type Layers = MeshLayers;

    fn layers(&self, edge: usize) -> MeshLayers {
        MeshLayers::new(edge)
    }

    fn gather(&self, tile: usize, corner: (usize, usize), layers: &mut MeshLayers) {
        layers.restart(corner);
        for facet in self.facets.of_tile(tile) {
            let (matter, faces_eye) = (Matter::Film(facet.film), facet.faces_eye);
            let part = Part { matter, faces_eye, opacity: 1.0, tolerance: f32::INFINITY };
            layers.add(facet, &part, |column, row| facet.fragment(column, row));
        }
        for tube in self.tubes.of_tile(tile) {
            let part =
                Part { matter: tube.kind.into(), faces_eye: true, opacity: tube.opacity, tolerance: 2.0 * tube.radius };
            layers.add(tube, &part, |column, row| tube.fragment(column, row));
        }
    }
}

impl From<LineKind> for Matter {
    fn from(kind: LineKind) -> Self {
        match kind {
            LineKind::Border => Self::Border,
            LineKind::Wire => Self::Wire,
        }
    }
}

/// What all fragments of a shape have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    matter: Matter,
    faces_eye: bool,
    opacity: f32,
    /// Fragments farther apart in depth than this are different sheets, metres.
    tolerance: f32,
}

/// Running sums of one sheet at one sample, weighted by the number of places.
#[derive(Clone, Copy, Debug)]
struct Sheet {
    /// The next sheet at the same sample.
    next: u32,
    part: Part,
    mask: Mask,
    value: f32,
    normal: Vec3,
    spread: Vec3,
    depth: f32,
}

impl Sheet {
    fn mean_depth(&self) -> f32 {
        self.depth / self.mask.count_ones() as f32
    }

    /// Places that a fragment adds to this sheet; none if it is not of this sheet.
    fn gains(&self, part: &Part, fragment: &Fragment) -> Mask {
        let alike = self.part.matter == part.matter && self.part.faces_eye == part.faces_eye;
        let doubled = self.mask & fragment.mask;
        match part.matter {
            _ if !alike || (self.mean_depth() - fragment.depth).abs() > part.tolerance => 0,
            Matter::Film(_) if doubled != 0 => 0,
            _ => fragment.mask & !self.mask,
        }
    }

    fn add(&mut self, gained: Mask, fragment: &Fragment) {
        let weight = gained.count_ones() as f32;
        self.mask |= gained;
        self.value += weight * fragment.value;
        self.normal += weight * fragment.normal;
        self.spread += weight * fragment.spread;
        self.depth += weight * fragment.depth;
    }

    fn surface(&self, ray: Vec3) -> Surface {
        let normal = self.normal.normalize_or(-ray);
        let cos = -ray.dot(normal);
        let normal = if cos < SHALLOWEST { (normal + (cos - SHALLOWEST) * ray).normalize_or(-ray) } else { normal };
        let places = self.mask.count_ones() as f32;
        let Part { matter, opacity, .. } = self.part;
        let (value, spread) = (self.value / places, self.spread / places);
        Surface { value, normal, spread, depth: self.mean_depth(), coverage: opacity, matter }
    }
}

/// The sheets at every sample of one square tile.
#[derive(Debug)]
pub(super) struct MeshLayers {
    edge: usize,
    corner: (usize, usize),
    /// Per sample, the first of its sheets.
    first: Vec<u32>,
    sheets: Vec<Sheet>,
    /// Room for the sheets of one sample, nearest first.
    stack: Vec<Sheet>,
    layers: Vec<(Mask, Layer)>,
}

impl MeshLayers {
    fn new(edge: usize) -> Self {
        let first = vec![END; edge * edge];
        Self { edge, corner: (0, 0), first, sheets: Vec::new(), stack: Vec::new(), layers: Vec::new() }
    }

    fn restart(&mut self, corner: (usize, usize)) {
        self.corner = corner;
        self.first.fill(END);
        self.sheets.clear();
    }

    /// Adds a shape to every sample of the tile under it.
    fn add(&mut self, shape: &impl Flat, part: &Part, fragment: impl Fn(usize, usize) -> Option<Fragment>) {
        let (low, high) = shape.bounds();
        let cells = |low: f32, high: f32, corner: usize| {
            let cell = |position: f32| (position.max(0.0) as usize).clamp(corner, corner + self.edge);
            cell(low)..cell(high + 1.0)
        };
        let (columns, rows) = (cells(low.x, high.x, self.corner.0), cells(low.y, high.y, self.corner.1));
        for row in rows {
            for column in columns.clone() {
                if let Some(fragment) = fragment(column, row) {
                    let sample = (row - self.corner.1) * self.edge + column - self.corner.0;
                    self.add_fragment(sample, part, &fragment);
                }
            }
        }
    }

    fn add_fragment(&mut self, sample: usize, part: &Part, fragment: &Fragment) {
        let distance = |sheet: &Sheet| (sheet.mean_depth() - fragment.depth).abs();
        let mut best: Option<(usize, Mask)> = None;
        let mut at = self.first[sample];
        while at != END {
            let sheet = &self.sheets[at as usize];
            let gained = sheet.gains(part, fragment);
            if gained != 0 && best.is_none_or(|(other, _)| distance(sheet) < distance(&self.sheets[other])) {
                best = Some((at as usize, gained));
            }
            // A line that only covers what it covers already adds nothing.
            if part.matter.is_line()
                && gained == 0
                && sheet.part.matter == part.matter
                && distance(sheet) <= part.tolerance
            {
                return;
            }
            at = sheet.next;
        }
        match best {
            Some((sheet, gained)) => self.sheets[sheet].add(gained, fragment),
            None => self.open(sample, part, fragment),
        }
    }

    fn open(&mut self, sample: usize, part: &Part, fragment: &Fragment) {
        let next = std::mem::replace(&mut self.first[sample], self.sheets.len() as u32);
        let (value, normal, spread, depth) = (0.0, Vec3::ZERO, Vec3::ZERO, 0.0);
        let mut sheet = Sheet { next, part: *part, mask: 0, value, normal, spread, depth };
        sheet.add(fragment.mask, fragment);
        self.sheets.push(sheet);
    }

    /// Copies the sheets at a sample to the stack, nearest first.
    fn stack(&mut self, sample: usize) {
        self.stack.clear();
        let mut at = self.first[sample];
        while at != END {
            let sheet = self.sheets[at as usize];
            self.stack.push(sheet);
            at = sheet.next;
        }
        self.stack.sort_by(|a, b| a.mean_depth().total_cmp(&b.mean_depth()));
    }
}

impl TileLight for MeshLayers {
    fn light(&mut self, (column, row): (usize, usize), sight: &Sight, shader: &Shader) -> Vec3 {
        self.stack(row * self.edge + column);
        if self.stack.is_empty() {
            return sight.background;
        }
        let lit = |sheet: &Sheet| (sheet.mask, shader.layer(sight.ray, &sheet.surface(sight.ray)));
        self.layers.clear();
        self.layers.extend(self.stack.iter().map(lit));
        let through = |places: Mask| {
            let layers = self.layers.iter().filter(|(mask, _)| mask & places != 0).map(|(_, layer)| layer);
            shader.develop(Layer::composite(layers, sight.background))
        };
        if self.layers.iter().all(|(mask, _)| *mask == WHOLE) {
            return through(WHOLE);
        }
        (0..Mask::BITS).map(|place| through(1 << place)).sum::<Vec3>() / Mask::BITS as f32
    }
}

#[cfg(test)]
mod tests {
    use super::{MeshFilms, MeshLayers};
    use crate::picture::camera::{Camera, View};
    use crate::picture::film_network::FilmNetwork;
    use crate::picture::raster::Content;
    use crate::picture::shade::Matter;
    use crate::picture::subsamples::WHOLE;
    use crate::picture::test_meshes::{Mesh, double_bubble, sphere};
    use crate::picture::tiles::TileGrid;
    use glam::{DVec3, Vec2, Vec3};

    const EDGE: usize = 120;

    fn view() -> View {
        let camera =
            Camera { position: DVec3::new(0.0, 0.0, 4.0), target: DVec3::ZERO, up: DVec3::Y, field_of_view: 40.0 };
        camera.view(EDGE as f64, EDGE as f64).unwrap()
    }

    fn drawn(mesh: &Mesh, radius: Option<f64>) -> MeshLayers {
        let (view, grid) = (view(), TileGrid::new(EDGE, EDGE, EDGE));
        let films = MeshFilms::new(&mesh.film(), &FilmNetwork::new(&mesh.film()), radius, &view, &grid);
        let mut layers = films.layers(EDGE);
        films.gather(0, (0, 0), &mut layers);
        layers
    }

    /// Distance of a sample from the centre of the picture, samples.
    fn from_centre(sample: usize) -> f32 {
        (Vec2::new((sample % EDGE) as f32, (sample / EDGE) as f32) + 0.5 - 0.5 * EDGE as f32).length()
    }

    #[test]
    fn a_sphere_shows_a_front_and_a_back_sheet_with_exact_normals_and_no_seams() {
        let mut layers = drawn(&sphere(4), None);
        let silhouette = (view().focal * (1.0_f64 / 4.0).asin().tan()) as f32;
        for sample in 0..EDGE * EDGE {
            layers.stack(sample);
            if from_centre(sample) < silhouette - 2.0 {
                let [front, back] = &layers.stack[..] else { panic!("{} sheets", layers.stack.len()) };
                assert!(front.mask == WHOLE && back.mask == WHOLE && front.part.faces_eye && !back.part.faces_eye);
                let ray = view().ray((sample % EDGE) as f32 + 0.5, (sample / EDGE) as f32 + 0.5);
                let place = ray / -ray.z * front.mean_depth() - Vec3::new(0.0, 0.0, -4.0);
                // Interpolated over an edge of 0.07: straight to second order.
                assert!(front.surface(ray).normal.distance(place.normalize()) < 0.005);
            }
            if from_centre(sample) > silhouette + 2.0 {
                assert!(layers.stack.is_empty());
            }
        }
    }

    #[test]
    fn any_number_of_films_behind_each_other_is_kept() {
        let mut mesh = Mesh::default();
        for k in 0..30 {
            let scaled = sphere(2);
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(scaled.positions.iter().map(|p| *p * (1.0 - 0.02 * f64::from(k))));
            mesh.values.extend(scaled.values);
            mesh.triangles.extend(scaled.triangles.iter().map(|t| t.map(|v| v + first)));
            mesh.labels.extend(scaled.labels.iter().map(|_| [k + 1, k]));
        }
        let mut layers = drawn(&mesh, None);
        layers.stack(EDGE / 2 * EDGE + EDGE / 2);
        assert_eq!(layers.stack.len(), 60);
    }

    #[test]
    fn a_border_is_one_unbroken_line_in_front_of_the_films_behind_it() {
        let radius = 0.02;
        let mut mesh = double_bubble(48);
        // Turned so that the border is seen as a circle.
        mesh.positions.iter_mut().for_each(|p| *p = DVec3::new(p.z, p.y, p.x));
        mesh.labels.iter_mut().for_each(|pair| pair.swap(0, 1));
        let mut layers = drawn(&mesh, Some(radius));
        let circle = (view().focal * 0.75_f64.sqrt() / 4.0) as f32;
        let mut places = 0;
        for sample in 0..EDGE * EDGE {
            layers.stack(sample);
            let borders: Vec<_> = layers.stack.iter().filter(|sheet| sheet.part.matter == Matter::Border).collect();
            assert!(borders.len() <= 1, "{} borders over one sample", borders.len());
            places += borders.iter().map(|sheet| sheet.mask.count_ones()).sum::<u32>();
            assert!(borders.is_empty() || (from_centre(sample) - circle).abs() < 2.5);
        }
        let area = f64::from(places) / 16.0;
        let expected = std::f64::consts::TAU * f64::from(circle) * 2.0 * radius * view().focal / 4.0;
        assert!((area / expected - 1.0).abs() < 0.05, "{area} of {expected}");
    }
}
