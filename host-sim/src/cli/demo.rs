//! `lost-motion demo`.

use std::path::PathBuf;

use anyhow::Result;

use serde_json::json;

use super::outputs::print;
use super::progress::Progress;
use super::summary;
use compensate::round_trip::{Compared, totals_um};
use contour::ContourError;
use demo::round_trips::{Figures, MAX_PREDICTION_ERROR, RoundTrip};
use demo::{self, Demo};
use files::error::InputError;
use files::output::write_whole;
use report::round_trip::RoundTripMotion;
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
    /// With --machines: the velocity feed-forward of the machines is already set.
    #[arg(long, requires = "machines")]
    feedforward_set: bool,
}

/// Runs the command.
///
/// # Errors
/// If the simulated machine does not run, or an output cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    if let Some(count) = arguments.machines {
        return round_trips(arguments, count);
    }
    let progress = Progress::start();
    let demo = demo::run(arguments.seed, &|what| progress.show(what))?;
    drop(progress);
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&demo.json())?;
        write_whole(path, |out| out.write_all(text.as_bytes()))?;
    }
    let extra = Extra {
        title: format!("Lost motion of the demo machine, seed {}", demo.seed),
        lead: vec![INTRODUCTION.to_owned(), headline(&demo)],
        truth: Some(vec![(demo.drawn.axis.clone(), demo.drawn.effect.clone())]),
        round_trip: (round_trip_motions(&demo), compensated(&demo)),
        ..Extra::default()
    };
    let path = trace_page::write(&arguments.report, &demo.trace, &extra)?;
    print(&format!(
        "{INTRODUCTION}\n\n{}\n\n{}\n{}\n\n{}\n\n{}\n\nReport: {}",
        summary::of_trace(&demo.trace),
        headline(&demo),
        reveal(&demo),
        compensated(&demo),
        table(&demo),
        path.display()
    ))
}

/// The contour error before, as predicted, and after, and where the controller ran.
fn compensated(demo: &Demo) -> String {
    let [before, predicted, after] = totals_um(&demo.compensated.motions);
    format!(
        "Compensated by the traced model, the contour error at the tool changed from {before:.2} to {after:.2} µm rms \
         ({predicted:.2} µm were predicted); the controller ran {}.",
        demo.compensated.place.words()
    )
}

fn table(demo: &Demo) -> String {
    let mut lines = vec![
        format!("{:<16}{:>27}{:>27}{:>27}", "contour error, µm", "rms", "greatest", "circular deviation G"),
        format!("{:<16}{}", "motion", format!("{:>9}{:>9}{:>9}", "before", "predict.", "after").repeat(3)),
    ];
    let cell = |value: Option<f64>| value.map_or(format!("{:>9}", "–"), |um| format!("{um:>9.2}"));
    for motion in &demo.compensated.motions {
        let of = |value: fn(&ContourError) -> Option<f64>| {
            motion.errors.iter().map(value).map(cell).collect::<String>()
        };
        let [rms, max, circular] =
            [of(|error| Some(error.rms_um)), of(|error| Some(error.max_um)), of(ContourError::circular_um)];
        lines.push(format!("{:<16}{rms}{max}{circular}", motion.name));
    }
    lines.join("\n")
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
    let progress = Progress::start();
    progress.show("logging, tracing, compensating and running the machines again");
    let trips = demo::round_trips::round_trips(arguments.seed, count, arguments.feedforward_set, &|| ())?;
    drop(progress);
    let Some(figures) = Figures::of(&trips) else {
        return Err(InputError::expected("--machines", "at least 1", count).into());
    };
    if let Some(path) = &arguments.json {
        let machine = |trip: &RoundTrip| {
            let [before, predicted, after] = trip.contour_um;
            json!({
                "seed": trip.seed, "effects": trip.effects, "found": trip.found,
                "contour_error_um": {"before": before, "predicted": predicted, "after": after},
            })
        };
        let value =
            json!({"summary": figures.json(), "machines": trips.iter().map(machine).collect::<Vec<_>>()});
        let text = serde_json::to_string_pretty(&value)?;
        write_whole(path, |out| out.write_all(text.as_bytes()))?;
    }
    print(&round_trip_text(&trips, &figures))
}

fn round_trip_text(trips: &[RoundTrip], figures: &Figures) -> String {
    let mut lines = vec![
        format!(
            "Contour error of {} machines before over after the compensation: {:.1} in the median, at least {:.1} in nine of \
             ten, at least {:.2} in all; within {:.0} % of the prediction in {:.0} % of them.",
            figures.count,
            figures.median_ratio,
            figures.ninth_ratio,
            figures.min_ratio,
            100.0 * MAX_PREDICTION_ERROR,
            100.0 * figures.predicted
        ),
        String::new(),
        format!("{:>6}{:>10}{:>11}{:>9}{:>8}  effects", "seed", "before µm", "predicted", "after", "ratio"),
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
            "{:>6}{before:>10.3}{predicted:>11.3}{after:>9.3}{:>8.1}  {effects}{found}",
            trip.seed,
            trip.ratio()
        )
    }));
    lines.join("\n")
}

const INTRODUCTION: &str = "A simulated two-axis machine executed circles, a motion over its travel and a corner. \
                            Its logs were traced with its declared model.";

/// The residual before and after, on held-out motions.
fn headline(demo: &Demo) -> String {
    let Some(h) = demo.headline() else { return "No residual could be evaluated.".to_owned() };
    format!(
        "On held-out motions, the {} residual of {} changed from {:.3} to {:.3} µm; the sensor noise is {:.3} µm.",
        stage_names(&[h.stage]),
        demo.drawn.axis,
        h.before,
        h.after,
        h.noise
    )
}

/// The true effect, which the tracer did not know, and whether it was identified.
fn reveal(demo: &Demo) -> String {
    let verdict = if demo.is_named() { "identified" } else { "not identified" };
    let truth = demo.drawn.effect.sentence(&[], false);
    format!("True effect (seed {}): {}: {truth} ({verdict}).", demo.seed, demo.drawn.axis)
}
