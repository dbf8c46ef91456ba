//! Means of a deviation over sectors of a turn.

use std::f64::consts::TAU;

/// Sectors of a turn, 0.25° each.
pub const SECTORS: usize = 1440;

/// Largest gap in a lap that still counts as full, in sectors: 10°. The start of a log is not evaluated.
const MAX_GAP: usize = SECTORS / 36;

/// The deviation in each sector of a turn, averaged over its samples and over all turns.
#[derive(Clone, Debug)]
pub struct Sectors {
    /// Sum of the deviations, µm, and number of samples of each sector.
    sums: Vec<(f64, u32)>,
}

impl Default for Sectors {
    fn default() -> Self {
        Self::new()
    }
}

impl Sectors {
    /// No samples.
    #[must_use]
    pub fn new() -> Self {
        Self { sums: vec![(0.0, 0); SECTORS] }
    }

    /// Adds a deviation, µm, at an angle, rad.
    pub fn add(&mut self, angle_rad: f64, deviation_um: f64) {
        let turn = angle_rad.rem_euclid(TAU) / TAU;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1440")]
        let sector = (turn * SECTORS as f64) as usize % SECTORS;
        let (sum, count) = &mut self.sums[sector];
        *sum += deviation_um;
        *count += 1;
    }

    /// Whether no gap is larger than 10°.
    #[must_use]
    pub fn is_full(&self) -> bool {
        let is_empty = |i: usize| self.sums[i % SECTORS].1 == 0;
        !(0..SECTORS).any(|from| (from..=from + MAX_GAP).all(is_empty))
    }

    /// Mean deviation of a sector, µm; `None` without samples.
    #[must_use]
    pub fn mean_um(&self, sector: usize) -> Option<f64> {
        let (sum, count) = *self.sums.get(sector)?;
        (count > 0).then(|| sum / f64::from(count))
    }

    /// Angle of the middle (rad) and mean deviation (µm) of the sectors that have samples.
    #[must_use]
    pub fn points(&self) -> Vec<(f64, f64)> {
        (0..SECTORS).filter_map(|i| Some((middle_rad(i), self.mean_um(i)?))).collect()
    }
}

/// Angle of the middle of a sector, rad.
#[must_use]
pub fn middle_rad(sector: usize) -> f64 {
    TAU * (sector as f64 + 0.5) / SECTORS as f64
}
