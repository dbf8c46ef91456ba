//! `lost-motion import`.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::outputs::{Output, check_outputs, print};
use super::reading::ReadingArguments;
use ::import::budget::Budget;
use ::import::{Foreign, ballbar, save};
use files::error::{InputError, in_one_line, quoted};
use files::head::Head;

/// Arguments of `import`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Log of another program: separated text (CSV, tabs, semicolons, spaces; decimal comma), LinuxCNC halsampler or halscope, MATLAB
    /// (.mat of level 5), NumPy (.npy, .npz), Parquet, MCAP, exports of TwinCAT Scope.
    file: PathBuf,
    /// Log to write: CSV, .csv.gz, .parquet or .mcap.
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    reading: ReadingArguments,
}

/// Runs the command.
///
/// # Errors
/// A file that is no table, a column or a unit that it does not have, an output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    check_outputs(&[&arguments.file], &[Output::File("--out", Some(&arguments.out))])?;
    let request = arguments.reading.request()?;
    let source = arguments.file.display().to_string();
    let head = Head::open(&arguments.file, &source)?;
    if ballbar::is_own(&head.names()) {
        let problem = "this table of a ballbar needs no import: lost-motion circle reads it (with --radius MM, if it has radius_um)";
        return Err(InputError::new(&source, problem).into());
    }
    let bytes = Budget::file().read(head.into_input(), &source)?;
    let (what, notes) = match ::import::foreign(&bytes, &source, &request)? {
        Foreign::Log(imported) => {
            save::write(&imported.log, &arguments.out)?;
            ("Log", imported.notes)
        }
        Foreign::Ballbar(table) => {
            check_csv(&arguments.out)?;
            table.write(&arguments.out)?;
            ("For lost-motion circle", table.notes)
        }
    };
    let notes: String = notes.iter().map(|note| format!("{}\n", in_one_line(note))).collect();
    print(&format!("{notes}{what}: {}", arguments.out.display()))
}

/// Checks that the table of a ballbar is written as CSV, which `circle` reads.
fn check_csv(out: &Path) -> Result<(), InputError> {
    if out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv")) {
        return Ok(());
    }
    let expected = "a name that ends in .csv, as the table of a ballbar is written";
    Err(InputError::expected("--out", expected, quoted(&out.display().to_string())))
}
