//! From authored films to one mesh: shapes as labelled triangles, perturbed, checked, held by their wires.

use froth_components::authored::film::Film;
use froth_components::authored::film_shape::FilmShape;
use froth_components::authored::mesh_shape::{FrameKind, MeshFile, MeshShape};
use froth_components::authored::shape::Shape;
use froth_components::authored::tension::Tension;
use froth_components::authored::volumes::Volumes;
use froth_components::authored::wire::{Moves, Wire};
use froth_surface::fault::{MeshFault, validate_with};
use froth_surface::files::{FileFault, read_named};
use froth_surface::motion::find_crossings;
use froth_surface::shapes::{self, frame::Frame};
use froth_surface::{LabelledTriangles, Region, Surface, VertexRow};
use glam::DVec3;
use thiserror::Error;

use super::wire_edges::vertices_along;
use super::wire_piercing::pierces;
use super::wires::Holders;
use crate::bubbles::gas::Ramp;
use crate::sampling;
use crate::sampling::field::Extent;
use crate::sampling::surface::{Displacement, Perturbation};

/// A film as the scene writes it.
#[derive(Clone, Debug)]
pub struct AuthoredFilm {
    /// Which entity of the scene it is, from 0.
    pub place: u32,
    /// What wires call it.
    pub name: Option<String>,
    /// Its shape.
    pub shape: FilmShape,
    /// Its thickness.
    pub film: Film,
    /// Factors by which the shape is stretched about its centre along x, y and z.
    pub stretch: DVec3,
    /// How the shape is displaced.
    pub perturbation: Perturbation,
    /// Seed of noise that the scene does not seed itself.
    pub seed: u32,
    /// How its own rims move.
    pub moves: Option<Moves>,
    /// Velocity at the start, m/s.
    pub drift: DVec3,
    /// What its bubbles grow or shrink to.
    pub volumes: Option<Volumes>,
    /// Tension of an interface, if not the liquid's.
    pub tension: Option<Tension>,
}

/// A wire as the scene writes it.
#[derive(Clone, Debug)]
pub struct AuthoredWire {
    /// Which entity of the scene it is, from 0.
    pub place: u32,
    /// Where it runs, and what it holds.
    pub wire: Wire,
    /// How it moves.
    pub moves: Option<Moves>,
}

/// What is wrong with the films of a scene; `place` is the entity, from 0.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FilmFault {
    /// A mesh file cannot be read.
    #[error("{fault}")]
    File {
        /// The entity.
        place: u32,
        /// What is wrong.
        fault: FileFault,
    },
    /// The mesh of a film is at fault.
    #[error("{fault}")]
    Mesh {
        /// The entity.
        place: u32,
        /// What is wrong.
        fault: MeshFault,
    },
    /// Volumes for more or fewer bubbles than there are.
    #[error("{volumes} volumes are given to {bubbles} bubbles: write one for each")]
    VolumeCount {
        /// The entity.
        place: u32,
        /// Bubbles of its shape.
        bubbles: usize,
        /// Volumes that it gives.
        volumes: usize,
    },
    /// Films of two entities go through each other.
    #[error("two films go through each other: move them apart, or join them where they meet")]
    Crossing {
        /// One entity.
        place: u32,
        /// The other.
        other: u32,
    },
    /// A wire with no film near it.
    #[error(
        "the wire runs along no film: the nearest vertex is {distance:.3e} m away, and edges are {edge:.3e} m long"
    )]
    NoFilmOnWire {
        /// The wire's entity.
        place: u32,
        /// Distance of the nearest vertex, metres.
        distance: f64,
        /// Edge length, metres.
        edge: f64,
    },
    /// A wire that a film cannot be put on without going through another.
    #[error("the wire goes through a film instead of along it, or films would cross if they were put on it")]
    WirePierces {
        /// The wire's entity.
        place: u32,
    },
}

impl FilmFault {
    /// The entity of the scene, from 0.
    #[must_use]
    pub fn place(&self) -> u32 {
        match self {
            Self::File { place, .. }
            | Self::Mesh { place, .. }
            | Self::VolumeCount { place, .. }
            | Self::Crossing { place, .. }
            | Self::NoFilmOnWire { place, .. }
            | Self::WirePierces { place } => *place,
        }
    }
}

