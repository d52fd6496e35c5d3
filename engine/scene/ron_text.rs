//! From the words of the RON reader to a [`SceneError`] that points at a token and names the field.

use std::borrow::Cow;
use std::ops::Range;

use froth_components::quantity::{Refusal, RefusalKind, nearest};
use miette::SourceSpan;
use ron::error::{Error as RonError, SpannedError, SpannedResult};
use ron::extensions::Extensions;
use serde::de::DeserializeOwned;

use super::error::SceneError;
use super::text::{self, SceneText, Surroundings, Tokens, is_identifier, quote};

/// Brackets within brackets; also what keeps a hostile file from overflowing the stack.
const MOST_LEVELS: usize = 64;

/// How all of a scene file is read: `Melp(cfl: 1)` without double brackets, and optional fields without `Some`.
pub(super) fn options() -> ron::Options {
    ron::Options::default()
        .with_default_extension(Extensions::UNWRAP_VARIANT_NEWTYPES)
        .with_default_extension(Extensions::IMPLICIT_SOME)
        // Each level of brackets costs the reader about three levels of its own.
        .with_recursion_limit(3 * MOST_LEVELS)
}

/// One value of a scene file, still as text.
#[derive(Clone, Debug)]
pub struct Block {
    file: SceneText,
    range: Range<usize>,
    /// The field it is the value of, where the text begins with no name of its own.
    root: &'static str,
}

impl Block {
    /// The part of a file without the spaces and comments around it.
    pub(super) fn new(file: &SceneText, range: Range<usize>, root: &'static str) -> Self {
        let mut tokens = Tokens::of(&file.text()[range.clone()]);
        let first = tokens.next().unwrap_or(0..0);
        let end = tokens.last().map_or(first.end, |last| last.end);
        Self { file: file.clone(), range: range.start + first.start..range.start + end, root }
    }

    /// The file it is in.
    pub(super) fn file(&self) -> &SceneText {
        &self.file
    }

    /// Where in the file, bytes.
    #[must_use]
    pub fn range(&self) -> Range<usize> {
        self.range.clone()
    }

    /// The text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.file.text()[self.range.clone()]
    }

    /// The name it begins with, as `Sphere` in `Sphere(radius: 1)`.
    pub(super) fn name(&self) -> Option<&str> {
        let first = Tokens::of(self.text()).next().map(|token| &self.text()[token])?;
        is_identifier(first).then_some(first)
    }

    /// Where the name is, bytes.
    pub(super) fn name_range(&self) -> Range<usize> {
        let length = Tokens::of(self.text()).next().map_or(0, |token| token.len());
        self.range.start..self.range.start + length
    }

    /// Reads the value. A bare name is a name with nothing in its brackets: `Hover` is `Hover()`.
    pub(super) fn read_by<T>(&self, read: impl Fn(&str) -> SpannedResult<T>) -> Result<T, SceneError> {
        let text =
            if is_identifier(self.text()) { Cow::from(format!("{}()", self.text())) } else { Cow::from(self.text()) };
        read(&text).map_err(|error| {
            let fields = Fields::of(self.name().unwrap_or_default(), &read);
            Fault { file: &self.file, text: &text, range: self.range(), root: self.root, fields }.explain(error)
        })
    }

    /// An error at the value that the block gives to a field, or at all of it where it gives none.
    pub(crate) fn out_of_range(&self, field: &str, message: String, help: String) -> SceneError {
        let (field, at) = self.place_of(field);
        SceneError::OutOfRange { field, message, help, file: self.file.clone(), at }
    }

    /// An error at the name that the block gives to a field.
    pub(crate) fn no_choice(&self, field: &str, found: &str, nearest: Option<&str>, known: &[&str]) -> SceneError {
        let (field, at) = self.place_of(field);
        let (found, nearest) = (quote(found), nearest.map(str::to_owned));
        SceneError::UnknownChoice { found, field, nearest, known: owned(known), file: self.file.clone(), at }
    }

    /// Path and place of the value of a field.
    fn place_of(&self, field: &str) -> (String, SourceSpan) {
        match text::value_of(self.text(), field) {
            Some(value) => {
                let path = Surroundings::at(self.text(), value.start).path(self.text());
                let place = self.range.start + value.start..self.range.start + value.end;
                (format!("{}.{path}", self.root), self.file.span(place))
            }
            None => (self.root.to_owned(), self.file.span(self.range())),
        }
    }

    /// Reads the value as settings of your own; a fault is reported at its place in the scene file.
    ///
    /// # Errors
    /// When the text does not describe a `T`.
    pub fn read<T: DeserializeOwned>(&self) -> Result<T, SceneError> {
        self.read_by(|text| options().from_str(text))
    }
}

