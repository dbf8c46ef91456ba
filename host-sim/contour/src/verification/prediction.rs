//! The predictions in a compensation file.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::commanded::{Commanded, is_same_duration};
use crate::ContourError;
use crate::logged::log_name;

/// Largest difference of the lengths of the predicted path and of the logged one, as a fraction.
const MAX_LENGTH_FRACTION: f64 = 1e-3;

/// Words of a file name that do not belong to the name of its motion.
const SIDES: [&str; 6] = ["before", "after", "uncompensated", "compensated", "without", "with"];

/// Entries `[[predicted]]` of a compensation file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Predictions(pub Vec<Prediction>);

/// The contour error of one motion at the tool as predicted, without the noise of a probe.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
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
    /// Circular deviation with compensation, µm.
    pub circular_after_um: Option<f64>,
    /// How far the rms after may lie from `after_um`, percent of `after_um`, at most 100.
    pub bound_percent: f64,
    /// What the trace of the model left unexplained on the axes of the motion, µm rms: the rms after may be larger, as its square is
    /// larger by up to the square of it; 0: nothing, or not known.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub unexplained_um: f64,
    /// Length of the path, mm: a log of another length is another motion.
    pub path_length_mm: Option<f64>,
    /// Time from the first change of the command to the last, s: a log of another duration has another feed.
    pub duration_s: Option<f64>,
    /// Axes on which the motion leaves the travel that the compensation is made for. The error there is not known: the prediction
    /// is not judged.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub beyond_mapped: Vec<String>,
    /// Positions of each axis at equal fractions of the path, mm; empty: not known.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub points_mm: BTreeMap<String, Vec<f64>>,
    /// Constant displacement of the tool along each axis without and with compensation, µm; empty: not known.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub displacement_um: BTreeMap<String, [f64; 2]>,
}

/// A prediction for a pair of logs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Found<'a> {
    /// There is none.
    None,
    /// There is one of the motion.
    Comparable(&'a Prediction),
    /// There is one of its name, of another motion.
    OfOtherMotion(&'a Prediction),
}

impl Prediction {
    /// From the errors before and after on a command.
    #[must_use]
    pub fn new(motion: &str, [before, after]: [&ContourError; 2], command: &Commanded) -> Self {
        let displacements = [before, after].map(|error| error.across.displacement_um());
        let of_axis = |(i, name): (usize, &String)| (name.clone(), displacements.map(|um| um[i]));
        Self {
            motion: motion.to_owned(),
            before_um: before.rms_without_noise_um(),
            after_um: after.rms_without_noise_um(),
            max_before_um: Some(before.max_um),
            max_after_um: Some(after.max_um),
            circular_before_um: before.circular_um(),
            circular_after_um: after.circular_um(),
            path_length_mm: Some(command.length_mm),
            duration_s: Some(command.duration_s),
            displacement_um: command.axes.iter().enumerate().map(of_axis).collect(),
            points_mm: command.points_mm.clone(),
            ..Self::default()
        }
    }

    /// Whether the motion of a command is the predicted one, as far as the prediction describes it.
    #[must_use]
    pub fn is_of(&self, command: &Commanded) -> bool {
        let max_mm = MAX_LENGTH_FRACTION * command.length_mm;
        let is_near = |(one, other): (&f64, &f64)| (one - other).abs() <= max_mm;
        let is_path = || {
            self.points_mm.len() == command.points_mm.len()
                && self.points_mm.iter().all(|(axis, points)| {
                    let others = command.points_mm.get(axis).filter(|others| others.len() == points.len());
                    others.is_some_and(|others| points.iter().zip(others).all(is_near))
                })
        };
        self.path_length_mm.is_none_or(|mm| is_near((&mm, &command.length_mm)))
            && self.duration_s.is_none_or(|s| is_same_duration(s, command.duration_s, command.sample_s))
            && (self.points_mm.is_empty() || is_path())
    }

    /// Rms after the change, µm, if the tool is displaced by as much more than predicted as it is before the change. No trace
    /// finds a constant displacement, such as the mean of a pitch error, as no log shows where the probe has its zero; it
    /// is in the measured error before and after.
    #[must_use]
    pub fn rms_after_um(&self, [before, after]: [&ContourError; 2], axes: &[String]) -> f64 {
        let measured_um = before.across.displacement_um();
        let [mut predicted_um, mut more_um] = [[0.0; 3]; 2];
        for (i, name) in axes.iter().enumerate() {
            let Some([predicted_before_um, predicted_after_um]) = self.displacement_um.get(name) else {
                return self.after_um;
            };
            predicted_um[i] = *predicted_after_um;
            more_um[i] = measured_um[i] - predicted_before_um;
        }
        (self.after_um.powi(2) + after.across.added_um2(predicted_um, more_um)).max(0.0).sqrt()
    }

    /// Between which the rms after has to lie, µm, if `after_um` is predicted by the model alone.
    #[must_use]
    pub fn range_um(&self, after_um: f64) -> [f64; 2] {
        let bound = 0.01 * self.bound_percent;
        [(1.0 - bound) * after_um, (1.0 + bound) * libm::hypot(after_um, self.unexplained_um)]
    }

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
            ("duration_s", self.duration_s),
            ("unexplained_um", Some(self.unexplained_um)),
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
    /// The entry for a motion with logs of these names and this command.
    ///
    /// The name of a log is its file name without folder and extension, and without a word such as `before` or `after`
    /// at either end. Blanks, hyphens and underscores are alike. Logs whose names are nothing but such words have the only entry
    /// of their motion that states its length.
    #[must_use]
    pub fn of_motion(&self, logs: [&str; 2], command: &Commanded) -> Found<'_> {
        let names = logs.map(|log| without_side(&plain(&log_name(log))));
        let is_named = |entry: &&Prediction| {
            let motion = plain(&log_name(&entry.motion));
            names.contains(&motion) || names.contains(&without_side(&motion))
        };
        let named = || self.0.iter().filter(is_named);
        if let Some(entry) = named().find(|entry| entry.is_of(command)) {
            return Found::Comparable(entry);
        }
        let unnamed = names.iter().all(|name| SIDES.contains(&name.as_str()));
        let is_described = |entry: &&Prediction| entry.path_length_mm.is_some() && entry.is_of(command);
        let mut described = self.0.iter().filter(|entry| unnamed && is_described(entry));
        match (described.next(), described.next(), named().next()) {
            (Some(entry), None, _) => Found::Comparable(entry),
            (_, _, Some(entry)) => Found::OfOtherMotion(entry),
            _ => Found::None,
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(um: &f64) -> bool {
    *um == 0.0
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
