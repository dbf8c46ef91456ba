//! `lost-motion record` on a servo board: the motion runs on the board, which streams its samples.

use std::path::Path;

use anyhow::Result;

use super::capture::write_log;
use super::consent;
use super::port::connect;
use super::upload;
use crate::cli::outputs::print;
use crate::cli::progress::Progress;
use crate::cli::stop;
use ::board::refusal::AXIS_NAMES;
use ::board::samples::{self, AxisSample};
use ::board::{BoardError, Client};
use files::error::InputError;
use files::format::significant;
use model::machine::Machine;
use motion::{Motion, PathBlock};
use plant::machine_path::MachinePath;
use shared::interpolate::{BlockOf, PathError};
use shared::link::halt::Halt;
use shared::link::message::{MAX_AXES, MOTION_BLOCKS, PerAxis, Request};
use shared::link::refusal::Refusal;

/// The machine file of the emulated board.
const BENCH_MACHINE: &str = include_str!("../../../machines/bench.toml");

/// Its name in messages.
const BENCH_MACHINE_FILE: &str = "machines/bench.toml";

/// Speed of the way to the start of the motion, m/s.
const APPROACH_M_PER_S: f64 = 0.02;

/// Acceleration of that way, m/s².
const APPROACH_M_PER_S2: f64 = 0.2;

/// Distance from the start of the motion at which the axes are there, m.
pub(super) const AT_START_M: f64 = 1e-9;

/// The machine file with whose settings the board runs, and its name in messages; without a path, that of the emulated board.
///
/// # Errors
/// A file that cannot be read, or is not valid.
pub fn machine_of(path: Option<&Path>) -> Result<(Machine, String), InputError> {
    match path {
        Some(path) => Ok((Machine::read(path)?, path.display().to_string())),
        None => Ok((Machine::parse(BENCH_MACHINE, BENCH_MACHINE_FILE)?, BENCH_MACHINE_FILE.to_owned())),
    }
}

/// A motion for a board.
pub struct Recording<'a> {
    /// Name of the port.
    pub port: &'a str,
    /// Timeout for a reply, s.
    pub timeout_s: f64,
    /// Machine file.
    pub machine: &'a Machine,
    /// Its name.
    pub machine_file: &'a str,
    /// Motion file.
    pub motion: &'a Motion,
    /// Its name.
    pub motion_file: &'a str,
    /// Log to write.
    pub out: &'a Path,
    /// Whether it may move without asking.
    pub yes: bool,
}

/// Runs the motion and writes its log.
///
/// # Errors
/// Input that the board refuses, no consent, a board that cannot be reached, drives that go off, lost samples, output that cannot be
/// written.
pub fn run(recording: &Recording<'_>) -> Result<()> {
    let Recording { machine, motion, motion_file, .. } = *recording;
    // The same check as for an upload: axes of a board with the keys of a controller.
    upload::settings(machine, recording.machine_file)?;
    let path = MachinePath::new(motion, machine, motion_file)?;
    let blocks: Vec<BlockOf<PerAxis<f64>>> = path.blocks.iter().filter_map(PathBlock::for_board).collect();
    if blocks.len() > MOTION_BLOCKS {
        let expected = format!("at most {MOTION_BLOCKS} blocks, which the board holds");
        return Err(InputError::expected(motion_file, expected, blocks.len()).at_key("block").into());
    }
    let mut client = connect(recording.port, recording.timeout_s)?;
    upload::check_axis_count(machine, recording.machine_file, &client)?;
    let tick_hz = client.welcome().rates.velocity_loop_hz;
    check_ticks(machine, recording.machine_file, tick_hz)?;
    let decimation = decimation(machine, recording.machine_file, tick_hz)?;
    consent::ask(&consequence(&path.start_m), recording.yes)?;
    stop::write_partial_result();
    client.enable()?;
    stop::check_before_motion()?;
    let progress = Progress::start();
    progress.show("to the start");
    let approach = approach(&mut client, &path.start_m, motion_file)?;
    client.send_motion(&blocks).map_err(|error| refused(error, motion_file))?;
    let samples = run_and_stream(&mut client, blocks.len(), decimation, &progress)?;
    drop(progress);
    let has_scale = write_log(recording.out, f64::from(decimation) / tick_hz, &samples)?;
    print(&format!(
        "{} ran {} on {}: {} samples at {} Hz in {}.{approach}{}\n\n{}",
        machine.name,
        motion.name,
        recording.port,
        samples.len(),
        tick_hz / f64::from(decimation),
        recording.out.display(),
        if has_scale { "" } else { " Without the scales: a signal was missing." },
        summary(&samples)
    ))
}

