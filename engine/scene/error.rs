//! What can be wrong with a scene file. Each fault has a stable code with a page of its own ([`crate::errors`]).
//!
//! A message says what is wrong; the label points at where; the help says what to write instead. This file is the list of faults; how
//! numbers and names are put into words is in `wording`, where a fault lies in `place`.

mod place;
mod wording;

use std::path::PathBuf;

use miette::{Diagnostic, SourceSpan};
use thiserror::Error;

pub use self::place::Place;
use self::wording::{
    all_of, count, length, memory, missing_help, names_help, one_of, prefix, refinement, rounded_down,
};
use super::estimate::Rows;
use super::text::SceneText;

/// A fault of a scene file. Codes: `F000x` the file, `F001x` its syntax, `F002x` names, `F003x` values, `F004x` meaning, `F005x` size, `F006x`
/// meshes.
#[derive(Debug, Error, Diagnostic)]
#[non_exhaustive]
pub enum SceneError {
    /// No such file.
    #[error("there is no file `{}`", path.display())]
    #[diagnostic(code(F0001), help("{}", missing_help(nearest.as_deref())))]
    Missing {
        /// The path as it was given.
        path: PathBuf,
        /// A file of nearly that name in the same folder.
        nearest: Option<String>,
    },

    /// A folder, not a file.
    #[error("`{}` is a folder, not a scene file", path.display())]
    #[diagnostic(code(F0002), help("name a file in it, such as `{}`", path.join("scene.ron").display()))]
    Directory {
        /// The path as it was given.
        path: PathBuf,
    },

    /// Nothing in the file but spaces and comments.
    #[error("`{name}` is empty")]
    #[diagnostic(code(F0003), help("a scene begins with `Scene(title: \"...\", method: Melp(), ...`"))]
    Empty {
        /// Name of the file.
        name: String,
    },

    /// Not a text file.
    #[error("`{name}` is not a text file: byte {offset} is no UTF-8 text")]
    #[diagnostic(code(F0004), help("a scene is a text file in RON; a checkpoint is resumed with `froth resume`"))]
    NotText {
        /// Name of the file.
        name: String,
        /// Offset of the first byte that is no text.
        offset: usize,
    },

