use std::f64::consts::TAU;

use nalgebra::Complex;
use shared::config::{AxisSettings, Law, Rates, Sensors, VelocitySource};
use shared::excitation::Excitation;
use shared::feedback::Reading;
use shared::machine::Machine;
use shared::scalar::{Fixed, Scalar};
use shared::units::Position;

use super::margins::MeasuredMargins;
use super::resonances::resonances;
use super::spectrum::lines;
use super::tones::Range;
use super::{Loop, Plan, Point, Record};

const RATES: Rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };

const RANGE: Range = Range { from_hz: 10.0, to_hz: 2000.0, tones: 24, at_once: 4 };

const MASS_KG: f64 = 15.0;
const VISCOUS_N_S_PER_M: f64 = 300.0;

fn settings() -> AxisSettings {
    AxisSettings {
        law: Law::P,
        position_gain_per_s: 40.0,
        velocity_gain_n_s_per_m: 6000.0,
        velocity_integral_time_s: Some(0.02),
        sensors: Sensors::Motor { scale_disagreement_limit_m: None, frozen_encoder_limit_m: None },
        ..AxisSettings::default()
    }
}

/// Records periods of a rigid axis: the exact solution of m·v' = F − b·v over a tick, under the controller itself.
fn measure(plan: &Plan, settings: &AxisSettings, periods: usize) -> Vec<Point> {
    let tick_s = 1.0 / RATES.velocity_loop_hz;
    let decay = (-VISCOUS_N_S_PER_M / MASS_KG * tick_s).exp();
    let mut points = Vec::new();
    for group in &plan.groups {
        let excitation = plan.excitation(group, 0, 60.0);
        let force = Excitation::<Fixed>::new(&excitation).unwrap();
        let mut machine =
            Machine::<f64, 1>::new(RATES, std::slice::from_ref(settings).try_into().unwrap(), [Position(0)])
                .unwrap();
        machine.enable();
        let (mut position_m, mut velocity, mut acting_n) = (0.0, 0.0, 0.0);
        let period = usize::from(plan.period_ticks);
        let settling = 3 * period + 77;
        let mut records = vec![Record::default(); periods];
        for tick in 0..=settling + periods * period {
            let steady = acting_n / VISCOUS_N_S_PER_M;
            position_m += steady * tick_s + (velocity - steady) * (1.0 - decay) * MASS_KG / VISCOUS_N_S_PER_M;
            velocity = steady + (velocity - steady) * decay;
            for (number, record) in records.iter_mut().enumerate() {
                let start = settling + number * period;
                if (start..=start + period).contains(&tick) {
                    record.start_tick = start as u64;
                    record.motor_m.push(position_m);
                    record.force_n.push(acting_n);
                }
            }
            machine.set_excitation(0, force.force(tick as u64).value());
            let motor = Position::from_m(position_m).unwrap();
            acting_n = machine.tick(&[Reading { motor, table: None }]).forces[0];
        }
        let lines = lines(&excitation, &records, RATES.velocity_loop_hz).unwrap();
        points.extend(lines.iter().map(|line| Point::of(line, settings, RATES)));
    }
    points.sort_by(|one, other| one.frequency_hz.total_cmp(&other.frequency_hz));
    points
}

fn close(found: Complex<f64>, expected: Complex<f64>, relative: f64) -> bool {
    (found - expected).norm() < relative * expected.norm()
}

/// The plant is 1/(m·s + b), although the controller holds it: the phases of hold and recording are those of the board. The loops are
/// those of the continuous controller with the delays of its difference (half a tick), of the hold of the force (half a tick), and of that of the
/// velocity command.
#[test]
fn the_response_of_a_rigid_axis_is_that_of_its_mass_and_its_controller() {
    let plan = Plan::new(&RANGE, RATES.velocity_loop_hz).unwrap();
    assert_eq!((plan.period_ticks, plan.tones()), (2048, 21));
    let settings = settings();
    let points = measure(&plan, &settings, 2);
    assert_eq!(points.len(), 21);
    let tick_s = 1.0 / RATES.velocity_loop_hz;
    for point in &points {
        let s = Complex::new(0.0, TAU * point.frequency_hz);
        let plant = 1.0 / (MASS_KG * s + VISCOUS_N_S_PER_M);
        assert!(point.coherence > 0.9999, "{point:?}");
        assert!(close(point.plant_m_per_s_per_n, plant, 1e-3), "{plant} {point:?}");
        let [velocity, position] = point.loops.unwrap();
        // The integral includes the present tick, which is half a tick ahead.
        let controller =
            settings.velocity_gain_n_s_per_m * (1.0 + 1.0 / (0.02 * s) * (0.5 * tick_s * s).exp());
        // Difference and hold of the force, each with sin(x)/x of half the angle of a tick.
        let half = 0.5 * tick_s * TAU * point.frequency_hz;
        let expected = controller * plant * (-tick_s * s).exp() * (half.sin() / half).powi(2);
        assert!(close(velocity, expected, 0.01), "{expected} {point:?}");
        // A hold of five ticks, sin(5x)/(5·sin x), and two ticks late; the difference is half a tick late.
        let delay = (5.0 * half).sin() / (5.0 * half.sin()) * (-(2.0 - 0.5) * tick_s * s).exp();
        let expected = 40.0 / s * delay * expected / (1.0 + expected);
        assert!(point.frequency_hz > 500.0 || close(position, expected, 0.02), "{expected} {point:?}");
        assert!(close(point.open_loop, velocity * (1.0 + 40.0 / s * delay), 0.03), "{point:?}");
        assert!(close(point.closed_loop() * (1.0 + point.open_loop), point.open_loop, 1e-9));
    }
    assert!(resonances(&points).is_empty());
}

