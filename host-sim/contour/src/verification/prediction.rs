//! The predictions in a compensation file.

use serde::{Deserialize, Serialize};

use crate::logged::log_name;

/// Largest difference of the lengths of the predicted path and of the logged one, as a fraction.
const MAX_LENGTH_FRACTION: f64 = 1e-3;

/// Words of a file name that do not belong to the name of its motion.
const SIDES: [&str; 6] = ["before", "after", "uncompensated", "compensated", "without", "with"];

/// Entries `[[predicted]]` of a compensation file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Predictions(pub Vec<Prediction>);

/// The contour error of one motion as predicted.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
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
    /// How far the rms after may lie from `after_um`, percent of `after_um`, at most 100.
    pub bound_percent: f64,
    /// Length of the path, mm: a log of another length is another motion.
    pub path_length_mm: Option<f64>,
}

impl Prediction {
    /// The first key whose value is not possible, and what was expected of it.
    #[must_use]
    pub fn refused(&self) -> Option<(&'static str, &'static str)> {
        let values = [
            ("before_um", Some(self.before_um)),
            ("after_um", Some(self.after_um)),
            ("max_before_um", self.max_before_um),
            ("max_after_um", self.max_after_um),
            ("circular_before_um", self.circular_before_um),
            ("circular_after_um", self.circular_after_um),
            ("path_length_mm", self.path_length_mm),
        ];
        let is_bad = |value: f64| !(value.is_finite() && value >= 0.0);
        let bad = values.into_iter().find(|(_, value)| value.is_some_and(is_bad));
        // A prediction that may be wrong by more than itself predicts nothing.
        let is_bound = (0.0..=100.0).contains(&self.bound_percent);
        bad.map(|(key, _)| (key, "a number of at least 0"))
            .or_else(|| (!is_bound).then_some(("bound_percent", "a number from 0 to 100")))
    }
}

impl Predictions {
    /// The entry for a motion with logs of these names and a path of this length.
    ///
    /// The name of a log is its file name without folder and extension, and without a word such as `before` or `after`
    /// at either end. Blanks, hyphens and underscores are alike. Logs whose names are nothing but such words have the only entry
    /// with a path of their length.
    #[must_use]
    pub fn of_motion(&self, logs: [&str; 2], length_mm: f64) -> Option<&Prediction> {
        let names = logs.map(|log| without_side(&plain(&log_name(log))));
        let is_length = |mm: f64| (mm - length_mm).abs() <= MAX_LENGTH_FRACTION * length_mm;
        let named = self.0.iter().find(|entry| {
            let motion = plain(&log_name(&entry.motion));
            let is_named = names.contains(&motion) || names.contains(&without_side(&motion));
            is_named && entry.path_length_mm.is_none_or(is_length)
        });
        let unnamed = names.iter().all(|name| SIDES.contains(&name.as_str()));
        let mut as_long =
            self.0.iter().filter(|entry| unnamed && entry.path_length_mm.is_some_and(is_length));
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
