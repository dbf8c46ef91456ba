//! `lost-motion board`: the commands for a servo board, one file each. `record` is a command of its own.

pub mod anticogging;
pub mod bench;
pub mod capture;
mod consent;
pub mod direction;
pub mod feed_override;
mod follow;
mod home;
pub mod jog;
pub mod monitor;
pub mod port;
pub mod ports;
mod preload;
mod probe;
pub mod record;
pub mod response;
pub mod simple;
pub mod status;
pub mod upload;

use anyhow::Result;
use clap::Subcommand;

/// What to do with a servo board.
#[derive(Subcommand)]
pub enum Verb {
    /// List the serial ports, and the emulated servo board.
    Ports,
    /// Tell what the board is and does, with its last faults.
    Status(status::Arguments),
    /// Send the settings of a machine file, and a compensation, to the board.
    Upload(upload::Arguments),
    /// Switch the drives on.
    Enable(simple::Arguments),
    /// Switch the drives off at once, also while another program holds the port.
    Disable(simple::Arguments),
    /// Acknowledge a fault.
    Clear(simple::Arguments),
    /// Move one axis. Switches the drives on if they are off.
    Jog(jog::Arguments),
    /// Push an axis with a small force, loops open, and tell whether it moves the right way.
    CheckDirection(direction::Arguments),
    /// Move an axis to its reference. Switches the drives on if they are off.
    Home(home::Arguments),
    /// Move an axis until the probe is touched, and tell the positions of that tick. Switches the drives on if they are off.
    Probe(probe::Arguments),
    /// Let an axis follow an external counter by a ratio until it is stopped. Switches the drives on if they are off.
    Follow(follow::Arguments),
    /// Feed hold: decelerate along the path, also that of another program at the port; `board resume` continues it.
    Hold(simple::Arguments),
    /// Continue the path after a hold, and wait for its end.
    Resume(simple::Arguments),
    /// Decelerate along the path, also that of another program at the port, and discard the rest of it.
    Stop(simple::Arguments),
    /// Feed override: let what runs, also for another program at the port, run at 0 to 200 % of its planned speed.
    Override(feed_override::Arguments),
    /// Measure the frequency response of an axis at rest with a small force: plant, loops, margins, resonances.
    Response(response::Arguments),
    /// Learn the cogging of a motor from slow passes, as a compensation file.
    Anticogging(anticogging::Arguments),
    /// Print a line about the board at intervals.
    Monitor(monitor::Arguments),
    /// Record every tick in the memory of the board and write the log.
    Capture(capture::Arguments),
    /// Operate the switches of the simulated machine of the emulated board.
    Bench(bench::Arguments),
}

/// Runs a command for a servo board.
///
/// # Errors
/// See the commands.
pub fn run(verb: &Verb) -> Result<()> {
    match verb {
        Verb::Ports => ports::run(),
        Verb::Status(arguments) => status::run(arguments),
        Verb::Upload(arguments) => upload::run(arguments),
        Verb::Enable(arguments) => simple::enable(arguments),
        Verb::Disable(arguments) => simple::disable(arguments),
        Verb::Clear(arguments) => simple::clear(arguments),
        Verb::Jog(arguments) => jog::run(arguments),
        Verb::CheckDirection(arguments) => direction::run(arguments),
        Verb::Home(arguments) => home::run(arguments),
        Verb::Probe(arguments) => probe::run(arguments),
        Verb::Follow(arguments) => follow::run(arguments),
        Verb::Hold(arguments) => simple::hold(arguments),
        Verb::Resume(arguments) => simple::resume(arguments),
        Verb::Stop(arguments) => simple::stop(arguments),
        Verb::Override(arguments) => feed_override::run(arguments),
        Verb::Response(arguments) => response::run(arguments),
        Verb::Anticogging(arguments) => anticogging::run(arguments),
        Verb::Monitor(arguments) => monitor::run(arguments),
        Verb::Capture(arguments) => capture::run(arguments),
        Verb::Bench(arguments) => bench::run(arguments),
    }
}
