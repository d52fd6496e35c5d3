//! What a run says about itself: measured numbers and faults.
//!
//! * [`Observables`]: one row of named numbers per step, for `observables.csv`.
//! * [`Faults`]: what a system reports when the run must stop; nothing runs after it.
//! * [`check_finite`]: the guard over every registered column.

mod faults;
mod finite;
mod observables;

pub use faults::{Fault, Faults};
pub use finite::check_finite;
pub use observables::{Observable, Observables};
