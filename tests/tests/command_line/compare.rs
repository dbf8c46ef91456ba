//! `lost-motion compare`: its table, its JSON, its page, and what it refuses.

use serde_json::Value;

use super::desk::Desk;

#[test]
fn the_comparison_is_said_written_and_drawn() {
    let desk = Desk::with(&[("other.txt", "")]);
    let said = desk.done("compare --hours 0.005 --json out.json --report report");
    let json: Value = serde_json::from_str(&desk.read("out.json")).unwrap();
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
        // Counted where the program of the emulated core is there.
        let counted = row["instructions_per_tick"].as_u64();
        assert!(counted.is_none_or(|count| (100..20_000).contains(&count)), "{name}: {row}");
        assert!(counted.is_none() || !name.ends_with("position"), "{name}");
    }
    assert!(said.starts_with("Fixed point stays within ") && said.contains("0.005 h of circles"), "{said}");
    for name in &names {
        let (motion, scalar) = name.split_once(' ').unwrap();
        let is_row = |line: &str| line.split_whitespace().take(2).eq([motion, scalar]);
        assert_eq!(said.lines().filter(|line| is_row(line)).count(), 1, "{name} in {said}");
    }
    let page = desk.read("report/report.html");
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    // Two pictures a motion, and two samples in the legend.
    assert_eq!(page.matches("<svg").count(), 12);
    assert!(!page.contains("http") && !page.contains("<script"));
}

#[test]
fn what_cannot_be_compared_is_refused_in_one_line() {
    let desk = Desk::with(&[("other.txt", "")]);
    let before = desk.content();
    for (arguments, expected) in [
        ("--hours 0", "lost-motion: --hours: expected a number of hours above 0, at most 8760, found 0"),
        ("--hours=-1", "found -1"),
        ("--hours NaN", "found NaN"),
        ("--hours 1e9", "found 1000000000"),
        ("--emulator nowhere", "lost-motion: --emulator: nowhere: no such program"),
    ] {
        let said = desk.fails(&format!("compare {arguments} --json out.json"), 2);
        assert!(said.contains(expected), "{arguments}: {said}");
        assert!(desk.content() == before, "{arguments}");
    }
}
