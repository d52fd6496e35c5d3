//! probe (temporary)
use bevy_ecs::world::World;
use froth::method::melp;
use froth::scene::{AuthoredRegistry, Scene};
use froth_components::clock::{Clock, Seed};
use froth_components::material::{Atmosphere, Liquid};
use froth_components::authored::method::MethodChoice;
use froth_systems::clock::{StepLimits, end_of_step};
use froth_systems::observe::{Faults, Observables};
use froth_systems::plan::SchedulePlan;
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let cols: Vec<String> = std::env::args().skip(2).collect();
    let scene = Scene::from_path(&path, &AuthoredRegistry::built_in()).unwrap();
    let h = &scene.header;
    let mut w = World::new();
    melp::register(&mut w);
    w.insert_resource(Liquid::from(h.liquid)); w.insert_resource(Atmosphere::from(h.atmosphere));
    w.insert_resource(Clock::default()); w.insert_resource(Seed(h.seed));
    w.init_resource::<StepLimits>(); w.init_resource::<Faults>(); w.init_resource::<Observables>();
    scene.spawn_into(&mut w);
    let MethodChoice::Melp(m) = h.method else { panic!() };
    let t0 = std::time::Instant::now();
    melp::discretise(&mut w, &m, h.resolution, h.maximum_step.map(|t| t.si())).unwrap();
    eprintln!("discretise {:?}", t0.elapsed());
    let mut plan = SchedulePlan::new();
    melp::assemble(&mut plan);
    let fps = h.frames_per_second.si();
    let frames = (h.duration.si() * fps).round() as u64;
    println!("t {}", cols.join(" "));
    let t0 = std::time::Instant::now();
    for f in 1..=frames {
        w.resource_mut::<Clock>().horizon = f as f64 / fps;
        while w.resource::<Clock>().time < f as f64 / fps {
            w.resource_mut::<StepLimits>().begin_step();
            plan.run(&mut w);
            w.clear_trackers();
            let faults = w.resource::<Faults>().all().to_vec();
            if let Some(f) = faults.first() { println!("FAULT {f}"); std::process::exit(1) }
            let mut c = w.resource_mut::<Clock>();
            c.time = end_of_step(&c); c.steps += 1;
        }
        let o = w.resource::<Observables>();
        print!("{:.4}", f as f64 / fps);
        for c in &cols { print!(" {:.6e}", o.columns().iter().find(|k| &k.name == c).and_then(|k| k.value).unwrap_or(f64::NAN)); }
        println!();
    }
    eprintln!("{} steps in {:?}", w.resource::<Clock>().steps, t0.elapsed());
}
