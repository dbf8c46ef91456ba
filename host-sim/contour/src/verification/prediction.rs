//! The predictions in a compensation file.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::logged::log_name;
use files::document::{Document, read_text};
use files::error::InputError;

/// Largest difference of the lengths of the predicted path and of the logged one, as a fraction.
const MAX_LENGTH_FRACTION: f64 = 1e-3;

/// Words of a file name that do not belong to the name of its motion.
const SIDES: [&str; 6] = ["before", "after", "uncompensated", "compensated", "without", "with"];

/// Entries `[[predicted]]` of a compensation file; the rest of the file is not read.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
pub struct Predictions {
    /// Name of the machine to which the file belongs.
    pub machine: Option<String>,
    /// The entries.
    #[serde(default)]
    pub predicted: Vec<Prediction>,
}

/// The contour error of one motion as predicted.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Prediction {
    /// Name of the motion, or of its log.
    pub motion: String,
    /// Rms without compensation, µm.
    pub before_um: f64,
    /// Rms with compensation, µm.
    pub after_um: f64,
    /// Greatest error without compensation, µm.
    pub max_before_um: Option<f64>,
    /// Greatest error with compensation, µm.
    pub max_after_um: Option<f64>,
    /// Circular deviation G, the larger of the directions, without compensation, µm.
    pub circular_before_um: Option<f64>,
    /// The same with compensation, µm.
    pub circular_after_um: Option<f64>,
    /// How far the rms after may lie from `after_um`, percent of `after_um`.
    pub bound_percent: f64,
    /// Length of the path, mm: a log of another length is another motion.
    pub path_length_mm: Option<f64>,
}

impl Predictions {
    /// Reads a compensation file.
    ///
    /// # Errors
    /// If it cannot be read, or an entry lacks a key or has a value that is not possible.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::parse(&read_text(path)?, &path.display().to_string())
    }

    /// Reads the text of a compensation file; `source` is its name.
    ///
    /// # Errors
    /// As [`Predictions::read`].
    pub fn parse(text: &str, source: &str) -> Result<Self, InputError> {
        let document = Document::parse(text, source)?;
        let predictions: Self = document.deserialize()?;
        for (index, entry) in predictions.predicted.iter().enumerate() {
            let errors = [
                ("before_um", Some(entry.before_um)),
                ("after_um", Some(entry.after_um)),
                ("max_before_um", entry.max_before_um),
                ("max_after_um", entry.max_after_um),
                ("circular_before_um", entry.circular_before_um),
                ("circular_after_um", entry.circular_after_um),
                ("bound_percent", Some(entry.bound_percent)),
                ("path_length_mm", entry.path_length_mm),
            ];
            let is_bad = |value: f64| !(value.is_finite() && value >= 0.0);
            if let Some((key, _)) = errors.into_iter().find(|(_, value)| value.is_some_and(is_bad)) {
                return Err(document.refuse(&format!("predicted[{index}].{key}"), "a number of at least 0"));
            }
        }
        Ok(predictions)
    }

    /// The entry for a motion with logs of these names and a path of this length.
    ///
    /// The name of a log is its file name without folder and extension, and without a word such as `before` or `after`
    /// at either end. Blanks, hyphens and underscores are alike. Logs whose names are nothing but such words have the only entry
    /// with a path of their length.
    #[must_use]
    pub fn of_motion(&self, logs: [&str; 2], length_mm: f64) -> Option<&Prediction> {
        let names = logs.map(|log| without_side(&plain(&log_name(log))));
        let is_length = |mm: f64| (mm - length_mm).abs() <= MAX_LENGTH_FRACTION * length_mm;
        let named = self.predicted.iter().find(|entry| {
            let motion = plain(&log_name(&entry.motion));
            let is_named = names.contains(&motion) || names.contains(&without_side(&motion));
            is_named && entry.path_length_mm.is_none_or(is_length)
        });
        let unnamed = names.iter().all(|name| SIDES.contains(&name.as_str()));
        let mut as_long =
            self.predicted.iter().filter(|entry| unnamed && entry.path_length_mm.is_some_and(is_length));
        named.or_else(|| as_long.next().filter(|_| as_long.next().is_none()))
    }
}

/// Lower case, with one separator.
fn plain(name: &str) -> String {
    name.to_lowercase().replace([' ', '-', '.'], "_")
}

fn without_side(name: &str) -> String {
    let start = SIDES.iter().find_map(|side| name.strip_prefix(side)?.strip_prefix('_'));
    let name = start.unwrap_or(name);
    let end = SIDES.iter().find_map(|side| name.strip_suffix(side)?.strip_suffix('_'));
    end.unwrap_or(name).to_owned()
}
