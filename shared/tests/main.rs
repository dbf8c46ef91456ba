//! Interaction of the parts of the controller: see `docs/testing.md`. The equations of a control law are tested in its own file.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod ahead;
mod amplifier;
mod compensation;
mod config;
mod control;
mod direction_check;
mod dual_feedback;
mod enabling;
mod figures;
mod gain_change;
mod gain_schedule;
mod gantry;
mod homing;
mod inputs;
mod link;
mod lockstep;
mod machine;
mod monitor;
mod notches;
mod observer;
mod path;
mod safety;
mod slide;
mod velocity_loop;
mod vertical;
