//! Logs of the same motions before and after a change, and what was predicted.

mod commanded;
mod pairing;
mod prediction;
mod significance;

pub use commanded::Commanded;
pub use pairing::{is_same_motion, pairs};
pub use prediction::{Found, Prediction, Predictions};
pub use significance::{is_better, is_larger, is_worse, rms_uncertainty_um};

use serde_json::{Value, json};

use super::comparison::Comparison;
use super::evaluation::ContourError;
use super::log_error::LogError;
use super::logged::{LoggedMotion, POSITIONS, has, log_name};
use files::error::InputError;
use files::log::{Channel, Log};

/// Largest deviation of a measured position from its command, as a fraction of the deviation of the command itself. On a circle the
/// difference of two exchanged axes has √2 of it; a lag has that of the angle by which it is late.
const MAX_OFF: f64 = 1.0;

/// Smallest motion of an axis that is checked, as a fraction of the largest.
const MIN_MOTION: f64 = 0.1;

/// One motion, before and after.
#[derive(Clone, Debug, PartialEq)]
pub struct VerifiedMotion {
    /// Name of the prediction, or of the file before.
    pub name: String,
    /// Files before and after.
    pub files: [String; 2],
    /// Names of the axes.
    pub axes: Vec<String>,
    /// The channel nearest to the tool that both logs have.
    pub channel: Channel,
    /// Contour error before.
    pub before: ContourError,
    /// Contour error after.
    pub after: ContourError,
    /// The command.
    pub command: Commanded,
    /// The prediction for this motion at the tool.
    pub predicted: Option<Prediction>,
    /// Why the prediction of this name is not compared.
    pub not_comparable: Option<String>,
}

/// Whether the contour error changed by more than chance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Smaller.
    Better,
    /// Not distinguishable.
    Unchanged,
    /// Larger.
    Worse,
}

impl VerifiedMotion {
    /// Evaluates two logs of the same motion.
    ///
    /// # Errors
    /// If a log lacks the command or a measured position that the other one has, or is too short.
    pub fn new(before: &Log, after: &Log, predictions: &Predictions) -> Result<Self, InputError> {
        let channel = POSITIONS.into_iter().find(|channel| has(before, *channel) && has(after, *channel));
        let channel = channel.ok_or_else(|| no_common_channel(before, after))?;
        let [(motion, before_error), (_, after_error)] =
            [evaluated(before, channel)?, evaluated(after, channel)?];
        let command = Commanded::of(&motion);
        let found = predictions.of_motion([&before.source, &after.source], &command);
        let (predicted, not_comparable) = compared(found, &command, channel);
        Ok(Self {
            name: predicted.as_ref().map_or_else(|| log_name(&before.source), |p| p.motion.clone()),
            files: [before.source.clone(), after.source.clone()],
            axes: motion.axes,
            channel,
            before: before_error,
            after: after_error,
            command,
            predicted,
            not_comparable,
        })
    }

    /// Whether the rms changed by more than chance; see [`is_worse`].
    #[must_use]
    pub fn change(&self) -> Change {
        if is_worse(&self.before, &self.after) {
            Change::Worse
        } else if is_better(&self.before, &self.after) {
            Change::Better
        } else {
            Change::Unchanged
        }
    }

    /// The contour error after the change, under the name of its log.
    #[must_use]
    pub fn log_after(&self) -> LogError {
        LogError {
            log: log_name(&self.files[1]),
            axes: self.axes.clone(),
            channel: self.channel,
            error: self.after.clone(),
        }
    }

    /// Rms without noise before, as predicted with the displacement of the tool before the change, and after, µm.
    #[must_use]
    pub fn rms_um(&self) -> [Option<f64>; 3] {
        let errors = [&self.before, &self.after];
        let predicted = self.predicted.as_ref().map(|p| p.rms_after_um(errors, &self.axes));
        let [before, after] = errors.map(|error| Some(error.rms_without_noise_um()));
        [before, predicted, after]
    }

    /// Between which the rms after has to lie as predicted, µm; `None` without a prediction.
    #[must_use]
    pub fn range_um(&self) -> Option<[f64; 2]> {
        let [_, predicted_um, _] = self.rms_um();
        Some(self.predicted.as_ref()?.range_um(predicted_um?))
    }

    /// Whether the rms after is within the range of its prediction and the sensors' noise; `None` without a prediction, or if
    /// the motion leaves the travel for which the compensation is made.
    #[must_use]
    pub fn is_as_predicted(&self) -> Option<bool> {
        self.predicted.as_ref().filter(|p| p.beyond_mapped.is_empty())?;
        let ([least_um, most_um], by_chance_um) = (self.range_um()?, rms_uncertainty_um(&self.after));
        let [_, _, after_um] = self.rms_um();
        Some((least_um - by_chance_um..=most_um + by_chance_um).contains(&after_um?))
    }

    /// Circular deviation G of the largest circle before and after, µm.
    #[must_use]
    pub fn circular_um(&self) -> Option<[f64; 2]> {
        Some([self.before.circular_um()?, self.after.circular_um()?])
    }

