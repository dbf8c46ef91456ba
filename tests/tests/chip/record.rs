//! `record` on the emulated core writes the same log as `simulate`, byte for byte; a core that does not reply ends the
//! run.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// A line there and back, and a quarter circle: half a second, 2,000 ticks.
const MOTION: &str = r#"name = "short"
feed_mm_per_min = 3000.0
acceleration_m_per_s2 = 2.0
start_mm = { x = 5.0, y = 0.0 }

[[block]]
line_to_mm = { x = 8.0, y = 1.0 }

[[block]]
line_to_mm = { x = 5.0, y = 0.0 }

[[block]]
arc = { plane = ["x", "y"], centre_mm = { x = 0.0, y = 0.0 }, turns = 0.25 }
"#;

/// Runs `lost-motion` in a folder, expects success, and gives its stdout.
fn succeeds(folder: &Path, arguments: &[&str]) -> String {
    let output = Command::new(tests::program::lost_motion()).args(arguments).current_dir(folder).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_emulated_core_writes_the_log_of_the_simulation() {
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("host-sim").join("machines");
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("motion.toml"), MOTION).unwrap();
    let port = format!("emulated:{}", tests::firmware::built("emulated").display());
    for name in ["desk.toml", "vmc.toml"] {
        let file = machines.join(name);
        let run = |command: &[&str], out| {
            let files = ["--machine", file.to_str().unwrap(), "--motion", "motion.toml", "--out", out];
            let stdout = succeeds(folder.path(), &[command, &files].concat());
            (stdout, fs::read(folder.path().join(out)).unwrap())
        };
        let (_, simulated) = run(&["simulate"], "simulated.csv");
        let (stdout, recorded) = run(&["record", "--port", &port], "recorded.csv");
        assert!(simulated == recorded, "{name}: the logs differ");
        assert!(simulated.len() > 10_000, "{name}: {} bytes are too few for half a second", simulated.len());
        assert!(stdout.contains("instructions in the median"), "{stdout}");
    }
}

/// Half an hour of standstill, which does not end during the test.
const LONG: &str = r#"name = "long"
feed_mm_per_min = 3000.0
acceleration_m_per_s2 = 2.0
start_mm = { x = 5.0, y = 0.0 }

[[block]]
dwell_s = 1800.0
"#;

/// Timeout of a reply in these tests.
const TIMEOUT_S: f64 = 1.5;

/// A folder whose `bin/qemu-system-arm` writes its process id to `pid` and executes another command.
struct StandIn {
    folder: tempfile::TempDir,
    path: String,
}

impl StandIn {
    fn new(command: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let bin = folder.path().join("bin");
        fs::create_dir(&bin).unwrap();
        fs::create_dir(folder.path().join("out")).unwrap();
        let script =
            format!("#!/bin/sh\necho $$ > '{}'\nexec {command}\n", folder.path().join("pid").display());
        let emulator = bin.join("qemu-system-arm");
        fs::write(&emulator, script).unwrap();
        fs::set_permissions(&emulator, fs::Permissions::from_mode(0o755)).unwrap();
        fs::write(folder.path().join("motion.toml"), LONG).unwrap();
        let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
        Self { folder, path }
    }

    fn record(&self, program: &Path) -> Command {
        let mut command = Command::new(tests::program::lost_motion());
        let port = format!("emulated:{}", program.display());
        command.args(["record", "--port", &port, "--timeout-s", &TIMEOUT_S.to_string()]);
        command.args(["--motion", "motion.toml", "--out", "out/log.csv"]);
        command.current_dir(self.folder.path()).env("PATH", &self.path);
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// The process id of the command; waits until it runs.
    fn pid(&self) -> u32 {
        wait_for(|| fs::read_to_string(self.folder.path().join("pid")).ok()?.trim().parse().ok())
    }

    fn outputs(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.folder.path().join("out")).unwrap();
        entries.map(|entry| entry.unwrap().path()).collect()
    }

    /// Asserts exit code 1, a message about the emulator that does not reply, no output and no process.
    fn assert_timed_out(&self, output: &Output) {
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{stderr}");
        let line =
            format!("the emulator has not answered for {TIMEOUT_S} s and was ended; check that its program");
        let last = stderr.trim_end().lines().last().unwrap();
        assert!(last.starts_with("lost-motion: ") && last.contains(&line), "{stderr}");
        assert!(self.outputs().is_empty(), "left behind: {:?}", self.outputs());
        let process = PathBuf::from(format!("/proc/{}", self.pid()));
        assert!(!process.exists(), "the emulator still runs");
    }
}

/// Polls until there is a value, for half a minute at most.
fn wait_for<T>(mut poll: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(value) = poll() {
            return value;
        }
        assert!(start.elapsed() < Duration::from_secs(30), "timeout");
        sleep(Duration::from_millis(10));
    }
}

#[test]
fn an_emulator_that_never_replies_times_out() {
    let stand_in = StandIn::new("cat 3>&1 > /dev/null");
    let program = stand_in.folder.path().join("motion.toml");
    // Builds `lost-motion` if no test has done so.
    let mut record = stand_in.record(&program);
    let start = Instant::now();
    let output = record.output().unwrap();
    stand_in.assert_timed_out(&output);
    // The timeout, plus the start of two programs on a busy computer.
    let waited_s = start.elapsed().as_secs_f64();
    assert!((TIMEOUT_S..TIMEOUT_S + 20.0).contains(&waited_s), "{waited_s}");
}

#[test]
fn an_emulator_that_stops_during_a_run_times_out() {
    let found = std::env::split_paths(&std::env::var_os("PATH").unwrap())
        .map(|folder| folder.join("qemu-system-arm"))
        .find(|path| path.is_file())
        .expect("qemu-system-arm is installed");
    let stand_in = StandIn::new(&format!("'{}' \"$@\"", found.display()));
    let recording = stand_in.record(&tests::firmware::built("emulated")).spawn().unwrap();
    // The log is created when the controller on the emulator is set up.
    wait_for(|| stand_in.outputs().first().cloned());
    let stopped = Command::new("kill").args(["-STOP", &stand_in.pid().to_string()]).status().unwrap();
    assert!(stopped.success());
    stand_in.assert_timed_out(&recording.wait_with_output().unwrap());
}

#[test]
fn an_invalid_timeout_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("motion.toml"), MOTION).unwrap();
    for seconds in ["0", "-1", "nan", "1e9"] {
        let output = Command::new(tests::program::lost_motion())
            .args(["record", "--port", "emulated", "--motion", "motion.toml", "--out", "log.csv"])
            .arg(format!("--timeout-s={seconds}"))
            .current_dir(folder.path())
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains("--timeout-s: expected seconds above 0 and up to 3600, found"), "{stderr}");
    }
}
