//! The standard triple and quadruple bubble of equal radii.
//!
//! Outer spheres of radius `R` about the corners of a regular triangle or tetrahedron of side `R`: two of them cut at 120
//! degrees with the flat wall between, three with four borders at `arccos(-1/3)`. Every film, border and corner is the set
//! of points with equal distances to the centres of its bubbles, cut by the spheres where it touches the outside: vertices
//! lie on it exactly. At rest `2 A = 3 sum(p V)` with the pressure `p = 2 / R` per unit of tension, so `A = 3 / R * sum(V)`.
//!
//! Clusters of unequal radii are images of these under inversion in a sphere; they are not made here.
//! Source: Plateau 1873; Wichiramala 2004 (triple), Milman and Neeman 2022 (least area up to four bubbles).

use glam::DVec3;

use super::fairing::even_out;
use super::wired::WiredFilms;
use crate::surface::LabelledTriangles;

/// Three equal bubbles about the line through `centre` along `axis`; outer radius and edge in metres.
///
/// Two quadruple points on the axis at `+-sqrt(2/3) R`, and four borders between them.
#[must_use]
pub fn triple_bubble(centre: DVec3, axis: DVec3, radius: f64, edge: f64) -> LabelledTriangles {
    let axis = axis.normalize_or(DVec3::Z);
    let (u, v) = axis.any_orthonormal_pair();
    let centres = [0.0, 1.0, 2.0].map(|k| {
        let angle = std::f64::consts::TAU * k / 3.0;
        (angle.cos() * u + angle.sin() * v) / 3f64.sqrt()
    });
    let cluster = Cluster { centres: centres.to_vec() };
    let mut set = LabelledTriangles::default();
    let middle = set.add_vertex(DVec3::ZERO, false);
    let ends = [axis, -axis].map(|x| cluster.corner(&mut set, x, &[0, 1, 2, 3]));
    for [i, j] in [[1, 2], [1, 3], [2, 3]] {
        cluster.add_border(&mut set, [i, j], ends, middle);
    }
    cluster.finish(set, centre, radius, edge)
}

/// Four equal bubbles about `centre`; outer radius and edge in metres. Five quadruple points, ten borders.
#[must_use]
pub fn quadruple_bubble(centre: DVec3, radius: f64, edge: f64) -> LabelledTriangles {
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let cluster = Cluster { centres: corners.map(|x| DVec3::from(x) / 8f64.sqrt()).to_vec() };
    let mut set = LabelledTriangles::default();
    let middle = set.add_vertex(DVec3::ZERO, false);
    let others = |left_out: u32| -> Vec<u32> { (0..=4).filter(|k| *k != left_out).collect() };
    let tips: Vec<u32> =
        (1..=4).map(|k| cluster.corner(&mut set, -cluster.centres[k as usize - 1], &others(k))).collect();
    for i in 1..=4 {
        for j in i + 1..=4 {
            let ends: Vec<u32> = (1..=4).filter(|k| *k != i && *k != j).map(|k| tips[k as usize - 1]).collect();
            cluster.add_border(&mut set, [i, j], [ends[0], ends[1]], middle);
        }
    }
    cluster.finish(set, centre, radius, edge)
}

/// Centres of unit spheres, all at distance 1 from each other.
struct Cluster {
    centres: Vec<DVec3>,
}

impl Cluster {
    /// The nearest point, along the way from the middle of their bubbles, that these regions share.
    fn snap(&self, place: DVec3, regions: &[u32]) -> DVec3 {
        let bubbles = regions.iter().filter(|region| **region != 0);
        let members: Vec<DVec3> = bubbles.map(|region| self.centres[*region as usize - 1]).collect();
        let middle = members.iter().sum::<DVec3>() / members.len() as f64;
        let mut across: Vec<DVec3> = Vec::new();
        let mut way = place - middle;
        for member in &members[1..] {
            let axis = across.iter().fold(*member - members[0], |axis, other| axis.reject_from_normalized(*other));
            across.push(axis.normalize());
            way = way.reject_from_normalized(across[across.len() - 1]);
        }
        if regions[0] == 0 {
            let reach = (1.0 - members[0].distance_squared(middle)).sqrt();
            way = reach * way.normalize();
        }
        middle + way
    }

    fn corner(&self, set: &mut LabelledTriangles, place: DVec3, regions: &[u32]) -> u32 {
        set.add_vertex(self.snap(place, regions), false)
    }

