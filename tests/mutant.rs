//! Behind `shared/src/lib.rs` in the build of `tests/shared_mutants.py`: which mutant a function is.
extern crate std;

use core::sync::atomic::{AtomicBool, AtomicUsize, Ordering::Relaxed};
use std::io::Write;

/// The number of functions with mutants.
const COUNT: usize = 0;

/// `usize::MAX`: not yet known. 0: none, and functions that are called are recorded. 1: none.
static SELECTED: AtomicUsize = AtomicUsize::new(usize::MAX);

static CALLED: [AtomicBool; COUNT] = [const { AtomicBool::new(false) }; COUNT];

#[inline]
pub(crate) fn of(function: usize) -> usize {
    match SELECTED.load(Relaxed) {
        usize::MAX => select(),
        0 => called(function),
        selected => selected,
    }
}

#[cold]
fn select() -> usize {
    let selected = std::env::var("MUTANT").ok().and_then(|text| text.parse().ok()).unwrap_or(1);
    SELECTED.store(selected, Relaxed);
    selected
}

/// Writes the number of a function once to the file that the environment names.
#[cold]
fn called(function: usize) -> usize {
    if !CALLED[function].swap(true, Relaxed) {
        let path = std::env::var("CALLED").expect("a file is named");
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).expect("it can be opened");
        writeln!(file, "{function}").expect("it can be written");
    }
    0
}
