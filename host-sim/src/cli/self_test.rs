//! `lost-motion self-test`.

use std::path::{Path, PathBuf};

use anyhow::Result;

use super::batch::{Batch, Results, Show};
use super::outputs::{Output, check_outputs, print, write_json};
use super::stop::{self, Stopped};
use files::error::InputError;
use files::output::remove_unfinished;
use numerics::quantile;
use self_test::case::Case;
use self_test::detection::{Detection, SizedCase, detect};
use self_test::detection_curve::Curve;
use self_test::kind::{Kind, Kinds};
use self_test::law_case::{self, LawCase, LawOutcome};
use self_test::plan_case::{PlanCase, PlanOutcome};
use self_test::plan_summary;
use self_test::score::Outcome;
use self_test::summary::Summary;
use self_test::{detection_curve, detection_text, text_summary};

/// Maximum number of cases of a kind, which takes several weeks.
const MAX_CASES: u64 = 100_000;

/// Arguments of `self-test`.
#[derive(Clone, clap::Args)]
pub struct Arguments {
    /// Number of machines of each kind; a case does not depend on it.
    #[arg(long, default_value_t = 20)]
    cases: u64,
    /// Seed for all machines and all noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Kinds of cases, separated by commas: textbook, coarse, many, small, jerk, offspec, shape, friction, foreign, slip,
    /// controller, sensors, sparse, guide, joint; or all.
    #[arg(long, default_value = "textbook")]
    kind: Kinds,
    /// Of the kinds sensors and sparse, only the cases with this error or gap.
    #[arg(long)]
    only: Option<String>,
    #[command(flatten)]
    instead: Instead,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
    /// Write each case into this folder, as a folder of machine.toml, logs and truth.json.
    #[arg(long)]
    keep: Option<PathBuf>,
    /// Draw and write the cases without tracing them.
    #[arg(long, requires = "keep", conflicts_with_all = ["json", "report"])]
    no_trace: bool,
}

/// What is measured instead of the kinds.
#[derive(Clone, clap::Args)]
struct Instead {
    /// How often an effect of a given size, in units of the noise, is found; all effects and sizes once in 187 cases.
    #[arg(long, conflicts_with_all = ["kind", "keep", "only"])]
    detection: bool,
    /// Whether laws of the tool, drawn at random, are found in what no effect describes.
    #[arg(long, conflicts_with_all = ["kind", "only", "detection", "report", "no_trace"])]
    laws: bool,
    /// Whether a planned motion decides what a log that is too short leaves open.
    #[arg(long, conflicts_with_all = ["kind", "keep", "only", "detection", "laws", "report"])]
    plan: bool,
}

/// Runs the command.
///
/// # Errors
/// Invalid arguments, output that cannot be written, [`Stopped`].
pub fn run(arguments: &Arguments) -> Result<()> {
    check(arguments)?;
    stop::write_partial_result();
    match arguments.instead {
        Instead { detection: true, .. } => run_detection(arguments),
        Instead { laws: true, .. } => run_laws(arguments),
        Instead { plan: true, .. } => run_plans(arguments),
        _ => run_kinds(arguments),
    }
}

fn check(arguments: &Arguments) -> Result<()> {
    if !(1..=MAX_CASES).contains(&arguments.cases) {
        let expected = format!("a number of cases from 1 to {MAX_CASES}");
        return Err(InputError::expected("--cases", expected, arguments.cases).into());
    }
    if let Some(only) = &arguments.only
        && arguments.kind.iter().any(|kind| numbers(arguments, kind).next().is_none())
    {
        let expected =
            "--kind sensors or sparse and one of its errors or gaps (docs/self-test.md)".to_owned();
        return Err(InputError::expected("--only", expected, only).into());
    }
    let page = pages::file_in(arguments.report.as_ref());
    // Any file in the folder of the cases.
    let kept = arguments.keep.as_ref().map(|folder| folder.join("case"));
    let outputs = [
        Output::File("--json", arguments.json.as_ref()),
        Output::InNewFolder("--report", page.as_ref()),
        Output::InNewFolder("--keep", kept.as_ref()),
    ];
    check_outputs(&[], &outputs)?;
    Ok(())
}

