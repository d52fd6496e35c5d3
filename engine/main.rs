//! The `froth` command line.
fn main() {}
