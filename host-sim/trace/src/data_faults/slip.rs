//! Slips: the reading jumps from one sample to the next and stays displaced.

use std::ops::Range;

use super::bridge::bridge;
use super::channels::{self, references};
use super::fault::FaultKind;
use super::findings::{ChannelLocation, Findings};
use super::jumps::{self, Jump, Relative};
use super::spike::{self, Spike};
use super::step::best_step;
use super::turns::Turns;
use crate::options::FaultOptions;
use files::log::Channel;

/// Smallest ratio of the lasting to the momentary displacement at a slip, and largest deviation of it from 1.
const MAX_DEVIATION: f64 = 0.35;
/// Smallest change of acceleration at which a jump of the tool is no fault, mm/s². A tool that jumps by 5 µm at a smaller one
/// would bend by more than 25 µm per m/s².
const MIN_ACCELERATION_MM_PER_S2: f64 = 200.0;
/// Largest ratio of the lasting to the momentary displacement at a spike.
const MAX_REMAINDER: f64 = 0.3;

/// Whether another channel of the axis jumps as well, so that the machine moved or the log lacks a sample.
fn is_shared(place: &ChannelLocation<'_>, jump: &Jump) -> bool {
    let jumps = |other: &[f64]| {
        (jump.sample - 1..=jump.sample + 1)
            .any(|sample| jumps::own(other, sample) / jump.size > MAX_REMAINDER)
    };
    references(place.axis(), place.channel).any(|(_, other)| jumps(other))
}

/// Whether a jump of the tool is at an instant at which the acceleration of an axis jumps: structures bend under
/// acceleration, and the tool with them, in one sample if the acceleration changes in one.
fn follows_acceleration(place: &ChannelLocation<'_>, sample: usize) -> bool {
    place.channel == Channel::Tool
        && place.log.axes.iter().any(|axis| {
            let motion = axis.command.as_ref().or(axis.motor.as_ref()).or(axis.table.as_ref());
            motion.is_some_and(|values| {
                acceleration_change(values, sample, place.log.sample_time_s).abs()
                    > MIN_ACCELERATION_MM_PER_S2
            })
        })
}

/// Change of the acceleration (mm/s²) of a reading (mm) at a sample: the difference between the parabolas through the first,
/// middle and last of eleven samples on each side.
fn acceleration_change(values: &[f64], sample: usize, sample_s: f64) -> f64 {
    const HALF: usize = 5;
    let second = |middle: usize| match values.get(middle - HALF..=middle + HALF) {
        Some(window) => {
            (window[2 * HALF] - 2.0 * window[HALF] + window[0]) / (HALF as f64 * sample_s).powi(2)
        }
        None => 0.0,
    };
    // A sample of the log may be one off the jump of its command.
    let aside = HALF + 2;
    if sample < aside + HALF { 0.0 } else { second(sample + aside) - second(sample - aside) }
}

/// Displaced readings of a channel.
#[derive(Clone, Debug, Default)]
struct Displaced {
    spikes: Vec<Spike>,
    /// Samples at each slip whose readings are not used, and the size of the slip.
    slips: Vec<(Range<usize>, f64)>,
}

/// Finds the slips and spikes of a channel of `place`, and removes them from `values`, its samples. Without another position
/// channel a slip cannot be distinguished from a motion; a command does not slip.
fn remove(values: &mut [f64], place: &ChannelLocation<'_>, options: &FaultOptions) -> Displaced {
    let reference = channels::reference(place.axis(), place.channel);
    let smallest = jumps::smallest(values, reference, options);
    let jumps: Vec<Jump> = jumps::jumps(Relative { values, reference }, smallest, options);
    let groups = jumps::groups(&jumps);
    // Clearances between table and tool turn over in every reversal.
    let may_turn = place.channel == Channel::Tool && !groups.is_empty();
    let turns = may_turn.then(|| Turns::of(place.log));
    let mut displaced = Displaced::default();
    for (number, group) in groups.iter().enumerate() {
        let (Some(first), Some(last)) = (group.first(), group.last()) else { continue };
        let across = first.sample..last.sample;
        let start =
            number.checked_sub(1).and_then(|before| groups[before].last()).map_or(0, |jump| jump.sample);
        let end = groups.get(number + 1).map_or(values.len(), |next| next[0].sample);
        if !(Relative { values, reference }).is_steady_around(group, smallest) {
            continue;
        }
        let Some(step) = best_step(values, place, &across, &(start..end)) else { continue };
        let largest = numerics::max_abs(group.iter().map(|jump| jump.size));
        let is_of_machine = |jump: &Jump| {
            is_shared(place, jump)
                || follows_acceleration(place, jump.sample)
                || turns.as_ref().is_some_and(|turns| turns.are_at(jump.sample))
        };
        if group.iter().any(is_of_machine) {
            continue;
        }
        let is_significant = largest > options.min_jump_context * step.scatter;
        if group.len() > 1 && step.size.abs() < MAX_REMAINDER * largest && is_significant {
            displaced.spikes.push(spike::remove(values, reference, &across));
            continue;
        }
        let sum: f64 = group.iter().map(|jump| jump.size).sum();
        let is_lasting = (step.size / sum - 1.0).abs() < MAX_DEVIATION && step.size.abs() >= smallest;
        if is_lasting && is_significant && reference.is_some() && place.channel != Channel::Command {
            values[across.end..].iter_mut().for_each(|value| *value -= step.size);
            bridge(values, reference, &across);
            displaced.slips.push((across, step.size));
        }
    }
    displaced
}

