//! Logs that lost rows, and encoders of 1 µm.

use files::log::{Channel, Log};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use trace::data_faults::FaultKind;
use trace::trace;

use super::case::Case;

/// Resolution of the encoders, mm.
const RESOLUTION_MM: f64 = 1e-3;

/// Reads motor, table and tool in steps of 1 µm, and replaces 1 % of the rows by the row before.
fn damage(log: &mut Log, random: &mut ChaCha8Rng) {
    for axis in &mut log.axes {
        for channel in [Channel::Motor, Channel::Table, Channel::Tool] {
            let readings = axis.channel_mut(channel).iter_mut().flatten();
            readings.for_each(|mm| *mm = (*mm / RESOLUTION_MM).round() * RESOLUTION_MM);
        }
    }
    for row in 1..log.len() {
        if random.random_bool(0.01) {
            let channels =
                log.axes.iter_mut().flat_map(|axis| Channel::ALL.map(|channel| (axis.name.clone(), channel)));
            for (name, channel) in channels.collect::<Vec<_>>() {
                let axis = log.axes.iter_mut().find(|axis| axis.name == name);
                if let Some(values) = axis.and_then(|axis| axis.channel_mut(channel).as_mut()) {
                    values[row] = values[row - 1];
                }
            }
        }
    }
}

/// Cases with effects that an encoder of 1 µm shows. Once none of them was found beside lost rows.
#[test]
fn effects_are_found_beside_lost_rows() {
    for name in ["case-2", "case-6"] {
        let Some(mut case) = Case::blind_named(name) else { return };
        let mut random = ChaCha8Rng::seed_from_u64(1);
        case.logs.iter_mut().flatten().for_each(|log| damage(log, &mut random));
        let [fit, validate] = &case.logs;
        let trace = trace(&case.machine(), fit, validate, &|_| {}).unwrap();
        let found = trace.axes.iter().flat_map(|axis| {
            axis.found.iter().map(|found| (axis.axis.clone(), found.effect.name().to_owned()))
        });
        let found: std::collections::BTreeSet<_> = found.collect();
        assert!(case.truth.is_subset(&found), "{name}: {found:?}");
        for (axis, log) in
            trace.axes.iter().flat_map(|axis| fit.iter().chain(validate).map(move |log| (axis, log)))
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
