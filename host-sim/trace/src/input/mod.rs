//! Admission of logs, and preparation of their signals.
//!
//! [`admission`] applies [`sampling_rate`], [`checks`], [`copies`], [`saturation`] and [`length`] to the logs. [`signals`]
//! prepares the admitted logs with [`smoothing`], [`motor_path`] and [`added_force`].

pub mod added_force;
pub mod admission;
pub mod checks;
pub mod copies;
pub mod length;
pub mod motor_path;
pub mod sampling_rate;
pub mod saturation;
pub mod signals;
pub mod smoothing;
