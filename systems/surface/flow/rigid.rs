//! Gives back to free clusters the momentum that the removal of tangential forces takes.
//!
//! # Equation
//! The tangential parts of tension do not add up to zero on a mesh: without them a free bubble would be pushed and turned by
//! forces of the order of the mesh's error, for ever. For every cluster of films that no wire holds, the sum `R` of what was
//! removed and its torque `Q` about the centre are spread as a rigid acceleration: `m_v (R / m + (I⁻¹ Q) x r_v)`, with `I`
//! the inertia. Forces and torques of tension then add up to zero again.

use glam::{DMat3, DVec3};

use crate::calculus::Incidence;
use crate::links::free_clusters;

/// A cluster of films that nothing holds.
#[derive(Clone, Copy, Debug)]
struct Cluster {
    weight: f64,
    centre: DVec3,
    inertia: DMat3,
    force: DVec3,
    torque: DVec3,
    linear: DVec3,
    angular: DVec3,
}

impl Cluster {
    const EMPTY: Self = Self {
        weight: 0.0,
        centre: DVec3::ZERO,
        inertia: DMat3::ZERO,
        force: DVec3::ZERO,
        torque: DVec3::ZERO,
        linear: DVec3::ZERO,
        angular: DVec3::ZERO,
    };

    /// Accelerations from the sums; none where there is no weight, no turning about a line.
    fn settle(&mut self) {
        self.linear = if self.weight > 0.0 { self.force / self.weight } else { DVec3::ZERO };
        // In units of its own size, so that the test for a line has no unit.
        let size = (self.inertia.x_axis.x + self.inertia.y_axis.y + self.inertia.z_axis.z) / 3.0;
        let scaled = self.inertia * (1.0 / size);
        let can_turn = size > 0.0 && scaled.determinant() > 1e-9;
        self.angular = if can_turn { scaled.inverse() * (self.torque / size) } else { DVec3::ZERO };
    }

    fn acceleration(&self, position: DVec3) -> DVec3 {
        self.linear + self.angular.cross(position - self.centre)
    }
}

/// Free clusters of a mesh.
#[derive(Clone, Debug, Default)]
pub struct FreeClusters {
    /// Per vertex, its cluster if it has one.
    cluster_of: Vec<Option<u32>>,
    clusters: Vec<Cluster>,
}

impl FreeClusters {
    /// Finds them: sets of vertices that films connect, none of them held.
    pub fn rebuild(&mut self, incidence: &Incidence, pinned: &[bool]) {
        let corners = incidence.films().iter().map(|film| film.corners);
        let free = free_clusters(incidence.vertex_rows(), corners, |v| pinned[v]);
        self.clusters.clear();
        self.clusters.resize(free.count, Cluster::EMPTY);
        self.cluster_of = free.of_vertex;
    }

    /// Spreads over the clusters what is in `removed` (N per vertex), weighted by `metric`.
    pub fn give_back(&mut self, positions: &[DVec3], metric: &[f64], removed: &[DVec3], forces: &mut [DVec3]) {
        self.clusters.fill(Cluster::EMPTY);
        for (v, cluster) in members(&self.cluster_of) {
            let cluster = &mut self.clusters[cluster];
            cluster.weight += metric[v];
            cluster.centre += positions[v] * metric[v];
            cluster.force += removed[v];
        }
        for cluster in self.clusters.iter_mut().filter(|cluster| cluster.weight > 0.0) {
            cluster.centre /= cluster.weight;
        }
        for (v, cluster) in members(&self.cluster_of) {
            let cluster = &mut self.clusters[cluster];
            let arm = positions[v] - cluster.centre;
            cluster.inertia += inertia(arm) * metric[v];
            cluster.torque += arm.cross(removed[v]);
        }
        self.clusters.iter_mut().for_each(Cluster::settle);
        for (v, cluster) in members(&self.cluster_of) {
            forces[v] += self.clusters[cluster].acceleration(positions[v]) * metric[v];
        }
    }
}

/// Vertices of clusters, each with its cluster.
fn members(cluster_of: &[Option<u32>]) -> impl Iterator<Item = (usize, usize)> {
    cluster_of.iter().enumerate().filter_map(|(v, cluster)| Some((v, (*cluster)? as usize)))
}

/// Inertia of a unit weight at the end of an arm.
fn inertia(arm: DVec3) -> DMat3 {
    let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
    DMat3::IDENTITY * arm.length_squared() - outer
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calculus::test_shapes::{double_bubble, flat_disc};

    #[test]
    fn what_is_given_back_has_the_force_and_torque_of_what_was_removed() {
        let surface = double_bubble(1.0, 0.7, 3);
        let incidence = Incidence::new(&surface);
        let mut clusters = FreeClusters::default();
        clusters.rebuild(&incidence, &surface.pinned);
        let rows = surface.positions.len();
        let metric: Vec<f64> = (0..rows).map(|v| 1.0 + (v as f64).sin().abs()).collect();
        let removed: Vec<DVec3> =
            (0..rows).map(|v| DVec3::new((v as f64).cos(), 0.3, (v as f64 * 2.0).sin())).collect();
        let mut forces = vec![DVec3::ZERO; rows];
        clusters.give_back(&surface.positions, &metric, &removed, &mut forces);
        let left: Vec<DVec3> = removed.iter().zip(&forces).map(|(a, b)| *a - *b).collect();
        let torque: DVec3 = left.iter().zip(surface.positions.iter()).map(|(f, x)| x.cross(*f)).sum();
        let force: DVec3 = left.iter().sum();
        assert!(force.length() < 1e-12 && torque.length() < 1e-12, "{force} {torque}");
    }

    #[test]
    fn films_on_wires_get_nothing_back() {
        let surface = flat_disc(1.0, 3);
        let mut clusters = FreeClusters::default();
        clusters.rebuild(&Incidence::new(&surface), &surface.pinned);
        let rows = surface.positions.len();
        let mut forces = vec![DVec3::ZERO; rows];
        clusters.give_back(&surface.positions, &vec![1.0; rows], &vec![DVec3::X; rows], &mut forces);
        assert!(forces.iter().all(|f| *f == DVec3::ZERO));
    }
}
