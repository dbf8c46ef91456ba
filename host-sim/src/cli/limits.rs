//! Limits of the error at the tool: arguments of every command that judges one.

use anyhow::{Result, bail};

use budget::limits::{Judgement, Limit, Outcome};

/// The limits that are asked for.
#[derive(clap::Args)]
#[command(next_help_heading = "Limits")]
pub struct ToolLimitArguments {
    /// Largest value of a figure at the tool, µm: G (circular deviation), rms or greatest (contour error), corner (overshoot or
    /// rounding). May be given several times.
    #[arg(long = "limit", value_name = "NAME=µm")]
    limits: Vec<Limit>,
    /// Exit with 1 unless every limit is kept. A limit that cannot be judged is not.
    #[arg(long, requires = "limits")]
    check: bool,
}

impl ToolLimitArguments {
    /// The limits, in the order in which they were given.
    pub fn all(&self) -> &[Limit] {
        &self.limits
    }

    /// Fails if limits are to be checked and one is not kept, or not known to be.
    pub fn checked(&self, judgements: &[Judgement]) -> Result<()> {
        let is_kept = |judgement: &&Judgement| judgement.result == Outcome::Pass;
        if self.check && !judgements.iter().all(|judgement| is_kept(&judgement)) {
            let named =
                |judgement: &Judgement| format!("{} ({})", judgement.name.name(), judgement.result.word());
            let others: Vec<String> = judgements.iter().filter(|one| !is_kept(one)).map(named).collect();
            bail!("limits that are not known to be kept: {}", others.join(", "));
        }
        Ok(())
    }
}

/// A line for each limit, after an empty one; empty without limits.
pub fn text(judgements: &[Judgement]) -> String {
    let lines: Vec<String> = judgements.iter().map(ToString::to_string).collect();
    if lines.is_empty() { String::new() } else { format!("\n\n{}", lines.join("\n")) }
}
