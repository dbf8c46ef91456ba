//! The passes of a recording at constant speed, averaged over evenly spaced positions.

use super::plan::{Grid, Plan};

/// Deviation of the commanded speed from the planned one that is constant speed.
const SAME_SPEED: f64 = 0.02;

/// Part of the force limit from which a force is at the limit.
const AT_LIMIT: f64 = 0.99;

/// Number of samples at a position over that at constant speed: outside of it, the axis stuck or jumped there.
const EVEN: std::ops::RangeInclusive<f64> = 0.4..=2.5;

/// The axis at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Command, m.
    pub command_m: f64,
    /// Reading of the motor, m.
    pub motor_m: f64,
    /// Force of the drive, N.
    pub force_n: f64,
}

/// Means over the positions of a grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Force of the drive, N.
    pub force_n: Vec<f64>,
    /// Motor − command, m.
    pub deviation_m: Vec<f64>,
}

/// A pass out and the pass back.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// In the positive direction.
    pub forward: Curve,
    /// In the negative direction.
    pub backward: Curve,
}

/// Why a recording shows nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PassError {
    /// Not every pass has the planned speed.
    #[error(
        "{found} of {expected} passes at the planned speed of {speed_mm_per_min:.3} mm/min: a feed override, or a limit, has changed it"
    )]
    Speed {
        /// Passes at the planned speed.
        found: usize,
        /// Passes that were planned.
        expected: usize,
        /// Planned speed, mm/min.
        speed_mm_per_min: f64,
    },
    /// The axis sticks or jumps.
    #[error(
        "the axis did not move evenly at {at_mm:.3} mm, it sticks or jumps there: a higher speed may help"
    )]
    Uneven {
        /// Place, mm.
        at_mm: f64,
    },
    /// The force limit was reached.
    #[error(
        "the force limit of {limit_n} N was reached at {at_mm:.3} mm: what the axis needs there is not known"
    )]
    ForceLimit {
        /// Force limit, N.
        limit_n: f64,
        /// Place, mm.
        at_mm: f64,
    },
}

/// The pairs of passes of a recording, in their order; `sample_s` is the time between two samples.
///
/// # Errors
/// [`PassError`].
pub fn pairs(
    samples: &[Sample],
    plan: &Plan,
    expected: usize,
    (sample_s, force_limit_n): (f64, Option<f64>),
) -> Result<Vec<Pair>, PassError> {
    let step_m = 1e-3 * plan.speed_mm_per_s * sample_s;
    let runs: Vec<&[Sample]> = runs(samples, step_m).filter(|run| covers(run, &plan.grid)).collect();
    // Before the passes the axis moves to their start, possibly as fast.
    let first = runs.len().saturating_sub(2 * expected);
    let alternate = |pair: &[&[Sample]]| is_forward(pair[0]) && !is_forward(pair[1]);
    if runs.len() < 2 * expected || !runs[first..].chunks(2).all(alternate) {
        let speed_mm_per_min = 60.0 * plan.speed_mm_per_s;
        return Err(PassError::Speed { found: runs.len(), expected: 2 * expected, speed_mm_per_min });
    }
    let per_point = 1e-3 * plan.grid.spacing_mm / step_m;
    let curve = |run: &[Sample]| curve(run, &plan.grid, per_point, force_limit_n);
    let pair = |pair: &[&[Sample]]| Ok(Pair { forward: curve(pair[0])?, backward: curve(pair[1])? });
    runs[first..].chunks(2).map(pair).collect()
}

/// The parts whose command moves by ± `step_m` from sample to sample.
fn runs(samples: &[Sample], step_m: f64) -> impl Iterator<Item = &[Sample]> {
    let kind = move |one: &Sample, next: &Sample| {
        let moved_m = next.command_m - one.command_m;
        if (moved_m.abs() - step_m).abs() > SAME_SPEED * step_m { 0.0 } else { moved_m.signum() }
    };
    let mut kinds = samples.windows(2).map(|pair| kind(&pair[0], &pair[1]));
    let mut last = kinds.next();
    let mut ends = vec![0];
    for (index, kind) in kinds.enumerate() {
        if Some(kind) != last {
            ends.push(index + 1);
            last = Some(kind);
        }
    }
    ends.push(samples.len());
    let parts: Vec<&[Sample]> = ends.windows(2).map(|ends| &samples[ends[0]..ends[1]]).collect();
    parts.into_iter().filter(move |part| part.len() > 1 && kind(&part[0], &part[1]) != 0.0)
}

fn is_forward(run: &[Sample]) -> bool {
    run.first().zip(run.last()).is_some_and(|(first, last)| first.command_m < last.command_m)
}

/// Whether a part goes over the whole grid.
fn covers(run: &[Sample], grid: &Grid) -> bool {
    let ends = run.first().zip(run.last()).map(|(first, last)| [first.motor_m, last.motor_m]);
    ends.is_some_and(|ends| {
        let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        1e3 * low <= grid.from_mm && 1e3 * high >= grid.from_mm + grid.length_mm()
    })
}

/// The means of a pass; `per_point` is the number of samples at a position at constant speed.
fn curve(
    run: &[Sample],
    grid: &Grid,
    per_point: f64,
    force_limit_n: Option<f64>,
) -> Result<Curve, PassError> {
    let mut counts = vec![0u32; grid.points];
    let zeros = || vec![0.0; grid.points];
    let mut curve = Curve { force_n: zeros(), deviation_m: zeros() };
    for sample in run {
        let at_mm = 1e3 * sample.motor_m;
        let place = (at_mm - grid.from_mm) / grid.spacing_mm;
        if place < 0.0 || place >= grid.points as f64 {
            continue;
        }
        if let Some(limit_n) = force_limit_n.filter(|limit_n| sample.force_n.abs() >= AT_LIMIT * limit_n) {
            return Err(PassError::ForceLimit { limit_n, at_mm });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to the points")]
        let point = place as usize;
        counts[point] += 1;
        curve.force_n[point] += sample.force_n;
        curve.deviation_m[point] += sample.motor_m - sample.command_m;
    }
    for (point, count) in counts.into_iter().map(f64::from).enumerate() {
        if !EVEN.contains(&(count / per_point)) {
            return Err(PassError::Uneven { at_mm: grid.position_mm(point) });
        }
        curve.force_n[point] /= count;
        curve.deviation_m[point] /= count;
    }
    Ok(curve)
}
