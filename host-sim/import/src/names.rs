//! Names of columns in messages: which one was meant, and which there are.

use files::error::{InputError, quoted};
use files::log::{AxisLog, Channel, TIME, Unit, channel_of};

/// Least likeness of two names of which one may be a misspelling of the other.
const LIKENESS: f64 = 0.8;

/// Most letters by which a misspelt name differs from one of ours.
const MISSPELT_LETTERS: usize = 2;

/// Most names that a message lists.
const MOST: usize = 12;

/// The most similar name, if it is similar enough to be meant.
pub fn likely<'a>(name: &str, among: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let lower = name.to_lowercase();
    let scored = among.map(|other| (strsim::jaro_winkler(&lower, &other.to_lowercase()), other));
    let (likeness, best) = scored.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (likeness >= LIKENESS).then_some(best)
}

/// The name of ours that a column's name differs from by a letter or two; `None` also for a name of ours.
#[must_use]
pub fn misspelt(name: &str) -> Option<String> {
    if name == TIME || channel_of(name).is_some() {
        return None;
    }
    let mut ours: Vec<String> = vec![TIME.to_owned()];
    if let Some((axis, _)) = name.split_once('_') {
        let of_axis = |channel| Unit::ALL.map(|unit| AxisLog::new(axis, unit).column(channel));
        ours.extend(Channel::ALL.into_iter().flat_map(of_axis));
    }
    let letters = |ours: &String| strsim::osa_distance(&name.to_lowercase(), ours);
    ours.into_iter().filter(|ours| letters(ours) <= MISSPELT_LETTERS).min_by_key(letters)
}

/// Names in quotes; of many, the first.
pub fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    let first: Vec<String> = names.iter().take(MOST).map(|name| quoted(name)).collect();
    let more = names.len().saturating_sub(MOST);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{more}", first.join(", "))
}

/// The error of a column that the user names and a file with columns of these names lacks.
#[must_use]
pub fn no_column<'a>(named: &str, names: impl Iterator<Item = &'a str> + Clone, source: &str) -> InputError {
    let expected = match likely(named, names.clone()) {
        Some(name) => format!("a column of the file (did you mean {}?)", quoted(name)),
        None => format!("a column of the file: {}", listed(names)),
    };
    InputError::expected(source, expected, quoted(named))
}
