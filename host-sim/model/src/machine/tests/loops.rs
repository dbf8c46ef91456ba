//! Tests of the keys of filters and limits.

use super::*;

/// Keys that are added to axis y of [`MACHINE`].
const LOOPS: &str = "smoothing_s = 0.02
smoothing_jerk_s = 0.005
notch_frequency_hz = 120
notch_width_hz = 30.5
notch_depth = 0.9
low_pass_frequency_hz = 800.0
low_pass_damping_ratio = 0.7
travel_mm = [-200, 310.5]
stop_deceleration_m_per_s2 = 3.0
saturation_time_s = 0.25
scale_disagreement_limit_mm = 0.4
fastest_mm_per_s = 900.0
frozen_encoder_limit_mm = 0.3
";

/// [`MACHINE`] with additional keys in axis y.
fn with(loops: &str) -> String {
    MACHINE.replacen("controller = ", &format!("{loops}controller = "), 1)
}

#[test]
fn filters_and_limits_are_converted_to_the_units_of_the_controller() {
    use shared::config::{LowPass, Notch, Notches};
    use shared::interpolate::Smoothing;

    let settings = |text: &str| {
        let machine = Machine::parse(text, "m.toml").unwrap();
        assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
        let axis = &machine.axis["y"];
        crate::servo::settings(&axis.settings, &crate::servo::ServoParameters::of(&axis.effect)).unwrap()
    };
    let given = settings(&with(LOOPS));
    assert_eq!(given.smoothing, Smoothing::SCurve { time_s: 0.02, jerk_time_s: 0.005 });
    let notch = Notch { frequency_hz: 120.0, width_hz: 30.5, depth: 0.9 };
    assert_eq!(given.notches, Notches([Some(notch), None, None, None]));
    assert_eq!(given.low_pass, Some(LowPass { frequency_hz: 800.0, damping_ratio: 0.7 }));
    let close = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-12, "{found} {wanted}");
    let [least, greatest] = given.travel_m.unwrap();
    close(least, -0.2);
    close(greatest, 0.3105);
    close(given.stop_deceleration_m_per_s2, 3.0);
    close(given.saturation_time_s, 0.25);
    close(given.sensors.scale_disagreement_limit_m().unwrap(), 0.4e-3);
    close(given.sensors.frozen_encoder_limit_m().unwrap(), 0.3e-3);
    close(given.fastest_m_per_s.unwrap(), 0.9);

    let trapezoid = settings(&with("smoothing_s = 0.02\n"));
    assert_eq!(trapezoid.smoothing, Smoothing::Trapezoid { time_s: 0.02 });
    let lag = settings(&with("smoothing_time_constant_s = 0.03\n"));
    assert_eq!(lag.smoothing, Smoothing::Exponential { time_constant_s: 0.03 });

    let (none, default) = (settings(MACHINE), shared::config::AxisSettings::default());
    assert_eq!((none.smoothing, none.notches, none.low_pass), (Smoothing::None, Notches::NONE, None));
    assert_eq!((none.travel_m, none.fastest_m_per_s), (None, None));
    close(none.stop_deceleration_m_per_s2, default.stop_deceleration_m_per_s2);
    close(none.saturation_time_s, default.saturation_time_s);
}

/// Points over position or speed, in m and m/s; a file is written as it was read.
#[test]
fn an_axis_has_a_gain_schedule() {
    use shared::config::{GainSchedule, SchedulePoint, ScheduledOver};
    for (key, over) in [
        ("gain_schedule_position_mm", ScheduledOver::Position),
        ("gain_schedule_speed_mm_per_s", ScheduledOver::Speed),
    ] {
        let keys = format!("{key} = [20, 60.5, 100]\ngain_schedule_ratio = [1, 2, 0.5]\n");
        let machine = Machine::parse(&with(&keys), "m.toml").unwrap();
        assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
        let points = [(0.02, 1.0), (0.0605, 2.0), (0.1, 0.5)].map(|(at, ratio)| SchedulePoint { at, ratio });
        let found = crate::servo::gain_schedule(&machine.axis["y"].settings.schedule);
        assert_eq!(found, GainSchedule::of(over, points));
    }
}

