//! Refusal of logs that cannot be traced.

use super::admitted::Admitted;
use super::{checks, copies, missing_channels};
use crate::input::saturation;
use crate::options::AdmissionOptions;
use files::error::InputError;
use model::machine::Machine;

/// The logs, if they can be traced, with notes on their missing channels and saturated forces.
///
/// # Errors
/// If a log does not match the machine file or the other logs, or contains no usable motion.
pub fn usable<'a>(
    machine: &Machine,
    admitted: Admitted<'a>,
    options: &AdmissionOptions,
) -> Result<Admitted<'a>, InputError> {
    let Admitted { mut examined, mut notes } = admitted;
    let [fit, validate] = &mut examined.logs;
    for log in fit.iter().chain(&*validate) {
        checks::check(machine, log, options)?;
    }
    checks::same_units(fit, validate)?;
    copies::refuse(fit.iter().chain(&*validate).map(AsRef::as_ref), options)?;
    notes.extend(missing_channels::remove_partial_temperatures([&mut *fit, validate]));
    notes.extend(missing_channels::notes(machine, fit, validate)?);
    notes.extend(missing_channels::remove_undriven_tools([&mut *fit, validate]));
    saturation::check(machine, fit, options, &mut notes)?;
    Ok(Admitted { examined, notes })
}

#[cfg(test)]
mod tests {
    use std::borrow::Cow;

    use super::super::admitted::at_machine_rate;
    use super::*;
    use crate::data_faults::examine::Examined;
    use crate::input::signals::Signals;
    use crate::options::SampleOptions;
    use files::log::{AxisLog, Log, Unit};

    const MACHINE: &str = "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ntable_mass_kg = 100.0\ncontroller = \"p\"\n\
                           position_gain_per_s = 30.0\nvelocity_gain_n_s_per_m = 1e4\nforce_limit_n = 100.0\n[axis.y]\n";

    fn machine() -> Machine {
        Machine::parse(MACHINE, "m.toml").unwrap()
    }

