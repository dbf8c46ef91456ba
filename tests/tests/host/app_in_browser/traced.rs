//! Traces in the browser have the JSON of the command line.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use serde_json::Value;
use tests::cases;
use tests::program::lost_motion;

use super::{OF_FIGURES, circle_log, difference, program, run};

/// Cases whose figures differed by more than a billionth before browser and program had their functions from one library.
const WHOSE_FIGURES_DIFFERED: [&str; 3] = ["case-1", "case-3", "case-9"];

/// Drops the files of a case, holds its logs to validate out, and traces. The seconds that it takes and the JSON; `None` without a browser.
fn on_page(folder: &Path) -> Option<(f64, Value)> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let paths: Vec<PathBuf> = entries.filter(|path| !path.ends_with("truth.json")).collect();
    let files: Vec<(&str, Vec<u8>)> = paths
        .iter()
        .map(|path| (path.file_name().unwrap().to_str().unwrap(), fs::read(path).unwrap()))
        .collect();
    let script = "dropped(files); await idle();
        for (const entry of document.querySelectorAll('#list > li')) if (entry.textContent.startsWith('validate')) entry.querySelector('input').click();
        const start = performance.now(); await click('trace');
        return { seconds: (performance.now() - start) / 1000, problem: shown('problem'), json: await file('trace.json') };";
    let seen = run(script, &files)?;
    let json = seen["json"].as_str().unwrap_or_else(|| panic!("{seen}"));
    Some((seen["seconds"].as_f64().unwrap(), serde_json::from_str(json).unwrap()))
}

/// The seconds that the program takes for a case on one thread, and the JSON.
fn by_program(folder: &Path) -> (f64, Value) {
    let folder_of_json = tempfile::tempdir().unwrap();
    let path = folder_of_json.path().join("t.json");
    let started = Instant::now();
    let mut command = Command::new(lost_motion());
    command.env("RAYON_NUM_THREADS", "1").arg("trace").arg("--machine").arg(folder.join("machine.toml"));
    for (flag, prefix) in [("--fit", "fit"), ("--validate", "validate")] {
        let logs = cases::logs(folder, prefix);
        command.args(logs.iter().flat_map(|log| [OsStr::new(flag), log.as_os_str()]));
    }
    let done = command.arg("--json").arg(&path).output().unwrap();
    assert!(done.status.success());
    (started.elapsed().as_secs_f64(), serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap())
}

/// The blind cases that are chosen have the JSON of the command line, but for the last digits.
fn have_the_json_of_the_command_line(is_chosen: impl Fn(&str) -> bool) {
    let Some(folders) = cases::folders() else { return };
    for folder in folders.iter().filter(|folder| is_chosen(&folder.file_name().unwrap().to_string_lossy())) {
        let Some((page_s, of_page)) = on_page(folder) else { return };
        let (program_s, of_program) = by_program(folder);
        let name = folder.display().to_string();
        let most = difference(&name, [&of_page, &of_program], OF_FIGURES);
        println!(
            "{name}: {page_s:.1} s, native on one thread {program_s:.1} s; differences up to {most:.1e}"
        );
    }
}

#[test]
fn cases_whose_figures_differed_have_the_json_of_the_command_line() {
    have_the_json_of_the_command_line(|case| WHOSE_FIGURES_DIFFERED.contains(&case));
}

/// With the times of all, for docs/browser.md.
#[test]
fn all_cases_have_the_json_of_the_command_line() {
    have_the_json_of_the_command_line(|_| true);
}

/// A log of one axis with command, motor and force, as of a positioning axis that somebody published, and no machine file: it is filled from the
/// log and the lead, and traced, as by `init` and `trace`.
#[test]
fn one_axis_is_traced_without_a_machine_file() {
    let folder = tempfile::tempdir().unwrap();
    let circle = circle_log(folder.path());
    let names: Vec<&str> = circle.lines().next().unwrap().split(',').collect();
    let kept: Vec<usize> = ["time_s", "x_command_mm", "x_motor_mm", "x_force_n"]
        .map(|kept| names.iter().position(|name| *name == kept).unwrap())
        .to_vec();
    let row = |line: &str| {
        let values: Vec<&str> = line.split(',').collect();
        kept.iter().map(|column| values[*column]).collect::<Vec<_>>().join(",") + "\n"
    };
    let log: String = circle.lines().map(row).collect();
    fs::write(folder.path().join("axis.csv"), &log).unwrap();
    let script =
        "dropped(files); await idle(); document.querySelector('[data-key=\"x.lead_mm\"]').value = '20';
        await click('init'); await click('trace');
        return { problem: shown('problem'), json: await file('trace.json') };";
    let Some(seen) = run(script, &[("axis.csv", log.into_bytes())]) else { return };
    let of_page: Value =
        serde_json::from_str(seen["json"].as_str().unwrap_or_else(|| panic!("{seen}"))).unwrap();
    program(&["init", "--log", "axis.csv", "--set", "x.lead_mm=20", "--out", "m.toml"], folder.path());
    program(&["trace", "--machine", "m.toml", "--fit", "axis.csv", "--json", "t.json"], folder.path());
    let of_program: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("t.json")).unwrap()).unwrap();
    difference("one axis", [&of_page, &of_program], OF_FIGURES);
    assert!(!of_page["residual"].as_array().unwrap().is_empty(), "{of_page}");
}
