//! Bubbles as closed regions of a mesh: the gas in them, whatever method moves their films.
//!
//! | stage | system | file |
//! |---|---|---|
//! | `Dynamics` | let gas in and out | `gas` |
//! | `Topology` | gas follows bubbles that divide, join, burst or vanish | `gas` |
//! | `Observe` | rows of regions; volumes and pressures | `gas`, `observe` |

pub mod gas;
pub mod observe;
