//! Where in a scene file a fault is, and the code that names its kind.

use miette::Diagnostic;

use super::SceneError;

/// A place in a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

impl SceneError {
    /// Stable code, such as `F0020`.
    #[must_use]
    pub fn stable_code(&self) -> String {
        self.code().map(|code| code.to_string()).unwrap_or_default()
    }

    /// Where the fault is; `None` where it is the file as a whole.
    #[must_use]
    pub fn place(&self) -> Option<Place> {
        let at = self.labels()?.next()?;
        let contents = self.source_code()?.read_span(at.inner(), 0, 0).ok()?;
        Some(Place {
            file: contents.name().unwrap_or_default().to_owned(),
            line: contents.line() + 1,
            column: contents.column() + 1,
        })
    }
}
