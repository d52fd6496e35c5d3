//! Datafiles of the Surface Evolver (Brakke 1992), an independent program that minimises area at given volumes.
//!
//! ```text
//! here                                      in the datafile
//! film between two regions                  face of tension 1: the energy is the area
//! ghost                                     fixed face of tension 0: bounds bodies, has no energy
//! region with a volume                      body of the same number, with that volume
//! outside and open regions                  nothing
//! pinned vertex                             fixed vertex
//! edge of a wire                            fixed edge, so that refinement keeps its middle
//! back and front region of a face           a body lists the face as +f if it is at the back, as -f if at the front:
//!                                           a face counts positive where its normal points out of the body
//! ```
//!
//! Elements have the numbers of their rows plus one. [`minimise`] runs the program, where it is installed.

mod program;

use std::fmt::{self, Write};

use glam::DVec3;

use crate::mesh::Face;
use crate::rows::{FaceRow, Region, VertexRow};
use crate::surface::Surface;

pub use program::{Body, EvolverError, Minimum, minimise};

/// The datafile of a surface, in which every closed region is a body.
///
/// `volumes` are those that the minimum is to have, in m^3 (the cube of the positions' unit); a closed region that is not
/// listed keeps the volume it has. Listed regions that are open or do not occur are passed over.
///
/// The same surface gives the same text, with numbers that read back exactly.
///
/// # Limits
/// A surface does not say which of its edges lie on a wire. An edge between two pinned vertices is taken for one, unless
/// it lies inside a film: between exactly two faces that are no ghosts. Where a wire passes through a film that goes on
/// behind it, refinement frees the wire between the pinned vertices.
#[must_use]
pub fn datafile(surface: &Surface, volumes: &[(Region, f64)]) -> String {
    let mut text = String::new();
    write_datafile(&mut text, surface, volumes).expect("invariant: writing to a string does not fail");
    text
}

fn write_datafile(text: &mut String, surface: &Surface, volumes: &[(Region, f64)]) -> fmt::Result {
    let edges = surface.mesh.edges();
    writeln!(text, "// Films of tension 1: the energy is their area.")?;
    write_vertices(text, surface)?;
    write_edges(text, surface, &edges)?;
    write_faces(text, surface, &edges)?;
    write_bodies(text, surface, volumes)
}

fn write_vertices(text: &mut String, surface: &Surface) -> fmt::Result {
    writeln!(text, "vertices")?;
    for vertex in surface.mesh.vertices() {
        let DVec3 { x, y, z } = surface.positions[vertex];
        let fixed = if surface.pinned[vertex] { " fixed" } else { "" };
        // The debug form is the shortest that reads back exactly, with a point or a short exponent.
        writeln!(text, "{} {x:?} {y:?} {z:?}{fixed}", vertex.0 + 1)?;
    }
    Ok(())
}

fn write_edges(text: &mut String, surface: &Surface, edges: &[[VertexRow; 2]]) -> fmt::Result {
    writeln!(text, "edges")?;
    for (number, [a, b]) in (1..).zip(edges) {
        let fixed = if is_on_wire(surface, *a, *b) { " fixed" } else { "" };
        writeln!(text, "{number} {} {}{fixed}", a.0 + 1, b.0 + 1)?;
    }
    Ok(())
}

/// Whether an edge lies on a wire, as far as the surface says: see [`datafile`].
fn is_on_wire(surface: &Surface, a: VertexRow, b: VertexRow) -> bool {
    let faces = surface.mesh.faces_of_edge(a, b);
    let is_inside_film = faces.len() == 2 && faces.iter().all(|face| !surface.mesh.face(*face).is_ghost());
    surface.pinned[a] && surface.pinned[b] && !is_inside_film
}

