//! `lost-motion board status`: what a board is and does.

use anyhow::Result;

use super::port::PortArguments;
use crate::cli::outputs::print;
use ::board::refusal::{self, AXIS_NAMES};
use shared::drive::{NotArmed, TickCounts};
use shared::figures::SignalFigures;
use shared::interpolate::feed_hold::FeedState;
use shared::link::feed_override::FeedOverride;
use shared::link::report::{Activity, AxisStatus, DirectionReport, UsbState};
use shared::link::{Status, Welcome};
use shared::safety::Power;
use shared::units::Position;

/// Arguments of `board status`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    port: PortArguments,
}

/// Runs the command.
///
/// # Errors
/// A board that cannot be reached.
pub fn run(arguments: &Arguments) -> Result<()> {
    let mut observer = arguments.port.observe()?;
    let welcome = arguments.port.identify(&mut observer)?;
    let status = observer.status()?;
    let mut lines = describe(&welcome, &status);
    for entry in observer.history()? {
        let ago_s = status.tick.saturating_sub(entry.tick) as f64 / welcome.rates.velocity_loop_hz;
        lines.push(format!("{ago_s:>10.1} s ago: {}", refusal::event(entry.event)));
    }
    print(&lines.join("\n"))
}

/// The lines about a board, without its history.
fn describe(welcome: &Welcome, status: &Status) -> Vec<String> {
    let times = &welcome.times;
    let mut lines = vec![
        format!("{}, version {}", welcome.board, welcome.software),
        format!(
            "{}, {} ticks per second, a position command every {} ticks",
            refusal::axes(welcome.steps.axes.len()),
            welcome.rates.velocity_loop_hz,
            welcome.rates.position_loop_divider
        ),
        format!(
            "host silent: path held after {} s, drives off after {} s; a jog at a speed ends after {} s",
            f64::from(times.hold_ms) / 1e3,
            f64::from(times.off_ms) / 1e3,
            f64::from(times.jog_ms) / 1e3
        ),
        format!("drives: {}", power(status)),
        format!("path: {}", path(status)),
        format!("settings: {}", refusal::settings(&status.settings)),
    ];
    lines.push(ticks(status, welcome.rates.velocity_loop_hz));
    if let Some(warning) = status.warning {
        lines.push(format!("warning: {}", refusal::fault(warning)));
    }
    if let Some(mv) = status.supply.bus_mv {
        lines.push(format!("supply: {:.1} V", f64::from(mv) / 1e3));
    }
    if let Some(mc) = status.supply.temperature_mc {
        lines.push(format!("power stages: {:.0} °C", f64::from(mc) / 1e3));
    }
    lines.push(format!(
        "{:<6}{:>14}{:>14}{:>14}{:>10}  reference",
        "axis", "command mm", "motor mm", "scale mm", "force N"
    ));
    for (name, axis) in AXIS_NAMES.iter().zip(&status.axes) {
        let scale =
            axis.table.map_or_else(|| "no signal".to_owned(), |table| format!("{:.4}", 1e3 * table.to_m()));
        let reference = if axis.homed { "homed" } else { "not homed" };
        lines.push(format!(
            "{name:<6}{:>14.4}{:>14.4}{scale:>14}{:>10.1}  {reference}",
            1e3 * axis.command.to_m(),
            1e3 * axis.motor.to_m(),
            axis.force_n
        ));
    }
    lines.extend(AXIS_NAMES.iter().zip(&status.axes).filter_map(|(name, axis)| figures(name, axis)));
    lines.extend(AXIS_NAMES.iter().zip(&status.axes).filter_map(|(name, axis)| following(name, axis)));
    lines.extend(AXIS_NAMES.iter().zip(&status.axes).filter_map(|(name, axis)| gantry(name, axis)));
    lines.extend(direction(status.direction));
    lines.extend(usb(status.usb).map(str::to_owned));
    let link = &status.link;
    lines.push(format!(
        "link: {} packets; refused: {} too long, {} too short, {} wrong encoding, {} wrong checksum, {} other version",
        link.packets, link.too_long, link.too_short, link.encoding, link.checksum, link.version
    ));
    lines
}

/// What an axis that follows a counter does.
fn following(name: &str, axis: &AxisStatus) -> Option<String> {
    let lag_um = Position(axis.lag?).to_m() * 1e6;
    Some(format!("{name}: follows a counter, {:.1} µm behind it", lag_um.abs()))
}

