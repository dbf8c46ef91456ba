//! A motor reading that stands still: a frozen encoder, or an axis that has not moved.

use super::*;

const fn motor_alone(frozen_m: f64) -> Sensors {
    Sensors::Motor { scale_disagreement_limit_m: None, frozen_encoder_limit_m: Some(frozen_m) }
}

/// Without feed-forward a motor is far behind its command and dwells at its reversal point while the command already moves
/// back. This must not be reported as a frozen encoder, at limits from 0.1 to 1 mm.
#[test]
fn a_reversal_far_behind_the_command_is_not_a_frozen_encoder() {
    for (limit, feed) in [(1e-4, 0.15), (3e-4, 0.15), (3e-4, 0.3), (1e-3, 0.3)] {
        for acceleration in [1.0, 5.0] {
            let settings = AxisSettings {
                position_gain_per_s: 20.0,
                following_error_limit_m: 0.1,
                fastest_m_per_s: None,
                sensors: motor_alone(limit),
                ..axis()
            };
            let mut plant = TestPlant::<f64>::new(&settings);
            plant.run(16_000);
            for x in [0.3003, 0.2, 0.3, 0.2] {
                plant.machine.push(&Block::line([x, 0.1], feed, acceleration)).unwrap();
            }
            plant.run(24_000);
            assert_eq!(plant.machine.power(), Power::On, "{limit} m, {feed} m/s, {acceleration} m/s²");
            assert!((plant.motor_m[0] - 0.2).abs() < 1e-5, "{}", plant.motor_m[0]);
        }
    }
}

/// The command travels 0.1 mm, the limit, in √(2·0.1 mm/2 m/s²) = 10 ms. Even if the force is at its limit F from the start,
/// the mass m moves by no more than F/2m·t² = 400/100·(10 ms)² = 0.4 mm in this time. The following error of 10 mm alone
/// would be reached after 0.1 s and 40 mm.
#[test]
fn a_frozen_encoder_switches_the_drives_off() {
    for toggles in [0.0, 0.5e-6] {
        let settings = AxisSettings {
            sensors: motor_alone(1e-4),
            force_limit_n: 400.0,
            feedforward_percent: 100.0,
            ..axis()
        };
        let mut machine = Machine::<Fixed, 1>::new(RATES, &[settings], [Position(0)]).unwrap();
        machine.push(&Block::line([0.1], 0.1, 2.0)).unwrap();
        machine.enable();
        let (mut velocity, mut position, mut ticks) = (0.0, 0.0, 0u32);
        loop {
            // With one broken wire the counter toggles between two adjacent counts.
            let reading = Position::from_m(if ticks % 2 == 0 { 0.0 } else { toggles }).unwrap();
            let force = machine.tick(&[Reading { motor: reading, table: None }]).forces[0].value();
            if !machine.power().is_on() {
                break;
            }
            TABLE.step(&mut position, &mut velocity, force, 1.0 / RATE_HZ);
            ticks += 1;
            assert!(ticks < 400, "{position} m");
        }
        assert_eq!(machine.power(), Power::Faulted(on(0, FaultKind::EncoderFrozen)));
        // 10 ms are 40 ticks.
        assert!((39..=42).contains(&ticks), "{ticks}");
        assert!(position < 0.4e-3, "{position} m");
    }
}

/// Three lines with a dwell before each.
#[test]
fn a_motor_that_follows_its_command_has_no_frozen_encoder() {
    let settings = AxisSettings { sensors: motor_alone(1e-4), ..axis() };
    let mut plant = TestPlant::<Fixed>::new(&settings);
    for x in [0.1, 0.2, 0.0] {
        plant.run(12_000);
        plant.machine.push(&Block::line([x, 0.05], 0.1, 2.0)).unwrap();
    }
    plant.run(12_000);
    assert_eq!(plant.machine.power(), Power::On);
}
