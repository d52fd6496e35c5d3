//! Components by the name a scene file gives them.
//!
//! ```
//! # use froth::scene::AuthoredRegistry;
//! # use bevy_ecs::component::Component;
//! #[derive(Component, Clone, serde::Deserialize)]
//! #[serde(deny_unknown_fields)]
//! struct Fan { strength: f64 }
//!
//! let mut registry = AuthoredRegistry::built_in();
//! registry.register::<Fan>("Fan", "blows"); // a scene may now say [ Fan(strength: 3.0) ]
//! ```
//!
//! The built-in components are listed in [`builtin`](super::builtin).

use std::any::Any;
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use bevy_ecs::component::Component;
use bevy_ecs::world::EntityWorldMut;
use ron::error::SpannedResult;
use serde::Deserializer;
use serde::de::{Deserialize, DeserializeOwned, DeserializeSeed, EnumAccess, VariantAccess, Visitor};

use super::builtin;
use super::ron_text::options;

/// A component of any type, read from a scene.
pub(super) trait Authored: Any + Send + Sync {
    /// Gives a copy to an entity.
    fn insert_into(&self, entity: &mut EntityWorldMut<'_>);
}

impl<T: Component + Clone> Authored for T {
    fn insert_into(&self, entity: &mut EntityWorldMut<'_>) {
        entity.insert(self.clone());
    }
}

type Read = fn(&str) -> SpannedResult<Box<dyn Authored>>;

/// What the registry knows of a component.
#[derive(Clone, Copy)]
pub struct RegisteredComponent {
    /// Name in a scene file.
    pub name: &'static str,
    /// What it does, in one line.
    pub summary: &'static str,
    pub(super) read: Read,
    pub(super) is_built_in: bool,
}

impl fmt::Debug for RegisteredComponent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.name, self.summary)
    }
}

/// Components by the name a scene file gives them.
#[derive(Clone, Debug)]
pub struct AuthoredRegistry {
    components: BTreeMap<&'static str, RegisteredComponent>,
}

impl Default for AuthoredRegistry {
    fn default() -> Self {
        Self::built_in()
    }
}

impl AuthoredRegistry {
    /// All components of froth.
    #[must_use]
    pub fn built_in() -> Self {
        let mut registry = Self { components: BTreeMap::new() };
        builtin::register(&mut registry);
        for component in registry.components.values_mut() {
            component.is_built_in = true;
        }
        registry
    }

    /// Lets scene files write `name(...)` for a component of your own. `summary`: what it does, in one line.
    ///
    /// A name that exists is replaced: yours wins over the built-in one.
    pub fn register<T: Component + Clone + DeserializeOwned>(&mut self, name: &'static str, summary: &'static str) {
        self.components.insert(name, RegisteredComponent { name, summary, read: read::<T>, is_built_in: false });
    }

    /// All components in alphabetical order, for listings.
    pub fn iter(&self) -> impl Iterator<Item = &RegisteredComponent> {
        self.components.values()
    }

    /// The component of a name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&RegisteredComponent> {
        self.components.get(name)
    }
}

/// Reads `Name(...)` as a `T`, whatever the name.
fn read<T: Component + Clone + DeserializeOwned>(text: &str) -> SpannedResult<Box<dyn Authored>> {
    let value = options().from_str_seed(text, Named::<T>(PhantomData))?;
    Ok(Box::new(value))
}

/// A value with a name before it, read as if it were a variant of an enum: that way RON names it in errors.
struct Named<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> DeserializeSeed<'de> for Named<T> {
    type Value = T;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<T, D::Error> {
        deserializer.deserialize_enum("", &[], self)
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for Named<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a component")
    }

    fn visit_enum<A: EnumAccess<'de>>(self, component: A) -> Result<T, A::Error> {
        let (AnyName, content) = component.variant()?;
        content.newtype_variant()
    }
}

/// The name itself, which was looked up before.
struct AnyName;

impl<'de> Deserialize<'de> for AnyName {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NameVisitor;
        impl Visitor<'_> for NameVisitor {
            type Value = AnyName;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a component")
            }

            fn visit_str<E: serde::de::Error>(self, _name: &str) -> Result<AnyName, E> {
                Ok(AnyName)
            }
        }
        deserializer.deserialize_identifier(NameVisitor)
    }
}
