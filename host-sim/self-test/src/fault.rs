//! Faults of the logs of the kind `slip`: a scale that slips or sticks, a probe with the wrong sign.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::draw::one_of;
use super::machine::AXES;
use super::truth::Truth;
use files::log::{AxisLog, Log};

/// Names of the faults.
pub const NAMES: [&str; 3] = ["scale_slip", "scale_stuck", "probe_sign"];

/// Sizes of a slip, mm, and durations of a scale that is stuck, s: log-uniform.
const SLIP_MM: [f64; 2] = [5e-3, 1.0];
const STUCK_S: [f64; 2] = [0.05, 1.0];
/// Travel during which the scale is stuck, mm; a scale that is stuck at standstill has no fault.
const MIN_TRAVEL_MM: f64 = 0.1;
/// Part of a log in which a fault begins.
const BEGIN: [f64; 2] = [0.1, 0.85];

/// Draws a fault and puts it into the logs. The faulty channel is not one of the controller's: the control loops see the
/// true position.
pub fn draw(logs: &mut [Log], random: &mut ChaCha8Rng) -> Option<Truth> {
    let name = one_of(&NAMES, random);
    let index = random.random_range(0..AXES.len());
    let (parameters, reference) = if name == "probe_sign" {
        for log in &mut *logs {
            reverse_probe(&mut log.axes[index]);
        }
        (Vec::new(), ("channel", "tool"))
    } else {
        let number = random.random_range(0..logs.len());
        let log = &mut logs[number];
        let parameters =
            if name == "scale_slip" { slip(log, index, random)? } else { stick(log, index, random)? };
        (parameters, ("log", motion_name(&log.source)))
    };
    Some(Truth { name, axis: AXES[index], parameters, reference: Some(reference), phase_rad: 0.0 })
}

/// Name of a motion of a session.
fn motion_name(source: &str) -> &'static str {
    super::draw::MOTIONS.into_iter().find(|name| *name == source).unwrap_or_default()
}

/// The probe reads every position with the wrong sign.
fn reverse_probe(axis: &mut AxisLog) {
    for value in axis.tool.iter_mut().flatten() {
        // The sum turns −0 into 0, as the log is written without it.
        *value = -*value + 0.0;
    }
}

/// From an instant on, the scale reads a constant more.
fn slip(log: &mut Log, index: usize, random: &mut ChaCha8Rng) -> Option<Vec<(&'static str, f64)>> {
    let sign = if random.random_bool(0.5) { 1.0 } else { -1.0 };
    // Whole steps of the scale: 0.01 µm.
    let steps = (1e5 * sign * log_uniform(SLIP_MM, random)).round();
    let size_mm = steps / 1e5;
    let begin = begin(log, random);
    let table = log.axes[index].table.as_mut()?;
    for value in &mut table[begin..] {
        *value = super::sensors::rounded(*value + size_mm, 1e5);
    }
    Some(vec![("at_s", log.start_s + log.sample_time_s * begin as f64), ("size_um", steps / 100.0)])
}

/// For a while, the scale repeats its reading.
fn stick(log: &mut Log, index: usize, random: &mut ChaCha8Rng) -> Option<Vec<(&'static str, f64)>> {
    /// Draws until the axis moves; nearly every motion moves at nearly every instant.
    const MAX_DRAWS: usize = 1000;
    let duration_s = log_uniform(STUCK_S, random);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 1000 samples")]
    let samples = (duration_s / log.sample_time_s).round() as usize;
    for _ in 0..MAX_DRAWS {
        let begin = begin(log, random);
        let start_s = log.start_s + log.sample_time_s * begin as f64;
        let table = log.axes[index].table.as_mut()?;
        let Some(stuck) = table.get_mut(begin..begin + samples) else { continue };
        let travel_mm = stuck.iter().fold(0.0, |most: f64, value| most.max((value - stuck[0]).abs()));
        if travel_mm > MIN_TRAVEL_MM {
            let held = stuck[0];
            stuck.fill(held);
            return Some(vec![("at_s", start_s), ("duration_s", samples as f64 * log.sample_time_s)]);
        }
    }
    None
}

/// Sample at which a fault begins.
fn begin(log: &Log, random: &mut ChaCha8Rng) -> usize {
    let part = random.random_range(BEGIN[0]..BEGIN[1]);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the log")]
    let begin = (part * log.len() as f64) as usize;
    begin
}

fn log_uniform([low, high]: [f64; 2], random: &mut ChaCha8Rng) -> f64 {
    low * libm::pow(high / low, random.random_range(0.0..1.0))
}
