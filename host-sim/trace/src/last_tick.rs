//! The force that is logged beside the force that moved the axis.

use shared::config::Rates;

use model::axis::Controller;

/// By what the force of the last velocity tick of a sample, which is the one that is logged, differs from the mean of
/// the sample's D ticks of T, which is the one that moved the axis.
///
/// The velocity command stands for them while the velocity grows by a·T each: the last tick's velocity error lies
/// a·T·(D − 1)/2 below the mean, and its force Kv times that. The integral part meanwhile goes on by its slope, the
/// proportional part over Ti, and is ahead of its mean by T·(D − 1)/2 of that; the ticks that take it there lie
/// (D + 1)/6 of T behind the middle. To the next order the growth is that at 2·(D − 2)/3 of T into the sample. The proportional part is what the force is without its low-pass of Ti.
#[derive(Clone, Copy, Debug, Default)]
pub struct LastTick {
    /// Less force per acceleration in the last tick, N per m/s².
    last_lacks_kg: f64,
    /// The same on the way of the integral.
    way_lacks_kg: f64,
    /// How long ago the velocity grew so, samples.
    pub growth_age: f64,
    /// Middle of the ticks to the last of them, s.
    ahead_s: f64,
    /// Ti, s; infinite without an integral part.
    integral_s: f64,
}

impl LastTick {
    /// Of the controller of an axis.
    #[must_use]
    pub fn new(controller: &Controller, rates: Rates) -> Self {
        let ticks = f64::from(rates.position_loop_divider);
        let ahead_s = 0.5 * (ticks - 1.0) / rates.velocity_loop_hz;
        let gain = controller.velocity_gain_n_s_per_m.unwrap_or(0.0);
        Self {
            last_lacks_kg: gain * ahead_s,
            way_lacks_kg: gain * (ticks + 1.0) / 6.0 / rates.velocity_loop_hz,
            growth_age: (ticks + 4.0) / (3.0 * ticks),
            ahead_s,
            integral_s: controller.velocity_integral_time_s.unwrap_or(f64::INFINITY),
        }
    }

    /// Makes of the mean forces of samples that the controller gave, N, those of their last ticks; with the accelerations of
    /// [`LastTick::growth_age`] ago, m/s².
    pub fn of_means(&self, force_n: &mut [f64], acceleration: &[f64], sample_s: f64) {
        let (share, takes) = (self.ahead_s / self.integral_s, -(-sample_s / self.integral_s).exp_m1());
        let mut of_integral_n = force_n.first().copied().unwrap_or(0.0);
        for (force_n, acceleration) in force_n.iter_mut().zip(acceleration) {
            let before_n = of_integral_n;
            of_integral_n += takes * (*force_n - before_n);
            // In the middle of the sample, where the mean is.
            let proportional_n = *force_n - 0.5 * (before_n + of_integral_n);
            *force_n += share * (proportional_n - self.way_lacks_kg * acceleration);
            *force_n -= self.last_lacks_kg * acceleration;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A PI loop written out: four ticks a sample on a swing at 7 Hz, the command held and ahead by what it likes.
    #[test]
    fn the_last_tick_is_the_mean_less_what_it_lacks() {
        const TICKS: u32 = 4;
        let (tick_s, kv, ti_s, omega) = (0.25e-3, 6e4, 0.02, 44.0);
        let place = |t: f64| 2e-3 * (omega * t).sin();
        let mut integral_m = 0.0;
        let (mut means, mut lasts, mut accelerations) = (Vec::new(), Vec::new(), Vec::new());
        for sample in 0..2000u32 {
            let t = f64::from(TICKS * sample) * tick_s;
            let asked = 2e-3 * omega * ((omega * t).cos() + 0.05 * (omega * t).sin());
            let mut sum = 0.0;
            for tick in 0..TICKS {
                let t = t + f64::from(tick) * tick_s;
                let error = asked - (place(t) - place(t - tick_s)) / tick_s;
                integral_m += tick_s * error;
                let force_n = kv * (error + integral_m / ti_s);
                sum += force_n;
                if tick == TICKS - 1 {
                    lasts.push(force_n);
                }
            }
            means.push(sum / f64::from(TICKS));
            accelerations.push(-omega * omega * place(t + 4.0 / 3.0 * tick_s));
        }
        let controller = Controller {
            velocity_gain_n_s_per_m: Some(kv),
            velocity_integral_time_s: Some(ti_s),
            ..Controller::default()
        };
        let last_tick =
            LastTick::new(&controller, Rates { velocity_loop_hz: 4000.0, position_loop_divider: TICKS });
        let off = |forces: &[f64]| {
            let squares: f64 = (500..2000).map(|i| (forces[i] - lasts[i]).powi(2)).sum();
            (squares / 1500.0).sqrt()
        };
        let mut corrected = means.clone();
        last_tick.of_means(&mut corrected, &accelerations, 4.0 * tick_s);
        // a·Kv·1.5·T is 87.1 N, 61.6 rms; the integral's way, 1.9 % of some 300 N, adds 4 to 5. What stays is what a sample
        // of the low-pass is coarse, ω·S/12 of the way, 0.02 N, and ω·T/4 of what the way lacks, 0.01 N.
        let (before, after) = (off(&means), off(&corrected));
        assert!(before > 61.6 && before < 67.0, "{before} N");
        assert!(after < 0.05 && after > 1e-4, "{after} N");
    }
}
