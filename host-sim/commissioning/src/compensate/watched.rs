//! Motions that a compensation must not make worse than they are without one: those it is planned on, and the standard motions.
//!
//! Where a motion becomes worse, the change of the compensation that is best for the planned motions is taken: a part is left out,
//! or the velocity feed-forward and the stretch become gentler. If no change suffices, the one that helps most is taken, and the
//! search goes on from there. It ends where the planned motions would lose more than a quarter of what they gain; a motion that is
//! then still worse is named.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::compensate::choice::{Choice, Part, Strength};
use crate::compensate::file::CompensationFile;
use crate::compensate::planning::Planning;
use crate::compensate::prediction::{PredictionError, TestMotion, contour_error_on, total_rms_um};
use contour::ContourError;
use contour::verification::is_larger;

/// Largest ratio of the rms contour errors with and without compensation. `verify` permits 1.05; the rest is for other noise.
const MAX_RATIO: f64 = 1.02;

/// Largest part of the gain of the planned motions that is given up.
const MAX_GIVEN_UP: f64 = 0.25;

/// A motion, and its contour error without noise, µm rms.
#[derive(Clone, Debug, PartialEq)]
pub struct Watched {
    /// Name of the motion.
    pub motion: String,
    /// Without compensation.
    pub before_um: f64,
    /// With it.
    pub after_um: f64,
    /// Whether it is worse with it, by more than the noise.
    pub is_worse: bool,
}

/// The motions that are watched, with their contour errors without compensation.
pub(crate) struct Watch<'a> {
    planning: &'a Planning<'a>,
    motions: Vec<(&'a TestMotion, ContourError)>,
}

/// The motion that a choice makes worse by the largest ratio.
#[derive(Clone, Debug, PartialEq)]
struct Worst {
    ratio: f64,
    motion: String,
}

/// What a choice does to the motions.
#[derive(Clone, Debug, PartialEq)]
struct Judged {
    /// Contour error of the planned motions, µm rms.
    planned_um: f64,
    /// The motion that is worse by the largest ratio; `None`: none is worse.
    worst: Option<Worst>,
}

impl Judged {
    fn ratio(&self) -> f64 {
        self.worst.as_ref().map_or(1.0, |worst| worst.ratio)
    }

    /// First what makes nothing worse, by the error of the planned motions, then the rest by the ratio of the worst motion.
    fn better_first(&self, other: &Self) -> Ordering {
        self.ratio().total_cmp(&other.ratio()).then(self.planned_um.total_cmp(&other.planned_um))
    }
}

/// Ratio of two rms contour errors, 1 if they do not differ by more than the noise.
fn ratio(before: &ContourError, after: &ContourError) -> f64 {
    let ratio = after.rms_without_noise_um() / before.rms_without_noise_um();
    if is_larger(before, after) { ratio } else { 1.0 }
}

/// A change of a choice: a part that is left out, or another strength.
#[derive(Clone, Debug)]
enum Change {
    Without(Part),
    With(Strength),
}

impl Change {
    fn of(&self, choice: &Choice) -> Choice {
        match self {
            Self::Without(part) => choice.without(part),
            Self::With(strength) => choice.with(*strength),
        }
    }
}

impl<'a> Watch<'a> {
    /// Executes the motions of a planning and those that are watched without compensation. A motion that the machine cannot execute
    /// is not watched.
    pub fn new(planning: &'a Planning<'a>) -> Self {
        let none = CompensationFile::none(planning.model);
        let motions: Vec<&TestMotion> = planning.tests.iter().chain(planning.watched).collect();
        let run = |test| Some((test, planning.error_on(test, &none).ok()?));
        Self { planning, motions: motions.into_par_iter().filter_map(run).collect() }
    }

