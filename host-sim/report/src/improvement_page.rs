//! The page of `improve`: what each round found and gained, and the motions before the first and after the last.

use std::path::{Path, PathBuf};

use maud::html;

use super::before_after::{self, RoundTripMotion};
use files::output::OutputError;
use pages::markup::{list, paragraph, section};

/// Writes the page into a folder, which is created if it does not exist, and returns its path. `sentences`: how the contour
/// error changed, and one sentence for each round.
///
/// # Errors
/// If the folder cannot be created or the page cannot be written.
pub fn write(
    folder: &Path,
    machine: &str,
    sentences: &[String],
    motions: &[RoundTripMotion],
) -> Result<PathBuf, OutputError> {
    let (first, rounds) = sentences.split_first().map_or(("", &[][..]), |(first, rest)| (first, rest));
    let lead = "The contour error before the first round, as predicted for the round that is kept, and measured after it.";
    let sections = html! {
        (section("Rounds", &list(rounds)))
        (section("Before and after", &before_after::round_trip(motions, lead)))
    };
    pages::write(folder, &pages::render(&format!("Improvement of {machine}"), &paragraph(first), &sections))
}
