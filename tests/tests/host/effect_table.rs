//! `docs/effects.md` is the table of the catalogue. `BLESS=1` writes the file again.

use std::fs;
use std::path::Path;

use model::effects::{Effect, KINDS, Kind, Occurrence, Parameter, Stage};
use model::range::Range;

#[test]
fn the_table_of_effects_matches_the_catalogue() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs").join("effects.md");
    if std::env::var_os("BLESS").is_some() {
        fs::write(&path, table()).unwrap();
    }
    let written = fs::read_to_string(&path).unwrap();
    assert!(written == table(), "docs/effects.md does not match the catalogue; BLESS=1 writes it again");
}

/// An entry with the listed keys is read; without one of the keys that hold a name, it is refused.
#[test]
fn the_listed_keys_are_sufficient_and_names_are_required() {
    for kind in KINDS {
        let mut entry = serde_json::Map::from_iter([("name".to_owned(), kind.name.into())]);
        entry.extend(kind.parameters.iter().map(|parameter| {
            let value = if parameter.is_list { vec![1.0, 2.0].into() } else { 1.0.into() };
            (parameter.key.to_owned(), value)
        }));
        for (key, _) in kind.named_keys {
            assert!(serde_json::from_value::<Effect>(entry.clone().into()).is_err(), "{}, {key}", kind.name);
            let value = match *key {
                "channel" => "tool",
                "part" => "scale",
                _ => "y",
            };
            entry.insert((*key).to_owned(), value.into());
        }
        let effect: Effect = serde_json::from_value(entry.into()).unwrap();
        assert_eq!(effect.name(), kind.name);
    }
}

fn table() -> String {
    let rows: String = KINDS.iter().map(row).collect();
    format!(
        "# Effects\n\nThe entries of `[[axis.NAME.effect]]` in a machine file, which are also what a trace can find. This file is \
         generated from the catalogue by `tests/tests/host/effect_table.rs`. In the results of rotary axes, keys are in degrees \
         instead of mm and in N·m instead of N, with the same numbers.\n\nVisible in: the channels of which at least one is \
         required to search for the effect. If an axis has an effect more than once, the contributions add up.\n\n\
         | name | description | parameters | on rotary axes | visible in | more than once |\n\
         |---|---|---|---|---|---|\n{rows}"
    )
}

fn row(kind: &Kind) -> String {
    let name = kind
        .distinguishing_key
        .map_or_else(|| format!("`{}`", kind.name), |key| format!("`{}` with `{key}`", kind.name));
    let list =
        |of: &dyn Fn(&Parameter) -> String| kind.parameters.iter().map(of).collect::<Vec<_>>().join("<br>");
    let range = |parameter: &Parameter| match parameter.range {
        Range::Signed if parameter.is_list => "list of numbers".to_owned(),
        Range::Signed => "of any sign".to_owned(),
        range => range.description(),
    };
    let named = kind.named_keys.iter().map(|(key, meaning)| format!("`{key}`, {meaning}<br>"));
    let linear =
        named.collect::<String>() + &list(&|parameter| format!("`{}`, {}", parameter.key, range(parameter)));
    let optional = kind.optional_named_keys.iter().map(|(key, meaning)| format!("<br>`{key}`, {meaning}"));
    let linear = linear + &optional.collect::<String>();
    let rotary = list(&|parameter| format!("`{}`", parameter.key_on(true)));
    let channels: Vec<&str> = kind.shown_in.iter().map(|stage| channel(*stage)).collect();
    let often = if kind.occurrence == Occurrence::Repeated { "yes" } else { "no" };
    let summary = kind.summary.replace('|', "\\|");
    format!("| {name} | {summary} | {linear} | {rotary} | {} | {often} |\n", channels.join(", "))
}

const fn channel(stage: Stage) -> &'static str {
    match stage {
        Stage::Motor => "motor (against the command)",
        Stage::Table => "table",
        Stage::Tool => "tool",
        Stage::Force => "force",
    }
}
