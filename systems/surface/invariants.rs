//! What must hold for a surface after every operation: checks for tests and debug builds.
//!
//! | check | says |
//! |---|---|
//! | distinct | a face has three vertices and two regions |
//! | twins | no two faces have the same vertices |
//! | balance | at every edge `(a, b)` and for every region `r`: `sum_f s_f ([back_f = r] - [front_f = r]) = 0`, `s_f = +1` if `f` contains `a -> b`, else `-1` |
//! | adjacency | the lists of faces around vertices are those that the faces give |
//! | sectors | around every vertex, sides that look at each other have the same region |
//! | crossings | no two films go through each other, by exact predicates |
//! | volumes | every gas region has a positive volume, and all volumes add up to zero |
//!
//! Balance is watertightness where any number of faces meet on an edge: every sector around the edge has one region. All but
//! the volumes are integers, and know nothing of positions.

use glam::DVec3;
use smallvec::SmallVec;
use thiserror::Error;

use crate::mesh::{Face, FaceList};
use crate::motion::find_crossings;
use crate::rows::{FaceRow, Region, VertexRow};
use crate::sectors::Sectors;
use crate::surface::Surface;

/// What does not hold, and where.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum Violation {
    /// An array per vertex has not one value for every row.
    #[error("{values} {what} for {rows} rows of vertices: every row needs one")]
    Length {
        /// Name of the array.
        what: &'static str,
        /// Its length.
        values: usize,
        /// Rows of vertices.
        rows: usize,
    },
    /// A position is not a number.
    #[error("{vertex} is at no finite place")]
    NotFinite {
        /// The vertex.
        vertex: VertexRow,
    },
    /// A face names a row that is not there.
    #[error("{face} has {vertex}, which is not among the rows")]
    NoSuchVertex {
        /// The face.
        face: FaceRow,
        /// The row it names.
        vertex: VertexRow,
    },
    /// The same vertex twice in a face.
    #[error("{face} has {vertex} twice")]
    RepeatedVertex {
        /// The face.
        face: FaceRow,
        /// The vertex.
        vertex: VertexRow,
    },
    /// The same region on both sides of a face.
    #[error("{face} has {region} on both sides")]
    SameLabels {
        /// The face.
        face: FaceRow,
        /// The region.
        region: Region,
    },
    /// Two faces with the same vertices.
    #[error("{first} and {second} have the same three vertices")]
    Twins {
        /// One face.
        first: FaceRow,
        /// The other.
        second: FaceRow,
    },
    /// An edge with one face.
    #[error("the edge of {a} and {b} has one face only, {face}: the film is torn there")]
    LoneFace {
        /// One end.
        a: VertexRow,
        /// The other end.
        b: VertexRow,
        /// The face.
        face: FaceRow,
    },
    /// A region is entered more often than it is left around an edge.
    #[error(
        "around the edge of {a} and {b} (faces {faces:?}), {region} is entered {excess} times more than it is left"
    )]
    Unbalanced {
        /// One end.
        a: VertexRow,
        /// The other end.
        b: VertexRow,
        /// The region.
        region: Region,
        /// Entered less left; dimensionless.
        excess: i32,
        /// The faces of the edge.
        faces: FaceList,
    },
    /// The faces around a vertex are not those that have it.
    #[error("{vertex} lists the faces {listed:?}, but {found:?} have it")]
    Adjacency {
        /// The vertex.
        vertex: VertexRow,
        /// Faces it lists.
        listed: FaceList,
        /// Faces that have it.
        found: FaceList,
    },
    /// A gas region without a positive volume.
    #[error("{region} has the volume {volume:e} m^3, which is not positive: its films cross or point the wrong way")]
    Volume {
        /// The region.
        region: Region,
        /// Its volume, m^3.
        volume: f64,
    },
    /// Sides that look at each other disagree in region, or films around a vertex do not bound whole sectors.
    #[error("around {vertex} the regions that faces show to each other disagree")]
    Tangled {
        /// The vertex.
        vertex: VertexRow,
    },
    /// Two films that go through each other.
    #[error("{first} and {second} cross")]
    Crossing {
        /// One face.
        first: FaceRow,
        /// The other.
        second: FaceRow,
    },
    /// Volumes that do not add up to zero.
    #[error("all volumes add up to {sum:e} m^3, more than the rounding {bound:e} m^3")]
    VolumeSum {
        /// Their sum, m^3.
        sum: f64,
        /// What rounding allows, m^3.
        bound: f64,
    },
}