/// With an observer the velocity loop is that with the difference times ((1 − r)/(1 − r/z))², and the position loop follows from it as
/// before.
#[test]
fn the_response_with_an_observer_is_that_of_its_two_stages() {
    let plan = Plan::new(&RANGE, RATES.velocity_loop_hz).unwrap();
    let velocity_source = VelocitySource::Observer { bandwidth_hz: 300.0 };
    let observed = measure(&plan, &AxisSettings { velocity_source, ..settings() }, 2);
    let points = measure(&plan, &settings(), 2);
    let r = (-TAU * 300.0 / RATES.velocity_loop_hz).exp();
    for (point, observed) in points.iter().zip(&observed) {
        let hz = point.frequency_hz;
        let angle = TAU * hz / RATES.velocity_loop_hz;
        let stage = (1.0 - r) / (Complex::from(1.0) - Complex::from_polar(r, -angle));
        let [velocity, position] = point.loops.unwrap();
        let [with, position_with] = observed.loops.unwrap();
        // The force is rounded: 2e-5 of a loop that is 7e-4 at 2 kHz.
        let expected = velocity * stage * stage;
        assert!((with - expected).norm() < 2e-3 * expected.norm() + 2e-5, "{hz} Hz: {with} {expected}");
        let expected = position * (1.0 + velocity) / velocity * with / (1.0 + with) / (stage * stage);
        assert!(hz > 500.0 || close(position_with, expected, 5e-3), "{hz} Hz: {position_with} {expected}");
    }
}

/// Kv/(m·ω) is 1 at 64 Hz. At 3 dB more gain the crossover is higher by this factor.
#[test]
fn crossover_and_margins_are_those_of_the_formula() {
    let plan = Plan::new(&RANGE, RATES.velocity_loop_hz).unwrap();
    let points = measure(&plan, &settings(), 1);
    let margins = MeasuredMargins::of(&points, Loop::Velocity);
    let hz = margins.crossover_hz.unwrap();
    let expected_hz = 6000.0 / MASS_KG / TAU;
    assert!((hz / expected_hz - 1.0).abs() < 0.02, "{hz} {expected_hz}");
    // 90° and less by the integral and two halves of a tick, more by the viscous friction.
    let omega = TAU * hz;
    let integral = (1.0 / (omega * 0.02)).atan();
    let expected = 90.0 + (VISCOUS_N_S_PER_M / (MASS_KG * omega)).atan().to_degrees()
        - (integral + omega / RATES.velocity_loop_hz).to_degrees();
    let phase = margins.phase_deg.unwrap();
    assert!((phase.value - expected).abs() < 1.0, "{phase:?} {expected}");
    // Up to 2 kHz the phase does not reach −180°.
    assert_eq!(margins.gain_db, None);
    let position = MeasuredMargins::of(&points, Loop::Position);
    assert_eq!(position.crossover_hz, None, "40/s is 6.4 Hz, below the lowest tone");
}

/// Points of a formula: L = 2·ω₁³/(s·(s + ω₁)²) has −180° at ω₁ with a gain of 1.
#[test]
fn the_margins_of_a_third_order_loop_are_interpolated() {
    for gain in [0.25, 0.9, 1.0 / 0.7] {
        let points: Vec<Point> = (0..60)
            .map(|k| {
                let frequency_hz = 5.0 * 1.1f64.powi(k);
                let s = Complex::new(0.0, frequency_hz / 100.0);
                let open_loop = 2.0 * gain / (s * (s + 1.0) * (s + 1.0));
                Point { frequency_hz, coherence: 1.0, plant_m_per_s_per_n: s, open_loop, loops: None }
            })
            .collect();
        let margins = MeasuredMargins::of(&points, Loop::Force);
        let found = margins.gain_db.unwrap();
        assert!(
            (found.value - (20.0 * gain.log10()).abs()).abs() < 0.1 && (found.hz - 100.0).abs() < 1.0,
            "{found:?}"
        );
        // Unstable above a gain of 1: the margin is negative.
        assert_eq!(margins.phase_deg.unwrap().value > 0.0, gain < 1.0, "{margins:?}");
        assert_eq!(MeasuredMargins::of(&points, Loop::Velocity), MeasuredMargins::default());
    }
}

