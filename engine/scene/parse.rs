//! From text to [`Scene`]: the header first, then each component from its own piece of the text.
//!
//! Components are cut out as raw pieces before they are read. Each piece knows its place in the file, so that a fault of the scene
//! as a whole (two shapes, a film too coarse) points at the component as well as a fault of its own does.

use froth_components::authored::liquid::{Atmosphere, Liquid};
use froth_components::authored::method::{MethodChoice, MethodName};
use froth_components::authored::resolution::Resolution;
use froth_components::quantity::{Rate, Time, nearest, range};
use ron::value::RawValue;
use serde::Deserialize;

use super::error::SceneError;
use super::header::SceneHeader;
use super::registry::AuthoredRegistry;
use super::ron_text::{Block, Fault, Fields, options, short};
use super::text::{SceneText, Tokens, quote};
use super::{AuthoredComponent, AuthoredEntity, Scene};

/// A scene file, with what is read later still as text.
#[derive(Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields)]
struct SceneFile<'a> {
    title: String,
    #[serde(borrow)]
    method: &'a RawValue,
    #[serde(borrow)]
    resolution: &'a RawValue,
    #[serde(deserialize_with = "range::positive")]
    duration: Time,
    #[serde(default = "usual_frame_rate", deserialize_with = "range::positive")]
    frames_per_second: Rate,
    #[serde(default)]
    seed: u64,
    #[serde(default)]
    liquid: Liquid,
    #[serde(default)]
    atmosphere: Atmosphere,
    #[serde(default, deserialize_with = "range::positive_if_given")]
    maximum_step: Option<Time>,
    #[serde(borrow, default)]
    picture: Option<&'a RawValue>,
    #[serde(borrow)]
    entities: Vec<Vec<&'a RawValue>>,
}

fn usual_frame_rate() -> Rate {
    Rate::from_si(50.0)
}

/// Reads a scene from its text.
pub(super) fn scene(file: &SceneText, registry: &AuthoredRegistry) -> Result<Scene, SceneError> {
    let text = file.text();
    if Tokens::of(text).next().is_none() {
        return Err(SceneError::Empty { name: file.name().to_owned() });
    }
    let parsed: SceneFile<'_> = options().from_str(text).map_err(|error| {
        Fault { file, text, range: 0..text.len(), root: "Scene", fields: Fields::default() }.explain(error)
    })?;
    let block = |raw: &RawValue, root| block_of(file, raw, root);
    let resolution = block(parsed.resolution, "");
    let header = SceneHeader {
        title: parsed.title,
        method: method(&block(parsed.method, ""))?,
        resolution: resolution.read::<Resolution>()?,
        duration: parsed.duration,
        frames_per_second: parsed.frames_per_second,
        seed: parsed.seed,
        liquid: parsed.liquid,
        atmosphere: parsed.atmosphere,
        maximum_step: parsed.maximum_step,
    };
    let entities = parsed.entities.iter().map(|raws| entity(raws.iter().map(|raw| block(raw, "")), registry));
    Ok(Scene {
        header,
        entities: entities.collect::<Result<_, _>>()?,
        picture: parsed.picture.map(|raw| block(raw, "picture")),
        resolution: resolution.range(),
        file: file.clone(),
    })
}

/// The place in the file of a piece that the RON reader lent from it.
fn block_of(file: &SceneText, raw: &RawValue, root: &'static str) -> Block {
    let piece = raw.get_ron();
    let start = piece.as_ptr() as usize - file.text().as_ptr() as usize;
    Block::new(file, start..start + piece.len(), root)
}

/// The method; one that is unknown and one that does not exist yet are told apart.
fn method(block: &Block) -> Result<MethodChoice, SceneError> {
    let available = || MethodName::ALL.into_iter().filter(|method| method.is_available()).map(MethodName::in_scene);
    let known = || available().map(str::to_owned).collect();
    let file = block.file().clone();
    let Some(name) = block.name() else {
        return Err(wrong_block(block, "Scene.method", "a method, e.g. Melp(cfl: 0.99)"));
    };
    let at = file.span(block.name_range());
    match MethodName::from_scene(name) {
        None => {
            let nearest = nearest(name, MethodName::ALL.map(MethodName::in_scene)).map(str::to_owned);
            Err(SceneError::UnknownMethod { found: quote(name), nearest, known: known(), file, at })
        }
        Some(method) if !method.is_available() => {
            Err(SceneError::MethodNotAvailable { method: name.to_owned(), known: known(), file, at })
        }
        Some(_) => block.read(),
    }
}

/// An entity from the pieces of its components.
fn entity(blocks: impl Iterator<Item = Block>, registry: &AuthoredRegistry) -> Result<AuthoredEntity, SceneError> {
    let mut components: Vec<AuthoredComponent> = Vec::new();
    for block in blocks {
        let component = component(&block, registry)?;
        if let Some(first) = components.iter().find(|other| other.name == component.name) {
            return Err(SceneError::DuplicateComponent {
                component: component.name.to_owned(),
                file: block.file().clone(),
                at: block.file().span(component.range),
                first: block.file().span(first.range.clone()),
            });
        }
        components.push(component);
    }
    Ok(AuthoredEntity { components })
}

fn component(block: &Block, registry: &AuthoredRegistry) -> Result<AuthoredComponent, SceneError> {
    let Some(name) = block.name() else {
        return Err(wrong_block(block, "Scene.entities", "a component, e.g. Sphere(radius: \"5 cm\")"));
    };
    let Some(registered) = registry.get(name) else {
        let names = || registry.iter().map(|component| component.name);
        return Err(SceneError::UnknownComponent {
            found: quote(name),
            nearest: nearest(name, names()).map(str::to_owned),
            known: names().map(str::to_owned).collect(),
            file: block.file().clone(),
            at: block.file().span(block.name_range()),
        });
    };
    Ok(AuthoredComponent {
        name: registered.name,
        is_built_in: registered.is_built_in,
        value: block.read_by(registered.read)?,
        range: block.range(),
    })
}

fn wrong_block(block: &Block, field: &str, expected: &str) -> SceneError {
    SceneError::WrongType {
        field: field.to_owned(),
        message: format!("`{}` is not {}", quote(block.text()), short(expected)),
        help: format!("write {expected}"),
        file: block.file().clone(),
        at: block.file().span(block.range()),
    }
}
