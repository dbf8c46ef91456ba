//! Hum: the reading of a scale contains an oscillation of constant frequency, amplitude and phase, from the mains for example.
//!
//! If the table oscillated, the tool on it would oscillate as well. A hum of the scale is in the differences of table and motor
//! and of table and tool alike, and not in that of tool and motor. A scale of which only the motor or only the tool is logged
//! beside it does not show which of both oscillates. At the frequency of such a hum the force is examined, too: what does not
//! accelerate the motor is a hum of the reading.

use std::borrow::Cow;
use std::ops::Range;

use super::fault::{DataFault, FaultHandling, FaultKind};
use super::findings::{ChannelLocation, Findings};
use super::steady_line::{BESIDE_HZ, Line, Signal, is_steady, lines, refined_hz};
use files::log::{AxisLog, Channel, Log};

/// Largest number of lines that are examined, the greatest first.
const MAX_LINES: usize = 10;
/// Largest number of hums of one scale.
const MAX_HUMS: usize = 4;
/// Largest number of samples of a piece: a minute at 1 kHz.
const MAX_SAMPLES: usize = 65_536;
/// Half the distance of two samples between which the motor's velocity is taken.
const SPAN: usize = 3;

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The greatest hum of the scale of an axis over a range of samples, at a frequency at which there may be one.
fn of_scale(
    axis: &AxisLog,
    range: &Range<usize>,
    sample_s: f64,
    may_be: &impl Fn(f64) -> bool,
) -> Option<Line> {
    let of = |channel| axis.channel(channel).map(|values| &values[range.clone()]);
    let (motor, table, tool) = (of(Channel::Motor)?, of(Channel::Table)?, of(Channel::Tool)?);
    let [to_motor, to_tool] = [motor, tool].map(|other| difference(table, other));
    let [to_motor, to_tool] = [&to_motor, &to_tool].map(|values| Signal::whole(values, sample_s));
    let hum = |about_hz: f64| {
        let frequency_hz = refined_hz(&to_tool, about_hz);
        let whole = Line { frequency_hz, parts: to_tool.parts(frequency_hz)? };
        let is_both = whole.agrees(to_motor.parts(frequency_hz)?);
        (may_be(frequency_hz) && is_both && is_steady(&to_tool, &whole)).then_some(whole)
    };
    lines(&to_tool).into_iter().take(MAX_LINES).find_map(hum)
}

/// Velocity, direction and acceleration of the motor, with which friction and inertia change the force.
fn motion(motor: &[f64]) -> Vec<Vec<f64>> {
    let at = |i: usize| motor[i.min(motor.len() - 1)];
    let velocity = |i: usize| at(i + SPAN) - at(i.saturating_sub(SPAN));
    let acceleration = |i: usize| at(i + SPAN) - 2.0 * at(i) + at(i.saturating_sub(SPAN));
    let of = |term: &dyn Fn(usize) -> f64| (0..motor.len()).map(term).collect::<Vec<f64>>();
    vec![of(&velocity), of(&|i| velocity(i).signum()), of(&acceleration)]
}

/// The hum of the force of an axis at a frequency over a range of samples.
fn of_force(axis: &AxisLog, range: &Range<usize>, frequency_hz: f64, sample_s: f64) -> Option<Line> {
    let of = |channel| axis.channel(channel).map(|values| &values[range.clone()]);
    let (motor, force) = (of(Channel::Motor)?, of(Channel::Force)?);
    let terms = motion(motor);
    let force = Signal { terms: terms.iter().map(Vec::as_slice).collect(), ..Signal::whole(force, sample_s) };
    let whole = Line { frequency_hz, parts: force.parts(frequency_hz)? };
    is_steady(&force, &whole).then_some(whole)
}

