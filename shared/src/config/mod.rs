//! Settings in SI, checked and converted to machine units.
//!
//! | module | holds |
//! |---|---|
//! | [`settings`] | what a person or a file declares for an axis, in SI |
//! | [`axis`] | the same in machine units: what a tick computes with |
//! | [`gantry`] | two motors with one command |
//! | [`envelope`] | the ceilings of the settings of an axis on a board |
//! | [`error`] | why a setting was rejected, with its name and range |
//!
//! Every setting is checked here and nowhere else; after that, a tick cannot fail.
//!
//! # Example
//!
//! ```
//! use shared::config::{AxisConfig, AxisSettings, ConfigError, Rates};
//! use shared::scalar::Fixed;
//!
//! let rates = Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 };
//! let settings = AxisSettings { position_gain_per_s: -1.0, ..AxisSettings::default() };
//! let error = AxisConfig::<Fixed>::new(&settings, rates).unwrap_err();
//! assert_eq!(error, ConfigError::NotPositive("position_gain_per_s"));
//! ```

pub mod axis;
pub(crate) mod check;
pub mod envelope;
pub mod error;
pub mod gantry;
pub mod gantry_settings;
mod schedule;
pub mod settings;

pub use axis::{AxisConfig, BrakeTicks, UNLIMITED};
pub use envelope::AxisEnvelope;
pub use error::ConfigError;
pub use gantry::GantryConfig;
pub use gantry_settings::GantrySettings;
pub use settings::{
    AxisSettings, Brake, GainSchedule, Law, LowPass, NOTCHES, Notch, Notches, Rates, SCHEDULE_POINTS,
    ScaleLimits, SchedulePoint, ScheduledOver, Sensors, VelocitySource,
};
