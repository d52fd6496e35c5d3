//! The examples run as they are, and say what they promise.

#[allow(dead_code, reason = "its `main` is called below")]
#[path = "../engine/examples/custom_component.rs"]
mod custom_component;
#[allow(dead_code, reason = "its `main` is called below")]
#[path = "../engine/examples/custom_force.rs"]
mod custom_force;

#[test]
fn a_custom_force_runs() {
    custom_force::main().unwrap();
}

#[test]
fn a_custom_component_runs() {
    custom_component::main().unwrap();
}