    /// Adds the wall of two bubbles, from the middle to their border with the outside, and what their caps have of it.
    fn add_border(&self, set: &mut LabelledTriangles, [i, j]: [u32; 2], ends: [u32; 2], middle: u32) {
        let outer = [0, i, j];
        let [from, to] = ends.map(|v| set.positions[v as usize]);
        let half = self.snap(2.0 * (self.centres[i as usize - 1] + self.centres[j as usize - 1]), &outer);
        // As many pieces as keep the angles at the middle, 180 or 109 degrees of a wall, near 50 degrees.
        let places =
            if self.centres.len() == 3 { vec![from.midpoint(half), half, half.midpoint(to)] } else { vec![half] };
        let mut path = vec![ends[0]];
        path.extend(places.into_iter().map(|place| self.corner(set, place, &outer)));
        path.push(ends[1]);
        let poles = [i, j].map(|bubble| self.pole(set, bubble));
        for pair in path.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            let towards = self.centres[j as usize - 1] - self.centres[i as usize - 1];
            add_facing(set, [middle, a, b], [i, j], towards);
            for (bubble, pole) in [i, j].into_iter().zip(poles) {
                let outwards = set.positions[a as usize] - self.centres[bubble as usize - 1];
                add_facing(set, [pole, a, b], [bubble, 0], outwards);
            }
        }
    }

    /// Row of the point of a bubble farthest from the middle, added when first asked for.
    fn pole(&self, set: &mut LabelledTriangles, bubble: u32) -> u32 {
        let place = self.snap(2.0 * self.centres[bubble as usize - 1], &[0, bubble]);
        match set.positions.iter().position(|x| *x == place) {
            Some(row) => row as u32,
            None => set.add_vertex(place, false),
        }
    }

    fn finish(&self, set: LabelledTriangles, centre: DVec3, radius: f64, edge: f64) -> LabelledTriangles {
        let snap = |x: DVec3, regions: &[u32]| self.snap(x, regions);
        let mut films = WiredFilms::new(set);
        films.refine_onto(1.15 * edge / radius, snap);
        let mut set = films.set;
        even_out(&mut set, 4, snap);
        set.positions.iter_mut().for_each(|x| *x = centre + radius * *x);
        set
    }
}

/// Adds a film with its normal on the side of a direction.
fn add_facing(set: &mut LabelledTriangles, [a, b, c]: [u32; 3], labels: [u32; 2], direction: DVec3) {
    let [p, q, r] = [a, b, c].map(|v| set.positions[v as usize]);
    let is_facing = (q - p).cross(r - p).dot(direction) > 0.0;
    set.add_film(if is_facing { [a, b, c] } else { [a, c, b] }, labels);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::measure::{checked, edge_lengths, smallest_angle};
    use crate::surface::Surface;

    fn quadruple_points(surface: &Surface) -> usize {
        surface.mesh.vertices().filter(|v| surface.mesh.regions_of(*v).len() == 4).count()
    }

    /// `A R / (3 sum V) - 1`, zero at rest.
    fn virial(surface: &Surface, radius: f64) -> f64 {
        surface.film_area() * radius / (-3.0 * surface.volumes()[0]) - 1.0
    }

    #[test]
    fn clusters_are_at_rest_and_converge_at_second_order() {
        let triple = [0.16, 0.08, 0.04].map(|edge| {
            let set = triple_bubble(DVec3::X, DVec3::new(0.0, 1.0, 1.0), 2.0, 2.0 * edge);
            virial(&checked(&set), 2.0)
        });
        let quadruple =
            [0.2, 0.1, 0.05].map(|edge| virial(&checked(&quadruple_bubble(DVec3::X, 2.0, 2.0 * edge)), 2.0));
        for errors in [triple, quadruple] {
            // Second order would be 16; triangles are not similar from size to size.
            assert!(errors[0] / errors[2] > 10.0 && errors[2].abs() < 2e-3, "{errors:?}");
        }
    }

    #[test]
    fn bubbles_are_equal_and_triangles_even() {
        for (set, points) in
            [(triple_bubble(DVec3::ZERO, DVec3::Z, 1.0, 0.1), 2), (quadruple_bubble(DVec3::ZERO, 1.0, 0.1), 5)]
        {
            let surface = checked(&set);
            let volumes = surface.volumes();
            assert!(volumes[1..].iter().all(|volume| (volume / volumes[1] - 1.0).abs() < 1e-3), "{volumes:?}");
            assert_eq!(quadruple_points(&surface), points);
            assert!(smallest_angle(&set) > 25.0, "{}", smallest_angle(&set));
            let [shortest, mean, longest] = edge_lengths(&set);
            assert!((mean / 0.1 - 1.0).abs() < 0.1 && longest < 0.2 && shortest > 0.03, "{shortest} {mean} {longest}");
        }
    }

    #[test]
    fn outer_vertices_lie_on_the_spheres() {
        let set = quadruple_bubble(DVec3::ZERO, 1.0, 0.2);
        let centres = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
        for (triangle, labels) in set.triangles.iter().zip(&set.labels).filter(|(_, labels)| labels[1] == 0) {
            let middle = DVec3::from(centres[labels[0] as usize - 1]) / 8f64.sqrt();
            assert!(triangle.iter().all(|v| (set.positions[*v as usize].distance(middle) - 1.0).abs() < 1e-14));
        }
    }
}
