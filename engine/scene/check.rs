//! Faults that no single component shows: what is missing, what is too much, what does not fit.

use froth_components::authored::film::Film;
use froth_components::authored::method::MethodName;
use froth_components::authored::shape::Shape;

use super::error::SceneError;
use super::estimate::Estimate;
use super::text::Tokens;
use super::{AuthoredComponent, AuthoredEntity, Scene, honours};

/// Fewer particles than these are no film: the neighbourhoods of a smaller one overlap all around.
pub const LEAST_PARTICLES: u64 = 60;

/// Shapes a spherical harmonic makes sense on.
const ROUND: [&str; 3] = ["Sphere", "Ellipsoid", "HalfSphere"];

/// Components that mean nothing without one of others in the same entity.
const COMPANIONS: &[(&str, &[&str])] = &[
    ("Film", &Shape::NAMES),
    ("Sphere", &["Film"]),
    ("Ellipsoid", &["Film"]),
    ("HalfSphere", &["Film"]),
    ("Disc", &["Film"]),
    ("Rectangle", &["Film"]),
    ("Hexagon", &["Film"]),
    ("Bumps", &Shape::NAMES),
    ("HarmonicMode", &ROUND),
    ("Drift", &["Film"]),
    ("Spin", &["Film"]),
    ("Swirl", &["Film"]),
];

impl Scene {
    /// Checks the scene as a whole for its own method, and against `available` bytes of memory
    /// ([`available_memory`](super::available_memory) on this machine).
    ///
    /// # Errors
    /// The first fault, pointing into the file.
    pub fn check(&self, available: u64) -> Result<Estimate, SceneError> {
        self.check_entities()?;
        self.check_honoured(self.header.method.name())?;
        let estimate = self.estimate();
        self.check_memory(&estimate, available)?;
        self.check_films(&estimate)?;
        Ok(estimate)
    }

    /// Checks that a method honours every built-in component; what `--method` asks before it replaces the scene's own.
    ///
    /// # Errors
    /// The first component that it cannot honour.
    pub fn check_honoured(&self, method: MethodName) -> Result<(), SceneError> {
        let components = self.entities.iter().flat_map(|entity| &entity.components);
        let refused = components
            .filter(|component| component.is_built_in)
            .find(|component| !honours::honours(method, component.name));
        refused.map_or(Ok(()), |component| {
            Err(SceneError::NotHonoured {
                method: method.in_scene(),
                component: component.name.to_owned(),
                methods: honours::methods_that_honour(component.name),
                file: self.file.clone(),
                at: self.file.span(component.range.clone()),
            })
        })
    }

    /// There is a film, and every entity makes sense.
    fn check_entities(&self) -> Result<(), SceneError> {
        for entity in &self.entities {
            self.check_shapes(entity)?;
            self.check_companions(entity)?;
        }
        if self.films().next().is_none() {
            return Err(SceneError::NoFilm { file: self.file.clone(), at: self.file.span(self.entities_keyword()) });
        }
        Ok(())
    }

    fn check_shapes(&self, entity: &AuthoredEntity) -> Result<(), SceneError> {
        let mut shapes = entity.components.iter().filter(|component| Shape::NAMES.contains(&component.name));
        let (Some(first), Some(second)) = (shapes.next(), shapes.next()) else { return Ok(()) };
        Err(SceneError::SeveralShapes {
            first_shape: first.name.to_owned(),
            second_shape: second.name.to_owned(),
            file: self.file.clone(),
            at: self.file.span(second.range.clone()),
            first: self.file.span(first.range.clone()),
        })
    }

    fn check_companions(&self, entity: &AuthoredEntity) -> Result<(), SceneError> {
        let has_any = |needs: &[&str]| entity.components.iter().any(|component| needs.contains(&component.name));
        let needs_of = |component: &AuthoredComponent| {
            COMPANIONS
                .iter()
                .find(|(name, _)| component.is_built_in && *name == component.name)
                .map(|(_, needs)| *needs)
        };
        for component in &entity.components {
            if let Some(needs) = needs_of(component).filter(|needs| !has_any(needs)) {
                return Err(SceneError::MissingCompanion {
                    component: component.name.to_owned(),
                    needs: needs.to_vec(),
                    file: self.file.clone(),
                    at: self.file.span(component.range.clone()),
                });
            }
        }
        Ok(())
    }

    fn check_memory(&self, estimate: &Estimate, available: u64) -> Result<(), SceneError> {
        if estimate.bytes <= available {
            return Ok(());
        }
        Err(SceneError::TooLarge {
            eulerian: estimate.eulerian,
            lagrangian: estimate.lagrangian,
            bytes: estimate.bytes,
            available,
            fitting: estimate.fitting(available),
            file: self.file.clone(),
            at: self.file.span(self.resolution.clone()),
        })
    }

    /// Each film has enough particles.
    fn check_films(&self, estimate: &Estimate) -> Result<(), SceneError> {
        for (entity, shape) in self.films() {
            let particles = (shape.area() / estimate.spacing.powi(2)).round() as u64;
            if particles < LEAST_PARTICLES {
                return Err(SceneError::TooCoarse {
                    particles,
                    least: LEAST_PARTICLES,
                    spacing: estimate.spacing,
                    enough: (shape.area() / LEAST_PARTICLES as f64).sqrt(),
                    file: self.file.clone(),
                    at: self.file.span(entity.shape_range()),
                });
            }
        }
        Ok(())
    }

    /// Films with their shapes, in the order of the file.
    pub fn films(&self) -> impl Iterator<Item = (&AuthoredEntity, Shape)> {
        self.entities
            .iter()
            .filter(|entity| entity.get::<Film>().is_some())
            .filter_map(|entity| Some((entity, entity.shape()?)))
    }

    /// Where the file says `entities`.
    fn entities_keyword(&self) -> std::ops::Range<usize> {
        let text = self.file.text();
        Tokens::of(text).find(|token| &text[token.clone()] == "entities").unwrap_or(0..text.len())
    }
}

impl AuthoredEntity {
    /// Where the file gives the shape.
    fn shape_range(&self) -> std::ops::Range<usize> {
        let shape = self.components.iter().find(|component| Shape::NAMES.contains(&component.name));
        shape.map_or(0..0, |component| component.range.clone())
    }
}
