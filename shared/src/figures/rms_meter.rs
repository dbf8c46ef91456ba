//! The rms of following error and force: squares are summed in the tick, in integers; the roots are taken when a host asks.

use serde::{Deserialize, Serialize};

use super::rms;

/// Greatest magnitude of a value in the sum, steps; a greater one counts as this. Of following errors it is 8.4 mm, of forces 131 kN.
pub const LARGEST: i32 = 1 << 23;

/// Greatest number of ticks in a window, so that the sum of their squares is below 2⁶³.
const LONGEST_WINDOW: u32 = 1 << 17;

/// Steps of a force in 1 N.
const STEPS_PER_N: f32 = 64.0;

/// The rms of an axis over the last complete window.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisRms {
    /// Command − motor reading, nm.
    pub error_nm: f32,
    /// Force, N.
    pub force_n: f32,
}

/// Sums of squares of each axis: of the error in nm and of the force in 1/64 N.
type Sums<const N: usize> = [[u64; 2]; N];

/// Sums the squares of windows that follow each other.
#[derive(Clone, Debug)]
pub struct RmsMeter<const N: usize> {
    /// Ticks of a window.
    window: u32,
    ticks: u32,
    sums: Sums<N>,
    complete: Option<Sums<N>>,
}

impl<const N: usize> RmsMeter<N> {
    /// With windows of a number of ticks, 1 to 2¹⁷.
    #[must_use]
    pub fn new(window: u32) -> Self {
        Self { window: window.clamp(1, LONGEST_WINDOW), ticks: 0, sums: [[0; 2]; N], complete: None }
    }

    /// A tick with the drives on: following errors in nm and forces in 1/64 N of each axis.
    pub fn add(&mut self, values: &[[i64; 2]; N]) {
        for (sums, values) in self.sums.iter_mut().zip(values) {
            for (sum, value) in sums.iter_mut().zip(values) {
                let magnitude = value.unsigned_abs().min(u64::from(LARGEST.unsigned_abs()));
                *sum += magnitude * magnitude;
            }
        }
        self.ticks += 1;
        if self.ticks >= self.window {
            self.complete = Some(self.sums);
            (self.ticks, self.sums) = (0, [[0; 2]; N]);
        }
    }

    /// A tick with the drives off: nothing is known any more.
    pub fn clear(&mut self) {
        if self.ticks > 0 || self.complete.is_some() {
            (self.ticks, self.sums, self.complete) = (0, [[0; 2]; N], None);
        }
    }

    /// The rms of an axis over the last window; `None` before one is complete. Not for a tick.
    #[must_use]
    pub fn axis(&self, axis: usize) -> Option<AxisRms> {
        let [error, force] = *self.complete.as_ref()?.get(axis)?;
        Some(AxisRms { error_nm: rms(error, self.window), force_n: rms(force, self.window) / STEPS_PER_N })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// √(Σ v²/n) over the window, to the error of the root and of the rounding of an f32; the values before and after it do not count.
        #[test]
        fn the_rms_is_that_of_the_window(values in prop::collection::vec(-1_000_000i64..1_000_000, 8)) {
            let mut meter = RmsMeter::<1>::new(8);
            for _ in 0..8 {
                meter.add(&[[7_000_000, 1]]);
            }
            for value in &values {
                meter.add(&[[*value, value / 2]]);
            }
            for _ in 0..7 {
                meter.add(&[[7_000_000, 1]]);
            }
            let exact = |values: &mut dyn Iterator<Item = i64>| {
                libm::sqrt(values.map(|v| (v * v) as f64).sum::<f64>() / 8.0)
            };
            let rms = meter.axis(0).unwrap();
            let error = exact(&mut values.iter().copied());
            let force = exact(&mut values.iter().map(|v| v / 2)) / 64.0;
            prop_assert!((f64::from(rms.error_nm) - error).abs() <= 1e-5 * error, "{rms:?}, {error}");
            prop_assert!((f64::from(rms.force_n) - force).abs() <= 1e-5 * force, "{rms:?}, {force}");
        }
    }

    /// A window that was begun before the drives went off is not continued.
    #[test]
    fn drives_that_were_off_begin_a_new_window() {
        let mut meter = RmsMeter::<1>::new(4);
        meter.add(&[[1000, 6400]]);
        meter.clear();
        for _ in 0..3 {
            meter.add(&[[3, 64]]);
            assert_eq!(meter.axis(0), None);
        }
        meter.add(&[[3, 64]]);
        let AxisRms { error_nm, force_n } = meter.axis(0).unwrap();
        assert!((error_nm - 3.0).abs() < 1e-4 && (force_n - 1.0).abs() < 1e-5);
    }

    /// The longest window of the largest values does not overflow, and drives that are off leave nothing behind.
    #[test]
    fn the_sums_hold_the_longest_window() {
        let mut meter = RmsMeter::<1>::new(u32::MAX);
        for _ in 0..LONGEST_WINDOW {
            assert_eq!(meter.axis(0), None);
            meter.add(&[[i64::MIN, i64::MAX]]);
        }
        let AxisRms { error_nm, force_n } = meter.axis(0).unwrap();
        assert!((error_nm / 8_388_608.0 - 1.0).abs() < 1e-5 && (force_n / 131_072.0 - 1.0).abs() < 1e-5);
        assert_eq!(meter.axis(1), None);
        meter.clear();
        assert_eq!(meter.axis(0), None);
        for _ in 1..LONGEST_WINDOW {
            meter.add(&[[3, 64]]);
        }
        assert_eq!(meter.axis(0), None);
        meter.add(&[[3, 64]]);
        let AxisRms { error_nm, force_n } = meter.axis(0).unwrap();
        assert!((error_nm - 3.0).abs() < 1e-4 && (force_n - 1.0).abs() < 1e-5);
    }
}
