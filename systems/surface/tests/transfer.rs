//! Data on vertices through thousands of operations: amounts stay, tables hold the pairs that are there, rows carry their values.

#[path = "common/random.rs"]
mod random;
#[path = "common/scenes.rs"]
mod scenes;
#[path = "common/voxels.rs"]
mod voxels;

use froth_surface::operations::Session;
use froth_surface::shapes::{double_bubble, icosphere, lattice};
use froth_surface::transfer::{Amounts, Circulations, Columns, Several, Transfer};
use froth_surface::{PerVertex, Policy, Region, Surface, VertexRow};
use glam::DVec3;
use random::{Dice, Foam, MIXED};
use scenes::{at, operate, tetrahedron_at};

#[test]
fn amounts_and_pairs_hold_through_thousands_of_operations() {
    let mut done = 0;
    for seed in 0..12 {
        let mut dice = Dice::new(seed);
        let mut foam = Foam::new(&lattice(DVec3::ZERO, [2, 2, 2], 1.0, 0.5), 0.5);
        for number in 1..=1000 {
            // `operate` looks at the liquid to 1e-12, and at the pairs of what was touched.
            let operation = foam.operate(&mut dice, &MIXED, number % 200 == 0);
            operation.unwrap_or_else(|problem| panic!("seed {seed}, {number}: {problem}\n{}", foam.history()));
            if foam.bubbles() < 3 {
                break;
            }
        }
        let c = foam.counts;
        done += c.splits + c.face_splits + c.collapses + c.separations + c.snaps + c.flips + c.bursts;
    }
    assert!(done > 3000, "{done}");
}

/// Data that is a function of place, opened for one operation.
fn with_places<R>(surface: &mut Surface, edge: f64, act: impl FnOnce(&mut Session<'_>) -> R) -> (R, Columns) {
    let mut places = Columns::new(3, surface.positions.iter().flat_map(|x| x.to_array()).collect());
    let (policy, mut marks) = (Policy::new(edge), PerVertex::default());
    let transfer = &mut places as &mut dyn Transfer;
    let done = act(&mut Session::new(surface, &policy, transfer, &mut marks, 1));
    (done, places)
}

#[test]
fn a_linear_field_stays_linear_along_split_edges() {
    let mut surface = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.5));
    let ((), places) = with_places(&mut surface, 0.2, |session| session.split_long_edges());
    for v in surface.mesh.vertices() {
        assert!(DVec3::from_slice(places.of(v)).distance(surface.positions[v]) < 1e-14);
    }
}

#[test]
fn a_compaction_carries_every_value_to_the_new_row_of_its_vertex() {
    let mut surface = Surface::from_triangles(&icosphere(DVec3::ZERO, 1.0, 0.3));
    let mut amounts = Amounts::new((0..surface.positions.len()).map(|v| v as f64).collect());
    let mut jumps = Circulations::new(&surface, |v, i, j| f64::from(v.0 + i.0 + j.0));
    let mut places = Columns::new(3, surface.positions.iter().flat_map(|x| x.to_array()).collect());
    let (policy, mut marks) = (Policy::new(0.6), PerVertex::default());
    let mut data = Several(vec![&mut amounts, &mut jumps, &mut places]);
    Session::new(&mut surface, &policy, &mut data, &mut marks, 1).collapse_short_edges();
    assert!(!surface.mesh.is_compact());
    drop(data);
    let (old_amounts, old_jumps, old_places) = (amounts.clone(), jumps.clone(), places.clone());
    let old = surface.clone();
    let remap = surface.compact();
    Several(vec![&mut amounts, &mut jumps, &mut places]).compact(&remap);
    let mut rows: Vec<VertexRow> = remap.vertices.iter().flatten().copied().collect();
    for (before, after) in remap.vertices.iter().enumerate().filter_map(|(i, row)| Some((VertexRow(i as u32), (*row)?)))
    {
        assert_eq!(surface.positions[after], old.positions[before]);
        assert_eq!(surface.mesh.faces_of(after).len(), old.mesh.faces_of(before).len());
        assert_eq!(amounts.values()[after.index()], old_amounts.values()[before.index()]);
        assert_eq!(places.of(after), old_places.of(before));
        assert_eq!(jumps.get(after, Region(0), Region(1)), old_jumps.get(before, Region(0), Region(1)));
    }
    rows.dedup();
    assert_eq!(rows, (0..surface.positions.len() as u32).map(VertexRow).collect::<Vec<_>>(), "one to one");
}

#[test]
fn circulations_add_up_across_a_film_that_closes_a_gap() {
    let mut set = froth_surface::LabelledTriangles::default();
    let ground = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.3, 1.0, 0.0)];
    for (side, region) in [(-1.0, 1), (1.0, 2)] {
        let [a, b, c] = ground.map(|x| x + at(0.0, 0.0, 0.025 * side));
        tetrahedron_at(&mut set, [a, b, c, at(0.4, 0.4, side)], region, 0);
    }
    let mut surface = Surface::from_triangles(&set);
    let mut jumps = Circulations::new(&surface, |_, _, j| if j == Region(1) { 5.0 } else { 7.0 });
    let (policy, mut marks) = (Policy::new(1.0), PerVertex::default());
    let mut session = Session::new(&mut surface, &policy, &mut jumps, &mut marks, 1);
    let kept = [[0, 4], [1, 5], [2, 6]].map(|[p, q]| session.snap_vertices(VertexRow(p), VertexRow(q)).unwrap());
    // (1, 0) jumps by -5 and (0, 2) by 7: (1, 2) by their sum.
    for v in kept {
        assert!((jumps.get(v, Region(1), Region(2)).unwrap() - 2.0).abs() < 1e-12);
        assert!((jumps.get(v, Region(0), Region(1)).unwrap() - 5.0).abs() < 1e-12);
    }
}

#[test]
fn circulations_of_films_that_become_one_are_brought_together() {
    let mut surface = Surface::from_triangles(&double_bubble(DVec3::ZERO, DVec3::X, 1.0, 0.8, 0.4));
    let mut jumps = Circulations::new(&surface, |_, i, j| f64::from(10 * i.0 + j.0));
    let (policy, mut marks) = (Policy::new(0.4), PerVertex::default());
    Session::new(&mut surface, &policy, &mut jumps, &mut marks, 1).burst(Region(2), Region(1)).unwrap();
    // Films (0, 1) at 1 and (0, 2) at 2 meet in the middle.
    for v in surface.mesh.vertices() {
        assert!((jumps.get(v, Region(0), Region(1)).unwrap() - 1.5).abs() < 1e-12, "{v}");
    }
}

#[test]
fn liquid_of_films_that_vanish_as_a_whole_is_counted_as_lost() {
    let mut set = froth_surface::LabelledTriangles::default();
    let corners = [at(0.0, 0.0, 0.0), at(0.15, 0.0, 0.0), at(0.0, 0.15, 0.0), at(0.0, 0.0, 0.15)];
    tetrahedron_at(&mut set, corners, 1, 0);
    let mut surface = Surface::from_triangles(&set);
    let mut liquid = Amounts::new(vec![1.0, 2.0, 3.0, 4.0]);
    let (policy, mut marks) = (Policy::new(1.0), PerVertex::default());
    Session::new(&mut surface, &policy, &mut liquid, &mut marks, 1).collapse_short_edges();
    assert_eq!(surface.mesh.face_count(), 0);
    assert!((liquid.lost() - 10.0).abs() < 1e-14 && liquid.values().iter().all(|amount| *amount == 0.0));
    let _ = operate(&mut surface, &policy, |session| session.snap_films());
}