/// What is known of the named fields of a value.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fields {
    /// All of them; none where the value has no named fields.
    names: &'static [&'static str],
    /// The first that has no default.
    needed: Option<&'static str>,
}

impl Fields {
    /// Of what `read` reads: it is asked for a field that does not exist, and for a value without fields.
    fn of<T>(name: &str, read: impl Fn(&str) -> SpannedResult<T>) -> Self {
        let fault = |fields: &str| read(&format!("{name}({fields})")).err().map(|error| error.code);
        let names = match fault("no_such_field: 0") {
            Some(RonError::NoSuchStructField { expected, found, .. }) if found == "no_such_field" => expected,
            _ => &[],
        };
        let needed = match fault("") {
            Some(RonError::MissingStructField { field, .. }) => Some(field),
            _ => None,
        };
        Self { names, needed }
    }

    /// Which one to write first.
    fn first(&self) -> Option<&'static str> {
        self.needed.or(self.names.first().copied())
    }
}

/// A text the RON reader gave up on, and where it stands in the file.
pub(super) struct Fault<'a> {
    pub(super) file: &'a SceneText,
    /// What was read: `range` of the file, perhaps with empty brackets added at the end.
    pub(super) text: &'a str,
    pub(super) range: Range<usize>,
    /// What a value outside all names belongs to.
    pub(super) root: &'static str,
    /// Fields of the whole text's value, as far as they are known.
    pub(super) fields: Fields,
}