fn write_faces(text: &mut String, surface: &Surface, edges: &[[VertexRow; 2]]) -> fmt::Result {
    writeln!(text, "faces")?;
    for (row, face) in surface.mesh.faces() {
        let [ab, bc, ac] = edge_numbers(face, edges);
        let ghost = if face.is_ghost() { " tension 0 fixed" } else { "" };
        // Vertices and edges both ascend: the way round is along ab and bc, and back along ac.
        writeln!(text, "{} {ab} {bc} -{ac}{ghost}", row.0 + 1)?;
    }
    Ok(())
}

/// Numbers of the edges `ab`, `bc` and `ac` of a face `abc`.
fn edge_numbers(face: &Face, edges: &[[VertexRow; 2]]) -> [usize; 3] {
    let [a, b, c] = face.vertices();
    [[a, b], [b, c], [a, c]].map(|edge| 1 + edges.binary_search(&edge).expect("invariant: a face has its edges"))
}

fn write_bodies(text: &mut String, surface: &Surface, volumes: &[(Region, f64)]) -> fmt::Result {
    let present = surface.volumes();
    let closed: Vec<Region> = surface.mesh.regions().into_iter().filter(|r| !surface.is_open(*r)).collect();
    if !closed.is_empty() {
        writeln!(text, "bodies")?;
    }
    for region in closed {
        write!(text, "{}", region.0)?;
        for (row, face) in surface.mesh.faces() {
            write_side(text, row, face, region)?;
        }
        let wanted = volumes.iter().find(|(listed, _)| *listed == region);
        let volume = wanted.map_or(present[region.index()], |(_, volume)| *volume);
        writeln!(text, " volume {volume:?}")?;
    }
    Ok(())
}

