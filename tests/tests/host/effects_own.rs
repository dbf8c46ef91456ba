//! An effect is known to its own file, the catalogue and the simulated machine: no file of the tracer, of the compensation or of the
//! reports names one. What they need to know of it, it declares.

use std::fs;

use model::effects::names;

use crate::documents::{sources, workspace};
use crate::module_circles::paths::Paths;

/// The types of the effects, from the list of the catalogue.
fn types() -> Vec<String> {
    let catalogue = fs::read_to_string(workspace().join("host-sim/model/src/effects/mod.rs")).unwrap();
    let (_, list) = catalogue.split_once("catalogue! {").unwrap();
    let (list, _) = list.split_once('}').unwrap();
    list.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()
}

/// What a source text names of the effects, without comments and tests: imported types, variants of `Effect` (in macros as well), and
/// names in quotes.
fn named(text: &str, types: &[String]) -> Vec<String> {
    let is_effect = |path: &[String]| {
        path.windows(2).any(|two| ["Effect", "effects"].contains(&two[0].as_str()) && types.contains(&two[1]))
    };
    let imported =
        Paths::of(text).used.into_iter().filter(|path| is_effect(path)).map(|path| path.join("::"));
    let before_tests = text.split("#[cfg(test)]").next().unwrap_or_default();
    let code: Vec<&str> = before_tests.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let code = code.join("\n");
    let variants = types.iter().map(|name| format!("Effect::{name}("));
    let quoted = names().into_iter().map(|name| format!("\"{name}\""));
    imported.chain(variants.chain(quoted).filter(|name| code.contains(name))).collect()
}

#[test]
fn no_file_of_tracer_compensation_and_reports_names_an_effect() {
    let types = types();
    assert!(types.len() >= names().len());
    let mut read = 0;
    for folder in
        ["trace", "commissioning", "report", "improve", "plan", "contour", "pages", "budget", "volume", "web"]
    {
        for file in sources(&workspace().join("host-sim").join(folder).join("src")) {
            if file.ends_with("tests.rs") {
                continue;
            }
            let named = named(&fs::read_to_string(&file).unwrap(), &types);
            assert!(named.is_empty(), "{} names {named:?}", file.display());
            read += 1;
        }
    }
    assert!(read > 200, "{read} files");
}

#[test]
fn a_name_of_an_effect_is_seen() {
    let types = types();
    let of = |text: &str| named(text, &types);
    assert_eq!(of("use model::effects::{Effect, Stage};"), [""; 0]);
    assert_eq!(of("use model::effects::{Effect, Windup};"), ["model::effects::Windup"]);
    assert_eq!(of("fn f(e: &Effect) -> bool { !matches!(e, Effect::Windup(_)) }"), ["Effect::Windup("]);
    assert!(
        !of("fn f(e: &Effect) -> bool { if let Effect::Windup(_) = e { true } else { false } }").is_empty()
    );
    assert_eq!(of("const NAME: &str = \"windup\";"), ["\"windup\""]);
    assert_eq!(of("/// As `Effect::Windup(_)`.\nfn f() {}"), [""; 0]);
    assert_eq!(of("#[cfg(test)] mod tests { use model::effects::Windup; }"), [""; 0]);
}
