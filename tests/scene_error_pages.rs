//! The pages of the error codes tell the truth: each broken scene gives its code, each mended one passes.

use froth::errors::{PAGES, error_page};
use froth::scene::{AuthoredRegistry, Scene, SceneError};
use froth_components::authored::method::MethodName;

/// Enough for every mended scene, and too little for a trillion particles, bytes.
const MEMORY: u64 = 8 << 30;

/// Faults of a file or of a user's program, which no text shows, and of a mesh, which only making it shows.
const WITHOUT_SCENES: [&str; 13] = [
    "F0001", "F0002", "F0004", "F0005", "F0006", "F0036", "F0063", "F0064", "F0065", "F0066", "F0067", "F0068", "F0069",
];

/// What the command line does: read, check for the method, check as a whole.
fn check(text: &str, option: Option<&str>) -> Result<(), SceneError> {
    // The folder of the mesh files that pages speak of.
    let scene = Scene::from_text("tests/meshes/page.ron", text, &AuthoredRegistry::built_in())?;
    if let Some(name) = option {
        let method = MethodName::ALL.into_iter().find(|method| method.on_command_line() == name);
        scene.check_honoured(method.unwrap_or_else(|| panic!("no method {name}")))?;
    }
    scene.check(MEMORY).map(|_| ())
}

/// Text and `--method` of the only block that begins with a fence.
fn block<'a>(page: &'a str, kind: &str) -> Option<(&'a str, Option<&'a str>)> {
    let (_, rest) = page.split_once(&format!("```ron {kind}"))?;
    let (option, rest) = rest.split_once('\n')?;
    let (text, _) = rest.split_once("```")?;
    Some((text, option.trim().strip_prefix("--method ")))
}

#[test]
fn each_broken_scene_gives_its_code() {
    for (code, page) in PAGES {
        let Some((text, option)) = block(page, "broken") else {
            assert!(WITHOUT_SCENES.contains(code), "{code} has no broken scene");
            continue;
        };
        let fault = check(text, option).expect_err(&format!("the broken scene of {code} passes"));
        assert_eq!(fault.stable_code(), *code, "{fault}");
    }
}

#[test]
fn each_mended_scene_passes() {
    for (code, page) in PAGES.iter().filter(|(code, _)| !WITHOUT_SCENES.contains(code)) {
        let (text, option) = block(page, "mended").unwrap_or_else(|| panic!("{code} has no mended scene"));
        check(text, option).unwrap_or_else(|fault| panic!("the mended scene of {code}: {fault}"));
    }
}

#[test]
fn each_code_has_one_page_which_begins_with_it() {
    let source = include_str!("../engine/scene/error.rs");
    let mut codes: Vec<&str> = source.split("code(F").skip(1).map(|rest| rest.split(')').next().unwrap()).collect();
    codes.sort_unstable();
    let pages: Vec<&str> = PAGES.iter().map(|(code, _)| code.strip_prefix('F').unwrap()).collect();
    assert_eq!(pages, codes);
    for (code, page) in PAGES {
        assert!(page.starts_with(&format!("# {code}: ")), "{code}");
    }
}

#[test]
fn a_page_is_found_by_its_code_in_any_case() {
    assert_eq!(error_page("f0020"), error_page("F0020"));
    assert!(error_page("F0020").is_some());
    assert_eq!(error_page("F9999"), None);
}
