//! The ticks of an axis: steps of 1, 2 or 5 times a power of ten, and their labels.

use files::format::fixed;

/// A tick.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tick {
    /// Its place, from 0 at the lower end of the axis to 1 at the upper.
    pub place: f64,
    /// Its label.
    pub label: String,
    /// Whether it is one of the few that are labelled where there is little room.
    pub is_coarse: bool,
}

/// The ticks within two ends: at most `most` steps, and at most `few` of the coarse ones; no step is below `least`, which is 0 or 1.
pub(super) fn within([low, high]: [f64; 2], most: u32, few: u32, least: f64) -> Vec<Tick> {
    let range = high - low;
    let step = step_of((range / f64::from(most)).max(least));
    let every = coarser(step, range / f64::from(few));
    #[expect(
        clippy::cast_possible_truncation,
        reason = "a range has few steps, and an axis starts near its range"
    )]
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    let decimals = decimals(step);
    let tick = |index: i64| {
        let value = index as f64 * step;
        Tick {
            place: (value - low) / range,
            label: fixed(value, decimals),
            is_coarse: index.rem_euclid(every) == 0,
        }
    };
    (first..=last).map(tick).collect()
}

/// The smallest of 1, 2 and 5 times a power of ten that is not below `least`.
fn step_of(least: f64) -> f64 {
    let power = libm::pow(10_f64, libm::log10(least).floor());
    // A step that is `least` but for rounding is that step.
    [1.0, 2.0, 5.0]
        .into_iter()
        .map(|m| m * power)
        .find(|step| *step >= least * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

/// How many steps a coarse step has, which is not below `least`.
fn coarser(step: f64, least: f64) -> i64 {
    [1, 2, 5].into_iter().find(|steps| *steps as f64 * step >= least * (1.0 - 1e-9)).unwrap_or(10)
}

/// As many decimals as neighbouring labels need to differ.
fn decimals(step: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 9")]
    let decimals = (-libm::log10(step * 1.001).floor()).clamp(0.0, 9.0) as usize;
    decimals
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(ends: [f64; 2], most: u32) -> Vec<String> {
        within(ends, most, most, 0.0).into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn labels_have_the_digits_they_need() {
        assert_eq!(labels([0.0, 0.31], 6), ["0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(labels([-0.04, 0.02], 6), ["−0.04", "−0.03", "−0.02", "−0.01", "0.00", "0.01", "0.02"]);
        assert_eq!(labels([400.0, 6400.0], 6), ["1000", "2000", "3000", "4000", "5000", "6000"]);
        assert_eq!(labels([-1.7, 0.2], 6), ["−1.5", "−1.0", "−0.5", "0.0"]);
    }

    /// The runs of a test are counted: there is no run 1.2.
    #[test]
    fn what_is_counted_has_whole_numbers_as_labels() {
        let counted =
            |ends| -> Vec<String> { within(ends, 16, 6, 1.0).into_iter().map(|tick| tick.label).collect() };
        assert_eq!(counted([1.0, 3.0]), ["1", "2", "3"]);
        assert_eq!(counted([0.5, 1.5]), ["1"]);
        assert_eq!(counted([1.0, 31.0]), labels([1.0, 31.0], 16));
    }

    /// For ranges of all sizes: at least two labels where there is room, at least one where there is not, and no more than fit.
    #[test]
    fn every_range_has_enough_labels_and_not_too_many() {
        for size in 1..2000_u32 {
            let range = 0.013 * f64::from(size);
            let low = -0.37 * range;
            for (most, few) in [(16, 5), (9, 5), (6, 6), (5, 5)] {
                let ticks = within([low, low + range], most, few, 0.0);
                let count = ticks.len();
                // A step is at most 2.5 times the least: 2 to 5.
                assert!(
                    count as f64 >= f64::from(most) / 2.5 - 1.0 && count <= most as usize + 1,
                    "{range} {most}: {count}"
                );
                let coarse = ticks.iter().filter(|tick| tick.is_coarse).count();
                assert!((1..=few as usize + 1).contains(&coarse), "{range} {few}: {coarse}");
                assert!(ticks.iter().all(|tick| (-1e-9..=1.0 + 1e-9).contains(&tick.place)));
            }
        }
    }
}
