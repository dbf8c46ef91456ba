//! Which logs can be traced on a machine, and what is made of those that cannot be taken as they are.

use std::borrow::Cow;

use super::copies;
use super::signals::Signals;
use files::error::InputError;
use files::log::{Channel, Log, Unit};
use model::machine::Machine;

/// Logs as they are traced, with what the user has to know of them.
#[derive(Clone, Debug)]
pub struct Admitted<'a> {
    /// To be fitted.
    pub fit: Vec<Cow<'a, Log>>,
    /// Held out; empty where the fit logs are to be split.
    pub validate: Vec<Cow<'a, Log>>,
    /// Sentences.
    pub notes: Vec<String>,
}

/// Rates that differ by less are the same: times are printed rounded, and a per mille is far below any other rate.
const SAME_RATE: f64 = 1e-3;

/// Most samples of all fit logs together, and of all others: a fit keeps some 50 numbers a sample and axis, and takes
/// seconds for each 100 000.
const MOST_SAMPLES: usize = 204_000;

/// Stretches that a log which is too long is cut down to.
const STRETCHES: usize = 12;

/// A force within this share of its limit stands at it: the reading has noise.
const AT_LIMIT: f64 = 0.99;

/// Admits logs, or refuses one of them.
///
/// # Errors
/// When a log does not fit the machine file or the other logs, or when nothing can be learned from it.
pub fn admit<'a>(machine: &Machine, fit: &'a [Log], validate: &'a [Log]) -> Result<Admitted<'a>, InputError> {
    let mut notes = Vec::new();
    let mut at_rate = |logs: &'a [Log]| -> Result<Vec<Cow<'a, Log>>, InputError> {
        logs.iter().map(|log| at_machine_rate(machine, log, &mut notes)).collect()
    };
    let (fit, validate) = (at_rate(fit)?, at_rate(validate)?);
    for log in fit.iter().chain(&validate) {
        check(machine, log)?;
    }
    same_units(&fit, &validate)?;
    copies::refuse(fit.iter().chain(&validate).map(AsRef::as_ref))?;
    notes.extend(lacking(machine, &fit, &validate)?);
    saturation(machine, &fit, &mut notes)?;
    let fit = cut_down(fit, &mut notes);
    let validate = cut_down(validate, &mut notes);
    Ok(Admitted { fit, validate, notes })
}

/// The log at the machine's rate. One that is a whole number of times as fast is thinned.
fn at_machine_rate<'a>(
    machine: &Machine,
    log: &'a Log,
    notes: &mut Vec<String>,
) -> Result<Cow<'a, Log>, InputError> {
    let rate = 1.0 / log.sample_time_s;
    let ratio = rate / machine.sample_rate_hz;
    let whole = ratio.round();
    let what = format!("samples at the machine's sample_rate_hz of {}", machine.sample_rate_hz);
    if whole < 1.0 || (ratio / whole - 1.0).abs() > SAME_RATE {
        let why = if ratio < 1.0 - SAME_RATE {
            "what lies between its samples is not known"
        } else {
            "no whole number of times as many"
        };
        return Err(InputError::expected(&log.source, what, format!("{rate:.6} Hz: {why}")));
    }
    if whole < 1.5 {
        return Ok(Cow::Borrowed(log));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 2")]
    let every = whole as usize;
    notes.push(format!(
        "{}: sampled at {rate:.0} Hz, {every} times the machine's rate; every {} sample is used, as read: a controller at \
         the machine's rate reads its encoders just so, and a filter would delay what it sees. Vibration above {:.0} Hz \
         appears at a lower frequency.",
        log.source,
        ordinal(every),
        0.5 * machine.sample_rate_hz
    ));
    let mut thinned = log.clone();
    thinned.sample_time_s = log.sample_time_s * whole;
    for axis in &mut thinned.axes {
        for channel in Channel::ALL {
            if let Some(samples) = axis.channel_mut(channel) {
                *samples = samples.iter().copied().step_by(every).collect();
            }
        }
    }
    Ok(Cow::Owned(thinned))
}

