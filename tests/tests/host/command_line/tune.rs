//! `tune`: settings from the plant of a machine file.

use super::work_folder::{MACHINE, MOTION, WorkFolder};

const TUNE: &str = "tune --machine machine.toml --motion motion.toml --out tuned.toml --json tuned.json \
                    --min-gain-margin-db 10 --min-phase-margin-deg 45";

/// The written machine has the margins that were asked for, and its settings are those of the JSON.
#[test]
fn the_proposed_machine_has_the_margins() {
    let folder = WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION)]);
    let stdout = folder.succeeds(TUNE);
    assert!(stdout.contains("With margins of at least 10 dB and 45°"), "{stdout}");
    let margins = folder.succeeds(
        "margins --machine tuned.toml --min-gain-margin-db 10 --min-phase-margin-deg 45 --json m.json",
    );
    assert!(margins.contains("x: both loops have margins of at least 10 dB and 45°"), "{margins}");
    assert!(margins.contains("y: both loops have margins of at least 10 dB and 45°"), "{margins}");
    let of = |name: &str| -> serde_json::Value { serde_json::from_str(&folder.read(name)).unwrap() };
    let proposed = of("tuned.json")["proposed"].clone();
    let [before, after] =
        [&of("tuned.json")["declared"], &proposed].map(|tried| tried["contour_error_um"].as_f64().unwrap());
    assert!(after > 0.0 && after < before, "{before} to {after}");
    let machine = folder.read("tuned.toml");
    let gain = proposed["axis"]["x"]["position_gain_per_s"].as_f64().unwrap();
    assert!(machine.contains(&format!("position_gain_per_s = {gain}")), "{machine}");
}

/// A velocity gain of 10⁷ N·s/m turns the speed of a mass of 200 kg around more than ten times a period of 0.25 ms. Once: "changes from
/// inf to".
#[test]
fn unstable_declared_loops_are_called_so() {
    let (gain, rest) = MACHINE.split_once("velocity_gain_n_s_per_m = ").unwrap();
    let (_, rest) = rest.split_once('\n').unwrap();
    let machine = format!("{gain}velocity_gain_n_s_per_m = 1e7\n{rest}");
    let folder = WorkFolder::with(&[("machine.toml", machine.as_str()), ("motion.toml", MOTION)]);
    let stdout = folder.succeeds(TUNE);
    assert!(stdout.contains(" µm rms; the declared loops are unstable."), "{stdout}");
    assert!(!stdout.contains("inf"), "{stdout}");
}

/// A measured response is refused if its file is no response or of another version, if the machine has no such axis, and if it was
/// measured at another tick rate or with other keys of the controller than the machine file has.
#[test]
fn a_response_that_does_not_fit_is_refused() {
    let controller = r#"{"controller": "p", "feedback": "motor", "position_gain_per_s": 50.0, "velocity_gain_n_s_per_m": 60000.0}"#;
    let response = |version: u32, axis: &str, tick_rate_hz: f64| {
        format!(
            r#"{{"version": {version}, "conditions": {{"board": "b", "axis": "{axis}", "at_mm": 0.0, "force_n": 100.0, "tones_at_once": 4,
            "periods": 4, "period_s": 0.1, "tick_rate_hz": {tick_rate_hz:?}, "controller": {controller}}}, "tones": [], "margins": [], "resonances": [],
            "notch": null}}"#
        )
    };
    for (text, expected) in [
        ("{}".to_owned(), "measured.json: expected the JSON of `board response`"),
        (response(2, "x", 4000.0), "measured.json: version: expected 1, found 2"),
        (response(1, "w", 4000.0), "measured.json: the response of w: the machine file has no such axis"),
        (
            response(1, "x", 20000.0),
            "it was measured with velocity_loop_rate_hz = 20000, and the machine file has 4000",
        ),
        (
            response(1, "x", 4000.0),
            "it was measured with velocity_integral_time_s = none, and the machine file has 0.016",
        ),
    ] {
        let files = [("machine.toml", MACHINE), ("motion.toml", MOTION), ("measured.json", &text)];
        let folder = WorkFolder::with(&files);
        let error = folder.fails(&format!("{TUNE} --measured measured.json"), 2);
        assert!(error.contains(expected) && error.lines().count() == 1, "{error}");
        assert!(!folder.path().join("tuned.toml").exists());
    }
}

#[test]
fn a_machine_without_a_mass_is_refused_by_its_key() {
    let without = MACHINE.replace("table_mass_kg", "# table_mass_kg");
    let folder = WorkFolder::with(&[("machine.toml", &without), ("motion.toml", &MOTION.to_owned())]);
    let error = folder.fails(TUNE, 2);
    assert!(error.contains("machine.toml") && error.contains("table_mass_kg"), "{error}");
    assert!(!folder.path().join("tuned.toml").exists());
}