    /// One second at a rate; x oscillates over 10 mm, y is at rest.
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
        Log::new(source, 0.0, 1.0 / rate_hz, axes)
    }

    /// Both steps of the admission.
    fn admit<'a>(
        machine: &Machine,
        fit: &'a [Log],
        validate: &'a [Log],
        options: &AdmissionOptions,
    ) -> Result<Admitted<'a>, InputError> {
        let logs = [fit, validate].map(|logs| logs.iter().map(Cow::Borrowed).collect());
        let given = Examined { logs, ..Examined::default() };
        usable(machine, at_machine_rate(machine, given, options)?, options)
    }

    fn refused(fit: &[Log], validate: &[Log]) -> String {
        admit(&machine(), fit, validate, &AdmissionOptions::default()).unwrap_err().to_string()
    }

    /// The stages of a trace have constant gains: a machine whose gains are scheduled would be misread.
    #[test]
    fn a_machine_with_a_gain_schedule_is_refused_by_name() {
        let keys = "gain_schedule_position_mm = [0, 9]\ngain_schedule_ratio = [1, 2]\n";
        let scheduled = MACHINE.replace("force_limit_n", &format!("{keys}force_limit_n"));
        let scheduled = Machine::parse(&scheduled, "m.toml").unwrap();
        let log = log("l.csv", 1000.0, Unit::Millimetre);
        let refused = |machine: &Machine| {
            admit(machine, std::slice::from_ref(&log), &[], &AdmissionOptions::default())
                .map(|_| ())
                .map_err(|e| e.to_string())
        };
        assert_eq!(refused(&machine()), Ok(()));
        assert!(refused(&scheduled).unwrap_err().contains("axis.x.gain_schedule_ratio"));
    }

    #[test]
    fn a_log_of_a_multiple_of_the_rate_is_thinned_and_this_is_noted() {
        let fast = log("fast.csv", 4000.0, Unit::Millimetre);
        let admitted =
            admit(&machine(), std::slice::from_ref(&fast), &[], &AdmissionOptions::default()).unwrap();
        let thinned = &admitted.examined.logs[0][0];
        assert_eq!((thinned.len(), thinned.sample_time_s), (1000, 1e-3));
        let [all, some] = [&fast, thinned.as_ref()].map(|log| log.axes[0].motor.as_ref().unwrap());
        assert!(some.iter().zip(all.iter().step_by(4)).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!(
            admitted.notes[0].starts_with("fast.csv: sampled at 4000 Hz, 4 times"),
            "{:?}",
            admitted.notes
        );
    }

    /// Between samples 0.67 ms apart, a sine of 5 mm and 6 rad/s is a cubic within its fourth derivative: 5·6⁴·(0.67e-3)⁴·(9/16)/24 = 3e-11 mm.
    #[test]
    fn a_log_of_another_higher_rate_is_resampled_and_this_is_noted() {
        let given = log("l.csv", 1500.0, Unit::Millimetre);
        let admitted =
            admit(&machine(), std::slice::from_ref(&given), &[], &AdmissionOptions::default()).unwrap();
        let said = "l.csv: sampled at 1500.000000 Hz and resampled at 1000 Hz";
        assert!(admitted.notes[0].starts_with(said) && admitted.notes[0].contains("set sample_rate_hz"));
        let log = &admitted.examined.logs[0][0];
        assert_eq!((log.len(), log.sample_time_s), (1000, 1e-3));
        for (i, x) in (0_u32..).zip(log.axes[0].motor.as_ref().unwrap()) {
            assert!((x - 5.0 * (6e-3 * f64::from(i)).sin()).abs() < 1e-10, "{i}: {x}");
        }
    }

    #[test]
    fn a_lower_rate_is_refused_with_the_key() {
        for rate in [700.0, 500.0] {
            let message = refused(&[log("l.csv", rate, Unit::Millimetre)], &[]);
            assert!(
                message.ends_with("too few; sample_rate_hz can be set to the rate of the log"),
                "{message}"
            );
        }
    }

    #[test]
    fn an_axis_has_one_unit_in_all_logs() {
        let message =
            refused(&[log("a.csv", 1000.0, Unit::Millimetre)], &[log("b.csv", 1000.0, Unit::Degree)]);
        assert_eq!(message, "b.csv: expected axis x in mm, as in a.csv, found deg");
    }

    #[test]
    fn a_copy_is_refused_among_fit_and_validation_logs() {
        use std::slice::from_ref;

        let whole = log("a.csv", 1000.0, Unit::Millimetre);
        let mut copy = Log { source: "b.csv".to_owned(), ..whole.slice(30..1000) };
        let message = "b.csv: expected a different recording, found 100 % of the rows of the shorter log shared with a.csv";
        assert_eq!(refused(from_ref(&whole), from_ref(&copy)), message);
        assert_eq!(refused(&[whole.clone(), copy.clone()], &[]), message);
        // The same motion with other readings is not a copy.
        for axis in &mut copy.axes {
            let readings = axis.motor.iter_mut().chain(&mut axis.force).flatten();
            readings.zip(0..).for_each(|(value, i)| *value += 1e-3 * f64::from(i % 7));
        }
        assert!(admit(&machine(), &[whole], &[copy], &AdmissionOptions::default()).is_ok());
    }

    #[test]
    fn channels_that_a_validation_log_lacks_are_noted_and_none_in_common_is_refused() {
        let fit = [log("a.csv", 1000.0, Unit::Millimetre)];
        let mut incomplete = log("b.csv", 1000.0, Unit::Millimetre);
        incomplete.axes[0].force = None;
        // Another motion, so that the log is not a copy.
        incomplete.axes[0].motor.iter_mut().flatten().for_each(|mm| *mm *= 0.5);
        let held_out = [incomplete.clone()];
        let admitted = admit(&machine(), &fit, &held_out, &AdmissionOptions::default()).unwrap();
        assert_eq!(admitted.notes, ["b.csv: has no x force, and judges nothing of it."]);
        incomplete.axes.pop();
        incomplete.axes[0].command = incomplete.axes[0].motor.take();
        assert!(
            refused(&fit, &[incomplete]).contains("b.csv: expected at least one channel of the fit logs")
        );
    }

    #[test]
    fn a_sensor_that_does_not_move_while_another_does_is_refused() {
        let mut dead = log("d.csv", 1000.0, Unit::Millimetre);
        let motor = dead.axes[0].motor.clone().unwrap();
        dead.axes[0].command = Some(motor.clone());
        dead.axes[0].motor = Some(vec![0.0; motor.len()]);
        let message = refused(&[dead.clone()], &[]);
        assert!(
            message
                .starts_with("d.csv: expected a motor reading of x that changes while the axis moves over"),
            "{message}"
        );
        (dead.axes[0].motor, dead.axes[0].table) = (Some(motor.clone()), Some(vec![5.0; motor.len()]));
        assert!(refused(&[dead], &[]).starts_with("d.csv: expected a table reading of x"));
    }

    #[test]
    fn a_saturated_force_is_excluded_or_refused() {
        let clipped = |greatest: f64| {
            let mut log = log("s.csv", 1000.0, Unit::Millimetre);
            let force = log.axes[0].force.as_mut().unwrap();
            for force in force.iter_mut() {
                *force = (greatest / 50.0 * *force).clamp(-100.0, 100.0);
            }
            log
        };
        // The expected fraction is counted from the samples above 99 N, in percent of one second.
        let log = clipped(120.0);
        let fraction =
            log.axes[0].force.as_ref().unwrap().iter().filter(|f| f.abs() >= 99.0).count() as f64 / 10.0;
        let admitted =
            admit(&machine(), std::slice::from_ref(&log), &[], &AdmissionOptions::default()).unwrap();
        assert!(admitted.notes[0].contains(&format!("limit in {fraction:.2} %")), "{:?}", admitted.notes);
        let mut prepared = [Signals::new(&log, &["x".to_owned(), "y".to_owned()], &SampleOptions::default())];
        saturation::mark(&machine(), &mut prepared, &AdmissionOptions::default());
        let excluded = prepared[0].axes[0].saturated.iter().filter(|at| **at).count() as f64 / 10.0;
        // The filter extends each of three stretches by five samples on both sides.
        assert!(excluded > fraction && excluded < fraction + 3.1, "{excluded} {fraction}");
        assert!(
            refused(&[clipped(1000.0)], &[])
                .contains("x: expected a force below force_limit_n (100) in most")
        );
    }

    #[test]
    fn an_axis_at_rest_is_recognized() {
        let fit = [Cow::Owned(log("a.csv", 1000.0, Unit::Millimetre))];
        let is_at_rest = |axis| checks::is_at_rest(&fit, axis, &AdmissionOptions::default());
        assert!(is_at_rest("y") && !is_at_rest("x"));
    }
}
