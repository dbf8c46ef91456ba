//! Logs in the dialects of other programs become the log from which they were written.

use files::log::{Channel, Log};
use import::any_log;
use import::request::Request;

use super::work_folder::{WorkFolder, log};

/// Position of command and motor of the axis x, mm, in the rows of the short log.
fn rows() -> Vec<[f64; 2]> {
    let log = Log::parse(log().as_bytes(), "log").unwrap();
    let x = log.axis("x").unwrap();
    let [command, motor] = [Channel::Command, Channel::Motor].map(|channel| x.channel(channel).unwrap());
    command.iter().zip(motor).map(|(command, motor)| [*command, *motor]).collect()
}

/// Writes the file, imports it, and compares both channels with the original to 0.1 nm and the rounding of the file.
fn assert_imported(text: &[u8], arguments: &str, rounding_mm: f64, said: &[&str]) {
    let folder = WorkFolder::with(&[("foreign.txt", text)]);
    let stdout = folder.succeeds(&format!("import foreign.txt --out log.csv {arguments}"));
    for said in said {
        assert!(stdout.contains(said), "{said}: {stdout}");
    }
    let imported = any_log::read(&folder.path().join("log.csv"), &Request::default()).unwrap();
    let log = imported.log;
    // A lost row is none of the file that is written either, so that a trace sees what is no measurement.
    assert_eq!(log.interpolated.is_empty(), !said.contains(&"overrun"), "{:?}", imported.notes);
    let original = Log::parse(super::work_folder::log().as_bytes(), "log").unwrap();
    assert!((log.sample_time_s / original.sample_time_s - 1.0).abs() < 1e-9);
    let x = log.axis("x").unwrap();
    assert_eq!(log.len(), rows().len());
    for (i, row) in rows().iter().enumerate() {
        for (channel, expected) in [Channel::Command, Channel::Motor].into_iter().zip(row) {
            let found = x.channel(channel).unwrap()[i];
            assert!((found - expected).abs() <= 1e-7 + rounding_mm, "row {i}: {found} {expected}");
        }
    }
}

fn period_ms() -> f64 {
    1e3 * Log::parse(log().as_bytes(), "log").unwrap().sample_time_s
}

/// Semicolons, decimal commas, µ in Latin-1, milliseconds, inches, and a spindle that no channel is.
#[test]
fn a_german_export_is_read() {
    let mut text = "# Messung 3\nZeit (ms);Soll (in);Ist (µm);Spindel\n".to_owned();
    for (i, [command, motor]) in rows().into_iter().enumerate() {
        let line = format!("{:.4};{:.9};{:.4};1200\n", period_ms() * i as f64, command / 25.4, 1e3 * motor);
        text.push_str(&line.replace('.', ","));
    }
    let latin_1: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    let arguments = "--map x_command_mm=Soll --map x_motor_mm=Ist";
    assert_imported(&latin_1, arguments, 1e-7, &["Latin-1", "not used: \"Spindel\"", "column \"Soll\", in"]);
}

/// `halsampler -t`: the number of the sample and two pins; the FIFO overran once, and one row is lost. The row is bridged by a straight
/// line: within half a row's travel of the truth, 50 mm/s times 1 ms.
#[test]
fn a_log_of_halsampler_is_read() {
    let mut text = String::new();
    for (i, [command, motor]) in rows().into_iter().enumerate() {
        text.push_str(&if i == 700 {
            "overrun\n".to_owned()
        } else {
            format!("{i} {command:.6} {motor:.6} \n")
        });
    }
    let rate = 1e3 / period_ms();
    let arguments = format!("--map x_command_mm=2 --map x_motor_mm=3 --rate {rate}");
    assert_imported(text.as_bytes(), &arguments, 0.025, &["LinuxCNC halsampler", "overrun", "1 of"]);
}

/// `halscope`: the period in the first line, the names of the pins in the second.
#[test]
fn a_log_of_halscope_is_read() {
    let mut text =
        format!("# Sampling period is {:.0} nSec\njoint.0.pos-cmd;joint.0.pos-fb\n", 1e6 * period_ms());
    for [command, motor] in rows() {
        text.push_str(&format!("{command:.7};{motor:.7}\n"));
    }
    let arguments = "--map x_command_mm=joint.0.pos-cmd --map x_motor_mm=joint.0.pos-fb";
    assert_imported(text.as_bytes(), arguments, 1e-7, &["LinuxCNC halscope"]);
}

/// Earlier versions of `halscope`: the name of each pin before its value. Its newest version: positions and scales of the channels in comments.
#[test]
fn logs_of_other_versions_of_halscope_are_read() {
    let period_ns = 1e6 * period_ms();
    let mut earlier = format!("Sampling period is {period_ns:.0} ns \n");
    let mut newest = format!(
        "# Sampling period is {period_ns:.0} ns\njoint.0.pos-cmd;joint.0.pos-fb\n# Position: 0.500000;0.500000\n# Scale: 0;-3\n"
    );
    for [command, motor] in rows() {
        earlier.push_str(&format!("\njoint.0.pos-cmd {command:+.14} joint.0.pos-fb {motor:+.14} "));
        newest.push_str(&format!("{command:.14};{motor:.14}\n"));
    }
    let arguments = "--map x_command_mm=joint.0.pos-cmd --map x_motor_mm=joint.0.pos-fb";
    for text in [earlier, newest] {
        assert_imported(text.as_bytes(), arguments, 1e-7, &["LinuxCNC halscope"]);
    }
}

/// Counts of an encoder of 0.5 µm.
#[test]
fn counts_are_scaled() {
    let mut text = "time_s,x_command_mm,counts\n".to_owned();
    for (i, [command, motor]) in rows().into_iter().enumerate() {
        let counts = (motor / 5e-4).round();
        text.push_str(&format!("{:.6},{command:.7},{counts}\n", 1e-3 * period_ms() * i as f64));
    }
    let arguments = "--map x_motor_mm=counts --unit x_motor_mm=counts*0.0005";
    assert_imported(text.as_bytes(), arguments, 0.25e-3, &["counts*0.0005"]);
}

#[test]
fn what_is_missing_is_asked_for_in_one_line() {
    let folder = WorkFolder::with(&[("foreign.txt", "a;b\n1;2\n2;3\n"), ("binary.mat", "MATLAB\u{0}\u{1}")]);
    for (arguments, expected) in [
        ("import foreign.txt --out o.csv", "foreign.txt: line 1: expected --map OURS=THEIRS"),
        ("import foreign.txt --out o.csv --map x_motor_mm=a", "foreign.txt: expected a column of times"),
        ("import foreign.txt --out o.csv --map x_motor_mm=c --rate 1000", "expected a column of the file"),
        ("import foreign.txt --out o.csv --map x_motr_mm=a --rate 1000", "did you mean x_motor_mm?"),
        (
            "import foreign.txt --out o.csv --map x_motor_mm=a --rate 0",
            "--rate: expected a number of samples",
        ),
        (
            "import foreign.txt --out foreign.txt --map x_motor_mm=a --rate 9",
            "neither an input nor another output",
        ),
        ("import binary.mat --out o.csv", "binary.mat: expected a text"),
    ] {
        let output = folder.run(arguments);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {stderr}");
        assert!(stderr.contains(expected) && stderr.lines().count() == 1, "{arguments}: {stderr}");
        assert!(!folder.path().join("o.csv").exists());
    }
}
