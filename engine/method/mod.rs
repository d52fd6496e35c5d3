//! Methods: schedules over shared components.

pub mod melp;