/// Everything: what needs no positions, then volumes, sectors, and crossings of films by exact predicates.
///
/// # Errors
/// The first [`Violation`], in the order of the checks.
pub fn check_all(surface: &Surface) -> Result<(), Violation> {
    check_combinatorial(surface)?;
    check_volumes(surface)?;
    check_sectors(surface)?;
    match find_crossings(surface, false).first() {
        Some((first, second)) => Err(Violation::Crossing { first: *first, second: *second }),
        None => Ok(()),
    }
}

/// The regions that faces show to each other agree around every vertex.
///
/// # Errors
/// The first vertex at which they do not.
pub fn check_sectors(surface: &Surface) -> Result<(), Violation> {
    let is_tangled = |v: &VertexRow| {
        let faces: Vec<Face> = surface.mesh.faces_of(*v).iter().map(|row| surface.mesh.face(*row)).collect();
        Sectors::of(*v, &faces, &|v| surface.positions[v]).is_tangled()
    };
    match surface.mesh.vertices().find(is_tangled) {
        Some(vertex) => Err(Violation::Tangled { vertex }),
        None => Ok(()),
    }
}

/// Everything that needs no positions: distinct, twins, balance, adjacency; and one value per row in every array.
///
/// # Errors
/// The first [`Violation`], in order of rows.
pub fn check_combinatorial(surface: &Surface) -> Result<(), Violation> {
    check_arrays(surface)?;
    check_adjacency(surface)?;
    for vertex in surface.mesh.vertices() {
        check_vertex(surface, vertex, |other| other > vertex)?;
    }
    Ok(())
}

/// Distinct, twins and balance at the faces and edges of a few vertices: what an operation there could have broken.
///
/// Vertices without faces pass, as do rows that are vacant.
///
/// # Errors
/// The first [`Violation`], in order of `vertices`.
pub fn check_combinatorial_around(surface: &Surface, vertices: &[VertexRow]) -> Result<(), Violation> {
    for vertex in vertices.iter().filter(|v| surface.mesh.has_vertex(**v)) {
        check_vertex(surface, *vertex, |_| true)?;
        for face in surface.mesh.faces_of(*vertex) {
            if surface.mesh.get(*face).is_none_or(|f| !f.has(*vertex)) {
                return Err(adjacency_violation(surface, *vertex));
            }
        }
    }
    Ok(())
}

/// Every region that is not open has a positive volume; all volumes, that of the outside included, add up to zero.
///
/// # Errors
/// [`Violation::Volume`], [`Violation::VolumeSum`] or [`Violation::NotFinite`].
pub fn check_volumes(surface: &Surface) -> Result<(), Violation> {
    check_finite(surface, surface.mesh.vertices())?;
    let volumes = surface.volumes();
    let sum: f64 = volumes.iter().sum();
    let bound = rounding_of_volumes(surface);
    if sum.abs() > bound {
        return Err(Violation::VolumeSum { sum, bound });
    }
    check_regions(surface, &volumes, bound, &surface.mesh.regions())
}

/// The regions around a few vertices have positive volumes, out of `volumes` as [`Surface::volumes`] gives them.
///
/// # Errors
/// [`Violation::Volume`] or [`Violation::NotFinite`].
pub fn check_volumes_around(surface: &Surface, volumes: &[f64], vertices: &[VertexRow]) -> Result<(), Violation> {
    check_finite(surface, vertices.iter().copied())?;
    let bound = rounding_of_volumes(surface);
    for vertex in vertices {
        check_regions(surface, volumes, bound, &surface.mesh.regions_of(*vertex))?;
    }
    Ok(())
}

fn check_arrays(surface: &Surface) -> Result<(), Violation> {
    let rows = surface.mesh.vertex_rows();
    for (what, values) in [("positions", surface.positions.len()), ("pins", surface.pinned.len())] {
        if values != rows {
            return Err(Violation::Length { what, values, rows });
        }
    }
    Ok(())
}

