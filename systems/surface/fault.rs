//! What can be wrong with triangles from outside, said so that it can be mended; and the way from triangles to a [`Surface`].

use std::fmt;

use glam::DVec3;
use thiserror::Error;

use crate::invariants::{Violation, check_combinatorial, check_volumes};
use crate::rows::{FaceRow, Region, VertexRow};
use crate::surface::{LabelledTriangles, Surface};

/// Largest label: volumes and pressures are arrays over labels.
pub const LARGEST_LABEL: u32 = 65_535;
/// Smallest area of a triangle, in squares of its longest edge; below, its normal is noise.
const FLAT: f64 = 1e-10;

/// A fault of a mesh. Rows count from 0, in the order of the input.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum MeshFault {
    /// No triangles.
    #[error("the mesh has no faces: give it at least a closed film of four")]
    Empty,
    /// Arrays that do not fit together.
    #[error("{values} {what} for {wanted}: every one needs its own")]
    Lengths {
        /// Name of the array.
        what: &'static str,
        /// Its length.
        values: usize,
        /// The length wanted.
        wanted: usize,
    },
    /// A position that is not a number.
    #[error("{vertex} lies at {place}, which is no finite place: mend its coordinates")]
    NotFinite {
        /// The vertex.
        vertex: VertexRow,
        /// Its position.
        place: DVec3,
    },
    /// A row out of range.
    #[error("{face} names {vertex}, but there are only {count} vertices (rows count from 0)")]
    NoSuchVertex {
        /// The face.
        face: FaceRow,
        /// The row it names.
        vertex: VertexRow,
        /// Vertices there are.
        count: usize,
    },
    /// The same vertex twice in a face.
    #[error("{face} has {vertex} twice: delete the face, or weld its neighbours")]
    RepeatedVertex {
        /// The face.
        face: FaceRow,
        /// The vertex.
        vertex: VertexRow,
    },
    /// The same region on both sides.
    #[error("{face} has {region} on both sides: a film separates two regions; delete the face or mend its labels")]
    SameLabels {
        /// The face.
        face: FaceRow,
        /// The region.
        region: Region,
    },
    /// A label beyond [`LARGEST_LABEL`].
    #[error("{face} has the label {label}; the largest is {LARGEST_LABEL}: number regions from 1 without gaps")]
    LabelTooLarge {
        /// The face.
        face: FaceRow,
        /// Its label.
        label: u32,
    },
    /// An open region that is the outside, or that no face has.
    #[error("region {label} is said to be open, but {}", if *label == 0 { "the outside always is" } else { "no face has it" })]
    NoSuchOpenRegion {
        /// The label.
        label: u32,
    },
    /// A face without area.
    #[error("{face} has no area ({area:e} m^2): its corners are on one line; collapse its shortest edge")]
    ZeroArea {
        /// The face.
        face: FaceRow,
        /// Its area, m^2.
        area: f64,
    },
    /// A vertex without faces.
    #[error("{vertex} has no face: delete it")]
    IsolatedVertex {
        /// The vertex.
        vertex: VertexRow,
    },
    /// Two faces with the same vertices.
    #[error(
        "{first} and {second} have the same three vertices: keep one, with the regions that lie on its outer sides"
    )]
    DuplicateFaces {
        /// One face.
        first: FaceRow,
        /// The other.
        second: FaceRow,
    },
    /// An edge with one face.
    #[error(
        "the edge of {a} and {b} has one face only, {face}: every region must be closed; fill the hole, or close an open film with ghost faces"
    )]
    OpenEdge {
        /// One end.
        a: VertexRow,
        /// The other end.
        b: VertexRow,
        /// The face.
        face: FaceRow,
    },
    /// Labels that do not fit around an edge.
    #[error(
        "labels do not fit around the edge of {a} and {b}: {}; a walk around it enters {region} more or less often than it leaves it: turn a face over or swap its labels",
        Sides(faces)
    )]
    InconsistentLabels {
        /// One end.
        a: VertexRow,
        /// The other end.
        b: VertexRow,
        /// The region.
        region: Region,
        /// The faces of the edge with their labels, back and front, as they were given.
        faces: Vec<(FaceRow, [Region; 2])>,
    },
    /// A gas region without a positive volume.
    #[error(
        "{region} has the volume {volume:e} m^3: its faces point inwards; swap the labels of all of them, or say that it is open"
    )]
    NoVolume {
        /// The region.
        region: Region,
        /// Its volume, m^3.
        volume: f64,
    },
    /// Two faces that cross.
    #[error(
        "{first} and {second} cross: films must not; move the bubbles apart, or make the wall between them one film"
    )]
    SelfIntersection {
        /// One face.
        first: FaceRow,
        /// The other.
        second: FaceRow,
    },
    /// Films around a vertex whose regions do not fit.
    #[error(
        "around {vertex} films show different regions to each other: they fold through one another there; pull them apart"
    )]
    Tangled {
        /// The vertex.
        vertex: VertexRow,
    },
    /// A wire that goes through a film.
    #[error(
        "piece {segment} of the wire goes through {face}: films end on wires; make its points vertices of the film, or move it"
    )]
    PiercedFilm {
        /// Piece of the wire, counted from 0.
        segment: usize,
        /// The face.
        face: FaceRow,
    },
}

