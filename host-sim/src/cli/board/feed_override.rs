//! `lost-motion board override`: the feed override.

use anyhow::Result;

use super::port::PortArguments;
use crate::cli::outputs::print;
use files::error::InputError;
use shared::interpolate::feed_hold::MOST_PERCENT;

/// Arguments of `board override`.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    port: PortArguments,
    /// Speed of what runs over its planned speed, 0 to 200.
    #[arg(long, allow_negative_numbers = true)]
    percent: f64,
}

impl Arguments {
    /// The whole number of percent.
    fn percent(&self) -> Result<u8, InputError> {
        let is_valid = (0.0..=f64::from(MOST_PERCENT)).contains(&self.percent) && self.percent.fract() == 0.0;
        if !is_valid {
            let expected = format!("a whole number from 0 to {MOST_PERCENT}");
            return Err(InputError::expected("--percent", expected, self.percent));
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 200")]
        let percent = self.percent as u8;
        Ok(percent)
    }
}

/// Sets the override of what runs, also for another program at the port. It ends with a stop, with the drives and with the session.
///
/// # Errors
/// Invalid arguments, a board that cannot be reached, or on which nothing moves.
pub fn run(arguments: &Arguments) -> Result<()> {
    let percent = arguments.percent()?;
    let mut observer = arguments.port.observe()?;
    observer.set_override(percent)?;
    let most = observer.status()?.feed_override.most_percent;
    print(&if percent > most {
        format!(
            "The override is {percent} %. Speed or acceleration of the axes limit this motion to {most} %."
        )
    } else {
        format!("The override is {percent} %.")
    })
}