/// The bandwidth of the observer is a setting of the controller; without it the velocity is the difference.
#[test]
fn an_axis_has_an_observer_of_its_velocity() {
    use shared::config::VelocitySource;
    let machine = Machine::parse(&with("velocity_observer_hz = 300.5\n"), "m.toml").unwrap();
    assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
    let source = |machine: &Machine| {
        crate::servo::settings(&machine.axis["y"].settings, &Default::default()).unwrap().velocity_source
    };
    assert_eq!(source(&machine), VelocitySource::Observer { bandwidth_hz: 300.5 });
    assert_eq!(source(&Machine::parse(MACHINE, "m.toml").unwrap()), VelocitySource::Difference);
}

/// Each notch has its number of each key; a file is written as it was read.
#[test]
fn an_axis_has_several_notches() {
    use shared::config::{Notch, Notches};
    let keys = "notch_frequency_hz = [300, 120.5]\nnotch_width_hz = [60, 30]\nnotch_depth = [0.9, 1]\n";
    let machine = Machine::parse(&with(keys), "m.toml").unwrap();
    assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
    let filters = &machine.axis["y"].settings.filters;
    let expected = [
        Notch { frequency_hz: 300.0, width_hz: 60.0, depth: 0.9 },
        Notch { frequency_hz: 120.5, width_hz: 30.0, depth: 1.0 },
    ];
    let [first, second] = expected.map(Some);
    assert_eq!(crate::servo::notches(filters), Notches([first, second, None, None]));
    assert_eq!(&filters.with_notches(&expected), filters);
}

/// A brake has both times, or there is none; a preload of zero is not an unknown one.
#[test]
fn brake_and_preload_are_settings_of_the_controller() {
    use shared::config::Brake;
    let settings = |text: &str| {
        let machine = Machine::parse(&with(text), "m.toml").unwrap();
        assert_eq!(Machine::parse(&machine.to_toml(), "again.toml").unwrap(), machine);
        let axis = &machine.axis["y"];
        crate::servo::settings(&axis.settings, &crate::servo::ServoParameters::of(&axis.effect)).unwrap()
    };
    let given = settings("preload_n = -147.0\nbrake_release_s = 0.06\nbrake_engage_s = 0\n");
    assert_eq!(given.brake, Some(Brake { release_s: 0.06, engage_s: 0.0 }));
    assert_eq!(given.preload_n, Some(-147.0));
    assert_eq!(settings("preload_n = 0\n").preload_n, Some(0.0));
    let none = settings("");
    assert_eq!((none.brake, none.preload_n), (None, None));
}

/// A loop with a scale has limits of its readings, declared or not; a loop on the motor has those that are declared.
#[test]
fn a_loop_with_a_scale_has_limits_without_their_keys() {
    use shared::config::{ScaleLimits, Sensors};

    let sensors = |text: &str| {
        let machine = Machine::parse(text, "m.toml").unwrap();
        let axis = &machine.axis["y"];
        crate::servo::settings(&axis.settings, &crate::servo::ServoParameters::default()).unwrap().sensors
    };
    assert!(matches!(sensors(MACHINE), Sensors::Dual { limits, .. } if limits == ScaleLimits::DEFAULT));
    let table = MACHINE.replace("feedback = \"dual\"", "feedback = \"table\"");
    assert_ne!(table, MACHINE);
    assert_eq!(sensors(&table), Sensors::Table(ScaleLimits::DEFAULT));
    let motor = MACHINE.replace("feedback = \"dual\"", "feedback = \"motor\"");
    assert_eq!(sensors(&motor), Sensors::MOTOR);
    // 0.25 mm is less than the 0.4 mm that hold otherwise.
    let narrow = sensors(&with("following_error_limit_mm = 0.25\n"));
    assert_eq!(narrow.frozen_encoder_limit_m(), Some(0.25e-3));
    assert_eq!(narrow.scale_disagreement_limit_m(), Some(0.5e-3));
}

