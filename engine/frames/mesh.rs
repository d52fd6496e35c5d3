//! Films of a mesh, read from a world for a picture.

use bevy_ecs::world::World;
use froth_components::kind::MeshVertex;
use froth_components::motion::{Pinned, Position};
use froth_surface::SurfaceMesh;
use froth_systems::rows::read_column;
use glam::DVec3;

use crate::picture::FilmTriangles;

/// The mesh of a world and where its vertices are; ghosts are left out.
pub(super) struct MeshFilms {
    positions: Vec<DVec3>,
    pinned: Vec<bool>,
    triangles: Vec<[u32; 3]>,
    labels: Vec<[u32; 2]>,
}

impl MeshFilms {
    /// The films of a world; none where it has no mesh.
    pub(super) fn of(world: &mut World) -> Self {
        let positions = read_column::<MeshVertex, Position>(world).iter().map(|p| p.0).collect();
        let pinned = read_column::<MeshVertex, Pinned>(world).iter().map(|p| p.0 != 0).collect();
        let faces = world.get_resource::<SurfaceMesh>().into_iter().flat_map(SurfaceMesh::faces);
        let films = faces.map(|(_, face)| face).filter(|face| !face.is_ghost());
        let (triangles, labels) =
            films.map(|face| (face.vertices().map(|v| v.0), face.labels().map(|region| region.0))).unzip();
        Self { positions, pinned, triangles, labels }
    }

    /// The films with one value per vertex.
    pub(super) fn film<'a>(&'a self, values: &'a [f64]) -> FilmTriangles<'a> {
        let Self { positions, pinned, triangles, labels } = self;
        FilmTriangles { positions, values, triangles, labels, pinned }
    }
}

#[cfg(test)]
mod tests {
    use super::MeshFilms;
    use bevy_ecs::world::World;
    use froth_components::column::Column;
    use froth_components::film::Thickness;
    use froth_components::kind::{Kind, MeshVertex};
    use froth_components::motion::{Pinned, Position};
    use froth_surface::{Face, Region, SurfaceMesh, VertexRow};
    use froth_systems::rows::registry::ColumnRegistry;
    use froth_systems::rows::{fill_column, spawn_rows};
    use glam::DVec3;

    use crate::frames::quantity::Quantity;
    use crate::picture::{Look, Painter, PictureSettings};

    /// Two films between regions 1 and 0, and a ghost.
    fn world() -> World {
        let mut world = World::new();
        ColumnRegistry::register::<MeshVertex, Position>(&mut world);
        ColumnRegistry::register::<MeshVertex, Thickness>(&mut world);
        ColumnRegistry::register::<MeshVertex, Pinned>(&mut world);
        spawn_rows::<MeshVertex>(&mut world, 4);
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::NEG_X];
        fill_column::<MeshVertex, _>(&mut world, &corners.map(Position));
        fill_column::<MeshVertex, _>(&mut world, &[1e-7, 2e-7, 3e-7, 4e-7].map(Thickness));
        fill_column::<MeshVertex, _>(&mut world, &[0, 1, 1, 0].map(Pinned));
        let face = |rows: [u32; 3]| Face::new(rows.map(VertexRow), [Region(1), Region(0)]);
        let faces = [face([0, 1, 2]), face([0, 2, 3]), face([0, 1, 3]).as_ghost(true)];
        world.insert_resource(SurfaceMesh::new(4, faces));
        world
    }

    #[test]
    fn a_world_with_a_mesh_is_drawn_from_its_triangles_without_ghosts() {
        let mut world = world();
        let quantity = Quantity::of(&Look::default(), &mut world).unwrap();
        assert_eq!(quantity.kind, MeshVertex::NAME);
        let (films, values) = (MeshFilms::of(&mut world), quantity.values(&mut world));
        assert_eq!(values, [1e-7, 2e-7, 3e-7, 4e-7]);
        assert_eq!(films.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(films.pinned, [false, true, true, false]);
        let painter = Painter::new(PictureSettings { width: 40, height: 30, ..PictureSettings::default() }).unwrap();
        assert_eq!(painter.paint_triangles(&films.film(&values)).unwrap().dimensions(), (40, 30));
    }

    #[test]
    fn a_method_of_meshes_alone_has_its_quantities_checked() {
        let world = world();
        assert!(Quantity::check(&Look::default(), &world, false).is_ok());
        assert!(Quantity::check(&Look::Regions { opacity: 0.5, relief: 0.0 }, &world, false).is_ok());
        let look = Look::Map {
            colours: Default::default(),
            quantity: "pined".to_owned(),
            unit: String::new(),
            unit_size: 1.0,
            range: None,
            relief: 0.0,
        };
        let error = Quantity::check(&look, &world, false).unwrap_err();
        assert_eq!(error.nearest.as_deref(), Some(Pinned::NAME));
    }

    #[test]
    fn a_mesh_whose_films_have_all_burst_still_has_a_quantity() {
        let mut world = World::new();
        ColumnRegistry::register::<MeshVertex, Thickness>(&mut world);
        world.insert_resource(SurfaceMesh::default());
        assert!(Quantity::of(&Look::default(), &mut world).is_ok());
    }
}