/// Finds the hums of the scales of all logs, reports them, and subtracts them. A hum is in all logs: a line that only one of several
/// shows follows from its motion, as a periodic error at constant speed does.
pub fn correct_all(logs: &mut [Vec<Cow<'_, Log>>; 2]) -> Vec<DataFault> {
    let lines_of = |log: &Cow<'_, Log>| {
        let mut findings = Findings::default();
        correct(&mut log.clone(), &|_| true, &mut findings);
        findings.faults.iter().filter_map(|fault| fault.frequency_hz).collect::<Vec<f64>>()
    };
    let found: Vec<Vec<f64>> = logs.iter().flatten().map(lines_of).collect();
    let is_near = |about_hz: f64| move |hz: &f64| (hz - about_hz).abs() < BESIDE_HZ[0];
    let is_common =
        |hz: f64| 2 * found.iter().filter(|lines| lines.iter().any(is_near(hz))).count() > found.len();
    let mut findings = Findings::default();
    for log in logs.iter_mut().flatten() {
        correct(log, &is_common, &mut findings);
    }
    findings.faults
}

/// Finds the hums of the scales of a log, reports them, and subtracts them; those of the force at the same frequencies as well.
/// The frequency of the mains changes slowly: long logs are examined in pieces.
fn correct(log: &mut Cow<'_, Log>, may_be: &impl Fn(f64) -> bool, findings: &mut Findings) {
    let pieces = log.len().div_ceil(MAX_SAMPLES);
    for axis in 0..log.axes.len() {
        let mut hums: Vec<(Channel, Line)> = Vec::new();
        for piece in 0..pieces {
            let range = piece * log.len() / pieces..(piece + 1) * log.len() / pieces;
            for _ in 0..MAX_HUMS {
                let sample_s = log.sample_time_s;
                let Some(hum) = of_scale(&log.axes[axis], &range, sample_s, may_be) else { break };
                let of_force = of_force(&log.axes[axis], &range, hum.frequency_hz, sample_s);
                let both = [Some((Channel::Table, hum)), of_force.map(|hum| (Channel::Force, hum))];
                for (channel, hum) in both.into_iter().flatten() {
                    if let Some(values) = log.to_mut().axes[axis].channel_mut(channel).as_mut() {
                        hum.subtract_from(&mut values[range.clone()], sample_s);
                    }
                    remember(&mut hums, channel, hum);
                }
            }
        }
        let fault = |(channel, hum): (Channel, Line)| {
            // Amplitudes of positions are in µm.
            let size = if channel == Channel::Force { 1.0 } else { 1e3 } * hum.amplitude();
            let fault = ChannelLocation { log, axis, channel }.fault(
                FaultKind::Hum,
                Some(size),
                FaultHandling::Corrected,
            );
            DataFault { frequency_hz: Some(hum.frequency_hz), ..fault }
        };
        findings.faults.extend(hums.into_iter().map(fault));
    }
}

