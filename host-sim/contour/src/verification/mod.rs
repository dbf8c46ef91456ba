//! Logs of the same motions before and after a change, and what was predicted.

mod pairing;
mod prediction;
mod significance;

pub use pairing::{is_same_motion, pairs};
pub use prediction::{Prediction, Predictions};
pub use significance::{is_better, is_worse, rms_standard_error_um};

use serde_json::{Value, json};

use super::comparison::Comparison;
use super::evaluation::ContourError;
use super::logged::{LoggedMotion, POSITIONS, has, log_name};
use files::error::InputError;
use files::log::{Channel, Log};

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
    /// Length of the commanded path, mm.
    pub length_mm: f64,
    /// The prediction for this motion.
    pub predicted: Option<Prediction>,
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
        let length_mm = 1e3 * super::NominalPath::of_command(&motion.command_m, motion.sample_s).length_m();
        let predicted = predictions.of_motion([&before.source, &after.source], length_mm).cloned();
        Ok(Self {
            name: predicted.as_ref().map_or_else(|| log_name(&before.source), |p| p.motion.clone()),
            files: [before.source.clone(), after.source.clone()],
            axes: motion.axes,
            channel,
            before: before_error,
            after: after_error,
            length_mm,
            predicted,
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

    /// Whether the rms after is within the bound of its prediction and the sensors' noise; `None` without a prediction.
    #[must_use]
    pub fn is_as_predicted(&self) -> Option<bool> {
        let predicted = self.predicted.as_ref()?;
        let allowed_um =
            0.01 * predicted.bound_percent * predicted.after_um + 2.0 * rms_standard_error_um(&self.after);
        Some((self.after.rms_um - predicted.after_um).abs() <= allowed_um)
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
                [Some(self.before.rms_um), predicted.map(|p| p.after_um), Some(self.after.rms_um)],
                [Some(self.before.max_um), predicted.and_then(|p| p.max_after_um), Some(self.after.max_um)],
                circular,
            ],
        }
    }

    /// The entry of `verify --json`.
    #[must_use]
    pub fn json(&self) -> Value {
        let measured = |error: &ContourError| json!({"max": error.max_um, "rms": error.rms_um});
        let predicted = self.predicted.as_ref();
        let mut entry = json!({
            "name": self.name,
            "contour_error_um": {
                "before": measured(&self.before),
                "predicted": predicted.map(|p| json!({"max": p.max_after_um, "rms": p.after_um})),
                "after": measured(&self.after),
            },
            "channel": self.channel.word(),
            "noise_um": {"before": self.before.noise_um, "after": self.after.noise_um},
            "change": match self.change() {
                Change::Better => "better",
                Change::Unchanged => "unchanged",
                Change::Worse => "worse",
            },
            "as_predicted": self.is_as_predicted(),
            "bound_percent": predicted.map(|p| p.bound_percent),
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

fn evaluated(log: &Log, channel: Channel) -> Result<(LoggedMotion, ContourError), InputError> {
    let motion = LoggedMotion::of_channel(log, channel).map_err(|missing| missing.in_log(log))?;
    let error = motion.contour_error().ok_or_else(|| {
        let expected =
            format!("a log longer than the {} s that are not evaluated", super::evaluation::SETTLING_S);
        InputError::expected(&log.source, expected, format!("{} samples", log.len()))
    })?;
    Ok((motion, error))
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
