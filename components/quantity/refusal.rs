//! A refused value as text that survives serde.
//!
//! Serde hands errors on as text alone. A [`Refusal`] therefore has a text form from which the scene loader reads back
//! which kind of fault it was and how to mend it: `[kind] message`, then the help on its own lines.

use std::fmt;

/// Why a value of a scene file was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefusalKind {
    /// The unit does not exist.
    UnknownUnit,
    /// The unit exists and belongs to another dimension.
    WrongDimension,
    /// Not a number, or infinite.
    NotFinite,
    /// Outside what the field can take.
    OutOfRange,
    /// Not a value of the kind wanted at all.
    WrongType,
    /// Two values of one component contradict each other.
    Contradiction,
}

impl RefusalKind {
    const ALL: [(Self, &'static str); 6] = [
        (Self::UnknownUnit, "unknown unit"),
        (Self::WrongDimension, "wrong dimension"),
        (Self::NotFinite, "not finite"),
        (Self::OutOfRange, "out of range"),
        (Self::WrongType, "wrong type"),
        (Self::Contradiction, "contradiction"),
    ];

    fn text(self) -> &'static str {
        Self::ALL.iter().find(|(kind, _)| *kind == self).map_or("", |(_, text)| text)
    }
}

/// A refused value: what is wrong, and what to write instead.
///
/// A component of your own refuses a value from its `Deserialize` by `Refusal::new(..).into_serde()`; the loader adds file, line and caret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// Which kind of fault.
    pub kind: RefusalKind,
    /// What is wrong, on one line.
    pub message: String,
    /// What to write instead.
    pub help: String,
}

impl Refusal {
    /// A refusal from its parts.
    pub fn new(kind: RefusalKind, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { kind, message: message.into(), help: help.into() }
    }

    /// The error a `Deserialize` returns.
    pub fn into_serde<E: serde::de::Error>(self) -> E {
        E::custom(self)
    }

    /// Reads the text form back; `None` for the text of any other error.
    #[must_use]
    pub fn from_text(text: &str) -> Option<Self> {
        let (kind, rest) = text.strip_prefix('[')?.split_once("] ")?;
        let &(kind, _) = RefusalKind::ALL.iter().find(|(_, name)| *name == kind)?;
        let (message, help) = rest.split_once('\n').unwrap_or((rest, ""));
        Some(Self::new(kind, message, help))
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}] {}\n{}", self.kind.text(), self.message.replace('\n', " "), self.help)
    }
}

impl std::error::Error for Refusal {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_survives_its_text_form() {
        for (kind, _) in RefusalKind::ALL {
            let refusal = Refusal::new(kind, "a radius of -1 m", "a radius is greater than 0\nsuch as 0.05");
            assert_eq!(Refusal::from_text(&refusal.to_string()), Some(refusal));
        }
    }

    #[test]
    fn the_text_of_another_error_is_no_refusal() {
        assert_eq!(Refusal::from_text("[odd] thing"), None);
        assert_eq!(Refusal::from_text("missing field"), None);
    }
}
