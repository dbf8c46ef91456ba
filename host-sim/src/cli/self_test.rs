//! `lost-motion self-test`.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow};

use super::progress::Progress;
use super::stop::{self, Stopped};
use super::{check_outputs, print};
use files::error::InputError;
use files::output::{remove_unfinished, write_whole};
use numerics::quantile;
use self_test::case::Case;
use self_test::score::Outcome;
use self_test::summary::Summary;
use self_test::words;

/// Most cases of one run: some weeks.
const MOST_CASES: u64 = 100_000;

/// Arguments of `self-test`.
#[derive(Clone, clap::Args)]
pub struct Arguments {
    /// How many machines are drawn; a case is the same whatever their number.
    #[arg(long, default_value_t = 20)]
    cases: u64,
    /// Draws all machines and all noise.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Write report.html into this folder.
    #[arg(long)]
    report: Option<PathBuf>,
    /// Write each case into this folder, as a folder of machine.toml, logs and truth.json.
    #[arg(long)]
    keep: Option<PathBuf>,
    /// Only draw and keep.
    #[arg(long, requires = "keep", conflicts_with_all = ["json", "report"])]
    no_trace: bool,
}

/// Runs the command.
///
/// # Errors
/// Arguments that cannot be used, output that cannot be written, [`Stopped`].
pub fn run(arguments: &Arguments) -> Result<()> {
    if !(1..=MOST_CASES).contains(&arguments.cases) {
        let expected = format!("a number of cases from 1 to {MOST_CASES}");
        return Err(InputError::expected("--cases", expected, arguments.cases).into());
    }
    let page = report::file_in(arguments.report.as_ref());
    check_outputs(&[], &[("--json", arguments.json.as_ref()), ("--report", page.as_ref())])?;
    stop::write_first();
    let (sender, receiver) = channel();
    let work = arguments.clone();
    // Beside this thread, so that a case that takes long does not keep the user waiting who wants to end.
    std::thread::spawn(move || drop(all(&work, &sender)));
    let run = collect(arguments, &receiver)?;
    let mut written = Ok(());
    if !arguments.no_trace {
        written = write(arguments, &run);
    } else if run.done > 0 {
        written = print(&format!("{} cases drawn.", run.done));
    }
    written?;
    if (run.done as u64) < arguments.cases {
        remove_unfinished();
        return Err(Stopped { done: run.done, asked: arguments.cases, what: "cases" }.into());
    }
    Ok(())
}

/// What the working thread has to tell.
enum News {
    /// What it is doing.
    Doing(String),
    /// A case is done: its score, if it was traced, and the time that took.
    Done(Option<Outcome>, Duration),
    /// It cannot go on.
    Failed(anyhow::Error),
}

/// Draws, keeps and traces all cases, one after the other; ends early if nobody listens any more.
fn all(arguments: &Arguments, news: &Sender<News>) -> Result<()> {
    for number in 1..=arguments.cases {
        let told = one(arguments, number, news).with_context(|| format!("case {number}"));
        news.send(told.unwrap_or_else(News::Failed))?;
    }
    Ok(())
}

fn one(arguments: &Arguments, number: u64, news: &Sender<News>) -> Result<News> {
    let doing = |what: &str| drop(news.send(News::Doing(format!("case {number}: {what}"))));
    doing("running the machine");
    let case = Case::draw(arguments.seed, number)?;
    if let Some(folder) = &arguments.keep {
        case.keep(folder)?;
    }
    let began = Instant::now();
    let outcome = if arguments.no_trace { None } else { Some(self_test::judge(&case, &|what| doing(what))?) };
    Ok(News::Done(outcome, began.elapsed()))
}

/// What has been done when the run ends.
#[derive(Default)]
struct Run {
    done: usize,
    outcomes: Vec<Outcome>,
    seconds: Vec<f64>,
}

/// Listens until all cases are done or the user wants to end.
fn collect(arguments: &Arguments, news: &Receiver<News>) -> Result<Run> {
    const PATIENCE: Duration = Duration::from_millis(50);
    let progress = Progress::of(arguments.cases);
    let mut run = Run::default();
    let mut score = String::new();
    while (run.done as u64) < arguments.cases && !stop::is_asked() {
        match news.recv_timeout(PATIENCE) {
            Ok(News::Doing(what)) => progress.show(&format!("{score}{what}")),
            Ok(News::Done(outcome, time)) => {
                run.done += 1;
                run.seconds.push(time.as_secs_f64());
                run.outcomes.extend(outcome);
                progress.done(run.done);
                let exact = run.outcomes.iter().filter(|outcome| outcome.is_exact()).count();
                if !run.outcomes.is_empty() {
                    score = format!("{exact} of {} exact; ", run.done);
                }
            }
            Ok(News::Failed(error)) => return Err(error),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(anyhow!("case {}: the tracer gave up", run.done + 1));
            }
        }
    }
    Ok(run)
}

/// Files, then words.
fn write(arguments: &Arguments, run: &Run) -> Result<()> {
    let summary = Summary::new(&run.outcomes);
    if let Some(path) = &arguments.json {
        let json = self_test::json(arguments.seed, arguments.cases, &run.outcomes, &summary);
        let text = serde_json::to_string_pretty(&json)?;
        write_whole(path, |out| out.write_all(text.as_bytes()))?;
    }
    let sentences = words::sentences(arguments.seed, &summary);
    let mut said = sentences.join("\n");
    said += &format!("\n\n{}", words::tables(&run.outcomes, &summary));
    said += &format!("\n{:.1} s a case in the median.", quantile(&run.seconds, 0.5));
    if let Some(folder) = &arguments.report {
        let path = self_test::page::write(folder, &sentences, &run.outcomes, &summary)?;
        said += &format!("\nReport: {}", path.display());
    }
    if let Some(folder) = &arguments.keep {
        said += &format!("\nCases: {}", folder.display());
    }
    print(&said)
}
