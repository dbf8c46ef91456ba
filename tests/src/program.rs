//! The program `lost-motion`, for tests that run it.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Builds the program as this test was built, in the same profile and target folder, and gives its path.
///
/// # Panics
/// Where cargo cannot build it, with its messages.
#[must_use]
pub fn lost_motion() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(build)
}

fn build() -> PathBuf {
    // Test binaries are in TARGET/PROFILE/deps.
    let test = std::env::current_exe().expect("the path of a running test is known");
    let folder = test.ancestors().nth(2).expect("a test is in two folders");
    let target = folder.parent().expect("the profile is in the target folder");
    let profile = match folder.file_name().and_then(|name| name.to_str()) {
        Some("debug") | None => "dev",
        Some(other) => other,
    };
    // Not `--package`: the features of the whole workspace are those of the dependencies that are built already.
    let output = Command::new(env!("CARGO"))
        .args(["build", "--bin", "lost-motion", "--profile", profile, "--target-dir"])
        .arg(target)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name(""))
        .output()
        .expect("cargo runs, as it has built this test");
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "lost-motion cannot be built:\n{messages}");
    folder.join("lost-motion").with_extension(std::env::consts::EXE_EXTENSION)
}