/// After the results have been written: an error if the program was interrupted.
fn ended<T>(results: &Results<T>) -> Result<()> {
    if results.is_complete() {
        return Ok(());
    }
    remove_unfinished();
    Err(Stopped { done: results.done.len(), asked: results.asked as u64, what: "cases" }.into())
}

/// Draws and traces the cases of each kind.
fn run_kinds(arguments: &Arguments) -> Result<()> {
    let cases =
        arguments.kind.iter().flat_map(|kind| numbers(arguments, kind).map(move |number| (kind, number)));
    let jobs = cases.map(|(kind, number)| (kind.case_words(number), (kind, number))).collect();
    let own = arguments.clone();
    let work = move |&(kind, number): &(Kind, u64), show: Show<'_>| run_case(&own, (kind, number), show);
    let results = Batch { jobs, work }.run(|done: &[Option<Outcome>]| {
        let exact = done.iter().flatten().filter(|outcome| outcome.is_exact()).count();
        if done.iter().flatten().count() == 0 {
            String::new()
        } else {
            format!("{exact} of {} exact; ", done.len())
        }
    })?;
    if !arguments.no_trace {
        write_kinds(arguments, &results)?;
    } else if !results.done.is_empty() {
        print(&format!("{} cases drawn.", results.done.len()))?;
    }
    ended(&results)
}

/// Numbers of the cases of a kind: with `--only`, those of its error or gap.
fn numbers(arguments: &Arguments, kind: Kind) -> impl Iterator<Item = u64> {
    let is_asked = move |number: &u64| match (&arguments.only, kind.subject(*number)) {
        (None, _) => true,
        (Some(only), Some(subject)) => only == subject,
        (Some(_), None) => false,
    };
    let asked = usize::try_from(arguments.cases).unwrap_or(usize::MAX);
    (1..=MAX_CASES).filter(is_asked).take(asked)
}

fn run_case(arguments: &Arguments, (kind, number): (Kind, u64), show: Show<'_>) -> Result<Option<Outcome>> {
    show("running the machine");
    let case = Case::draw_kind(kind, arguments.seed, number)?;
    if let Some(folder) = &arguments.keep {
        case.keep(folder)?;
    }
    if arguments.no_trace {
        return Ok(None);
    }
    // A drawn loop that oscillates at the limit of its force is refused, and is no reason to lose the results of the others.
    Ok(Some(self_test::trace_and_score(&case, show).unwrap_or_else(|why| Outcome::refused(&case, &why))))
}

/// Writes the files, then prints the summary.
fn write_kinds(arguments: &Arguments, results: &Results<Option<Outcome>>) -> Result<()> {
    let outcomes: Vec<Outcome> = results.done.iter().flatten().cloned().collect();
    let summary = Summary::new(&outcomes);
    write_json(
        arguments.json.as_ref(),
        &self_test::json(arguments.seed, arguments.cases, &outcomes, &summary),
    )?;
    let sentences = text_summary::sentences(arguments.seed, &summary);
    let tables = text_summary::tables(&outcomes, &results.seconds, &summary);
    let page = |folder: &Path| self_test::page::write(folder, &sentences, &outcomes, &summary);
    let report = arguments.report.as_deref().map(page).transpose()?;
    print_summary(arguments, &[&sentences.join("\n"), &tables], &results.seconds, report)
}

