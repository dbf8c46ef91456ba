//! `lost-motion board` with `enable`, `disable`, `clear`, `hold`, `resume` and `stop`.

use std::thread::sleep;

use anyhow::Result;

use super::port::PortArguments;
use crate::cli::outputs::print;
use crate::cli::stop;
use ::board::motion::{POLL, stopped};
use ::board::{BoardError, Client, Observer};
use shared::interpolate::feed_hold::FeedState;
use shared::link::halt::Halt;
use shared::link::report::Activity;
use shared::link::{Refusal, Request, Status};
use shared::safety::Power;

/// Arguments of a command that needs nothing but the port.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    port: PortArguments,
}

/// Enables the drives and waits until they are on.
///
/// # Errors
/// A board that cannot be reached or refuses it.
pub fn enable(arguments: &Arguments) -> Result<()> {
    let mut client = arguments.port.connect()?;
    client.enable()?;
    let off_ms = client.welcome().times.off_ms;
    print(&format!(
        "The drives are on. Without a further command they go off after {} s.",
        f64::from(off_ms) / 1e3
    ))
}

/// Disables the drives, also while another program holds the port, and waits until brakes have closed.
///
/// # Errors
/// A board that cannot be reached.
pub fn disable(arguments: &Arguments) -> Result<()> {
    let mut observer = arguments.port.observe()?;
    observer.halt(Halt::Disable)?;
    loop {
        let Some(status) = seen(&mut observer)? else {
            return print(
                "The drives go off, as soon as brakes have closed; their host is at the other port of the board.",
            );
        };
        match status.power {
            Power::Disabling(None) => sleep(POLL),
            Power::Disabling(Some(_)) | Power::Faulted(_) => return Err(stopped(&status).into()),
            Power::Off | Power::On | Power::Enabling | Power::Stopping(_) => break,
        }
    }
    print("The drives are off.")
}

/// Acknowledges a fault.
///
/// # Errors
/// A board that cannot be reached or refuses it.
pub fn clear(arguments: &Arguments) -> Result<()> {
    let mut client = arguments.port.connect()?;
    let power = client.status()?.power;
    client.command(&Request::Clear)?;
    print(match power.fault() {
        Some(_) => "The fault is acknowledged.",
        None => "There is no fault to acknowledge.",
    })
}

/// Holds the path, also that of another program that holds the port.
///
/// # Errors
/// A board that cannot be reached.
pub fn hold(arguments: &Arguments) -> Result<()> {
    let mut observer = arguments.port.observe()?;
    observer.halt(Halt::Hold)?;
    print(match seen(&mut observer)?.map(|status| (status.activity, status.feed)) {
        None => "The path is held, if one runs; its host is at the other port of the board.",
        Some((Activity::Idle, _)) => "No path runs: nothing is held.",
        Some((Activity::Following, _)) => "The axis decelerates, and follows the counter no longer.",
        Some((_, FeedState::Discarding)) => "The path is being stopped: nothing is held.",
        Some(_) => "The path is held.",
    })
}

/// Stops the path, also that of another program that holds the port, and waits until the axes are at rest.
///
/// # Errors
/// A board that cannot be reached, drives that have stopped by a fault.
pub fn stop(arguments: &Arguments) -> Result<()> {
    let mut observer = arguments.port.observe()?;
    observer.halt(Halt::Stop)?;
    loop {
        let Some(status) = seen(&mut observer)? else {
            return print(
                "The axes decelerate, if they moved; their host is at the other port of the board.",
            );
        };
        match status.power {
            Power::On if !status.at_rest || status.activity != Activity::Idle => sleep(POLL),
            power if power.fault().is_some() => return Err(stopped(&status).into()),
            _ => break,
        }
    }
    print("The axes are at rest; no path is left.")
}

/// The state of the board; `None` if a host at its other port keeps it.
fn seen(observer: &mut Observer) -> Result<Option<Status>> {
    match observer.status() {
        Err(BoardError::Refused(Refusal::OtherPort)) => Ok(None),
        other => Ok(Some(other?)),
    }
}

/// Continues a path that is held, and waits for its end.
///
/// # Errors
/// A board that cannot be reached or refuses it.
pub fn resume(arguments: &Arguments) -> Result<()> {
    let mut client = arguments.port.connect()?;
    stop::write_partial_result();
    client.command(&Request::Resume)?;
    wait(&mut client)?;
    print("The path has ended.")
}

/// Waits until the axes are at rest. An interrupt stops them.
///
/// # Errors
/// Drives that have gone off, an interrupt.
pub fn wait(client: &mut Client) -> Result<()> {
    let mut interrupted = false;
    client.wait(|client, _| {
        if stop::is_interrupted() && !interrupted {
            interrupted = true;
            client.command(&Request::Stop)?;
        }
        Ok(true)
    })?;
    if interrupted {
        return Err(stop::MOTION_STOPPED.into());
    }
    Ok(())
}
