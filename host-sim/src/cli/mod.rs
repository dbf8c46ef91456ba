//! The command line: arguments, results on stdout, progress on stderr, exit codes.

mod compare;
mod demo;
mod friction_map;
mod input_error;
mod logged_run;
mod progress;
mod record;
mod reproduce;
mod self_test;
mod simulate;
mod stop;
mod summary;
mod trace;

use std::io::{ErrorKind, Write, stdout};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use files::error::{InputError, quoted};
use stop::Stopped;

/// Finds out what a machine does that its model does not print, and gets rid of it.
#[derive(Parser)]
#[command(name = "lost-motion", version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// The main job with nothing to prepare: run, log, trace, and reveal the truth.
    Demo(demo::Arguments),
    /// Close the loop on a simulated machine and log it.
    Simulate(simulate::Arguments),
    /// The same motion with the controller on the emulated core; boards on a serial port cannot be reached yet.
    Record(record::Arguments),
    /// The same motions in fixed point, f32, f64, and with f32 positions: what each loses.
    Compare(compare::Arguments),
    /// The published experiments again: the paper's figure beside ours.
    Reproduce(reproduce::Arguments),
    /// Machines drawn at random, simulated by a second program, traced blind, and scored.
    SelfTest(self_test::Arguments),
    /// Find the residual of a log, name its causes, report before and after.
    Trace(trace::Arguments),
}

/// Runs the program. Exit codes: 0 done, 1 the job failed, 2 unusable arguments or input, 130 interrupted.
#[must_use]
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    stop::install_handler();
    let outcome = match arguments.command {
        Command::Demo(arguments) => demo::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Record(arguments) => record::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Reproduce(arguments) => reproduce::run(&arguments),
        Command::SelfTest(arguments) => self_test::run(&arguments),
        Command::Trace(arguments) => trace::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("lost-motion: {error:#}");
            ExitCode::from(match error {
                error if error.is::<InputError>() => 2,
                error if error.is::<Stopped>() => stop::EXIT_CODE,
                _ => 1,
            })
        }
    }
}

/// Checks that no output overwrites an input or another output. `outputs` are the flags and their paths.
fn check_outputs(inputs: &[&Path], outputs: &[(&str, Option<&PathBuf>)]) -> Result<(), InputError> {
    let canonical = |path: &Path| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let in_folder = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
        path.canonicalize().ok().or_else(in_folder).filter(|path| !path.exists() || path.is_file())
    };
    let mut taken: Vec<PathBuf> = inputs.iter().filter_map(|path| canonical(path)).collect();
    for (flag, path) in outputs {
        let Some(path) = path.and_then(|path| canonical(path)) else { continue };
        if taken.contains(&path) {
            let expected = "a file that is neither an input nor another output";
            return Err(InputError::expected(flag, expected, quoted(&path.display().to_string())));
        }
        taken.push(path);
    }
    Ok(())
}

/// Prints the result on stdout. A closed pipe is no error: all files are written before.
fn print(text: &str) -> anyhow::Result<()> {
    match writeln!(stdout().lock(), "{text}") {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}
