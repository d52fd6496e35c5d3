//! One page per error code: what it means, a broken scene and the mended one. Tests run both.

/// Code and page, in order.
pub const PAGES: &[(&str, &str)] = &[];

/// The page of an error code such as `F0020`, in Markdown. Upper and lower case are the same.
#[must_use]
pub fn error_page(code: &str) -> Option<&'static str> {
    PAGES.iter().find(|(known, _)| known.eq_ignore_ascii_case(code)).map(|(_, page)| *page)
}
