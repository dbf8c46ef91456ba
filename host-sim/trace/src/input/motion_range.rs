//! Travel, speed and acceleration of an axis in logs.

use super::signals::Signals;
use super::smoothing::Smooth;

/// Range of the motion of an axis in logs, by its table or motor; mm, or degrees for a rotary axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionRange {
    /// Middle of its travel.
    pub middle_mm: f64,
    /// Half of its travel.
    pub half_mm: f64,
    /// Largest speed.
    pub speed_mm_s: f64,
    /// Largest acceleration, m/s², or 1000°/s².
    pub acceleration_m_per_s2: f64,
}

impl MotionRange {
    /// The range of an axis, by its index; `None` if it does not move by at least `min_travel_mm`.
    #[must_use]
    pub fn of(logs: &[Signals], axis: usize, min_travel_mm: f64) -> Option<Self> {
        let signals = || logs.iter().filter_map(|log| log.axes.get(axis)?.table_or_motor());
        let greatest = |of: &dyn Fn(&Smooth) -> f64| signals().map(of).reduce(f64::max);
        let max = greatest(&|s| numerics::max(s.value.iter().copied()))?;
        let min = -greatest(&|s| numerics::max(s.value.iter().map(|m| -m)))?;
        let speed = greatest(&|s| numerics::max_abs(s.velocity.iter().copied()))?;
        let acceleration = greatest(&|s| numerics::max_abs(s.acceleration.iter().copied()))?;
        // An axis at rest in the logs has no range of motion.
        let half_mm = 500.0 * (max - min);
        (2.0 * half_mm >= min_travel_mm).then_some(Self {
            middle_mm: 500.0 * (max + min),
            half_mm,
            speed_mm_s: 1e3 * speed,
            acceleration_m_per_s2: acceleration,
        })
    }
}
