//! The shape of a film, of either sort: one film that particles can be ([`Shape`]), or what takes a mesh ([`MeshShape`]).

use bevy_ecs::component::Component;
use bevy_ecs::world::EntityRef;
use glam::DVec3;

use super::mesh_shape::MeshShape;
use super::shape::{Disc, Ellipsoid, HalfSphere, Hexagon, Rectangle, Shape, Sphere};

/// An entity, in a world or in a scene file, that can be asked for its components.
pub trait Parts {
    /// The component of a type, if the entity has one.
    fn part<T: Component>(&self) -> Option<&T>;
}

impl Parts for EntityRef<'_> {
    fn part<T: Component>(&self) -> Option<&T> {
        self.get::<T>()
    }
}

impl Shape {
    /// The shape among the components of an entity, if it has one.
    #[must_use]
    pub fn of(entity: &impl Parts) -> Option<Self> {
        let sphere = entity.part::<Sphere>().copied().map(Self::Sphere);
        sphere
            .or_else(|| entity.part::<Ellipsoid>().copied().map(Self::Ellipsoid))
            .or_else(|| entity.part::<HalfSphere>().copied().map(Self::HalfSphere))
            .or_else(|| entity.part::<Disc>().copied().map(Self::Disc))
            .or_else(|| entity.part::<Rectangle>().copied().map(Self::Rectangle))
            .or_else(|| entity.part::<Hexagon>().copied().map(Self::Hexagon))
    }
}

/// The shape of a film.
#[derive(Clone, Debug, PartialEq)]
pub enum FilmShape {
    /// One film.
    Single(Shape),
    /// What takes a mesh.
    Mesh(MeshShape),
}

impl FilmShape {
    /// Names of all shape components, as scene files write them.
    pub const NAMES: [&str; NAME_COUNT] = joined();

    /// The shape among the components of an entity, if it has one.
    #[must_use]
    pub fn of(entity: &impl Parts) -> Option<Self> {
        Shape::of(entity).map(Self::Single).or_else(|| MeshShape::of(entity).map(Self::Mesh))
    }

    /// Centre, metres.
    #[must_use]
    pub fn centre(&self) -> DVec3 {
        match self {
            Self::Single(shape) => shape.centre(),
            Self::Mesh(shape) => shape.measured().centre(),
        }
    }

    /// Size that relative amplitudes and noise frequencies refer to, metres.
    #[must_use]
    pub fn size(&self) -> f64 {
        match self {
            Self::Single(shape) => shape.size(),
            Self::Mesh(shape) => shape.measured().size(),
        }
    }

    /// Area of all films, square metres; good enough to estimate by.
    #[must_use]
    pub fn area(&self) -> f64 {
        match self {
            Self::Single(shape) => shape.area(),
            Self::Mesh(shape) => shape.measured().area(),
        }
    }

    /// Length of the pinned rims, metres; 0 for a closed shape.
    #[must_use]
    pub fn rim(&self) -> f64 {
        match self {
            Self::Single(shape) => shape.rim(),
            Self::Mesh(shape) => shape.measured().rim(),
        }
    }

    /// Points whose convex hull is the shape's hull, metres.
    #[must_use]
    pub fn outline(&self) -> Vec<DVec3> {
        match self {
            Self::Single(shape) => shape.outline(),
            Self::Mesh(shape) => shape.measured().outline(),
        }
    }

    /// Directions across its flat films; none for a curved shape.
    #[must_use]
    pub fn flat_normals(&self) -> Vec<DVec3> {
        match self {
            Self::Single(shape) => shape.flat_normal().into_iter().collect(),
            Self::Mesh(shape) => shape.measured().flat_normals(),
        }
    }

    /// Normal of a flat shape; none for a curved one or one of several films.
    #[must_use]
    pub fn flat_normal(&self) -> Option<DVec3> {
        match self {
            Self::Single(shape) => shape.flat_normal(),
            Self::Mesh(_) => None,
        }
    }

    /// Number of bubbles; of an open film, 1.
    #[must_use]
    pub fn bubbles(&self) -> u64 {
        match self {
            Self::Single(_) => 1,
            Self::Mesh(shape) => shape.measured().bubbles(),
        }
    }

    /// Vertices that it brings along, however coarse the resolution.
    #[must_use]
    pub fn own_vertices(&self) -> u64 {
        match self {
            Self::Single(_) => 0,
            Self::Mesh(shape) => shape.measured().own_vertices(),
        }
    }

    /// Whether the shape encloses gas volumes by itself.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Single(shape) => shape.is_closed(),
            Self::Mesh(shape) => shape.measured().is_closed(),
        }
    }
}

const NAME_COUNT: usize = Shape::NAMES.len() + MeshShape::NAMES.len();

/// Names of single films, then of meshes.
const fn joined() -> [&'static str; NAME_COUNT] {
    let mut names = [""; NAME_COUNT];
    let mut at = 0;
    while at < names.len() {
        let own = at < Shape::NAMES.len();
        names[at] = if own { Shape::NAMES[at] } else { MeshShape::NAMES[at - Shape::NAMES.len()] };
        at += 1;
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::authored::mesh_shape::Cube;
    use crate::authored::shape::Place;
    use crate::quantity::Length;
    use bevy_ecs::world::World;

    #[test]
    fn the_shape_of_an_entity_in_a_world_is_found() {
        let cube = Cube { centre: Place::ZERO, side: Length::from_si(0.05) };
        let sphere = Sphere { centre: Place::ZERO, radius: Length::from_si(0.05) };
        let mut world = World::new();
        let entities = [world.spawn(cube).id(), world.spawn(sphere).id(), world.spawn_empty().id()];
        let shapes = entities.map(|entity| FilmShape::of(&world.entity(entity)));
        assert_eq!(shapes[0], Some(FilmShape::Mesh(MeshShape::Cube(cube))));
        assert_eq!(shapes[1], Some(FilmShape::Single(Shape::Sphere(sphere))));
        assert_eq!(shapes[2], None);
    }

    #[test]
    fn every_shape_has_a_name_of_its_own() {
        let mut names = FilmShape::NAMES.to_vec();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), FilmShape::NAMES.len());
    }
}
