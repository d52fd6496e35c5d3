//! Faults that no single component shows: what is missing, what is too much, what does not fit.

use froth_components::authored::film::Film;
use froth_components::authored::film_shape::FilmShape;
use froth_components::authored::method::MethodName;
use froth_components::authored::shape::Shape;
use froth_components::authored::wire::Wire;
use froth_components::quantity::nearest;

use super::error::SceneError;
use super::estimate::{Estimate, Rows};
use super::text::{Tokens, quote, value_of};
use super::{AuthoredComponent, AuthoredEntity, Scene, honours};

/// Fewer particles than these are no film: the neighbourhoods of a smaller one overlap all around.
pub const LEAST_PARTICLES: u64 = 60;

/// Fewer mesh vertices per bubble than these are no film: an icosahedron has as many.
pub const LEAST_VERTICES: u64 = 12;

/// Least radius of curvature of a shape, in spacings of carriers: particles cannot be spread below about 1.
pub const LEAST_BEND: f64 = 1.5;

/// Most frames of a scene: at 50 a second, more than five hours to watch.
pub const MOST_FRAMES: u64 = 1_000_000;

/// Shapes a spherical harmonic makes sense on.
const ROUND: &[&str] = &["Sphere", "Ellipsoid", "HalfSphere"];

/// Shapes that have one normal everywhere, to be displaced along.
const SMOOTH: &[&str] = &["Sphere", "Ellipsoid", "HalfSphere", "Disc", "Rectangle", "Hexagon", "Cube", "Catenoid"];

/// What has points that are held, to be moved.
const HELD: &[&str] = &["Wire", "HalfSphere", "Disc", "Rectangle", "Hexagon", "Catenoid", "WireFrame"];

/// Components that mean nothing without one of others in the same entity. Every shape needs [`Film`].
const COMPANIONS: &[(&str, &[&str])] = &[
    ("Film", &FilmShape::NAMES),
    ("Bumps", SMOOTH),
    ("HarmonicMode", ROUND),
    ("Drift", &["Film"]),
    ("Spin", &["Film"]),
    ("Swirl", &["Film"]),
    ("Moves", HELD),
    ("Volumes", &["Film"]),
    ("Tension", &["Film"]),
];

/// What a component needs beside it; nothing where it stands alone.
fn companions(component: &str) -> Option<&'static [&'static str]> {
    if FilmShape::NAMES.contains(&component) {
        return Some(&["Film"]);
    }
    COMPANIONS.iter().find(|(name, _)| *name == component).map(|(_, needs)| *needs)
}

