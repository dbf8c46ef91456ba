//! `lost-motion self-test`.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow};

use super::outputs::{check_outputs, print};
use super::progress::Progress;
use super::stop::{self, Stopped};
use files::error::InputError;
use files::output::{remove_unfinished, write_whole};
use numerics::quantile;
use self_test::case::Case;
use self_test::kind::Kind;
use self_test::score::Outcome;
use self_test::summary::Summary;
use self_test::text_summary;

/// Maximum number of cases of one run, which takes several weeks.
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
    /// controller.
    #[arg(long, value_delimiter = ',', default_value = "textbook")]
    kind: Vec<Kind>,
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

impl Arguments {
    /// Kind and number of all cases, in the order in which they are run.
    fn cases(&self) -> impl Iterator<Item = (Kind, u64)> {
        self.kind.iter().flat_map(|&kind| (1..=self.cases).map(move |number| (kind, number)))
    }

    /// Number of all cases.
    fn total(&self) -> u64 {
        self.cases * self.kind.len() as u64
    }
}

/// Runs the command.
///
/// # Errors
/// Invalid arguments, output that cannot be written, [`Stopped`].
pub fn run(arguments: &Arguments) -> Result<()> {
    if !(1..=MAX_CASES).contains(&arguments.cases) {
        let expected = format!("a number of cases from 1 to {MAX_CASES}");
        return Err(InputError::expected("--cases", expected, arguments.cases).into());
    }
    let mut kinds = arguments.kind.clone();
    kinds.sort_unstable();
    kinds.dedup();
    if kinds.len() < arguments.kind.len() {
        return Err(InputError::expected("--kind", "each kind once", "one of them twice").into());
    }
    let page = pages::file_in(arguments.report.as_ref());
    check_outputs(&[], &[("--json", arguments.json.as_ref()), ("--report", page.as_ref())])?;
    stop::write_partial_result();
    let (sender, receiver) = channel();
    let work = arguments.clone();
    // On another thread, so that a long case does not delay the reaction to an interrupt.
    std::thread::spawn(move || drop(run_cases(&work, &sender)));
    let run = collect(arguments, &receiver)?;
    let mut written = Ok(());
    if !arguments.no_trace {
        written = write(arguments, &run);
    } else if run.done > 0 {
        written = print(&format!("{} cases drawn.", run.done));
    }
    written?;
    if (run.done as u64) < arguments.total() {
        remove_unfinished();
        return Err(Stopped { done: run.done, asked: arguments.total(), what: "cases" }.into());
    }
    Ok(())
}

/// A message of the working thread.
enum Message {
    /// A line of progress.
    Progress(String),
    /// A case is done: its score, if it was traced, and the time taken.
    Done(Option<Outcome>, Duration),
    /// The thread has failed and ends.
    Failed(anyhow::Error),
}

/// Draws, writes and traces all cases, one after the other; ends early if the receiver has been dropped.
fn run_cases(arguments: &Arguments, messages: &Sender<Message>) -> Result<()> {
    for (kind, number) in arguments.cases() {
        let name = case_words(kind, number);
        let message = run_case(arguments, (kind, number), messages).with_context(|| name);
        messages.send(message.unwrap_or_else(Message::Failed))?;
    }
    Ok(())
}

/// A case in messages: `case 3`, `offspec case 3`.
fn case_words(kind: Kind, number: u64) -> String {
    match kind {
        Kind::Textbook => format!("case {number}"),
        _ => format!("{kind} case {number}"),
    }
}

fn run_case(
    arguments: &Arguments,
    (kind, number): (Kind, u64),
    messages: &Sender<Message>,
) -> Result<Message> {
    let name = case_words(kind, number);
    let progress = |what: &str| drop(messages.send(Message::Progress(format!("{name}: {what}"))));
    progress("running the machine");
    let case = Case::draw_kind(kind, arguments.seed, number)?;
    if let Some(folder) = &arguments.keep {
        case.keep(folder)?;
    }
    let start = Instant::now();
    let outcome = if arguments.no_trace {
        None
    } else {
        Some(self_test::trace_and_score(&case, &|what| progress(what))?)
    };
    Ok(Message::Done(outcome, start.elapsed()))
}

/// The results of the cases so far.
#[derive(Default)]
struct Run {
    done: usize,
    outcomes: Vec<Outcome>,
    seconds: Vec<f64>,
}

/// Receives messages until all cases are done or the program is interrupted.
fn collect(arguments: &Arguments, messages: &Receiver<Message>) -> Result<Run> {
    /// Maximum delay of the reaction to an interrupt.
    const POLL_INTERVAL: Duration = Duration::from_millis(50);
    let progress = Progress::with_bar(arguments.total());
    let mut run = Run::default();
    let mut score = String::new();
    while (run.done as u64) < arguments.total() && !stop::is_interrupted() {
        match messages.recv_timeout(POLL_INTERVAL) {
            Ok(Message::Progress(what)) => progress.show(&format!("{score}{what}")),
            Ok(Message::Done(outcome, time)) => {
                run.done += 1;
                run.seconds.push(time.as_secs_f64());
                run.outcomes.extend(outcome);
                progress.set_done(run.done);
                let exact = run.outcomes.iter().filter(|outcome| outcome.is_exact()).count();
                if !run.outcomes.is_empty() {
                    score = format!("{exact} of {} exact; ", run.done);
                }
            }
            Ok(Message::Failed(error)) => return Err(error),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(anyhow!("case {} of all: the working thread ended unexpectedly", run.done + 1));
            }
        }
    }
    Ok(run)
}

/// Writes the files, then prints the summary.
fn write(arguments: &Arguments, run: &Run) -> Result<()> {
    let summary = Summary::new(&run.outcomes);
    if let Some(path) = &arguments.json {
        let json = self_test::json(arguments.seed, arguments.cases, &run.outcomes, &summary);
        let text = serde_json::to_string_pretty(&json)?;
        write_whole(path, |out| out.write_all(text.as_bytes()))?;
    }
    let sentences = text_summary::sentences(arguments.seed, &summary);
    let mut output = sentences.join("\n");
    output += &format!("\n\n{}", text_summary::tables(&run.outcomes, &summary));
    output += &format!("\n{:.1} s per case in the median.", quantile(&run.seconds, 0.5));
    if let Some(folder) = &arguments.report {
        let path = self_test::page::write(folder, &sentences, &run.outcomes, &summary)?;
        output += &format!("\nReport: {}", path.display());
    }
    if let Some(folder) = &arguments.keep {
        output += &format!("\nCases: {}", folder.display());
    }
    print(&output)
}
