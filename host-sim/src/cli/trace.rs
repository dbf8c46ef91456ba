//! `lost-motion trace`.

use std::path::PathBuf;

use anyhow::Result;

use crate::log::Log;
use crate::machine::Machine;
use crate::output::write_whole;
use crate::trace;

/// Arguments of `trace`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Machine file: what is declared.
    #[arg(long)]
    machine: PathBuf,
    /// A log to explain (CSV, .csv.gz, or - for stdin); may be given several times.
    #[arg(long, required = true)]
    fit: Vec<PathBuf>,
    /// A log that takes part in no fit and no choice; without one the last quarter of each fit log.
    #[arg(long)]
    validate: Vec<PathBuf>,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write the better machine file.
    #[arg(long)]
    model: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Input that cannot be used, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let machine = Machine::read(&arguments.machine)?;
    let read = |paths: &[PathBuf]| paths.iter().map(|path| Log::read(path)).collect::<Result<Vec<_>, _>>();
    let (fit, validate) = (read(&arguments.fit)?, read(&arguments.validate)?);
    let trace = trace::trace(&machine, &fit, &validate, &|what| eprintln!("{what}"))?;
    for axis in &trace.axes {
        println!("{}", axis.axis);
        for e in &axis.errors {
            println!("  {:?} before {:.4} / {:.4} after {:.4} / {:.4} noise {:.4}", e.stage, e.before.fit, e.before.validate, e.after.fit, e.after.validate, e.noise);
        }
        for f in &axis.found {
            println!("  {:?} ± {:?} {:.1}% {:?}", f.effect, f.half_widths, f.validate_reduction_percent, f.stage);
        }
        for u in &axis.unexplained {
            println!("  {u:?}");
        }
        for r in &axis.rounds {
            println!("  round {:?} added {:?}", r.stages, r.added);
            for c in r.candidates.iter().take(5) {
                if let Some(f) = &c.fitted { println!("       {:?}", f.slots.iter().map(|s| (s.coordinate.lower, s.coordinate.value, s.coordinate.upper)).collect::<Vec<_>>()); }
                println!("     {:.4} {:?} {:?}", c.gain, c.effect, c.comparison.iter().map(|c| (c.stage, (c.reduction * 1e3).round() / 1e3, (c.t*100.).round()/100., c.folds_better, (c.worst_log*1e3).round()/1e3)).collect::<Vec<_>>());
            }
        }
    }
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&trace::report::json(&trace))?;
        write_whole(path, |out| out.write_all(text.as_bytes()))?;
    }
    if let Some(path) = &arguments.model {
        write_whole(path, |out| out.write_all(trace.better_machine().to_toml().as_bytes()))?;
    }
    Ok(())
}
