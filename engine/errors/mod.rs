//! One page per error code: what it means, a broken scene and the mended one. Tests run both.
//!
//! A page is Markdown. Its blocks ```` ```ron broken ```` and ```` ```ron mended ```` are whole scenes; a `--method` after them is
//! the one that the command line would give.

macro_rules! pages {
    ($($code:literal)*) => {
        /// Code and page, in order of the codes.
        pub const PAGES: &[(&str, &str)] = &[$(($code, include_str!(concat!($code, ".md")))),*];
    };
}

pages! {
    "F0001" "F0002" "F0003" "F0004" "F0005" "F0006"
    "F0010" "F0011"
    "F0020" "F0021" "F0022" "F0023" "F0024" "F0025" "F0026" "F0027"
    "F0030" "F0031" "F0032" "F0033" "F0034" "F0035" "F0036"
    "F0040" "F0041" "F0042" "F0043" "F0044" "F0045" "F0046" "F0047"
    "F0050" "F0051" "F0052" "F0053"
    "F0060" "F0061" "F0062" "F0063" "F0064" "F0065" "F0066" "F0067" "F0068" "F0069"
}

/// The page of an error code such as `F0020`, in Markdown. Upper and lower case are the same.
#[must_use]
pub fn error_page(code: &str) -> Option<&'static str> {
    PAGES.iter().find(|(known, _)| known.eq_ignore_ascii_case(code)).map(|(_, page)| *page)
}
