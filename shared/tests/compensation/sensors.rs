//! Errors between motor and scale, and errors of the tool, with each kind of position feedback: a compensation cancels its
//! error whether the loop sees the error or not.
//!
//! The machine is simulated here: a mass on the motor, and a table that follows it with the errors of a screw.

use crate::slide::Slide;
use shared::config::{AxisSettings, ScaleLimits, Sensors};
use shared::interpolate::Block;
use shared::machine::Machine;
use shared::safety::Power;

use super::*;

const SENSORS: [Sensors; 3] = [
    Sensors::Motor {
        scale_disagreement_limit_m: Some(LIMITS.disagreement_m),
        frozen_encoder_limit_m: Some(LIMITS.frozen_m),
    },
    Sensors::Table(LIMITS),
    Sensors::Dual { time_constant_s: DUAL_TIME_CONSTANT_S, limits: LIMITS },
];
const DUAL_TIME_CONSTANT_S: f64 = 0.1;

/// The errors are at most 26 µm.
const LIMITS: ScaleLimits = ScaleLimits { disagreement_m: 40e-6, frozen_m: 40e-6 };

const TICKS: u32 = 13_000;

/// Ticks at which the axis stands after the way there, and after the way back.
const STANDING: [u32; 2] = [6200, 12_900];

/// What the mechanics do wrong.
#[derive(Clone, Copy, Default)]
struct Errors {
    /// 12 µm over the travel of 40 mm, and 4 µm with the period of 8 mm.
    screw: bool,
    /// Total width, m.
    backlash_m: f64,
    /// Load on the table, N, and compliance of the drive, m/N.
    load_n: f64,
    compliance_m_per_n: f64,
    /// The scale reads too much by this per metre.
    scale_per_m: f64,
    /// Ticks without a reading of the scale.
    scale_lost: [u32; 2],
}

impl Errors {
    fn screw_m(&self, motor_m: f64) -> f64 {
        if self.screw { 300e-6 * motor_m + 4e-6 * (TAU * motor_m / 8e-3 + 0.5).sin() } else { 0.0 }
    }
}

const TABLE: Slide = Slide { mass_kg: 50.0, viscous_n_s_per_m: 500.0, coulomb_n: 0.0 };

/// Position of the table in every tick, m: to 40 mm at 40 mm/s, a stop, and back to 10 mm.
fn table_m(sensors: Sensors, errors: Errors, settings: Option<&CompensationSettings>) -> Vec<f64> {
    let axis = AxisSettings {
        position_gain_per_s: 40.0,
        // Without an overshoot that would cross the gap of the backlash.
        feedforward_percent: if errors.backlash_m > 0.0 { 0.0 } else { 100.0 },
        velocity_integral_time_s: if errors.backlash_m > 0.0 { None } else { Some(0.02) },
        velocity_gain_n_s_per_m: 20_000.0,
        sensors,
        scale_fade_time_s: 0.05,
        ..AxisSettings::default()
    };
    let mut machine = Machine::<Fixed, 1>::new(RATES, &[axis], [Position(0)]).unwrap();
    if let Some(settings) = settings {
        machine.compensate(0, settings).unwrap();
    }
    for block in [Block::line([0.04], 0.04, 0.5), Block::dwell(0.5), Block::line([0.01], 0.04, 0.5)] {
        machine.push(&block).unwrap();
    }
    machine.enable();
    let (mut motor, mut velocity, mut gap, mut force) = (0.0f64, 0.0, 0.0f64, 0.0);
    let mut tables = Vec::new();
    for tick in 0..TICKS {
        for _ in 0..10 {
            TABLE.step(&mut motor, &mut velocity, force - errors.load_n, 0.1 / RATE_HZ);
        }
        // Kinematic backlash: the table stays while the screw moves within the gap.
        let screw = motor + errors.screw_m(motor) - errors.load_n * errors.compliance_m_per_n;
        gap = gap.clamp(screw - 0.5 * errors.backlash_m, screw + 0.5 * errors.backlash_m);
        tables.push(gap);
        let scale = gap * (1.0 + errors.scale_per_m);
        let [from, to] = errors.scale_lost;
        let has_scale = !(from..to).contains(&tick);
        let reading = Reading { motor: position(motor), table: has_scale.then(|| position(scale)) };
        force = machine.tick(&[reading]).forces[0].value();
        assert_eq!(machine.power(), Power::On, "{sensors:?}, tick {tick}");
    }
    tables
}

fn screw() -> CompensationSettings {
    CompensationSettings {
        pitch: Some(Pitch {
            of: PitchSource::Screw,
            forward: points(-0.1, 0.01, |x| 300e-6 * x),
            backward: None,
        }),
        screw: [Cycle::harmonic(4e-6, 8e-3, 0.5)].into_iter().collect(),
        position_rate_m_per_s: 0.05,
        ..CompensationSettings::default()
    }
}

/// Position of the table relative to the command where the axis stands, m.
fn standing_m(sensors: Sensors, errors: Errors, settings: Option<&CompensationSettings>) -> [f64; 2] {
    let tables = table_m(sensors, errors, settings);
    let at = |tick: u32, command_m: f64| tables[tick as usize] - command_m;
    [at(STANDING[0], 0.04), at(STANDING[1], 0.01)]
}

