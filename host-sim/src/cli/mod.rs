//! The command line: arguments, results on stdout, progress on stderr, exit codes.

mod compare;
mod demo;
mod friction_map;
mod input_error;
mod logged_run;
mod outputs;
mod progress;
mod record;
mod reproduce;
mod self_test;
mod simulate;
mod stop;
mod summary;
mod trace;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use files::error::InputError;
use stop::Stopped;

/// Finds out what a machine does that its model does not say, and gets rid of it.
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
