//! Random parts of logs and machine files.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};

use files::log::{Channel, Log};
use model::machine::Machine;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use report::sentences;
use trace::trace;

use super::case::{Case, Named, certain};

/// Number of variants of each case in every run.
const VARIANTS: u64 = 5;
/// Greatest length of a log in these, samples; that of `tests/deep.sh sweep` is unlimited.
const MAX_SAMPLES: usize = 3_000;

/// Keys of an axis that may be absent.
const KEYS: [&str; 16] = [
    "feedforward_percent",
    "velocity_gain_n_s_per_m",
    "velocity_integral_time_s",
    "force_limit_n",
    "motor_mass_kg",
    "table_mass_kg",
    "stiffness_n_per_um",
    "damping_n_s_per_m",
    "coulomb_n",
    "viscous_n_s_per_m",
    "motor_coulomb_n",
    "presliding_stiffness_n_per_um",
    "presliding_damping_n_s_per_m",
    "plant_tolerance_percent",
    "lead_mm",
    "resolver_pole_pairs",
];

/// A part of a case.
struct Variant {
    machine: String,
    logs: [Vec<Log>; 2],
    /// What is missing, for messages.
    missing: String,
    /// The keys that are missing on each axis.
    keys: BTreeSet<Named>,
}

impl Variant {
    fn draw(case: &Case, max_samples: usize, random: &mut ChaCha8Rng) -> Self {
        let mut missing = String::new();
        let mut logs = case.logs.clone();
        for logs in &mut logs {
            let count = random.random_range(1..=logs.len());
            let first = random.random_range(0..=logs.len() - count);
            *logs = logs[first..first + count].to_vec();
            for log in logs.iter_mut() {
                *log = part(log, max_samples, random);
                write!(missing, " {}@{}+{}", log.source, log.start_s, log.len()).unwrap();
            }
        }
        if random.random_bool(0.3) {
            logs[1].clear();
            missing += " no validation";
        }
        drop_channels(&mut logs, &mut missing, random);
        let (machine, keys) = without_keys(&case.machine, random);
        write!(missing, " without {keys:?}").unwrap();
        Self { machine, logs, missing, keys }
    }
}

/// A part of a log of random length and place, with at least 100 samples.
fn part(log: &Log, max_samples: usize, random: &mut ChaCha8Rng) -> Log {
    let most = log.len().min(max_samples);
    let samples = if random.random_bool(0.4) { most } else { random.random_range(100..=most) };
    let first = random.random_range(0..=log.len() - samples);
    log.slice(first..first + samples)
}

/// Drops channels, of all logs or of some, and axes.
fn drop_channels(logs: &mut [Vec<Log>; 2], missing: &mut String, random: &mut ChaCha8Rng) {
    let names: Vec<String> = logs[0][0].axes.iter().map(|axis| axis.name.clone()).collect();
    for name in names {
        for channel in Channel::ALL {
            let of_all = random.random_bool(0.2);
            for log in logs.iter_mut().flatten() {
                let is_dropped = of_all || random.random_bool(0.05);
                let Some(axis) = log.axes.iter_mut().find(|axis| axis.name == name) else { continue };
                if is_dropped && axis.channel_mut(channel).take().is_some() {
                    let what = if of_all { String::new() } else { format!(" of {}", log.source) };
                    write!(missing, " {name}_{}{what}", channel.word()).unwrap();
                }
            }
        }
        if random.random_bool(0.1) {
            logs.iter_mut().flatten().for_each(|log| log.axes.retain(|axis| axis.name != name));
            write!(missing, " axis {name}").unwrap();
        }
    }
    // As in a file: an axis without a channel has no column, and a log without any cannot be read.
    let has_channel = |log: &Log, axis: &str| {
        log.axis(axis).is_some_and(|axis| Channel::ALL.iter().any(|channel| axis.channel(*channel).is_some()))
    };
    for logs in logs {
        for log in logs.iter_mut() {
            let names: Vec<String> = log.axes.iter().map(|axis| axis.name.clone()).collect();
            let left: Vec<&String> = names.iter().filter(|name| has_channel(log, name)).collect();
            let left: BTreeSet<String> = left.into_iter().cloned().collect();
            log.axes.retain(|axis| left.contains(&axis.name));
        }
        logs.retain(|log| !log.axes.is_empty());
    }
}