impl Scene {
    /// Checks the scene as a whole for its own method, and against `available` bytes of memory
    /// ([`available_memory`](super::available_memory) on this machine).
    ///
    /// # Errors
    /// The first fault, pointing into the file.
    pub fn check(&self, available: u64) -> Result<Estimate, SceneError> {
        self.check_entities()?;
        self.check_honoured(self.header.method.name())?;
        self.check_liquid()?;
        self.check_inertia()?;
        self.check_air()?;
        self.check_wires()?;
        self.check_frames()?;
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

    /// Whether films have liquid that flows.
    pub(crate) fn has_liquid(&self) -> bool {
        self.header.method.has_liquid()
    }

    /// What acts on liquid alone finds some.
    fn check_liquid(&self) -> Result<(), SceneError> {
        if self.has_liquid() {
            return Ok(());
        }
        let mut components = self.entities.iter().flat_map(|entity| &entity.components);
        let idle = components.find(|component| component.is_built_in && honours::needs_liquid(component.name));
        idle.map_or(Ok(()), |component| {
            Err(SceneError::NoLiquid {
                component: component.name.to_owned(),
                file: self.file.clone(),
                at: self.file.span(component.range.clone()),
                setting: value_of(self.file.text(), "liquid_per_carrier").map(|range| self.file.span(range)),
            })
        })
    }

    /// What acts through inertia finds some.
    fn check_inertia(&self) -> Result<(), SceneError> {
        if self.header.method.creep().is_none() {
            return Ok(());
        }
        let mut components = self.entities.iter().flat_map(|entity| &entity.components);
        let idle = components.find(|component| component.is_built_in && honours::needs_inertia(component.name));
        idle.map_or(Ok(()), |component| {
            Err(SceneError::NoInertia {
                component: component.name.to_owned(),
                file: self.file.clone(),
                at: self.file.span(component.range.clone()),
                setting: value_of(self.file.text(), "motion").map(|range| self.file.span(range)),
            })
        })
    }

    /// Films that only the air moves have some.
    fn check_air(&self) -> Result<(), SceneError> {
        if self.header.method.name() != MethodName::VortexSheet || self.header.atmosphere.density.si() > 0.0 {
            return Ok(());
        }
        let text = self.file.text();
        // The liquid has a density too: the one wanted comes after `atmosphere`.
        let atmosphere = value_of(text, "atmosphere").unwrap_or(0..text.len());
        let within = value_of(&text[atmosphere.clone()], "density");
        let at =
            within.map_or(atmosphere.clone(), |range| atmosphere.start + range.start..atmosphere.start + range.end);
        Err(SceneError::NoAir { file: self.file.clone(), at: self.file.span(at) })
    }

    /// The film that a wire is to hold exists.
    fn check_wires(&self) -> Result<(), SceneError> {
        let names: Vec<&str> = self.films().filter_map(|(film, _)| film.name()).collect();
        for entity in &self.entities {
            let Some(wanted) = entity.get::<Wire>().and_then(|wire| wire.holds.as_deref()) else { continue };
            if !names.contains(&wanted) {
                return Err(SceneError::UnknownFilm {
                    found: quote(wanted),
                    nearest: nearest(wanted, names.iter().copied()).map(str::to_owned),
                    known: names.iter().map(|name| quote(name)).collect(),
                    file: self.file.clone(),
                    at: self.file.span(entity.range_of(&["Wire"])),
                });
            }
        }
        Ok(())
    }

    /// The frames can be counted, named and kept.
    fn check_frames(&self) -> Result<(), SceneError> {
        let frames = self.header.duration.si() * self.header.frames_per_second.si();
        if frames <= MOST_FRAMES as f64 {
            return Ok(());
        }
        let text = self.file.text();
        let at = value_of(text, "frames_per_second").or_else(|| value_of(text, "duration")).unwrap_or(0..0);
        Err(SceneError::TooManyFrames { frames, most: MOST_FRAMES, file: self.file.clone(), at: self.file.span(at) })
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
        let mut shapes = entity.components.iter().filter(|component| FilmShape::NAMES.contains(&component.name));
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
        let needs_of =
            |component: &AuthoredComponent| component.is_built_in.then(|| companions(component.name)).flatten();
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
            rows: estimate.rows,
            bytes: estimate.bytes,
            available,
            fitting: estimate.fitting(available),
            factor: None,
            file: self.file.clone(),
            at: self.file.span(self.resolution.clone()),
        })
    }

    /// Each film has enough carriers, and they can follow its shape.
    fn check_films(&self, estimate: &Estimate) -> Result<(), SceneError> {
        for (entity, shape) in self.films() {
            let (carriers, least) = (estimate.carriers_on(shape.area()), least_carriers(&estimate.rows, &shape));
            if carriers < least {
                return Err(SceneError::TooCoarse {
                    carriers,
                    noun: estimate.rows.noun(),
                    least,
                    spacing: estimate.spacing,
                    enough: estimate.spacing_for(least, shape.area()),
                    factor: None,
                    file: self.file.clone(),
                    at: self.file.span(entity.shape_range()),
                });
            }
            let radius = least_radius_of_curvature(&shape);
            if radius < LEAST_BEND * estimate.spacing {
                return Err(SceneError::TooSharp {
                    radius,
                    noun: estimate.rows.noun(),
                    spacing: estimate.spacing,
                    enough: radius / LEAST_BEND,
                    factor: None,
                    file: self.file.clone(),
                    at: self.file.span(entity.shape_range()),
                });
            }
        }
        Ok(())
    }

    /// Films with their shapes, in the order of the file.
    pub fn films(&self) -> impl Iterator<Item = (&AuthoredEntity, FilmShape)> {
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

/// Least number of carriers that make a film.
fn least_carriers(rows: &Rows, shape: &FilmShape) -> u64 {
    match rows {
        Rows::Particles { .. } => LEAST_PARTICLES,
        Rows::Mesh { .. } => LEAST_VERTICES.saturating_mul(shape.bubbles()),
    }
}

/// Least radius of curvature of a shape, metres: `c^2 / a` at the tips of an ellipsoid with the longest half axis `a` and the
/// shortest `c`. The other shapes are as round as they are large, or flat.
fn least_radius_of_curvature(shape: &FilmShape) -> f64 {
    match shape {
        FilmShape::Single(Shape::Ellipsoid(ellipsoid)) => {
            let radii = ellipsoid.radii.si();
            radii.min_element() * (radii.min_element() / radii.max_element())
        }
        _ => f64::INFINITY,
    }
}

impl AuthoredEntity {
    /// Where the file gives the shape.
    pub(super) fn shape_range(&self) -> std::ops::Range<usize> {
        self.range_of(&FilmShape::NAMES)
    }

    /// Where the file gives the first component of some names.
    pub(super) fn range_of(&self, names: &[&str]) -> std::ops::Range<usize> {
        let named = self.components.iter().find(|component| names.contains(&component.name));
        named.map_or(0..0, |component| component.range.clone())
    }
}
