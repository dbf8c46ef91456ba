//! `record` on the emulated core and `simulate` here write the same log, byte for byte.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;
use std::process::Command;

/// Once there and back, and a quarter of a circle: half a second, 2,000 ticks.
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

/// Runs `lost-motion` in a folder and gives what it printed.
fn done(folder: &Path, arguments: &[&str]) -> String {
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
            let said = done(folder.path(), &[command, &files].concat());
            (said, fs::read(folder.path().join(out)).unwrap())
        };
        let (_, here) = run(&["simulate"], "here.csv");
        let (said, there) = run(&["record", "--port", &port], "there.csv");
        assert!(here == there, "{name}: the logs differ");
        assert!(here.len() > 10_000, "{name}: {} bytes are no log of half a second", here.len());
        assert!(said.contains("instructions in the median"), "{said}");
    }
}