impl Fault<'_> {
    /// The error a person should see.
    pub(super) fn explain(&self, error: SpannedError) -> SceneError {
        let cursor = text::offset_of(self.text, error.span.end);
        match error.code {
            RonError::Message(message) => self.refused(message, cursor),
            RonError::NoSuchStructField { expected, found, .. } => self.unknown_field(&found, expected, cursor),
            RonError::NoSuchEnumVariant { expected, found, .. } => self.unknown_choice(&found, expected, cursor),
            RonError::MissingStructField { field, .. } => self.missing_field(field, cursor),
            RonError::DuplicateStructField { field, .. } => self.duplicate_field(field, cursor),
            RonError::ExpectedIdentifier | RonError::SuggestRawIdentifier(_) if self.wants_a_field(cursor) => {
                self.unnamed_field(cursor)
            }
            RonError::SuggestRawIdentifier(_) => self.wrong_type("a name", self.token_at(cursor)),
            RonError::ExceededRecursionLimit => {
                SceneError::TooDeep { file: self.file.clone(), at: self.in_file(self.token_at(cursor)) }
            }
            RonError::InvalidValueForType { expected, .. } => self.wrong_type(&expected, self.value_before(cursor)),
            RonError::ExpectedDifferentLength { expected, .. } => {
                self.wrong_type(&expected, self.innermost(cursor).unwrap_or_else(|| self.value_before(cursor)))
            }
            code => match expected_value(&code) {
                Some(expected) if is_after_value(&code) => self.wrong_type(&expected, self.value_before(cursor)),
                Some(expected) if cursor < self.text.len() => self.wrong_type(&expected, self.token_at(cursor)),
                _ => self.syntax(&code, cursor),
            },
        }
    }

    /// A value refused after it was read.
    fn refused(&self, message: String, cursor: usize) -> SceneError {
        let file = self.file.clone();
        let Some(Refusal { kind, message, help }) = Refusal::from_text(&message) else {
            let at = self.innermost(cursor).unwrap_or_else(|| self.value_before(cursor));
            return SceneError::Refused { field: self.owner(cursor), message, file, at: self.in_file(at) };
        };
        if kind == RefusalKind::Contradiction {
            let at = self.innermost(cursor).unwrap_or_else(|| self.value_before(cursor));
            let field = self.owner(cursor);
            return SceneError::Contradiction { field, message, help, file, at: self.in_file(at) };
        }
        let value = self.value_before(cursor);
        let field = self.path(value.start);
        let at = self.in_file(value);
        match kind {
            RefusalKind::UnknownUnit => SceneError::UnknownUnit { field, message, help, file, at },
            RefusalKind::WrongDimension => SceneError::WrongDimension { field, message, help, file, at },
            RefusalKind::NotFinite => SceneError::NotFinite { field, message, help, file, at },
            RefusalKind::WrongType => SceneError::WrongType { field, message, help, file, at },
            RefusalKind::OutOfRange | RefusalKind::Contradiction => {
                SceneError::OutOfRange { field, message, help, file, at }
            }
        }
    }

    fn unknown_field(&self, found: &str, known: &[&str], cursor: usize) -> SceneError {
        SceneError::UnknownField {
            owner: self.owner(cursor),
            found: quote(found),
            nearest: nearest(found, known.iter().copied()).map(str::to_owned),
            known: owned(known),
            file: self.file.clone(),
            at: self.in_file(self.value_before(cursor)),
        }
    }

    fn unknown_choice(&self, found: &str, known: &[&str], cursor: usize) -> SceneError {
        let at = self.value_before(cursor);
        SceneError::UnknownChoice {
            field: self.path(at.start),
            found: quote(found),
            nearest: nearest(found, known.iter().copied()).map(str::to_owned),
            known: owned(known),
            file: self.file.clone(),
            at: self.in_file(at),
        }
    }

    /// Whether a field begins at `cursor`: after a bracket or a comma, not after a colon.
    fn wants_a_field(&self, cursor: usize) -> bool {
        let found = self.token_at(cursor);
        let before = Tokens::of(self.text).take_while(|token| token.end <= found.start).last();
        before.is_some_and(|token| matches!(&self.text[token], "(" | ","))
    }

    /// A value without the name of its field.
    fn unnamed_field(&self, cursor: usize) -> SceneError {
        let found = self.token_at(cursor);
        let found = text::value_before(self.text, found.end).unwrap_or(found);
        let owner = self.owner(found.start + 1);
        let is_outermost = Surroundings::at(self.text, found.start).depth() == 1;
        let help = match self.fields.first().filter(|_| is_outermost) {
            Some(first) => format!("write `{owner}({first}: ...)`; fields: {}", self.fields.names.join(", ")),
            None => "write `name: value`".to_owned(),
        };
        SceneError::WrongType {
            message: format!("`{}` stands where a named field is wanted", quote(&self.text[found.clone()])),
            field: owner,
            help,
            file: self.file.clone(),
            at: self.in_file(found),
        }
    }

    fn missing_field(&self, field: &str, cursor: usize) -> SceneError {
        SceneError::MissingField {
            owner: self.owner(cursor),
            field: field.to_owned(),
            file: self.file.clone(),
            at: self.in_file(self.innermost(cursor).unwrap_or(0..self.text.len())),
        }
    }

    fn duplicate_field(&self, field: &str, cursor: usize) -> SceneError {
        SceneError::DuplicateField {
            owner: self.owner(cursor),
            field: field.to_owned(),
            file: self.file.clone(),
            at: self.in_file(self.value_before(cursor)),
        }
    }

    fn wrong_type(&self, expected: &str, found: Range<usize>) -> SceneError {
        SceneError::WrongType {
            field: self.path(found.start),
            message: format!("`{}` is not {}", quote(&self.text[found.clone()]), short(expected)),
            help: format!("write {expected}"),
            file: self.file.clone(),
            at: self.in_file(found),
        }
    }

    fn syntax(&self, code: &RonError, cursor: usize) -> SceneError {
        let unclosed = if cursor >= self.text.len() { self.innermost(cursor) } else { None };
        let over_lines = text::text_over_lines(self.text, cursor);
        let help = match code {
            _ if over_lines.is_some() => "this text goes on over several lines; is its closing \" missing?",
            _ if unclosed.is_some() => "the bracket opened here is never closed",
            RonError::ExpectedComma => "values are separated by commas; is one missing before this?",
            RonError::ExpectedStringEnd => "the text begins here and has no closing \"",
            RonError::UnclosedBlockComment => "the comment has no closing */",
            RonError::ExpectedMapColon => "a field is written `name: value`",
            _ => "look for a missing comma, bracket or quote just before this place",
        };
        let problem = lower_first(&code.to_string());
        let at = self.in_file(over_lines.or(unclosed).unwrap_or_else(|| self.token_at(cursor)));
        SceneError::Syntax { problem, help, file: self.file.clone(), at }
    }

    /// Path of the field that the token before `cursor` belongs to.
    fn path(&self, cursor: usize) -> String {
        let path = Surroundings::at(self.text, cursor).path(self.text);
        match (path.is_empty(), self.root.is_empty() || is_named(self.text)) {
            (true, _) => self.root.to_owned(),
            (false, true) => quote(&path),
            (false, false) => quote(&format!("{}.{path}", self.root)),
        }
    }

    /// What the fields at `cursor` belong to.
    fn owner(&self, cursor: usize) -> String {
        let owner = Surroundings::at(self.text, cursor).owner(self.text);
        if owner.is_empty() { self.root.to_owned() } else { quote(&owner) }
    }

    fn innermost(&self, cursor: usize) -> Option<Range<usize>> {
        Surroundings::at(self.text, cursor).innermost(self.text)
    }

    fn value_before(&self, cursor: usize) -> Range<usize> {
        text::value_before(self.text, cursor).unwrap_or(cursor..cursor)
    }

    fn token_at(&self, cursor: usize) -> Range<usize> {
        text::token_after(self.text, cursor).unwrap_or_else(|| self.value_before(cursor))
    }

    /// A range of the read text as a range of the file.
    fn in_file(&self, range: Range<usize>) -> SourceSpan {
        let place = |offset: usize| (self.range.start + offset).min(self.range.end);
        self.file.span(place(range.start)..place(range.end))
    }
}

