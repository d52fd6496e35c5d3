//! Bubbles of particles that touch, as a user meets them.

use froth::Simulation;
use froth_components::film::LiquidVolume;
use froth_components::kind::LagrangianParticle;
use froth_systems::melp::contact::Contacts;

fn bubbles(apart: f64, settings: &str) -> Simulation {
    let text = format!(
        r#"Scene(title: "t", method: Melp({settings}), resolution: Particles(2000), duration: "2 s", entities: [
            [ Sphere(radius: "5 cm"), Film(thickness: Uniform("400 nm")) ],
            [ Sphere(centre: ({apart}, 0, 0), radius: "5 cm"), Film(thickness: Uniform("200 nm")) ],
            [ AirDrag(rate: "1 1/s", normal: "20 1/s") ],
        ])"#
    );
    Simulation::from_scene_text(&text).unwrap()
}

/// Carriers that share all of their second interface.
fn on_walls(simulation: &Simulation, count: usize) -> usize {
    let contacts = simulation.world().resource::<Contacts>();
    (0..count).filter(|i| contacts.share(*i) > 0.98).count()
}

#[test]
fn bubbles_that_touch_grow_a_wall_and_bubbles_that_do_not_stay_alone() {
    let mut touching = bubbles(0.099, "liquid_per_carrier: 4");
    let liquid =
        |run: &mut Simulation| run.column::<LagrangianParticle, LiquidVolume>().iter().map(|v| v.0).sum::<f64>();
    let before = liquid(&mut touching);
    touching.advance_to(0.2).unwrap();
    assert!(on_walls(&touching, 2000) > 60, "{}", on_walls(&touching, 2000));
    assert!((liquid(&mut touching) / before - 1.0).abs() < 1e-12);
    let mut apart = bubbles(0.13, "liquid_per_carrier: 4");
    apart.advance_to(0.1).unwrap();
    assert!(apart.world().resource::<Contacts>().is_empty());
}

#[test]
fn bubbles_that_start_inside_each_other_stop_the_run_and_say_so() {
    let fault = bubbles(0.05, "liquid_per_carrier: 0").step().unwrap_err().to_string();
    let chain = format!("{fault:?} {fault}");
    assert!(chain.contains("spacings into each other"), "{chain}");
}
