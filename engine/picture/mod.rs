//! Pictures of films, drawn on the processor from points or triangles.
//!
//! [`Painter`] turns [`FilmPoints`] (positions, normals, values, spacing) or [`FilmTriangles`] (vertices, values, triangles
//! between regions) into an image by [`PictureSettings`]: a soap film in a studio, coloured by thin-film interference, a
//! colour map of any quantity with its scale bar, or one colour per film. [`Animation`] gathers images into one animated
//! PNG, [`ContactSheet`] into one still. Nothing here knows a world, a scene or a run.
//!
//! | question | file |
//! |---|---|
//! | how much does a film reflect | `optics` |
//! | which colour is that | `colour`, `interference` |
//! | where do points fall | `camera`, `splat`, `tiles` |
//! | where do triangles fall | `camera`, `facet`, `tube`, `subsamples`, `tiles` |
//! | which triangles are one film, where do films meet | `triangles`, `film_network` |
//! | which film is seen at a sample | `layers` (points), `mesh_layers` (triangles) |
//! | what light comes from there | `studio`, `shade`, `rod`, `colour_map`, `region_colours` |
//! | who puts it together | `raster`, `painter`, `settings` |
//! | legends, moving pictures, overviews | `scale_bar`, `lettering`, `animation`, `contact_sheet` |
//!
//! ```
//! use froth::picture::{FilmPoints, Painter, Part, PictureSettings};
//! use glam::DVec3;
//!
//! // A bubble of 1000 points, 400 nm thick.
//! let directions: Vec<DVec3> = (0..1000)
//!     .map(|i| {
//!         let (height, turn) = (1.0 - (2 * i + 1) as f64 / 1000.0, 2.399963 * i as f64);
//!         let width = (1.0 - height * height).sqrt();
//!         DVec3::new(width * turn.cos(), height, width * turn.sin())
//!     })
//!     .collect();
//! let positions: Vec<DVec3> = directions.iter().map(|d| 0.05 * *d).collect();
//! let spacing = 0.05 * (4.0 * std::f64::consts::PI / 1000.0).sqrt();
//! let film = FilmPoints { positions: &positions, normals: &directions, values: &[400e-9; 1000], spacing, part: Part::Whole };
//! let painter = Painter::new(PictureSettings { width: 64, height: 64, ..Default::default() })?;
//! assert_eq!(painter.paint(&film)?.dimensions(), (64, 64));
//! # Ok::<(), froth::picture::PictureError>(())
//! ```

pub mod animation;
pub mod camera;
pub mod colour;
pub mod colour_map;
pub mod contact_sheet;
mod error;
mod facet;
mod film;
mod film_network;
pub mod interference;
mod layers;
mod lettering;
mod mesh_layers;
pub mod optics;
mod painter;
mod raster;
mod region_colours;
mod rod;
pub mod scale_bar;
mod settings;
mod shade;
mod splat;
mod studio;
mod subsamples;
#[cfg(test)]
mod test_meshes;
mod tiles;
mod triangles;
mod tube;

pub use animation::{Animation, AnimationSettings};
pub use camera::Camera;
pub use colour_map::ColourMap;
pub use contact_sheet::ContactSheet;
pub use error::PictureError;
pub use film::{FilmPoints, Part};
pub use film_network::film_normals;
pub use painter::Painter;
pub use settings::{Look, PictureSettings};
pub use studio::Background;
pub use triangles::FilmTriangles;
