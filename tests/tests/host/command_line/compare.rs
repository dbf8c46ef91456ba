//! `lost-motion compare`: table, JSON, page, and rejected arguments.

use std::path::Path;

use serde_json::Value;

use super::work_folder::WorkFolder;
use tests::tables;

#[test]
fn table_json_and_page_have_every_motion_and_format() {
    let folder = WorkFolder::with(&[("other.txt", "")]);
    let stdout = folder.succeeds("compare --hours 0.005 --json out.json --report report");
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    assert_eq!(json.as_object().unwrap().keys().collect::<Vec<_>>(), ["rows"]);
    let rows = json["rows"].as_array().unwrap();
    let named =
        |row: &Value| format!("{} {}", row["motion"].as_str().unwrap(), row["scalar"].as_str().unwrap());
    let names: Vec<String> = rows.iter().map(named).collect();
    let expected = ["circle", "corner", "steps", "creep", "long_run"].iter().flat_map(|motion| {
        ["fixed", "f32", "f64", "f32_position"].map(|scalar| format!("{motion} {scalar}"))
    });
    assert_eq!(names, expected.collect::<Vec<_>>());
    let mut keys =
        ["motion", "scalar", "command_error_nm", "position_error_nm", "drift_nm", "instructions_per_tick"];
    keys.sort_unstable();
    for (row, name) in rows.iter().zip(&names) {
        assert_eq!(row.as_object().unwrap().keys().collect::<Vec<_>>(), keys, "{name}");
        for error in ["command_error_nm", "position_error_nm"] {
            let [max, rms] = ["max", "rms"].map(|figure| row[error][figure].as_f64().unwrap());
            assert!(max >= rms && rms >= 0.0, "{name}: {row}");
        }
        assert_eq!(row["drift_nm"].is_number(), name.starts_with("long_run"), "{name}");
        // Instructions are counted where the program of the emulated core exists.
        let counted = row["instructions_per_tick"].as_u64();
        assert!(counted.is_none_or(|count| (100..20_000).contains(&count)), "{name}: {row}");
        assert!(counted.is_none() || !name.ends_with("position"), "{name}");
    }
    assert!(
        stdout.starts_with("Fixed point stays within ") && stdout.contains("0.005 h of circles"),
        "{stdout}"
    );
    for name in &names {
        let (motion, scalar) = name.split_once(' ').unwrap();
        let is_row = |line: &str| line.split_whitespace().take(2).eq([motion, scalar]);
        assert_eq!(stdout.lines().filter(|line| is_row(line)).count(), 1, "{name} in {stdout}");
    }
    assert_the_document(rows);
    let page = folder.read("report/report.html");
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    // Two plots per motion, and two samples in the legend.
    assert_eq!(page.matches("<svg class=\"chart").count(), 10);
    assert_eq!(page.matches("class=\"key\"").count(), 2);
    assert!(!page.contains("http") && page.matches("<script").count() <= 1);
    // A page is passed on: it names no folder of the computer that wrote it. Both folders, as links may lead to them, too.
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    for path in [folder.path(), workspace, &std::env::temp_dir()] {
        for path in [path.to_owned(), path.canonicalize().unwrap()] {
            assert!(!page.contains(path.to_str().unwrap()), "{}", path.display());
        }
    }
    // Any other path: one that begins at the root has two separators at least. Tags and units have one.
    let rooted = |word: &str| word.starts_with('/') && word.matches('/').count() > 1;
    let text = |part: &str| part.split_once('>').map_or(String::new(), |(_, text)| text.to_owned());
    // The patterns of a script begin with a separator, too.
    let (before, script) = page.split_once("<script").unwrap_or((&page, ""));
    let shown = before.to_owned() + script.split_once("</script>").map_or("", |(_, after)| after);
    let words: Vec<String> = shown
        .split('<')
        .flat_map(|part| text(part).split_whitespace().map(str::to_owned).collect::<Vec<_>>())
        .collect();
    assert!(words.len() > 100, "{} words of text", words.len());
    assert!(!words.iter().any(|word| rooted(word.trim_matches(['(', '`', '"', '\'']))), "{words:?}");
    assert!(!page.contains("of circle of"), "a section is named by its motion once");
}

/// `docs/compare.md` has the figures of every motion but the long one, which is shorter here.
fn assert_the_document(rows: &[Value]) {
    const HEAD: &str = "| motion | arithmetic | command error, nm: max | rms | position error, nm: max | rms | drift, nm | instructions |";
    let documented = tables::rows("compare.md", HEAD);
    assert_eq!(documented.len(), rows.len());
    for (cells, row) in documented.iter().zip(rows).filter(|(cells, _)| cells[0] != "long_run") {
        assert_eq!([&cells[0], &cells[1]], [&row["motion"], &row["scalar"]]);
        let errors = [&row["command_error_nm"], &row["position_error_nm"]];
        let figures = errors.into_iter().flat_map(|error| [&error["max"], &error["rms"]]);
        for (cell, figure) in cells[2..6].iter().zip(figures) {
            let nm = figure.as_f64().unwrap();
            let shown = match cell.strip_suffix(" µm") {
                Some(um) => tables::shows(um, nm / 1e3),
                None => tables::shows(cell, nm),
            };
            assert!(shown, "docs/compare.md: {cells:?}: {row}");
        }
        if let Some(count) = row["instructions_per_tick"].as_u64() {
            assert_eq!(cells[7], count.to_string(), "docs/compare.md: {cells:?}");
        }
    }
}

#[test]
fn invalid_arguments_are_rejected_in_one_line() {
    let folder = WorkFolder::with(&[("other.txt", "")]);
    let before = folder.contents();
    for (arguments, expected) in [
        ("--hours 0", "lost-motion: --hours: expected a number of hours above 0, at most 8760, found 0"),
        ("--hours=-1", "found -1"),
        ("--hours NaN", "found NaN"),
        ("--hours 1e9", "found 1000000000"),
        ("--emulator nowhere", "lost-motion: --emulator: nowhere: no such program"),
    ] {
        let message = folder.fails(&format!("compare {arguments} --json out.json"), 2);
        assert!(message.contains(expected), "{arguments}: {message}");
        assert!(folder.contents() == before, "{arguments}");
    }
}
