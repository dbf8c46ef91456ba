//! Tables over the travel are evaluated one per command of the machine, and wait for a limited number of long ticks.

use shared::compensate::machine::MAX_WAIT;

use super::*;

/// The tick, counted from 1, in which the correction of an axis follows a step of both commands in the first.
fn ticks_to_correction(axis: usize, is_long_tick: bool) -> usize {
    let rising = points(-0.3, 0.01, |x| 10e-6 * x);
    let settings = CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Scale, forward: rising, backward: None }),
        position_rate_m_per_s: 0.1,
        ..CompensationSettings::default()
    };
    let mut all = Compensation::<Fixed, 2>::none([position(0.0); 2]);
    for axis in 0..2 {
        all.replace(axis, &AxisCompensation::new(&settings, RATES, AxisOf { axis, axes: 2 }).unwrap());
    }
    let stepped = [position(0.1); 2];
    let ticks = (1..100).find(|_| {
        all.advance(&stepped, is_long_tick);
        all.correct_commands();
        // The error at 0.1 m is 1 µm; at zero, the rounding of the table.
        all.active_corrections()[axis].total.value() > 0.5
    });
    ticks.unwrap()
}

#[test]
fn one_table_of_the_machine_is_evaluated_with_each_command() {
    assert_eq!([0, 1].map(|axis| ticks_to_correction(axis, false)), [1, 2]);
}

/// However many ticks in succession take long: one of `MAX_WAIT` + 1 evaluates a table.
#[test]
fn long_ticks_delay_a_table_by_a_limited_number() {
    let turn = usize::from(MAX_WAIT) + 1;
    assert_eq!([0, 1].map(|axis| ticks_to_correction(axis, true)), [turn, 2 * turn]);
}
