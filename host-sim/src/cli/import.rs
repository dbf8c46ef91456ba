//! `lost-motion import`.

use std::path::PathBuf;

use anyhow::Result;

use super::outputs::{Output, check_outputs, print};
use ::import::format::Format;
use ::import::request::{Mapping, Request, UnitOf};
use files::error::{InputError, quoted};

/// Arguments of `import`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Log of another program: separated text (CSV, tabs, semicolons, spaces; decimal comma), LinuxCNC halsampler or halscope, MATLAB
    /// (.mat of level 5), NumPy (.npy, .npz), Parquet, MCAP, exports of TwinCAT Scope.
    file: PathBuf,
    /// Log to write: CSV, .csv.gz, .parquet or .mcap.
    #[arg(long)]
    out: PathBuf,
    /// Column of a channel, `x_command_mm=X cmd`, or of the times, `time_s=THEIRS`. Without a header, columns are counted from 1; of a
    /// matrix they are VARIABLE:1, VARIABLE:2, …
    #[arg(long = "map", value_name = "OURS=THEIRS")]
    mappings: Vec<Mapping>,
    /// Unit of a column, if its header does not say it: `x_command_mm=inch`, `x_motor_mm=counts*0.0005`, `time_s=ms`.
    #[arg(long = "unit", value_name = "OURS=UNIT")]
    units: Vec<UnitOf>,
    /// Samples per second, if the file has no times.
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Format of the file, if it is not to be recognised by content.
    #[arg(long, value_name = "NAME")]
    preset: Option<Format>,
}

/// Runs the command.
///
/// # Errors
/// A file that is no table, a column or a unit that it does not have, an output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    check_outputs(&[&arguments.file], &[Output::File("--out", Some(&arguments.out))])?;
    if let Some(rate) = arguments.rate.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
        return Err(InputError::expected(
            "--rate",
            "a number of samples per second",
            quoted(&rate.to_string()),
        )
        .into());
    }
    let request = Request {
        mappings: arguments.mappings.clone(),
        units: arguments.units.clone(),
        rate_hz: arguments.rate,
        preset: arguments.preset,
    };
    let imported = ::import::import(&arguments.file, &request)?;
    ::import::save::write(&imported.log, &arguments.out)?;
    let notes: String = imported.notes.iter().map(|note| format!("{note}\n")).collect();
    print(&format!("{notes}Log: {}", arguments.out.display()))
}
