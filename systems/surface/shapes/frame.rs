//! Plateau's wire frames: films of the right topology to begin with.
//!
//! Every face of a frame has a pocket of air behind it, an open region, which ghosts close over the face: from its wires to a
//! held vertex a quarter of a wire outside it, where no film comes. Films are flat; the tetrahedron is at rest, the others
//! are not.

use glam::DVec3;

use super::wired::WiredFilms;
use crate::surface::LabelledTriangles;

/// A wire frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// Six films from the wires to the centre, the exact minimum: area `3 / (2 sqrt 2)` for wires of length 1.
    Tetrahedron,
    /// Twelve films from the wires to a small square in the middle of side 0.2: their minimum is below the cone's `3 sqrt 2`.
    Cube,
    /// Twelve films from the wires to the centre: area 3, which films beat once their topology changes.
    Octahedron,
}

/// Side of the square in the middle of a cube frame, in wires.
const SQUARE: f64 = 0.2;
/// Distance of the tip of a lid from its face, in wires.
const LID: f64 = 0.25;

/// Films on a frame with wires of length `wire` (metres), refined to `edge`; wires are held, regions 1 and up are open.
#[must_use]
pub fn frame(kind: Frame, centre: DVec3, wire: f64, edge: f64) -> LabelledTriangles {
    let mut films = match kind {
        Frame::Tetrahedron => cone(&TETRAHEDRON, &TETRAHEDRON_FACES, 0.125f64.sqrt()),
        Frame::Octahedron => cone(&OCTAHEDRON, &OCTAHEDRON_FACES, 0.5f64.sqrt()),
        Frame::Cube => cube(),
    };
    films.set.positions.iter_mut().for_each(|x| *x = centre + wire * *x);
    films.refine(edge);
    films.set
}