/// At rest: command + c = motor and table = command, so that every one of the three position errors is zero. If c were added to
/// the command alone, a loop with a scale would move the table by c, up to 16 µm.
#[test]
fn a_compensated_screw_leaves_no_error_at_rest_with_any_sensor() {
    let load = ForceModel { load: Some(points(-0.3, 0.01, |_| 200.0)), ..ForceModel::default() };
    let cases = vec![
        (Errors { screw: true, ..Errors::default() }, screw()),
        (
            Errors { backlash_m: 10e-6, ..Errors::default() },
            CompensationSettings { backlash_width_m: Some(10e-6), ..CompensationSettings::default() },
        ),
        (
            Errors { load_n: 200.0, compliance_m_per_n: 2e-8, ..Errors::default() },
            CompensationSettings {
                force: Some(load),
                stretch_m_per_n: Some(2e-8),
                ..CompensationSettings::default()
            },
        ),
    ];
    for (errors, settings) in &cases {
        for sensors in SENSORS {
            let without = standing_m(sensors, *errors, None);
            let with = standing_m(sensors, *errors, Some(settings));
            // Interpolation of the cycle, 1.2e-3 of 4 µm. With the motor, the error at the command is taken instead of that at
            // the motor, up to 14 µm away: 14 µm·(300 µm/m + 4 µm·2π/8 mm) = 48 nm.
            let bound = if matches!(sensors, Sensors::Motor { .. }) { 55e-9 } else { 5e-9 };
            assert!(
                with.iter().all(|error| error.abs() < bound),
                "{sensors:?}: {with:?}, without {without:?}"
            );
            let largest = without[0].abs().max(without[1].abs());
            match sensors {
                Sensors::Motor { .. } => assert!((3e-6..17e-6).contains(&largest), "{without:?}"),
                // Dual feedback still takes over the error of the way: 14 µm·e^(−6), after 0.6 s of 0.1 s.
                _ => assert!(largest < 40e-9, "{sensors:?}: {without:?}"),
            }
        }
    }
}

/// An error of the tool that no sensor sees, 3 µm, and one of the scale, 100 µm/m: these corrections act with the loop on the
/// scale as well.
#[test]
fn errors_that_the_scale_does_not_see_are_corrected_with_any_sensor() {
    let drift = CompensationSettings {
        drift: Some(TimePoints { start_s: 0.0, spacing_s: 0.5, values: [3e-6; 2].into_iter().collect() }),
        ..CompensationSettings::default()
    };
    for sensors in SENSORS {
        let with = standing_m(sensors, Errors::default(), Some(&drift));
        assert!(with.iter().all(|error| (error + 3e-6).abs() < 5e-9), "{sensors:?}: {with:?}");
    }
    let forward = points(-0.1, 0.01, |x| 100e-6 * x);
    let scale = CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Scale, forward, backward: None }),
        ..CompensationSettings::default()
    };
    let errors = Errors { scale_per_m: 100e-6, ..Errors::default() };
    for sensors in [SENSORS[1], SENSORS[2]] {
        let without = standing_m(sensors, errors, None);
        // The table moves by 1/(1 + 10⁻⁴) of the command: 4 µm less at 40 mm.
        assert!((without[0] + 4e-6).abs() < 5e-9, "{sensors:?}: {without:?}");
        let with = standing_m(sensors, errors, Some(&scale));
        assert!(with.iter().all(|error| error.abs() < 5e-9), "{sensors:?}: {with:?}");
    }
}

/// Greatest difference between two tables in motion, m, after the first 0.6 s. Before, dual feedback takes over the correction
/// that starts with the motion, 2 µm, with its time constant: 2 µm·e^(−6) remain, 5 nm.
fn apart(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).skip(2400).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max)
}

/// In motion the table is where that of a machine without errors is. Without compensation the loop on the motor leaves the whole
/// error; dual feedback lets pass what changes faster than its crossover; the loop on the scale follows within its gain.
#[test]
fn a_compensated_screw_leaves_no_error_in_motion_with_any_sensor() {
    let errors = Errors { screw: true, ..Errors::default() };
    for (sensors, left_m) in SENSORS.into_iter().zip([12e-6, 2e-6, 2e-6]) {
        let ideal = table_m(sensors, Errors::default(), None);
        let without = apart(&table_m(sensors, errors, None), &ideal);
        let with = apart(&table_m(sensors, errors, Some(&screw())), &ideal);
        assert!(without > left_m && without < 17e-6, "{sensors:?}: {without:e}");
        // The correction passes the velocity loop, 400 rad/s: 4 µm·(2π·5 Hz)/400 = 0.3 µm at most.
        assert!(with < 0.4e-6 && with > 1e-9, "{sensors:?}: {with:e}, without {without:e}");
    }
}

/// The scale is lost for 0.35 s in motion: the shift between motor and feedback is held at what the errors left, nothing, and the
/// correction of the command goes on as with a loop on the motor. When the scale returns there is no offset to fade out.
#[test]
fn a_compensated_screw_needs_no_scale() {
    let errors = Errors { screw: true, scale_lost: [2400, 3800], ..Errors::default() };
    for sensors in [SENSORS[1], SENSORS[2]] {
        let ideal = table_m(sensors, Errors::default(), None);
        let without = apart(&table_m(sensors, errors, None), &ideal);
        let with = apart(&table_m(sensors, errors, Some(&screw())), &ideal);
        assert!(with < 0.4e-6, "{sensors:?}: {with:e}");
        assert!(without > 5.0 * with, "{sensors:?}: {without:e} without, {with:e} with");
    }
}
