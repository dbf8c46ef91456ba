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

use super::case::{Case, Named, certain, named};

/// Number of variants of each case in every run.
const VARIANTS: u64 = 5;
/// Samples of all logs for the fit from which on an effect counts as shown.
const SHOWN_SAMPLES: usize = 1_000;
/// Share of the effects shown that has to be found. A part of a log need not move the axis as an effect needs it, and other logs of the
/// same variant may lack its channel: 7 of 11 are found.
const MIN_FOUND: f64 = 0.5;
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

/// The effects that the logs of variants show, and how many of them are found.
#[derive(Default)]
struct Detection {
    shown: usize,
    found: usize,
}

impl Detection {
    /// Adds the effects of axes of which all keys are left, and all channels in some log for the fit, of this many samples at least.
    fn add(&mut self, case: &Case, variant: &Variant, named: &BTreeSet<Named>) {
        let channels = |log: &Log, axis: &str| {
            log.axis(axis).map(|axis| Channel::ALL.map(|channel| axis.channel(channel).is_some()))
        };
        let is_shown = |axis: &str| {
            let is_whole = |log: &&Log| channels(log, axis) == channels(&case.logs[0][0], axis);
            let samples: usize = variant.logs[0].iter().filter(is_whole).map(Log::len).sum();
            samples >= SHOWN_SAMPLES && !variant.keys.iter().any(|(of, _)| of == axis)
        };
        for effect in case.truth.iter().filter(|(axis, _)| is_shown(axis)) {
            self.shown += 1;
            self.found += usize::from(named.contains(effect));
        }
    }
}

/// What is wrong with the result of a variant; `None`: nothing.
fn fault(case: &Case, variant: &Variant, detection: &mut Detection) -> Option<String> {
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
    let json = trace::json::Document::of(&traced, &[], false).value();
    let text = sentences::summary(&traced, None).join("\n");
    if text.contains("NaN") || text.contains("inf ") {
        return Some(format!("no numbers: {text}"));
    }
    detection.add(case, variant, &named(&json));
    let is_false = |named: &Named| !case.truth.contains(named) && !is_declared_exact(named, variant);
    let certain: Vec<Named> = certain(&json).into_iter().filter(is_false).collect();
    (!certain.is_empty()).then(|| format!("certain: {certain:?}"))
}

/// The message of an error that is not one line.
fn in_one_line(message: &str) -> Option<String> {
    let is_one = !message.is_empty() && message.lines().count() == 1 && message.contains(": ");
    (!is_one).then(|| format!("not one line: {message}"))
}

/// Without `plant_tolerance_percent` the declared values count as exact: their true deviation, up to 10 % in these cases, is then an
/// effect.
fn is_declared_exact((axis, _): &Named, variant: &Variant) -> bool {
    variant.keys.contains(&(axis.clone(), "plant_tolerance_percent".to_owned()))
}

/// The faults of variants of each case, with all that is needed to repeat them, and the effects that were found.
fn faults(cases: &[Case], variants: u64, seed: u64, max_samples: usize) -> (Vec<String>, Detection) {
    let (mut faults, mut detection) = (Vec::new(), Detection::default());
    for (stream, case) in cases.iter().enumerate() {
        for number in seed..seed + variants {
            let mut random = ChaCha8Rng::seed_from_u64(number);
            random.set_stream(stream as u64);
            let variant = Variant::draw(case, max_samples, &mut random);
            let Some(fault) = fault(case, &variant, &mut detection) else { continue };
            let fault = format!("{}, seed {number}: {fault}:{}", case.name, variant.missing);
            // At once, as a deep run takes hours.
            eprintln!("{fault}");
            faults.push(fault);
        }
    }
    (faults, detection)
}

/// No fault, and of the effects that the logs show at least this share is found: a tracer that names nothing is never wrong.
fn assert_sound((faults, detection): (Vec<String>, Detection), min_found: f64) {
    assert!(faults.is_empty(), "{faults:#?}");
    let Detection { shown, found } = detection;
    assert!(shown > 0 && found as f64 >= min_found * shown as f64, "{found} of {shown} effects found");
}

#[test]
fn parts_of_simulated_logs() {
    assert_sound(faults(&[Case::simulated()], 2 * VARIANTS, 1, MAX_SAMPLES), MIN_FOUND);
}

#[test]
fn parts_of_the_blind_cases() {
    let Some(cases) = Case::blind() else { return };
    assert_sound(faults(&cases, VARIANTS, 1, MAX_SAMPLES), MIN_FOUND);
}

/// `tests/deep.sh sweep`: as many variants as `SWEEP_VARIANTS` says, from `SWEEP_SEED` on, of logs of any length.
#[test]
#[ignore = "takes hours"]
fn many_parts_of_the_blind_cases() {
    let number = |name: &str, default: u64| std::env::var(name).map_or(default, |text| text.parse().unwrap());
    let Some(cases) = Case::blind() else { return };
    let swept = faults(&cases, number("SWEEP_VARIANTS", 100), number("SWEEP_SEED", 1000), usize::MAX);
    assert_sound(swept, MIN_FOUND);
}
