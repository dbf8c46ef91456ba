//! The difference between the logged force, which is that of one velocity tick, and the mean force of the sample, which moves
//! the axis.

use shared::config::Rates;

use model::axis::Controller;
use model::servo::{ServoParameters, velocity_source};

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
///
/// Where the output follows its readings d ticks later, the first d of the forces belong to the velocity command of the sample before. The
/// last one is higher by d/D of the step of Kv times the command. That is the change of the mean proportional force from sample to sample,
/// and Kv·D·T times the acceleration between both. In the rate of the integral force, which is weighted by the time that is left, the
/// proportional force is then Kv·a·T·d·(D − d)/(D − 1) less below its mean.
///
/// With an observer, the velocity that changes is that of its mean age before: so are both accelerations.
#[derive(Clone, Copy, Debug, Default)]
pub struct ForceSampling {
    /// Kv·T·(D − 1)/2, N per m/s².
    proportional_kg: f64,
    /// Kv·T·((D + 1)/6 − d·(D − d)/(D − 1)), N per m/s².
    integral_kg: f64,
    /// Kv·T·d, N per m/s².
    command_kg: f64,
    /// d/D.
    delay: f64,
    /// Ages of the acceleration a and of that between two samples of the position loop, samples.
    ages: [f64; 2],
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
        let periods = servo.computation_delay.periods;
        let delay = periods / ticks;
        let observer = velocity_source(controller).age_ticks(rates.velocity_loop_hz) / ticks;
        let of_integral = (ticks + 1.0) / 6.0;
        let of_delay = periods * (ticks - periods) / (ticks - 1.0).max(1.0);
        Self {
            proportional_kg: gain * ahead_s,
            integral_kg: gain * (of_integral - of_delay) / rates.velocity_loop_hz,
            command_kg: gain * periods / rates.velocity_loop_hz,
            delay,
            // Between the means of two samples, and half a tick older as a backward difference.
            ages: [(ticks + 4.0) / (3.0 * ticks) + delay + observer, 1.0 + 1.0 / ticks + observer],
            ahead_s,
            integral_s: servo.velocity_integral_time_s(controller).unwrap_or(f64::INFINITY),
        }
    }

    /// Replaces the controller's mean force of each sample, N, by that of the last tick. `acceleration_before` returns the acceleration some
    /// samples ago, m/s².
    pub fn last_ticks_from_means(
        &self,
        force_n: &mut [f64],
        acceleration_before: impl Fn(f64) -> Vec<f64>,
        sample_s: f64,
    ) {
        let [age_in_sample, age_between_samples] = self.ages;
        let in_sample = acceleration_before(age_in_sample);
        let late =
            (self.delay > 0.0).then(|| (self.changes(force_n), acceleration_before(age_between_samples)));
        let (ahead, low_pass) = (self.ahead_s / self.integral_s, -libm::expm1(-sample_s / self.integral_s));
        let mut of_integral_n = force_n.first().copied().unwrap_or(0.0);
        for (i, force_n) in force_n.iter_mut().enumerate() {
            let before_n = of_integral_n;
            of_integral_n += low_pass * (*force_n - before_n);
            // The mean belongs to the middle of the sample, at which the low-pass is the average of both ends.
            let proportional_n = *force_n - 0.5 * (before_n + of_integral_n);
            *force_n += ahead * (proportional_n - self.integral_kg * in_sample[i]);
            *force_n -= self.proportional_kg * in_sample[i];
            if let Some((change_n, between_samples)) = &late {
                let step_n = change_n[i] - proportional_n * sample_s / self.integral_s;
                *force_n += self.delay * step_n + self.command_kg * between_samples[i];
            }
        }
    }

    /// Change of the mean force from the sample before to that of the readings, N. The samples of the means are those of the output, which
    /// are later.
    fn changes(&self, force_n: &[f64]) -> Vec<f64> {
        let earlier = 0.5 - self.delay;
        let central = |i: usize| {
            let [before, after] = [i.saturating_sub(1), (i + 1).min(force_n.len() - 1)];
            (force_n[after] - force_n[before]) / (after - before).max(1) as f64
        };
        let of_output = |i: usize| (1.0 - earlier) * central(i) + earlier * central(i.saturating_sub(1));
        (0..force_n.len()).map(of_output).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::ComputationDelay;

    /// A simulated PI loop: four ticks per sample on a sine of 7 Hz, with the velocity command held over the sample.
    #[test]
    fn forces_of_last_ticks_follow_from_the_means() {
        // Kv·a·1.5·T is 87.1 N, 61.6 N rms. The integral part, 1.9 % of about 300 N, adds 4 to 5 N.
        let (before, after) = errors_n(0, None);
        assert!(before > 61.6 && before < 67.0, "{before} N");
        // The remaining error is that of one low-pass step per sample S, ω·S/12 of the integral part, 0.02 N, and ω·T/4 of its
        // correction, 0.01 N.
        assert!(after < 0.05 && after > 1e-4, "{after} N");
        // With outputs that are late, Kv·a·(1.5 − d)·T for d = 1 and 2: a third, 20.5 N rms, with either sign of the part of the integral.
        for periods in [1, 2] {
            let (before, after) = errors_n(periods, None);
            assert!(before > 15.0 && before < 26.0, "{before} N");
            assert!(after < 0.2 && after > 1e-4, "{periods}: {after} N");
        }
        // An observer of 300 Hz is 3.3 ticks late: 3.6 % of the phase at 7 Hz of what is corrected, 2.2 N without its age.
        let (before, after) = errors_n(0, Some(300.0));
        assert!(before > 61.6 && before < 67.0, "{before} N");
        assert!(after < 0.2 && after > 1e-4, "{after} N");
    }

    /// Rms difference of the last forces of the samples from the means, without and with the correction, N, if the forces are output
    /// some ticks after their readings, or the velocity is that of an observer.
    fn errors_n(periods: usize, velocity_observer_hz: Option<f64>) -> (f64, f64) {
        const TICKS: u32 = 4;
        let (tick_s, kv, ti_s, omega) = (0.25e-3, 6e4, 0.02, 44.0);
        let position = |t: f64| 2e-3 * (omega * t).sin();
        let (mut integral_m, mut observer) = (0.0, [0.0; 2]);
        let mut pending_n = vec![0.0; periods];
        let (mut means, mut lasts, mut ends_s) = (Vec::new(), Vec::new(), Vec::new());
        for sample in 0..2000u32 {
            let t = f64::from(TICKS * sample) * tick_s;
            let command = 2e-3 * omega * ((omega * t).cos() + 0.05 * (omega * t).sin());
            let mut sum = 0.0;
            for tick in 0..TICKS {
                let t = t + f64::from(tick) * tick_s;
                let mut velocity = (position(t) - position(t - tick_s)) / tick_s;
                if let Some(hz) = velocity_observer_hz {
                    for stage in &mut observer {
                        *stage -= (-std::f64::consts::TAU * hz * tick_s).exp_m1() * (velocity - *stage);
                        velocity = *stage;
                    }
                }
                let error = command - velocity;
                integral_m += tick_s * error;
                pending_n.push(kv * (error + integral_m / ti_s));
                let force_n = pending_n.remove(0);
                sum += force_n;
                if tick == TICKS - 1 {
                    lasts.push(force_n);
                }
            }
            means.push(sum / f64::from(TICKS));
            ends_s.push(t + f64::from(TICKS) * tick_s);
        }
        let controller = Controller {
            velocity_gain_n_s_per_m: Some(kv),
            velocity_integral_time_s: Some(ti_s),
            velocity_observer_hz,
            ..Controller::default()
        };
        let rates = Rates { velocity_loop_hz: 4000.0, position_loop_divider: TICKS };
        let computation_delay = ComputationDelay { periods: periods as f64 };
        let servo = ServoParameters { computation_delay, ..ServoParameters::default() };
        let sampling = ForceSampling::new(&controller, &servo, rates);
        let error_n = |forces: &[f64]| {
            let squares: f64 = (500..2000).map(|i| (forces[i] - lasts[i]).powi(2)).sum();
            (squares / 1500.0).sqrt()
        };
        let mut corrected = means.clone();
        let acceleration_before = |samples: f64| {
            let at = |end_s: &f64| -omega * omega * position(end_s - samples * 4.0 * tick_s);
            ends_s.iter().map(at).collect()
        };
        sampling.last_ticks_from_means(&mut corrected, acceleration_before, 4.0 * tick_s);
        (error_n(&means), error_n(&corrected))
    }
}
