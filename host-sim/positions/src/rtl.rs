//! The file `.rtl` that Renishaw's laser software writes for a linear axis.
//!
//! Renishaw publishes no description of it; the layout is that which two independent public readers agree on:
//!
//! ```text
//! HEADER::
//! TARGET DATA::
//! Target-count: 3
//! Targets :
//!     0.0000   50.0000  100.0000
//! Flags: …
//! RUNS::
//! Run-count: 2
//! DEVIATIONS::
//! Run Target Data:
//!   1   1    0.000
//!   …
//! ```
//!
//! Targets are in mm over several lines, deviations in µm: number of the run, number of the target from 1, deviation. A run is one pass in
//! one direction. Which direction is not told: it is the order in which the lines of a run go through the targets.

use files::error::{InputError, quoted};

use super::measured::{Reading, Test, Way};

/// Begin of the list of deviations.
const DATA: &str = "run target data";

/// Whether a text is such a file.
#[must_use]
pub fn is(text: &str) -> bool {
    let has = |word: &str| text.lines().any(|line| line.trim().to_lowercase().starts_with(word));
    has("deviations::") && has(DATA)
}

/// The test in a text; `source` is the name of the file for messages.
///
/// # Errors
/// No targets, a line that is no deviation, a target that is not in the list.
pub fn of_text(text: &str, source: &str, mut notes: Vec<String>) -> Result<Test, InputError> {
    let targets_mm = targets(text, source)?;
    let passes = passes(text, source, targets_mm.len())?;
    if passes.is_empty() {
        return Err(InputError::expected(source, "deviations after \"Run Target Data:\"", "none"));
    }
    notes.push(format!(
        "{source}: read as the file of Renishaw's laser software: targets in mm, deviations in µm."
    ));
    let ways: Vec<Option<Way>> = passes.iter().map(|pass| way(pass, &targets_mm)).collect();
    let goes_back = ways.contains(&Some(Way::Negative));
    if !goes_back && passes.len() > 1 {
        notes.push(format!(
            "{source}: every run lists its targets in rising order, so that the file does not tell which were approached in − direction: all are taken as approached in + direction."
        ));
    }
    // A run there and back is two of the file.
    let (mut runs, mut readings, mut counts) = (0, Vec::new(), [0_usize; 2]);
    for (pass, way) in passes.iter().zip(ways) {
        let way = way.unwrap_or(Way::Positive);
        let count = &mut counts[usize::from(way == Way::Negative)];
        let run = *count;
        *count += 1;
        runs = runs.max(*count);
        readings.extend(pass.iter().map(|&(target, deviation_um, line)| Reading {
            run,
            way,
            target_mm: targets_mm[target],
            deviation_um,
            time_s: None,
            line,
        }));
    }
    let run_numbers = (1..=runs).map(|count| count as f64).collect();
    Test { source: source.to_owned(), readings, run_numbers, notes }.checked()
}

/// The targets, mm.
fn targets(text: &str, source: &str) -> Result<Vec<f64>, InputError> {
    let is_begin = |line: &&str| line.trim().to_lowercase().replace(' ', "").starts_with("targets:");
    let lines = text.lines().skip_while(|line| !is_begin(line));
    let after = lines.clone().take(1).filter_map(|line| line.split_once(':')).map(|(_, rest)| rest);
    let more = lines.skip(1).take_while(|line| !line.contains(':'));
    let cells = after.chain(more).flat_map(str::split_whitespace);
    let targets: Vec<f64> = cells
        .map(|cell| {
            let number = cell.parse().ok().filter(|number: &f64| number.is_finite());
            number
                .ok_or_else(|| InputError::expected(source, "a target in mm", quoted(cell)).at_key("Targets"))
        })
        .collect::<Result<_, _>>()?;
    if targets.is_empty() {
        return Err(InputError::expected(source, "targets in mm", "none").at_key("Targets"));
    }
    Ok(targets)
}

/// A deviation: index of its target, µm, line of the file.
type Deviation = (usize, f64, usize);