/// A machine file without some of its keys, and these.
fn without_keys(machine: &str, random: &mut ChaCha8Rng) -> (String, BTreeSet<Named>) {
    let mut keys = BTreeSet::new();
    let loses_keys = random.random_bool(0.4);
    let mut axis = String::new();
    let mut kept = String::new();
    for line in machine.lines() {
        if let Some(name) = line.strip_prefix("[axis.") {
            name.trim_end_matches(']').clone_into(&mut axis);
        }
        let key = line.split_once(" = ").map_or("", |(key, _)| key);
        if KEYS.contains(&key) && loses_keys && random.random_bool(0.1) {
            keys.insert((axis.clone(), key.to_owned()));
        } else {
            kept += line;
            kept.push('\n');
        }
    }
    (kept, keys)
}

/// What is wrong with the result of a variant; `None`: nothing.
fn fault(case: &Case, variant: &Variant) -> Option<String> {
    let machine = match Machine::parse(&variant.machine, "machine.toml") {
        Ok(machine) => machine,
        Err(error) => return in_one_line(&error.to_string()),
    };
    let [fit, validate] = &variant.logs;
    if fit.is_empty() {
        return None;
    }
    let result = catch_unwind(AssertUnwindSafe(|| trace(&machine, fit, validate, &|_| {})));
    let traced = match result {
        Err(_) => return Some("panics".to_owned()),
        Ok(Err(error)) => return in_one_line(&error.to_string()),
        Ok(Ok(traced)) => traced,
    };
    let json = trace::json::of(&traced, false);
    let text = sentences::summary(&traced).join("\n");
    if text.contains("NaN") || text.contains("inf ") {
        return Some(format!("no numbers: {text}"));
    }
    let is_false = |named: &Named| !case.truth.contains(named) && !is_known_imitation(named, variant);
    let certain: Vec<Named> = certain(&json).into_iter().filter(is_false).collect();
    (!certain.is_empty()).then(|| format!("certain: {certain:?}"))
}

/// The message of an error that is not one line.
fn in_one_line(message: &str) -> Option<String> {
    let is_one = !message.is_empty() && message.lines().count() == 1 && message.contains(": ");
    (!is_one).then(|| format!("not one line: {message}"))
}

/// Effects of the tool that the stretch of the drive imitates.
const OF_STRETCH: [&str; 4] = ["intalk", "crosstalk", "resonance", "latency"];

/// False names whose cause is known and which are not mended yet:
///
/// - Without `plant_tolerance_percent` the declared values count as exact. Their true deviation, up to 10 % in these cases, must then
///   be an effect.
/// - Without the table the tool is predicted from the motor: what the drive stretches is an effect of the tool.
fn is_known_imitation((axis, name): &Named, variant: &Variant) -> bool {
    let lacks = |key: &str| variant.keys.contains(&(axis.clone(), key.to_owned()));
    let has_table = |log: &Log| log.axis(axis).is_some_and(|axis| axis.table.is_some());
    lacks("plant_tolerance_percent")
        || OF_STRETCH.contains(&name.as_str()) && !variant.logs[0].iter().any(has_table)
}

/// The faults of variants of each case, with all that is needed to repeat them.
fn faults(cases: &[Case], variants: u64, seed: u64, max_samples: usize) -> Vec<String> {
    let mut faults = Vec::new();
    for (stream, case) in cases.iter().enumerate() {
        for number in seed..seed + variants {
            let mut random = ChaCha8Rng::seed_from_u64(number);
            random.set_stream(stream as u64);
            let variant = Variant::draw(case, max_samples, &mut random);
            let Some(fault) = fault(case, &variant) else { continue };
            let fault = format!("{}, seed {number}: {fault}:{}", case.name, variant.missing);
            // At once, as a deep run takes hours.
            eprintln!("{fault}");
            faults.push(fault);
        }
    }
    faults
}

#[test]
fn parts_of_simulated_logs() {
    let faults = faults(&[Case::simulated()], 2 * VARIANTS, 1, MAX_SAMPLES);
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn parts_of_the_blind_cases() {
    let Some(cases) = Case::blind() else { return };
    let faults = faults(&cases, VARIANTS, 1, MAX_SAMPLES);
    assert!(faults.is_empty(), "{faults:#?}");
}

/// `tests/deep.sh sweep`: as many variants as `SWEEP_VARIANTS` says, from `SWEEP_SEED` on, of logs of any length.
#[test]
#[ignore = "takes hours"]
fn many_parts_of_the_blind_cases() {
    let number = |name: &str, default: u64| std::env::var(name).map_or(default, |text| text.parse().unwrap());
    let Some(cases) = Case::blind() else { return };
    let faults = faults(&cases, number("SWEEP_VARIANTS", 100), number("SWEEP_SEED", 1000), usize::MAX);
    assert!(faults.is_empty(), "{faults:#?}");
}
