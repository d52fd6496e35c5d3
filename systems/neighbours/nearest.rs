//! Nearest-point questions, answered by a k-d tree (kiddo).

use glam::DVec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};

/// A k-d tree over one set of points.
pub struct NearestPoint {
    tree: ImmutableKdTree<f64, 3>,
}

/// A point set of which no tree can be built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("no nearest-point tree can be built over {points} points")]
pub struct NoTree {
    /// How many points there were.
    pub points: usize,
}

impl NearestPoint {
    /// Builds the tree.
    ///
    /// # Errors
    /// [`NoTree`] for an empty set or coordinates that are not finite.
    pub fn build(points: &[DVec3]) -> Result<Self, NoTree> {
        let raw: Vec<[f64; 3]> = points.iter().map(DVec3::to_array).collect();
        if raw.is_empty() || raw.iter().flatten().any(|v| !v.is_finite()) {
            return Err(NoTree { points: raw.len() });
        }
        let tree = ImmutableKdTree::new_from_slice(&raw).map_err(|_| NoTree { points: raw.len() })?;
        Ok(Self { tree })
    }

    /// Row of the point nearest to `place`, and its distance in metres.
    #[must_use]
    pub fn nearest(&self, place: DVec3) -> (usize, f64) {
        let found = self.tree.query(&place.to_array()).nearest_one::<SquaredEuclidean<f64>>().execute();
        (found.item as usize, found.distance.sqrt())
    }
}