    /// The row of the table.
    #[must_use]
    pub fn comparison(&self) -> Comparison {
        let predicted = self.predicted.as_ref();
        let circular = match self.circular_um() {
            Some([before, after]) => [Some(before), predicted.and_then(|p| p.circular_after_um), Some(after)],
            None => [None; 3],
        };
        Comparison {
            name: self.name.clone(),
            figures: [
                self.rms_um(),
                [Some(self.before.max_um), predicted.and_then(|p| p.max_after_um), Some(self.after.max_um)],
                circular,
            ],
        }
    }

    /// The entry of `verify --json`.
    #[must_use]
    pub fn json(&self) -> Value {
        let measured =
            |error: &ContourError| json!({"max": error.max_um, "rms": error.rms_without_noise_um()});
        let [_, predicted_um, _] = self.rms_um();
        let predicted = self.predicted.as_ref();
        let mut entry = json!({
            "name": self.name,
            "contour_error_um": {
                "before": measured(&self.before),
                "predicted": predicted.map(|p| json!({"max": p.max_after_um, "rms": predicted_um})),
                "after": measured(&self.after),
            },
            "channel": self.channel.word(),
            "noise_um": {"before": self.before.noise_um, "after": self.after.noise_um},
            "rms_with_noise_um": {"before": self.before.rms_um, "after": self.after.rms_um},
            "rms_uncertainty_um": {
                "before": rms_uncertainty_um(&self.before),
                "after": rms_uncertainty_um(&self.after),
            },
            "change": match self.change() {
                Change::Better => "better",
                Change::Unchanged => "unchanged",
                Change::Worse => "worse",
            },
            "as_predicted": self.is_as_predicted(),
            "bound_percent": predicted.map(|p| p.bound_percent),
            "predicted_range_um": self.range_um(),
            "not_comparable": self.not_comparable,
            "beyond_mapped": predicted.map(|p| &p.beyond_mapped),
            "files": {"before": self.files[0], "after": self.files[1]},
        });
        if let (Some([before, after]), Some(entry)) = (self.circular_um(), entry.as_object_mut()) {
            let predicted = predicted.and_then(|p| p.circular_after_um);
            let circular = json!({"before": before, "predicted": predicted, "after": after});
            entry.insert("circular_deviation_um".to_owned(), circular);
        }
        entry
    }
}

/// The prediction that is compared, or why the one that is found is not.
fn compared(found: Found<'_>, command: &Commanded, channel: Channel) -> (Option<Prediction>, Option<String>) {
    let is_at_tool = channel == Channel::Tool;
    match found {
        Found::None => (None, None),
        Found::Comparable(entry) if is_at_tool => (Some(entry.clone()), None),
        Found::Comparable(_) => {
            let why = format!("it is of the tool, and the logs have the {}", channel.word());
            (None, Some(why))
        }
        Found::OfOtherMotion(entry) => {
            let words = |mm: Option<f64>, s: Option<f64>| match (mm, s) {
                (Some(mm), Some(s)) => format!("a path of {mm:.3} mm in {s:.3} s"),
                (Some(mm), None) => format!("a path of {mm:.3} mm"),
                (None, _) => "another path".to_owned(),
            };
            let predicted = words(entry.path_length_mm, entry.duration_s);
            let logged = words(Some(command.length_mm), Some(command.duration_s));
            let points = if predicted == logged { ", with other points" } else { "" };
            (None, Some(format!("it is of {predicted}{points}, and the logs are of {logged}")))
        }
    }
}

fn evaluated(log: &Log, channel: Channel) -> Result<(LoggedMotion, ContourError), InputError> {
    let motion = LoggedMotion::of_channel(log, channel).map_err(|missing| missing.in_log(log))?;
    check_following(log, &motion)?;
    let error = motion.contour_error().ok_or_else(|| {
        let expected =
            format!("a log longer than the {} s that are not evaluated", super::evaluation::SETTLING_S);
        InputError::expected(&log.source, expected, format!("{} samples", log.len()))
    })?;
    Ok((motion, error))
}

/// Checks that each axis that moves follows its command. A tool that is exchanged, turned or mirrored is on a full circle all the same.
fn check_following(log: &Log, motion: &LoggedMotion) -> Result<(), InputError> {
    let deviation = |values: &[f64]| numerics::mean_and_deviation(values).1;
    let moves_m: Vec<f64> = motion.command_m.iter().map(|command| deviation(command)).collect();
    let largest_m = numerics::max(moves_m.iter().copied());
    for (axis, moves_m) in moves_m.into_iter().enumerate().filter(|(_, m)| *m > MIN_MOTION * largest_m) {
        let both = motion.command_m[axis].iter().zip(&motion.measured_m[axis]);
        let off_m: Vec<f64> = both.map(|(command, measured)| measured - command).collect();
        let off_m = deviation(&off_m);
        if off_m > MAX_OFF * moves_m {
            let expected = format!("the {} of {} near its command", motion.channel.word(), motion.axes[axis]);
            let found = format!(
                "a deviation of {:.3} mm from the command, which itself deviates by {:.3} mm",
                1e3 * off_m,
                1e3 * moves_m
            );
            return Err(InputError::expected(&log.source, expected, found));
        }
    }
    Ok(())
}

fn no_common_channel(before: &Log, after: &Log) -> InputError {
    for log in [before, after] {
        if let Err(missing) = LoggedMotion::of(log) {
            return missing.in_log(log);
        }
    }
    let expected = format!("a measured position of each axis that {} has, too", before.source);
    InputError::expected(&after.source, expected, "none")
}