fn ordinal(n: usize) -> String {
    let end = match (n % 10, n % 100) {
        (1, rest) if rest != 11 => "st",
        (2, rest) if rest != 12 => "nd",
        (3, rest) if rest != 13 => "rd",
        _ => "th",
    };
    format!("{n}{end}")
}

/// How far a log's axis goes in the channel that goes farthest, mm or degrees.
fn travel(log: &Log, axis: &str) -> f64 {
    let Some(axis) = log.axis(axis) else { return 0.0 };
    let channels = [&axis.command, &axis.motor, &axis.table].into_iter().flatten();
    numerics::max(channels.map(|places| numerics::peak_to_peak(places.iter().copied()))).max(0.0)
}

/// Less is presliding and noise, mm or degrees.
const LEAST_TRAVEL: f64 = 0.01;

/// More is a slip of the unit.
const MOST_TRAVEL: f64 = 1e6;

/// A sensor that stands while another goes so many times as far as an axis must is dead: no gap is as wide.
const STANDS_BESIDE: f64 = 100.0;

/// Least samples that anything can be fitted to.
const LEAST_SAMPLES: usize = 200;

/// Refuses a log that is not of this machine, or that nothing can be learned from.
fn check(machine: &Machine, log: &Log) -> Result<(), InputError> {
    let refuse = |what: String, found: String| Err(InputError::expected(&log.source, what, found));
    for axis in &log.axes {
        if !machine.axis.contains_key(&axis.name) {
            let names: Vec<&str> = machine.axis.keys().map(String::as_str).collect();
            return refuse(
                format!("axes of the machine file ({})", names.join(", ")),
                format!("axis {}", axis.name),
            );
        }
    }
    let farthest = numerics::max_abs(log.axes.iter().map(|axis| travel(log, &axis.name)));
    if !(LEAST_TRAVEL..=MOST_TRAVEL).contains(&farthest) {
        return refuse(
            format!("motion over {LEAST_TRAVEL} to {MOST_TRAVEL} mm (or deg) on some axis"),
            format!("{farthest:.6}"),
        );
    }
    for axis in &log.axes {
        let of = |channel: Channel| {
            axis.channel(channel).map(|places| numerics::peak_to_peak(places.iter().copied()))
        };
        let [command, motor, table] = [Channel::Command, Channel::Motor, Channel::Table].map(of);
        for (name, dead, moves) in [("motor", motor, table.or(command)), ("table", table, motor)] {
            let (Some(dead), Some(moves)) = (dead, moves) else { continue };
            if moves > STANDS_BESIDE * LEAST_TRAVEL && dead < LEAST_TRAVEL {
                return refuse(
                    format!(
                        "a {name} of {} that moves where the axis goes {moves:.3} mm (or deg)",
                        axis.name
                    ),
                    "one that stands".to_owned(),
                );
            }
        }
    }
    if log.len() < LEAST_SAMPLES {
        return refuse(format!("at least {LEAST_SAMPLES} samples"), log.len().to_string());
    }
    Ok(())
}

/// Refuses an axis that is linear in one log and rotary in another.
fn same_units(fit: &[Cow<'_, Log>], validate: &[Cow<'_, Log>]) -> Result<(), InputError> {
    let logs: Vec<&Log> = fit.iter().chain(validate).map(AsRef::as_ref).collect();
    for (i, log) in logs.iter().enumerate() {
        for axis in &log.axes {
            let of = |other: &&&Log| other.axis(&axis.name).is_some_and(|there| there.unit != axis.unit);
            if let Some(other) = logs[..i].iter().find(of) {
                let unit = |unit: Unit| unit.suffix(Channel::Motor);
                let there = other.axis(&axis.name).map_or("", |there| unit(there.unit));
                let what = format!("axis {} in {there}, as in {}", axis.name, other.source);
                return Err(InputError::expected(&log.source, what, unit(axis.unit)));
            }
        }
    }
    Ok(())
}

