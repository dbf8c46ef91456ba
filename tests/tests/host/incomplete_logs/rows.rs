//! Logs that lost rows, and encoders of 1 µm.

use files::log::{Channel, Log};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use trace::data_faults::FaultKind;
use trace::trace;

use super::case::Case;

/// Resolution of the encoders, mm.
const RESOLUTION_MM: f64 = 1e-3;

/// Reads motor, table and tool in steps of 1 µm, and replaces these channels by those of the row before in 1 % of the rows.
fn damage(log: &mut Log, channels: &[Channel], random: &mut ChaCha8Rng) {
    for axis in &mut log.axes {
        for channel in [Channel::Motor, Channel::Table, Channel::Tool] {
            let readings = axis.channel_mut(channel).iter_mut().flatten();
            readings.for_each(|mm| *mm = (*mm / RESOLUTION_MM).round() * RESOLUTION_MM);
        }
    }
    for row in 1..log.len() {
        if random.random_bool(0.01) {
            for axis in &mut log.axes {
                for &channel in channels {
                    if let Some(values) = axis.channel_mut(channel) {
                        values[row] = values[row - 1];
                    }
                }
            }
        }
    }
}

/// The log as a logger of N times its rate would write it: values between the samples lie on straight lines.
fn at_times_the_rate(log: &Log, times: u32) -> Log {
    let between = |values: &[f64]| -> Vec<f64> {
        let pairs = values.windows(2).flat_map(|pair| {
            let &[from, to] = pair else { unreachable!("windows of two") };
            (0..times).map(move |step| from + (to - from) * f64::from(step) / f64::from(times))
        });
        pairs.chain(values.last().copied()).collect()
    };
    let mut fast = log.clone();
    fast.sample_time_s /= f64::from(times);
    for axis in &mut fast.axes {
        for channel in Channel::ALL {
            if let Some(values) = axis.channel_mut(channel) {
                *values = between(values);
            }
        }
    }
    fast
}

/// Cases with effects that an encoder of 1 µm shows. Once none of them was found beside lost rows: of all channels, of those that
/// are measured while the command of the control goes on, or in a log at four times the rate of the machine.
#[test]
fn effects_are_found_beside_lost_rows() {
    const MEASURED: [Channel; 4] = [Channel::Motor, Channel::Table, Channel::Tool, Channel::Force];
    for (name, channels, times) in
        [("case-2", &Channel::ALL[..], 1), ("case-6", &MEASURED[..], 1), ("case-2", &MEASURED[..], 4)]
    {
        let Some(mut case) = Case::blind_named(name) else { return };
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for log in case.logs.iter_mut().flatten() {
            *log = at_times_the_rate(log, times);
            damage(log, channels, &mut random);
        }
        let [fit, validate] = &case.logs;
        let trace = trace(&case.machine(), fit, validate, &|_| {}).unwrap();
        let found = trace.axes().iter().flat_map(|axis| {
            axis.found.iter().map(|found| (axis.axis.clone(), found.effect.name().to_owned()))
        });
        let found: std::collections::BTreeSet<_> = found.collect();
        assert!(case.truth.is_subset(&found), "{name}: {found:?}");
        for (axis, log) in
            trace.axes().iter().flat_map(|axis| fit.iter().chain(validate).map(move |log| (axis, log)))
        {
            let lost: usize = axis
                .data_faults
                .iter()
                .filter(|fault| {
                    fault.log == log.source && fault.kind == FaultKind::Stuck && fault.channel.is_none()
                })
                .map(|fault| fault.count)
                .sum();
            // 1 % of the rows within four standard deviations; two in a row are one gap.
            let expected = 0.01 * log.len() as f64;
            assert!(
                (lost as f64 - expected).abs() < 4.0 * expected.sqrt(),
                "{}: {lost} of {expected}",
                log.source
            );
        }
    }
}
