//! Connectivity in flat arrays: what the sums over faces run over, built once per change of the mesh.
//!
//! ```text
//! films:  faces that carry tension and mass                  (ghosts left out)
//! walls:  faces with a closed region on at least one side    (ghosts included)
//! list of vertex v:  entries[offsets[v] .. offsets[v + 1]] = closed regions that v touches, ascending
//! ```

use smallvec::SmallVec;

use crate::rows::{FaceRow, Region, VertexRow};
use crate::surface::Surface;

/// Stands for "no closed region on this side".
pub const NONE: u32 = u32::MAX;

/// A face that carries tension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Film {
    /// Its vertices, ascending.
    pub corners: [u32; 3],
    /// Its row in the mesh.
    pub row: FaceRow,
    /// Its labels: `[back, front]`.
    pub labels: [Region; 2],
}

/// A face that bounds a closed region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wall {
    /// Its vertices, ascending.
    pub corners: [u32; 3],
    /// Numbers of the closed regions in the back and in front, or [`NONE`].
    pub regions: [u32; 2],
    /// For either side and each corner, the entry of that region in the corner's list, or [`NONE`].
    pub entries: [[u32; 3]; 2],
}

/// The regions that the films of a vertex lie between.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sides {
    /// The two smallest labels.
    pub labels: [Region; 2],
    /// How many labels there are: 2 in the middle of a film, 3 on a border, 4 where borders meet. 0 where no film is, and
    /// where one lies between a region and itself.
    pub count: u8,
}

/// Connectivity of a surface in flat arrays.
#[derive(Clone, Debug, Default)]
pub struct Incidence {
    films: Vec<Film>,
    walls: Vec<Wall>,
    closed: Vec<Region>,
    /// Per label, its place in `closed`, or [`NONE`].
    numbers: Vec<u32>,
    origins: Vec<u32>,
    offsets: Vec<u32>,
    entries: Vec<u32>,
    sides: Vec<Sides>,
}

impl Incidence {
    /// The connectivity of a surface.
    #[must_use]
    pub fn new(surface: &Surface) -> Self {
        let mut built = Self::default();
        built.rebuild(surface);
        built
    }

    /// Builds it anew, in the memory it has.
    pub fn rebuild(&mut self, surface: &Surface) {
        let labels = surface.mesh.regions();
        self.closed.clear();
        self.closed.extend(labels.iter().copied().filter(|region| !surface.is_open(*region)));
        self.numbers.clear();
        self.numbers.resize(labels.last().map_or(0, |last| last.index() + 1), NONE);
        (0..).zip(&self.closed).for_each(|(number, region)| self.numbers[region.index()] = number);
        self.list_faces(surface);
        self.list_entries(surface);
        self.find_entries_of_walls();
    }

    fn list_faces(&mut self, surface: &Surface) {
        self.films.clear();
        self.walls.clear();
        self.origins.clear();
        self.origins.resize(self.closed.len(), NONE);
        for (row, face) in surface.mesh.faces() {
            let corners = face.vertices().map(|v| v.0);
            let [back, front] = face.labels();
            if !face.is_ghost() {
                self.films.push(Film { corners, row, labels: [back, front] });
            }
            let regions = [back, front].map(|region| self.numbers[region.index()]);
            if back == front || regions == [NONE; 2] {
                continue;
            }
            for region in regions.into_iter().filter(|region| *region != NONE) {
                let origin = &mut self.origins[region as usize];
                *origin = (*origin).min(corners[0]);
            }
            self.walls.push(Wall { corners, regions, entries: [[NONE; 3]; 2] });
        }
    }

    /// Closed regions and sides of every vertex, from the faces around it.
    fn list_entries(&mut self, surface: &Surface) {
        self.entries.clear();
        self.offsets.clear();
        self.sides.clear();
        for vertex in (0..surface.mesh.vertex_rows() as u32).map(VertexRow) {
            self.offsets.push(self.entries.len() as u32);
            let around = Around::of(surface, vertex);
            self.sides.push(around.sides());
            // Numbers ascend with labels.
            let closed = around.walls.iter().map(|label| self.numbers[label.index()]);
            self.entries.extend(closed.filter(|number| *number != NONE));
        }
        self.offsets.push(self.entries.len() as u32);
    }

