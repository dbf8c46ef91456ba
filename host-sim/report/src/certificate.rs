//! What stands at the top of the page of a trace: the verdict in one sentence, the limits, and the circumstances.

use maud::{Markup, html};

use budget::limits::{Judgement, summary};
use budget::traced;
use budget::{Budget, MotionBudget};
use files::format::significant;
use model::effects::Stage;
use pages::file_name;
use pages::markup::{Column, note, number_cell, table, table_with, text, words_cell};
use trace::analysis::residual_analysis::UnexplainedResidual;
use trace::input::signals::Signals;
use trace::stages::{residual_unit, stage_names};
use trace::verdict::{self, Verdict};
use trace::{AxisIdentification, Identification};

/// What is told of a trace besides its result. What is not given does not stand on the page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Circumstances {
    /// When and where it was traced, as the JSON has it.
    pub traced: traced::Circumstances,
    /// How the program was called.
    pub command_line: Option<String>,
}

/// The result in one sentence: the error at the tool, its largest cause, what to do about it, and what is not known.
#[must_use]
pub fn verdict(trace: &Identification, budget: Option<&Budget>, limits: &[Judgement]) -> String {
    let found = verdict::of(trace);
    let first = match (found, budget.and_then(|budget| budget.motions.first())) {
        (Verdict::ModelDoesNotFit, _) => undescribed(trace),
        (_, Some(motion)) => of_motion(motion),
        (_, None) => of_effects(trace),
    };
    let left = (found == Verdict::Unexplained).then(|| unexplained(trace));
    let parts: Vec<String> = [first].into_iter().chain(left).chain(summary(limits)).collect();
    format!("{}.", parts.join("; "))
}

/// That the figures of the page are worth nothing.
fn undescribed(trace: &Identification) -> String {
    let axes = trace.axes().iter().filter(|axis| verdict::of_axis(axis) == Verdict::ModelDoesNotFit);
    let axes: Vec<&str> = axes.map(|axis| axis.axis.as_str()).collect();
    format!(
        "The machine file does not describe the logs of axis {}, so that no figure on this page can be relied on",
        axes.join(" and ")
    )
}

/// That something is not explained, with the largest residual of the positions.
fn unexplained(trace: &Identification) -> String {
    let of_axis = |axis: &'_ AxisIdentification| {
        let positions = axis.unexplained.iter().filter(|rest| rest.stage != Stage::Force);
        let named = |rest: &UnexplainedResidual| {
            let unit = residual_unit(axis.unit, rest.stage).0;
            let stage = stage_names(&[rest.stage]);
            (rest.rms, format!(" ({}, {stage}: {} {unit} rms)", axis.axis, significant(rest.rms, 3)))
        };
        positions.map(named).collect::<Vec<_>>()
    };
    let largest = trace.axes().iter().flat_map(of_axis).max_by(|a, b| a.0.total_cmp(&b.0));
    let largest = largest.map(|(_, named)| named).unwrap_or_default();
    format!("a part of what was measured is explained by nothing that was found{largest}")
}

/// The error of a motion, its largest cause, and what to do about it.
fn of_motion(motion: &MotionBudget) -> String {
    let um = |um: f64| significant(um, 3);
    let circular = motion.whole.circular.map_or(String::new(), |g| format!(" (G = {} µm)", um(g)));
    let largest = motion.causes.iter().find(|cause| cause.share.rms > 0.0);
    let by = largest.map_or(String::new(), |cause| {
        format!(
            "; the largest cause is {} ({}, {} µm rms): {}",
            cause.plain_title(),
            cause.certainty.word(),
            um(cause.share.rms),
            cause.remedy
        )
    });
    format!(
        "By the model, the tool is {} µm rms and at most {} µm from the path of the standard motion {}{circular}{by}",
        um(motion.whole.rms),
        um(motion.whole.max),
        motion.name
    )
}

/// How many effects were found, where nothing says what they cost.
fn of_effects(trace: &Identification) -> String {
    let count: usize = trace.axes().iter().map(|axis| axis.found.len()).sum();
    match count {
        0 => "No undeclared effect was found".to_owned(),
        1 => "One undeclared effect was found; what it costs at the tool is not known".to_owned(),
        _ => format!("{count} undeclared effects were found; what they cost at the tool is not known"),
    }
}

/// The table of limits; empty without any.
#[must_use]
pub fn limits(judgements: &[Judgement]) -> Markup {
    const NOTE: &str = "G: circular deviation (ISO 230-4). Greatest: distance from the path. Corner: overshoot or rounding. \
                        A figure is judged by the logs of the tool, the worst of them; where there is none, by the error \
                        budget. What cannot be told is not a pass.";
    if judgements.is_empty() {
        return Markup::default();
    }
    let columns = [
        Column::Words("figure"),
        Column::Numbers("limit, µm"),
        Column::Numbers("value, µm"),
        Column::Words("result"),
        Column::Words("judged by"),
        Column::Words("why not known"),
    ];
    let rows = html! {
        @for judgement in judgements {
            tr {
                th scope="row" { (judgement.name.name()) }
                (number_cell(&significant(judgement.limit_um, 3)))
                (number_cell(&judgement.value_um.map_or("–".to_owned(), |um| significant(um, 3))))
                td.result { (judgement.result.word()) }
                (words_cell(&judgement.judged_by()))
                (words_cell(&judgement.why))
            }
        }
    };
    html! { (table("Limits", &columns, &rows)) (note(NOTE)) }
}

/// Machine, serial number, operator, date, logs, program and command line.
#[must_use]
pub fn circumstances(trace: &Identification, told: &Circumstances) -> Markup {
    let names =
        |logs: &[Signals]| logs.iter().map(|log| file_name(&log.source)).collect::<Vec<_>>().join(", ");
    let (fit, validate) = (names(trace.fit_logs()), names(trace.validate_logs()));
    let held_out =
        if fit == validate { "the last part of each log, which is not fitted".to_owned() } else { validate };
    let facts = [
        ("machine", Some(trace.machine().name.clone())),
        ("serial number", told.traced.serial.clone()),
        ("operator", told.traced.operator.clone()),
        ("date", told.traced.date.clone()),
        ("temperature", told.traced.temperature_c.map(|celsius| format!("{celsius} °C"))),
        ("logs fitted", Some(fit)),
        ("logs held out", Some(held_out)),
        ("program", Some(format!("lost-motion {}", env!("CARGO_PKG_VERSION")))),
        ("command line", told.command_line.clone()),
    ];
    let rows = html! {
        tbody {
            @for (name, value) in &facts {
                @if let Some(value) = value { tr { th scope="row" { (name) } td { (text(value)) } } }
            }
        }
    };
    table_with("facts", "Machine and logs", &rows)
}
