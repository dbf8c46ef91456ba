//! A survey, evaluated.

use serde::Serialize;

use files::error::InputError;
use files::format::significant;

use super::axis_table::{self, AxisTable};
use super::component::{Axis, Component, Kind, Range};
use super::field::Geometry;
use super::fit::Fit;
use super::measurement::{Group, Row};
use super::selection::{self, HALF_95, Item, Selected, Shown, of_item, shown};
use super::survey::What;
use super::vector::dot;

/// Most knots of a positioning error.
const MAX_KNOTS: usize = 60;

/// Targets that differ by less than this part of the range are one.
const SAME_TARGET: f64 = 1e-4;

/// Positions of each axis at which the size of an error is looked for.
const POSITIONS: usize = 81;

/// Least that is left of a measurement, µm rms, that is worth a sentence.
const UNDESCRIBED_UM: f64 = 0.5;

/// Factor by which a held-out measurement may be worse before the result is not confirmed: chance.
const WORSE: f64 = 1.1;

/// An error that was looked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The name of ISO 230-1, such as `EYX`; of squareness the two axes.
    pub name: String,
    /// In words.
    pub words: String,
    /// Unit of the value: µm, µrad, or µm/m for squareness.
    pub unit: &'static str,
    /// What is known of it.
    #[serde(flatten)]
    pub known: Known,
}

/// What is known of an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "known", rename_all = "snake_case")]
pub enum Known {
    /// It is there, and is in the tables.
    Shown {
        /// Where it is furthest from zero; of squareness its slope.
        greatest: f64,
        /// Half of the 95 % interval there.
        half_width: f64,
    },
    /// It is not told from zero.
    Small {
        /// The furthest that it may move the tool at any reading, µm.
        at_most_um: f64,
    },
    /// The measurements do not determine it.
    Open {
        /// The measurement that would.
        shown_by: String,
    },
}

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
    /// Whether no held-out measurement is worse with the errors that are shown. `None`: nothing was held out.
    pub is_confirmed: Option<bool>,
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
    let fitted = groups.iter().filter(|group| !group.is_held_out);
    let rows: Vec<Row> = fitted.flat_map(|group| group.rows.iter().copied()).collect();
    let geometry = Geometry::new(chain, ranges, &rows);
    let Selected { fit, small, simpler } = selection::fitted(&geometry, &groups);
    notes.extend(simplified(&simpler));
    let is_shown = |item: Item| shown(&fit, item) == Shown::Yes;
    let kept: Vec<usize> =
        (0..fit.terms.len()).filter(|term| Item::of(fit.terms[*term]).is_some_and(is_shown)).collect();
    let tables = axis_table::of(&geometry, &fit, &kept);
    let findings = findings(&geometry, &groups, &fit, &small);
    let judged: Vec<Judged> = groups.iter().map(|group| judged(group, &geometry, &fit, &kept)).collect();
    notes.extend(groups.iter().zip(&judged).filter_map(|(group, judged)| undescribed(group, judged)));
    let held_out = || judged.iter().filter(|judged| judged.is_held_out);
    let is_confirmed =
        held_out().next().map(|_| held_out().all(|judged| judged.after_um <= WORSE * judged.before_um));
    if groups.iter().any(|group| matches!(group.what, What::Circle { .. })) {
        notes.push(
            "Errors that depend on acceleration (in-talk, cross-talk) look like squareness on a circle: they grow with the square of the feed, so \
             measure circles slowly, or at two feeds."
                .to_owned(),
        );
    }
    let measured_mm = [0, 1, 2].map(|axis| [geometry.ranges[axis].low_mm, geometry.ranges[axis].high_mm]);
    let lever_from_mm = [0, 1, 2].map(|axis| geometry.ranges[axis].lever_from_mm);
    Ok(Analysis { chain, measured_mm, lever_from_mm, findings, judged, is_confirmed, tables, notes })
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
            "Taken as zero, as these measurements do not tell them from other errors: cubic bends, and bends of tilts, of {}. \
             Circles about other centres would show them.",
            names.join(", ")
        )
    })
}

/// The positions of an axis in the measurements that are fitted.
fn range(axis: Axis, groups: &[Group]) -> Range {
    let fitted = || groups.iter().filter(|group| !group.is_held_out);
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

/// All errors: shown, small, open.
fn findings(geometry: &Geometry, groups: &[Group], fit: &Fit, small: &[(Item, f64)]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for item in selection::items(&geometry.terms()) {
        let small = small.iter().find(|(other, _)| *other == item).map(|(_, bound_um)| *bound_um);
        let known = match (small, shown(fit, item)) {
            (Some(at_most_um), _) => Known::Small { at_most_um },
            (None, Shown::Yes) => greatest(geometry, fit, item),
            (None, Shown::No) => Known::Small { at_most_um: selection::bound(fit, geometry, groups, item) },
            (None, Shown::Open) => Known::Open { shown_by: item.component.shown_by(geometry.chain) },
        };
        findings.push(named(item, known));
    }
    for component in Component::all() {
        let is_known = findings.iter().any(|finding| finding.name == component.name());
        if !is_known {
            let item = Item { component, is_squareness: false };
            findings.push(named(item, Known::Open { shown_by: component.shown_by(geometry.chain) }));
        }
    }
    let rank = |finding: &Finding| match finding.known {
        Known::Shown { .. } => 0,
        Known::Small { .. } => 1,
        Known::Open { .. } => 2,
    };
    findings.sort_by_key(rank);
    findings
}

fn named(item: Item, known: Known) -> Finding {
    let component = item.component;
    match component.kind {
        Kind::Along(axis) if item.is_squareness => {
            let [leaning, to] = [component.moved.name(), axis.name()];
            let words = format!("squareness: {leaning} leans towards + of {to}");
            Finding { name: format!("{to}-{leaning}"), words, unit: "µm/m", known }
        }
        _ => Finding { name: component.name(), words: component.words(), unit: component.unit(), known },
    }
}

/// The value of an item where it is furthest from zero; of squareness its slope, µm/m.
fn greatest(geometry: &Geometry, fit: &Fit, item: Item) -> Known {
    let own = of_item(&fit.terms, item);
    let [low_mm, high_mm] = geometry.spans_mm.get(&item.component).copied().unwrap_or_default();
    let span_mm = high_mm - low_mm;
    if item.is_squareness {
        // From −1 to 1 over the span: twice the value in its length.
        let per_m = 2.0 * 1e3 / span_mm;
        let deviation = fit.covariance[(own[0], own[0])].max(0.0).sqrt();
        return Known::Shown {
            greatest: per_m * fit.values[own[0]],
            half_width: per_m * HALF_95 * deviation,
        };
    }
    let at = |step: usize| {
        let mm = low_mm + span_mm * step as f64 / (POSITIONS - 1) as f64;
        let courses: Vec<f64> = own.iter().map(|term| geometry.value(fit.terms[*term], mm)).collect();
        let value: f64 = courses.iter().zip(&own).map(|(course, term)| course * fit.values[*term]).sum();
        let mut variance = 0.0;
        for (a, first) in own.iter().enumerate() {
            for (b, second) in own.iter().enumerate() {
                variance += courses[a] * courses[b] * fit.covariance[(*first, *second)];
            }
        }
        (value, HALF_95 * variance.max(0.0).sqrt())
    };
    let furthest = (0..POSITIONS).map(at).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let (greatest, half_width) = furthest.unwrap_or((0.0, 0.0));
    Known::Shown { greatest, half_width }
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
