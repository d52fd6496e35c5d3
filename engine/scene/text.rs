//! The text of a scene file: its tokens, places in it, and how much of it an error shows.
//!
//! The RON reader says where it stood when it gave up. [`SceneText`] turns that into the token a person would point at,
//! and into the path of the field it belongs to (`Film.thickness.mean`).

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

/// Longest piece of a file that an error repeats in a sentence, characters.
const QUOTE_LENGTH: usize = 40;
/// Longest piece of a file that an error points at, bytes.
const POINTED_LENGTH: usize = 400;
/// Longest excerpt of a file that an error shows, bytes; more is one endless line.
const EXCERPT_LENGTH: usize = 1600;
/// Bytes shown on either side of the fault in an endless line.
const EXCERPT_MARGIN: usize = 40;

/// Name and text of a scene file. Cheap to clone: every error carries it.
#[derive(Clone)]
pub struct SceneText(Arc<Named>);

struct Named {
    name: String,
    text: String,
}

impl SceneText {
    /// A text under the name that errors show.
    #[must_use]
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self(Arc::new(Named { name: name.into(), text: text.into() }))
    }

    /// Name that errors show.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.0.name
    }

    /// The whole text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.0.text
    }

    /// The bytes an error points at, cut where they would fill the screen.
    pub(super) fn span(&self, range: Range<usize>) -> SourceSpan {
        let end = range.end.min(self.text().floor_char_boundary(range.start + POINTED_LENGTH));
        (range.start..end.max(range.start)).into()
    }

    /// Line and column of a byte offset, both from 1.
    #[must_use]
    pub fn line_and_column(&self, offset: usize) -> (usize, usize) {
        let before = self.text().get(..offset).unwrap_or(self.text());
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        (1 + before.matches('\n').count(), 1 + before[line_start..].chars().count())
    }
}

impl fmt::Debug for SceneText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("SceneText").field(&self.name()).finish_non_exhaustive()
    }
}

impl SourceCode for SceneText {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let whole = self.text().read_span(span, lines_before, lines_after)?;
        let (data, shown, line, column) = if whole.data().len() <= EXCERPT_LENGTH {
            (whole.data(), *whole.span(), whole.line(), whole.column())
        } else {
            let range = self.excerpt(span);
            let (line, column) = self.line_and_column(range.start);
            (&self.text().as_bytes()[range.clone()], range.into(), line - 1, column - 1)
        };
        let name = self.name().to_owned();
        Ok(Box::new(MietteSpanContents::new_named(name, data, shown, line, column, whole.line_count())))
    }
}

impl SceneText {
    /// The fault and a little around it, within its line.
    fn excerpt(&self, span: &SourceSpan) -> Range<usize> {
        let text = self.text();
        let line_start = text[..span.offset()].rfind('\n').map_or(0, |newline| newline + 1);
        let start = text.floor_char_boundary(span.offset().saturating_sub(EXCERPT_MARGIN)).max(line_start);
        let end = text.floor_char_boundary((span.offset() + span.len().max(1) + EXCERPT_MARGIN).min(text.len()));
        start..end.max(start)
    }
}

/// A piece of a file as a sentence may repeat it: short, on one line, without control characters.
pub(super) fn quote(piece: &str) -> String {
    let mut quoted: String = piece.chars().take(QUOTE_LENGTH).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if piece.chars().nth(QUOTE_LENGTH).is_some() {
        quoted.push('…');
    }
    quoted
}

/// Byte offset of a place of the RON reader (line and column from 1, columns in characters).
pub(super) fn offset_of(text: &str, position: ron::error::Position) -> usize {
    let line_start = match position.line.checked_sub(2) {
        None => 0,
        Some(newlines) => text.match_indices('\n').nth(newlines).map_or(text.len(), |(newline, _)| newline + 1),
    };
    let column = position.col.saturating_sub(1);
    text[line_start..].char_indices().nth(column).map_or(text.len(), |(offset, _)| line_start + offset)
}

