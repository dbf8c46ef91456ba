//! The ends of the travel: a path stops there, an axis beyond them goes back, and what leads out is not taken.

use super::*;

/// The soft limit of the first axis is crossed on the way: the path goes on along its line for v²/2a at the
/// most, both axes on it, and the drives go off once it stands.
#[test]
fn a_soft_limit_stops_along_the_path() {
    let mut bench = Bench::<Fixed>::new(&axis());
    bench.run(1);
    // Narrowed under way: a block that leads out of the travel would not have been taken.
    bench.machine.change(0, &AxisSettings { travel_m: Some([-0.01, 0.08]), ..axis() }).unwrap();
    let mut commands = Vec::new();
    let mut stopping = 0;
    while bench.machine.power() == Power::Off || bench.machine.power().is_on() {
        commands.push(bench.tick().commands);
        stopping += u32::from(matches!(bench.machine.power(), Power::Stopping(_)));
        assert!(commands.len() < 20_000);
    }
    assert_eq!(bench.machine.power(), Power::Faulted(on(0, FaultKind::SoftLimit)));
    // 0.1 m/s at 4 m/s² is 25 ms: 100 ticks, one more to see it; 1.25 mm of path, 1.12 mm of x.
    assert!((98..=102).contains(&stopping), "{stopping}");
    let [x, _] = commands[commands.len() - 2].map(Position::to_m);
    assert!(x > 0.08 + 1.0e-3 && x < 0.08 + 1.2e-3, "{x}");
    for [x, y] in commands[..commands.len() - 1].iter().map(|point| point.map(Position::to_m)) {
        assert!((x / 2.0 - y).abs() < 1e-9, "off the line at {x}, {y}");
    }
}

/// A scale that is lost does not hide the soft limit: 0.05 m of travel, and the command stops behind them within v²/2a.
#[test]
fn a_lost_scale_leaves_the_soft_limits_on() {
    for sensors in [Sensors::Table, Sensors::Dual { time_constant_s: 0.05 }] {
        let mut bench = Bench::<Fixed>::new(&AxisSettings { sensors, ..axis() });
        bench.run(100);
        // Narrowed under way: a block beyond it would not have been taken.
        let narrow = AxisSettings { sensors, travel_m: Some([-0.01, 0.05]), ..axis() };
        bench.machine.change(0, &narrow).unwrap();
        bench.scale = false;
        let warned = bench.tick().warning;
        assert_eq!(warned, Some(on(0, FaultKind::ScaleLost)));
        let mut x = 0.0;
        bench.until_off(|bench, output| {
            if bench.machine.power().is_on() {
                x = output.commands[0].to_m();
            }
            assert!(x < 0.06, "{x}");
        });
        assert_eq!(bench.machine.power(), Power::Faulted(on(0, FaultKind::SoftLimit)));
        // 0.1 m/s of path at 4 m/s² are 1.25 mm of path, 1.12 mm of x; a tick of 22 µm to see it.
        assert!(x > 0.05 + 1.0e-3 && x < 0.05 + 1.2e-3, "{x}");
    }
}

/// A scale that is lost in the tick in which the command leaves the travel: the stop and the warning are both there.
#[test]
fn a_lost_scale_and_a_soft_limit_in_one_tick_are_both_told() {
    let mut bench = Bench::<Fixed>::new(&axis());
    bench.run(2000);
    bench.machine.change(0, &AxisSettings { travel_m: Some([-0.01, 0.0]), ..axis() }).unwrap();
    bench.scale = false;
    let output = bench.tick();
    assert_eq!(bench.machine.power(), Power::Stopping(on(0, FaultKind::SoftLimit)));
    assert_eq!(output.warning, Some(on(0, FaultKind::ScaleLost)));
}

/// After a soft limit the axis comes on where it stopped, is refused any further out, and goes back under power. What
/// it has come back by is closed behind it.
#[test]
fn an_axis_beyond_its_travel_goes_back_and_no_further_out() {
    let narrow = AxisSettings { travel_m: Some([-0.01, 0.05]), ..axis() };
    let mut bench = Bench::<Fixed>::new(&axis());
    bench.run(100);
    bench.machine.change(0, &narrow).unwrap();
    bench.until_off(|_, _| {});
    assert_eq!(bench.machine.power(), Power::Faulted(on(0, FaultKind::SoftLimit)));
    bench.run(4000);
    bench.machine.disable();
    bench.run(10);
    bench.machine.enable();
    bench.run(400);
    // It holds outside, under power.
    assert_eq!(bench.machine.power(), Power::On);
    let outside = bench.motor_m[0];
    assert!(outside > 0.0505, "{outside}");
    let line = |x| Block::line([x, 0.0], 0.05, 2.0);
    assert_eq!(bench.machine.push(&line(outside + 1e-3)), Err(PathError::BeyondTravel { axis: 0 }));
    bench.machine.push(&line(0.0502)).unwrap();
    bench.run(8000);
    assert_eq!(bench.machine.power(), Power::On);
    assert!((bench.motor_m[0] - 0.0502).abs() < 1e-5, "{}", bench.motor_m[0]);
    // Where it has been is outside now.
    assert_eq!(bench.machine.push(&line(0.0504)), Err(PathError::BeyondTravel { axis: 0 }));
    bench.machine.push(&line(0.04)).unwrap();
    bench.run(8000);
    assert_eq!(bench.machine.power(), Power::On);
    assert_eq!(bench.machine.push(&line(0.0501)), Err(PathError::BeyondTravel { axis: 0 }));
}

