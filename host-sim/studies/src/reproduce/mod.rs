//! Published experiments repeated on the simulated machine, and comparison of the printed values with ours.
//!
//! One module per paper; each returns a [`Study`]: findings as sentences, every value with its verdict, and
//! pictures. Where the printed text is illegible or wrong, the notes of the study give the reading that was used and
//! the reason. `docs/reproduce.md` contains all papers on one page.

pub mod acceleration;
pub mod corner;
pub mod dual_feedback;
pub mod page;
pub mod stick_slip;
pub mod study;

pub use study::{Outcome, Picture, Printed, ReproduceError, Reproduction, Study};

use rayon::prelude::*;

/// Runs the experiments of all papers in parallel; `progress` receives the name of each one as it starts.
///
/// # Errors
/// If an experiment cannot be run.
pub fn run(progress: &(dyn Fn(&str) + Sync)) -> Result<Reproduction, ReproduceError> {
    type Run = fn() -> Result<Study, ReproduceError>;
    let papers: [(&str, Run); 4] = [
        ("dual feedback", dual_feedback::run),
        ("errors at the corner", corner::run),
        ("stick-slip", stick_slip::run),
        ("acceleration", acceleration::run),
    ];
    let studies = papers
        .into_par_iter()
        .map(|(name, run)| {
            progress(name);
            run()
        })
        .collect::<Result<_, _>>()?;
    Ok(Reproduction { studies })
}