/// Keys and the expected error. The sample rate is 1 kHz, the rate of the velocity loop 4 kHz.
const BAD_LOOPS: &[(&str, &str)] = &[
    ("smoothing_s = 0", "line 6: axis.y.smoothing_s: expected a number above 0, found 0"),
    ("smoothing_s = 0.0014", "axis.y.smoothing_s: expected two samples (0.002 s) or more, found 0.0014"),
    (
        "smoothing_s = 0.513",
        "axis.y.smoothing_s: expected at most 512 samples (0.512 s) including smoothing_jerk_s",
    ),
    ("smoothing_jerk_s = 0.01", "line 5: axis.y.smoothing_s: expected a value beside smoothing_jerk_s"),
    (
        "smoothing_s = 0.01\nsmoothing_jerk_s = 0.02",
        "line 7: axis.y.smoothing_jerk_s: expected a time no longer than smoothing_s, found 0.02",
    ),
    (
        "smoothing_s = 0.3\nsmoothing_jerk_s = 0.3",
        "line 6: axis.y.smoothing_s: expected at most 512 samples (0.512 s) including smoothing_jerk_s, found 0.3",
    ),
    (
        "smoothing_s = 0.3\nsmoothing_time_constant_s = 0.3",
        "line 7: axis.y.smoothing_time_constant_s: expected no such key, as smoothing_s is given, found 0.3",
    ),
    ("smoothing_time_constant_s = 2e3", "expected a time of at most a million samples, found 2e3"),
    ("velocity_observer_hz = 0", "axis.y.velocity_observer_hz: expected a number above 0, found 0"),
    (
        "velocity_observer_hz = 1001",
        "line 6: axis.y.velocity_observer_hz: expected a number from 4 to 1000, found 1001",
    ),
    (
        "gain_schedule_ratio = [1, 2]",
        "axis.y.gain_schedule_position_mm: expected a value beside gain_schedule_ratio",
    ),
    (
        "gain_schedule_speed_mm_per_s = [1, 2]",
        "axis.y.gain_schedule_ratio: expected a value beside gain_schedule_speed_mm_per_s",
    ),
    (
        "gain_schedule_position_mm = [1, 2]\ngain_schedule_speed_mm_per_s = [1, 2]\ngain_schedule_ratio = [1, 2]",
        "line 7: axis.y.gain_schedule_speed_mm_per_s: expected no such key, as gain_schedule_position_mm is given",
    ),
    (
        "gain_schedule_position_mm = [1]\ngain_schedule_ratio = [1]",
        "line 6: axis.y.gain_schedule_position_mm: expected 2 to 6 numbers",
    ),
    (
        "gain_schedule_position_mm = [1, 2, 3, 4, 5, 6, 7]\ngain_schedule_ratio = [1, 1, 1, 1, 1, 1, 1]",
        "line 6: axis.y.gain_schedule_position_mm: expected 2 to 6 numbers",
    ),
    (
        "gain_schedule_position_mm = [1, 5]\ngain_schedule_ratio = [1, 1, 1]",
        "line 7: axis.y.gain_schedule_ratio: expected as many numbers as gain_schedule_position_mm has",
    ),
    (
        "gain_schedule_position_mm = [1, 5]\ngain_schedule_ratio = [1, 5]",
        "line 7: axis.y.gain_schedule_ratio: expected numbers from 0.25 to 4",
    ),
    (
        "gain_schedule_position_mm = [5, 1]\ngain_schedule_ratio = [1, 2]",
        "line 6: axis.y.gain_schedule_position_mm: expected ascending numbers, 1 or more apart, up to 100000",
    ),
    (
        "gain_schedule_speed_mm_per_s = [-1, 1]\ngain_schedule_ratio = [1, 2]",
        "line 6: axis.y.gain_schedule_speed_mm_per_s[0]",
    ),
    ("notch_frequency_hz = 100.0", "axis.y.notch_width_hz: expected a value beside notch_frequency_hz"),
    ("notch_depth = 1", "axis.y.notch_frequency_hz: expected a value beside notch_depth, found none"),
    (
        "notch_frequency_hz = 2000\nnotch_width_hz = 10\nnotch_depth = 1",
        "line 6: axis.y.notch_frequency_hz: expected a number from 4 to 1800, found 2000",
    ),
    (
        "notch_frequency_hz = 100\nnotch_width_hz = 401\nnotch_depth = 1",
        "line 7: axis.y.notch_width_hz: expected a number from 0 to 400, found 401",
    ),
    (
        "notch_frequency_hz = [100, 2000]\nnotch_width_hz = [10, 20]\nnotch_depth = [1, 0.5]",
        "line 6: axis.y.notch_frequency_hz[1]: expected a number from 4 to 1800, found 2000",
    ),
    (
        "notch_frequency_hz = [100, 200]\nnotch_width_hz = [10, 20]\nnotch_depth = [1, 1.5]",
        "line 8: axis.y.notch_depth[1]: expected a number from 0 to 1, found 1.5",
    ),
    (
        "notch_frequency_hz = [100, 200]\nnotch_width_hz = [10, 20]\nnotch_depth = 1",
        "line 8: axis.y.notch_depth: expected as many numbers as notch_frequency_hz has, found 1",
    ),
    (
        "notch_frequency_hz = [1, 2, 3, 4, 5]\nnotch_width_hz = 10\nnotch_depth = 1",
        "line 6: axis.y.notch_frequency_hz: expected 1 to 4 numbers, found an array of 5",
    ),
    (
        "notch_frequency_hz = []\nnotch_width_hz = []\nnotch_depth = []",
        "axis.y.notch_frequency_hz: expected 1 to 4 numbers",
    ),
    ("notch_frequency_hz = \"low\"", "axis.y.notch_frequency_hz: expected a number or a list of numbers"),
    ("notch_frequency_hz = [\"low\"]", "axis.y.notch_frequency_hz"),
    ("notch_depth = 1.1", "axis.y.notch_depth: expected a number from 0 to 1, found 1.1"),
    ("low_pass_frequency_hz = 100", "axis.y.low_pass_damping_ratio: expected a value beside low_pass_freq"),
    (
        "low_pass_frequency_hz = 3\nlow_pass_damping_ratio = 0.7",
        "line 6: axis.y.low_pass_frequency_hz: expected a number from 4 to 1800, found 3",
    ),
    (
        "low_pass_frequency_hz = 300\nlow_pass_damping_ratio = 11",
        "line 7: axis.y.low_pass_damping_ratio: expected a number from 0.05 to 10, found 11",
    ),
    ("brake_release_s = 0.1", "axis.y.brake_engage_s: expected a value beside brake_release_s, found none"),
    ("brake_engage_s = 0.1", "axis.y.brake_release_s: expected a value beside brake_engage_s, found none"),
    (
        "brake_release_s = 2.5\nbrake_engage_s = 0.1",
        "axis.y.brake_release_s: expected a number from 0 to 2, found 2.5",
    ),
    (
        "preload_n = -20000.5",
        "axis.y.preload_n: expected a number from -20000 to 20000, the force limit, found -20000.5",
    ),
    ("travel_mm = [1, 1]", "line 6: axis.y.travel_mm[1]: expected a number above the first, found 1"),
    (
        "travel_mm = [-1e6, 1]",
        "axis.y.travel_mm[0]: expected a position within 100000 mm of zero, found -1e6",
    ),
    ("travel_mm = [1]", "axis.y.travel_mm: expected an array of length 2, found an array of 1"),
    ("travel_mm = 5", "axis.y.travel_mm: expected"),
    ("stop_deceleration_m_per_s2 = 0", "stop_deceleration_m_per_s2: expected a number above 0, found 0"),
    ("saturation_time_s = -1", "axis.y.saturation_time_s: expected a number above 0, found -1"),
    ("scale_disagreement_limit_mm = -1", "scale_disagreement_limit_mm: expected a number from 0 to 100000"),
    ("fastest_mm_per_s = 0", "axis.y.fastest_mm_per_s: expected a number above 0, found 0"),
    (
        "frozen_encoder_limit_mm = 500",
        "axis.y.frozen_encoder_limit_mm: expected no more than following_error_limit_mm, ",
    ),
    ("frozen_encoder_limit_mm = 0", "axis.y.frozen_encoder_limit_mm: expected a number above 0, found 0"),
];

#[test]
fn bad_filters_and_limits_are_refused_with_line_key_and_expectation() {
    for (loops, wanted) in BAD_LOOPS {
        let message = Machine::parse(&with(&format!("{loops}\n")), "m.toml").expect_err(wanted).to_string();
        assert!(message.starts_with("m.toml: ") && message.contains(wanted), "{message}\nwanted {wanted}");
        assert!(!message.contains('\n'), "{message}");
    }
    // Without a controller, the keys would have no effect, but for the travel: tables and motions are within it.
    for line in LOOPS.lines() {
        let text = format!("{MACHINE}{line}\n");
        if line.starts_with("travel_mm") {
            Machine::parse(&text, "m.toml").unwrap();
            continue;
        }
        let message = Machine::parse(&text, "m.toml").expect_err(line).to_string();
        let key = line.split(' ').next().unwrap();
        let wanted = format!("axis.x.controller: expected a value beside {key}");
        assert!(message.contains(&wanted), "{message}");
    }
}
