//! `lost-motion board monitor`: a line about the board at intervals.

use std::thread;
use std::time::{Duration, Instant};

use anyhow::Result;

use super::port::PortArguments;
use super::status::{path, power};
use crate::cli::outputs::print_to_reader;
use crate::cli::stop;
use ::board::refusal::{self, AXIS_NAMES};
use ::board::{BoardError, Client, Observer};
use files::error::InputError;
use shared::drive::TickCounts;
use shared::link::{Status, Welcome};
use shared::units::Position;

/// Longest interval, s: a host that is silent for longer stops the drives.
const MAX_INTERVAL_S: f64 = 60.0;

/// Arguments of `board monitor`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    port: PortArguments,
    /// Time between two lines.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, default_value_t = 0.5)]
    interval_s: f64,
    /// Number of lines; without it until an interrupt.
    #[arg(long)]
    lines: Option<u32>,
}

/// A board that is watched. As the host at a free port, a monitor keeps the drives on; while another program holds the port, that program
/// does.
enum Watched {
    Host(Client),
    Guest(Observer),
}

impl Watched {
    fn open(port: &PortArguments) -> Result<(Self, Welcome)> {
        let error = match port.connect() {
            Ok(client) => {
                let welcome = client.welcome().clone();
                return Ok((Self::Host(client), welcome));
            }
            Err(error) => error,
        };
        if !matches!(error.downcast_ref(), Some(BoardError::InUse { .. })) {
            return Err(error);
        }
        let mut observer = port.observe()?;
        let welcome = port.identify(&mut observer)?;
        Ok((Self::Guest(observer), welcome))
    }

    /// The state, or what another program has done meanwhile, in words.
    fn look(&mut self) -> Result<Result<Status, &'static str>, BoardError> {
        let status = match self {
            Self::Host(client) => client.status(),
            Self::Guest(observer) => observer.status(),
        };
        match status {
            Err(BoardError::HaltedByOther(halt)) => Ok(Err(refusal::halted_by_other(halt))),
            status => status.map(Ok),
        }
    }
}

/// Runs the command.
///
/// # Errors
/// Invalid arguments, a board that cannot be reached.
pub fn run(arguments: &Arguments) -> Result<()> {
    if !(0.0..=MAX_INTERVAL_S).contains(&arguments.interval_s) {
        let expected = format!("seconds from 0 to {MAX_INTERVAL_S}");
        return Err(InputError::expected("--interval-s", expected, arguments.interval_s).into());
    }
    let interval = Duration::from_secs_f64(arguments.interval_s);
    let (mut watched, welcome) = Watched::open(&arguments.port)?;
    stop::write_partial_result();
    let mut left = arguments.lines;
    while left != Some(0) && !stop::is_interrupted() {
        let started = Instant::now();
        let line = match watched.look()? {
            Ok(status) => line(&status, welcome.rates.velocity_loop_hz),
            Err(halted) => halted.to_owned(),
        };
        if !print_to_reader(&line)? {
            // Further requests would keep the drives on.
            break;
        }
        left = left.map(|lines| lines - 1);
        if left != Some(0) {
            thread::sleep(interval.saturating_sub(started.elapsed()));
        }
    }
    Ok(())
}

fn line(status: &Status, tick_hz: f64) -> String {
    let axes = AXIS_NAMES.iter().zip(&status.axes).map(|(name, axis)| {
        let [command, motor] = [axis.command, axis.motor].map(|position| 1e3 * position.to_m());
        let error_um = 1e3 * (command - motor);
        let rms = axis.rms.map_or_else(String::new, |rms| {
            format!(" (rms of a second: {:.2} µm, {:.1} N)", f64::from(rms.error_nm) / 1e3, rms.force_n)
        });
        let skew = axis.gantry.map_or_else(String::new, |gantry| {
            format!(", skew {:.1} µm", 1e6 * Position(gantry.skew).to_m())
        });
        format!("{name} {motor:.4} mm, error {error_um:.2} µm{skew}, {:.1} N{rms}", axis.force_n)
    });
    let axes: Vec<String> = axes.collect();
    let TickCounts { late, missed, .. } = status.ticks;
    let ticks = if late == 0 && missed == 0 {
        String::new()
    } else {
        format!("; {late} ticks late, {missed} missed")
    };
    format!(
        "{:.3} s: drives {}; {}; {}{ticks}",
        status.tick as f64 / tick_hz,
        power(status),
        path(status),
        axes.join("; ")
    )
}
