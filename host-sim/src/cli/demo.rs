//! `lost-motion demo`.

use std::path::PathBuf;

use anyhow::Result;

use serde_json::json;

use super::outputs::{check_json_and_page, print, write_json};
use super::progress::Progress;
use super::summary;
use commissioning::compensate::limits::Limit;
use commissioning::compensate::round_trip::{Compared, totals_um};
use contour::comparison::{self, Comparison};
use demo::round_trips::{Figures, MAX_PREDICTION_ERROR, Machines, RoundTrip, Simulator};
use demo::{self, Demo, Traced};
use files::error::InputError;
use files::format::significant;
use report::before_after::RoundTripMotion;
use report::trace_page::{self, Extra};
use trace::stages::stage_names;

/// Arguments of `demo`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Seed for the machine's true values, its undeclared effect and all noise.
    #[arg(long, default_value_t = 2)]
    seed: u64,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long, default_value = "report")]
    report: PathBuf,
    /// Instead of one machine, the round trips of this many machines with one to three effects, from the seed on: a table.
    #[arg(long, value_name = "COUNT")]
    machines: Option<u64>,
    /// With --machines: the velocity feed-forward is already 100 % before the compensation.
    #[arg(long, requires = "machines")]
    feedforward_set: bool,
    /// With --machines: machines of the self-test, simulated by its second simulator, which shares no code with the first one.
    #[arg(long, requires = "machines")]
    second_simulator: bool,
}

/// Runs the command.
///
/// # Errors
/// If the simulated machine does not run, or an output cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let page = pages::file_in(Some(&arguments.report));
    check_json_and_page(&[], arguments.json.as_ref(), page.as_ref())?;
    if let Some(count) = arguments.machines {
        return round_trips(arguments, count);
    }
    let progress = Progress::start();
    let demo = demo::run(arguments.seed, &|what| progress.show(what))?;
    progress.show("simulating the motions with and without each cause");
    let budget = budget::traced::budget(&demo.traced.trace)?;
    drop(progress);
    write_json(arguments.json.as_ref(), &demo.json())?;
    let traced = &demo.traced;
    let extra = Extra {
        title: format!("Lost motion of the demo machine, seed {}", traced.seed),
        lead: vec![INTRODUCTION.to_owned(), headline(traced)],
        truth: Some(vec![(traced.drawn.axis.clone(), traced.drawn.effect.clone())]),
        contour_errors: traced.contour_errors.clone(),
        budget,
        round_trip: (round_trip_motions(&demo), round_trip_lead(&demo)),
        ..Extra::default()
    };
    let path = trace_page::write(&arguments.report, &demo.traced.trace, &extra)?;
    let rows: Vec<Comparison> = demo.compensated.motions.iter().map(Compared::comparison).collect();
    print(&format!(
        "{INTRODUCTION}\n\n{}\n\n{}\n{}\n\n{}\n\n{}\n\n{}\n\nReport: {}",
        summary::of_trace(&traced.trace, extra.budget.as_ref(), true),
        headline(traced),
        reveal(traced),
        compensated(&demo),
        comparison::text(&rows),
        demo.compensated.limits.sentence(),
        path.display()
    ))
}

/// The contour error before, as predicted, and after, and where the controller ran.
fn compensated(demo: &Demo) -> String {
    let [before, predicted, after] = totals_um(&demo.compensated.motions).map(|um| significant(um, 3));
    format!(
        "Compensated by the traced model, the contour error at the tool changed from {before} to {after} µm rms \
         ({predicted} µm were predicted); the controller ran {}.",
        demo.controller_host.words()
    )
}

/// What the compensation gained, and what limits the error that is left.
fn round_trip_lead(demo: &Demo) -> String {
    format!("{} {}", compensated(demo), demo.compensated.limits.sentence())
}

fn round_trip_motions(demo: &Demo) -> Vec<RoundTripMotion> {
    let one = |motion: &Compared| RoundTripMotion {
        name: motion.name.clone(),
        axes: motion.logs[0].axes.iter().map(|axis| axis.name.clone()).collect(),
        errors: motion.errors.clone(),
    };
    demo.compensated.motions.iter().map(one).collect()
}

