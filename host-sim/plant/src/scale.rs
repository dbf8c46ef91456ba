//! Errors of the linear scale, and the growth of screw and scale with heat.
//!
//! The growth of a screw is added to table and tool behind the mechanics: it is so slow that it causes no force.

use model::effects::{PeriodicError, ScaleGain, ThermalGrowth};

/// The errors of a scale's reading. The closed loop reads them, too.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scale {
    /// Error in proportion to the position.
    pub gain: ScaleGain,
    /// Periodic errors.
    pub periodic: Vec<PeriodicError>,
    /// Growth of the screw or of the scale.
    pub growth: Option<ThermalGrowth>,
}

impl Scale {
    /// Reading − position, m, at a position of the table without growth (m) and a time of the session (s).
    #[must_use]
    #[inline]
    pub fn error_m(&self, table_m: f64, time_s: f64) -> f64 {
        let growth_m = self.growth.as_ref().map_or(0.0, |growth| growth.reading_m(table_m, time_s));
        let periodic_m: f64 = self.periodic.iter().map(|error| error.error_m(table_m)).sum();
        self.gain.error_m(table_m) + periodic_m + growth_m
    }

    /// Displacement of the tool by the growth of the screw, m.
    #[must_use]
    #[inline]
    pub fn displacement_m(&self, table_m: f64, time_s: f64) -> f64 {
        self.growth.as_ref().map_or(0.0, |growth| growth.displacement_m(table_m, time_s))
    }

    /// Position of the table without growth, m, of a reading (m). The errors are so small that those at the reading are those at the position:
    /// of an amplitude A with a period λ, 2π·A/λ of it remains, some 1e-3.
    #[must_use]
    #[inline]
    pub fn table_of_reading_m(&self, reading_m: f64, time_s: f64) -> f64 {
        reading_m - self.error_m(reading_m, time_s)
    }
}
