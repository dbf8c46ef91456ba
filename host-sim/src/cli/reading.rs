//! How logs of other programs are read: arguments of every command that takes a log.

use files::error::{InputError, quoted};
use import::format::Format;
use import::request::{Mapping, Request, UnitOf};

/// What the user says of the columns, units, clock and format of foreign logs. Our own logs are read without it.
#[derive(clap::Args)]
#[command(next_help_heading = "Logs of other programs")]
pub struct ReadingArguments {
    /// Column of a channel, `x_command_mm=X cmd`, or of the times, `time_s=THEIRS`. Without a header, columns are counted from 1; of a
    /// matrix they are VARIABLE:1, VARIABLE:2, …
    #[arg(long = "map", value_name = "OURS=THEIRS")]
    mappings: Vec<Mapping>,
    /// Unit of a column, if its header does not say it: `x_command_mm=inch`, `x_motor_mm=counts*0.0005`, `time_s=ms`.
    #[arg(long = "unit", value_name = "OURS=UNIT")]
    units: Vec<UnitOf>,
    /// Samples per second, if the file has no times.
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Format of the file, if it is not to be recognised by content.
    #[arg(long, value_name = "NAME")]
    preset: Option<Format>,
}

impl ReadingArguments {
    /// What the readers are asked for.
    ///
    /// # Errors
    /// If the rate is not above 0.
    pub fn request(&self) -> Result<Request, InputError> {
        if let Some(rate) = self.rate.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
            let found = quoted(&rate.to_string());
            return Err(InputError::expected("--rate", "a number of samples per second", found));
        }
        Ok(Request {
            mappings: self.mappings.clone(),
            units: self.units.clone(),
            rate_hz: self.rate,
            preset: self.preset,
        })
    }
}
