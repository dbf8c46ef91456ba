//! Duration of a motion.

use shared::interpolate::Ramps;

use super::block::Pace;
use super::bounds::LONGEST_S;

/// Duration of the blocks so far.
#[derive(Clone, Debug, Default)]
pub struct Duration {
    /// At the programmed feeds, without the additional time of acceleration.
    at_feed_s: f64,
    ramp: FastestRamp,
}

impl Duration {
    /// Adds a standstill.
    pub const fn add_dwell(&mut self, seconds: f64) {
        self.at_feed_s += seconds;
    }

    /// Adds a path of this length.
    pub fn add_path(&mut self, length_mm: f64, pace: &Pace) {
        self.ramp.add(length_mm, pace);
        self.at_feed_s += 60.0 * length_mm / pace.feed_mm_per_min;
    }

    /// Whether the motion may last that long.
    pub fn is_permitted(&self) -> bool {
        let is_short = |seconds: f64| seconds <= LONGEST_S;
        is_short(self.at_feed_s) && (self.ramp.length_m == 0.0 || is_short(self.ramp.duration_s()))
    }
}

/// The fastest motion over the length of all blocks that their accelerations and jerks permit: a ramp from standstill.
#[derive(Clone, Debug, Default)]
struct FastestRamp {
    length_m: f64,
    acceleration_m_per_s2: f64,
    jerk_m_per_s3: f64,
}

impl FastestRamp {
    fn add(&mut self, length_mm: f64, pace: &Pace) {
        let jerk_m_per_s3 = match pace.ramps {
            Ramps::SCurve { jerk_m_per_s3 } => jerk_m_per_s3,
            _ => f64::INFINITY,
        };
        self.length_m += 1e-3 * length_mm;
        self.acceleration_m_per_s2 = self.acceleration_m_per_s2.max(pace.acceleration_m_per_s2);
        self.jerk_m_per_s3 = self.jerk_m_per_s3.max(jerk_m_per_s3);
    }

    /// From length = ½·acceleration·t² and length = ⅙·jerk·t³.
    fn duration_s(&self) -> f64 {
        let at_acceleration_s = (2.0 * self.length_m / self.acceleration_m_per_s2).sqrt();
        at_acceleration_s.max(libm::cbrt(6.0 * self.length_m / self.jerk_m_per_s3))
    }
}
