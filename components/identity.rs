//! Who a particle is and where it belongs.

use serde::{Deserialize, Serialize};

use crate::column::Plain;

columns! {
    /// Identity of a physical particle, unique within its kind for the whole run. Rows and entity ids change hands
    /// when rows are sorted; this number moves with the particle and keys its random numbers.
    pub struct StableId(u64), "id", "1";
    /// The region a particle belongs to. Particles of one region occupy one contiguous range of rows.
    pub struct InRegion(RegionId), "region", "1";
}

/// Number of a region: 0 is the outside, 1 the first authored film's inside (or, for an open film, the film itself).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct RegionId(pub u32);

impl Plain for RegionId {
    const LANES: &'static [&'static str] = &[];
    fn write_le(&self, out: &mut Vec<u8>) {
        u64::from(self.0).write_le(out);
    }
    fn read_le(bytes: &[u8]) -> Self {
        Self(u64::read_le(bytes) as u32)
    }
    fn push_lanes(&self, out: &mut Vec<f64>) {
        out.push(f64::from(self.0));
    }
    const BLENDS: bool = false;
    fn from_lanes(lanes: &[f64]) -> Self {
        Self(lanes[0] as u32)
    }
}