/// Finds, reports and removes slips and spikes of a channel.
pub fn correct(
    values: &mut [f64],
    place: &ChannelLocation<'_>,
    margin: usize,
    options: &FaultOptions,
    findings: &mut Findings,
) {
    let displaced = remove(values, place, options);
    for (samples, size) in &displaced.slips {
        findings.faults.push(place.fault_at(FaultKind::Slip, samples.end, 1e3 * size));
        findings.exclude(place, samples, margin);
    }
    findings.faults.extend(spike::fault(place, &displaced.spikes));
    for spike in &displaced.spikes {
        // A reading or two that are interpolated do not disturb the filter.
        findings.exclude(place, &spike.samples, if spike.samples.len() > 2 { margin } else { 0 });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::{AxisLog, Log, Unit};

    /// Noise with standard deviation 1, reproducible.
    fn noise(count: usize, seed: u32) -> impl Iterator<Item = f64> {
        let mut state = seed;
        let mut uniform = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24) - 0.5
        };
        // The sum of three uniform deviates of variance 1/12 has variance 1/4.
        (0..count).map(move |_| 2.0 * (uniform() + uniform() + uniform()))
    }

    /// 6 s on a circle of 20 mm at 60 mm/s: a motor, a table with 10 µm of backlash, both with 0.05 µm of noise, and a probe
    /// that drifts by 20 µm.
    fn log() -> Log {
        let count = 6000;
        let motor: Vec<f64> = (0..count).map(|i| 20.0 * (3e-3 * f64::from(i)).sin()).collect();
        let mut at = 0.0;
        let table: Vec<f64> = motor
            .iter()
            .map(|mm| {
                at = f64::clamp(at, mm - 0.005, mm + 0.005);
                at
            })
            .collect();
        let drift = |i: usize| 0.02 * (1.0 - (-(i as f64) / 2000.0).exp());
        let tool = table.iter().enumerate().map(|(i, mm)| mm + drift(i)).collect();
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        for (channel, values, seed) in
            [(Channel::Motor, motor, 1), (Channel::Table, table, 2), (Channel::Tool, tool, 3)]
        {
            let noisy = values.iter().zip(noise(values.len(), seed)).map(|(mm, noise)| mm + 5e-5 * noise);
            *axis.channel_mut(channel) = Some(noisy.collect());
        }
        Log::new("l", 100.0, 1e-3, [axis])
    }

    fn corrected(log: &Log, channel: Channel) -> (Findings, Vec<f64>) {
        let place = ChannelLocation { log, axis: 0, channel };
        let mut values = log.axes[0].channel(channel).unwrap().to_vec();
        let mut findings = Findings::default();
        correct(&mut values, &place, 6, &FaultOptions::default(), &mut findings);
        (findings, values)
    }

    #[test]
    fn a_sound_log_has_neither_slips_nor_spikes() {
        for channel in channels::SENSORS {
            assert!(corrected(&log(), channel).0.faults.is_empty(), "{channel:?}");
        }
    }

    /// A slip at full speed, one at 50 ms before a reversal (at 524 ms), and two in one log.
    #[test]
    fn slips_are_found_with_time_and_size_and_removed() {
        for channel in channels::SENSORS {
            for slips in [&[(1000, 5.0)][..], &[(474, -8.0)], &[(700, 10_000.0), (3000, -60.0)]] {
                let whole = log();
                let mut broken = whole.clone();
                let values = broken.axes[0].channel_mut(channel).as_mut().unwrap();
                for &(sample, um) in slips {
                    values[sample..].iter_mut().for_each(|mm| *mm += 1e-3 * um);
                }
                let (findings, mended) = corrected(&broken, channel);
                let found: Vec<(FaultKind, f64)> =
                    findings.faults.iter().map(|fault| (fault.kind, fault.at_s.unwrap())).collect();
                let expected: Vec<(FaultKind, f64)> = slips
                    .iter()
                    .map(|(sample, _)| (FaultKind::Slip, 100.0 + 1e-3 * *sample as f64))
                    .collect();
                assert!(found.len() == expected.len(), "{channel:?} {slips:?}: {:?}", findings.faults);
                assert!(found.iter().zip(&expected).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-9));
                // Lines through 8 samples of √2·0.05 µm have a standard error of 0.07 µm at a step; four of them.
                let sound = whole.axes[0].channel(channel).unwrap();
                let worst = numerics::max_abs(mended.iter().zip(sound).map(|(a, b)| a - b));
                assert!(worst < 0.3e-3 * slips.len() as f64, "{channel:?} {slips:?}: {worst}");
            }
        }
    }

    #[test]
    fn the_drift_of_a_probe_is_not_a_slip_and_remains_beside_one() {
        let mut broken = log();
        broken.axes[0].tool.as_mut().unwrap()[3500..].iter_mut().for_each(|mm| *mm -= 0.012);
        let (findings, mended) = corrected(&broken, Channel::Tool);
        assert_eq!(findings.faults.len(), 1);
        let table = broken.axes[0].table.as_ref().unwrap();
        let drift_um = |samples: Range<usize>| 1e3 * numerics::mean(samples.map(|i| mended[i] - table[i]));
        // 20·(1 − e^(−2.95)) − 20·(1 − e^(−0.05)) = 17.98 µm between 0.1 s and 5.9 s, to within the error of the slip.
        let drift = drift_um(5800..6000) - drift_um(0..200);
        assert!((drift - 17.98).abs() < 0.3, "{drift}");
    }

    #[test]
    fn spikes_are_found_with_number_and_size_and_interpolated() {
        for channel in channels::SENSORS {
            let whole = log();
            let mut broken = whole.clone();
            let values = broken.axes[0].channel_mut(channel).as_mut().unwrap();
            for (sample, mm) in [(800, 0.02), (801, 0.02), (2000, -1.0), (2003, 1.0), (4100, 0.05)] {
                values[sample] += mm;
            }
            let (findings, mended) = corrected(&broken, channel);
            let [fault] = &findings.faults[..] else { panic!("{channel:?} {:?}", findings.faults) };
            // Those at 2000 and 2003 are one.
            assert_eq!((fault.kind, fault.count), (FaultKind::Spike, 3));
            assert!((fault.at_s.unwrap() - 100.8).abs() < 1e-9);
            assert!((fault.size.unwrap().abs() - 1000.0).abs() < 0.5, "{fault:?}");
            let sound = whole.axes[0].channel(channel).unwrap();
            let worst = numerics::max_abs(mended.iter().zip(sound).map(|(a, b)| a - b));
            // The readings of two sensors with 0.05 µm of noise replace one another.
            assert!(worst < 0.5e-3, "{channel:?} {worst}");
        }
    }

    /// The motor at the impact of a table after a backlash, and the ringing of a probe: the displacements per sample, µm, of
    /// simulated machines.
    #[test]
    fn an_impact_is_no_slip() {
        for (channel, changes_um) in [
            (Channel::Motor, [2.4, 3.8, 5.2, 2.2, -2.1, 0.2]),
            (Channel::Tool, [0.7, 9.3, -3.3, -3.9, 2.4, -0.3]),
        ] {
            let mut hit = log();
            let values = hit.axes[0].channel_mut(channel).as_mut().unwrap();
            for (number, um) in changes_um.into_iter().enumerate() {
                values[3000 + number..].iter_mut().for_each(|mm| *mm += 1e-3 * um);
            }
            assert!(corrected(&hit, channel).0.faults.is_empty(), "{channel:?}");
        }
    }

    /// The command starts with 1 m/s² at sample 1000, where the tool jumps by 8 µm: it bends. With 0.1 m/s² it slips.
    #[test]
    fn a_tool_that_jumps_with_the_acceleration_does_not_slip() {
        for (acceleration, faults) in [(1.0, 0), (0.1, 1)] {
            let mut bent = log();
            let since = |i: usize| i.saturating_sub(1000) as f64 * 1e-3;
            let command = |i: usize| 500.0 * acceleration * since(i) * since(i);
            let mut other = AxisLog::new("y", Unit::Millimetre);
            other.command = Some((0..6000).map(command).collect());
            bent.axes.push(other);
            bent.axes[0].tool.as_mut().unwrap()[1001..].iter_mut().for_each(|mm| *mm += 0.008);
            assert_eq!(corrected(&bent, Channel::Tool).0.faults.len(), faults, "{acceleration}");
        }
    }

    /// At the reversal of the circle at 524 ms the tool turns over by 8 µm; 200 ms later it slips.
    #[test]
    fn a_tool_that_jumps_at_a_reversal_does_not_slip() {
        for (sample, faults) in [(524, 0), (724, 1)] {
            let mut turned = log();
            turned.axes[0].tool.as_mut().unwrap()[sample..].iter_mut().for_each(|mm| *mm -= 0.008);
            assert_eq!(corrected(&turned, Channel::Tool).0.faults.len(), faults, "{sample}");
        }
    }

    /// All channels jump: the axis was moved, or samples are lacking.
    #[test]
    fn a_jump_of_all_channels_is_no_slip() {
        let mut moved = log();
        for channel in channels::SENSORS {
            let values = moved.axes[0].channel_mut(channel).as_mut().unwrap();
            values[2000..].iter_mut().for_each(|mm| *mm += 0.5);
        }
        for channel in channels::SENSORS {
            assert!(corrected(&moved, channel).0.faults.is_empty(), "{channel:?}");
        }
    }
}
