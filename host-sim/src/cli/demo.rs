//! `lost-motion demo`.

use std::path::PathBuf;

use anyhow::Result;

use crate::demo;
use crate::output::write_whole;

/// Arguments of `demo`.
#[derive(clap::Args)]
pub struct Arguments {
    /// Draws the machine's true values, its undeclared effect, and all noise.
    #[arg(long, default_value_t = 7)]
    seed: u64,
    /// Write the result as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// When the simulated machine does not run or an output cannot be written.
pub fn run(arguments: &Arguments) -> Result<()> {
    let demo = demo::run(arguments.seed, &|what| eprintln!("{what}"))?;
    println!("{} {:?} named {} {:?}", demo.drawn.axis, demo.drawn.effect, demo.is_named(), demo.headline());
    for axis in &demo.trace.axes { for f in &axis.found { println!("   {} {:?} {:?}", axis.axis, f.effect, f.half_widths); } }
    if let Some(path) = &arguments.json {
        let text = serde_json::to_string_pretty(&demo.json())?;
        write_whole(path, |out| out.write_all(text.as_bytes()))?;
    }
    Ok(())
}
