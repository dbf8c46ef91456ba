//! The command line: arguments, results on stdout, progress on stderr, exit codes.

mod app;
mod argument_error;
mod batch;
mod board;
mod budget;
mod certificate;
mod circle;
mod compare;
mod compensate;
mod compensation;
mod demo;
mod examples;
mod friction_map;
mod gcode;
mod help;
mod history;
mod import;
mod improve;
mod init;
mod input_error;
mod limits;
mod logged_run;
mod logs;
mod margins;
mod outputs;
mod plan;
mod positions;
mod progress;
mod questions;
mod reading;
mod record;
mod reproduce;
mod resonances;
mod self_test;
mod sensors;
mod shell;
mod simulate;
mod sound_logs;
mod stop;
mod summary;
mod trace;
mod tune;
mod verify;
mod volume;

use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};

use files::error::{InputError, printable};
use stop::Stopped;

/// Identifies effects of a machine that are missing from its declared model.
#[derive(Parser)]
#[command(name = "lost-motion", version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Simulate a machine with an undeclared effect, trace its logs, and compare the result with the truth.
    Demo(demo::Arguments),
    /// Run a motion on a simulated machine in closed loop and log it.
    Simulate(simulate::Arguments),
    /// Run a motion with the controller on the emulated core, or on a servo board, and log it. On a board it switches the drives
    /// on if they are off.
    Record(record::Arguments),
    /// Ask, operate and set up a servo board; `record` runs a motion on it.
    #[command(subcommand)]
    Board(board::Verb),
    /// Tell what a circle is made of, from its log or a ballbar's table, without a machine file.
    Circle(circle::Arguments),
    /// Evaluate a positioning test after ISO 230-2 and tell what the deviations are made of, without a machine file.
    Positions(positions::Arguments),
    /// Tell which errors of geometry three axes have, from circles and positioning tests at several places, and write tables of them.
    Volume(volume::Arguments),
    /// Turn the effects of a model into the compensation that the controller applies, and predict the contour error.
    Compensate(compensate::Arguments),
    /// Tell what makes a motion wrong at the tool: each cause of a model with its share in µm, and what to do about it.
    Budget(budget::Arguments),
    /// Run the same motions in fixed point, f32, f64 and with f32 positions, and compare errors and cost.
    Compare(compare::Arguments),
    /// Repeat published experiments and compare the printed values with ours.
    Reproduce(reproduce::Arguments),
    /// Close the position loop of one machine by the motor, the table and both: contour error, margins, highest gain.
    Sensors(sensors::Arguments),
    /// Test the tracer on randomly drawn machines that a second, independent simulator simulates.
    SelfTest(self_test::Arguments),
    /// Compute the residuals of logs, identify the missing effects, report the errors before and after.
    Trace(trace::Arguments),
    /// Turn a log that another program wrote into one that the other commands read.
    Import(import::Arguments),
    /// Estimate a machine file from logs: what they show of drive, gains, masses, friction and stiffness.
    Init(init::Arguments),
    /// Plan the shortest motion that decides between effects that a trace could not tell apart.
    Plan(plan::Arguments),
    /// Write a motion as a program for LinuxCNC, Siemens or Fanuc.
    Gcode(gcode::Arguments),
    /// Compute gain and phase margins of the velocity and position loops of a machine file.
    Margins(margins::Arguments),
    /// Find resonances in accelerations at the tool, as Klipper records them.
    Resonances(resonances::Arguments),
    /// Log, trace, compensate and run a simulated machine again, round after round, until nothing more is gained.
    Improve(improve::Arguments),
    /// Propose gains, control law, feedback and feed-forward from the plant of a machine file, with their margins.
    Tune(tune::Arguments),
    /// Tell what changed on a machine over months, from its traces, and when a limit will be reached.
    History(history::Arguments),
    /// Write the tracer as one HTML file, in which anybody reads logs in a browser, without a network.
    App(app::Arguments),
    /// Compare the contour error of the same motions before and after a change with each other and with the prediction.
    Verify(verify::Arguments),
    /// Print completions for a shell.
    Completions(shell::CompletionArguments),
    /// Write the manual pages of the program and its verbs.
    Man(shell::ManArguments),
}

/// The program with all that its help says.
fn command() -> clap::Command {
    help::grouped(Arguments::command())
}

/// Runs the program. Exit codes: 0 success, 1 failure, 2 invalid arguments or input, 130 interrupted.
#[must_use]
pub fn run() -> ExitCode {
    let arguments: Arguments = argument_error::parse_or_exit(command());
    stop::install_handler();
    let outcome = match arguments.command {
        Command::Demo(arguments) => demo::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Record(arguments) => record::run(&arguments),
        Command::Board(verb) => board::run(&verb),
        Command::Circle(arguments) => circle::run(&arguments),
        Command::Positions(arguments) => positions::run(&arguments),
        Command::Volume(arguments) => volume::run(&arguments),
        Command::Compensate(arguments) => compensate::run(&arguments),
        Command::Budget(arguments) => budget::run(&arguments),
        Command::History(arguments) => history::run(&arguments),
        Command::App(arguments) => app::run(&arguments),
        Command::Plan(arguments) => plan::run(&arguments),
        Command::Gcode(arguments) => gcode::run(&arguments),
        Command::Margins(arguments) => margins::run(&arguments),
        Command::Resonances(arguments) => resonances::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Reproduce(arguments) => reproduce::run(&arguments),
        Command::Sensors(arguments) => sensors::run(&arguments),
        Command::SelfTest(arguments) => self_test::run(&arguments),
        Command::Trace(arguments) => trace::run(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Improve(arguments) => improve::run(&arguments),
        Command::Init(arguments) => init::run(&arguments),
        Command::Tune(arguments) => tune::run(&arguments),
        Command::Verify(arguments) => verify::run(&arguments),
        Command::Completions(arguments) => shell::completions(&arguments, command()),
        Command::Man(arguments) => shell::man(&arguments, command()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("lost-motion: {}", printable(&format!("{error:#}")));
            ExitCode::from(match error {
                error if error.is::<InputError>() => 2,
                error if error.is::<Stopped>() => stop::EXIT_CODE,
                _ => 1,
            })
        }
    }
}
