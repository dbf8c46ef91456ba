//! Prediction of each stage by a model, driven by the measured signal upstream of the stage.
//!
//! [`driven`] predicts table and force from the measured motor, [`closed_loop`] the motor from the command, and [`tool`]
//! the tool point from the measured tables. [`velocity_drive`] predicts a motor whose velocity is commanded.
//! [`force_windup`] replaces the mechanics if no masses are declared. [`plant::friction_direction`] is that of a friction that yields.

pub mod closed_loop;
pub mod controller_readings;
pub mod driven;
pub mod force_sampling;
pub mod force_windup;
pub mod initial_state;
pub mod law_terms;
pub mod position_loop;
pub mod resonant_response;
pub mod table_motion;
pub mod table_variable;
pub mod tool;
pub mod velocity_drive;
