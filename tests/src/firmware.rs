//! Builds the programs of the chip, for tests that read or run them.

use std::path::{Path, PathBuf};
use std::process::Command;

/// The ELF file of `board` or `emulated`, built by the alias of that name.
///
/// # Panics
/// Where cargo cannot build it, with what cargo said.
#[must_use]
pub fn built(program: &str) -> PathBuf {
    let workspace =
        Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests is a folder of the workspace");
    let cargo = Command::new(env!("CARGO")).arg(program).current_dir(workspace).output();
    let output = cargo.expect("cargo runs, as it has built this test");
    assert!(
        output.status.success(),
        "`cargo {program}` failed (is the target thumbv7em-none-eabihf installed?):\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
    // A relative one is relative to where cargo ran; an absolute one replaces what it is joined to.
    let target = workspace.join(std::env::var_os("CARGO_TARGET_DIR").unwrap_or("target".into()));
    target.join("thumbv7em-none-eabihf/firmware").join(program)
}