/// Draws and traces the cases of the detection curve.
fn run_detection(arguments: &Arguments) -> Result<()> {
    let jobs = (1..=arguments.cases).map(|number| (Kind::Textbook.case_words(number), number)).collect();
    let seed = arguments.seed;
    let work = move |&number: &u64, show: Show<'_>| {
        show("running the machine");
        let case = SizedCase::draw(seed, number)?;
        Ok(detect(&case, show)?)
    };
    let results = Batch { jobs, work }.run(|done: &[Detection]| {
        let found = done.iter().filter(|detection| detection.is_found).count();
        format!("{found} of {} found; ", done.len())
    })?;
    let curve = Curve::new(&results.done);
    let json = detection_curve::json(seed, arguments.cases, &results.done, &curve);
    write_json(arguments.json.as_ref(), &json)?;
    let sentences = detection_text::sentences(seed, &results.done, &curve);
    let tables = detection_text::tables(&results.done, &curve);
    let page = |folder: &Path| detection_text::write_page(folder, &sentences, &results.done, &curve);
    let report = arguments.report.as_deref().map(page).transpose()?;
    print_summary(arguments, &[&sentences.join("\n"), &tables], &results.seconds, report)?;
    ended(&results)
}

/// Draws and traces the machines with a law.
fn run_laws(arguments: &Arguments) -> Result<()> {
    let jobs = (1..=arguments.cases).map(|number| (format!("law {number}"), number)).collect();
    let seed = arguments.seed;
    let keep = arguments.keep.clone();
    let work = move |&number: &u64, show: Show<'_>| {
        show("running the machine");
        let law = LawCase::draw(seed, number)?;
        if let Some(folder) = &keep {
            law.case.keep(folder)?;
        }
        Ok(LawOutcome::of(&law, &self_test::traced(&law.case, show)?))
    };
    let results = Batch { jobs, work }.run(|done: &[LawOutcome]| {
        let right = done.iter().filter(|outcome| outcome.is_right).count();
        format!("{right} of {} right; ", done.len())
    })?;
    let cases: Vec<_> = results.done.iter().map(LawOutcome::json).collect();
    write_json(arguments.json.as_ref(), &serde_json::json!({"seed": seed, "cases": cases}))?;
    print_summary(arguments, &[&law_case::summary(seed, &results.done)], &results.seconds, None)?;
    ended(&results)
}

/// Draws machines with a short log, and plans a motion for each that leaves a question.
fn run_plans(arguments: &Arguments) -> Result<()> {
    let jobs = (1..=arguments.cases).map(|number| (format!("plan {number}"), number)).collect();
    let seed = arguments.seed;
    let work = move |&number: &u64, show: Show<'_>| {
        show("running the machine");
        Ok(PlanCase::draw(seed, number)?.judged(show)?)
    };
    let results = Batch { jobs, work }.run(|done: &[Option<PlanOutcome>]| {
        let asked: Vec<&PlanOutcome> = done.iter().flatten().collect();
        let decided = asked.iter().filter(|outcome| outcome.is_decided).count();
        format!("{decided} of {} decided; ", asked.len())
    })?;
    let outcomes: Vec<PlanOutcome> = results.done.iter().flatten().cloned().collect();
    let cases: Vec<_> = outcomes.iter().map(PlanOutcome::json).collect();
    write_json(arguments.json.as_ref(), &serde_json::json!({"seed": seed, "cases": cases}))?;
    let summary = plan_summary::summary(seed, results.done.len(), &outcomes);
    print_summary(arguments, &[&summary], &results.seconds, None)?;
    ended(&results)
}

fn print_summary(
    arguments: &Arguments,
    parts: &[&str],
    seconds: &[f64],
    report: Option<PathBuf>,
) -> Result<()> {
    let mut output = parts.join("\n\n");
    output += &format!("\n{:.1} s per case in the median.", quantile(seconds, 0.5));
    if let Some(path) = report {
        output += &format!("\nReport: {}", path.display());
    }
    if let Some(folder) = &arguments.keep {
        output += &format!("\nCases: {}", folder.display());
    }
    print(&output)
}
