//! What exists in froth: plain data with unit and meaning, no behaviour beyond constructors.

pub mod authored;
pub mod quantity;
