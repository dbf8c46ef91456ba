//! The signals of logs, and the parts of logs that are fitted and held out.
//!
//! [`parts`] divides logs into what is fitted and what is held out. [`signals`] prepares them with [`smoothing`],
//! [`quiet_acceleration`], [`motor_path`] and [`added_force`]; [`saturation`] marks forces at their limit. [`motion_range`]: how far and
//! how fast an axis moves.

pub mod added_force;
pub mod encoder_step;
pub mod motion_range;
pub mod motor_path;
pub mod parts;
pub mod quiet_acceleration;
pub mod saturation;
pub mod signals;
pub mod smoothing;
pub mod table_motions;
pub mod temperature;