/// Adds a hum to those of other pieces; of one frequency the greatest remains.
fn remember(hums: &mut Vec<(Channel, Line)>, channel: Channel, hum: Line) {
    let is_same = |(other, line): &&mut (Channel, Line)| {
        *other == channel && (line.frequency_hz - hum.frequency_hz).abs() < BESIDE_HZ[0]
    };
    match hums.iter_mut().find(is_same) {
        Some((_, known)) if known.amplitude() < hum.amplitude() => *known = hum,
        Some(_) => {}
        None => hums.push((channel, hum)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::Unit;

    const SAMPLES: u32 = 8000;

    /// White noise with a standard deviation of 1/√12: bits of a product of large odd numbers.
    fn noise(channel: u32, i: u32) -> f64 {
        let mut bits =
            (u64::from(channel) << 32 | u64::from(i)).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        f64::from(u32::try_from(bits >> 32).unwrap()) / f64::from(u32::MAX) - 0.5
    }

    /// 8 s of motor, table and tool with 0.02 µm of noise, in which a wind-up of 2 µm and an in-talk of 1 µm follow a motion that
    /// starts and stops, and a force of 200 kg with 1 N of noise.
    fn log(add: impl Fn(Channel, f64) -> f64) -> Log {
        let at = |i: u32| 30.0 * (1.5 * 1e-3 * f64::from(i)).sin().powi(3);
        let acceleration = |i: u32| 1e3 * (at(i + 1) - 2.0 * at(i) + at(i.saturating_sub(1)));
        let values = |number: u32, channel: Channel, value: &dyn Fn(u32) -> f64, scatter: f64| {
            let one = |i| value(i) + scatter * noise(number, i) + add(channel, 1e-3 * f64::from(i));
            (0..SAMPLES).map(one).collect::<Vec<f64>>()
        };
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        axis.motor = Some(values(1, Channel::Motor, &at, 7e-5));
        axis.table = Some(values(2, Channel::Table, &|i| at(i) - 0.01 * acceleration(i), 7e-5));
        axis.tool = Some(values(3, Channel::Tool, &|i| at(i) - 0.015 * acceleration(i), 7e-5));
        axis.force = Some(values(
            4,
            Channel::Force,
            &|i| 200.0 * acceleration(i) + 50.0 * (at(i + 1) - at(i)).signum(),
            3.5,
        ));
        Log::new("l", 5.0, 1e-3, [axis])
    }

    fn corrected(log: &Log) -> (Cow<'_, Log>, Vec<DataFault>) {
        let (mut log, mut findings) = (Cow::Borrowed(log), Findings::default());
        correct(&mut log, &|_| true, &mut findings);
        (log, findings.faults)
    }

    fn sine(amplitude: f64, hz: f64, time_s: f64) -> f64 {
        amplitude * (std::f64::consts::TAU * hz * time_s + 0.7).sin()
    }

    /// The white noise of 0.02 µm over 8000 samples shifts an amplitude by 0.02·√(2·1.5/8000) = 0.0004 µm, the frequency by less than
    /// a hundredth of 1/8 Hz.
    #[test]
    fn a_hum_of_the_scale_is_named_and_subtracted() {
        let hum = |channel, t| match channel {
            Channel::Table => sine(6e-5, 50.02, t),
            Channel::Force => sine(6.0, 50.02, t),
            _ => 0.0,
        };
        let [sound, broken] = [log(|_, _| 0.0), log(hum)];
        let (log, faults) = corrected(&broken);
        let [table, force] = &faults[..] else { panic!("{faults:?}") };
        assert_eq!((table.channel, force.channel), (Some(Channel::Table), Some(Channel::Force)));
        assert!((table.size.unwrap() - 0.06).abs() < 0.002, "{table:?}");
        assert!((table.frequency_hz.unwrap() - 50.02).abs() < 0.005, "{table:?}");
        // 1 N: √(3/8000) = 0.02 N, and what friction has at 50 Hz, which jumps six times.
        assert!((force.size.unwrap() - 6.0).abs() < 0.5, "{force:?}");
        let left = |channel| {
            let [a, b] = [log.as_ref(), &sound].map(|log| log.axes[0].channel(channel).unwrap());
            numerics::rms(difference(a, b))
        };
        assert!(left(Channel::Table) < 0.002e-3 && left(Channel::Force) < 0.5, "{}", left(Channel::Force));
    }

    /// An oscillation of the tool, of the table with the tool, and of the motor; one of the scale that decays.
    #[test]
    fn a_vibration_is_no_hum() {
        assert_eq!(corrected(&log(|_, _| 0.0)).1, []);
        let moving = |channels: &'static [Channel]| {
            log(move |channel, t| if channels.contains(&channel) { sine(6e-5, 50.0, t) } else { 0.0 })
        };
        for channels in [&[Channel::Tool][..], &[Channel::Table, Channel::Tool], &[Channel::Motor]] {
            assert_eq!(corrected(&moving(channels)).1, [], "{channels:?}");
        }
        let decaying =
            log(|channel, t| if channel == Channel::Table { sine(6e-5, 50.0, t) * (-t).exp() } else { 0.0 });
        assert_eq!(corrected(&decaying).1, []);
    }
}
