//! Recordings that show nothing are refused by name.

use super::rig::{DECLARED, Rig, SAMPLE_S, wanted};
use crate::anticogging::passes::{PassError, pairs};
use crate::anticogging::plan::Plan;

#[test]
fn passes_at_another_speed_at_the_force_limit_or_with_a_standstill_are_refused() {
    let plan = Plan::new(&wanted(), &DECLARED).unwrap();
    let samples = Rig::quiet(1).run(&plan, 4);
    let refused = |samples: &[_], limit_n| pairs(samples, &plan, 4, (SAMPLE_S, limit_n)).unwrap_err();
    assert_eq!(pairs(&samples, &plan, 4, (SAMPLE_S, Some(200.0))).unwrap().len(), 4);
    // A motion to the start before the passes, as fast as they are, is none of them.
    let from_m = 1e-3 * plan.travel_mm[0];
    let approach = (0..40_000u32).rev().map(|step| {
        let mut sample = samples[0];
        sample.command_m = from_m + f64::from(step) * 1e-3 * plan.speed_mm_per_s * SAMPLE_S;
        sample.motor_m = sample.command_m;
        sample
    });
    let with_approach: Vec<_> = approach.chain(samples.iter().copied()).collect();
    assert_eq!(
        pairs(&with_approach, &plan, 4, (SAMPLE_S, None)).unwrap(),
        pairs(&samples, &plan, 4, (SAMPLE_S, None)).unwrap()
    );
    // The friction of 20 N and the load of 12 N are above 25 N.
    assert!(matches!(refused(&samples, Some(25.0)), PassError::ForceLimit { .. }));
    // At an override of 95 %.
    let slower: Vec<_> = samples
        .iter()
        .map(|sample| {
            let mut sample = *sample;
            sample.command_m *= 0.95;
            sample
        })
        .collect();
    assert!(matches!(refused(&slower, None), PassError::Speed { found: 0, expected: 8, .. }));
    // A pass is missing.
    assert!(matches!(refused(&samples[samples.len() / 4..], None), PassError::Speed { .. }));
    // The motor stands for 0.05 mm and then jumps.
    let sticking: Vec<_> = samples
        .iter()
        .map(|sample| {
            let mut sample = *sample;
            if (0.0..5e-5).contains(&sample.motor_m) {
                sample.motor_m = 0.0;
            }
            sample
        })
        .collect();
    let error = refused(&sticking, None);
    assert!(matches!(error, PassError::Uneven { .. }) && error.to_string().contains("sticks"), "{error}");
}