/// `face 3 (1 | 0), face 7 (2 | 0)`: back and front of each face.
struct Sides<'a>(&'a [(FaceRow, [Region; 2])]);

impl fmt::Display for Sides<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, (face, [back, front])) in self.0.iter().enumerate() {
            let comma = if place == 0 { "" } else { ", " };
            write!(f, "{comma}{face} ({} | {})", back.0, front.0)?;
        }
        Ok(())
    }
}

/// The surface of triangles that hold: closed regions, labels that fit, faces with area, positive volumes.
///
/// Crossings of films are not looked for; see [`validate_with`].
///
/// # Errors
/// The first [`MeshFault`] found: arrays and rows first, then faces, edges and regions.
pub fn validate(set: &LabelledTriangles) -> Result<Surface, MeshFault> {
    check_arrays(set)?;
    check_vertices(set)?;
    (0..set.triangles.len()).try_for_each(|face| check_face(set, face))?;
    let surface = Surface::from_triangles(set);
    if let Some(vertex) = (0..set.positions.len() as u32).map(VertexRow).find(|v| !surface.mesh.has_vertex(*v)) {
        return Err(MeshFault::IsolatedVertex { vertex });
    }
    check_open(set, &surface)?;
    check_combinatorial(&surface).and_then(|()| check_volumes(&surface)).map_err(|found| fault_of(found, set))?;
    Ok(surface)
}

/// The same, with a search for pairs of faces that cross.
///
/// # Errors
/// As [`validate`], and [`MeshFault::SelfIntersection`] with the first pair that `find_crossings` gives.
pub fn validate_with(
    set: &LabelledTriangles,
    find_crossings: impl FnOnce(&Surface) -> Vec<(FaceRow, FaceRow)>,
) -> Result<Surface, MeshFault> {
    let surface = validate(set)?;
    match find_crossings(&surface).first() {
        Some((first, second)) => Err(MeshFault::SelfIntersection { first: *first, second: *second }),
        None => Ok(surface),
    }
}

/// Looks for films, ghosts left out, that pieces of a wire go through; `pierces` says whether a segment crosses a triangle.
///
/// A piece may end on a film: `pierces` must not count what only touches.
///
/// # Errors
/// [`MeshFault::PiercedFilm`] with the first piece and face.
pub fn check_wires(
    surface: &Surface,
    wire: &[[DVec3; 2]],
    pierces: impl Fn([DVec3; 2], [DVec3; 3]) -> bool,
) -> Result<(), MeshFault> {
    for (segment, ends) in wire.iter().enumerate() {
        let mut films = surface.mesh.faces().filter(|(_, face)| !face.is_ghost());
        if let Some((face, _)) = films.find(|(row, _)| pierces(*ends, surface.corners(*row))) {
            return Err(MeshFault::PiercedFilm { segment, face });
        }
    }
    Ok(())
}

fn check_arrays(set: &LabelledTriangles) -> Result<(), MeshFault> {
    let (vertices, faces) = (set.positions.len(), set.triangles.len());
    for (what, values, wanted) in [
        ("pins", set.pinned.len(), vertices),
        ("labels", set.labels.len(), faces),
        ("ghost flags", set.ghosts.len(), faces),
    ] {
        if values != wanted {
            return Err(MeshFault::Lengths { what, values, wanted });
        }
    }
    if faces == 0 { Err(MeshFault::Empty) } else { Ok(()) }
}

