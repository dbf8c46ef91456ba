//! A log of one hour at 1 kHz: simulated, written and traced.
//!
//! `cargo bench -p host-sim --bench hour`. The program runs as a process of its own, whose peak memory and processor time are
//! read from `/proc` (Linux). The motion has lines, circles and pauses of many sizes and speeds; the machine has three effects
//! that its machine file does not declare, and the benchmark stops unless they are found.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a benchmark that cannot run stops")]

mod motion;

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

const PROGRAM: &str = env!("CARGO_BIN_EXE_lost-motion");
const DECLARED: &str = include_str!("../../machines/demo.toml");

/// What the machine has and the declared model lacks: axis, effect, its keys.
const EFFECTS: [(&str, &str, &str); 3] = [
    ("x", "pitch_cyclic", "amplitude_um = 4.0\nperiod_mm = 10.0\nphase_rad = 0.7"),
    ("x", "friction_asymmetry", "half_difference_n_s_per_m = 250.0"),
    ("y", "backlash", "width_um = 9.0"),
];

/// What a run of the program took.
struct Cost {
    wall_s: f64,
    processor_s: f64,
    peak_mb: f64,
}

/// Runs the program, and stops if it fails.
fn run(arguments: &[&str]) -> Cost {
    let start = Instant::now();
    let mut child =
        Command::new(PROGRAM).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let mut cost = Cost { wall_s: 0.0, processor_s: 0.0, peak_mb: 0.0 };
    let process = Path::new("/proc").join(child.id().to_string());
    loop {
        // After its end, a process has neither memory nor times: the last values before it are taken.
        if let Some(peak_mb) = peak_mb(&process) {
            (cost.peak_mb, cost.processor_s) = (peak_mb, processor_s(&process).unwrap_or(cost.processor_s));
        }
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success(), "lost-motion {}: {status}", arguments.join(" "));
            cost.wall_s = start.elapsed().as_secs_f64();
            return cost;
        }
        sleep(Duration::from_millis(10));
    }
}

/// Largest memory of a process so far, MB of 10⁶ bytes.
fn peak_mb(process: &Path) -> Option<f64> {
    let status = fs::read_to_string(process.join("status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}

/// Processor time of a process so far, s. The kernel counts it in hundredths.
fn processor_s(process: &Path) -> Option<f64> {
    let stat = fs::read_to_string(process.join("stat")).ok()?;
    // The name in parentheses may contain blanks; user and system time are the 12th and 13th value after it.
    let values: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = |index: usize| values.get(index)?.parse::<f64>().ok();
    Some(0.01 * (ticks(11)? + ticks(12)?))
}

fn report(name: &str, cost: &Cost) {
    let Cost { wall_s, processor_s, peak_mb } = cost;
    println!(
        "{name:32} {wall_s:8.1} s wall, {processor_s:8.1} s of processor time, {peak_mb:6.0} MB at most"
    );
}

fn main() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hour");
    fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name).display().to_string();
    let [declared, truth, motion, log, json] =
        ["declared.toml", "truth.toml", "motion.toml", "hour.csv", "trace.json"].map(file);
    let mut true_machine = DECLARED.to_owned();
    for (axis, name, keys) in EFFECTS {
        true_machine += &format!("\n[[axis.{axis}.effect]]\nname = \"{name}\"\n{keys}\n");
    }
    fs::write(&declared, DECLARED).unwrap();
    fs::write(&truth, true_machine).unwrap();
    fs::write(&motion, motion::of_one_hour()).unwrap();

    let simulated = run(&["simulate", "--machine", &truth, "--motion", &motion, "--out", &log]);
    report("simulate one hour at 1 kHz", &simulated);
    println!("{:32} {:8.0} MB", "log", fs::metadata(&log).unwrap().len() as f64 / 1e6);
    let traced = run(&["trace", "--machine", &declared, "--fit", &log, "--json", &json]);
    report("trace", &traced);

    let result: Value =
        serde_json::from_str(&fs::read_to_string(&json).unwrap()).expect("the JSON of a trace");
    let found: Vec<(&str, &str)> = result["effects"]
        .as_array()
        .unwrap()
        .iter()
        .map(|effect| (effect["axis"].as_str().unwrap(), effect["name"].as_str().unwrap()))
        .collect();
    let mut expected: Vec<(&str, &str)> = EFFECTS.map(|(axis, name, _)| (axis, name)).to_vec();
    expected.sort_unstable();
    let mut sorted = found.clone();
    sorted.sort_unstable();
    assert_eq!(sorted, expected, "the effects found");
    println!("found: {found:?}");
    fs::remove_file(&log).unwrap();
}
