//! A motor reading that stands: a dead encoder, or an axis that has not moved.

use super::*;

/// Far behind its command, without feed-forward, a motor dwells at its turning point while the command is on its way back:
/// that is no dead encoder, at any limit from 0.1 mm on.
#[test]
fn a_motor_that_turns_round_behind_its_command_is_not_frozen() {
    for (limit, feed) in [(1e-4, 0.15), (3e-4, 0.15), (3e-4, 0.3), (1e-3, 0.3)] {
        for acceleration in [1.0, 5.0] {
            let settings = AxisSettings {
                position_gain_per_s: 20.0,
                following_error_limit_m: 0.1,
                frozen_encoder_limit_m: Some(limit),
                fastest_m_per_s: None,
                sensors: Sensors::Motor,
                ..axis()
            };
            let mut bench = Bench::<f64>::new(&settings);
            bench.run(16_000);
            for x in [0.3003, 0.2, 0.3, 0.2] {
                bench.machine.push(&Block::line([x, 0.1], feed, acceleration)).unwrap();
            }
            bench.run(24_000);
            assert_eq!(bench.machine.power(), Power::On, "{limit} m, {feed} m/s, {acceleration} m/s²");
            assert!((bench.motor_m[0] - 0.2).abs() < 1e-5, "{}", bench.motor_m[0]);
        }
    }
}

/// A motor reading that stands while the axis is to move: the drives go off before the axis has run away. The command
/// is at 0.1 mm after √(2·0.1 mm/2 m/s²) = 10 ms; the mass, which nobody sees, has gone no further than a force that
/// grows to the limit in no time takes it: F/2m·t² = 400/100·(10 ms)² = 0.4 mm, where the following error of 10 mm
/// alone would have let it run for 0.1 s and 40 mm.
#[test]
fn a_frozen_encoder_puts_the_drives_off() {
    for toggles in [0.0, 0.5e-6] {
        let settings = AxisSettings {
            sensors: Sensors::Motor,
            force_limit_n: 400.0,
            frozen_encoder_limit_m: Some(1e-4),
            scale_disagreement_limit_m: None,
            feedforward_percent: 100.0,
            ..axis()
        };
        let mut machine = Machine::<Fixed, 1>::new(RATES, &[settings], [Position(0)]).unwrap();
        machine.push(&Block::line([0.1], 0.1, 2.0)).unwrap();
        machine.enable();
        let (mut velocity, mut place, mut ticks) = (0.0, 0.0, 0u32);
        loop {
            // With one wire broken the counter goes to and fro between two counts.
            let shown = Position::from_m(if ticks % 2 == 0 { 0.0 } else { toggles }).unwrap();
            let force = machine.tick(&[Reading { motor: shown, table: None }]).forces[0].value();
            if !machine.power().is_on() {
                break;
            }
            velocity += force / 50.0 / RATE_HZ;
            place += velocity / RATE_HZ;
            ticks += 1;
            assert!(ticks < 400, "{place} m");
        }
        assert_eq!(machine.power(), Power::Faulted(on(0, FaultKind::EncoderFrozen)));
        // 10 ms are 40 ticks.
        assert!((39..=42).contains(&ticks), "{ticks}");
        assert!(place < 0.4e-3, "{place} m");
    }
}

/// A motor that follows late, against friction that holds it for a while at each start, is not frozen.
#[test]
fn an_encoder_that_moves_is_not_frozen() {
    let settings = AxisSettings { frozen_encoder_limit_m: Some(1e-4), ..axis() };
    let mut bench = Bench::<Fixed>::new(&settings);
    for x in [0.1, 0.2, 0.0] {
        bench.run(12_000);
        bench.machine.push(&Block::line([x, 0.05], 0.1, 2.0)).unwrap();
    }
    bench.run(12_000);
    assert_eq!(bench.machine.power(), Power::On);
}