fn check_vertices(set: &LabelledTriangles) -> Result<(), MeshFault> {
    let lost = (0..).map(VertexRow).zip(&set.positions).find(|(_, place)| !place.is_finite());
    lost.map_or(Ok(()), |(vertex, place)| Err(MeshFault::NotFinite { vertex, place: *place }))
}

fn check_face(set: &LabelledTriangles, index: usize) -> Result<(), MeshFault> {
    let (face, count, triangle) = (FaceRow(index as u32), set.positions.len(), set.triangles[index]);
    if let Some(vertex) = triangle.into_iter().find(|v| *v as usize >= count) {
        return Err(MeshFault::NoSuchVertex { face, vertex: VertexRow(vertex), count });
    }
    if let Some(k) = (0..3).find(|k| triangle[*k] == triangle[(k + 1) % 3]) {
        return Err(MeshFault::RepeatedVertex { face, vertex: VertexRow(triangle[k]) });
    }
    let [back, front] = set.labels[index];
    if let Some(label) = [back, front].into_iter().find(|label| *label > LARGEST_LABEL) {
        return Err(MeshFault::LabelTooLarge { face, label });
    }
    if back == front {
        return Err(MeshFault::SameLabels { face, region: Region(back) });
    }
    let [a, b, c] = triangle.map(|v| set.positions[v as usize]);
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    // In units of the longest edge: squares of tiny edges would vanish.
    let [u, v] = [b - a, c - a].map(|way| way / longest);
    let relative = 0.5 * u.cross(v).length();
    if relative > FLAT { Ok(()) } else { Err(MeshFault::ZeroArea { face, area: 0.5 * (b - a).cross(c - a).length() }) }
}

fn check_open(set: &LabelledTriangles, surface: &Surface) -> Result<(), MeshFault> {
    let regions = surface.mesh.regions();
    let lost = set.open.iter().find(|label| **label == 0 || regions.binary_search(&Region(**label)).is_err());
    lost.map_or(Ok(()), |label| Err(MeshFault::NoSuchOpenRegion { label: *label }))
}

