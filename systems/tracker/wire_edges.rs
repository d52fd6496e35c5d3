//! The edges of a film that a wire runs along, where the film has no rim on it.
//!
//! A wire holds a film only if no gap is between the vertices it holds: they must follow each other along edges. Chosen is the way
//! of least `sum of l (1 + 4 (d1^2 + d2^2) / L^2)`, edges of length `l` whose ends are at distances `d1` and `d2` from the wire:
//! once around for a closed wire, as far as it goes for an open one. It is found by relaxing all edges until none shortens a way
//! (Bellman 1958, Ford 1956).

use froth_components::authored::wire::WirePath;
use froth_surface::{Surface, VertexRow};

/// Vertices farther from the wire than this are not looked at, in edge lengths.
const WIDTH: f64 = 1.0;
/// How much dearer an edge is whose ends are an edge length off the wire: `1 + 2 * DETOUR` times.
const DETOUR: f64 = 4.0;

/// A vertex beside the wire.
struct Beside {
    vertex: VertexRow,
    /// Distance from the wire, metres.
    off: f64,
    /// Where along the wire, metres.
    along: f64,
}

/// An edge beside the wire, walked from one of its ends, places in the list of vertices.
struct Walk {
    from: usize,
    to: usize,
    cost: f64,
    /// Whether it passes the place where a closed wire begins, forwards (1) or backwards (-1).
    turns: i32,
}

/// The vertices that a wire takes hold of, among `vertices` that are free, one way for each connected piece of film beside the wire.
pub fn vertices_along(surface: &Surface, vertices: &[VertexRow], wire: &WirePath, edge: f64) -> Vec<VertexRow> {
    let beside = |vertex: &VertexRow| {
        let x = surface.positions[*vertex];
        Beside { vertex: *vertex, off: wire.nearest(x).distance(x), along: wire.along(x) }
    };
    let near: Vec<Beside> = vertices.iter().filter(|v| !surface.pinned[**v]).map(beside).collect();
    let near: Vec<Beside> = near.into_iter().filter(|at| at.off < WIDTH * edge).collect();
    let walks = walks(surface, &near, wire, edge);
    let mut held: Vec<usize> =
        pieces(near.len(), &walks).iter().flat_map(|piece| way(piece, &near, &walks, wire)).collect();
    held.sort_unstable();
    held.dedup();
    held.into_iter().map(|place| near[place].vertex).collect()
}

fn walks(surface: &Surface, near: &[Beside], wire: &WirePath, edge: f64) -> Vec<Walk> {
    let length = wire.length();
    let place = |v: VertexRow| near.binary_search_by_key(&v, |at| at.vertex).ok();
    let mut walks = Vec::new();
    for (from, a) in near.iter().enumerate() {
        for (to, b) in surface.mesh.neighbours(a.vertex).into_iter().filter_map(place).map(|to| (to, &near[to])) {
            let way = b.along - a.along;
            let turns = if wire.is_closed() { -(way / length).round() as i32 } else { 0 };
            let off = (a.off * a.off + b.off * b.off) / (edge * edge);
            let cost = surface.positions[a.vertex].distance(surface.positions[b.vertex]) * (1.0 + DETOUR * off);
            walks.push(Walk { from, to, cost, turns });
        }
    }
    walks
}

/// Connected pieces, each a list of places.
fn pieces(count: usize, walks: &[Walk]) -> Vec<Vec<usize>> {
    let mut piece: Vec<usize> = (0..count).collect();
    let mut changes = true;
    while changes {
        changes = false;
        for walk in walks {
            let least = piece[walk.from].min(piece[walk.to]);
            changes |= piece[walk.from] != least || piece[walk.to] != least;
            (piece[walk.from], piece[walk.to]) = (least, least);
        }
    }
    let members = |name: usize| (0..count).filter(|place| piece[*place] == name).collect::<Vec<usize>>();
    (0..count).filter(|name| piece[*name] == *name).map(members).collect()
}

