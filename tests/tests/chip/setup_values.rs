//! The values of the board's table against the page of its wiring, `docs/firmware.md`, and against the parts that it names: computed here from
//! resistors, leads and lines, not from the constants.

use firmware::f405::{CORE_HZ, IDENTITY};
use firmware::setup::{
    BLINK_TICKS, BUS_MV_PER_COUNT, CRYSTAL_HZ, ENVELOPE, MotorSensor, PWM_HZ, RATES, SETTINGS,
    SWITCH_SETTLING_TICKS, SetupError, TABLE, TEMPERATURE, TICK_HZ, TOLERATED_TICKS, TemperatureSensor,
    tick_clock,
};
use shared::config::AxisEnvelope;
use shared::drive::{DriveError, DriveSettings, SupplyLimits};
use shared::homing::{Direction, Mark};
use shared::machine::MachineError;

/// Steps of a converter of 12 bits over 3.3 V.
const COUNTS_PER_V: f64 = 4096.0 / 3.3;

fn is_near(found: f64, expected: f64, of: &str) {
    assert!((found / expected - 1.0).abs() < 1e-9, "{of}: {found}, expected {expected}");
}

/// A screw of 5 mm with 5000 lines, four counts each; a scale of 0.5 µm; 400 N at full duty; every contact is connected.
#[test]
fn each_axis_has_its_screw_its_scale_and_its_contacts() {
    for axis in &TABLE {
        let MotorSensor::Encoder { metres_per_count } = axis.motor else { panic!("{:?}", axis.motor) };
        is_near(metres_per_count, 0.25e-6, "encoder");
        is_near(axis.scale_m_per_count.unwrap(), 0.5e-6, "scale");
        let DriveSettings::Pwm { full_duty_n } = axis.drive else { panic!("{:?}", axis.drive) };
        is_near(full_duty_n, 400.0, "force at full duty");
        assert!(axis.limit_switches && axis.drive_fault && axis.scale_signal);
    }
}

/// 48 V behind 100 kΩ and 4.7 kΩ are 2.15 V at the pin; 10 mV/K and 500 mV at 0 °C are 750 mV at 25 °C.
#[test]
fn a_count_of_a_converter_is_its_voltage() {
    let pin_v = 48.0 * 4.7 / (100.0 + 4.7);
    is_near(BUS_MV_PER_COUNT * pin_v * COUNTS_PER_V, 48_000.0, "bus voltage");
    let TemperatureSensor::Linear([slope, offset]) = TEMPERATURE else { panic!("{TEMPERATURE:?}") };
    is_near(slope * 0.75 * COUNTS_PER_V + offset, 25_000.0, "temperature");
    is_near(slope * 0.5 * COUNTS_PER_V, -offset, "temperature at zero");
}

/// The envelope of the page, for both axes: 0.4 m of travel, 30 m/min, 300 N, 36 to 60 V, 80 °C.
#[test]
fn the_envelope_is_that_of_the_page() {
    let axis = AxisEnvelope {
        travel_m: Some([-0.01, 0.4]),
        fastest_m_per_s: 30.0 / 60.0,
        force_limit_n: 300.0,
        saturation_time_s: 1.0,
        following_error_limit_m: 5e-3,
        frozen_encoder_limit_m: 0.5e-3,
        scale_disagreement_limit_m: Some(1e-3),
        stop_deceleration_m_per_s2: 0.5,
        excitation_limit_n: 120.0,
        gantry_skew_limit_m: Some(2e-3),
    };
    assert_eq!(ENVELOPE.axes, [axis; 2]);
    let supply = SupplyLimits { min_bus_mv: 36_000, max_bus_mv: 60_000, max_temperature_mc: 80_000 };
    assert_eq!(ENVELOPE.supply, supply);
}

/// 20 kHz, one tick a period of the PWM, path and position loops in every fifth; the switch settles in 20 ms, the light blinks twice a second;
/// a tick has 8400 cycles of the core, and none may be late.
#[test]
fn times_are_those_of_the_page() {
    assert_eq!((TICK_HZ, PWM_HZ, CRYSTAL_HZ), (20_000, 20_000, 8_000_000));
    assert_eq!((RATES.velocity_loop_hz.to_bits(), RATES.position_loop_divider), (20e3_f64.to_bits(), 5));
    assert_eq!((SWITCH_SETTLING_TICKS, BLINK_TICKS), (20 * 20, 20_000 / 4));
    let clock = tick_clock(CORE_HZ);
    assert_eq!((clock.counts_per_tick.get(), clock.tolerated, TOLERATED_TICKS), (8400, 0, 0));
}

/// The reference is at the negative end, on the index of the motor, once in a turn of the screw; both axes are homed the same way. Recordings
/// have counts of the motor, 0.25 µm, and commands of a sixteenth of a nanometre; the units are those of a position.
#[test]
fn homing_and_recording_fit_the_screw() {
    for homing in IDENTITY.homing {
        let homing = homing.unwrap();
        assert_eq!(
            (homing.direction, homing.mark),
            (Direction::Negative, Mark::MotorIndex { spacing_m: 5e-3 })
        );
        assert_eq!(homing.mark_position_m.to_bits(), 0.0_f64.to_bits());
        // The travel is searched once, and a mark is within the back-off.
        assert!(homing.search_distance_m >= 0.35 && homing.back_off_distance_m > 5e-3);
    }
    let unit_m = shared::units::Position(1).to_m();
    is_near(IDENTITY.steps.command as f64 * unit_m, 1e-9 / 16.0, "step of a command");
    for count in IDENTITY.steps.motor.into_iter().chain(IDENTITY.steps.table) {
        is_near(count as f64 * unit_m, 0.25e-6, "step of a reading");
    }
    assert_eq!(IDENTITY.tick_hz, TICK_HZ);
}

/// The loops: the bandwidth of the velocity loop is Kv/(2π·m) = 32 Hz with 15 kg, Kp is at most its quarter; soft limits are within the envelope.
#[test]
fn the_loops_are_those_of_the_comment() {
    for axis in &SETTINGS {
        let bandwidth_per_s = axis.velocity_gain_n_s_per_m / 15.0;
        assert!((31.0..33.0).contains(&(bandwidth_per_s / std::f64::consts::TAU)));
        assert!((0.9..=1.0).contains(&(axis.position_gain_per_s / (bandwidth_per_s / 8.0))));
        assert_eq!(axis.travel_m, Some([0.0, 0.35]));
        assert_eq!(axis.fastest_m_per_s, Some(0.15));
    }
}

/// A refusal keeps its reason.
#[test]
fn a_refusal_has_its_reason() {
    let machine = MachineError::NoSuchAxis;
    assert_eq!(SetupError::from(machine), SetupError::Machine(machine));
    let drive = DriveError::FullScale;
    assert_eq!(SetupError::from(drive), SetupError::Drive(drive));
}
