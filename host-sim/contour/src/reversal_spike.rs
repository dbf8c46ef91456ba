//! The peak of the radial deviation at the reversal of an axis: friction stops the axis for some milliseconds.
//!
//! Around each of the angles 0, 90, 180 and 270°, the height is that of the highest point within 6° above the higher of two
//! levels, the means from 6 to 10° before and after the reversal; or, negative, that of the lowest point below the lower
//! level, if that is larger. A step at the reversal (backlash) therefore has no height. An oval a·cos 2θ has a height of
//! a·(1 − cos 16°) = 0.04·a.

use super::circular_test::{Lap, POINTS};

/// Points of a lap per degree.
const PER_DEGREE: usize = POINTS / 360;

/// Largest angle of the peak from the reversal, and largest angle of the levels, degrees.
const PEAK_DEGREES: usize = 6;
const LEVEL_DEGREES: usize = 10;

/// Heights at 0, 90, 180 and 270°, µm.
pub(crate) fn of(lap: &Lap) -> [f64; 4] {
    [0, 90, 180, 270].map(|degrees| height_um(lap, degrees * PER_DEGREE))
}

fn height_um(lap: &Lap, reversal: usize) -> f64 {
    let (peak, level) = (PEAK_DEGREES * PER_DEGREE, LEVEL_DEGREES * PER_DEGREE);
    let after = |step: usize| lap.deviation_um[(reversal + step) % POINTS];
    let before = |step: usize| lap.deviation_um[(reversal + POINTS - step) % POINTS];
    let levels = [numerics::mean((peak..=level).map(after)), numerics::mean((peak..=level).map(before))];
    let [lowest, highest] = numerics::min_max((0..=peak).flat_map(|step| [after(step), before(step)]));
    let [low, high] = numerics::min_max(levels);
    let (outward, inward) = ((highest - high).max(0.0), (low - lowest).max(0.0));
    if outward >= inward { outward } else { -inward }
}
