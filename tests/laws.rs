//! The quick laws of `froth verify`, one test each.

use froth::verify::{Effort, LAWS, law};

/// Measures a law and asserts every finding.
fn assert_law(name: &str) {
    let law = law(name).unwrap_or_else(|| panic!("there is no law `{name}`"));
    let findings = (law.measure)(Effort::Quick).unwrap();
    assert!(!findings.is_empty());
    let broken: Vec<_> = findings.iter().filter(|finding| !finding.passes()).collect();
    assert!(broken.is_empty(), "{}: {broken:#?}", law.summary);
}

macro_rules! laws {
    ($($(#[$attribute:meta])* $test:ident = $name:literal;)+) => {
        $($(#[$attribute])* #[test] fn $test() { assert_law($name); })+

        #[test]
        fn every_law_has_a_test() {
            let tested = [$($name),+];
            assert_eq!(LAWS.iter().map(|law| law.name).collect::<Vec<_>>(), tested);
        }
    };
}

laws! {
    operators_are_exact_for_constants_and_linear_fields_also_at_walls = "operators";
    spheres_and_ellipsoids_have_their_area_and_curvature = "curvature";
    transfers_keep_liquid_surfactant_and_momentum = "transfers";
    redistribution_leaves_the_surface_and_the_thickness_unchanged = "redistribution";
    the_pressure_in_a_bubble_is_four_sigma_over_its_radius = "young_laplace";
    a_bubble_breathes_on_the_spring_of_its_gas = "breathing";
    a_bubble_of_film_mass_rings_at_the_frequencies_of_its_shape = "shape_modes";
    a_bubble_with_liquid_and_air_rings_slower = "elastic_shape_modes";
    marangoni_waves_run_at_the_speed_of_their_elasticity = "marangoni_wave";
    a_drained_film_is_exponential = "drainage";
    an_uneven_disc_evens_out = "equilibrium_disc";
    a_bubble_at_rest_stays_at_rest = "resting_bubble";
    clusters_of_particles_come_to_rest_with_plateaus_angles = "particle_clusters";
    a_bubble_keeps_its_volume_while_its_mesh_changes = "sphere_volume";
    unequal_bubbles_meet_at_120_degrees_with_the_least_area = "double_bubble";
    two_soaps_meet_at_neumanns_angles = "unequal_tensions";
    a_catenoid_holds_up_to_the_widest_gap = "catenoid";
    two_bubbles_that_touch_become_a_double_bubble = "coalescence";
    a_double_bubble_that_is_pulled_apart_becomes_two_bubbles = "pulled_double_bubble";
    a_lattice_of_cubes_becomes_a_foam = "foam_lattice";
    bubbles_keep_their_volumes_while_others_burst = "bursting_foam";
    films_in_frames_come_to_the_least_area = "frames";
    unequal_clusters_have_the_least_area_and_its_pressures = "clusters";
    a_bubble_in_air_rings_at_the_frequencies_of_two_fluids = "air_modes";
    a_film_on_a_ring_swings_in_air_like_a_drum = "drum_in_air";
    a_bubble_in_air_keeps_its_energy = "sheet_energy";
    a_cube_rings_on_in_air_and_settles_where_it_is_damped = "sheet_cube";
    clusters_in_air_come_to_rest_with_plateaus_angles = "sheet_clusters";
    a_cluster_in_air_keeps_its_impulse = "sheet_impulse";
    the_scenes_of_vortex_sheets_run = "sheet_scenes";
}