/// Lists around vertices against lists made from the faces alone.
fn check_adjacency(surface: &Surface) -> Result<(), Violation> {
    let mesh = &surface.mesh;
    let mut found = vec![FaceList::new(); mesh.vertex_rows()];
    for (row, face) in mesh.faces() {
        for vertex in face.vertices() {
            found.get_mut(vertex.index()).ok_or(Violation::NoSuchVertex { face: row, vertex })?.push(row);
        }
        check_distinct(surface, row)?;
    }
    for (vertex, found) in (0..).map(VertexRow).zip(found) {
        if mesh.faces_of(vertex) != found.as_slice() {
            return Err(Violation::Adjacency { vertex, listed: mesh.faces_of(vertex).into(), found });
        }
    }
    Ok(())
}

fn adjacency_violation(surface: &Surface, vertex: VertexRow) -> Violation {
    let found = surface.mesh.faces().filter(|(_, face)| face.has(vertex)).map(|(row, _)| row).collect();
    Violation::Adjacency { vertex, listed: surface.mesh.faces_of(vertex).into(), found }
}

fn check_distinct(surface: &Surface, row: FaceRow) -> Result<(), Violation> {
    let Some(face) = surface.mesh.get(row) else { return Ok(()) };
    let [a, b, c] = face.vertices();
    if a == b || b == c {
        return Err(Violation::RepeatedVertex { face: row, vertex: b });
    }
    let [back, front] = face.labels();
    if back == front { Err(Violation::SameLabels { face: row, region: back }) } else { Ok(()) }
}

/// Faces of a vertex, and its edges to the neighbours that are `wanted`.
fn check_vertex(surface: &Surface, vertex: VertexRow, wanted: impl Fn(VertexRow) -> bool) -> Result<(), Violation> {
    let faces = surface.mesh.faces_of(vertex);
    for face in faces.iter().filter(|face| surface.mesh.get(**face).is_some()) {
        check_distinct(surface, *face)?;
    }
    if faces.iter().any(|face| surface.mesh.get(*face).is_none()) {
        return Err(adjacency_violation(surface, vertex));
    }
    for other in surface.mesh.neighbours(vertex).into_iter().filter(|other| wanted(*other)) {
        check_edge(surface, vertex, other)?;
    }
    Ok(())
}

fn check_edge(surface: &Surface, a: VertexRow, b: VertexRow) -> Result<(), Violation> {
    let mesh = &surface.mesh;
    let faces = mesh.faces_of_edge(a, b);
    if let [face] = faces[..] {
        return Err(Violation::LoneFace { a, b, face });
    }
    for (place, first) in faces.iter().enumerate() {
        let opposite = mesh.face(*first).opposite(a, b);
        if let Some(second) = faces[place + 1..].iter().find(|other| mesh.face(**other).has(opposite)) {
            return Err(Violation::Twins { first: *first, second: *second });
        }
    }
    match label_excess(surface, a, b, &faces).into_iter().find(|(_, excess)| *excess != 0) {
        Some((region, excess)) => Err(Violation::Unbalanced { a, b, region, excess, faces }),
        None => Ok(()),
    }
}

/// Per region at an edge: how much more often it is entered than left on a walk around the edge.
fn label_excess(surface: &Surface, a: VertexRow, b: VertexRow, faces: &[FaceRow]) -> SmallVec<[(Region, i32); 8]> {
    let mut excess: SmallVec<[(Region, i32); 8]> = SmallVec::new();
    for row in faces {
        let face = surface.mesh.face(*row);
        let [back, front] = face.labels();
        for (region, change) in [(back, face.direction(a, b)), (front, -face.direction(a, b))] {
            match excess.iter_mut().find(|(known, _)| *known == region) {
                Some((_, sum)) => *sum += change,
                None => excess.push((region, change)),
            }
        }
    }
    excess
}

