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
    a_bubble_of_film_mass_rings_at_the_frequencies_of_its_shape = "shape_modes";
}
