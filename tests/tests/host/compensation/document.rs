//! The table of `docs/compensation.md` is that of `EffectModel::compensation`. `BLESS=1` writes it again.

use std::fs;
use std::path::Path;

use model::effects::{EffectCompensation, KINDS, Kind};

use super::listed::example;

const BEGIN: &str =
    "| effect | what the controller does, or why it does nothing | instead |\n|---|---|---|\n";

fn row(kind: &Kind) -> String {
    let name = kind
        .distinguishing_key
        .map_or_else(|| format!("`{}`", kind.name), |key| format!("`{}` with `{key}`", kind.name));
    match example(kind).compensation() {
        EffectCompensation::Compensated { does, .. } => format!("| {name} | {does} | |\n"),
        EffectCompensation::Not { why, instead } => {
            format!("| {name} | not compensated: {why} | {instead} |\n")
        }
    }
}

#[test]
fn the_table_of_the_document_matches_the_catalogue() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs").join("compensation.md");
    let text = fs::read_to_string(&path).unwrap();
    let (head, rest) = text.split_once(BEGIN).unwrap();
    let end = rest.find("\n\n").unwrap();
    let rows: String = KINDS.iter().map(row).collect();
    let expected = format!("{head}{BEGIN}{rows}{}", &rest[end + 1..]);
    if std::env::var_os("BLESS").is_some() {
        fs::write(&path, &expected).unwrap();
        return;
    }
    assert!(
        text == expected,
        "docs/compensation.md does not match what the effects declare; BLESS=1 writes it again"
    );
}
