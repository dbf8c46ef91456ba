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
    /// step, the tool would be half a step late or early. ω in 1/s, and ζ; none: rigid. The damper is between the mass and the ground, or
    /// between the mass and the table.
    pub(super) fn step(
        &mut self,
        [from_m, to_m]: [f64; 2],
        resonance: Option<[f64; 2]>,
        is_damped_by_table: bool,
    ) {
        let Some([omega, zeta]) = resonance else {
            self.at_m = to_m;
            return;
        };
        let damper_m_per_s = if is_damped_by_table { (to_m - from_m) / STEP_S } else { 0.0 };
        // The damping is that of the mean of the velocities before and after: otherwise a step h would shift the frequency by ζωh/2.
        for step in 0..STEPS {
            let fraction = f64::from(step) / f64::from(STEPS);
            let table_m = from_m + fraction * (to_m - from_m);
            let damping = zeta * omega * MODE_STEP_S;
            let pull = MODE_STEP_S * omega * omega * (table_m - self.at_m) + 2.0 * damping * damper_m_per_s;
            self.m_per_s = (self.m_per_s * (1.0 - damping) + pull) / (1.0 + damping);
            self.at_m += MODE_STEP_S * self.m_per_s;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// The tool against H·table, H = (1 + 2jζr)/(1 − r² + 2jζr) with the damper at the table and 1/(1 − r² + 2jζr) with it at the ground, r = Ω/ω.
    ///
    /// The table moves evenly within a step h of the plant, which reduces its sine by sinc², 1 − (Ω·h)²/12. The speed of a damper at the table is
    /// that of the coming step of the mode, half of such a step early. Of the transient e^(−20) is left.
    #[test]
    fn a_mode_follows_the_transfer_function_of_its_damper() {
        let (omega, zeta) = (TAU * 60.0, 0.1);
        for (hertz, by_table) in [20.0, 60.0, 120.0].into_iter().flat_map(|hz| [(hz, false), (hz, true)]) {
            let forced = TAU * hertz;
            let r = forced / omega;
            let (real, imaginary) = (1.0 - r * r, 2.0 * zeta * r);
            let [own, other] = [by_table, !by_table].map(|by_table| if by_table { imaginary } else { 0.0 });
            let gain = own.hypot(1.0) / real.hypot(imaginary);
            let phase = own.atan2(1.0) - imaginary.atan2(real);
            let early = own / real.hypot(imaginary) * 0.5 * forced * MODE_STEP_S;
            let bound = 1.1 * (gain * (forced * STEP_S).powi(2) / 12.0 + early) + 1e-6;
            // Both dampers differ by the term of the damper.
            assert!((own - other).abs() / real.hypot(imaginary) > 20.0 * bound, "{hertz}: {bound}");
            let table_m = |step: u32| (forced * STEP_S * f64::from(step)).sin();
            let mut mode = Mode::resting(0.0);
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "some thousand steps"
            )]
            let settling = (20.0 / (zeta * omega * STEP_S)).round() as u32;
            for step in 0..settling + 1000 {
                mode.step([table_m(step), table_m(step + 1)], Some([omega, zeta]), by_table);
                let expected_m = gain * (forced * STEP_S * f64::from(step + 1) + phase).sin();
                let is_settled = step >= settling;
                assert!(!is_settled || (mode.at_m - expected_m).abs() < bound, "{hertz} {by_table} {step}");
            }
        }
    }

    #[test]
    fn a_mode_lags_an_even_acceleration_by_it_over_the_frequency_squared() {
        let (omega, zeta, acceleration) = (TAU * 40.0, 0.1, 3.0);
        let table_m = |step: u32| 0.5 * acceleration * (STEP_S * f64::from(step)).powi(2);
        let mut mode = Mode::resting(0.0);
        // 1 s: e^−25 of the transient is left. The damping acts on the mode's own speed relative to the table at rest.
        for step in 0..20_000 {
            mode.step([table_m(step), table_m(step + 1)], Some([omega, zeta]), false);
        }
        let speed = acceleration;
        let expected_m = -(acceleration + 2.0 * zeta * omega * speed) / (omega * omega);
        let found_m = mode.at_m - table_m(20_000);
        assert!((found_m / expected_m - 1.0).abs() < 0.02, "{found_m} {expected_m}");
    }
}
