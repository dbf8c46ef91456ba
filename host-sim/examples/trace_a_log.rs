//! The trace of a log. A machine with a backlash is simulated and logged. The tracer receives the machine file without the
//! backlash and identifies it. For a measured log, [`Log::read`] replaces the simulation.
//!
//! `cargo run --release -p host-sim --example trace_a_log`

use files::log::Log;
use model::examples::{DEMO_BALLBAR, DEMO_CIRCLE, DEMO_MACHINE};
use model::machine::Machine;
use report::sentences;

const BACKLASH: &str = "\n[[axis.x.effect]]\nname = \"backlash\"\nwidth_um = 9.0\n";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for sentence in sentences()? {
        println!("{sentence}");
    }
    Ok(())
}

fn sentences() -> Result<Vec<String>, Box<dyn std::error::Error>> {
    let truth = Machine::parse(&format!("{DEMO_MACHINE}{BACKLASH}"), "truth.toml")?;
    let fit: Log = demo::log(&truth, DEMO_CIRCLE, 0.0, 1)?;
    let validate: Log = demo::log(&truth, DEMO_BALLBAR, 40.0, 2)?;

    let declared = Machine::parse(DEMO_MACHINE, "declared.toml")?;
    let trace = trace::trace(&declared, &[fit], &[validate], &|_| {})?;
    Ok(sentences::summary(&trace, None))
}

#[test]
fn the_backlash_is_reported() -> Result<(), Box<dyn std::error::Error>> {
    let summary = sentences()?.join("\n");
    assert!(
        summary.contains("x: 9.0") && summary.contains("µm backlash between screw and table"),
        "{summary}"
    );
    Ok(())
}