/// All films of a scene as one mesh, one value per vertex row in every list.
#[derive(Clone, Debug, Default)]
pub struct DiscreteFilms {
    /// The mesh.
    pub surface: Surface,
    /// Thickness of the film, metres.
    pub thickness: Vec<f64>,
    /// Tension of an interface of the regions that have their own, N/m.
    pub tensions: Vec<(Region, f64)>,
    /// What bubbles grow or shrink to, in the order of the scene.
    pub ramps: Vec<(Region, Ramp)>,
    /// Velocity at the start, m/s.
    pub velocities: Vec<DVec3>,
    /// What holds the vertex, as [`Holders`] numbers it; 0 for nothing.
    pub pins: Vec<u64>,
}

impl DiscreteFilms {
    /// Makes and checks the mesh of all films with edges of about `edge` metres.
    ///
    /// # Errors
    /// The first [`FilmFault`], in the order of the scene.
    pub fn sample(films: &[AuthoredFilm], wires: &[AuthoredWire], edge: f64) -> Result<Self, FilmFault> {
        let mut all = LabelledTriangles::default();
        let mut discrete = Self::default();
        // Which film a vertex belongs to.
        let mut owners: Vec<usize> = Vec::new();
        for (number, film) in films.iter().enumerate() {
            let mut triangles = triangles(film, edge)?;
            let centre = film.shape.centre();
            triangles.positions.iter_mut().for_each(|x| *x = centre + film.stretch * (*x - centre));
            perturb(&mut triangles, film);
            let fault = |fault| FilmFault::Mesh { place: film.place, fault };
            validate_with(&triangles, |surface| find_crossings(surface, false)).map_err(fault)?;
            discrete.thickness.extend(thickness(&triangles, film));
            let count = triangles.positions.len();
            discrete.velocities.extend(std::iter::repeat_n(film.drift, count));
            discrete
                .pins
                .extend(triangles.pinned.iter().map(|held| if *held { Holders::pin_of_rim(number) } else { 0 }));
            owners.extend(std::iter::repeat_n(number, count));
            discrete.ramps.extend(ramps(film, &triangles, all.region_count() - 1)?);
            let own = (1..triangles.region_count()).map(|label| Region(label + all.region_count() - 1));
            discrete.tensions.extend(film.tension.iter().flat_map(|t| own.clone().map(|region| (region, t.0.si()))));
            all.append(&triangles);
        }
        discrete.surface = Surface::from_triangles(&all);
        discrete.check_apart(films, &owners)?;
        for (number, wire) in wires.iter().enumerate() {
            discrete.hold(wire, Holders::pin_of_wire(films.len(), number), films, &owners, edge)?;
        }
        Ok(discrete)
    }

    /// Films of different entities must not cross.
    fn check_apart(&self, films: &[AuthoredFilm], owners: &[usize]) -> Result<(), FilmFault> {
        let owner = |face| films[owners[self.surface.mesh.face(face).vertices()[0].index()]].place;
        match find_crossings(&self.surface, false).first() {
            Some((a, b)) => Err(FilmFault::Crossing { place: owner(*a), other: owner(*b) }),
            None => Ok(()),
        }
    }

