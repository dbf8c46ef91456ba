//! Soft limits: a path stops there, an axis outside its travel can move back, and a block that leaves the travel is rejected.

use super::*;

/// The path passes the soft limit of the first axis. Both axes continue along the line for at most v²/2a; then the drives are
/// switched off.
#[test]
fn a_soft_limit_stops_along_the_path() {
    let mut plant = TestPlant::<Fixed>::new(&axis());
    plant.run(1);
    // The travel is reduced during the motion: a block that leaves it would have been rejected.
    plant.machine.change(0, &AxisSettings { travel_m: Some([-0.01, 0.08]), ..axis() }).unwrap();
    let mut commands = Vec::new();
    let mut stopping = 0;
    while plant.machine.power() == Power::Off || plant.machine.power().is_on() {
        commands.push(plant.tick().commands);
        stopping += u32::from(matches!(plant.machine.power(), Power::Stopping(_)));
        assert!(commands.len() < 20_000);
    }
    assert_eq!(plant.machine.power(), Power::Faulted(on(0, FaultKind::SoftLimit)));
    // 0.1 m/s at 4 m/s²: 25 ms or 100 ticks, plus one for the detection; 1.25 mm along the path, 1.12 mm along x.
    assert!((98..=102).contains(&stopping), "{stopping}");
    let [x, _] = commands[commands.len() - 2].map(Position::to_m);
    assert!(x > 0.08 + 1.0e-3 && x < 0.08 + 1.2e-3, "{x}");
    for [x, y] in commands[..commands.len() - 1].iter().map(|point| point.map(Position::to_m)) {
        assert!((x / 2.0 - y).abs() < 1e-9, "({x}, {y}) is not on the line");
    }
}

#[test]
fn soft_limits_are_monitored_while_the_scale_is_lost() {
    for sensors in [Sensors::Table(LIMITS), Sensors::Dual { time_constant_s: 0.05, limits: LIMITS }] {
        let mut plant = TestPlant::<Fixed>::new(&AxisSettings { sensors, ..axis() });
        plant.run(100);
        // The travel is reduced during the motion: a block that leaves it would have been rejected.
        let narrow = AxisSettings { sensors, travel_m: Some([-0.01, 0.05]), ..axis() };
        plant.machine.change(0, &narrow).unwrap();
        plant.scale = false;
        let warned = plant.tick().warning;
        assert_eq!(warned, Some(on(0, FaultKind::ScaleLost)));
        let mut x = 0.0;
        plant.until_off(|plant, output| {
            if plant.machine.power().is_on() {
                x = output.commands[0].to_m();
            }
            assert!(x < 0.06, "{x}");
        });
        assert_eq!(plant.machine.power(), Power::Faulted(on(0, FaultKind::SoftLimit)));
        // 0.1 m/s at 4 m/s²: 1.25 mm along the path, 1.12 mm along x, plus 22 µm for the tick of the detection.
        assert!(x > 0.05 + 1.0e-3 && x < 0.05 + 1.2e-3, "{x}");
    }
}

#[test]
fn a_lost_scale_and_a_soft_limit_in_the_same_tick_are_both_reported() {
    let mut plant = TestPlant::<Fixed>::new(&axis());
    plant.run(2000);
    plant.machine.change(0, &AxisSettings { travel_m: Some([-0.01, 0.0]), ..axis() }).unwrap();
    plant.scale = false;
    let output = plant.tick();
    assert_eq!(plant.machine.power(), Power::Stopping(on(0, FaultKind::SoftLimit)));
    assert_eq!(output.warning, Some(on(0, FaultKind::ScaleLost)));
}

