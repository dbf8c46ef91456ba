//! The simulated machine, and the closed loop of a controller with it.
//!
//! In the order of the signal:
//!
//! | | |
//! |---|---|
//! | [`controller`] | the interface of a controller to the closed loop, and the controller in this process |
//! | [`machine_path`] | the motion file as blocks in the axes of the machine |
//! | [`simulate`] | the closed loop: the controller of a machine file, a run along a path, its log |
//! | [`equivalent`] | machines of which masses or loops are not known, as machines that can be simulated |
//! | [`machine_sim`] | the machine in one tick: commanded forces in, readings and measurements out |
//! | [`instruments`] | lag of the drives, sensors and their latencies, the same for all axes |
//! | [`parameters`] | the physical parameters of an axis: keys and effects of the machine file, in SI; the longest step that they allow |
//! | [`mechanics`] | one step of an axis from its drive to its table: motor, screw, guide |
//! | [`transition`] | its linear part: masses, spring, viscous friction and drive lag, exact |
//! | [`following`] | instead of a motor with masses: one that follows its command |
//! | [`screw`] | pitch errors, backlash and elasticity between motor and table |
//! | [`scale`] | errors of the linear scale |
//! | [`guide`], [`load`] | force of the guideway over a step: implicit friction, load |
//! | [`friction`], [`presliding`], [`friction_direction`] | the friction laws |
//! | [`axis_motion`] | the state of an axis: positions, velocities, bristles |
//! | [`coupled_axes`], [`multibody`] | instead of `mechanics` where the machine file describes rigid bodies |
//! | [`tool_point`], [`tool_parameters`] | from table to tool: offsets by acceleration, position and time; modes; alignment of the probe |
//! | [`residuals`] | residuals that no effect describes |
//! | [`delay`], [`sensors`] | latency, noise and quantisation of the readings and of the log |
//! | [`lane`] | arithmetic for one axis, or for two in one SIMD register |
//!
//! The tracer (the crate `trace`) uses the same parts with measured signals: [`driven`] is the table behind a measured
//! motor. Laws that plant and tracer both need are defined here once: [`friction::smoothed_sign`],
//! [`presliding::Bristles`], [`screw::Screw`], and the force ripple and resolver errors of
//! [`parameters::AxisParameters`].

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod axis_motion;
pub mod controller;
pub mod coupled_axes;
pub mod delay;
pub mod driven;
pub mod equivalent;
pub mod following;
pub mod friction;
pub mod friction_direction;
pub mod guide;
pub mod guide_temperature;
pub mod instruments;
pub mod lane;
pub mod load;
pub mod machine_path;
pub mod machine_sim;
pub mod mechanics;
pub mod multibody;
pub mod parameters;
pub mod presliding;
pub mod probe;
pub mod residuals;
pub mod scale;
pub mod screw;
pub mod sensors;
pub mod simulate;
mod step_limit;
pub mod stepper;
pub mod tool_parameters;
pub mod tool_point;
pub mod transition;
