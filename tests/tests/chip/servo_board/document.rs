//! The steps of `docs/board.md`: the commands are run, and what the page shows of their output is compared. `BLESS=1` writes the
//! outputs again.
//!
//! Beside the commands of the program a block may have three of a shell: `&` behind a command starts it, `sleep` lets it run, `wait` waits
//! until it has ended by itself or has been stopped by another one.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Child;
use std::thread::sleep;
use std::time::Duration;

use super::emulated_board::EmulatedBoard;

fn document() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs").join("board.md")
}

/// Period of the signals of the encoder of x, mm (`firmware/src/bench/signals.rs`).
const SIGNAL_PERIOD_MM: f64 = 0.02;

/// Phase of the signals of x at the position of its motor in a status, periods; `None` without this position.
fn phase_of_motor(status: &str) -> Option<f64> {
    let row = status.lines().find(|line| line.starts_with("x  "))?;
    let motor_mm: f64 = row.split_whitespace().nth(2)?.parse().ok()?;
    Some((motor_mm / SIGNAL_PERIOD_MM).rem_euclid(1.0))
}

/// Words are equal; numbers within 5 % or 0.05: the host decides when it asks. A phase is that of the motor position beside it, as the micrometre at which an
/// axis comes to rest depends on when the host asks. The printed position is rounded to 0.0025 of a period, the phase to 0.005.
fn is_same(found: &str, shown: &str) -> bool {
    let phase = phase_of_motor(found);
    let is_phase =
        |value: f64| phase.is_some_and(|phase| ((value - phase + 0.5).rem_euclid(1.0) - 0.5).abs() < 0.01);
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let (found, shown) = (words(found), words(shown));
    let same = |(i, (a, b)): (usize, (&String, &String))| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(_)) if i > 0 && shown[i - 1] == "phase" => is_phase(a),
        (Ok(a), Ok(b)) => (a - b).abs() <= 0.05 + 0.05 * b.abs(),
        _ => a == b,
    };
    found.len() == shown.len() && found.iter().zip(&shown).enumerate().all(same)
}

/// The exit code of the commands of a block in a language: they succeed, the board refuses them, or their input is wrong. `None`: no commands.
fn exit_code(language: &str) -> Option<i32> {
    match language {
        "sh" => Some(0),
        "sh refused" => Some(1),
        "sh bad input" => Some(2),
        _ => None,
    }
}

/// A block `text` is the output of the last command before it.
#[test]
fn every_step_of_the_page_does_what_it_shows() {
    let Some(board) = EmulatedBoard::new() else { return };
    let text = fs::read_to_string(document()).unwrap();
    for folder in ["machines", "motions"] {
        let from = EmulatedBoard::file("host-sim").join(folder);
        let to = board.path().join("host-sim").join(folder);
        fs::create_dir_all(&to).unwrap();
        for name in fs::read_dir(from).unwrap().map(|entry| entry.unwrap()) {
            fs::copy(name.path(), to.join(name.file_name())).unwrap();
        }
    }
    let blesses = std::env::var_os("BLESS").is_some();
    let (mut written, mut output, mut commands) = (Vec::new(), String::new(), 0);
    for (index, part) in text.split("```").enumerate() {
        let Some((language, block)) = part.split_once('\n').filter(|_| index % 2 == 1) else {
            written.push(part.to_owned());
            continue;
        };
        let mut shown = block.to_owned();
        if let Some(code) = exit_code(language) {
            let mut started = None;
            for command in block.replace("\\\n", " ").lines() {
                output = run(&board, command, code, &mut started);
                commands += 1;
            }
            assert!(started.is_none(), "{block}: without a wait");
        } else if language == "text" && blesses {
            shown = trimmed(&output);
        } else if language == "text" {
            let found = trimmed(&output);
            assert!(is_same(&found, &shown), "found:\n{found}\nin docs/board.md:\n{shown}");
        }
        written.push(format!("{language}\n{shown}"));
    }
    assert!(commands >= 20, "{commands}");
    if blesses {
        fs::write(document(), written.join("```")).unwrap();
    }
}

/// Runs a line of a block, which has to end with an exit code. Returns its output; that of a `wait` is what the program that was started
/// has told.
fn run(board: &EmulatedBoard, line: &str, code: i32, started: &mut Option<Child>) -> String {
    if let Some(seconds) = line.strip_prefix("sleep ") {
        sleep(Duration::from_secs(seconds.parse().unwrap()));
        return String::new();
    }
    if line == "wait" {
        let output = started.take().expect("a command was started").wait_with_output().unwrap();
        return String::from_utf8(output.stderr).unwrap();
    }
    let command = line.strip_prefix("lost-motion ").expect("only this program is run");
    match command.strip_suffix(" &") {
        Some(command) => {
            assert!(started.replace(board.start(command)).is_none(), "{line}: one at a time");
            String::new()
        }
        None if code == 0 => board.succeeds(command),
        None => board.fails(code, command),
    }
}

/// The output without blanks at the ends of its lines.
fn trimmed(stdout: &str) -> String {
    stdout.lines().fold(String::new(), |text, line| text + line.trim_end() + "\n")
}
