//! axe-core, which finds what hinders keyboards and screen readers. npm fetches it once into the folder of cargo; without npm or network it is
//! left out, and the test says so.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

const PACKAGE: &str = "axe-core@4.10.3";

/// Puts the script beside a page; false if it could not be fetched.
pub fn put_beside(page: &Path) -> bool {
    static SCRIPT: OnceLock<Option<PathBuf>> = OnceLock::new();
    let script = SCRIPT.get_or_init(|| match fetched() {
        Ok(script) => Some(script),
        Err(why) => {
            eprintln!("{PACKAGE} was not fetched ({why}): keyboard and screen reader were not checked");
            None
        }
    });
    script.as_ref().is_some_and(|script| fs::copy(script, page.with_file_name("axe.min.js")).is_ok())
}

fn fetched() -> Result<PathBuf, String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(PACKAGE);
    let script = folder.join("package").join("axe.min.js");
    if script.exists() {
        return Ok(script);
    }
    fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    run(Command::new("npm").args(["pack", "--silent", PACKAGE]).current_dir(&folder))?;
    let packed = PACKAGE.replace('@', "-") + ".tgz";
    run(Command::new("tar").args(["xzf", &packed, "package/axe.min.js"]).current_dir(&folder))?;
    Ok(script)
}

fn run(command: &mut Command) -> Result<(), String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    if output.status.success() { Ok(()) } else { Err(format!("{command:?}: {}", said.trim())) }
}