/// Whether a text begins with a name, as in `Sphere(...)`.
fn is_named(text: &str) -> bool {
    Tokens::of(text).next().is_some_and(|token| is_identifier(&text[token]))
}

/// What the reader wanted instead of the token it stands before; `None` for punctuation, which is a matter of syntax.
fn expected_value(code: &RonError) -> Option<String> {
    Some(match code {
        RonError::ExpectedBoolean => "true or false".to_owned(),
        RonError::ExpectedString => "a text in quotes, e.g. \"two bubbles\"".to_owned(),
        RonError::ExpectedFloat => "a number".to_owned(),
        RonError::ExpectedInteger | RonError::InvalidIntegerDigit { .. } | RonError::IntegerOutOfBounds => {
            "a whole number of 0 or more".to_owned()
        }
        RonError::ExpectedArray => "a list in square brackets, `[ ... ]`".to_owned(),
        RonError::ExpectedIdentifier => "a name".to_owned(),
        RonError::ExpectedNamedStructLike(name) if !name.is_empty() => format!("`{name}( ... )`"),
        RonError::ExpectedDifferentStructName { expected, .. } => format!("`{expected}( ... )`"),
        RonError::ExpectedStructLike | RonError::ExpectedNamedStructLike(_) => {
            "fields in brackets, `( ... )`".to_owned()
        }
        _ => return None,
    })
}

/// Whether the reader stands after the value it refuses, not before.
fn is_after_value(code: &RonError) -> bool {
    matches!(code, RonError::IntegerOutOfBounds | RonError::ExpectedDifferentStructName { .. })
}

/// What is wanted, without the example.
pub(super) fn short(expected: &str) -> &str {
    expected.split_once(", e.g.").map_or(expected, |(short, _example)| short)
}

fn owned(names: &[&str]) -> Box<[String]> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

fn lower_first(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map(|first| first.to_lowercase().chain(letters).collect()).unwrap_or_default()
}
