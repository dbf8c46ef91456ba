//! `lost-motion init`.

use std::io::{IsTerminal, stderr, stdin};
use std::path::{Path, PathBuf};

use anyhow::Result;

use super::outputs::{Output, check_outputs, print};
use super::progress::Progress;
use super::reading::ReadingArguments;
use super::{logs, questions};
use ::init::known::{self, Known};
use files::output::write_whole;
use model::machine::Machine;

/// Arguments of `init`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Log of the machine (CSV, .csv.gz, or - for stdin); may be given several times. Motions with reversals, several speeds and fast
    /// changes show most.
    #[arg(long = "log", required = true)]
    logs: Vec<PathBuf>,
    /// Machine file with what is known: its values are kept, all others are estimated. Default: nothing is known.
    #[arg(long)]
    machine: Option<PathBuf>,
    /// A value that is known, as in a machine file: `x.lead_mm=10`, `y.drive=stepper`, `x.feedback=table`.
    #[arg(long, value_name = "AXIS.KEY=VALUE")]
    set: Vec<Known>,
    /// Machine file to write.
    #[arg(long)]
    out: PathBuf,
    #[command(flatten)]
    reading: ReadingArguments,
}

/// Runs the command.
///
/// # Errors
/// Input that cannot be used, an output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let inputs: Vec<&Path> = arguments.logs.iter().chain(&arguments.machine).map(PathBuf::as_path).collect();
    check_outputs(&inputs, &[Output::File("--out", Some(&arguments.out))])?;
    let logs = logs::read(&arguments.logs, &arguments.reading.request()?)?;
    let declared = match &arguments.machine {
        Some(path) => Machine::read(path)?,
        None => ::init::unknown("machine", &logs)?,
    };
    let mut declared = known::with(&declared, &arguments.set, "--set")?;
    let is_asked = stdin().is_terminal() && stderr().is_terminal();
    if is_asked && !arguments.logs.iter().any(|path| path.as_os_str() == "-") {
        let said = questions::ask(&declared, &logs, &mut stdin().lock(), &mut stderr())?;
        declared = known::with(&declared, &said, "answer")?;
    }
    let progress = Progress::start();
    let initial = ::init::machine(&declared, &logs, &|what: &str| progress.show(what))?;
    drop(progress);
    let names: Vec<String> = arguments.logs.iter().map(|path| path.display().to_string()).collect();
    let text = ::init::written::file(&initial, &names);
    write_whole(&arguments.out, |out| out.write_all(text.as_bytes()))?;
    print(&format!("{}\nMachine file: {}", ::init::written::summary(&initial), arguments.out.display()))
}