/// The gantry of a second motor.
fn gantry(name: &str, axis: &AxisStatus) -> Option<String> {
    let gantry = axis.gantry?;
    let (first, skew_um) = (refusal::axis_name(gantry.first), Position(gantry.skew).to_m() * 1e6);
    Some(format!("{name}: second motor of a gantry with {first}, {skew_um:.1} µm from a square beam"))
}

/// What is known of the last second of an axis, and of the signals of its motor sensor.
fn figures(name: &str, axis: &AxisStatus) -> Option<String> {
    let rms = axis.rms.map(|rms| {
        format!("rms of a second: error {:.2} µm, force {:.1} N", f64::from(rms.error_nm) / 1e3, rms.force_n)
    });
    let signals = axis.signals.map(|signals| {
        let SignalFigures { amplitude_counts, level_db, phase_deg, health_percent } = signals;
        format!(
            "signals: {amplitude_counts:.0} counts, {level_db:+.2} dB from the middle of their limits; phase {:.2} of a period, health {health_percent:.0} %",
            phase_deg / 360.0
        )
    });
    let parts: Vec<String> = rms.into_iter().chain(signals).collect();
    (!parts.is_empty()).then(|| format!("{name}: {}", parts.join("; ")))
}

/// The late and missed ticks in words, with a delay of at least half a period: shorter ones are those of the requests of the host.
fn ticks(status: &Status, tick_hz: f64) -> String {
    let TickCounts { late, missed, longest_delay_permille } = status.ticks;
    let counts = format!("ticks with the stages on: {late} late, {missed} missed");
    if longest_delay_permille < 500 {
        return counts;
    }
    let delay_us = f64::from(longest_delay_permille) * 1e3 / tick_hz;
    format!("{counts}, started up to {delay_us:.1} µs after they were due")
}

/// The direction check in words.
fn direction(report: DirectionReport) -> Option<String> {
    match report {
        DirectionReport::None => None,
        DirectionReport::Running { axis } => Some(format!(
            "direction check of {}: waits until the enable switch is closed, after it was open",
            refusal::axis_name(axis)
        )),
        DirectionReport::Ended { axis, result } => {
            Some(format!("direction check of {}", refusal::direction(axis, result)))
        }
    }
}

/// The USB port in words.
const fn usb(state: UsbState) -> Option<&'static str> {
    match state {
        UsbState::None => None,
        UsbState::NotAnswering => Some("usb: its core did not answer at the start; it is not used"),
        UsbState::Detached => Some("usb: no host"),
        UsbState::Attached => Some("usb: connected to a host"),
    }
}

/// The power state in words.
pub fn power(status: &Status) -> String {
    match status.power {
        Power::Off => match status.not_armed {
            None => "off; the enable switch permits an enable".to_owned(),
            Some(NotArmed::Switch) => {
                "off; the enable switch has to be closed (if it is: opened and closed)".to_owned()
            }
            Some(NotArmed::EmergencyStop) => {
                "off; the emergency stop is pressed: release it, then open and close the enable switch"
                    .to_owned()
            }
        },
        Power::On => "on".to_owned(),
        Power::Enabling => "on; the axes are held until their brakes are open".to_owned(),
        Power::Disabling(None) => "on; the axes are held until their brakes are closed".to_owned(),
        Power::Stopping(fault) | Power::Disabling(Some(fault)) => {
            format!("on, stopping: {}", refusal::fault(fault))
        }
        Power::Faulted(fault) => format!("off by a fault: {}", refusal::fault(fault)),
    }
}

/// The feed override, if it is not 100 %.
fn feed_override(status: &Status) -> String {
    let FeedOverride { percent, most_percent } = status.feed_override;
    if status.activity == Activity::Idle || percent == 100 {
        String::new()
    } else if percent > most_percent {
        format!(" at {most_percent} % (override {percent} %, limited by speed or acceleration)")
    } else {
        format!(" at {percent} %")
    }
}

/// What the path does, in words.
pub fn path(status: &Status) -> String {
    let what = match status.activity {
        Activity::Idle => "at rest",
        Activity::Motion => "motion",
        Activity::Jog => "jog",
        Activity::Homing => "homing",
        Activity::Response => "frequency response",
        Activity::Probing => "probing",
        Activity::Following => "following a counter",
    };
    let what = &(what.to_owned() + &feed_override(status));
    match status.feed {
        FeedState::Running => what.to_owned(),
        FeedState::Holding => format!("{what}, being held"),
        FeedState::Held => format!("{what}, held"),
        FeedState::Resuming => format!("{what}, resuming"),
        FeedState::Discarding => format!("{what}, stopping"),
    }
}
