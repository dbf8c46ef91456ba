//! A log traced: a machine with an undeclared backlash is run and logged, and the tracer, which gets the file without it,
//! says what the file lacks. With a log of your own the first half falls away: [`Log::read`] takes a CSV file.
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
    Ok(sentences::summary(&trace))
}

#[test]
fn the_backlash_is_named() -> Result<(), Box<dyn std::error::Error>> {
    let said = sentences()?.join("\n");
    assert!(said.contains("x: 9.0") && said.contains("µm backlash between screw and table"), "{said}");
    Ok(())
}
