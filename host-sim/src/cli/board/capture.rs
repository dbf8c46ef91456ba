//! `lost-motion board capture`: every tick of all axes, from the memory of the board.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail};
use clap::ValueEnum;

use super::port::{PortArguments, check_value};
use crate::cli::outputs::{Output, check_outputs, print};
use crate::cli::stop;
use ::board::Client;
use ::board::motion::POLL;
use ::board::refusal::AXIS_NAMES;
use ::board::samples::AxisSample;
use files::error::InputError;
use files::log::{AxisLog, Channel, Log, Unit, write_rows};
use shared::capture::{CaptureState, Trigger};
use shared::link::Request;
use shared::link::message::PerAxis;

/// Arguments of `board capture`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    port: PortArguments,
    /// What to do; without it, arm, wait and read.
    #[arg(long, value_enum)]
    only: Option<Step>,
    /// When the recording starts.
    #[arg(long, value_enum, default_value = "motion")]
    trigger: When,
    /// Duration.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value_t = 0.5)]
    seconds: f64,
    /// Log to write (CSV, or .csv.gz).
    #[arg(long, required_unless_present = "only")]
    out: Option<PathBuf>,
}

/// A part of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Step {
    /// Arm it and return.
    Arm,
    /// Read one that is complete.
    Read,
}

/// When the recording starts.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum When {
    /// At once.
    Now,
    /// With the next motion.
    Motion,
}

/// Longest recording that can be asked for, s.
const MAX_S: f64 = 3600.0;

/// Runs the command.
///
/// # Errors
/// Invalid arguments, a board that cannot be reached, nothing recorded, output that cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let seconds = arguments.seconds;
    let expected = format!("seconds above 0 and up to {MAX_S}");
    check_value("--seconds", &expected, seconds > 0.0 && seconds <= MAX_S, seconds)?;
    let out = log_to_write(arguments)?;
    check_outputs(&[], &[Output::File("--out", out)])?;
    let mut client = arguments.port.connect()?;
    if arguments.only != Some(Step::Read) {
        arm(&mut client, arguments)?;
    }
    let Some(out) = out else { return print("The recording is armed.") };
    if arguments.only.is_none() {
        wait(&mut client)?;
    }
    read(&mut client, out)
}

/// The log to write; `None` if the recording is only armed.
fn log_to_write(arguments: &Arguments) -> Result<Option<&PathBuf>, InputError> {
    match (&arguments.out, arguments.only) {
        (Some(_), Some(Step::Arm)) => {
            Err(InputError::new("--out", "cannot be used with --only arm, which writes no log"))
        }
        (None, Some(Step::Read)) => Err(InputError::expected("--out", "a log to write", "none")),
        (out, _) => Ok(out.as_ref()),
    }
}

fn arm(client: &mut Client, arguments: &Arguments) -> Result<()> {
    let trigger = match arguments.trigger {
        When::Now => Trigger::Now,
        When::Motion => Trigger::Motion,
    };
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "up to 3600 s")]
    let samples = (arguments.seconds * client.welcome().rates.velocity_loop_hz).round() as u32;
    Ok(client.command(&Request::Arm { trigger, samples })?)
}

/// Waits for the end of the recording. An interrupt ends it.
fn wait(client: &mut Client) -> Result<()> {
    stop::write_partial_result();
    while client.capture_report()?.state != CaptureState::Complete {
        if stop::is_interrupted() {
            client.command(&Request::EndCapture)?;
            return Err(stop::Stopped { done: 0, asked: 1, what: "recordings" }.into());
        }
        client.listen(POLL)?;
    }
    Ok(())
}

/// Reads the recording, which may still run, into a log.
fn read(client: &mut Client, out: &Path) -> Result<()> {
    while client.capture_report()?.state == CaptureState::Recording {
        client.listen(POLL)?;
    }
    let report = client.capture_report()?;
    match report.state {
        CaptureState::Armed => {
            bail!("nothing was recorded: the recording is armed, and nothing has moved since")
        }
        CaptureState::Complete if report.samples > 0 => {}
        _ => bail!("nothing was recorded: --only arm prepares a recording"),
    }
    let samples = client.read_capture()?;
    let tick_hz = client.welcome().rates.velocity_loop_hz;
    let has_scale = write_log(out, 1.0 / tick_hz, &samples)?;
    let missing = if has_scale { "" } else { " Without the scales: a signal was missing." };
    print(&format!(
        "{} samples at {tick_hz} Hz in {}, {} bytes in the memory of the board.{missing}",
        samples.len(),
        out.display(),
        report.bytes
    ))
}

/// Writes a log. The scales are left out if a signal was missing. Returns whether they are in it.
pub fn write_log(out: &Path, sample_time_s: f64, samples: &[PerAxis<AxisSample>]) -> Result<bool> {
    let has_scale = samples.iter().flatten().all(|axis| axis.table_m.is_some());
    let axis = |name: &&str| {
        let mut axis = AxisLog::new(*name, Unit::Millimetre);
        for channel in [Channel::Command, Channel::Motor, Channel::Table, Channel::Force] {
            if channel != Channel::Table || has_scale {
                *axis.channel_mut(channel) = Some(Vec::new());
            }
        }
        axis
    };
    let axes = samples.first().map_or(0, |sample| sample.len());
    let head = Log::new("board", 0.0, sample_time_s, AXIS_NAMES.iter().take(axes).map(axis));
    write_rows(out, &head, |rows| {
        for sample in samples {
            rows.row(sample.iter().flat_map(|axis| {
                let table = axis.table_m.filter(|_| has_scale).map(|m| 1e3 * m);
                let positions = [Some(1e3 * axis.command_m), Some(1e3 * axis.motor_m), table];
                positions.into_iter().chain([Some(axis.force_n)]).flatten()
            }))?;
        }
        Ok(())
    })?;
    Ok(has_scale)
}