/// What a violation means for somebody who made the mesh.
fn fault_of(violation: Violation, set: &LabelledTriangles) -> MeshFault {
    match violation {
        Violation::LoneFace { a, b, face } => MeshFault::OpenEdge { a, b, face },
        Violation::Twins { first, second } => MeshFault::DuplicateFaces { first, second },
        Violation::Unbalanced { a, b, region, faces, .. } => {
            let faces = faces.iter().map(|row| (*row, set.labels[row.index()].map(Region))).collect();
            MeshFault::InconsistentLabels { a, b, region, faces }
        }
        Violation::Volume { region, volume } => MeshFault::NoVolume { region, volume },
        Violation::VolumeSum { sum, .. } => MeshFault::NoVolume { region: Region::OUTSIDE, volume: sum },
        Violation::NotFinite { vertex } => MeshFault::NotFinite { vertex, place: set.positions[vertex.index()] },
        Violation::RepeatedVertex { face, vertex } => MeshFault::RepeatedVertex { face, vertex },
        Violation::SameLabels { face, region } => MeshFault::SameLabels { face, region },
        Violation::NoSuchVertex { face, vertex } => {
            MeshFault::NoSuchVertex { face, vertex, count: set.positions.len() }
        }
        Violation::Length { what, values, rows } => MeshFault::Lengths { what, values, wanted: rows },
        Violation::Adjacency { vertex, .. } => MeshFault::IsolatedVertex { vertex },
        Violation::Tangled { vertex } => MeshFault::Tangled { vertex },
        Violation::Crossing { first, second } => MeshFault::SelfIntersection { first, second },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cube, disc, icosphere, packing};

    fn sphere() -> LabelledTriangles {
        icosphere(DVec3::ZERO, 1.0, 0.4)
    }

    fn lone_vertex() -> LabelledTriangles {
        LabelledTriangles { positions: vec![DVec3::ZERO], pinned: vec![false], ..Default::default() }
    }

    fn without_face(mut set: LabelledTriangles, face: usize) -> LabelledTriangles {
        set.triangles.remove(face);
        set.labels.remove(face);
        set.ghosts.remove(face);
        set
    }

    #[test]
    fn shapes_pass() {
        for set in [sphere(), cube(DVec3::ONE, 1e-6, 3e-7), disc(DVec3::ZERO, 1e6, DVec3::Y, 2e5)] {
            assert!(validate(&set).is_ok());
        }
        assert!(validate(&packing(DVec3::ZERO, 3, 1e-6, 0.2, 1, 3e-7)).is_ok());
    }

    #[test]
    fn a_hole_is_named_by_an_edge_of_it() {
        let found = validate(&without_face(sphere(), 5));
        assert!(matches!(found, Err(MeshFault::OpenEdge { .. })), "{found:?}");
    }

    #[test]
    fn a_face_turned_over_is_named_with_its_labels() {
        let mut set = sphere();
        set.triangles[9].swap(0, 1);
        let fault = validate(&set).unwrap_err();
        let MeshFault::InconsistentLabels { faces, .. } = &fault else { panic!("{fault}") };
        assert!(faces.iter().any(|(face, _)| *face == FaceRow(9)));
        let message = fault.to_string();
        assert!(message.contains("face 9 (1 | 0)") && message.contains("swap its labels"), "{message}");
    }

    #[test]
    fn every_bad_value_has_its_own_fault() {
        let spoilt = |spoil: fn(&mut LabelledTriangles)| {
            let mut set = sphere();
            spoil(&mut set);
            validate(&set).unwrap_err()
        };
        assert_eq!(validate(&LabelledTriangles::default()), Err(MeshFault::Empty));
        assert!(matches!(spoilt(|s| s.positions[3].x = f64::NAN), MeshFault::NotFinite { vertex: VertexRow(3), .. }));
        let lost = spoilt(|s| s.triangles[4][2] = 5000);
        assert!(matches!(lost, MeshFault::NoSuchVertex { face: FaceRow(4), vertex: VertexRow(5000), .. }));
        assert!(matches!(spoilt(|s| s.triangles[4][2] = s.triangles[4][0]), MeshFault::RepeatedVertex { .. }));
        assert!(matches!(spoilt(|s| s.labels[4] = [1, 1]), MeshFault::SameLabels { face: FaceRow(4), .. }));
        assert!(matches!(spoilt(|s| s.labels[4] = [70_000, 0]), MeshFault::LabelTooLarge { label: 70_000, .. }));
        assert!(matches!(spoilt(|s| s.append(&lone_vertex())), MeshFault::IsolatedVertex { .. }));
        assert!(matches!(spoilt(|s| s.ghosts.truncate(5)), MeshFault::Lengths { what: "ghost flags", .. }));
        assert!(matches!(spoilt(|s| s.open.push(2)), MeshFault::NoSuchOpenRegion { label: 2 }));
        let inside_out = spoilt(|s| s.labels.iter_mut().for_each(|labels| labels.reverse()));
        assert!(matches!(inside_out, MeshFault::NoVolume { region: Region(1), .. }));
        let flat = spoilt(|s| {
            let [a, b, c] = s.triangles[0].map(|v| v as usize);
            s.positions[a] = s.positions[b].midpoint(s.positions[c]);
        });
        assert!(matches!(flat, MeshFault::ZeroArea { .. }), "{flat}");
        let twins = spoilt(|s| {
            s.add_film(s.triangles[0], [0, 1]);
        });
        assert!(matches!(twins, MeshFault::DuplicateFaces { .. } | MeshFault::InconsistentLabels { .. }), "{twins}");
    }

    #[test]
    fn crossings_and_pierced_films_are_passed_on() {
        let crossing = validate_with(&sphere(), |_| vec![(FaceRow(3), FaceRow(8))]);
        assert_eq!(crossing, Err(MeshFault::SelfIntersection { first: FaceRow(3), second: FaceRow(8) }));
        let surface = validate_with(&disc(DVec3::ZERO, 1.0, DVec3::Z, 0.3), |_| Vec::new()).unwrap();
        let through =
            |[p, q]: [DVec3; 2], t: [DVec3; 3]| p.z * q.z < 0.0 && t.iter().all(|x| x.truncate().length() < 0.5);
        let wire = [[DVec3::Z, DVec3::X + DVec3::Z], [DVec3::Z, -DVec3::Z]];
        assert!(matches!(check_wires(&surface, &wire, through), Err(MeshFault::PiercedFilm { segment: 1, .. })));
        assert_eq!(check_wires(&surface, &wire[..1], through), Ok(()));
    }
}