fn check_finite(surface: &Surface, vertices: impl IntoIterator<Item = VertexRow>) -> Result<(), Violation> {
    let lost = vertices.into_iter().find(|v| !surface.positions[*v].is_finite());
    lost.map_or(Ok(()), |vertex| Err(Violation::NotFinite { vertex }))
}

/// Signs of volumes; those within `bound` (m^3) of zero are found anew, from nearby.
fn check_regions(surface: &Surface, volumes: &[f64], bound: f64, regions: &[Region]) -> Result<(), Violation> {
    for region in regions.iter().filter(|region| !surface.is_open(**region)) {
        let of_all = volumes[region.index()];
        // The sign of a speck is lost among the terms of a sum from a point far away.
        let volume = if of_all.abs() > bound { of_all } else { volume_from_nearby(surface, *region) };
        if !(volume > 0.0) {
            return Err(Violation::Volume { region: *region, volume });
        }
    }
    Ok(())
}

/// Volume of a region from a corner of its own, m^3.
fn volume_from_nearby(surface: &Surface, region: Region) -> f64 {
    let films = || surface.mesh.faces().filter(|(_, face)| face.borders(region));
    let origin = films().next().map_or(DVec3::ZERO, |(row, _)| surface.corners(row)[0]);
    let part = |(row, face): (FaceRow, &Face)| {
        let [a, b, c] = surface.corners(row).map(|x| x - origin);
        let part = a.dot(b.cross(c)) / 6.0;
        if face.labels()[0] == region { part } else { -part }
    };
    films().map(part).sum()
}

/// Most that [`Surface::volumes`] may err by rounding, m^3.
fn rounding_of_volumes(surface: &Surface) -> f64 {
    f64::EPSILON * surface.mesh.face_count() as f64 * gross_volume(surface)
}