    /// Puts the vertices nearest to a wire on it, and holds them; rims that lie on it already are the wire's from then on.
    fn hold(
        &mut self,
        wire: &AuthoredWire,
        pin: u64,
        films: &[AuthoredFilm],
        owners: &[usize],
        edge: f64,
    ) -> Result<(), FilmFault> {
        let named = |v: VertexRow| {
            let name = films[owners[v.index()]].name.as_deref();
            wire.wire.holds.as_deref().is_none_or(|wanted| name == Some(wanted))
        };
        let vertices: Vec<VertexRow> = self.surface.mesh.vertices().filter(|v| named(*v)).collect();
        let distance = |v: &VertexRow| {
            let x = self.surface.positions[*v];
            wire.wire.path.nearest(x).distance(x)
        };
        // What a film pinned itself; what a wire before took stays with that.
        let is_own = |v: VertexRow| Holders::is_rim(self.pins[v.index()], films.len());
        let rims: Vec<VertexRow> =
            vertices.iter().copied().filter(|v| is_own(*v) && distance(v) < 1e-3 * edge).collect();
        let rimmed: Vec<usize> = rims.iter().map(|v| owners[v.index()]).collect();
        let others: Vec<VertexRow> =
            vertices.iter().copied().filter(|v| !rimmed.contains(&owners[v.index()])).collect();
        let ring = vertices_along(&self.surface, &others, &wire.wire.path, edge);
        let held: Vec<VertexRow> = rims.iter().chain(&ring).copied().collect();
        if pierces(&self.surface, &held, &wire.wire.path, edge) {
            return Err(FilmFault::WirePierces { place: wire.place });
        }
        if held.is_empty() {
            let nearest = vertices.iter().map(distance).fold(f64::INFINITY, f64::min);
            return Err(FilmFault::NoFilmOnWire { place: wire.place, distance: nearest, edge });
        }
        self.take_over(&rims, pin);
        for v in ring {
            let x = self.surface.positions[v];
            self.surface.positions[v] = wire.wire.path.nearest(x);
            self.surface.pinned[v] = true;
            self.pins[v.index()] = pin;
        }
        match find_crossings(&self.surface, false).is_empty() {
            true => Ok(()),
            false => Err(FilmFault::WirePierces { place: wire.place }),
        }
    }
}

impl DiscreteFilms {
    /// Gives rims to another holder, with the tips of the lids that close them: a lid goes along with its rim.
    fn take_over(&mut self, rims: &[VertexRow], pin: u64) {
        let mesh = &self.surface.mesh;
        let is_tip = |v: &VertexRow| {
            let faces = mesh.faces_of(*v);
            let is_of_rims = |w: VertexRow| w == *v || rims.contains(&w);
            faces.iter().all(|row| mesh.face(*row).is_ghost() && mesh.face(*row).vertices().into_iter().all(is_of_rims))
        };
        let tips: Vec<VertexRow> =
            rims.iter().flat_map(|v| mesh.neighbours(*v)).filter(|v| self.surface.pinned[*v]).filter(is_tip).collect();
        rims.iter().chain(&tips).for_each(|v| self.pins[v.index()] = pin);
    }
}

/// The triangles of an authored shape.
fn triangles(film: &AuthoredFilm, edge: f64) -> Result<LabelledTriangles, FilmFault> {
    match &film.shape {
        FilmShape::Single(shape) => Ok(single(shape, edge)),
        FilmShape::Mesh(MeshShape::MeshFile(file)) => {
            from_file(file).map_err(|fault| FilmFault::File { place: film.place, fault })
        }
        FilmShape::Mesh(shape) => Ok(several(shape, film.seed, edge)),
    }
}

fn single(shape: &Shape, edge: f64) -> LabelledTriangles {
    let centre = shape.centre();
    match shape {
        Shape::Sphere(sphere) => shapes::icosphere(centre, sphere.radius.si(), edge),
        Shape::Ellipsoid(ellipsoid) => shapes::ellipsoid(centre, ellipsoid.radii.si(), edge),
        Shape::HalfSphere(half) => shapes::half_sphere(centre, half.radius.si(), half.up.unit(), edge),
        Shape::Disc(disc) => shapes::disc(centre, disc.radius.si(), disc.normal.unit(), edge),
        Shape::Rectangle(r) => {
            shapes::rectangle(centre, r.width.si(), r.height.si(), r.normal.unit(), r.up.unit(), edge)
        }
        Shape::Hexagon(h) => shapes::hexagon(centre, h.radius.si(), h.normal.unit(), h.up.unit(), edge),
    }
}

