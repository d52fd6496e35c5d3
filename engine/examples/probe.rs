//! Prints observables per frame: `probe SCENE NAME...`
#![expect(clippy::print_stdout, reason = "a command-line probe prints")]

use froth::Simulation;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut simulation = Simulation::from_scene(arguments.next().ok_or("a scene file is wanted")?)?;
    let names: Vec<String> = arguments.collect();
    println!("t {}", names.join(" "));
    while !simulation.has_reached(simulation.scene().header.duration.si()) {
        if simulation.step()?.frame.is_some() {
            let values = names.iter().map(|name| simulation.observables().get(name).unwrap_or(f64::NAN));
            let values: Vec<String> = values.map(|value| format!("{value:.6e}")).collect();
            println!("{:.4} {}", simulation.time(), values.join(" "));
        }
    }
    Ok(())
}
