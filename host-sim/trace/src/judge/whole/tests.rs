use std::borrow::Cow;

use crate::fit::fit_data::FitData;
use crate::fit::least_squares::{STEPS, fit};
use crate::input::parts::Parts;
use crate::input::signals::Signals;
use crate::options::TraceOptions;
use crate::trace;
use files::log::{AxisLog, Log, Unit};
use model::effects::{Effect, Stage};
use model::machine::Machine;

const MACHINE: &str = "name = \"m\"\nsample_rate_hz = 1000.0\n[axis.x]\ntable_mass_kg = 100.0\ncoulomb_n = 20.0\n\
                       viscous_n_s_per_m = 200.0\nplant_tolerance_percent = 10.0\n";

/// Reproducible noise, uniform from −0.5 to 0.5.
fn noise(seed: u32) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24) - 0.5
    }
}

/// A rigid axis that oscillates with two frequencies, with 4 % more mass than declared and a load of 30 N. In the samples of
/// `disturbed` the force is 40 N higher.
fn log(source: &str, count: u32, seed: u32, disturbed: std::ops::Range<u32>) -> Log {
    let mut noise = noise(seed);
    let mut axis = AxisLog::new("x", Unit::Millimetre);
    let waves = [(0.06, 2.0), (0.013, 7.3)];
    let sum = |of: &dyn Fn(f64, f64) -> f64| waves.iter().map(|(a, w)| of(*a, *w)).sum::<f64>();
    let time = |i: u32| 1e-3 * f64::from(i);
    axis.motor =
        Some((0..count).map(|i| 1e3 * sum(&|a, w| a * (w * time(i)).sin()) + 1e-5 * noise()).collect());
    let force = |i: u32| {
        let velocity = sum(&|a, w| a * w * (w * time(i)).cos());
        let acceleration = sum(&|a, w| -a * w * w * (w * time(i)).sin());
        let extra = if disturbed.contains(&i) { 40.0 } else { 0.0 };
        104.0 * acceleration + 20.0 * velocity.signum() + 200.0 * velocity + 30.0 + 4.0 * noise() + extra
    };
    axis.force = Some((0..count).map(force).collect());
    Log::new(source, 0.0, 1e-3, [axis])
}

fn load_n(effect: &Effect) -> f64 {
    let Effect::ConstantLoad(load) = effect else { panic!("{effect:?}") };
    load.force_n
}

/// Values and residuals are those of a fit to the signals of the whole log at once.
#[test]
fn a_long_log_is_fitted_and_evaluated_as_a_whole() {
    let options = TraceOptions::default();
    let machine = Machine::parse(MACHINE, "m.toml").unwrap();
    let count = u32::try_from(options.admission.max_samples).unwrap() + 60_000;
    let [long, other] = [log("long.csv", count, 1, 0..0), log("other.csv", 30_000, 2, 0..0)];
    let traced = trace(&machine, std::slice::from_ref(&long), &[other], &|_| {}).unwrap();
    assert!(traced.notes()[0].contains("effects are searched for in 8 stretches"), "{:?}", traced.notes());
    let axis = &traced.axes()[0];
    // The force of this log is that of the instant, not that of the interval before it, which is found as a latency beside the load.
    let found = &axis.found[0];

    let names = ["x".to_owned()];
    let logs = [Signals::new(&long, &names, &options.samples)];
    let data = FitData::new(&logs, &names, 0, machine.rates(), &options);
    let scope = &axis.scopes[0];
    let residuals = data.residuals(&axis.model, scope);
    let error = axis.residual(Stage::Force).unwrap();
    // The first 0.3 s are left out of one, the last 20 samples of the other: 0.1 % of the samples.
    let ratio = error.after.fit / data.rms(&residuals, Stage::Force);
    assert!((ratio - 1.0).abs() < 2e-3, "{ratio}");
    // White noise of 4/√12 N after a filter that leaves √0.2 of it is 0.52 N. Two reversals a second, at which the sign of the
    // friction is half of 20 N off in two samples each, leave √(2·2·10²/1000) N = 0.63 N.
    assert!((0.52..0.82).contains(&error.after.fit), "{error:?}");

    let whole = fit(&data, &axis.model, scope, STEPS).model;
    let [stepped, whole] = [&axis.model, &whole].map(|model| load_n(&model.found()[0]));
    // What the step leaves is far below the interval of the stretches.
    assert!(
        (stepped - whole).abs() < 0.05 * found.half_widths[0],
        "{stepped} {whole} {:?}",
        found.half_widths
    );
    assert!((stepped - 30.0).abs() < found.half_widths[0], "{stepped}");
    assert!((load_n(&found.effect) - stepped).abs() < 1e-12, "the reported value is that of the model");
}

/// A disturbance of ten seconds between two stretches is not seen by the search, but in the residual of the whole log.
#[test]
fn a_disturbance_outside_of_the_stretches_is_reported_with_its_time() {
    let options = TraceOptions::default();
    let machine = Machine::parse(MACHINE, "m.toml").unwrap();
    let count = u32::try_from(options.admission.max_samples).unwrap() + 60_000;
    let sound = log("long.csv", count, 1, 0..0);
    let logs = [Cow::Borrowed(&sound)];
    let parts = Parts::of([&logs, &[]], &options.admission);
    let searched = |set| parts.searched(set, &options.admission);
    // The first gap of ten seconds that no stretch, with its lead-in, contains.
    let is_free = |from: usize| {
        let of_set = |set| {
            searched(set)
                .iter()
                .all(|piece| piece.samples().end < from || piece.samples().start > from + 10_000)
        };
        [0, 1].into_iter().all(of_set)
    };
    let from = (1000..count as usize - 11_000).step_by(500).find(|&from| is_free(from)).unwrap();
    let start = u32::try_from(from).unwrap();
    let disturbed = log("long.csv", count, 1, start..start + 10_000);
    let [of_sound, of_disturbed] =
        [&sound, &disturbed].map(|log| trace(&machine, std::slice::from_ref(log), &[], &|_| {}).unwrap());
    let about = |notes: &[String]| notes.iter().find(|note| note.contains("force stage")).cloned();
    assert_eq!(about(of_sound.notes()), None);
    let note = about(of_disturbed.notes()).unwrap();
    let seconds: Vec<f64> = note.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let middle_s = 1e-3 * from as f64 + 5.0;
    assert!(seconds[0] < middle_s && middle_s < seconds[1], "{note}, disturbed from {from}");
    let after = |trace: &crate::Identification| trace.axes()[0].residuals[0].after;
    let [least, most] = [after(&of_sound), after(&of_disturbed)].map(|rms| rms.fit.max(rms.validate));
    assert!(most > 2.0 * least, "{least} {most}");
    assert!(!of_disturbed.axes()[0].unexplained.is_empty());
}
