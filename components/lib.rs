//! What exists in froth: plain data with unit and meaning, no behaviour beyond constructors.
//!
//! * [`authored`]: what a scene file can say: shapes, films, fields; [`quantity`]: its dimensioned values.
//! * [`kind`]: what an entity is (Eulerian particle, Lagrangian particle, boundary particle, mesh vertex, region).
//! * [`motion`], [`film`], [`gas`], [`identity`]: what it carries, one physical idea per component.
//! * [`column`](mod@column): how a component is laid out as scalars, for row permutation, checkpoints and export.
//! * [`lamella`]: the films of a run; [`clock`], [`material`]: the few quantities that belong to the whole run.
//!
//! Conventions (units, signs, orientation) are drawn once in [`film`].

#[macro_use]
pub mod column;

pub mod authored;
pub mod clock;
pub mod film;
pub mod gas;
pub mod identity;
pub mod kind;
pub mod lamella;
pub mod material;
pub mod motion;
pub mod quantity;
