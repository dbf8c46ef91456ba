//! The way of a position from its sensor to the position loop: a delay and a filter.

use super::delay_line::DelayLine;
use super::plant::STEP_S;

/// Delay and filter of the position feedback.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pickup {
    /// Age of the position, s.
    pub delay_s: f64,
    /// Filter in front of the position loop.
    pub filter: Filter,
}

/// A filter of gain 1 at frequency 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Filter {
    /// None.
    #[default]
    None,
    /// 1/(τs + 1), τ in s.
    LowPass(f64),
    /// (s² + ω²)/(s² + 2ζωs + ω²): ω in 1/s, and ζ.
    Notch([f64; 2]),
}

/// The state of a [`Pickup`].
pub(super) struct PickedUp {
    filter: Filter,
    delay: DelayLine,
    low_m: f64,
    band_m: f64,
    value_m: f64,
}

impl PickedUp {
    /// At rest.
    pub(super) fn new(pickup: Pickup, start_m: f64) -> Self {
        let delay = DelayLine::new(pickup.delay_s, start_m);
        Self { filter: pickup.filter, delay, low_m: start_m, band_m: 0.0, value_m: start_m }
    }

    /// The reading after a further step of the plant.
    pub(super) fn push(&mut self, reading_m: f64) {
        self.delay.push(reading_m);
        let delayed_m = self.delay.value();
        self.value_m = match self.filter {
            Filter::None => delayed_m,
            Filter::LowPass(time_s) => {
                self.low_m -= libm::expm1(-STEP_S / time_s) * (delayed_m - self.low_m);
                self.low_m
            }
            Filter::Notch([omega, zeta]) => {
                // State variables of the band 2ζωs/(s² + 2ζωs + ω²), which the notch lacks.
                let high_m = delayed_m - self.low_m - 2.0 * zeta * self.band_m;
                self.band_m += STEP_S * omega * high_m;
                self.low_m += STEP_S * omega * self.band_m;
                delayed_m - 2.0 * zeta * self.band_m
            }
        };
    }

    /// What the position loop uses, m.
    pub(super) fn value_m(&self) -> f64 {
        self.value_m
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn last(pickup: Pickup, signal: impl Fn(f64) -> f64, steps: u32) -> f64 {
        let mut picked = PickedUp::new(pickup, signal(0.0));
        (1..=steps).for_each(|step| picked.push(signal(STEP_S * f64::from(step))));
        picked.value_m()
    }

    #[test]
    fn a_ramp_is_late_by_the_delay_and_the_slope_of_the_phase_at_frequency_0() {
        let omega = TAU * 60.0;
        for (filter, lag_s) in [
            (Filter::None, 0.0),
            (Filter::LowPass(1e-3), 1e-3),
            // 1 − 2ζωs/ω² + …: 2ζ/ω.
            (Filter::Notch([omega, 0.4]), 0.8 / omega),
        ] {
            let late = last(Pickup { delay_s: 1.3e-3, filter }, |t| 0.05 * t, 20_000);
            // The steps of the filters are one-sided: half a step.
            let found_s = 1.0 - late / 0.05;
            assert!((found_s - 1.3e-3 - lag_s).abs() < 0.6 * STEP_S, "{filter:?}: {found_s}");
        }
    }

    #[test]
    fn a_notch_removes_its_frequency_and_keeps_a_much_lower_one() {
        let omega = TAU * 60.0;
        let pickup = Pickup { delay_s: 0.0, filter: Filter::Notch([omega, 0.4]) };
        // Whole periods after 1 s, at the peak of the cosine.
        assert!(last(pickup, |t| (omega * t).cos(), 20_000).abs() < 0.02);
        assert!((last(pickup, |t| (TAU * 2.0 * t).cos(), 20_000) - 1.0).abs() < 0.01);
    }
}
