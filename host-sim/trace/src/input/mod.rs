//! Admission of logs, and preparation of their signals.
//!
//! [`admission`] applies [`sampling_rate`], [`checks`], [`copies`], [`missing_channels`] and [`saturation`] to the logs. [`parts`] divides
//! them into what is fitted and what is held out. [`signals`] prepares them with [`smoothing`], [`quiet_acceleration`],
//! [`motor_path`] and [`added_force`].

pub mod added_force;
pub mod admission;
pub mod checks;
pub mod copies;
pub mod encoder_step;
pub mod missing_channels;
pub mod motor_path;
pub mod parts;
pub mod quiet_acceleration;
pub mod sampling_rate;
pub mod saturation;
pub mod signals;
pub mod smoothing;
pub mod table_motions;
