//! Which position channels of an axis disagree with the majority on the size or the direction of the motion.

use super::channels::POSITIONS;
use super::ratio::{Ratio, ratio, ratio_to_follower};
use crate::options::FaultOptions;
use files::log::{AxisLog, Channel};

/// The position channels of an axis and the ratios of their motions.
struct Motions {
    channels: Vec<Channel>,
    /// Factor of the first channel relative to the second, if their motions are proportional.
    factors: Vec<Vec<Option<f64>>>,
}

impl Motions {
    fn of(axis: &AxisLog, sample_s: f64, options: &FaultOptions) -> Self {
        let present: Vec<(Channel, &[f64])> =
            POSITIONS.into_iter().filter_map(|channel| Some((channel, axis.channel(channel)?))).collect();
        let factor = |(of, values): (Channel, &[f64]), (to, reference): (Channel, &[f64])| {
            let found = match (of, to) {
                (Channel::Command, _) => ratio_to_follower(values, reference, sample_s),
                (_, Channel::Command) => ratio_to_follower(reference, values, sample_s).map(Ratio::inverse),
                _ => ratio(values, reference, sample_s),
            }?;
            (found.spread < options.max_factor_spread).then_some(found.factor)
        };
        let row = |of| present.iter().map(|to| if of == *to { Some(1.0) } else { factor(of, *to) }).collect();
        Self {
            channels: present.iter().map(|(channel, _)| *channel).collect(),
            factors: present.iter().map(|of| row(*of)).collect(),
        }
    }

    fn agrees(&self, of: usize, to: usize, options: &FaultOptions) -> bool {
        let pair = [self.channels[of], self.channels[to]];
        self.factors[of][to].is_some_and(|factor| (factor - 1.0).abs() < tolerance(&pair, options))
    }
}

/// Largest deviation from 1 of the factor between channels that agree.
#[must_use]
pub fn tolerance(pair: &[Channel], options: &FaultOptions) -> f64 {
    if pair.contains(&Channel::Command) { options.max_command_factor } else { options.max_sensor_factor }
}

/// Channels whose motion is that of the majority times a factor other than 1, with the factor.
///
/// The majority are the channels that agree with the one with which most agree. If two are equally many, it is the one
/// nearer to the command.
#[must_use]
pub fn disagreeing(axis: &AxisLog, sample_s: f64, options: &FaultOptions) -> Vec<(Channel, f64)> {
    let motions = Motions::of(axis, sample_s, options);
    let all = 0..motions.channels.len();
    let count = |to: usize| all.clone().filter(|&of| motions.agrees(of, to, options)).count();
    // The first of the largest counts.
    let Some(majority) = all.clone().rev().max_by_key(|&to| count(to)) else { return Vec::new() };
    // As the following error is between them, a sensor is a better reference than the command that agrees with it.
    let is_sensor =
        |of: &usize| motions.channels[*of] != Channel::Command && motions.agrees(*of, majority, options);
    let reference = all.clone().rev().filter(is_sensor).max_by_key(|&to| count(to)).unwrap_or(majority);
    let wrong = |of: usize| {
        let factor = motions.factors[of][reference]?;
        (!motions.agrees(of, reference, options)).then_some((motions.channels[of], factor))
    };
    all.filter_map(wrong).collect()
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
            for wrong in [-1.0, 25.4, 0.4] {
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
        // 5 mm/m between motor and table; the command 20 % larger than the motion.
        assert_eq!(found([1.2, 1.0, 1.005, 1.005]), []);
    }
}