/// What validation logs lack that fit logs have. With nothing in common they cannot judge anything.
fn lacking(
    machine: &Machine,
    fit: &[Cow<'_, Log>],
    validate: &[Cow<'_, Log>],
) -> Result<Vec<String>, InputError> {
    let in_all = |logs: &[Cow<'_, Log>], name: &str, channel| {
        !logs.is_empty()
            && logs.iter().all(|log| log.axis(name).is_some_and(|axis| axis.channel(channel).is_some()))
    };
    let fitted: Vec<(&str, Channel)> = machine
        .axis
        .keys()
        .flat_map(|name| Channel::ALL.map(|channel| (name.as_str(), channel)))
        .filter(|(name, channel)| *channel != Channel::AddedForce && in_all(fit, name, *channel))
        .collect();
    let mut notes = Vec::new();
    for log in validate {
        let missing: Vec<String> = fitted
            .iter()
            .filter(|(name, channel)| log.axis(name).is_none_or(|axis| axis.channel(*channel).is_none()))
            .map(|(name, channel)| format!("{name} {}", channel.word()))
            .collect();
        if missing.len() == fitted.len() && !fitted.is_empty() {
            let what = "a channel that the fit logs have, too";
            return Err(InputError::expected(&log.source, what, "none"));
        }
        if !missing.is_empty() {
            notes.push(format!("{}: has no {}, and judges nothing of it.", log.source, missing.join(", ")));
        }
    }
    Ok(notes)
}

/// Says how much of a fit log's force stands at its limit; refuses where most of it does.
fn saturation(machine: &Machine, fit: &[Cow<'_, Log>], notes: &mut Vec<String>) -> Result<(), InputError> {
    for log in fit {
        for (name, axis) in &machine.axis {
            let (Some(limit_n), Some(force)) =
                (axis.force_limit_n, log.axis(name).and_then(|axis| axis.force.as_ref()))
            else {
                continue;
            };
            let count = at_limit(force, limit_n).iter().filter(|at| **at).count();
            let share = count as f64 / force.len().max(1) as f64;
            if share > 0.5 {
                let what = format!("a force below force_limit_n ({limit_n}) in most samples");
                let found = format!("it at the limit in {:.0} %", 100.0 * share);
                return Err(InputError::expected(&log.source, what, found).at_key(name));
            }
            if count > 0 {
                notes.push(format!(
                    "{}: the force of {name} stands at its limit in {:.2} % of the samples; the force stage leaves \
                     them out.",
                    log.source,
                    100.0 * share
                ));
            }
        }
    }
    Ok(())
}

fn at_limit(force: &[f64], limit_n: f64) -> Vec<bool> {
    force.iter().map(|force| force.abs() >= AT_LIMIT * limit_n).collect()
}

/// Marks the samples of prepared logs whose force stands at its limit, with their neighbours within the smoothing
/// filter, and the logs that are recordings of their own.
pub fn mark(machine: &Machine, logs: &mut [Signals], first: Option<&str>) {
    for log in logs {
        log.has_own_zero = first.is_some_and(|first| first != log.source);
        for (axis, declared) in log.axes.iter_mut().zip(machine.axis.values()) {
            let (Some(force), Some(limit_n)) = (&axis.force, declared.force_limit_n) else { continue };
            let at = at_limit(&force.raw, limit_n);
            if at.iter().any(|at| *at) {
                let reach = force.reach();
                let around = |i: usize| i.saturating_sub(reach)..(i + reach + 1).min(at.len());
                axis.saturated = (0..at.len()).map(|i| at[around(i)].iter().any(|at| *at)).collect();
            }
        }
    }
}

/// Logs that are too long together are cut down to stretches, spread evenly over each.
fn cut_down<'a>(logs: Vec<Cow<'a, Log>>, notes: &mut Vec<String>) -> Vec<Cow<'a, Log>> {
    let total: usize = logs.iter().map(|log| log.len()).sum();
    if total <= MOST_SAMPLES {
        return logs;
    }
    let share = MOST_SAMPLES as f64 / total as f64;
    let of_log = |log: Cow<'a, Log>| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a length")]
        let length = (share * log.len() as f64 / STRETCHES as f64) as usize;
        if length < LEAST_SAMPLES {
            return vec![log];
        }
        notes.push(format!(
            "{}: {} samples are more than is needed; {STRETCHES} stretches of {:.0} s, spread evenly over it, are used.",
            log.source,
            log.len(),
            length as f64 * log.sample_time_s
        ));
        let start = |i: usize| i * (log.len() - length) / (STRETCHES - 1);
        (0..STRETCHES).map(|i| Cow::Owned(log.slice(start(i)..start(i) + length))).collect()
    };
    logs.into_iter().flat_map(of_log).collect()
}