/// Tokens of a RON text as byte ranges, without spaces and comments. Never fails: what is no token is one character.
pub(super) struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Tokens<'a> {
    pub(super) fn of(text: &'a str) -> Self {
        Self { text, at: 0 }
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn skip_spaces_and_comments(&mut self) {
        loop {
            let rest = self.rest();
            let trimmed = rest.trim_start_matches(|c: char| c.is_whitespace() || matches!(c, '\u{200E}' | '\u{200F}'));
            self.at += rest.len() - trimmed.len();
            let comment = match trimmed.get(..2) {
                Some("//") => trimmed.find('\n').unwrap_or(trimmed.len()),
                Some("/*") => block_comment_length(trimmed),
                _ => return,
            };
            self.at += comment;
        }
    }
}

impl Iterator for Tokens<'_> {
    type Item = Range<usize>;

    fn next(&mut self) -> Option<Range<usize>> {
        self.skip_spaces_and_comments();
        let start = self.at;
        let length = token_length(self.rest())?;
        self.at += length;
        Some(start..self.at)
    }
}

/// Length of the token a text begins with.
fn token_length(text: &str) -> Option<usize> {
    let first = text.chars().next()?;
    let number_continues = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
    Some(match first {
        '"' => string_length(text, '"'),
        '\'' => character_length(text),
        'r' if raw_string_length(text).is_some() => raw_string_length(text)?,
        'b' if text[1..].starts_with('"') => 1 + string_length(&text[1..], '"'),
        _ if first.is_alphabetic() || first == '_' => {
            text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len())
        }
        '0'..='9' | '+' | '-' | '.' => {
            let mut previous = ' ';
            let mut is_part = |(at, c): (usize, char)| {
                let part = at == 0 || number_continues(c) || (matches!(c, '+' | '-') && matches!(previous, 'e' | 'E'));
                previous = c;
                part
            };
            text.char_indices().find(|&place| !is_part(place)).map_or(text.len(), |(at, _)| at)
        }
        other => other.len_utf8(),
    })
}

/// Length of a quoted piece with its quotes; to the end if it is never closed.
fn string_length(text: &str, quote: char) -> usize {
    let mut escaped = false;
    for (at, letter) in text.char_indices().skip(1) {
        if letter == quote && !escaped {
            return at + 1;
        }
        escaped = letter == '\\' && !escaped;
    }
    text.len()
}

/// A character literal is short; a lone quote is a token of its own.
fn character_length(text: &str) -> usize {
    let literal = text.char_indices().nth(12).map_or(text, |(end, _)| &text[..end]);
    let length = string_length(literal, '\'');
    if length > 1 && literal[..length].ends_with('\'') { length } else { 1 }
}