/// Two masses on a spring: the acceleration of the motor per force has its maximum beside √(k·(1/m + 1/M)).
#[test]
fn the_resonance_of_two_masses_is_found_with_its_notch() {
    let (motor, table, stiffness, damping) = (6.0, 9.0, 50e6, 1500.0);
    let points: Vec<Point> = (0..120)
        .map(|k| {
            let frequency_hz = 20.0 * 1.04f64.powi(k);
            let s = Complex::new(0.0, TAU * frequency_hz);
            let spring = damping * s + stiffness;
            let plant = (table * s * s + spring) / (s * (motor * table * s * s + (motor + table) * spring));
            Point { frequency_hz, coherence: 1.0, plant_m_per_s_per_n: plant, open_loop: plant, loops: None }
        })
        .collect();
    let [resonance] = resonances(&points)[..] else { panic!("{:?}", resonances(&points)) };
    let natural = (stiffness * (1.0 / motor + 1.0 / table)).sqrt();
    assert!((resonance.frequency_hz / (natural / TAU) - 1.0).abs() < 0.02, "{resonance:?}");
    // 2·ζ·ω with ζ = c·(1/m + 1/M)/(2·ω), a little wider on the way to the antiresonance.
    let width = damping * (1.0 / motor + 1.0 / table) / TAU;
    let found = resonance.width_hz.unwrap();
    assert!((0.9..1.4).contains(&(found / width)), "{found} {width}");
    let notch = resonance.notch();
    assert!(notch.depth > 0.6 && notch.depth < 1.0 && notch.width_hz.to_bits() == found.to_bits());
}

/// The highest first, no more than an axis can have; the keys give back the notches, and one is written as a number.
#[test]
fn notches_are_proposed_for_the_highest_resonances() {
    use super::file::NotchKeys;
    use super::resonances::Resonance;
    use shared::config::NOTCHES;

    let resonance = |number: u32| {
        let height_db = f64::from([5, 9, 4, 20, 7, 3][number as usize]);
        Resonance { frequency_hz: 100.0 * f64::from(number + 1), height_db, width_hz: None }
    };
    let found: Vec<Resonance> = (0..6).map(resonance).collect();
    let keys = NotchKeys::of(&found).unwrap();
    assert_eq!(keys.notch_frequency_hz.0, [400.0, 200.0, 500.0, 100.0]);
    assert_eq!(keys.notches()[1], found[1].notch());
    assert_eq!(keys.notches().len(), NOTCHES);
    assert_eq!(keys.notch_frequency_hz.toml(0), "[400, 200, 500, 100]");
    assert_eq!(NotchKeys::of(&[]), None);
    let one = serde_json::to_value(NotchKeys::of(&found[..1])).unwrap();
    assert_eq!(one["notch_frequency_hz"], 100.0);
    assert_eq!(serde_json::from_value::<NotchKeys>(one).ok(), NotchKeys::of(&found[..1]));
}

#[test]
fn a_plan_has_ascending_harmonics_in_spread_groups_and_refuses_what_it_cannot_measure() {
    use super::PlanError::{From, To, Tones};

    let plan = |range| Plan::new(&range, 20_000.0);
    let all = plan(Range { from_hz: 2.5, to_hz: 8000.0, tones: 40, at_once: 8 }).unwrap();
    assert_eq!(all.period_ticks, 8192);
    assert!(all.groups.iter().all(|group| group.len() <= 8 && group.is_sorted_by(|one, next| one < next)));
    let mut harmonics = all.groups.concat();
    harmonics.sort_unstable();
    assert!(harmonics.is_sorted_by(|one, next| one < next) && harmonics.len() == all.tones());
    assert_eq!((harmonics[0], *harmonics.last().unwrap()), (1, 3277));
    let coarse = plan(Range { from_hz: 400.0, ..RANGE }).unwrap();
    assert_eq!(coarse.period_ticks, 256);
    assert!(matches!(plan(Range { from_hz: 2.4, ..RANGE }), Err(From { .. })));
    assert!(matches!(plan(Range { from_hz: f64::NAN, ..RANGE }), Err(From { .. })));
    assert!(matches!(plan(Range { from_hz: 2000.0, ..RANGE }), Err(From { .. })));
    assert!(matches!(plan(Range { to_hz: 8001.0, ..RANGE }), Err(To { .. })));
    for (tones, at_once) in [(1, 1), (201, 1), (20, 0), (20, 9)] {
        assert_eq!(plan(Range { tones, at_once, ..RANGE }), Err(Tones));
    }
}
