//! The difference between the logged force, which is that of one velocity tick, and the mean force of the sample, which moves
//! the axis.

use shared::config::Rates;

use model::axis::Controller;
use model::servo::ServoParameters;

/// Difference between the logged force of the last velocity tick of a sample and the mean over the sample's D ticks of period
/// T.
///
/// The velocity command is constant over the D ticks, while the velocity changes by a·T in each. Therefore
///
/// - the proportional force of the last tick is Kv·a·T·(D − 1)/2 below its mean;
/// - the integral force changes at the rate (proportional force)/Ti and is therefore in the last tick above its mean by
///   this rate times T·(D − 1)/2. In this rate, the proportional force is Kv·a·T·(D + 1)/6 below its mean.
///
/// To the next order, a is the acceleration at 2·(D − 2)/3 ticks after the start of the sample. The proportional force is
/// the force less its low-pass with time constant Ti.
#[derive(Clone, Copy, Debug, Default)]
pub struct ForceSampling {
    /// Kv·T·(D − 1)/2, N per m/s².
    proportional_kg: f64,
    /// Kv·T·(D + 1)/6, N per m/s².
    integral_kg: f64,
    /// Age of the acceleration a, samples.
    pub growth_age: f64,
    /// T·(D − 1)/2, s.
    ahead_s: f64,
    /// Ti, s; infinite without an integral part.
    integral_s: f64,
}

impl ForceSampling {
    /// The difference for a controller with the effects in it, and its loop rates.
    #[must_use]
    pub fn new(controller: &Controller, servo: &ServoParameters, rates: Rates) -> Self {
        let ticks = f64::from(rates.position_loop_divider);
        let ahead_s = 0.5 * (ticks - 1.0) / rates.velocity_loop_hz;
        let gain = servo.velocity_gain_n_s_per_m(controller).unwrap_or(0.0);
        Self {
            proportional_kg: gain * ahead_s,
            integral_kg: gain * (ticks + 1.0) / 6.0 / rates.velocity_loop_hz,
            growth_age: (ticks + 4.0) / (3.0 * ticks),
            ahead_s,
            integral_s: servo.velocity_integral_time_s(controller).unwrap_or(f64::INFINITY),
        }
    }

    /// Replaces the controller's mean force of each sample, N, by that of the last tick. `acceleration` is that of
    /// [`ForceSampling::growth_age`] samples ago, m/s².
    pub fn last_ticks_from_means(&self, force_n: &mut [f64], acceleration: &[f64], sample_s: f64) {
        let (ahead, low_pass) = (self.ahead_s / self.integral_s, -(-sample_s / self.integral_s).exp_m1());
        let mut of_integral_n = force_n.first().copied().unwrap_or(0.0);
        for (force_n, acceleration) in force_n.iter_mut().zip(acceleration) {
            let before_n = of_integral_n;
            of_integral_n += low_pass * (*force_n - before_n);
            // The mean belongs to the middle of the sample, at which the low-pass is the average of both ends.
            let proportional_n = *force_n - 0.5 * (before_n + of_integral_n);
            *force_n += ahead * (proportional_n - self.integral_kg * acceleration);
            *force_n -= self.proportional_kg * acceleration;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A simulated PI loop: four ticks per sample on a sine of 7 Hz, with the velocity command held over the sample.
    #[test]
    fn forces_of_last_ticks_follow_from_the_means() {
        const TICKS: u32 = 4;
        let (tick_s, kv, ti_s, omega) = (0.25e-3, 6e4, 0.02, 44.0);
        let position = |t: f64| 2e-3 * (omega * t).sin();
        let mut integral_m = 0.0;
        let (mut means, mut lasts, mut accelerations) = (Vec::new(), Vec::new(), Vec::new());
        for sample in 0..2000u32 {
            let t = f64::from(TICKS * sample) * tick_s;
            let command = 2e-3 * omega * ((omega * t).cos() + 0.05 * (omega * t).sin());
            let mut sum = 0.0;
            for tick in 0..TICKS {
                let t = t + f64::from(tick) * tick_s;
                let error = command - (position(t) - position(t - tick_s)) / tick_s;
                integral_m += tick_s * error;
                let force_n = kv * (error + integral_m / ti_s);
                sum += force_n;
                if tick == TICKS - 1 {
                    lasts.push(force_n);
                }
            }
            means.push(sum / f64::from(TICKS));
            accelerations.push(-omega * omega * position(t + 4.0 / 3.0 * tick_s));
        }
        let controller = Controller {
            velocity_gain_n_s_per_m: Some(kv),
            velocity_integral_time_s: Some(ti_s),
            ..Controller::default()
        };
        let rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: TICKS };
        let sampling = ForceSampling::new(&controller, &ServoParameters::default(), rates);
        let error_n = |forces: &[f64]| {
            let squares: f64 = (500..2000).map(|i| (forces[i] - lasts[i]).powi(2)).sum();
            (squares / 1500.0).sqrt()
        };
        let mut corrected = means.clone();
        sampling.last_ticks_from_means(&mut corrected, &accelerations, 4.0 * tick_s);
        // Kv·a·1.5·T is 87.1 N, 61.6 N rms. The integral part, 1.9 % of about 300 N, adds 4 to 5 N. The remaining error is
        // that of one low-pass step per sample S, ω·S/12 of the integral part, 0.02 N, and ω·T/4 of its correction, 0.01 N.
        let (before, after) = (error_n(&means), error_n(&corrected));
        assert!(before > 61.6 && before < 67.0, "{before} N");
        assert!(after < 0.05 && after > 1e-4, "{after} N");
    }
}