/// Length of `r"..."` or `r#"..."#`; `None` if the text does not begin with one.
fn raw_string_length(text: &str) -> Option<usize> {
    let hashes = text[1..].bytes().take_while(|byte| *byte == b'#').count();
    let body = text[1 + hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    Some(body.find(&end).map_or(text.len(), |at| 2 + hashes + at + end.len()))
}

/// Length of a block comment, which may contain others; to the end if it is never closed.
fn block_comment_length(text: &str) -> usize {
    let mut depth = 0_usize;
    let mut at = 0;
    while let Some(next) = text[at..].find(['/', '*']) {
        at += next;
        match text.get(at..at + 2) {
            Some("/*") => (depth, at) = (depth + 1, at + 2),
            Some("*/") => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

/// Where a token stands: inside which brackets, under which names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Surroundings {
    open: Vec<Bracket>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Bracket {
    /// The bracket itself.
    at: Range<usize>,
    /// Name before it, as in `Sphere(`.
    name: Option<Range<usize>>,
    /// Name of the field being read, as in `radius:`.
    key: Option<Range<usize>>,
}

impl Surroundings {
    /// Of the last token that begins before `cursor`.
    pub(super) fn at(text: &str, cursor: usize) -> Self {
        let mut open: Vec<Bracket> = Vec::new();
        let mut name: Option<Range<usize>> = None;
        for token in Tokens::of(text).take_while(|token| token.start < cursor) {
            let mut next_name = None;
            match text.as_bytes()[token.start] {
                b'(' | b'[' | b'{' => open.push(Bracket { at: token, name, key: None }),
                b')' | b']' | b'}' => drop(open.pop()),
                b':' => set_key(&mut open, name),
                b',' => set_key(&mut open, None),
                _ => next_name = is_identifier(&text[token.clone()]).then_some(token),
            }
            name = next_name;
        }
        Self { open }
    }

    /// Brackets around.
    pub(super) fn depth(&self) -> usize {
        self.open.len()
    }

    /// Path of the field, such as `Film.thickness.mean`; empty outside all brackets.
    pub(super) fn path(&self, text: &str) -> String {
        let first = self.open.first().and_then(|bracket| bracket.name.clone());
        let keys = self.open.iter().filter_map(|bracket| bracket.key.clone());
        first.into_iter().chain(keys).map(|range| &text[range]).collect::<Vec<_>>().join(".")
    }

    /// The innermost bracket: with the name before it, or else all of it.
    pub(super) fn innermost(&self, text: &str) -> Option<Range<usize>> {
        self.open.last().map(|bracket| match &bracket.name {
            Some(name) => name.start..bracket.at.end,
            None => through_closing_bracket(text, bracket.at.clone()),
        })
    }

    /// What the innermost bracket describes: the name before it, or else the field it is the value of.
    pub(super) fn owner(mut self, text: &str) -> String {
        let Some(innermost) = self.open.pop() else { return String::new() };
        innermost.name.map_or_else(|| self.path(text), |name| text[name].to_owned())
    }
}

fn set_key(open: &mut [Bracket], key: Option<Range<usize>>) {
    if let Some(bracket) = open.last_mut() {
        bracket.key = key;
    }
}

/// Whether a token is a name.
pub(super) fn is_identifier(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_') && token.chars().all(|c| c.is_alphanumeric() || c == '_')
}

/// The value whose last token ends at or before `cursor`: one token, or all from bracket to bracket with the name before it.
pub(super) fn value_before(text: &str, cursor: usize) -> Option<Range<usize>> {
    let mut open: Vec<Range<usize>> = Vec::new();
    let mut name: Option<Range<usize>> = None;
    let mut value = None;
    for token in Tokens::of(text).take_while(|token| token.end <= cursor) {
        let mut next_name = None;
        value = Some(token.clone());
        match text.as_bytes()[token.start] {
            b'(' | b'[' | b'{' => open.push(name.map_or(token.start, |name| name.start)..token.end),
            b')' | b']' | b'}' => value = open.pop().map(|opening| opening.start..token.end).or(value),
            _ => next_name = is_identifier(&text[token.clone()]).then_some(token),
        }
        name = next_name;
    }
    value.map(|value| through_closing_bracket(text, value))
}

/// The first value that a text gives to a field of this name.
pub(super) fn value_of(text: &str, field: &str) -> Option<Range<usize>> {
    let mut tokens = Tokens::of(text).peekable();
    while let Some(token) = tokens.next() {
        if &text[token] == field && tokens.next_if(|next| &text[next.clone()] == ":").is_some() {
            let first = tokens.next()?;
            let bracket =
                tokens.peek().filter(|next| is_identifier(&text[first.clone()]) && &text[(*next).clone()] == "(");
            let last = bracket.map_or_else(|| first.clone(), Clone::clone);
            return Some(first.start..through_closing_bracket(text, last).end);
        }
    }
    None
}

/// The token that `cursor` is in, or else the next one.
pub(super) fn token_after(text: &str, cursor: usize) -> Option<Range<usize>> {
    Tokens::of(text).find(|token| token.end > cursor)
}

/// The last text before `cursor` that goes on over more than one line: most likely its closing quote is missing.
pub(super) fn text_over_lines(text: &str, cursor: usize) -> Option<Range<usize>> {
    let tokens = Tokens::of(text).take_while(|token| token.start < cursor);
    let last =
        tokens.filter(|token| text[token.clone()].starts_with('"') && text[token.clone()].contains('\n')).last()?;
    let first_line = text[last.clone()].lines().next().map_or(0, str::len);
    Some(last.start..last.start + first_line)
}

/// Extends an opening bracket to its closing one.
fn through_closing_bracket(text: &str, token: Range<usize>) -> Range<usize> {
    let mut depth = 0_usize;
    if !matches!(text[token.clone()].chars().next(), Some('(' | '[' | '{')) {
        return token;
    }
    for next in Tokens::of(&text[token.start..]) {
        match text.as_bytes()[token.start + next.start] {
            b'(' | b'[' | b'{' => depth += 1,
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return token.start..token.start + next.end;
        }
    }
    token
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn tokens(text: &str) -> Vec<&str> {
        Tokens::of(text).map(|token| &text[token]).collect()
    }

    #[test]
    fn a_text_falls_into_tokens() {
        let text = r##"Scene(a: -1.5e-3, /* b /* c */ */ d: "x\"y", // e
            f: r#"g"h"#, 'i', b"j", [r, 0x1F])"##;
        let wanted = [
            "Scene",
            "(",
            "a",
            ":",
            "-1.5e-3",
            ",",
            "d",
            ":",
            r#""x\"y""#,
            ",",
            "f",
            ":",
            r##"r#"g"h"#"##,
            ",",
            "'i'",
            ",",
            r#"b"j""#,
            ",",
            "[",
            "r",
            ",",
            "0x1F",
            "]",
            ")",
        ];
        assert_eq!(tokens(text), wanted);
    }

    #[test]
    fn what_is_never_closed_ends_with_the_text() {
        assert_eq!(tokens("a \"b"), ["a", "\"b"]);
        assert_eq!(tokens("a /* b"), ["a"]);
        assert_eq!(tokens("' a"), ["'", "a"]);
    }

    #[test]
    fn a_place_knows_its_path() {
        let text = "Film(surfactant: Uniform, thickness: Noise(relative: 0.1, mean: \"5 kg\"))";
        let surroundings = Surroundings::at(text, text.find("\"5 kg").unwrap());
        assert_eq!(surroundings.path(text), "Film.thickness.mean");
        assert_eq!(surroundings.owner(text), "Noise");
        let text = "Scene(liquid: (density: 1))";
        assert_eq!(Surroundings::at(text, text.find('1').unwrap()).owner(text), "Scene.liquid");
    }

    #[test]
    fn an_opening_bracket_reaches_to_its_closing_one() {
        let text = "a: (1, (2), \")\"), b: 3";
        assert_eq!(value_before(text, 4).map(|range| &text[range]), Some("(1, (2), \")\")"));
        assert_eq!(value_before("a: B(1, 2)", 10), Some(3..10));
        assert_eq!(token_after(text, 4).map(|range| &text[range]), Some("1"));
    }

    #[test]
    fn the_value_of_a_field_is_found() {
        let text = "(size: 5, /* width: 1 */ width: 640, look: Map(range: (0, 1)))";
        let of = |field| value_of(text, field).map(|range| &text[range]);
        assert_eq!((of("width"), of("range")), (Some("640"), Some("(0, 1)")));
        assert_eq!((of("look"), of("height")), (Some("Map(range: (0, 1))"), None));
    }

    #[test]
    fn an_endless_line_is_shown_in_part() {
        let text = SceneText::new("long.ron", "x".repeat(100_000));
        let shown = text.read_span(&(50_000..50_001).into(), 1, 1).unwrap();
        assert!(shown.data().len() < EXCERPT_LENGTH);
        assert_eq!((shown.line(), shown.column()), (0, 50_000 - EXCERPT_MARGIN));
    }

    proptest! {
        #[test]
        fn tokens_cover_any_text_in_order(text in "\\PC*|[ -~\n]*|[r#\"'/*b()x\\\\]*") {
            let mut end = 0;
            for token in Tokens::of(&text) {
                prop_assert!(token.start >= end && token.end > token.start);
                prop_assert!(text.get(token.clone()).is_some());
                end = token.end;
            }
            for cursor in 0..=text.len() {
                Surroundings::at(&text, cursor).path(&text);
                value_before(&text, cursor);
                token_after(&text, cursor);
            }
        }
    }
}
