//! `init`: what it writes, that `trace` reads it, and what it refuses.

use super::work_folder::WorkFolder;

/// A loop of Kp 40 1/s with a feed-forward of 70 % and a drive of 5 ms, ±20 mm; positions to 10 nm.
fn log() -> String {
    let (kp, kf, lag_s, step_s) = (40.0, 0.7, 5e-3, 1e-4);
    let command = |t: f64| 15.0 * (3.0 * t).sin() + 5.0 * (11.0 * t).sin();
    let (mut x, mut v) = (0.0, 0.0);
    let mut csv = "time_s,x_command_mm,x_motor_mm\n".to_owned();
    for i in 0..6000_u32 {
        let t = 1e-3 * f64::from(i);
        csv += &format!("{t:.3},{:.5},{x:.5}\n", command(t));
        let wanted = kp * (command(t) - x) + kf * (command(t) - command(t - 1e-3)) / 1e-3;
        for _ in 0..10 {
            v += step_s / lag_s * (wanted - v);
            x += step_s * v;
        }
    }
    csv
}

#[test]
fn a_machine_file_is_written_that_trace_reads() {
    let folder = WorkFolder::with(&[("log.csv", log())]);
    let stdout = folder.succeeds("init --log log.csv --set x.lead_mm=10 --out machine.toml");
    assert!(stdout.contains("x: drive with a velocity command"), "{stdout}");
    assert!(!stdout.contains("lead_mm is unknown"), "{stdout}");
    let file = folder.read("machine.toml");
    for line in ["drive = \"velocity\"", "lead_mm = 10.0", "[axis.x.tolerance_percent]", "% from the logs"] {
        assert!(file.contains(line), "{line}: {file}");
    }
    let number = |key: &str| -> f64 {
        let line = file.lines().find(|line| line.starts_with(key)).unwrap();
        line.split(' ').nth(2).unwrap().parse().unwrap()
    };
    let lag_s = (1.0 - 0.01 * number("feedforward_percent")) / number("position_gain_per_s");
    assert!((lag_s / (0.3 / 40.0) - 1.0).abs() < 0.02, "{file}");
    folder.succeeds("trace --machine machine.toml --fit log.csv --json out.json");
    // The same logs give the same bytes.
    folder.succeeds("init --log log.csv --set x.lead_mm=10 --out again.toml");
    assert_eq!(folder.read("again.toml"), file);
    // What is declared stays.
    folder.succeeds(
        "init --log log.csv --machine machine.toml --set x.position_gain_per_s=41 --out third.toml",
    );
    assert!(folder.read("third.toml").contains("position_gain_per_s = 41.0\n"));
}

#[test]
fn what_cannot_be_used_is_refused_in_one_line() {
    let folder = WorkFolder::with(&[("log.csv", log()), ("machine.toml", "name = 3\n".to_owned())]);
    for (arguments, said) in [
        (
            "init --log log.csv --out log.csv",
            "--out: expected a file that is neither an input nor another output",
        ),
        (
            "init --log log.csv --set z.lead_mm=10 --out m.toml",
            "--set: expected an axis of the logs (x), found \"z\"",
        ),
        ("init --log log.csv --set x.lead_mm=-1 --out m.toml", "axis.x.lead_mm: expected a number above 0"),
        ("init --log log.csv --set lead=1 --out m.toml", "expected AXIS.KEY=VALUE"),
        ("init --log log.csv --machine machine.toml --out m.toml", "machine.toml: line 1"),
        ("init --log missing.csv --out m.toml", "missing.csv: expected a readable file"),
    ] {
        let stderr = folder.fails(arguments, 2);
        assert!(stderr.contains(said), "{arguments}: {stderr}");
    }
    assert!(!folder.path().join("m.toml").exists());
}