/// What a recording does to the machine, in words.
fn consequence(start_m: &[f64]) -> String {
    format!(
        "record switches the drives on if they are off, moves the axes in a straight line to the start of the motion ({}), and then \
         along it",
        place(start_m)
    )
}

/// A position in words.
fn place(at_m: &[f64]) -> String {
    let axes = AXIS_NAMES.iter().zip(at_m).map(|(name, m)| format!("{name} {:.3}", 1e3 * m));
    format!("{} mm", axes.collect::<Vec<_>>().join(", "))
}

/// The rate of the velocity loop has to be the tick rate of the board, as for an upload.
pub(super) fn check_ticks(machine: &Machine, machine_file: &str, tick_hz: f64) -> Result<(), InputError> {
    let found_hz = machine.rates().velocity_loop_hz;
    if found_hz.to_bits() == tick_hz.to_bits() {
        return Ok(());
    }
    let expected = format!("{tick_hz}, the tick rate of the board");
    Err(InputError::expected(machine_file, expected, found_hz).at_key("velocity_loop_rate_hz"))
}

/// Ticks per row of the log.
pub(super) fn decimation(machine: &Machine, machine_file: &str, tick_hz: f64) -> Result<u32, InputError> {
    let ticks = tick_hz / machine.sample_rate_hz;
    if ticks < 1.0 || (ticks - ticks.round()).abs() > 1e-9 {
        let expected = format!("a divisor of the board's {tick_hz} ticks per second");
        let error = InputError::expected(machine_file, expected, machine.sample_rate_hz);
        return Err(error.at_key("sample_rate_hz"));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1; saturates")]
    Ok(ticks.round() as u32)
}

/// Moves to the start of the motion. Returns a sentence about it, empty if the axes are there.
fn approach(client: &mut Client, start_m: &[f64], motion_file: &str) -> Result<String> {
    let status = client.status()?;
    let away = status
        .axes
        .iter()
        .zip(start_m)
        .any(|(axis, to)| axis.gantry.is_none() && (axis.command.to_m() - to).abs() > AT_START_M);
    if !away {
        return Ok(String::new());
    }
    let to_m: PerAxis<f64> = start_m.iter().copied().take(MAX_AXES).collect();
    let line = BlockOf::line_to(to_m, APPROACH_M_PER_S, APPROACH_M_PER_S2);
    let sent = client.send_motion(&[line]);
    sent.map_err(|error| refused_at(error, motion_file, |_| "start_mm".to_owned()))?;
    client.start_motion(1)?;
    super::simple::wait(client).or_else(|error| discard_if_held(client, error))?;
    Ok(format!(" The axes were moved to its start first ({}).", place(start_m)))
}

/// Runs the motion that was sent, and collects the samples from its start to its end.
pub(super) fn run_and_stream(
    client: &mut Client,
    blocks: usize,
    decimation: u32,
    progress: &Progress,
) -> Result<Vec<PerAxis<AxisSample>>> {
    let steps = client.welcome().steps.clone();
    let tick_hz = client.welcome().rates.velocity_loop_hz;
    client.command(&Request::Stream { decimation })?;
    // Sending the blocks takes time.
    stop::check_before_motion()?;
    client.start_motion(blocks)?;
    let mut collected = Vec::new();
    let (mut next, mut lost, mut interrupted) = (0u32, 0u32, false);
    let mut take = |client: &mut Client| -> Result<f64, BoardError> {
        while let Some(packet) = client.streamed() {
            let new = samples::of_packet(&steps, &packet).map_err(|_| BoardError::Unexpected)?;
            // On the board or on the way: the numbers tell.
            lost += packet.first.wrapping_sub(next);
            next = packet.first.wrapping_add(packet.samples.into());
            collected.extend(new);
        }
        Ok(f64::from(next) * f64::from(decimation) / tick_hz)
    };
    let waited = client.wait(|client, _| {
        let time_s = take(client)?;
        progress.show(&format!("{time_s:.1} s"));
        if stop::is_interrupted() && !interrupted {
            interrupted = true;
            client.command(&Request::Stop)?;
        }
        Ok(true)
    });
    waited.map(drop).or_else(|error| discard_if_held(client, error.into()))?;
    client.command(&Request::Stream { decimation: 0 })?;
    take(client)?;
    if interrupted {
        return Err(stop::MOTION_STOPPED.into());
    }
    if lost > 0 {
        anyhow::bail!(
            "{lost} samples were lost on the link, {} arrived: repeat it while this computer does less, or give a machine file \
             (--machine) with a lower sample_rate_hz",
            collected.len()
        );
    }
    Ok(collected)
}

/// The error of a wait. If the path is held, its rest is discarded: a recording with a standstill in a block is of no use.
fn discard_if_held(client: &mut Client, error: anyhow::Error) -> Result<()> {
    let why = match error.downcast_ref() {
        Some(BoardError::Held { silent_s }) => {
            format!("the board held the path, since this program was silent for {silent_s} s")
        }
        Some(BoardError::HaltedByOther(Halt::Hold)) => "another program has held the path".to_owned(),
        _ => return Err(error),
    };
    client.command(&Request::Stop)?;
    anyhow::bail!("{why}; the rest of the path is discarded, and no log is written")
}

/// A block that the board refuses is an error of the motion file.
fn refused(error: BoardError, motion_file: &str) -> anyhow::Error {
    refused_at(error, motion_file, |block| format!("block[{block}]"))
}

fn refused_at(error: BoardError, motion_file: &str, key: impl Fn(u16) -> String) -> anyhow::Error {
    match &error {
        // Not a fault of the file.
        BoardError::Refused(Refusal::Path { error: PathError::NotHomed { .. }, .. }) => error.into(),
        BoardError::Refused(Refusal::Path { block, .. } | Refusal::TooFast { block, .. }) => {
            InputError::new(motion_file, error.to_string()).at_key(&key(*block)).into()
        }
        _ => error.into(),
    }
}

/// A table of following error and force.
fn summary(samples: &[PerAxis<AxisSample>]) -> String {
    let mut lines = vec![
        format!("{:<6}{:>28}{:>24}", "axis", "following error µm", "force N"),
        format!("{:<6}{:>14}{:>14}{:>12}{:>12}", "", "rms", "greatest", "rms", "greatest"),
    ];
    let axes = samples.first().map_or(0, |sample| sample.len());
    for (axis, name) in AXIS_NAMES.iter().enumerate().take(axes) {
        let of = |value: fn(&AxisSample) -> f64| {
            let squares: f64 = samples.iter().map(|sample| value(&sample[axis]).powi(2)).sum();
            let greatest = samples.iter().map(|sample| value(&sample[axis]).abs()).fold(0.0, f64::max);
            ((squares / samples.len().max(1) as f64).sqrt(), greatest)
        };
        let error = of(|sample| 1e6 * (sample.command_m - sample.motor_m));
        let force = of(|sample| sample.force_n);
        let [rms_um, greatest_um] = [error.0, error.1].map(|um| significant(um, 3));
        lines.push(format!("{name:<6}{rms_um:>14}{greatest_um:>14}{:>12.1}{:>12.1}", force.0, force.1));
    }
    lines.join("\n")
}
