//! Drifts from run to run, with times and without.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use positions::columns::Request;
use positions::{analyse, readings};

use super::generator::{Axis, Drift, RUN_S, covered, effect, options, signed};

fn warm(drift: Drift) -> Axis {
    Axis { drift: Some(drift), gap_um: 6.0, ..Axis::quiet(0.3) }
}

#[test]
fn a_drift_has_its_amplitude_and_time_constant_where_times_are_given() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let (mut hits, mut intervals) = (0, 0);
    for seed in 0..40 {
        let drift = Drift {
            amplitude_um: signed(&mut random, 8.0, 30.0),
            um_per_m: 0.0,
            time_constant_s: random.random_range(0.8..2.5) * RUN_S,
        };
        let analysis = warm(drift).analysed(seed, true);
        let found = effect(&analysis, "thermal_drift")
            .unwrap_or_else(|| panic!("{seed}: {drift:?} {:?}", analysis.effects));
        for (key, truth) in [("amplitude_um", drift.amplitude_um), ("time_constant_s", drift.time_constant_s)]
        {
            let (hit, count) = covered(found, key, &[truth]);
            hits += hit;
            intervals += count;
        }
        assert!(found.rivals.contains(&"laser_drift"));
        assert!((analysis.residual.after.fit - 0.3).abs() < 0.06, "{seed}: {:?}", analysis.residual);
    }
    assert!(intervals == 80 && hits >= 72, "{hits} of {intervals}");
}

/// Without times a drift is a change from run to run: at the middle of the runs 15·(exp(−0.5/2) − exp(−4.5/2)) = 10.1 µm.
#[test]
fn without_times_a_drift_is_a_change_from_run_to_run() {
    let drift = Drift { amplitude_um: 15.0, um_per_m: 0.0, time_constant_s: 2.0 * RUN_S };
    let analysis = warm(drift).analysed(5, false);
    let found = effect(&analysis, "thermal_drift").unwrap();
    assert!(!found.parameters.contains_key("time_constant_s"), "{found:?}");
    assert!((found.value("amplitude_um").unwrap() - 10.1).abs() < 0.6, "{found:?}");
    assert!((found.value("um_per_run").unwrap() - 2.5).abs() < 0.2, "{found:?}");
}

#[test]
fn an_axis_that_grows_is_told_from_one_that_moves() {
    let drift = Drift { amplitude_um: 0.0, um_per_m: 60.0, time_constant_s: 2.0 * RUN_S };
    let analysis = warm(drift).analysed(2, true);
    let found = effect(&analysis, "thermal_growth").unwrap();
    assert!((found.value("um_per_m").unwrap() / 60.0 - 1.0).abs() < 0.15, "{found:?}");
    assert!(found.rivals.contains(&"air_temperature"));
}

/// Runs 4 and 5 of a drift, predicted from runs 1 to 3: nearer than a table of means.
#[test]
fn a_drift_goes_on_in_runs_that_were_not_fitted() {
    for seed in 0..10 {
        let drift = Drift { amplitude_um: 15.0, um_per_m: 20.0, time_constant_s: 3.0 * RUN_S };
        let table = warm(drift).table(seed, false);
        let runs = |is: &dyn Fn(char) -> bool| {
            let lines: Vec<&str> =
                table.lines().filter(|line| line.starts_with('r') || line.starts_with(is)).collect();
            readings::of_text(&lines.join("\n"), "x.csv", &Request::default(), Vec::new()).unwrap()
        };
        let analysis = analyse(runs(&|c| c < '4'), vec![runs(&|c| c > '3')], &options()).unwrap();
        let residual = analysis.residual;
        let [after, table] = [residual.after, residual.table].map(|of| of.validate.unwrap());
        assert!(after < 0.4 * table && after < 1.5, "{seed}: {residual:?}");
        let found = effect(&analysis, "thermal_drift").unwrap();
        assert!(found.validate_reduction_percent.unwrap() > 30.0, "{found:?}");
    }
}
