//! `lost-motion sensors`: the tables of its page.

use serde_json::Value;

use super::work_folder::WorkFolder;
use tests::tables::{rows, shows};

/// Whether a cell shows two values: "5.17 → 0.64".
fn shows_both(cell: &str, values: [&Value; 2]) -> bool {
    let (before, after) = cell.split_once(" → ").unwrap();
    shows(before, values[0].as_f64().unwrap()) && shows(after, values[1].as_f64().unwrap())
}

#[test]
fn the_page_has_the_figures_of_the_comparison() {
    let folder = WorkFolder::with(&[("other.txt", "")]);
    folder.succeeds("sensors --json out.json");
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    let head = "| feedback | law | gain margin dB | phase margin ° | highest Kp 1/s | circle rms | circle G | corner rms | corner greatest |";
    let (shown, found) = (rows("sensors.md", head), json["rows"].as_array().unwrap());
    assert_eq!((shown.len(), found.len()), (6, 6));
    for (cells, row) in shown.iter().zip(found) {
        assert_eq!(cells[0], row["feedback"]);
        assert_eq!(cells[1].to_lowercase(), row["controller"]);
        let margins = ["gain_margin_db", "phase_margin_deg", "highest_position_gain_per_s"];
        for (cell, key) in cells[2..5].iter().zip(margins) {
            assert!(shows(cell, row[key].as_f64().unwrap()), "{key}: {cells:?}: {row}");
        }
        let errors = ["circle_rms_um", "circular_um", "corner_rms_um", "corner_max_um"];
        for (cell, key) in cells[5..].iter().zip(errors) {
            let values = ["uncompensated", "compensated"].map(|state| &row[state][key]);
            assert!(shows_both(cell, values), "{key}: {cells:?}: {values:?}");
        }
    }
    let shown = rows("sensors.md", "| time constant, P control | circle rms, µm | highest Kp, 1/s |");
    let found = json["crossovers"].as_array().unwrap();
    assert_eq!((shown.len(), found.len()), (5, 5));
    for (cells, row) in shown.iter().zip(found) {
        let time_ms = cells[0].strip_suffix(" ms").unwrap();
        assert!(shows(time_ms, 1e3 * row["time_constant_s"].as_f64().unwrap()), "{cells:?}");
        let figures = [(&cells[1], "circle_rms_um"), (&cells[2], "highest_position_gain_per_s")];
        for (cell, key) in figures {
            assert!(shows(cell, row[key].as_f64().unwrap()), "{key}: {cells:?}: {row}");
        }
    }
}
