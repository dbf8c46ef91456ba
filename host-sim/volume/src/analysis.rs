//! A survey, evaluated.

use serde::Serialize;

use files::error::InputError;
use files::format::significant;

use super::axis_table::{self, AxisTable};
use super::component::{Axis, Component, Range};
use super::field::Geometry;
use super::finding::{Finding, findings};
use super::fit::Fit;
use super::measurement::{Group, Row, fitted};
use super::selection::{self, Item, Selected, Shown, shown};
use super::survey::What;
use super::vector::dot;

/// Most knots of a positioning error.
const MAX_KNOTS: usize = 60;

/// Targets that differ by less than this part of the range are one.
const SAME_TARGET: f64 = 1e-4;

/// Least that is left of a measurement, µm rms, that is worth a sentence.
const UNDESCRIBED_UM: f64 = 0.5;

/// Largest part of the mean square of a held-out measurement that may be left where it confirms.
const CONFIRMED: f64 = 0.5;

/// Factor by which a measurement may be worse by chance.
const WORSE: f64 = 1.02;

/// A measurement before and after.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judged {
    /// Its file.
    pub source: String,
    /// Whether it took no part in the fit.
    pub is_held_out: bool,
    /// Its deviations without centre, radius and origin, µm rms.
    pub before_um: f64,
    /// Less the errors that are shown.
    pub after_um: f64,
}

/// Whether the measurements confirm the errors that are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Of all held-out measurements together, less than half of the mean square is left, and none is worse.
    Confirmed,
    /// Nothing was held out.
    NotJudged,
    /// None is worse, and more than half is left of what was held out.
    Undecided,
    /// A measurement is worse, held out or not.
    Refuted,
}

impl Verdict {
    fn of(judged: &[Judged]) -> Self {
        let is_worse = |judged: &Judged| judged.after_um > WORSE * judged.before_um;
        let held_out = || judged.iter().filter(|judged| judged.is_held_out);
        let square = |um: fn(&Judged) -> f64| held_out().map(|judged| um(judged).powi(2)).sum::<f64>();
        if judged.iter().any(is_worse) {
            Self::Refuted
        } else if held_out().next().is_none() {
            Self::NotJudged
        } else if square(|judged| judged.after_um) < CONFIRMED * square(|judged| judged.before_um) {
            Self::Confirmed
        } else {
            Self::Undecided
        }
    }
}

/// The result.
#[derive(Clone, Debug, Serialize)]
pub struct Analysis {
    /// The axes from the workpiece to the tool.
    pub chain: [Axis; 3],
    /// What was measured of each axis: lowest and highest position, mm.
    pub measured_mm: [[f64; 2]; 3],
    /// From where the levers of x, y and z count, for errors along x, y and z: positions of x, y and z, mm.
    pub lever_from_mm: [[[f64; 3]; 3]; 3],
    /// The errors, those that are shown first.
    pub findings: Vec<Finding>,
    /// The measurements.
    pub judged: Vec<Judged>,
    /// Whether the measurements confirm the errors that are shown.
    pub verdict: Verdict,
    /// The errors that are shown, over the position of each axis.
    pub tables: [AxisTable; 3],
    /// What was assumed or left out.
    pub notes: Vec<String>,
}

/// Evaluates the measurements of a survey.
///
/// # Errors
/// A measurement that is held out beyond the positions of the others.
pub fn analyse(chain: [Axis; 3], groups: Vec<Group>) -> Result<Analysis, InputError> {
    let mut notes: Vec<String> = groups
        .iter()
        .flat_map(|group| group.notes.iter().map(|note| format!("{}: {note}", group.source)))
        .collect();
    let ranges = Axis::ALL.map(|axis| range(axis, &groups));
    let groups = within(groups, &ranges, &mut notes)?;
    let rows: Vec<&[Row]> = fitted(&groups).map(|group| &group.rows[..]).collect();
    let geometry = Geometry::new(chain, ranges, &rows);
    let Selected { fit, simpler } = selection::fitted(&geometry, &groups);
    notes.extend(simplified(&simpler));
    let is_shown = |item: Item| shown(&fit, item) == Shown::Yes;
    let kept: Vec<usize> =
        (0..fit.terms.len()).filter(|term| Item::of(fit.terms[*term]).is_some_and(is_shown)).collect();
    let tables = axis_table::of(&geometry, &fit, &kept);
    let findings = findings(&geometry, &groups, &fit, &simpler);
    let judged: Vec<Judged> = groups.iter().map(|group| judged(group, &geometry, &fit, &kept)).collect();
    notes.extend(groups.iter().zip(&judged).filter_map(|(group, judged)| undescribed(group, judged)));
    let verdict = Verdict::of(&judged);
    if groups.iter().any(|group| matches!(group.what, What::Circle { .. })) {
        notes.push(
            "Errors that depend on acceleration (in-talk, cross-talk) look like squareness on a circle: they grow with the square of the feed, so \
             measure circles slowly, or at two feeds."
                .to_owned(),
        );
    }
    let measured_mm = [0, 1, 2].map(|axis| [geometry.ranges[axis].low_mm, geometry.ranges[axis].high_mm]);
    let lever_from_mm = [0, 1, 2].map(|axis| geometry.ranges[axis].lever_from_mm);
    Ok(Analysis { chain, measured_mm, lever_from_mm, findings, judged, verdict, tables, notes })
}

impl Analysis {
    /// The error of the tool that is shown, µm, at a position in mm.
    #[must_use]
    pub fn error_um(&self, at_mm: [f64; 3]) -> [f64; 3] {
        axis_table::error_um(&self.tables, self.chain, &self.lever_from_mm, at_mm)
    }
}

