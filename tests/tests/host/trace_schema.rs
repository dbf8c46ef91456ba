//! `docs/trace.schema.json` is the schema of the types of `trace --json`, and outputs are valid under it. `BLESS=1` writes the file
//! again.

use std::fs;
use std::path::Path;

use budget::traced::{self, Document, schema};
use contour::log_error::LogError;
use serde_json::{Value, json};
use tests::cases;
use trace::Identification;

use crate::traces;

#[test]
fn the_schema_is_that_of_the_types() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs").join("trace.schema.json");
    let text = serde_json::to_string_pretty(&schema()).unwrap() + "\n";
    if std::env::var_os("BLESS").is_some() {
        fs::write(&path, &text).unwrap();
    }
    let written = fs::read_to_string(&path).unwrap();
    assert!(written == text, "docs/trace.schema.json is not that of the types; BLESS=1 writes it again");
}

/// The output of `trace --json --empirical`.
fn document(trace: &Identification, contour_errors: &[LogError]) -> Value {
    let budget = traced::budget(trace).unwrap();
    assert!(budget.is_some(), "every case has a linear axis");
    Document::of(trace::json::Document::of(trace, contour_errors, true), budget.as_ref(), &[]).value()
}

fn errors(document: &Value) -> Vec<String> {
    let validator = jsonschema::validator_for(&schema()).unwrap();
    validator.iter_errors(document).map(|error| format!("{}: {error}", error.instance_path())).collect()
}

#[test]
fn the_result_of_a_demo_is_valid_and_wrong_ones_are_not() {
    let demo::Traced { trace, contour_errors, .. } = demo::traced(1, &|_| ()).unwrap();
    let document = document(&trace, &contour_errors);
    assert_eq!(errors(&document), [""; 0]);
    assert!(
        !document["effects"].as_array().unwrap().is_empty() && document["contour"][0]["max_um"].is_number()
    );
    let with = |pointer: &str, value: Value| {
        let mut wrong = document.clone();
        *wrong.pointer_mut(pointer).unwrap() = value;
        errors(&wrong).len()
    };
    assert_eq!(with("/verdict", json!("unknown")), 1);
    assert_eq!(with("/effects/0/certainty", json!(true)), 1);
    assert_eq!(with("/contour/0/rms_um", json!("1")), 1);
    assert!(with("/budget/motions/0/sum_um/rms", json!("1")) > 0);
    // A figure without its unit.
    let mut wrong = document.clone();
    let entry = wrong["residual"][0].as_object_mut().unwrap();
    let key = entry.keys().find(|key| key.starts_with("after_")).unwrap().clone();
    let after = entry.remove(&key).unwrap();
    entry.insert("after".to_owned(), after);
    assert_eq!(errors(&wrong).len(), 1);
}

#[test]
fn the_results_of_blind_cases_are_valid() {
    let (Some(cases), Some(sparse)) = (cases::folders(), cases::sparse_folders()) else { return };
    for folder in cases.into_iter().chain(sparse) {
        let traced = traces::of_case(&folder);
        let contour_errors = LogError::all(traced.fit.iter().chain(&traced.validate));
        let document = document(&traced.trace, &contour_errors);
        assert_eq!(errors(&document), [""; 0], "{}", folder.display());
    }
}
