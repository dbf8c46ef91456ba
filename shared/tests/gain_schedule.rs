//! The gain schedule of an axis: its force by the equation of the loop, with the ratio of the position tick before; what is refused.

use shared::config::{
    AxisConfig, AxisSettings, ConfigError, GainSchedule, Rates, SCHEDULE_POINTS, SchedulePoint, ScheduledOver,
};
use shared::interpolate::Block;
use shared::machine::{Machine, Reading};
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };
const TICK_S: f64 = 50e-6;
const POSITION_TICK_S: f64 = 250e-6;
const KP_PER_S: f64 = 33.0;
const KV_N_S_PER_M: f64 = 2_000.0;
const TI_S: f64 = 0.2;

fn schedule(over: ScheduledOver, points: &[[f64; 2]]) -> Option<GainSchedule> {
    GainSchedule::of(over, points.iter().map(|&[at, ratio]| SchedulePoint { at, ratio }))
}

fn settings(gain_schedule: Option<GainSchedule>) -> AxisSettings {
    AxisSettings {
        position_gain_per_s: KP_PER_S,
        velocity_gain_n_s_per_m: KV_N_S_PER_M,
        velocity_integral_time_s: Some(TI_S),
        gain_schedule,
        ..AxisSettings::default()
    }
}

/// Straight lines between the points.
fn ratio(points: &[[f64; 2]], x: f64) -> f64 {
    let last = points[points.len() - 1];
    points.windows(2).find(|pair| x < pair[1][0]).map_or(last[1], |pair| {
        let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
        y0 + (y1 - y0) * ((x - x0) / (x1 - x0)).max(0.0)
    })
}

fn standing() -> [Reading; 1] {
    [Reading { motor: Position(0), table: None }]
}

/// Command and force of each tick of a motion by 20 mm while the motor stands.
fn run<S: Scalar>(machine: &mut Machine<S, 1>, ticks: usize) -> Vec<(f64, f64)> {
    machine.enable();
    machine.tick(&standing());
    machine.jog(&Block::line([0.02], 0.1, 1.0)).unwrap();
    (1..ticks)
        .map(|_| {
            let output = machine.tick(&standing());
            assert!(output.enabled, "{:?}", machine.power());
            (output.commands[0].to_m(), output.forces[0].value())
        })
        .collect()
}

/// The greatest difference of the forces from Kv·r·e + Σ Kv·r·e·T/Ti, N, with e = Kp·command, since the motor stands, and a ratio r by the
/// commands before each position tick. And the greatest force.
fn off_the_equation<S: Scalar>(over: ScheduledOver, points: &[[f64; 2]]) -> [f64; 2] {
    let mut machine =
        Machine::<S, 1>::new(RATES, &[settings(schedule(over, points))], [Position(0)]).unwrap();
    let (mut integral, mut r) = (0.0, 1.0);
    let (mut before, mut last) = (0.0, 0.0);
    let [mut worst, mut greatest] = [0.0_f64; 2];
    // The first position tick was that of the enable; the command changes in the fifth tick after it.
    for (tick, (command, force)) in run(&mut machine, 4000).into_iter().enumerate() {
        if (tick + 1) % 5 == 0 {
            r = match over {
                ScheduledOver::Position => ratio(points, last),
                ScheduledOver::Speed => ratio(points, (last - before).abs() / POSITION_TICK_S),
            };
            (before, last) = (last, command);
        }
        let error = KP_PER_S * command;
        integral += KV_N_S_PER_M * r * error * TICK_S / TI_S;
        worst = worst.max((force - (KV_N_S_PER_M * r * error + integral)).abs());
        greatest = greatest.max(force.abs());
    }
    [worst, greatest]
}

const OVER_POSITION: &[[f64; 2]] = &[[0.0, 1.0], [0.002, 0.5], [0.012, 2.0], [0.015, 1.25]];
const OVER_SPEED: &[[f64; 2]] = &[[0.0, 2.0], [0.05, 1.0], [0.09, 0.5]];

/// The integral is kept in N while the gain changes: a loop that scaled it, too, would be off by hundreds of N. Fixed point resolves the velocity error
/// to 2⁻¹⁴ mm/s and Kv to 2⁻²⁴: 7e-6 of 2000 N·s/m.
#[test]
fn the_force_follows_the_equation_of_the_loop_with_the_ratio() {
    for (over, points) in [(ScheduledOver::Position, OVER_POSITION), (ScheduledOver::Speed, OVER_SPEED)] {
        let [worst_n, greatest_n] = off_the_equation::<f64>(over, points);
        assert!(greatest_n > 600.0, "{greatest_n} N");
        assert!(worst_n < 1e-3, "{over:?}: {worst_n} N in f64");
        let [worst_n, _] = off_the_equation::<Fixed>(over, points);
        assert!(worst_n < 1.0, "{over:?}: {worst_n} N in fixed point");
        let [worst_n, _] = off_the_equation::<f32>(over, points);
        assert!(worst_n < 1.0, "{over:?}: {worst_n} N in f32");
    }
}