/// A measurement of which far more is left than its own scatter.
fn undescribed(group: &Group, judged: &Judged) -> Option<String> {
    let limit_um = (4.0 * group.scatter_um).max(UNDESCRIBED_UM);
    (group.scatter_um > 0.0 && judged.after_um > limit_um).then(|| {
        format!(
            "{}: {} µm rms are left where its readings scatter by {} µm: it has an error of another kind, or of a finer course, than those that \
             are fitted.",
            group.source,
            significant(judged.after_um, 2),
            significant(group.scatter_um, 2)
        )
    })
}

/// What was taken as zero, because the measurements do not determine it.
fn simplified(components: &[Component]) -> Option<String> {
    let names: Vec<String> = components.iter().map(|component| component.name()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "Taken as zero, as these measurements do not tell them from other errors: the finest courses of {} (cubic bends, bends of tilts). What \
             is shown beside them holds if they are small; circles about other centres would show them.",
            names.join(", ")
        )
    })
}

/// The positions of an axis in the measurements that are fitted.
fn range(axis: Axis, groups: &[Group]) -> Range {
    let fitted = || fitted(groups);
    let all = || fitted().flat_map(|group| &group.rows).map(|row| row.at_mm[axis as usize]);
    let [low_mm, high_mm] = [numerics::min(all()), numerics::max(all())];
    let tests = || fitted().filter(|group| group.what == What::Positioning(axis));
    let mut knots_mm: Vec<f64> =
        tests().flat_map(|group| &group.rows).map(|row| row.at_mm[axis as usize]).collect();
    knots_mm.sort_by(f64::total_cmp);
    knots_mm.dedup_by(|a, b| (*a - *b).abs() < SAME_TARGET * (high_mm - low_mm));
    if knots_mm.len() > MAX_KNOTS {
        let last = knots_mm.len() - 1;
        knots_mm = (0..MAX_KNOTS).map(|knot| knots_mm[knot * last / (MAX_KNOTS - 1)]).collect();
    }
    let lever_from_mm = Axis::ALL.map(|direction| {
        let first = fitted().find(|group| shows(group, axis, direction));
        first.and_then(|group| group.rows.first()).map_or([0.0; 3], |row| row.at_mm)
    });
    let unturned_mm = Axis::ALL.map(|about| {
        let is_of_plane =
            |group: &&Group| matches!(group.what, What::Circle { plane, .. } if !plane.contains(&about));
        let circle = fitted().find(is_of_plane)?;
        Some(numerics::mean(circle.rows.iter().map(|row| row.at_mm[axis as usize])))
    });
    let zero_mm = 0.5 * (low_mm + high_mm);
    Range { low_mm, high_mm, zero_mm, lever_from_mm, unturned_mm, knots_mm }
}

/// Whether a measurement is that of the error of an axis in a direction.
fn shows(group: &Group, axis: Axis, direction: Axis) -> bool {
    match group.what {
        What::Positioning(of) => of == axis && direction == axis,
        What::Circle { plane, .. } => {
            direction != axis && plane.contains(&axis) && plane.contains(&direction)
        }
    }
}

/// The measurements without what lies beyond a positioning test, where nothing is known of the screw, or, if they are held out, beyond all
/// others.
fn within(
    groups: Vec<Group>,
    ranges: &[Range; 3],
    notes: &mut Vec<String>,
) -> Result<Vec<Group>, InputError> {
    let limits = ranges.each_ref().map(|range| match range.knots_mm[..] {
        [first, .., last] => [first, last],
        _ => [range.low_mm, range.high_mm],
    });
    let mut kept = Vec::new();
    for group in groups {
        let is_within = |index: &usize| {
            let at_mm = group.rows[*index].at_mm;
            (0..3).all(|axis| {
                let slack_mm = 1e-6 * (limits[axis][1] - limits[axis][0]).max(1.0);
                at_mm[axis] >= limits[axis][0] - slack_mm && at_mm[axis] <= limits[axis][1] + slack_mm
                    || !group.is_held_out && ranges[axis].knots_mm.is_empty()
            })
        };
        let inside: Vec<usize> = (0..group.rows.len()).filter(is_within).collect();
        let lost = group.rows.len() - inside.len();
        if inside.len() <= group.unknowns.len() {
            let expected =
                "positions within those of the positioning tests and of the measurements that are fitted";
            return Err(InputError::expected(&group.source, expected, "none"));
        }
        if lost > 0 {
            notes.push(format!(
                "{}: {lost} readings lie beyond the positioning tests: left out.",
                group.source
            ));
        }
        let rows = inside.iter().map(|index| group.rows[*index]).collect();
        let column = |column: &Vec<f64>| inside.iter().map(|index| column[*index]).collect();
        let unknowns = group.unknowns.iter().map(column).collect();
        kept.push(Group { rows, unknowns, ..group });
    }
    Ok(kept)
}

/// A measurement before and after, with its instrument fitted again to each.
fn judged(group: &Group, geometry: &Geometry, fit: &Fit, kept: &[usize]) -> Judged {
    let measured: Vec<f64> = group.rows.iter().map(|row| row.value_um).collect();
    let left = group.rows.iter().map(|row| {
        let effect = |term: &usize| {
            fit.values[*term] * dot(row.direction, geometry.effect_um(fit.terms[*term], row.at_mm))
        };
        row.value_um - kept.iter().map(effect).sum::<f64>()
    });
    let left: Vec<f64> = left.collect();
    Judged {
        source: group.source.clone(),
        is_held_out: group.is_held_out,
        before_um: numerics::rms(group.without_instrument(&measured)),
        after_um: numerics::rms(group.without_instrument(&left)),
    }
}
