//! A rigid mass m with a velocity loop without integral part: backward difference of the reading and held force give
//!
//! ```text
//! L(z) = Kv·T/(2m)·(z + 1)/(z·(z − 1)) = −j·Kv·T/(2m)·cot(θ/2)·e^(−jθ),   z = e^(jθ).
//! ```
//!
//! Its phase is −90° − θ: the gain margin is 2m/(Kv·T), at θ = 90°; the phase margin is 90° − θ at cot(θ/2) = 2m/(Kv·T).

use crate::margins::axis_margins::AxisLoops;
use crate::margins::mechanics::Condition;
use crate::margins::tests::machine;
use model::effects::{ComputationDelay, DriveDeadTime, Effect};
use plant::instruments::Instruments;

/// Rigid, without viscous friction and integral part.
fn rigid() -> AxisLoops {
    rigid_with(Vec::new())
}

/// Rigid, without viscous friction and integral part, with effects.
fn rigid_with(effects: Vec<Effect>) -> AxisLoops {
    rigid_changed(|machine| machine.axis[0].effect = effects)
}

/// Rigid, without viscous friction and integral part, otherwise changed.
fn rigid_changed(change: impl FnOnce(&mut model::machine::Machine)) -> AxisLoops {
    let mut machine = machine("p", "motor");
    change(&mut machine);
    let settings = &mut machine.axis[0].settings;
    settings.mechanics.stiffness_n_per_um = None;
    settings.mechanics.damping_n_s_per_m = None;
    settings.mechanics.viscous_n_s_per_m = None;
    settings.controller.velocity_integral_time_s = None;
    AxisLoops::of_machine(&machine, &Instruments::default()).unwrap().remove(0)
}

#[test]
fn the_velocity_loop_of_a_rigid_mass_has_the_margins_of_its_closed_form() {
    let margins = rigid().velocity();
    let ratio: f64 = 2.0 * 250.0 / (60_000.0 / 4000.0);
    let (gain, phase) = (margins.gain_db.unwrap().0, margins.phase_deg.unwrap().0);
    assert!((gain.value - 20.0 * ratio.log10()).abs() < 1e-6, "{gain:?}");
    assert!((gain.hz - 1000.0).abs() < 1e-3, "a quarter of 4 kHz: {gain:?}");
    let angle = 2.0 * (1.0 / ratio).atan();
    assert!((phase.value - (90.0 - angle.to_degrees())).abs() < 1e-6, "{phase:?}");
    assert!((phase.hz - angle / std::f64::consts::TAU * 4000.0).abs() < 1e-3, "{phase:?}");
    assert_eq!(margins.unstable, None);
}

/// With an observer L(z) is multiplied by ((1 − r)/(1 − r/z))²: at the phase crossover θ its phase is −90° − θ − 2φ = −180° with
/// φ = atan(r·sin θ/(1 − r·cos θ)), and at the gain crossover Kv·T/(2m)·cot(θ/2)·(1 − r)²/(1 − 2r·cos θ + r²) = 1. Both are solved by
/// halving.
#[test]
fn an_observer_multiplies_the_velocity_loop_by_its_two_stages() {
    for bandwidth_hz in [150.0, 300.0, 900.0] {
        let observed = |machine: &mut model::machine::Machine| {
            machine.axis[0].settings.controller.velocity_observer_hz = Some(bandwidth_hz);
        };
        let margins = rigid_changed(observed).velocity();
        let (gain, phase) = (margins.gain_db.unwrap().0, margins.phase_deg.unwrap().0);
        let r = (-std::f64::consts::TAU * bandwidth_hz / 4000.0).exp();
        let lag = |theta: f64| (r * theta.sin()).atan2(1.0 - r * theta.cos());
        let magnitude = |theta: f64| {
            60_000.0 / 4000.0 / 500.0 / (theta / 2.0).tan() * (1.0 - r).powi(2)
                / (1.0 - 2.0 * r * theta.cos() + r * r)
        };
        let solved = |is_above: &dyn Fn(f64) -> bool| {
            let halve = |[low, high]: [f64; 2], _| {
                let middle = 0.5 * (low + high);
                if is_above(middle) { [low, middle] } else { [middle, high] }
            };
            (0..60).fold([1e-6, 3.0], halve)[0]
        };
        let turned = |theta: f64| std::f64::consts::FRAC_PI_2 + theta + 2.0 * lag(theta);
        let theta = solved(&|theta| turned(theta) > std::f64::consts::PI);
        assert!((gain.value + 20.0 * magnitude(theta).log10()).abs() < 1e-6, "{bandwidth_hz}: {gain:?}");
        assert!((gain.hz - theta / std::f64::consts::TAU * 4000.0).abs() < 1e-3, "{bandwidth_hz}: {gain:?}");
        let theta = solved(&|theta| magnitude(theta) < 1.0);
        let expected = 180.0 - turned(theta).to_degrees();
        assert!((phase.value - expected).abs() < 1e-6, "{bandwidth_hz}: {phase:?}, not {expected}");
    }
}

