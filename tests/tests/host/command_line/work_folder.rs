//! A folder to run the program in, and a valid machine, motion and log.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use tempfile::TempDir;

/// A machine of two axes without undeclared effects.
pub const MACHINE: &str = include_str!("../../../../host-sim/machines/demo.toml");

/// A line there and back, and a quarter circle in each direction; 1.5 s.
pub const MOTION: &str = r#"name = "short"
feed_mm_per_min = 3000.0
acceleration_m_per_s2 = 2.0
start_mm = { x = 10.0, y = 0.0 }

[[block]]
line_to_mm = { x = 20.0, y = 5.0 }

[[block]]
line_to_mm = { x = 10.0, y = 0.0 }

[[block]]
arc = { plane = ["x", "y"], centre_mm = { x = 0.0, y = 0.0 }, turns = 0.25 }

[[block]]
arc = { plane = ["x", "y"], centre_mm = { x = 0.0, y = 0.0 }, turns = -0.25 }
"#;

/// The log of [`MOTION`] on [`MACHINE`] that `simulate` writes.
pub fn log() -> &'static str {
    static LOG: OnceLock<String> = OnceLock::new();
    LOG.get_or_init(|| {
        let folder = WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION)]);
        folder.succeeds(SIMULATE);
        folder.read("out.csv")
    })
}

/// A command that simulates.
pub const SIMULATE: &str = "simulate --machine machine.toml --motion motion.toml --out out.csv";

/// A command that traces, with every output.
pub const TRACE: &str =
    "trace --machine machine.toml --fit fit.csv --json out.json --model out.toml --report report";

/// A temporary folder, which is removed when this value is dropped.
pub struct WorkFolder(TempDir);

impl WorkFolder {
    /// A folder with files, given by name and content.
    pub fn with(files: &[(&str, impl AsRef<[u8]>)]) -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        for (name, content) in files {
            fs::write(folder.path().join(name), content).unwrap();
        }
        folder
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// The text of a file in it.
    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path().join(name)).unwrap()
    }

    /// Names and contents of all entries, sorted; a subfolder has no content.
    pub fn contents(&self) -> Vec<(String, Option<Vec<u8>>)> {
        let entries = fs::read_dir(self.path()).unwrap().map(Result::unwrap);
        let mut contents: Vec<_> = entries
            .map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).ok()))
            .collect();
        contents.sort();
        contents
    }

    /// Runs `lost-motion` in the folder, with an empty standard input.
    pub fn run(&self, arguments: &str) -> Output {
        self.run_on(arguments, b"")
    }

    /// [`WorkFolder::run`] with a standard input.
    pub fn run_on(&self, arguments: &str, input: &[u8]) -> Output {
        let mut child = Command::new(tests::program::lost_motion())
            .args(arguments.split_whitespace())
            .current_dir(self.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut pipe = child.stdin.take().unwrap();
        let input = input.to_owned();
        // In a thread: a program that does not read its input must not block the test.
        let writer = std::thread::spawn(move || drop(pipe.write_all(&input)));
        let output = child.wait_with_output().unwrap();
        writer.join().unwrap();
        output
    }

    /// Runs the program, expects exit code 0 and an empty stderr, and gives its stdout.
    pub fn succeeds(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), stderr.as_str()), (Some(0), ""), "{arguments}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs the program, expects an exit code and one line on stderr, and gives that line.
    pub fn fails(&self, arguments: &str, code: i32) -> String {
        let output = self.run(arguments);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments}: {stderr}");
        assert!(stderr.lines().count() == 1 && stderr.ends_with('\n'), "{arguments}: {stderr}");
        stderr
    }
}