    /// Longer than any scene.
    #[error("`{name}` has {bytes} bytes; a scene has at most {limit}")]
    #[diagnostic(
        code(F0005),
        help("is this a scene file? Thousands of films are better made by a program that calls froth as a library")
    )]
    TooLong {
        /// Name of the file.
        name: String,
        /// Its length; the limit plus one where the file does not say.
        bytes: u64,
        /// Longest allowed, bytes.
        limit: u64,
    },

    /// The system refuses to read the file.
    #[error("`{}` cannot be read", path.display())]
    #[diagnostic(code(F0006), help("a scene must be a plain file that you may read"))]
    Unreadable {
        /// The path as it was given.
        path: PathBuf,
        /// What the system said.
        #[source]
        cause: std::io::Error,
    },

    /// Not RON.
    #[error("the file is not RON: {problem}")]
    #[diagnostic(code(F0010), help("{help}"))]
    Syntax {
        /// What the reader wanted.
        problem: String,
        /// What to look for.
        help: &'static str,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("here")]
        at: SourceSpan,
    },

    /// Brackets within brackets without end.
    #[error("brackets are nested too deeply")]
    #[diagnostic(code(F0011), help("no scene needs more than ten levels"))]
    TooDeep {
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where the limit was reached.
        #[label("one level too many")]
        at: SourceSpan,
    },

    /// No component of that name.
    #[error("unknown component `{found}`")]
    #[diagnostic(code(F0020), help("{}", names_help(nearest.as_deref(), "components", known)))]
    UnknownComponent {
        /// The name in the file.
        found: String,
        /// The known name most like it.
        nearest: Option<String>,
        /// All components, in alphabetical order.
        known: Box<[String]>,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("no component has this name")]
        at: SourceSpan,
    },

    /// No field of that name.
    #[error("`{owner}` has no field `{found}`")]
    #[diagnostic(code(F0021), help("{}", names_help(nearest.as_deref(), "fields", known)))]
    UnknownField {
        /// What the field would belong to.
        owner: String,
        /// The name in the file.
        found: String,
        /// The known name most like it.
        nearest: Option<String>,
        /// All fields of the owner.
        known: Box<[String]>,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("no field has this name")]
        at: SourceSpan,
    },

    /// A field has a choice of names, and this is none of them.
    #[error("`{found}` is no choice for `{field}`")]
    #[diagnostic(code(F0022), help("{}", names_help(nearest.as_deref(), "choices", known)))]
    UnknownChoice {
        /// The name in the file.
        found: String,
        /// Path of the field.
        field: String,
        /// The known name most like it.
        nearest: Option<String>,
        /// All choices.
        known: Box<[String]>,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("not a choice")]
        at: SourceSpan,
    },

    /// No method of that name.
    #[error("unknown method `{found}`")]
    #[diagnostic(code(F0023), help("{}", names_help(nearest.as_deref(), "methods", known)))]
    UnknownMethod {
        /// The name in the file.
        found: String,
        /// The known name most like it.
        nearest: Option<String>,
        /// All available methods.
        known: Box<[String]>,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("no method has this name")]
        at: SourceSpan,
    },

    /// A published method that froth does not have yet.
    #[error("the method `{method}` is not available yet")]
    #[diagnostic(code(F0024), help("choose one of: {}", known.join(", ")))]
    MethodNotAvailable {
        /// The name in the file.
        method: String,
        /// All available methods.
        known: Box<[String]>,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("known, but not available")]
        at: SourceSpan,
    },

    /// A field without a default is not given.
    #[error("`{owner}` lacks the field `{field}`")]
    #[diagnostic(code(F0025), help("add `{field}: ...`; it has no default"))]
    MissingField {
        /// What the field belongs to.
        owner: String,
        /// The field.
        field: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The owner.
        #[label("`{field}` is missing here")]
        at: SourceSpan,
    },

    /// A field is given twice.
    #[error("`{owner}` has the field `{field}` twice")]
    #[diagnostic(code(F0026), help("keep one of them"))]
    DuplicateField {
        /// What the field belongs to.
        owner: String,
        /// The field.
        field: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The second one.
        #[label("given again")]
        at: SourceSpan,
    },

    /// An entity has two components of one kind.
    #[error("the entity has two `{component}` components")]
    #[diagnostic(
        code(F0027),
        help("keep one of them, or write the other into an entity of its own: `[ ... ], [ ... ]`")
    )]
    DuplicateComponent {
        /// The component.
        component: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The second one.
        #[label("given again")]
        at: SourceSpan,
        /// The first one.
        #[label("given first")]
        first: SourceSpan,
    },

    /// A value of another kind than wanted.
    #[error("{}{message}", prefix(field))]
    #[diagnostic(code(F0030), help("{help}"))]
    WrongType {
        /// Path of the field; empty where there is none.
        field: String,
        /// What is there and what is wanted.
        message: String,
        /// What to write.
        help: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("not what is wanted here")]
        at: SourceSpan,
    },

    /// A unit that does not exist.
    #[error("{}{message}", prefix(field))]
    #[diagnostic(code(F0031), help("{help}"))]
    UnknownUnit {
        /// Path of the field.
        field: String,
        /// What is wrong.
        message: String,
        /// Nearest unit and list of units.
        help: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("unknown unit")]
        at: SourceSpan,
    },

    /// A unit of another dimension.
    #[error("{}{message}", prefix(field))]
    #[diagnostic(code(F0032), help("{help}"))]
    WrongDimension {
        /// Path of the field.
        field: String,
        /// What is there and what is wanted.
        message: String,
        /// Units of the wanted dimension.
        help: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("wrong dimension")]
        at: SourceSpan,
    },

    /// NaN or infinity.
    #[error("{}{message}", prefix(field))]
    #[diagnostic(code(F0033), help("{help}"))]
    NotFinite {
        /// Path of the field.
        field: String,
        /// What is wrong.
        message: String,
        /// What is wanted.
        help: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("not a finite number")]
        at: SourceSpan,
    },

    /// A value outside what the field can take.
    #[error("{}{message}", prefix(field))]
    #[diagnostic(code(F0034), help("{help}"))]
    OutOfRange {
        /// Path of the field.
        field: String,
        /// What is wrong.
        message: String,
        /// The range.
        help: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("out of range")]
        at: SourceSpan,
    },

    /// Two values of one component that cannot both hold.
    #[error("{}{message}", prefix(field))]
    #[diagnostic(code(F0035), help("{help}"))]
    Contradiction {
        /// Path of what holds both.
        field: String,
        /// What is wrong.
        message: String,
        /// How they must relate.
        help: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("these do not go together")]
        at: SourceSpan,
    },

    /// A component of the user's own refuses a value in its own words.
    #[error("{}{message}", prefix(field))]
    #[diagnostic(code(F0036), help("this rule is the component's own; its documentation should say more"))]
    Refused {
        /// Path of the field.
        field: String,
        /// The component's words.
        message: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// Where.
        #[label("refused")]
        at: SourceSpan,
    },

    /// Nothing to simulate.
    #[error("the scene has no film")]
    #[diagnostic(
        code(F0040),
        help("add an entity such as `[ Sphere(radius: \"5 cm\"), Film(thickness: Uniform(\"500 nm\")) ]`")
    )]
    NoFilm {
        /// The file.
        #[source_code]
        file: SceneText,
        /// The entities.
        #[label("none of these is a film")]
        at: SourceSpan,
    },

    /// A component that means nothing without another.
    #[error("`{component}` needs {} in the same entity", one_of(needs))]
    #[diagnostic(code(F0041), help("write both into one list: `[ {component}(...), {}(...) ]`", needs.first().copied().unwrap_or_default()))]
    MissingCompanion {
        /// The component that is there.
        component: String,
        /// One of these is missing.
        needs: Vec<&'static str>,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The component.
        #[label("needs another component beside it")]
        at: SourceSpan,
    },

    /// A film of two shapes.
    #[error("the entity has two shapes, `{first_shape}` and `{second_shape}`")]
    #[diagnostic(code(F0042), help("write each film into an entity of its own: `[ ... ], [ ... ]`"))]
    SeveralShapes {
        /// The first one.
        first_shape: String,
        /// The second one.
        second_shape: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The second one.
        #[label("a second shape")]
        at: SourceSpan,
        /// The first one.
        #[label("the first shape")]
        first: SourceSpan,
    },

    /// A method cannot do what a component asks for.
    #[error("the method `{method}` cannot honour `{component}`")]
    #[diagnostic(code(F0043), help("take it out of the scene, or choose a method that honours it: {}", methods.join(", ")))]
    NotHonoured {
        /// The method.
        method: &'static str,
        /// The component.
        component: String,
        /// Methods that honour it.
        methods: Vec<&'static str>,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The component.
        #[label("has no meaning under `{method}`")]
        at: SourceSpan,
    },

    /// A component that moves or warms the liquid, under settings that give the film none.
    #[error("`{component}` acts on the liquid within a film, and `Melp(liquid_per_carrier: 0)` has none")]
    #[diagnostic(
        code(F0044),
        help("write `liquid_per_carrier: 4` or more (16 by default), or take `{component}` out of the scene")
    )]
    NoLiquid {
        /// The component.
        component: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The component.
        #[label("has nothing to act on")]
        at: SourceSpan,
        /// The setting.
        #[label("no liquid")]
        setting: Option<SourceSpan>,
    },

    /// A component that acts through inertia, under settings that give the film none.
    #[error("`{component}` is a velocity at the start, and an overdamped film has no inertia to keep it")]
    #[diagnostic(
        code(F0045),
        help("write `motion: Inertial()` into the method, or take `{component}` out of the scene")
    )]
    NoInertia {
        /// The component.
        component: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The component.
        #[label("forgotten at once")]
        at: SourceSpan,
        /// The setting.
        #[label("no inertia")]
        setting: Option<SourceSpan>,
    },

    /// Vortex sheets in a vacuum: only air moves their films.
    #[error("films of `VortexSheet` are moved by the air around them, and the atmosphere has none")]
    #[diagnostic(
        code(F0047),
        help(
            "give `atmosphere` a density, e.g. `density: 1.2`, or choose a method whose films have a mass of their own"
        )
    )]
    NoAir {
        /// The file.
        #[source_code]
        file: SceneText,
        /// The density.
        #[label("a vacuum")]
        at: SourceSpan,
    },

    /// A wire that holds a film which does not exist.
    #[error("the wire holds `{found}`, and no film has this name")]
    #[diagnostic(code(F0046), help("{}", names_help(nearest.as_deref(), "films with a `Name`", known)))]
    UnknownFilm {
        /// The name in the file.
        found: String,
        /// The known name most like it.
        nearest: Option<String>,
        /// Names of all films, in the order of the file.
        known: Box<[String]>,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The wire.
        #[label("holds nothing")]
        at: SourceSpan,
    },

    /// A film of too few carriers.
    #[error("the film would have {carriers} {noun}; fewer than {least} are no film")]
    #[diagnostic(
        code(F0050),
        help(
            "{noun} are {} apart; write a spacing of {} or less, or more {noun}{}",
            length(*spacing),
            length(rounded_down(*enough)),
            refinement(*factor, noun)
        )
    )]
    TooCoarse {
        /// Carriers it would have.
        carriers: u64,
        /// What they are called.
        noun: &'static str,
        /// Least number that makes sense.
        least: u64,
        /// Distance between them, metres.
        spacing: f64,
        /// Largest distance that gives enough, metres.
        enough: f64,
        /// Factor on the resolution from outside the file.
        factor: Option<f64>,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The shape.
        #[label("{carriers} {noun} on this")]
        at: SourceSpan,
    },

    /// More carriers than memory.
    #[error(
        "the scene needs about {} for {}; {} is available",
        memory(*bytes),
        all_of(rows),
        memory(*available)
    )]
    #[diagnostic(
        code(F0051),
        help(
            "write a larger spacing or fewer {}: about {} {} fit{}",
            rows.noun(),
            count(*fitting),
            rows.carrier_name(),
            refinement(*factor, rows.noun())
        )
    )]
    TooLarge {
        /// What the films would be made of.
        rows: Rows,
        /// Memory they need, bytes.
        bytes: u64,
        /// Memory there is, bytes.
        available: u64,
        /// Carriers that would fit.
        fitting: u64,
        /// Factor on the resolution from outside the file.
        factor: Option<f64>,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The resolution.
        #[label("too fine")]
        at: SourceSpan,
    },

    /// More frames than anybody watches or any disk holds.
    #[error("the run would make about {frames:.1e} frames; more than {} are refused", count(*most))]
    #[diagnostic(code(F0052), help("write a shorter duration or fewer frames per second"))]
    TooManyFrames {
        /// Frames it would make.
        frames: f64,
        /// Most that are made.
        most: u64,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The frame rate, or the duration where the rate is the usual one.
        #[label("too many frames")]
        at: SourceSpan,
    },

    /// A shape that bends more sharply than its carriers can follow.
    #[error("the shape bends with a radius of {}, and its {noun} are {} apart", length(*radius), length(*spacing))]
    #[diagnostic(
        code(F0053),
        help(
            "write a spacing of {} or less, more {noun}, or a rounder shape{}",
            length(rounded_down(*enough)),
            refinement(*factor, noun)
        )
    )]
    TooSharp {
        /// Least radius of curvature, metres.
        radius: f64,
        /// What carriers are called.
        noun: &'static str,
        /// Distance between them, metres.
        spacing: f64,
        /// Largest distance that follows the shape, metres.
        enough: f64,
        /// Factor on the resolution from outside the file.
        factor: Option<f64>,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The shape.
        #[label("too sharp for the resolution")]
        at: SourceSpan,
    },

    /// A mesh file that is not in the scene's folder.
    #[error("the mesh file `{path}` is not within the scene's own folder")]
    #[diagnostic(
        code(F0060),
        help(
            "put the file beside the scene or into a folder there, and write its path from the scene: \"meshes/foam.ply\""
        )
    )]
    MeshOutside {
        /// As the scene gives it.
        path: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The component.
        #[label("leads out of the folder")]
        at: SourceSpan,
    },

    /// A mesh file that is not there or cannot be read.
    #[error("the mesh file `{path}` {problem}")]
    #[diagnostic(code(F0061), help("{help}"))]
    MeshUnreadable {
        /// As the scene gives it.
        path: String,
        /// What is wrong with it.
        problem: String,
        /// What to do.
        help: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The component.
        #[label("names the file")]
        at: SourceSpan,
    },

    /// A file that is no mesh.
    #[error("the mesh cannot be read: {message}")]
    #[diagnostic(
        code(F0062),
        help(
            "a mesh is a Wavefront .obj or a Stanford .ply file of triangles; `froth explain F0062` shows one of each"
        )
    )]
    NotAMesh {
        /// What is wrong, with the line or the byte where it is.
        message: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The component.
        #[label("no mesh")]
        at: SourceSpan,
    },

    /// Films that do not part regions: an edge where the regions around do not match, or a film that ends in the air.
    #[error("the films do not part one region from another: {message}")]
    #[diagnostic(
        code(F0063),
        help("around each edge, what is behind one film is before the next; a film that ends must end on a wire")
    )]
    MeshLabels {
        /// Which edge, and what does not match.
        message: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The component.
        #[label("open or inconsistent")]
        at: SourceSpan,
    },

    /// Faces that are no faces: double, without area, or vertices without any.
    #[error("the mesh has faces that are none: {message}")]
    #[diagnostic(
        code(F0064),
        help("merge vertices that coincide, then remove double faces, faces without area, and vertices without faces")
    )]
    MeshFaces {
        /// Which faces, and what is wrong.
        message: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The component.
        #[label("double, empty or loose")]
        at: SourceSpan,
    },

    /// Films that pass through each other.
    #[error("films pass through each other: {message}")]
    #[diagnostic(code(F0065), help("move the films apart, or join them where they meet"))]
    FilmsCross {
        /// Which films, and where.
        message: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The component.
        #[label("crosses a film")]
        at: SourceSpan,
    },

    /// A wire that passes through a film.
    #[error("the wire passes through a film: {message}")]
    #[diagnostic(code(F0066), help("a wire runs along the film that it holds: change its radius or move it"))]
    WirePierces {
        /// Where.
        message: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The wire.
        #[label("pierces a film")]
        at: SourceSpan,
    },

    /// A wire with no film near it.
    #[error("the wire holds no film: {message}")]
    #[diagnostic(
        code(F0067),
        help("a wire runs along the film that it holds, nowhere farther from it than an edge of the mesh")
    )]
    WireFar {
        /// How far, and from what.
        message: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The wire.
        #[label("no film here")]
        at: SourceSpan,
    },

    /// Volumes for more or fewer bubbles than there are.
    #[error("the volumes do not fit the bubbles: {message}")]
    #[diagnostic(
        code(F0068),
        help("write one volume for each bubble of the shape, in the order that its type documents")
    )]
    VolumesMisfit {
        /// How many of each.
        message: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The shape.
        #[label("has another number of bubbles")]
        at: SourceSpan,
    },

    /// A burst of a bubble that is not there.
    #[error("a bubble is to burst that is not there: {message}")]
    #[diagnostic(
        code(F0069),
        help(
            "write numbers of bubbles that the films enclose at the start; the outside and regions that no film closes cannot burst"
        )
    )]
    UnknownBubble {
        /// Which, and which there are.
        message: String,
        /// The file.
        #[source_code]
        file: SceneText,
        /// The burst.
        #[label("names a bubble that is not there")]
        at: SourceSpan,
    },
}

impl SceneError {
    /// Names the factor on the resolution that came from outside the file, where the fault depends on it.
    pub(crate) fn refined_by(mut self, outside: Option<f64>) -> Self {
        if let Self::TooCoarse { factor, .. } | Self::TooLarge { factor, .. } | Self::TooSharp { factor, .. } =
            &mut self
        {
            *factor = outside;
        }
        self
    }
}