const TETRAHEDRON: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
const TETRAHEDRON_FACES: [&[u32]; 4] = [&[0, 1, 2], &[0, 3, 1], &[0, 2, 3], &[1, 3, 2]];
const OCTAHEDRON: [[f64; 3]; 6] =
    [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
const OCTAHEDRON_FACES: [&[u32]; 8] =
    [&[0, 2, 4], &[2, 1, 4], &[1, 3, 4], &[3, 0, 4], &[2, 0, 5], &[1, 2, 5], &[3, 1, 5], &[0, 3, 5]];
/// Corners of the cube: bit 0 is x, bit 1 is y, bit 2 is z.
const CUBE_FACES: [&[u32]; 6] =
    [&[0, 4, 6, 2], &[1, 3, 7, 5], &[0, 1, 5, 4], &[2, 6, 7, 3], &[0, 2, 3, 1], &[4, 5, 7, 6]];

/// Films from every wire to the centre.
fn cone(corners: &[[f64; 3]], faces: &[&[u32]], scale: f64) -> WiredFilms {
    let mut films = wires_and_lids(corners.iter().map(|x| scale * DVec3::from(*x)), faces);
    let middle = films.set.add_vertex(DVec3::ZERO, false);
    for [a, b, left, right] in wires_of(faces) {
        films.set.add_film([a, b, middle], [left, right]);
    }
    films
}

/// Films from every wire to a square in the plane z = 0.
///
/// ```text
///      s---t         a, b   ends of a wire, m its middle
///     /|   |\        s, t   corners of the square that they lead to; one and the same for the four wires along z
///    p-+-n-+-q       p, q   middles of the ways there
///   /  \ | /  \
///  a-----m-----b
/// ```
fn cube() -> WiredFilms {
    let corner = |k: u32| DVec3::from([0, 1, 2].map(|axis| f64::from(k >> axis & 1) - 0.5));
    let mut films = wires_and_lids((0..8).map(corner), &CUBE_FACES);
    let tip = |k: u32| (SQUARE * corner(k)).with_z(0.0);
    let square: [u32; 4] = std::array::from_fn(|k| films.set.add_vertex(tip(k as u32), false));
    let halfway: [u32; 8] = std::array::from_fn(|k| {
        let k = k as u32;
        films.set.add_vertex(corner(k).midpoint(tip(k)), false)
    });
    for [a, b, left, right] in wires_of(&CUBE_FACES) {
        let m = films.halve(a, b);
        let [p, q] = [a, b].map(|k| halfway[k as usize]);
        let [s, t] = [a, b].map(|k| square[k as usize % 4]);
        let near = [[a, m, p], [m, b, q]];
        let far = if s == t {
            vec![[m, q, p], [p, q, s]]
        } else {
            let n =
                films.set.add_vertex(films.set.positions[p as usize].midpoint(films.set.positions[q as usize]), false);
            vec![[m, n, p], [m, q, n], [p, n, s], [n, q, t], [n, t, s]]
        };
        near.into_iter().chain(far).for_each(|triangle| films.set.add_film(triangle, [left, right]));
    }
    // Region 5 lies under the square, region 6 over it.
    films.set.add_film([square[0], square[1], square[3]], [5, 6]);
    films.set.add_film([square[0], square[3], square[2]], [5, 6]);
    films
}

/// The wires of a frame, and ghosts over its faces, which run counter-clockwise seen from outside; face `k` has region `k + 1`.
fn wires_and_lids(corners: impl Iterator<Item = DVec3>, faces: &[&[u32]]) -> WiredFilms {
    let mut films = WiredFilms::default();
    for x in corners {
        films.set.add_vertex(x, true);
    }
    for (face, region) in faces.iter().zip(1..) {
        let place = |v: u32| films.set.positions[v as usize];
        let middle = face.iter().map(|v| place(*v)).sum::<DVec3>() / face.len() as f64;
        let apex = films.set.add_vertex(middle + LID * middle.normalize(), true);
        for (a, b) in edges_of(face) {
            films.set.add_face([a, b, apex], [region, 0], true);
            films.add_wire(a, b);
        }
        films.set.open.push(region);
    }
    films
}

/// Each wire once, with the regions behind and before a film from it, `(a, b, middle)`.
fn wires_of(faces: &[&[u32]]) -> Vec<[u32; 4]> {
    let directed = faces.iter().zip(1..).flat_map(|(face, region)| edges_of(face).map(move |edge| (edge, region)));
    let directed: Vec<((u32, u32), u32)> = directed.collect();
    let other = |a: u32, b: u32| directed.iter().find(|(edge, _)| *edge == (b, a)).map(|(_, region)| *region);
    let once = directed.iter().filter(|((a, b), _)| a < b);
    // Seen from outside, the face whose loop has a -> b is on the left of it: the film's normal points away from it.
    once.filter_map(|((a, b), region)| Some([*a, *b, other(*a, *b)?, *region])).collect()
}

fn edges_of(face: &[u32]) -> impl Iterator<Item = (u32, u32)> + '_ {
    (0..face.len()).map(|k| (face[k], face[(k + 1) % face.len()]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::measure::{checked, edge_lengths, smallest_angle};

    #[test]
    fn the_cones_have_their_closed_areas() {
        for (kind, regions, area) in [(Frame::Tetrahedron, 4, 1.060_660_171_779_821), (Frame::Octahedron, 8, 3.0)] {
            let set = frame(kind, DVec3::new(1.0, 2.0, 3.0), 2.0, 0.2);
            let surface = checked(&set);
            assert!((surface.film_area() - 4.0 * area).abs() < 1e-12, "{kind:?} {}", surface.film_area());
            assert_eq!(surface.open.len(), regions);
            assert!(edge_lengths(&set)[2] <= 0.26);
        }
    }

    #[test]
    fn the_films_of_a_cube_frame_have_a_square_in_the_middle() {
        let set = frame(Frame::Cube, DVec3::ZERO, 1.0, 0.08);
        let area = checked(&set).film_area();
        let exact = 0.04 + 4.0 * 0.5 * 0.4 * 2f64.sqrt() + 8.0 * 0.6 * 0.5f64.hypot(0.4);
        assert!((area - exact).abs() < 1e-12, "{area}");
        let free: Vec<_> = set.positions.iter().zip(&set.pinned).filter(|(_, pinned)| !**pinned).collect();
        assert!(free.iter().all(|(x, _)| x.abs().max_element() < 0.5), "no free vertex lies on a face of the frame");
    }

    #[test]
    fn angles_stay_wide_and_every_pocket_has_air() {
        for kind in [Frame::Tetrahedron, Frame::Cube, Frame::Octahedron] {
            let set = frame(kind, DVec3::ZERO, 1.0, 0.1);
            let surface = checked(&set);
            assert!(smallest_angle(&set) > 24.0, "{kind:?}: {}", smallest_angle(&set));
            assert!(surface.volumes()[1..].iter().all(|volume| *volume > 0.0), "{kind:?}: {:?}", surface.volumes());
        }
    }
}