    /// Changes a choice until no motion is worse. Also the parts that are left out, each with the motion that is worse with it.
    pub fn guarded(&self, mut choice: Choice) -> Result<(Choice, BTreeMap<Part, String>), PredictionError> {
        let mut left_out = BTreeMap::new();
        let mut judged = self.judge(&choice)?;
        let planned = self.motions.iter().take(self.planning.tests.len()).map(|(_, error)| error.clone());
        let before_um = total_rms_um(&planned.collect::<Vec<_>>());
        let most_um = judged.planned_um + MAX_GIVEN_UP * (before_um - judged.planned_um).max(0.0);
        while let Some(worst) = &judged.worst {
            let tried = self.changes(&choice).into_par_iter();
            let tried = tried.map(|change| Ok((self.judge(&change.of(&choice))?, change)));
            let tried: Vec<(Judged, Change)> = tried.collect::<Result<_, PredictionError>>()?;
            let helps =
                |(next, _): &(Judged, Change)| next.planned_um <= most_um && next.ratio() < worst.ratio;
            let Some((next, change)) = tried.into_iter().filter(helps).min_by(|a, b| a.0.better_first(&b.0))
            else {
                break;
            };
            if let Change::Without(part) = &change {
                left_out.insert(part.clone(), worst.motion.clone());
            }
            (choice, judged) = (change.of(&choice), next);
        }
        Ok((choice, left_out))
    }

    /// The figures of the watched motions with a file.
    pub fn figures(&self, file: &CompensationFile) -> Result<Vec<Watched>, PredictionError> {
        let figures = self.motions.par_iter().map(|(test, before)| {
            let after = self.planning.error_on(test, file)?;
            Ok(Watched {
                motion: test.motion.name.clone(),
                before_um: before.rms_without_noise_um(),
                after_um: after.rms_without_noise_um(),
                is_worse: ratio(before, &after) > MAX_RATIO,
            })
        });
        figures.collect()
    }

    /// Executes the motions with a choice. One that it does not let the machine execute is infinitely worse.
    fn judge(&self, choice: &Choice) -> Result<Judged, PredictionError> {
        let file = self.planning.file(choice)?;
        let run = |(test, before): &(&TestMotion, ContourError)| {
            let after = self.planning.error_on(test, &file).ok();
            let ratio = after.as_ref().map_or(f64::INFINITY, |after| ratio(before, after));
            (after, Worst { ratio, motion: test.motion.name.clone() })
        };
        let (after, ratios): (Vec<Option<ContourError>>, Vec<Worst>) =
            self.motions.par_iter().map(run).unzip();
        let planned: Option<Vec<ContourError>> = after.into_iter().take(self.planning.tests.len()).collect();
        let worse = ratios.into_iter().filter(|worst| worst.ratio > MAX_RATIO);
        Ok(Judged {
            planned_um: planned.map_or(f64::INFINITY, |errors| total_rms_um(&errors)),
            worst: worse.max_by(|a, b| a.ratio.total_cmp(&b.ratio)),
        })
    }

    /// Every change of a choice that changes something.
    fn changes(&self, choice: &Choice) -> Vec<Change> {
        let parts: Vec<Part> = self.planning.parts().into_iter().filter(|part| choice.has(part)).collect();
        let has_feedforward = parts.contains(&Part::Feedforward);
        let has_stretch = parts.iter().any(|part| matches!(part, Part::Stretch(_)));
        let same = choice.strength;
        let is_change = |other: &Strength| {
            let stretch_alone = Strength { stretch: other.stretch, ..same };
            let feedforward_alone = Strength { stretch: same.stretch, ..*other };
            (has_feedforward || stretch_alone == *other) && (has_stretch || feedforward_alone == *other)
        };
        let gentler = choice.strength.gentler(self.planning.tick_s()).filter(is_change).map(Change::With);
        parts.into_iter().map(Change::Without).chain(gentler).collect()
    }
}

impl Planning<'_> {
    fn error_on(&self, test: &TestMotion, file: &CompensationFile) -> Result<ContourError, PredictionError> {
        contour_error_on(self.model, file, test, self.instruments)
    }
}
