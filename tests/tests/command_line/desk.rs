//! A folder to run the program in, with a machine, a motion and a log that are all in order.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use tempfile::TempDir;

/// Two axes, nothing undeclared.
pub const MACHINE: &str = include_str!("../../../host-sim/machines/demo.toml");

/// Out and back, and a quarter of a circle each way; 1.5 s.
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

/// The log of that motion on that machine, as `simulate` writes it.
pub fn log() -> &'static str {
    static LOG: OnceLock<String> = OnceLock::new();
    LOG.get_or_init(|| {
        let desk = Desk::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION)]);
        desk.done(SIMULATE);
        desk.read("out.csv")
    })
}

/// Closes the loop.
pub const SIMULATE: &str = "simulate --machine machine.toml --motion motion.toml --out out.csv";

/// Traces with every output there is.
pub const TRACE: &str =
    "trace --machine machine.toml --fit fit.csv --json out.json --model out.toml --report report";

/// A folder that is gone with this value.
pub struct Desk(TempDir);

impl Desk {
    /// A folder with these files.
    pub fn with(files: &[(&str, impl AsRef<[u8]>)]) -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        for (name, content) in files {
            fs::write(desk.path().join(name), content).unwrap();
        }
        desk
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// The text of a file in it.
    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path().join(name)).unwrap()
    }

    /// Names and contents of all files, sorted; folders have no content.
    pub fn content(&self) -> Vec<(String, Option<Vec<u8>>)> {
        let entries = fs::read_dir(self.path()).unwrap().map(Result::unwrap);
        let mut content: Vec<_> = entries
            .map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).ok()))
            .collect();
        content.sort();
        content
    }

    /// Runs `lost-motion` in the folder, with nothing on its standard input.
    pub fn run(&self, arguments: &str) -> Output {
        self.run_on(arguments, b"")
    }

    /// The same with something on its standard input.
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
        // A program that does not read it ends all the same.
        let writer = std::thread::spawn(move || drop(pipe.write_all(&input)));
        let output = child.wait_with_output().unwrap();
        writer.join().unwrap();
        output
    }

    /// Runs it, expects exit code 0 and silence on stderr, and gives what it printed.
    pub fn done(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), said.as_str()), (Some(0), ""), "{arguments}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs it, expects this exit code and one line on stderr, and gives that line.
    pub fn fails(&self, arguments: &str, code: i32) -> String {
        let output = self.run(arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments}: {said}");
        assert!(said.lines().count() == 1 && said.ends_with('\n'), "{arguments}: {said}");
        said
    }
}