/// A delay of n periods turns L(z) by −n·θ, and leaves its magnitude.
#[test]
fn a_late_force_reduces_the_phase_margin_by_its_delay() {
    let (before, condition) = rigid().velocity().phase_deg.unwrap();
    let theta_deg = before.hz / 4000.0 * 360.0;
    let computed = Effect::ComputationDelay(ComputationDelay { periods: 2.0 });
    let dead = Effect::DriveDeadTime(DriveDeadTime { ms: 0.25 });
    for (effects, periods) in
        [(vec![computed.clone()], 2.0), (vec![dead.clone()], 1.0), (vec![computed, dead], 3.0)]
    {
        let (after, same) = rigid_with(effects).velocity().phase_deg.unwrap();
        assert!((before.value - after.value - periods * theta_deg).abs() < 1e-6, "{periods}: {after:?}");
        assert!((after.hz / before.hz - 1.0).abs() < 1e-9 && same == condition, "{periods}: {after:?}");
    }
}

/// Far below the bandwidth of the velocity loop the position loop is Kp/s behind a delay, and the phase margin is 90° less Kp
/// times the delay. For a velocity command that rises by a per second, the reading is m·a/Kv below the command, and is half a
/// tick T late; the hold over n ticks of the position loop lags by (n − 1)·T/2. Delay: m/Kv − T/2 + (n − 1)·T/2.
#[test]
fn a_slow_position_loop_has_a_phase_margin_near_90_degrees() {
    let margins = rigid().with_position_gain(2.0).position();
    let (phase, _) = margins.phase_deg.unwrap();
    assert!((phase.hz * std::f64::consts::TAU - 2.0).abs() < 2e-3, "{phase:?}");
    let delay_s = (90.0 - phase.value).to_radians() / 2.0;
    let exact_s = 250.0 / 60_000.0 - 0.5 / 4000.0 + 1.5 / 4000.0;
    // The phase of a first-order lag differs from that of a delay by (ωτ)²/3 = 2e-5 of itself.
    assert!((delay_s / exact_s - 1.0).abs() < 1e-4, "{delay_s} {exact_s}");
}

/// For P control the loop is proportional to Kp: the loop at Kp times the gain margin is at its limit.
#[test]
fn the_gain_margin_of_p_control_is_the_factor_of_kp_at_which_the_loop_becomes_unstable() {
    for feedback in ["motor", "table", "dual"] {
        let machine = machine("p", feedback);
        let loops = AxisLoops::of_machine(&machine, &crate::margins::tests::instruments()).unwrap().remove(0);
        let (gain, condition) = loops.position().gain_db.unwrap();
        assert_eq!(condition, Condition::Sliding);
        let limit = 50.0 * 10f64.powf(gain.value / 20.0);
        // The crossing is found to 40 halvings; a change of Kp by 1e-5 moves the pole across the unit circle.
        assert_eq!(loops.with_position_gain(limit * (1.0 - 1e-5)).position().unstable, None, "{feedback}");
        assert!(loops.with_position_gain(limit * (1.0 + 1e-5)).position().unstable.is_some(), "{feedback}");
    }
}