    fn find_entries_of_walls(&mut self) {
        let (offsets, entries) = (&self.offsets, &self.entries);
        for wall in &mut self.walls {
            for (side, region) in wall.regions.into_iter().enumerate().filter(|(_, region)| *region != NONE) {
                wall.entries[side] = wall.corners.map(|corner| entry_of(offsets, entries, corner, region));
            }
        }
    }

    /// Faces that carry tension, ascending.
    #[must_use]
    pub fn films(&self) -> &[Film] {
        &self.films
    }

    /// Faces that bound a closed region, ascending.
    #[must_use]
    pub fn walls(&self) -> &[Wall] {
        &self.walls
    }

    /// Regions with a volume of their own, ascending. Position in this list is the region's number.
    #[must_use]
    pub fn closed(&self) -> &[Region] {
        &self.closed
    }

    /// The number of a closed region.
    #[must_use]
    pub fn number(&self, region: Region) -> Option<u32> {
        self.numbers.get(region.index()).copied().filter(|number| *number != NONE)
    }

    /// Per closed region, a vertex of it: volumes are measured from there, which keeps their digits.
    #[must_use]
    pub fn origins(&self) -> &[u32] {
        &self.origins
    }

    /// Rows of vertices, vacant ones counted.
    #[must_use]
    pub fn vertex_rows(&self) -> usize {
        self.sides.len()
    }

    /// Entries of a vertex, as a range into what [`Self::entry_regions`] lists.
    #[must_use]
    #[inline]
    pub fn entries_of(&self, vertex: usize) -> std::ops::Range<usize> {
        self.offsets[vertex] as usize..self.offsets[vertex + 1] as usize
    }

    /// Per entry, the number of its closed region.
    #[must_use]
    pub fn entry_regions(&self) -> &[u32] {
        &self.entries
    }

    /// The regions that the films of a vertex lie between.
    #[must_use]
    #[inline]
    pub fn sides(&self, vertex: usize) -> Sides {
        self.sides[vertex]
    }
}

fn entry_of(offsets: &[u32], entries: &[u32], vertex: u32, region: u32) -> u32 {
    let (from, to) = (offsets[vertex as usize], offsets[vertex as usize + 1]);
    let place = entries[from as usize..to as usize].iter().position(|entry| *entry == region);
    from + place.expect("invariant: corners of a wall list its regions") as u32
}

/// Labels around a vertex, each list ascending.
struct Around {
    /// Of films.
    films: LabelList,
    /// Of faces between two regions, ghosts too.
    walls: LabelList,
    /// Whether a film lies between a region and itself.
    has_inner_film: bool,
}

type LabelList = SmallVec<[Region; 8]>;

impl Around {
    fn of(surface: &Surface, vertex: VertexRow) -> Self {
        let mut around = Self { films: LabelList::new(), walls: LabelList::new(), has_inner_film: false };
        for face in surface.mesh.faces_of(vertex).iter().map(|row| surface.mesh.face(*row)) {
            let [back, front] = face.labels();
            let (is_film, is_wall) = (!face.is_ghost(), back != front);
            around.has_inner_film |= is_film && !is_wall;
            for label in [back, front] {
                if is_film {
                    insert(&mut around.films, label);
                }
                if is_wall {
                    insert(&mut around.walls, label);
                }
            }
        }
        around
    }

    fn sides(&self) -> Sides {
        match self.films.as_slice() {
            _ if self.has_inner_film => Sides::default(),
            [first, second, ..] => Sides { labels: [*first, *second], count: self.films.len().min(255) as u8 },
            _ => Sides::default(),
        }
    }
}

/// Adds a label to an ascending list, once.
fn insert(labels: &mut LabelList, label: Region) {
    if let Err(place) = labels.binary_search(&label) {
        labels.insert(place, label);
    }
}
