//! A machine file from logs.
//!
//! For a user who has a log but does not know masses, stiffness or gains, this crate writes a first machine file: the values that the logs
//! show, each with its interval as a tolerance, within which a trace may adjust it. Values known to the user ([`known`]) remain as declared.
//!
//! 1. [`rough`]: first values by linear regressions: [`mechanics`] from force, motor and table, the loops from command, motor and
//!    force ([`control_loop`]) or without a force ([`velocity_loop`]).
//! 2. [`form`]: traces from these values, for each form of the loops; the form with the smallest residual is kept.
//! 3. [`initial`]: the values are fitted and get their tolerances. What the logs do not determine remains unknown ([`shown`]); an error that
//!    repeats over the position is reported if the lead is not known ([`period`]).
//! 4. [`written`]: the file with a comment for each value.
//!
//! [`estimate`] has the first values of a trace whose machine file lacks them; [`gains`] those of a velocity drive.
//!
//! What logs cannot show remains unknown: the lead of a screw, limits, and everything that only a missing channel would show.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod control_loop;
pub mod direction;
pub mod estimate;
pub mod form;
pub mod gains;
pub mod initial;
pub mod known;
pub mod mechanics;
pub mod period;
pub mod regression;
pub mod rough;
pub mod shown;
pub mod velocity_loop;
pub mod written;

use files::error::InputError;
use files::log::Log;
use indexmap::IndexMap;
use model::axis::{KeyNames, Settings};
use model::machine::{Axis, Machine, rotary};

pub use initial::{Initial, machine};

/// A machine of which nothing is known but the axes and the rate of its logs.
///
/// # Errors
/// If there is no log, or none with an axis.
pub fn unknown(name: &str, logs: &[Log]) -> Result<Machine, InputError> {
    let mut axes: IndexMap<String, Axis> = IndexMap::new();
    for axis in logs.iter().flat_map(|log| &log.axes) {
        axes.entry(axis.name.clone())
            .or_insert_with(|| Axis { settings: Settings::default(), ..Axis::default() });
    }
    let Some(log) = logs.first().filter(|_| !axes.is_empty()) else {
        return Err(InputError::expected("--log", "a log with the channels of an axis", "none".to_owned()));
    };
    Ok(Machine {
        name: name.to_owned(),
        sample_rate_hz: rounded(1.0 / log.sample_time_s),
        velocity_loop_rate_hz: None,
        instruments: None,
        axis: axes,
        structure: None,
    })
}

/// A value of a key with six significant digits in the unit in which a file with these names of keys has it.
#[must_use]
pub fn rounded_as_written(key: &'static str, value: f64, names: KeyNames) -> f64 {
    let (_, factor) = rotary::written(key, 1.0, names);
    rounded(value * factor) / factor
}

/// A value with six significant digits, more than any log determines.
#[must_use]
pub fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