/// A schedule of one ratio is the loop with Kv times this ratio, to the last bit in fixed point.
#[test]
fn a_constant_ratio_is_another_gain() {
    for over in [ScheduledOver::Position, ScheduledOver::Speed] {
        let scheduled = settings(schedule(over, &[[0.0, 1.5], [0.01, 1.5]]));
        let other = AxisSettings { velocity_gain_n_s_per_m: 1.5 * KV_N_S_PER_M, ..settings(None) };
        let [a, b] = [scheduled, other].map(|settings| {
            let mut machine = Machine::<Fixed, 1>::new(RATES, &[settings], [Position(0)]).unwrap();
            run(&mut machine, 2000).into_iter().map(|(_, force)| force.to_bits()).collect::<Vec<_>>()
        });
        assert_eq!(a, b);
    }
}

/// Whose position is not known has the gain of the settings, from the homing on that of the schedule; over speed the schedule acts at once.
#[test]
fn an_axis_that_is_not_homed_is_not_scheduled_over_position() {
    let force = |over, points: &[[f64; 2]], is_homed: bool| {
        let settings = settings(schedule(over, points));
        let mut machine = Machine::<f64, 1>::new(RATES, &[settings], [Position(0)]).unwrap();
        if !is_homed {
            machine.lose_reference(0);
        }
        run(&mut machine, 1000).last().unwrap().1
    };
    let points: &[[f64; 2]] = &[[0.0, 2.0], [0.01, 2.0]];
    for (over, of_relative) in [(ScheduledOver::Position, 1.0), (ScheduledOver::Speed, 2.0)] {
        let [homed_n, relative_n] = [true, false].map(|is_homed| force(over, points, is_homed));
        assert!((homed_n / relative_n - 2.0 / of_relative).abs() < 1e-3, "{homed_n} N, {relative_n} N");
    }
}

/// Each refusal names the setting with its range; the values beside it are accepted.
#[test]
fn a_schedule_beyond_its_ranges_is_refused_by_name() {
    use ScheduledOver::{Position as OverPosition, Speed as OverSpeed};

    let of = |over, points: &[[f64; 2]]| {
        AxisConfig::<Fixed>::new(
            &AxisSettings { gain_schedule: schedule(over, points), ..AxisSettings::default() },
            RATES,
        )
        .map(|_| ())
        .map_err(|error| ConfigError::name(&error))
    };
    let long: Vec<[f64; 2]> = (0..SCHEDULE_POINTS).map(|k| [0.01 * k as f64, 1.0]).collect();
    assert_eq!(of(OverPosition, &long), Ok(()));
    assert_eq!(schedule(OverPosition, &[long.as_slice(), &[[1.0, 1.0]]].concat()), None);
    for count in [0, 1] {
        assert_eq!(of(OverPosition, &long[..count]), Err("gain_schedule_points"));
    }
    for (least, greatest) in [(0.25, 4.0)] {
        assert_eq!(of(OverSpeed, &[[0.0, least], [0.1, greatest]]), Ok(()));
        for ratio in [0.999 * least, 1.001 * greatest, f64::NAN, -1.0] {
            assert_eq!(of(OverSpeed, &[[0.0, 1.0], [0.1, ratio]]), Err("gain_schedule_ratio"), "{ratio}");
        }
    }
    for (over, name) in [(OverPosition, "gain_schedule_position"), (OverSpeed, "gain_schedule_speed")] {
        assert_eq!(of(over, &[[0.1, 1.0], [0.101, 2.0]]), Ok(()));
        for second in [0.1009, 0.1, 0.0, 101.0, f64::NAN] {
            assert_eq!(of(over, &[[0.1, 1.0], [second, 2.0]]), Err(name), "{second}");
        }
    }
    assert_eq!(of(OverSpeed, &[[-0.001, 1.0], [0.1, 2.0]]), Err("gain_schedule_speed"));
    assert_eq!(of(OverPosition, &[[-0.001, 1.0], [0.1, 2.0]]), Ok(()));
    // Kv itself is within the format, four times of it is not.
    let beyond = AxisSettings {
        velocity_gain_n_s_per_m: 3e6,
        ..settings(schedule(OverSpeed, &[[0.0, 1.0], [0.1, 4.0]]))
    };
    assert_eq!(AxisConfig::<Fixed>::new(&beyond, RATES).unwrap_err().name(), "gain_schedule_ratio");
}

/// A schedule that is changed, set and taken away with the loops of an axis: after each change of the settings the force is that of their
/// ratio for the same following error, Kv·r·e. The offset of the change has gone after 0.6 s, e⁻²⁰.
#[test]
fn a_schedule_is_changed_with_the_loops() {
    let constant = |ratio| schedule(ScheduledOver::Position, &[[-0.1, ratio], [0.1, ratio]]);
    let without_integral =
        |gain_schedule| AxisSettings { velocity_integral_time_s: None, ..settings(gain_schedule) };
    let mut machine = Machine::<f64, 1>::new(RATES, &[without_integral(None)], [Position(0)]).unwrap();
    let (_, base_n) = *run(&mut machine, 20_000).last().unwrap();
    assert!((base_n - KV_N_S_PER_M * KP_PER_S * 0.02).abs() < 1e-6, "{base_n} N");
    for (gain_schedule, ratio) in [(constant(2.0), 2.0), (constant(0.5), 0.5), (None, 1.0)] {
        machine.change(0, &without_integral(gain_schedule)).unwrap();
        let force_n = (0..12_000).map(|_| machine.tick(&standing()).forces[0]).last().unwrap();
        assert!((force_n - ratio * base_n).abs() < 1e-3, "{ratio}: {force_n} N of {base_n} N");
    }
}