/// The round trips of many machines.
fn round_trips(arguments: &Arguments, count: u64) -> Result<()> {
    let progress = Progress::with_bar(count);
    progress.show("logging, tracing, compensating and running the machines again");
    let done = |machines| progress.set_done(machines);
    let simulator = if arguments.second_simulator { Simulator::SelfTest } else { Simulator::Plant };
    let machines = Machines { simulator, has_feedforward: arguments.feedforward_set };
    let trips = demo::round_trips::round_trips(machines, arguments.seed, count, &done)?;
    drop(progress);
    let Some(figures) = Figures::of(&trips) else {
        return Err(InputError::expected("--machines", "at least 1", count).into());
    };
    let machines: Vec<_> = trips.iter().map(RoundTrip::json).collect();
    write_json(arguments.json.as_ref(), &json!({"summary": figures.json(), "machines": machines}))?;
    print(&round_trip_text(&trips, &figures))
}

/// The ratios of the machines and how many of the predictions hold.
fn round_trip_sentence(figures: &Figures) -> String {
    let within = 100.0 * MAX_PREDICTION_ERROR;
    if figures.count == 1 {
        let is_within = if figures.predicted > 0.5 { "is" } else { "is not" };
        return format!(
            "Contour error of 1 machine before over after the compensation: {:.2}; the error after it {is_within} within \
             {within:.0} % of the prediction.",
            figures.min_ratio
        );
    }
    format!(
        "Contour error of {} machines before over after the compensation: {:.1} in the median, at least {:.1} in nine of ten, \
         at least {:.2} in all; within {within:.0} % of the prediction in {:.0} % of them.",
        figures.count,
        figures.median_ratio,
        figures.ninth_ratio,
        figures.min_ratio,
        100.0 * figures.predicted
    )
}

fn round_trip_text(trips: &[RoundTrip], figures: &Figures) -> String {
    let mut lines = vec![
        round_trip_sentence(figures),
        limited_by(figures),
        String::new(),
        format!(
            "{:>6}{:>10}{:>11}{:>9}{:>8}  {:<12}effects",
            "seed", "before µm", "predicted", "after", "ratio", "limit"
        ),
    ];
    lines.extend(trips.iter().map(|trip| {
        let [before, predicted, after] = trip.contour_um;
        let found = if trip.effects.iter().all(|effect| trip.found.contains(effect))
            && trip.found.len() == trip.effects.len()
        {
            String::new()
        } else {
            format!(" (found: {})", trip.found.join(", "))
        };
        let effects = trip.effects.join(", ");
        format!(
            "{:>6}{before:>10.3}{predicted:>11.3}{after:>9.3}{:>8.1}  {:<12}{effects}{found}",
            trip.seed,
            trip.ratio(),
            trip.limits.largest().word()
        )
    }));
    lines.join("\n")
}

/// On how many machines each part of what is left is the largest.
fn limited_by(figures: &Figures) -> String {
    let parts = Limit::ALL.iter().zip(figures.limited_by).filter(|(_, machines)| *machines > 0);
    let parts: Vec<String> =
        parts.map(|(limit, machines)| format!("{} on {machines}", limit.word())).collect();
    format!("The largest part of what is left is due to: {} (docs/compensation.md).", parts.join(", "))
}

const INTRODUCTION: &str = "A simulated two-axis machine executed circles, a motion over its travel and a corner. \
                            Its logs were traced with its declared model.";

/// The residual before and after, on held-out motions.
fn headline(traced: &Traced) -> String {
    let Some(h) = traced.headline() else { return "No residual could be evaluated.".to_owned() };
    format!(
        "On held-out motions, the {} residual of {} changed from {} to {} µm; the sensor noise is {} µm.",
        stage_names(&[h.stage]),
        traced.drawn.axis,
        significant(h.before, 3),
        significant(h.after, 3),
        significant(h.noise, 3)
    )
}

/// The true effect, which the tracer did not know, and whether it was identified.
fn reveal(traced: &Traced) -> String {
    let verdict = if traced.is_named() { "identified" } else { "not identified" };
    let truth = traced.drawn.effect.sentence(&[], false);
    format!("True effect (seed {}): {}: {truth} ({verdict}).", traced.seed, traced.drawn.axis)
}
