//! A mode of the tool: a mass on a spring and a damper that the table carries.

use super::plant::STEP_S;

/// Integration steps of a mode per step of the plant.
const STEPS: u32 = 20;
const MODE_STEP_S: f64 = STEP_S / 20.0;

/// State of a mode.
pub(super) struct Mode {
    /// Its position.
    pub(super) at_m: f64,
    m_per_s: f64,
}

impl Mode {
    pub(super) fn resting(at_m: f64) -> Self {
        Self { at_m, m_per_s: 0.0 }
    }

    /// A step of the plant, in which the table moves evenly from one position to another. With either of them for the whole
    /// step, the tool would be half a step late or early. ω in 1/s, and ζ; none: rigid.
    pub(super) fn step(&mut self, [from_m, to_m]: [f64; 2], resonance: Option<[f64; 2]>) {
        let Some([omega, zeta]) = resonance else {
            self.at_m = to_m;
            return;
        };
        // The damping is that of the mean of the velocities before and after: otherwise a step h would shift the frequency by ζωh/2.
        for step in 0..STEPS {
            let fraction = f64::from(step) / f64::from(STEPS);
            let table_m = from_m + fraction * (to_m - from_m);
            let damping = zeta * omega * MODE_STEP_S;
            let pull = MODE_STEP_S * omega * omega * (table_m - self.at_m);
            self.m_per_s = (self.m_per_s * (1.0 - damping) + pull) / (1.0 + damping);
            self.at_m += MODE_STEP_S * self.m_per_s;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    #[test]
    fn a_mode_lags_an_even_acceleration_by_it_over_the_frequency_squared() {
        let (omega, zeta, acceleration) = (TAU * 40.0, 0.1, 3.0);
        let table_m = |step: u32| 0.5 * acceleration * (STEP_S * f64::from(step)).powi(2);
        let mut mode = Mode::resting(0.0);
        // 1 s: e^−25 of the transient is left. The damping acts on the mode's own speed relative to the table at rest.
        for step in 0..20_000 {
            mode.step([table_m(step), table_m(step + 1)], Some([omega, zeta]));
        }
        let speed = acceleration;
        let expected_m = -(acceleration + 2.0 * zeta * omega * speed) / (omega * omega);
        let found_m = mode.at_m - table_m(20_000);
        assert!((found_m / expected_m - 1.0).abs() < 0.02, "{found_m} {expected_m}");
    }
}
