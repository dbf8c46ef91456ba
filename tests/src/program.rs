//! Builds `lost-motion`, for tests that run it.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// The program, built as this test was: in the same profile, into the same folder.
///
/// # Panics
/// Where cargo cannot build it, with what cargo said.
#[must_use]
pub fn lost_motion() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(build)
}

fn build() -> PathBuf {
    // Tests lie in TARGET/PROFILE/deps.
    let test = std::env::current_exe().expect("a test knows where it lies");
    let folder = test.ancestors().nth(2).expect("two folders around it");
    let target = folder.parent().expect("one more around these");
    let profile = match folder.file_name().and_then(|name| name.to_str()) {
        Some("debug") | None => "dev",
        Some(other) => other,
    };
    // Not `--package`: with the features of the whole workspace, as they are built already.
    let output = Command::new(env!("CARGO"))
        .args(["build", "--bin", "lost-motion", "--profile", profile, "--target-dir"])
        .arg(target)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name(""))
        .output()
        .expect("cargo runs, as it has built this test");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "lost-motion cannot be built:\n{said}");
    folder.join("lost-motion").with_extension(std::env::consts::EXE_EXTENSION)
}
