//! Limits judged by the logs of the tool, else by the budget.

use contour::ContourError;
use contour::log_error::LogError;
use files::format::significant;
use files::log::Channel;

use super::judgement::{Basis, Judgement, Outcome};
use super::limit::{Figure, Limit};
use crate::of_motion::MotionBudget;
use crate::sizes::Sizes;

/// The greatest of some ten thousand values of noise, in standard deviations.
const GREATEST_NOISE: f64 = 4.0;

/// How far a prediction counts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Trust {
    /// The model describes the logs up to the tool.
    Whole,
    /// Something may come on top of what is predicted: it shows that a limit is not kept, but not that it is. With the reason.
    AtLeast(String),
    /// It shows nothing, with the reason.
    None(String),
}

/// What limits are judged by.
#[derive(Clone, Debug)]
pub struct Judged<'a> {
    /// Contour errors of logs.
    pub logs: &'a [LogError],
    /// Names of logs with faults in the command or at the tool.
    pub faulty: &'a [String],
    /// The budgets of motions; may be empty.
    pub motions: &'a [MotionBudget],
    /// How far these count.
    pub trust: Trust,
}

/// Each limit with its outcome. Of several logs, or motions, the worst counts.
#[must_use]
pub fn judged(limits: &[Limit], by: &Judged<'_>) -> Vec<Judgement> {
    limits.iter().map(|limit| of_limit(*limit, by)).collect()
}

/// Each limit with its outcome by sound logs alone.
#[must_use]
pub fn judged_by_logs(limits: &[Limit], logs: &[LogError]) -> Vec<Judgement> {
    judged(limits, &Judged { logs, faulty: &[], motions: &[], trust: Trust::Whole })
}

fn of_limit(limit: Limit, by: &Judged<'_>) -> Judgement {
    let at_tool = |log: &&LogError| log.channel == Channel::Tool && !log.error.is_along_axis;
    let measured = by.logs.iter().filter(at_tool).filter_map(|log| measured(limit, log, by.faulty));
    let worst = |a: &Judgement, b: &Judgement| {
        let value = |one: &Judgement| one.value_um.unwrap_or(0.0);
        a.result.cmp(&b.result).then(value(a).total_cmp(&value(b)))
    };
    let predicted =
        || by.motions.iter().filter_map(|motion| predicted(limit, motion, &by.trust)).max_by(worst);
    measured.max_by(worst).or_else(predicted).unwrap_or_else(|| Judgement {
        basis: Basis::None,
        value_um: None,
        why: format!("no log of the tool has {}, and no budget predicts it", limit.figure.needs()),
        ..unknown(limit)
    })
}

fn unknown(limit: Limit) -> Judgement {
    Judgement {
        name: limit.figure,
        limit_um: limit.um,
        result: Outcome::Unknown,
        basis: Basis::None,
        value_um: None,
        uncertainty_um: None,
        of: String::new(),
        why: String::new(),
    }
}

/// By a log of the tool. Noise makes every figure larger: a value above the limit is a failure only if the noise does not explain it.
fn measured(limit: Limit, log: &LogError, faulty: &[String]) -> Option<Judgement> {
    let um = limit.figure.of(&Sizes::of(&log.error))?;
    let by_noise_um = by_noise(limit.figure, &log.error);
    let judged = by_value(limit, um, by_noise_um, &log.log);
    Some(if faulty.contains(&log.log) {
        let why = "the log has a fault in its command or at the tool".to_owned();
        Judgement { result: Outcome::Unknown, why, ..judged }
    } else {
        judged
    })
}

/// By a figure that was measured, of which noise makes up to `by_noise_um`; `of` names the log.
fn by_value(limit: Limit, um: f64, by_noise_um: f64, of: &str) -> Judgement {
    let (result, why) = if um <= limit.um {
        (Outcome::Pass, String::new())
    } else if um - by_noise_um > limit.um {
        (Outcome::Fail, String::new())
    } else {
        let noise = significant(by_noise_um, 2);
        (Outcome::Unknown, format!("the noise of the sensors makes up to {noise} µm of it"))
    };
    Judgement {
        result,
        basis: Basis::Measured,
        value_um: Some(um),
        uncertainty_um: Some(by_noise_um),
        of: of.to_owned(),
        why,
        ..unknown(limit)
    }
}

/// A circle that was measured alone.
#[derive(Clone, Copy, Debug)]
pub struct Circular<'a> {
    /// Its name.
    pub of: &'a str,
    /// Whether it was measured at the tool.
    pub is_at_tool: bool,
    /// The larger circular deviation of the directions that are full circles, µm.
    pub um: Option<f64>,
    /// Noise of the radius, µm.
    pub noise_um: f64,
}

/// Each limit judged by a circle alone.
#[must_use]
pub fn of_circle(limits: &[Limit], circle: &Circular<'_>) -> Vec<Judgement> {
    let judged = |limit: &Limit| {
        let why = match (limit.figure, circle.is_at_tool, circle.um) {
            (Figure::Circular, true, Some(um)) => {
                return by_value(*limit, um, 2.0 * GREATEST_NOISE * circle.noise_um, circle.of);
            }
            (Figure::Circular, true, None) => "no direction is a full circle",
            (Figure::Circular, false, _) => "the circle was not measured at the tool",
            _ => "a circle alone has no figure but G",
        };
        Judgement { why: why.to_owned(), of: circle.of.to_owned(), ..unknown(*limit) }
    };
    limits.iter().map(judged).collect()
}

/// By how much noise makes a figure larger, µm: exactly for the rms, at most for the others. G is a range, with noise at both ends.
fn by_noise(figure: Figure, error: &ContourError) -> f64 {
    match figure {
        Figure::Rms => error.rms_um - error.rms_without_noise_um(),
        Figure::Greatest | Figure::Corner => GREATEST_NOISE * error.noise_um,
        Figure::Circular => 2.0 * GREATEST_NOISE * error.noise_um,
    }
}

/// By the budget of a motion.
fn predicted(limit: Limit, motion: &MotionBudget, trust: &Trust) -> Option<Judgement> {
    let um = limit.figure.of(&motion.whole)?;
    let half_um = um * motion.relative_uncertainty();
    let (result, why) = match trust {
        Trust::None(why) => (Outcome::Unknown, why.clone()),
        _ if um - half_um > limit.um => (Outcome::Fail, String::new()),
        _ if um + half_um > limit.um => {
            (Outcome::Unknown, "the limit is within the interval of the prediction".to_owned())
        }
        Trust::AtLeast(why) => (Outcome::Unknown, why.clone()),
        Trust::Whole => (Outcome::Pass, String::new()),
    };
    Some(Judgement {
        result,
        basis: Basis::Predicted,
        value_um: Some(um),
        uncertainty_um: Some(half_um),
        of: motion.name.clone(),
        why,
        ..unknown(limit)
    })
}
