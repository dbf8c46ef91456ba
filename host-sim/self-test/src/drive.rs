//! The power stage of a drive: what becomes of a commanded force.

use super::delay_line::DelayLine;
use super::plant::STEP_S;
use super::servo::Settings;

/// A power stage: dead time, then a gain that may depend on the direction of the force, then a first-order lag.
pub(super) struct Drive {
    lag_s: f64,
    weakness: f64,
    dead: DelayLine,
    acting_n: f64,
}

impl Drive {
    pub(super) fn new(settings: &Settings) -> Self {
        let Settings { lag_s, weakness, dead_s, .. } = *settings;
        Self { lag_s, weakness, dead: DelayLine::new(dead_s, 0.0), acting_n: 0.0 }
    }

    /// Force on the motor in a step over which a force is commanded, N: with a lag, that at the start of the step.
    ///
    /// The plant moves the positions with the velocities in the middle of the steps, which the force at the start changes: with that
    /// at the end, the lag would be a step too short. Without a lag the force acts half a step early, which the tracer has to find.
    pub(super) fn acting_n(&mut self, commanded_n: f64) -> f64 {
        self.dead.push(commanded_n);
        let force_n = self.weakened(self.dead.value());
        if self.lag_s == 0.0 {
            return force_n;
        }
        let before_n = self.acting_n;
        let kept = libm::exp(-STEP_S / self.lag_s);
        self.acting_n = force_n + kept * (before_n - force_n);
        before_n
    }

    /// A positive weakness is that of forces in the positive direction, a negative one that of the others.
    fn weakened(&self, force_n: f64) -> f64 {
        if force_n * self.weakness > 0.0 { force_n * (1.0 - self.weakness.abs()) } else { force_n }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(change: impl Fn(&mut Settings)) -> Drive {
        let mut settings = Settings::default();
        change(&mut settings);
        Drive::new(&settings)
    }

    #[test]
    fn a_lag_of_the_drive_delays_a_step_of_force_by_its_time_constant() {
        let (lag_s, commanded_n) = (0.4e-3, 500.0);
        let mut lagging = drive(|settings| settings.lag_s = lag_s);
        // The force at the start of each step.
        for step in 0..20 {
            let expected_n = commanded_n * -(-f64::from(step) * STEP_S / lag_s).exp_m1();
            let acting_n = lagging.acting_n(commanded_n);
            assert!((acting_n - expected_n).abs() < 1e-9 * commanded_n, "{step}: {acting_n} {expected_n}");
        }
        assert!((drive(|_| {}).acting_n(commanded_n) - commanded_n).abs() < f64::EPSILON);
    }

    #[test]
    fn a_dead_time_passes_before_a_force_acts() {
        // Two ticks of 0.25 ms are ten steps.
        let mut dead = drive(|settings| settings.dead_s = 0.5e-3);
        let acting: Vec<f64> = (0..12).map(|_| dead.acting_n(100.0)).collect();
        let expected: Vec<f64> = (0..12).map(|step| if step < 10 { 0.0 } else { 100.0 }).collect();
        assert!(acting.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9), "{acting:?}");
    }

    #[test]
    fn a_drive_is_weaker_in_the_direction_of_the_sign_of_its_weakness() {
        for (weakness, expected) in [(0.1, [90.0, -100.0]), (-0.1, [100.0, -90.0])] {
            let mut weak = drive(|settings| settings.weakness = weakness);
            let acting = [100.0, -100.0].map(|force_n| weak.acting_n(force_n));
            assert!(acting.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{acting:?}");
        }
    }
}