/// Axes that do not move in any fit log.
#[must_use]
pub fn stands(fit: &[Cow<'_, Log>], axis: &str) -> bool {
    fit.iter().all(|log| travel(log, axis) < LEAST_TRAVEL)
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::AxisLog;

    const MACHINE: &str = "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ntable_mass_kg = 100.0\ncontroller = \"p\"\n\
                           position_gain_per_s = 30.0\nvelocity_gain_n_s_per_m = 1e4\nforce_limit_n = 100.0\n[axis.y]\n";

    fn machine() -> Machine {
        Machine::parse(MACHINE, "m.toml").unwrap()
    }

    /// One second at a rate; x swings over 10 mm, y stands.
    fn log(source: &str, rate_hz: f64, unit: Unit) -> Log {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few thousand")]
        let count = rate_hz as u32;
        let time = |i: u32| f64::from(i) / rate_hz;
        let mut x = AxisLog::new("x", unit);
        x.motor = Some((0..count).map(|i| 5.0 * (6.0 * time(i)).sin()).collect());
        x.force = Some((0..count).map(|i| 50.0 * (6.0 * time(i)).cos()).collect());
        let mut y = AxisLog::new("y", unit);
        y.motor = Some(vec![1.0; x.motor.as_ref().unwrap().len()]);
        let axes = vec![x, y];
        Log { source: source.to_owned(), start_s: 0.0, sample_time_s: 1.0 / rate_hz, axes }
    }

    fn refused(fit: &[Log], validate: &[Log]) -> String {
        admit(&machine(), fit, validate).unwrap_err().to_string()
    }

    #[test]
    fn a_log_of_a_multiple_of_the_rate_is_thinned_and_said_to_be() {
        let fast = log("fast.csv", 4000.0, Unit::Millimetre);
        let admitted = admit(&machine(), std::slice::from_ref(&fast), &[]).unwrap();
        let thinned = &admitted.fit[0];
        assert_eq!((thinned.len(), thinned.sample_time_s), (1000, 1e-3));
        let [all, some] = [&fast, thinned.as_ref()].map(|log| log.axes[0].motor.as_ref().unwrap());
        assert!(some.iter().zip(all.iter().step_by(4)).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(
            admitted.notes[0].starts_with("fast.csv: sampled at 4000 Hz, 4 times"),
            "{:?}",
            admitted.notes
        );
    }

    #[test]
    fn other_rates_are_refused_with_the_reason() {
        let said = |rate| refused(&[log("l.csv", rate, Unit::Millimetre)], &[]);
        assert!(said(1500.0).ends_with("no whole number of times as many"), "{}", said(1500.0));
        assert!(said(500.0).ends_with("what lies between its samples is not known"), "{}", said(500.0));
    }

    #[test]
    fn an_axis_has_one_unit_in_all_logs() {
        let said = refused(&[log("a.csv", 1000.0, Unit::Millimetre)], &[log("b.csv", 1000.0, Unit::Degree)]);
        assert_eq!(said, "b.csv: expected axis x in mm, as in a.csv, found deg");
    }

    #[test]
    fn a_copy_is_refused_wherever_it_is_given() {
        use std::slice::from_ref;

        let whole = log("a.csv", 1000.0, Unit::Millimetre);
        let mut copy = Log { source: "b.csv".to_owned(), ..whole.slice(30..1000) };
        let said =
            "b.csv: expected a log of its own, found 100 % of the shorter one's rows shared with a.csv";
        assert_eq!(refused(from_ref(&whole), from_ref(&copy)), said);
        assert_eq!(refused(&[whole.clone(), copy.clone()], &[]), said);
        // The same motion with other readings is a log of its own.
        for axis in &mut copy.axes {
            let readings = axis.motor.iter_mut().chain(&mut axis.force).flatten();
            readings.zip(0..).for_each(|(value, i)| *value += 1e-3 * f64::from(i % 7));
        }
        assert!(admit(&machine(), &[whole], &[copy]).is_ok());
    }

    #[test]
    fn what_a_validation_log_lacks_is_told_and_all_of_it_is_too_much() {
        let fit = [log("a.csv", 1000.0, Unit::Millimetre)];
        let mut lacks = log("b.csv", 1000.0, Unit::Millimetre);
        lacks.axes[0].force = None;
        // A motion of its own.
        lacks.axes[0].motor.iter_mut().flatten().for_each(|mm| *mm *= 0.5);
        let held_out = [lacks.clone()];
        let admitted = admit(&machine(), &fit, &held_out).unwrap();
        assert_eq!(admitted.notes, ["b.csv: has no x force, and judges nothing of it."]);
        lacks.axes.pop();
        lacks.axes[0].command = lacks.axes[0].motor.take();
        assert!(refused(&fit, &[lacks]).contains("b.csv: expected a channel that the fit logs have, too"));
    }

    #[test]
    fn a_sensor_that_stands_while_another_moves_is_dead() {
        let mut dead = log("d.csv", 1000.0, Unit::Millimetre);
        let motor = dead.axes[0].motor.clone().unwrap();
        dead.axes[0].command = Some(motor.clone());
        dead.axes[0].motor = Some(vec![0.0; motor.len()]);
        let said = refused(&[dead.clone()], &[]);
        assert!(said.starts_with("d.csv: expected a motor of x that moves where the axis goes"), "{said}");
        (dead.axes[0].motor, dead.axes[0].table) = (Some(motor.clone()), Some(vec![5.0; motor.len()]));
        assert!(refused(&[dead], &[]).starts_with("d.csv: expected a table of x"));
    }

    #[test]
    fn a_saturated_force_is_left_out_or_refused() {
        let clipped = |greatest: f64| {
            let mut log = log("s.csv", 1000.0, Unit::Millimetre);
            let force = log.axes[0].force.as_mut().unwrap();
            for force in force.iter_mut() {
                *force = (greatest / 50.0 * *force).clamp(-100.0, 100.0);
            }
            log
        };
        // |cos| of 6 rad: above 100/120 for its share of a second, which is counted here.
        let log = clipped(120.0);
        let share =
            log.axes[0].force.as_ref().unwrap().iter().filter(|f| f.abs() >= 99.0).count() as f64 / 10.0;
        let admitted = admit(&machine(), std::slice::from_ref(&log), &[]).unwrap();
        assert!(admitted.notes[0].contains(&format!("limit in {share:.2} %")), "{:?}", admitted.notes);
        let mut prepared = [Signals::new(&log, &["x".to_owned(), "y".to_owned()])];
        mark(&machine(), &mut prepared, None);
        let left_out = prepared[0].axes[0].saturated.iter().filter(|at| **at).count() as f64 / 10.0;
        // Five samples of the filter on either side of each of three stretches.
        assert!(left_out > share && left_out < share + 3.1, "{left_out} {share}");
        assert!(
            refused(&[clipped(1000.0)], &[])
                .contains("x: expected a force below force_limit_n (100) in most")
        );
    }

    #[test]
    fn an_axis_that_stands_is_known_to() {
        let fit = [Cow::Owned(log("a.csv", 1000.0, Unit::Millimetre))];
        assert!(stands(&fit, "y") && !stands(&fit, "x"));
    }

    #[test]
    fn a_log_without_end_is_cut_down_to_stretches_of_it() {
        let mut long = log("long.csv", 1000.0, Unit::Millimetre);
        let count = 2 * MOST_SAMPLES;
        for axis in &mut long.axes {
            axis.motor = Some((0..count).map(|i| i as f64).collect());
            axis.force = None;
        }
        let mut notes = Vec::new();
        let cut = cut_down(vec![Cow::Borrowed(&long)], &mut notes);
        assert_eq!((cut.len(), cut.iter().map(|log| log.len()).sum::<usize>()), (STRETCHES, MOST_SAMPLES));
        let first = |log: &Log| log.axes[0].motor.as_ref().unwrap()[0];
        assert_eq!((first(&cut[0]), first(&cut[11])), (0.0, (count - MOST_SAMPLES / STRETCHES) as f64));
        assert!(notes[0].contains("12 stretches of 17 s"), "{notes:?}");
    }
}