/// After a soft limit the axis is enabled where it stopped. Blocks that lead further out are rejected, blocks that lead
/// inwards are accepted; the limit follows the axis inwards.
#[test]
fn an_axis_outside_its_travel_can_move_back_but_no_further_out() {
    let narrow = AxisSettings { travel_m: Some([-0.01, 0.05]), ..axis() };
    let mut plant = TestPlant::<Fixed>::new(&axis());
    plant.run(100);
    plant.machine.change(0, &narrow).unwrap();
    plant.until_off(|_, _| {});
    assert_eq!(plant.machine.power(), Power::Faulted(on(0, FaultKind::SoftLimit)));
    plant.run(4000);
    plant.machine.disable();
    plant.run(10);
    plant.machine.enable();
    plant.run(400);
    // The axis holds its position outside the travel.
    assert_eq!(plant.machine.power(), Power::On);
    let outside = plant.motor_m[0];
    assert!(outside > 0.0505, "{outside}");
    let line = |x| Block::line([x, 0.0], 0.05, 2.0);
    assert_eq!(plant.machine.push(&line(outside + 1e-3)), Err(PathError::BeyondTravel { axis: 0 }));
    plant.machine.push(&line(0.0502)).unwrap();
    plant.run(8000);
    assert_eq!(plant.machine.power(), Power::On);
    assert!((plant.motor_m[0] - 0.0502).abs() < 1e-5, "{}", plant.motor_m[0]);
    // The limit has followed the axis.
    assert_eq!(plant.machine.push(&line(0.0504)), Err(PathError::BeyondTravel { axis: 0 }));
    plant.machine.push(&line(0.04)).unwrap();
    plant.run(8000);
    assert_eq!(plant.machine.power(), Power::On);
    assert_eq!(plant.machine.push(&line(0.0501)), Err(PathError::BeyondTravel { axis: 0 }));
}

#[test]
fn a_block_that_leaves_the_travel_is_rejected() {
    let bounded = AxisSettings { travel_m: Some([-0.01, 0.3]), ..axis() };
    let mut plant = TestPlant::<Fixed>::new(&bounded);
    let beyond = |axis| Err(PathError::BeyondTravel { axis });
    let mut push = |block: Block<2>| plant.machine.push(&block);
    // The queue ends at (0.2, 0.1).
    assert_eq!(push(Block::line([0.301, 0.1], 0.1, 1.0)), beyond(0));
    assert_eq!(push(Block::line([0.2, -0.011], 0.1, 1.0)), beyond(1));
    // Arcs from (0.25, 0.1) with a radius of 0.06 m pass (0.31, 0.16) in + direction, and (0.19, 0.16) in − direction.
    assert_eq!(push(Block::line([0.25, 0.1], 0.1, 1.0)), Ok(()));
    assert_eq!(push(Block::arc([0, 1], [0.25, 0.16], 0.5, 0.1, 1.0)), beyond(0));
    assert_eq!(push(Block::arc([0, 1], [0.25, 0.16], 0.2, 0.1, 1.0)), beyond(0));
    assert_eq!(push(Block::arc([0, 1], [0.25, 0.16], -0.5, 0.1, 1.0)), Ok(()));
    // From (0.25, 0.22), a radius of 0.09 m about (0.16, 0.22) reaches y = 0.31, outside; 0.05 m about (0.2, 0.22) reaches
    // (0.2, 0.27), inside.
    assert_eq!(push(Block::arc([0, 1], [0.16, 0.22], 0.25, 0.1, 1.0)), beyond(1));
    assert_eq!(push(Block::arc([0, 1], [0.2, 0.22], 1.0, 0.1, 1.0)), Ok(()));
}

/// With every axis filter, a line that ends exactly on a soft limit, or further in when the axis was enabled outside its
/// travel, is completed without a fault.
#[test]
fn a_block_that_ends_on_a_soft_limit_is_completed_with_every_filter() {
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
            sensors: Sensors::MOTOR,
            saturation_time_s: 100.0,
            ..axis()
        };
        let start = position(0.0601);
        let mut machine = Machine::<f64, 1>::new(RATES, &[settings], [start]).unwrap();
        let mut at = start;
        machine.tick(&[Reading { motor: at, table: None }]);
        machine.enable();
        // Two points outside, then the two ends in turn with points between them, at lengths that give various remainders in
        // the filters.
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
            assert_eq!(at, position(x), "{smoothing:?}");
        }
    }
}

#[test]
fn a_path_that_is_stopping_rejects_blocks() {
    let mut plant = TestPlant::<Fixed>::new(&axis());
    plant.run(2000);
    plant.machine.fault(on(0, FaultKind::SoftLimit));
    assert_eq!(plant.machine.power(), Power::Stopping(on(0, FaultKind::SoftLimit)));
    assert_eq!(plant.machine.push(&Block::line([0.0, 0.0], 0.1, 1.0)), Err(PathError::Interrupted));
}