fn several(shape: &MeshShape, seed: u32, edge: f64) -> LabelledTriangles {
    let centre = shape.measured().centre();
    match shape {
        MeshShape::Cube(cube) => shapes::cube(centre, cube.side.si(), edge),
        MeshShape::DoubleBubble(double) => {
            let [first, second] = double.radii.si();
            shapes::double_bubble(double.centre.si(), double.axis.unit(), first, second, edge)
        }
        MeshShape::TripleBubble(triple) => shapes::triple_bubble(centre, triple.axis.unit(), triple.radius.si(), edge),
        MeshShape::QuadrupleBubble(quadruple) => shapes::quadruple_bubble(centre, quadruple.radius.si(), edge),
        MeshShape::KelvinCells(cells) => shapes::kelvin_cells(centre, cells.size.si(), cells.count as usize, edge),
        MeshShape::Lattice(lattice) => {
            shapes::lattice(centre, lattice.counts.get().map(|n| n as usize), lattice.cell.si(), edge)
        }
        MeshShape::SphereLattice(spheres) => {
            let mut set = shapes::sphere_lattice(
                spheres.counts.get().map(|n| n as usize),
                spheres.radius.si(),
                spheres.gap.si(),
                edge,
            );
            set.positions.iter_mut().for_each(|x| *x += centre);
            set
        }
        MeshShape::Packing(foam) => {
            let seed = foam.seed.unwrap_or(u64::from(seed));
            shapes::packing(centre, foam.count as usize, foam.radius.si(), foam.spread.si(), seed, edge)
        }
        MeshShape::Catenoid(c) => shapes::catenoid(centre, c.axis.unit(), c.radius.si(), c.gap.si(), edge),
        MeshShape::WireFrame(wires) => {
            let kind = match wires.kind {
                FrameKind::Tetrahedron => Frame::Tetrahedron,
                FrameKind::Cube => Frame::Cube,
                FrameKind::Octahedron => Frame::Octahedron,
            };
            shapes::frame(kind, centre, wires.edge.si(), edge)
        }
        _ => unreachable!("invariant: files are read elsewhere"),
    }
}

fn from_file(file: &MeshFile) -> Result<LabelledTriangles, FileFault> {
    let mut set = read_named(&file.path, file.bytes())?;
    set.positions.iter_mut().for_each(|x| *x = file.centre.si() + file.scale.si() * *x);
    Ok(set)
}

/// What the bubbles of a film grow or shrink to; its regions follow `before` others.
fn ramps(film: &AuthoredFilm, set: &LabelledTriangles, before: u32) -> Result<Vec<(Region, Ramp)>, FilmFault> {
    let Some(volumes) = &film.volumes else { return Ok(Vec::new()) };
    let bubbles: Vec<u32> = (1..set.region_count()).filter(|label| !set.open.contains(label)).collect();
    if bubbles.len() != volumes.of.si().len() {
        return Err(FilmFault::VolumeCount {
            place: film.place,
            bubbles: bubbles.len(),
            volumes: volumes.of.si().len(),
        });
    }
    let end = volumes.within.si();
    let ramp = |(label, volume): (u32, f64)| (Region(label + before), Ramp { volume, end });
    Ok(bubbles.into_iter().zip(volumes.of.si()).map(ramp).collect())
}

/// Displaces free vertices along the normal of a flat shape, or else along the way from its centre; towards a rim by less.
fn perturb(set: &mut LabelledTriangles, film: &AuthoredFilm) {
    let (centre, size) = (film.shape.centre(), film.shape.size());
    let displacement = Displacement::new(film.perturbation);
    let rim = match &film.shape {
        FilmShape::Single(shape) => Some(sampling::surface::Surface::new(*shape, Perturbation::default())),
        FilmShape::Mesh(_) => None,
    };
    for (x, _) in set.positions.iter_mut().zip(&set.pinned).filter(|(_, held)| !**held) {
        let arm = (*x - centre) / size;
        let along = film.shape.flat_normal().unwrap_or_else(|| arm.normalize_or_zero());
        let share = rim.as_ref().map_or(1.0, |rim| rim.pinning(*x));
        *x += along * (size * displacement.at(arm) * share);
    }
}

fn thickness(set: &LabelledTriangles, film: &AuthoredFilm) -> Vec<f64> {
    let (centre, size) = (film.shape.centre(), film.shape.size());
    Extent { places: &set.positions, centre, size, seed: film.seed }.thickness(&film.film.thickness)
}
