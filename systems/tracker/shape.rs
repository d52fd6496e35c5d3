//! Shape of the films: areas, normals, curvature and thickness of every vertex, as columns.
//!
//! Mean curvature is the area gradient along the normal per area: the sum of principal curvatures. Normals point from the region of
//! the larger label to that of the smaller, out of a bubble.

use bevy_ecs::query::With;
use bevy_ecs::system::Query;
use bevy_ecs::world::World;
use froth_components::film::{Area, LiquidVolume, MeanCurvature, Thickness};
use froth_components::kind::MeshVertex;
use froth_components::motion::Normal;
use froth_surface::calculus::area::{area_gradient, vertex_integrals, vertex_normals};
use froth_surface::calculus::{Incidence, Weights};
use glam::DVec3;

use crate::rows::{columns, columns_mut};

struct Work {
    areas: Vec<f64>,
    normals: Vec<[DVec3; 2]>,
    gradient: Vec<DVec3>,
}

/// Measures the films with vertices at `positions` (metres), and writes what it finds.
pub fn write(world: &mut World, incidence: &Incidence, positions: &[DVec3]) {
    let rows = positions.len();
    let mut work =
        Work { areas: vec![0.0; rows], normals: vec![[DVec3::ZERO; 2]; rows], gradient: vec![DVec3::ZERO; rows] };
    vertex_integrals(incidence, positions, Weights::Uniform(1.0), &mut work.areas);
    vertex_normals(incidence, positions, &mut work.normals);
    area_gradient(incidence, positions, Weights::Uniform(1.0), &mut work.gradient);
    fill(world, &work);
}

type Measured<'a> = (&'a mut Area, &'a mut Normal, &'a mut MeanCurvature, &'a mut Thickness);

fn fill(world: &mut World, work: &Work) {
    let mut state = bevy_ecs::system::SystemState::<(
        Query<Measured<'_>, With<MeshVertex>>,
        Query<&LiquidVolume, With<MeshVertex>>,
    )>::new(world);
    let (mut vertices, liquid) = state.get_mut(world).expect("invariant: queries are always to be had");
    if liquid.is_empty() {
        return; // The last film has burst.
    }
    let liquid = columns(&liquid);
    let (mut areas, mut normals, mut curvatures, mut thickness) = columns_mut(&mut vertices);
    let (areas, normals) = (areas.bypass_change_detection(), normals.bypass_change_detection());
    let (curvatures, thickness) = (curvatures.bypass_change_detection(), thickness.bypass_change_detection());
    for v in 0..areas.len() {
        // The first of the two points from the smaller label inwards: out of a bubble is against it.
        let (area, normal) = (work.areas[v], -work.normals[v][0].normalize_or_zero());
        (areas[v].0, normals[v].0) = (area, normal);
        curvatures[v].0 = if area > 0.0 { work.gradient[v].dot(normal) / area } else { 0.0 };
        thickness[v].0 = if area > 0.0 { liquid[v].0 / area } else { 0.0 };
    }
}
