//! Wind-up of an axis without declared masses, computed from the measured force.

use crate::input::signals::AxisSignals;
use plant::friction_direction;
use plant::parameters::AxisParameters;

/// Adds the stretch of the drive train (µm) to the residual table − motor.
///
/// The stretch is that of `forced_windup`: (force − friction·direction)/stiffness. The direction follows the sign of
/// motion exponentially over the presliding distance (Dahl, 1968) and is constant during a standstill.
pub fn add_stretch(residual_um: &mut [f64], parameters: &AxisParameters, signals: &AxisSignals) {
    let (Some(windup), Some(force), Some(motor)) =
        (&parameters.forced_windup, &signals.force, &signals.motor)
    else {
        return;
    };
    let presliding_m = 1e-3 * windup.presliding_mm.unwrap_or(0.0).max(1e-9);
    let mut direction = 0.0;
    let mut last = motor.value.first().copied().unwrap_or(0.0);
    let directions = motor.value.iter().enumerate().map(|(i, &position)| {
        let step = position - last;
        last = position;
        if !signals.standstill.get(i).copied().unwrap_or(false) {
            direction = friction_direction::after(direction, step, presliding_m);
        }
        direction
    });
    let directions = motor.filtered(&directions.collect::<Vec<_>>());
    for ((residual, force), direction) in residual_um.iter_mut().zip(&force.value).zip(directions) {
        *residual += windup.deflection_um(*force, direction);
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    use crate::{Identification, trace};
    use files::log::{AxisLog, Log, Unit};
    use model::machine::Machine;

    /// The trace of a robot's axis, 20 s at 250 Hz, that oscillates over ±20° against gravity and 2 N·m of motor friction. The
    /// load side is read 3 ms late and lags by `windup_mdeg`(torque, direction).
    fn traced(seed: u64, windup_mdeg: impl Fn(f64, f64) -> f64) -> Identification {
        let machine = Machine::parse("name = \"r\"\nsample_rate_hz = 250.0\n[axis.a]\n", "r.toml").unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut noise = || numerics::noise::sum_of_uniforms(&mut random);
        let phase = noise();
        let position = |t: f64| 15.0 * (1.1 * t + phase).sin() + 5.0 * (0.47 * t).sin();
        let speed = |t: f64| 16.5 * (1.1 * t + phase).cos() + 2.35 * (0.47 * t).cos();
        let torque = |t: f64| {
            -8.0 * position(t).to_radians().cos() - 6.0 * position(t).to_radians().sin()
                + 2.0 * speed(t).signum()
        };
        let times: Vec<f64> = (0..5000).map(|i| 0.004 * f64::from(i)).collect();
        let mut axis = AxisLog::new("a", Unit::Degree);
        axis.motor = Some(times.iter().map(|&t| position(t) + 1e-4 * noise()).collect());
        axis.force = Some(times.iter().map(|&t| torque(t) + 0.05 * noise()).collect());
        let late = |t: f64| {
            position(t - 0.003) - 1e-3 * windup_mdeg(torque(t - 0.003), speed(t - 0.003).signum()) + 0.05
        };
        axis.table = Some(times.iter().map(|&t| late(t) + 1e-4 * noise()).collect());
        let log = Log::new("r.csv", 0.0, 0.004, [axis]);
        trace(&machine, &[log], &[], &|_| {}).unwrap()
    }

    fn names(trace: &Identification) -> Vec<&'static str> {
        trace.axes()[0].found.iter().map(|found| found.effect.name()).collect()
    }

    #[test]
    fn the_stiffness_of_a_gear_is_found_from_torque_and_two_encoders() {
        for seed in 0..5 {
            // Stiffness 0.5 N·m/mdeg, friction before the gear 1.5 N·m.
            let trace = traced(seed, |torque, direction| (torque - 1.5 * direction) / 0.5);
            assert_eq!(names(&trace), ["latency", "windup"], "{seed}");
            let windup = &trace.axes()[0].found[1];
            let near = |i: usize, truth: f64| {
                let error = (windup.effect.parameters()[i].1 - truth).abs();
                // The tracer delays the motion by 3 ms but not the wind-up. At each reversal, the jump of the wind-up by
                // 6 mdeg is predicted 3 ms early. This biases stiffness and friction by a few percent, more than their
                // confidence intervals.
                error < 0.05 * truth
            };
            assert!(near(0, 0.5) && near(1, 1.5), "{seed}: {windup:?}");
        }
    }

    #[test]
    fn no_windup_is_found_on_a_stiff_gear() {
        for seed in 0..40 {
            assert_eq!(names(&traced(seed, |_, _| 0.0)), ["latency"], "{seed}");
        }
    }
}