#[test]
fn a_block_beyond_the_travel_is_refused_before_it_starts() {
    let bounded = AxisSettings { travel_m: Some([-0.01, 0.3]), ..axis() };
    let mut bench = Bench::<Fixed>::new(&bounded);
    let beyond = |axis| Err(PathError::BeyondTravel { axis });
    let mut push = |block: Block<2>| bench.machine.push(&block);
    // The path stands at (0.2, 0.1) so far.
    assert_eq!(push(Block::line([0.301, 0.1], 0.1, 1.0)), beyond(0));
    assert_eq!(push(Block::line([0.2, -0.011], 0.1, 1.0)), beyond(1));
    // Half circles upwards from (0.25, 0.1) with 0.06 m: by the right they pass (0.31, 0.16), by the left (0.19, 0.16).
    assert_eq!(push(Block::line([0.25, 0.1], 0.1, 1.0)), Ok(()));
    assert_eq!(push(Block::arc([0, 1], [0.25, 0.16], 0.5, 0.1, 1.0)), beyond(0));
    assert_eq!(push(Block::arc([0, 1], [0.25, 0.16], 0.2, 0.1, 1.0)), beyond(0));
    assert_eq!(push(Block::arc([0, 1], [0.25, 0.16], -0.5, 0.1, 1.0)), Ok(()));
    // From (0.25, 0.22) on round (0.2, 0.22): up to (0.2, 0.27), which fits; with 0.09 m, to y = 0.31, it does not.
    assert_eq!(push(Block::arc([0, 1], [0.16, 0.22], 0.25, 0.1, 1.0)), beyond(1));
    assert_eq!(push(Block::arc([0, 1], [0.2, 0.22], 1.0, 0.1, 1.0)), Ok(()));
}

/// What is taken is travelled: a line that ends on either end of the travel, or inside of an axis that came on beyond it, is
/// no soft limit, whatever filter is behind the path.
#[test]
fn a_block_that_ends_on_the_travel_is_travelled_behind_every_filter() {
    let filters = [
        Smoothing::None,
        Smoothing::Trapezoid { time_s: 0.02 },
        Smoothing::Trapezoid { time_s: 3.0 / RATE_HZ },
        Smoothing::SCurve { time_s: 0.02, jerk_time_s: 0.007 },
        Smoothing::Exponential { time_constant_s: 0.01 },
    ];
    for smoothing in filters {
        let settings = AxisSettings {
            smoothing,
            travel_m: Some([-0.05, 0.05]),
            sensors: Sensors::Motor,
            saturation_time_s: 100.0,
            ..axis()
        };
        let start = place(0.0601);
        let mut machine = Machine::<f64, 1>::new(RATES, &[settings], [start]).unwrap();
        let mut at = start;
        machine.tick(&[Reading { motor: at, table: None }]);
        machine.enable();
        // Beyond, then each time on an end, from either side, at lengths that leave all kinds of remainders.
        let inside =
            (1..60).flat_map(|k: i32| [-0.05, 1e-3 * f64::from(k) / 7.0, 0.05, 1e-4 / 3.0 * f64::from(k)]);
        for x in [0.0571, 0.0533].into_iter().chain(inside) {
            machine.push(&Block::line([x], 0.1, 20.0)).unwrap();
            for _ in 0..8000 {
                let output = machine.tick(&[Reading { motor: at, table: None }]);
                at = output.commands[0];
                if output.done {
                    break;
                }
            }
            assert_eq!(machine.power(), Power::On, "{smoothing:?} to {x}");
            assert_eq!(at, place(x), "{smoothing:?}");
        }
    }
}

#[test]
fn a_path_that_stops_takes_no_block() {
    let mut bench = Bench::<Fixed>::new(&axis());
    bench.run(2000);
    bench.machine.fault(on(0, FaultKind::SoftLimit));
    assert_eq!(bench.machine.power(), Power::Stopping(on(0, FaultKind::SoftLimit)));
    assert_eq!(bench.machine.push(&Block::line([0.0, 0.0], 0.1, 1.0)), Err(PathError::Interrupted));
}
