//! Many independent jobs, one after the other, with a progress bar; an interrupt ends them after the current one.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, anyhow};

use super::progress::Progress;
use super::stop;

/// What is to be done.
pub struct Batch<Job, Work> {
    /// The jobs, each with its name in messages.
    pub jobs: Vec<(String, Job)>,
    /// Does a job; it receives a function that shows what it does.
    pub work: Work,
}

/// The results of the jobs that are done.
pub struct Results<T> {
    /// In the order of the jobs.
    pub done: Vec<T>,
    /// The time of each, s.
    pub seconds: Vec<f64>,
    /// Number of jobs.
    pub asked: usize,
}

impl<T> Results<T> {
    /// Whether all jobs are done.
    pub fn is_complete(&self) -> bool {
        self.done.len() == self.asked
    }
}

/// A message of the working thread.
enum Message<T> {
    /// A line of progress.
    Progress(String),
    /// A job is done, and the time taken.
    Done(T, Duration),
    /// A job has failed, and the thread ends.
    Failed(anyhow::Error),
}

/// Shows what a job does.
pub type Show<'a> = &'a (dyn Fn(&str) + Sync);

impl<Job, T, Work> Batch<Job, Work>
where
    Job: Send + 'static,
    T: Send + 'static,
    Work: Fn(&Job, Show<'_>) -> Result<T> + Send + 'static,
{
    /// Does the jobs until all are done or the program is interrupted. `score` is shown before each line of progress.
    ///
    /// # Errors
    /// That of the first job that fails, with the name of the job.
    pub fn run(self, score: impl Fn(&[T]) -> String) -> Result<Results<T>> {
        let (sender, receiver) = channel();
        let asked = self.jobs.len();
        // On another thread, so that a long job does not delay the reaction to an interrupt.
        std::thread::spawn(move || drop(self.run_jobs(&sender)));
        collect(asked, &receiver, score)
    }

    /// Does all jobs; ends early if the receiver has been dropped.
    fn run_jobs(self, messages: &Sender<Message<T>>) -> Result<()> {
        for (name, job) in self.jobs {
            let show = |what: &str| drop(messages.send(Message::Progress(format!("{name}: {what}"))));
            let start = Instant::now();
            let message = match (self.work)(&job, &show).with_context(|| name.clone()) {
                Ok(result) => Message::Done(result, start.elapsed()),
                Err(error) => Message::Failed(error),
            };
            messages.send(message).map_err(|_| anyhow!("no one receives the result of {name}"))?;
        }
        Ok(())
    }
}

/// Receives messages until all jobs are done or the program is interrupted.
fn collect<T>(
    asked: usize,
    messages: &Receiver<Message<T>>,
    score: impl Fn(&[T]) -> String,
) -> Result<Results<T>> {
    /// Maximum delay of the reaction to an interrupt.
    const POLL_INTERVAL: Duration = Duration::from_millis(50);
    let progress = Progress::with_bar(asked as u64);
    let mut results = Results { done: Vec::new(), seconds: Vec::new(), asked };
    let mut prefix = String::new();
    while !results.is_complete() && !stop::is_interrupted() {
        match messages.recv_timeout(POLL_INTERVAL) {
            Ok(Message::Progress(what)) => progress.show(&format!("{prefix}{what}")),
            Ok(Message::Done(result, time)) => {
                results.done.push(result);
                results.seconds.push(time.as_secs_f64());
                progress.set_done(results.done.len());
                prefix = score(&results.done);
            }
            Ok(Message::Failed(error)) => return Err(error),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(anyhow!(
                    "the working thread ended unexpectedly after {} jobs",
                    results.done.len()
                ));
            }
        }
    }
    Ok(results)
}