/// Sum of bounds of the tetrahedra that [`Surface::volumes`] adds up: the scale of its rounding, m^3.
fn gross_volume(surface: &Surface) -> f64 {
    let origin = surface.mesh.vertices().next().map_or(DVec3::ZERO, |v| surface.positions[v]);
    let part = |row: FaceRow| {
        let [a, b, c] = surface.corners(row).map(|x| (x - origin).length());
        a * b * c
    };
    surface.mesh.faces().map(|(row, _)| part(row)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Face;
    use crate::shapes::double_bubble;
    use crate::surface::LabelledTriangles;
    use proptest::collection::vec;
    use proptest::prelude::{any, prop_assert, prop_assert_eq, proptest};

    /// Corners of two tetrahedra with `shared` corners in common.
    fn two_tetrahedra(shared: usize) -> LabelledTriangles {
        let mut set = LabelledTriangles::default();
        let first = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|x| set.add_vertex(x, false));
        add_tetrahedron(&mut set, first, 1);
        let mirrored = [DVec3::ZERO, DVec3::X, DVec3::Y, -DVec3::Z];
        let turned = [DVec3::ZERO, DVec3::X, -DVec3::Y, -DVec3::Z];
        let opposite = [DVec3::ZERO, -DVec3::X, -DVec3::Y, -DVec3::Z];
        let places = [mirrored, turned, opposite][3 - shared];
        let row = |k: usize, set: &mut LabelledTriangles| {
            if k < shared { first[k] } else { set.add_vertex(places[k], false) }
        };
        let second: [u32; 4] = std::array::from_fn(|k| row(k, &mut set));
        add_tetrahedron(&mut set, second, 2);
        set
    }

    fn add_tetrahedron(set: &mut LabelledTriangles, corners: [u32; 4], region: u32) {
        let [o, x, y, z] = corners.map(|v| set.positions[v as usize]);
        let is_right = (x - o).cross(y - o).dot(z - o) > 0.0;
        for [a, b, c] in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
            let labels = if is_right { [region, 0] } else { [0, region] };
            set.add_film([a, b, c].map(|k: usize| corners[k]), labels);
        }
    }

    /// Replaces two coincident faces of bubbles 1 and 2 by the wall between them.
    fn fuse(set: &mut LabelledTriangles) {
        let twin = set.triangles.len() - 4;
        for list in [twin, 0] {
            set.triangles.remove(list);
            set.labels.remove(list);
            set.ghosts.remove(list);
        }
        set.add_film([0, 2, 1], [1, 2]);
    }

    #[test]
    fn a_tetrahedron_holds() {
        let mut set = LabelledTriangles::default();
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|x| set.add_vertex(x, false));
        add_tetrahedron(&mut set, corners, 1);
        let surface = Surface::from_triangles(&set);
        assert_eq!(check_combinatorial(&surface), Ok(()));
        assert_eq!(check_volumes(&surface), Ok(()));
        assert!((surface.volumes()[1] - 1.0 / 6.0).abs() < 1e-15);
    }

    #[test]
    fn the_sign_of_a_speck_far_from_the_rest_is_found() {
        for (place, wrong) in (0..40).flat_map(|i| [(i, false), (i, true)]) {
            let mut set = LabelledTriangles::default();
            let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|x| set.add_vertex(x, false));
            add_tetrahedron(&mut set, corners, 1);
            let far = DVec3::new(4.1, 3.7 + 0.1 * f64::from(place), 2.3);
            let speck = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|x| set.add_vertex(far + 1e-6 * x, false));
            add_tetrahedron(&mut set, speck, 2);
            if wrong {
                set.labels[4..].iter_mut().for_each(|labels| labels.reverse());
            }
            let found = check_volumes(&Surface::from_triangles(&set));
            let expected = |violation| matches!(violation, Err(Violation::Volume { region: Region(2), .. }));
            assert!(if wrong { expected(found) } else { found == Ok(()) }, "{place} {wrong}");
        }
    }

    #[test]
    fn bubbles_that_share_a_vertex_or_an_edge_hold() {
        for shared in [1, 2] {
            let surface = Surface::from_triangles(&two_tetrahedra(shared));
            assert_eq!(check_combinatorial(&surface), Ok(()));
            assert_eq!(check_volumes(&surface), Ok(()));
        }
        let surface = Surface::from_triangles(&two_tetrahedra(2));
        assert_eq!(surface.mesh.faces_of_edge(VertexRow(0), VertexRow(1)).len(), 4);
    }

    #[test]
    fn bubbles_that_share_a_face_need_it_once() {
        let mut set = two_tetrahedra(3);
        let twins = check_combinatorial(&Surface::from_triangles(&set));
        assert!(matches!(twins, Err(Violation::Twins { .. })), "{twins:?}");
        fuse(&mut set);
        let surface = Surface::from_triangles(&set);
        assert_eq!(check_combinatorial(&surface), Ok(()));
        assert_eq!(check_volumes(&surface), Ok(()));
        assert_eq!(surface.mesh.faces_of_edge(VertexRow(0), VertexRow(1)).len(), 3);
    }

    #[test]
    fn a_missing_face_is_named_by_its_edge() {
        let mut set = two_tetrahedra(1);
        set.triangles.pop();
        set.labels.pop();
        set.ghosts.pop();
        let torn = check_combinatorial(&Surface::from_triangles(&set));
        assert!(matches!(torn, Err(Violation::LoneFace { .. })), "{torn:?}");
    }

    #[test]
    fn a_face_with_its_labels_swapped_is_unbalanced() {
        let mut set = two_tetrahedra(1);
        set.labels[0].reverse();
        let surface = Surface::from_triangles(&set);
        let found = check_combinatorial(&surface);
        assert!(matches!(found, Err(Violation::Unbalanced { excess: 2 | -2, .. })), "{found:?}");
        assert_eq!(check_combinatorial_around(&surface, &[VertexRow(0)]), found);
        assert_eq!(check_combinatorial_around(&surface, &[VertexRow(5)]), Ok(()), "vertex 5 is far from it");
    }

    #[test]
    fn equal_labels_and_repeated_vertices_are_found() {
        let mut set = two_tetrahedra(1);
        set.labels[2] = [1, 1];
        let found = check_combinatorial(&Surface::from_triangles(&set));
        assert_eq!(found, Err(Violation::SameLabels { face: FaceRow(2), region: Region(1) }));
        set.triangles[1] = [3, 1, 3];
        let found = check_combinatorial(&Surface::from_triangles(&set));
        assert_eq!(found, Err(Violation::RepeatedVertex { face: FaceRow(1), vertex: VertexRow(3) }));
    }

    #[test]
    fn a_bubble_inside_out_has_no_volume() {
        let mut set = two_tetrahedra(1);
        set.labels.iter_mut().filter(|labels| labels.contains(&2)).for_each(|labels| labels.reverse());
        let surface = Surface::from_triangles(&set);
        assert_eq!(check_combinatorial(&surface), Ok(()));
        let found = check_volumes(&surface);
        assert!(matches!(found, Err(Violation::Volume { region: Region(2), .. })), "{found:?}");
        let around = |v| check_volumes_around(&surface, &surface.volumes(), &[VertexRow(v)]);
        assert_eq!((around(1), around(5)), (Ok(()), found));
        set.open.push(2);
        assert_eq!(check_volumes(&Surface::from_triangles(&set)), Ok(()));
    }

    #[test]
    fn positions_must_be_numbers_and_as_many_as_rows() {
        let mut surface = Surface::from_triangles(&two_tetrahedra(1));
        surface.positions[VertexRow(3)].y = f64::NAN;
        assert_eq!(check_volumes(&surface), Err(Violation::NotFinite { vertex: VertexRow(3) }));
        surface.pinned.0.pop();
        let found = check_combinatorial(&surface);
        assert_eq!(found, Err(Violation::Length { what: "pins", values: 6, rows: 7 }));
    }

    #[test]
    fn checks_hold_after_deletion_and_compaction() {
        let mut surface = Surface::from_triangles(&two_tetrahedra(1));
        let second: Vec<FaceRow> = surface.mesh.faces().filter(|(_, f)| f.borders(Region(2))).map(|(r, _)| r).collect();
        for row in second {
            surface.mesh.remove_face(row);
        }
        assert_eq!(check_combinatorial(&surface), Ok(()));
        let remap = surface.compact();
        assert_eq!(check_combinatorial(&surface), Ok(()));
        assert_eq!((surface.mesh.vertex_rows(), surface.positions.len()), (4, 4));
        assert_eq!(remap.vertices.iter().flatten().count(), 4);
    }

    #[test]
    fn a_face_is_the_same_however_it_is_written() {
        let (vertices, labels) = ([7, 2, 5].map(VertexRow), [Region(3), Region(1)]);
        let face = Face::new(vertices, labels);
        let [a, b, c] = vertices;
        assert_eq!(face, Face::new([b, c, a], labels));
        assert_eq!(face, Face::new([b, a, c], [labels[1], labels[0]]));
        assert_ne!(face, Face::new([b, a, c], labels));
        assert_eq!((face.direction(a, b), face.direction(b, a)), (1, -1));
    }

    proptest! {
        #[test]
        fn a_surface_is_the_same_however_its_faces_are_written(choices in vec(0u8..6, 60..61)) {
            let set = double_bubble(DVec3::X, DVec3::Y, 1.0, 0.6, 0.5);
            let mut written = set.clone();
            for (face, choice) in choices.iter().cycle().enumerate().take(set.triangles.len()) {
                written.triangles[face].rotate_left(usize::from(choice % 3));
                if *choice > 2 {
                    written.triangles[face].swap(0, 1);
                    written.labels[face].reverse();
                }
            }
            let surface = Surface::from_triangles(&written);
            prop_assert_eq!(&surface, &Surface::from_triangles(&set));
            prop_assert_eq!(check_combinatorial(&surface), Ok(()));
        }

        #[test]
        fn any_one_spoilt_label_or_winding_is_found(place in 0usize..10_000, is_label in any::<bool>()) {
            let mut set = double_bubble(DVec3::X, DVec3::Y, 1.0, 0.6, 0.5);
            let face = place % set.triangles.len();
            if is_label {
                set.labels[face][place % 2] += 3;
            } else {
                set.triangles[face].swap(1, 2);
            }
            let surface = Surface::from_triangles(&set);
            let corners = surface.mesh.face(FaceRow(face as u32)).vertices();
            prop_assert!(check_combinatorial(&surface).is_err());
            prop_assert!(check_combinatorial_around(&surface, &corners[..1]).is_err());
        }
    }
}
