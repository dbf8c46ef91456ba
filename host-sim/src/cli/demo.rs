//! `lost-motion demo`.

use std::path::PathBuf;

use anyhow::Result;

use super::outputs::print;
use super::progress::Progress;
use super::summary;
use demo::{self, Demo};
use files::output::write_whole;
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
}

/// Runs the command.
///
/// # Errors
/// If the simulated machine does not run, or an output cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
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
        ..Extra::default()
    };
    let path = trace_page::write(&arguments.report, &demo.trace, &extra)?;
    print(&format!(
        "{INTRODUCTION}\n\n{}\n\n{}\n{}\nReport: {}",
        summary::of_trace(&demo.trace),
        headline(&demo),
        reveal(&demo),
        path.display()
    ))
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