/// The deviations of each run.
fn passes(text: &str, source: &str, targets: usize) -> Result<Vec<Vec<Deviation>>, InputError> {
    let lines =
        (1..).zip(text.lines()).skip_while(|(_, line)| !line.trim().to_lowercase().starts_with(DATA)).skip(1);
    let mut passes: Vec<(usize, Vec<Deviation>)> = Vec::new();
    for (line, text) in
        lines.take_while(|(_, line)| !line.contains(':')).filter(|(_, line)| !line.trim().is_empty())
    {
        let error =
            |expected: &str| InputError::expected(source, expected, quoted(text.trim())).at_line(line);
        let cells: Vec<&str> = text.split_whitespace().collect();
        let [run, target, um] = cells[..] else { return Err(error("run, target and deviation in µm")) };
        let numbers = run.parse::<usize>().ok().zip(target.parse::<usize>().ok()).zip(um.parse::<f64>().ok());
        let Some(((run, target), um)) = numbers.filter(|(_, um)| um.abs() <= 1e9) else {
            return Err(error("run, target and deviation in µm"));
        };
        if !(1..=targets).contains(&target) {
            return Err(error(&format!("a target from 1 to {targets}")));
        }
        if passes.last().is_none_or(|(last, _)| *last != run) {
            passes.push((run, Vec::new()));
        }
        if let Some((_, pass)) = passes.last_mut() {
            pass.push((target - 1, um, line));
        }
    }
    Ok(passes.into_iter().map(|(_, pass)| pass).collect())
}

/// The direction in which a pass goes through its targets.
fn way(pass: &[Deviation], targets_mm: &[f64]) -> Option<Way> {
    let (first, last) = (pass.first()?, pass.last()?);
    let travelled_mm = targets_mm[last.0] - targets_mm[first.0];
    (travelled_mm != 0.0).then_some(if travelled_mm < 0.0 { Way::Negative } else { Way::Positive })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "HEADER::\r\nFile type: RTL\r\nTARGET DATA::\r\nTarget-count: 3\r\nTargets :\r\n 0.0 50.0\r\n 100.0\r\nFlags: 0\r\nRUNS::\r\nRun-count: 2\r\nDEVIATIONS::\r\nRun Target Data:\r\n 1 1 0.5\r\n 1 2 1.5\r\n 1 3 -2.0\r\n 2 3 -3.0\r\n 2 2 1.0\r\n 2 1 0.0\r\nEQUIPMENT::\r\n";

    #[test]
    fn runs_there_and_back_are_one_run_with_both_ways() {
        assert!(is(TEXT) && !is("run,approach\n1,+\n"));
        let test = of_text(TEXT, "a.rtl", Vec::new()).unwrap();
        assert_eq!((test.runs(), test.readings.len(), test.targets_mm()), (1, 6, vec![0.0, 50.0, 100.0]));
        let third = test.readings[3];
        assert_eq!(
            (third.way, third.target_mm, third.deviation_um, third.line),
            (Way::Negative, 100.0, -3.0, 16)
        );
    }

    #[test]
    fn rising_runs_have_no_direction_and_a_wrong_line_is_named() {
        let rising = TEXT.replace(" 2 3 -3.0\r\n 2 2 1.0\r\n 2 1 0.0", " 2 1 0\r\n 2 2 0\r\n 2 3 0");
        let test = of_text(&rising, "a.rtl", Vec::new()).unwrap();
        assert!(test.runs() == 2 && !test.has_both_ways());
        assert!(test.notes.iter().any(|note| note.contains("rising order")), "{:?}", test.notes);
        let message = |text: String| of_text(&text, "a.rtl", Vec::new()).unwrap_err().to_string();
        assert_eq!(
            message(TEXT.replace(" 1 3 ", " 1 4 ")),
            "a.rtl: line 15: expected a target from 1 to 3, found \"1 4 -2.0\""
        );
        assert!(
            message(TEXT.replace(" 1 2 1.5", " 1 2")).contains("line 14: expected run, target and deviation")
        );
        assert!(message(TEXT.replace("50.0", "x")).contains("Targets: expected a target in mm"));
    }
}
