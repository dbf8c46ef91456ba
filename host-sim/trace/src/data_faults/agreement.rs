//! Which position channels of an axis disagree with the majority on the size or the direction of the motion.

use super::channels::POSITIONS;
use super::ratio::ratio;
use crate::options::FaultOptions;
use files::log::{AxisLog, Channel};

/// Channels whose motion is that of the majority times a factor other than 1, with the factor.
///
/// The majority are the channels that agree with a sensor with which most agree. If two are equally many, it is the one
/// nearer to the command. The command agrees with a sensor up to the following error.
#[must_use]
pub fn disagreeing(axis: &AxisLog, sample_s: f64, options: &FaultOptions) -> Vec<(Channel, f64)> {
    let present: Vec<(Channel, &[f64])> =
        POSITIONS.into_iter().filter_map(|channel| Some((channel, axis.channel(channel)?))).collect();
    let factor = |of: usize, to: usize| -> Option<f64> {
        let found = ratio(present[of].1, present[to].1, sample_s)?;
        (found.spread < options.max_factor_spread).then_some(found.factor)
    };
    let tolerance = |a: usize, b: usize| {
        if [a, b].iter().any(|&i| present[i].0 == Channel::Command) {
            options.max_command_factor
        } else {
            options.max_sensor_factor
        }
    };
    let agrees = |of: usize, to: usize| {
        of == to || factor(of, to).is_some_and(|factor| (factor - 1.0).abs() < tolerance(of, to))
    };
    let count = |to: usize| (0..present.len()).filter(|&of| agrees(of, to)).count();
    // The first of the largest counts.
    let Some(majority) = (0..present.len()).rev().max_by_key(|&to| count(to)) else { return Vec::new() };
    // With a following error between them, a sensor is a better reference than the command that agrees with it.
    let reference = (0..present.len())
        .rev()
        .filter(|&of| present[of].0 != Channel::Command && agrees(of, majority))
        .max_by_key(|&to| count(to))
        .unwrap_or(majority);
    let wrong = |of: usize| {
        let factor = factor(of, reference)?;
        ((factor - 1.0).abs() >= tolerance(of, reference)).then_some((present[of].0, factor))
    };
    (0..present.len()).filter(|&of| !agrees(of, majority)).filter_map(wrong).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use files::log::Unit;

    fn axis(factors: [f64; 4]) -> AxisLog {
        let motion = |lag: f64| (0..5000).map(move |i| 30.0 * (3e-3 * (f64::from(i) - lag)).sin());
        let mut axis = AxisLog::new("x", Unit::Millimetre);
        for ((channel, factor), lag) in POSITIONS.into_iter().zip(factors).zip([0.0, 10.0, 10.0, 10.0]) {
            *axis.channel_mut(channel) = Some(motion(lag).map(|mm| factor * mm).collect());
        }
        axis
    }

    fn found(factors: [f64; 4]) -> Vec<(Channel, f64)> {
        disagreeing(&axis(factors), 1e-3, &FaultOptions::default())
    }

    #[test]
    fn the_channel_that_differs_from_the_majority_is_found() {
        assert_eq!(found([1.0; 4]), []);
        for (at, channel) in POSITIONS.into_iter().enumerate() {
            for wrong in [-1.0, 25.4, 0.5] {
                let mut factors = [1.0; 4];
                factors[at] = wrong;
                let [(of, factor)] = found(factors)[..] else { panic!("{channel:?} {wrong}") };
                // The lag of 10 samples at 3 rad/s changes the ratio to the command by less than its tolerance.
                assert!(of == channel && (factor / wrong - 1.0).abs() < 0.05, "{of:?} {factor}");
            }
        }
    }

    #[test]
    fn of_two_equal_halves_the_command_is_right() {
        let found = found([1.0, 1.0, -1.0, -1.0]);
        let channels: Vec<Channel> = found.iter().map(|(channel, _)| *channel).collect();
        assert_eq!(channels, [Channel::Table, Channel::Tool]);
    }

    #[test]
    fn a_pitch_error_and_a_following_error_are_no_faults() {
        // 5 mm/m between motor and table; the command 5 % larger than the motion.
        assert_eq!(found([1.05, 1.0, 1.005, 1.005]), []);
    }
}
