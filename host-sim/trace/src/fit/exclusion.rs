//! Exclusion of parts of a residual that no effect of the catalogue describes, so that they neither hide nor imitate an
//! effect.
//!
//! A vibration or a local defect of the travel can be larger than an effect. If one of them dominates the residual at the
//! end of the search, the search is repeated without the samples at that position, or with the bump or the oscillation
//! subtracted. The excluded part is reported as unexplained.

use model::effects::Stage;

/// An exclusion from the residual of one stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exclusion {
    /// Stage.
    pub stage: Stage,
    /// The excluded part.
    pub part: ExcludedPart,
}

/// A part of a residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExcludedPart {
    /// Samples at which the axis is between two positions, mm.
    Position {
        /// Lower end, inclusive.
        from_mm: f64,
        /// Upper end, exclusive.
        to_mm: f64,
    },
    /// A bump over the position of the axis, whose height is fitted to all logs.
    Bump(Bump),
    /// A sine, whose amplitude and phase are fitted in each log.
    Sine {
        /// Frequency, Hz.
        frequency_hz: f64,
    },
}

/// Place and width of exp(−((x − centre)/width)²/2) over the position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bump {
    /// Its centre, mm.
    pub centre_mm: f64,
    /// Its standard deviation, mm.
    pub width_mm: f64,
}

impl Bump {
    /// Its height at a position, as a fraction of that at the centre.
    #[must_use]
    pub fn at(&self, position_mm: f64) -> f64 {
        libm::exp(-0.5 * ((position_mm - self.centre_mm) / self.width_mm).powi(2))
    }
}

impl Exclusion {
    /// Whether a sample of a stage is excluded. `position_mm` returns the position of the axis, if it was measured.
    pub fn covers(&self, stage: Stage, position_mm: impl Fn() -> Option<f64>) -> bool {
        let ExcludedPart::Position { from_mm, to_mm } = self.part else { return false };
        self.stage == stage && position_mm().is_some_and(|mm| (from_mm..to_mm).contains(&mm))
    }

    /// The bump that is subtracted from a stage.
    #[must_use]
    pub fn bump(&self, stage: Stage) -> Option<Bump> {
        match self.part {
            ExcludedPart::Bump(bump) if self.stage == stage => Some(bump),
            _ => None,
        }
    }

    /// The frequency that is subtracted from a stage, Hz.
    #[must_use]
    pub fn frequency_hz(&self, stage: Stage) -> Option<f64> {
        match self.part {
            ExcludedPart::Sine { frequency_hz } if self.stage == stage => Some(frequency_hz),
            _ => None,
        }
    }
}

/// Subtracts the least-squares sine (amplitude and phase) with a phase step of `step_rad` per sample from the values that
/// count.
pub fn subtract_sine(values: &mut [f64], counts: &[bool], step_rad: f64) {
    let waves = || counts.iter().enumerate().map(|(i, counts)| (*counts, libm::sincos(step_rad * i as f64)));
    let mut sums = [0.0; 5];
    for ((counts, (sin, cos)), value) in waves().zip(values.iter()) {
        if counts {
            let terms = [cos * cos, sin * cos, sin * sin, cos * value, sin * value];
            sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        }
    }
    let [cc, sc, ss, cv, sv] = sums;
    let determinant = cc * ss - sc * sc;
    if determinant <= 0.0 {
        return;
    }
    let (a, b) = ((ss * cv - sc * sv) / determinant, (cc * sv - sc * cv) / determinant);
    for ((counts, (sin, cos)), value) in waves().zip(values) {
        if counts {
            *value -= a * cos + b * sin;
        }
    }
}