/// The way along one piece: once around, or from its one end to the other.
fn way(piece: &[usize], near: &[Beside], walks: &[Walk], wire: &WirePath) -> Vec<usize> {
    let nearest_to = |along: f64| {
        let far = |place: &usize| (near[*place].along - along).abs() + near[*place].off;
        piece.iter().copied().min_by(|p, q| far(p).total_cmp(&far(q)))
    };
    if wire.is_closed() {
        // From opposite to where the wire begins, so that one turn is counted in the middle of the way.
        let start = nearest_to(0.5 * wire.length());
        if let Some(around) = start.and_then(|start| cheapest(start, (start, 1), near.len(), walks)) {
            return around;
        }
    }
    let (Some(start), Some(end)) = (nearest_to(0.0), nearest_to(wire.length())) else { return Vec::new() };
    cheapest(start, (end, 0), near.len(), walks).unwrap_or_default()
}

/// The cheapest way from a place to another with as many turns, 0 or 1; `None` where there is none.
fn cheapest(start: usize, end: (usize, i32), count: usize, walks: &[Walk]) -> Option<Vec<usize>> {
    let state = |place: usize, turns: i32| place + count * turns as usize;
    let mut costs = vec![f64::INFINITY; 2 * count];
    let mut before = vec![None; 2 * count];
    costs[state(start, 0)] = 0.0;
    let mut shortens = true;
    while shortens {
        shortens = false;
        for walk in walks {
            for turns in [0, 1].into_iter().filter(|turns| (0..=1).contains(&(turns + walk.turns))) {
                let (from, to) = (state(walk.from, turns), state(walk.to, turns + walk.turns));
                let cost = costs[from] + walk.cost;
                if cost < costs[to] {
                    (costs[to], before[to], shortens) = (cost, Some(from), true);
                }
            }
        }
    }
    let last = state(end.0, end.1);
    let way = std::iter::successors(costs[last].is_finite().then_some(last), |at| before[*at]);
    let way: Vec<usize> = way.map(|at| at % count).collect();
    (!way.is_empty()).then_some(way)
}

#[cfg(test)]
mod tests {
    use froth_surface::shapes::icosphere;
    use glam::DVec3;

    use super::*;
    use crate::tracker::wires::read_path;

    fn along(text: &str, edge: f64) -> (Surface, Vec<VertexRow>) {
        let surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, edge));
        let vertices: Vec<VertexRow> = surface.mesh.vertices().collect();
        let held = vertices_along(&surface, &vertices, &read_path(text), edge);
        (surface, held)
    }

    fn held_neighbours(surface: &Surface, held: &[VertexRow], of: VertexRow) -> usize {
        surface.mesh.neighbours(of).iter().filter(|v| held.contains(v)).count()
    }

    #[test]
    fn a_ring_takes_hold_of_a_closed_loop_of_edges() {
        for height in [0.0, 0.3, 0.77] {
            let radius = (1.0_f64 - height * height).sqrt();
            let (surface, held) = along(&format!("Ring(centre: (0, {height}, 0), radius: {radius})"), 0.12);
            assert!(held.iter().all(|v| held_neighbours(&surface, &held, *v) >= 2), "{height}");
            let least = std::f64::consts::TAU * radius / 0.12;
            assert!(held.len() as f64 > 0.7 * least && (held.len() as f64) < 1.5 * least, "{height}: {}", held.len());
        }
    }

    #[test]
    fn a_straight_wire_takes_hold_of_edges_from_end_to_end() {
        let (surface, held) = along("Line(points: [(-0.3, 0, 0.97), (0.3, 0, 0.97)])", 0.1);
        let ends = held.iter().filter(|v| held_neighbours(&surface, &held, **v) == 1).count();
        assert!(held.len() >= 5 && ends == 2, "{} with {ends} ends", held.len());
    }
}