/// The face in the list of a body, with the sign of its normal; nothing where the region is on both sides or on none.
fn write_side(text: &mut String, row: FaceRow, face: &Face, region: Region) -> fmt::Result {
    let [back, front] = face.labels();
    match (back == region, front == region) {
        (true, false) => write!(text, " {}", row.0 + 1),
        (false, true) => write!(text, " -{}", row.0 + 1),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::LabelledTriangles;

    /// A tetrahedron of region 1, with its outward faces as given; its volume is `size^3 / 6`.
    fn tetrahedron(size: f64) -> LabelledTriangles {
        let mut triangles = LabelledTriangles::default();
        for corner in [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z] {
            triangles.add_vertex(size * corner, false);
        }
        for vertices in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
            triangles.add_film(vertices, [1, 0]);
        }
        triangles
    }

    /// What the program finds; `None`, with a message, where it is not installed.
    #[expect(clippy::print_stderr, reason = "a test that is skipped says so")]
    fn found(datafile: &str, commands: &str) -> Option<Minimum> {
        let found = minimise(datafile, commands).unwrap();
        if found.is_none() {
            eprintln!("skipped: the Surface Evolver is not installed (Debian package evolver-nox)");
        }
        found
    }

    #[test]
    fn a_bubble_becomes_a_body_of_its_outward_faces() {
        let surface = Surface::from_triangles(&tetrahedron(0.1));
        let text = datafile(&surface, &[(Region(1), 2e-4)]);
        let expected = "// Films of tension 1: the energy is their area.\n\
            vertices\n1 0.0 0.0 0.0\n2 0.1 0.0 0.0\n3 0.0 0.1 0.0\n4 0.0 0.0 0.1\n\
            edges\n1 1 2\n2 1 3\n3 1 4\n4 2 3\n5 2 4\n6 3 4\n\
            faces\n1 1 4 -2\n2 1 5 -3\n3 2 6 -3\n4 4 6 -5\n\
            bodies\n1 -1 2 -3 4 volume 0.0002\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn a_region_that_is_not_listed_keeps_its_volume() {
        let text = datafile(&Surface::from_triangles(&tetrahedron(1.0)), &[(Region(7), 3.0)]);
        assert!(text.ends_with(&format!(" volume {:?}\n", 1.0 / 6.0)), "{text}");
    }

    #[test]
    fn ghosts_are_fixed_without_tension_and_open_regions_are_no_bodies() {
        let mut triangles = tetrahedron(1.0);
        triangles.pinned[..3].fill(true);
        triangles.ghosts[0] = true;
        triangles.open = vec![1];
        let text = datafile(&Surface::from_triangles(&triangles), &[(Region(1), 1.0)]);
        assert!(text.contains("\n3 0.0 1.0 0.0 fixed\n4 0.0 0.0 1.0\n"), "{text}");
        assert!(text.contains("edges\n1 1 2 fixed\n2 1 3 fixed\n3 1 4\n4 2 3 fixed\n5 2 4\n6 3 4\n"), "{text}");
        assert!(text.contains("faces\n1 1 4 -2 tension 0 fixed\n2 1 5 -3\n"), "{text}");
        assert!(!text.contains("bodies"), "{text}");
    }

    #[test]
    fn an_edge_inside_a_film_is_no_wire_although_both_its_ends_are_pinned() {
        let mut triangles = tetrahedron(1.0);
        triangles.pinned.fill(true);
        let text = datafile(&Surface::from_triangles(&triangles), &[]);
        assert!(text.contains("edges\n1 1 2\n2 1 3\n"), "{text}");
    }

    #[test]
    fn a_vacant_row_leaves_a_gap_in_the_numbers() {
        let mut triangles = tetrahedron(1.0);
        triangles.append(&tetrahedron(2.0));
        let mut surface = Surface::from_triangles(&triangles);
        for row in 0..4 {
            surface.mesh.remove_face(FaceRow(row));
        }
        let text = datafile(&surface, &[]);
        assert!(text.contains("vertices\n5 0.0 0.0 0.0\n"), "{text}");
        assert!(text.contains("bodies\n2 -5 6 -7 8 volume "), "{text}");
    }

    #[test]
    fn the_program_sees_the_areas_and_volumes_that_are_here() {
        for size in [1e-6, 1.0, 1e6] {
            let mut triangles = tetrahedron(size);
            triangles.add_vertex(DVec3::splat(size), false);
            for vertices in [[1, 2, 4], [2, 3, 4], [3, 1, 4]] {
                triangles.add_film(vertices, [2, 0]);
            }
            triangles.labels[3] = [1, 2];
            let surface = Surface::from_triangles(&triangles);
            let Some(seen) = found(&datafile(&surface, &[]), "") else {
                return;
            };
            let is_close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
            assert!(is_close(seen.area, surface.film_area()), "{} against {}", seen.area, surface.film_area());
            for (region, volume) in [(Region(1), surface.volumes()[1]), (Region(2), surface.volumes()[2])] {
                let body = seen.body(region).unwrap();
                assert!(is_close(body.volume, volume), "{} against {volume}", body.volume);
            }
        }
    }

    #[test]
    fn a_bubble_relaxes_to_a_sphere_at_any_scale() {
        for size in [1e-6, 1.0, 1e6] {
            let surface = Surface::from_triangles(&tetrahedron(size));
            let wanted = size.powi(3);
            let commands = "r; g 20; r; V; g 20; r; V; u; g 20; M 2; hessian; hessian;";
            let Some(sphere) = found(&datafile(&surface, &[(Region(1), wanted)]), commands) else {
                return;
            };
            let radius = (wanted * 3.0 / (4.0 * std::f64::consts::PI)).cbrt();
            let body = sphere.body(Region(1)).unwrap();
            // Quadratic elements of a quarter of the radius: fourth order.
            assert!((body.volume / wanted - 1.0).abs() < 1e-9, "{} against {wanted}", body.volume);
            assert!((body.pressure * radius / 2.0 - 1.0).abs() < 4e-3, "{}", body.pressure * radius);
            assert!((sphere.area * radius / (3.0 * wanted) - 1.0).abs() < 4e-3, "{}", sphere.area);
        }
    }
}
