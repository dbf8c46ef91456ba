//! Compensation of known errors of the machine: corrections of the command, of the motor reading and of the force. Each has
//! the unit and the sign of the error that it cancels.
//!
//! | compensation | cancels | acts on | with a scale in the loop |
//! |---|---|---|---|
//! | [`pitch`] of the screw | pitch error of the screw over the travel | command | also on the scale's reading |
//! | screw ([`cycles`]) | periodic error of the screw, two periods | command | also on the scale's reading |
//! | [`backlash`] | backlash between screw and table | command | also on the scale's reading |
//! | stretch ([`force`]) | deflection of the drive under the force on the table | command | also on the scale's reading |
//! | [`pitch`] of the scale | pitch error of the scale over the travel | command | command alone |
//! | [`talk`] | in-talk and cross-talk: displacement of the tool by an acceleration | command | command alone |
//! | [`geometry`] | squareness and straightness | command | command alone |
//! | [`drift`] | thermal drift of the tool | command | command alone |
//! | [`products`] | displacement of the tool by products of positions, velocities, accelerations and directions | command | command alone |
//! | dividing ([`cycles`]) | periodic error of the resolver, two periods | motor reading | the same |
//! | [`reversal`] | static friction at reversal: a pulse of set shape | force | the same |
//! | [`force`] | forces of masses, friction and load, from the commanded motion | force | the same |
//! | ripple ([`cycles`]) | force ripple of the motor, two periods | force | the same |
//!
//! Corrections of the command are computed from the command, which has no noise, and added up; so are those of the force.
//! Each sum, and the correction of the reading, passes a slew-rate limiter ([`slew`]), so that nothing jumps when a
//! compensation is switched or replaced, or the axis reverses. Tables over the travel change slowly: one table of the
//! machine is evaluated with each command, in turn.
//!
//! # With a scale in the loop
//!
//! The first four cancel errors between motor and scale. A loop that uses the scale already sees these, and moves the table to
//! its command. Their sum c is therefore added to the command and to the scale's reading:
//!
//! ```text
//! position error e, for a machine without any other error, motor = command + c and table = command
//! motor:  e = command + c − motor                                         = 0
//! table:  e = command + c − (table + c)                                   = 0
//! dual:   e = command + c − (motor + low-pass(table + c − motor))         = 0 − low-pass(0) = 0
//! ```
//!
//! With the loop on the scale, c thus acts by its velocity alone, by the feed-forward; with dual feedback, above the crossover.
//! The monitor that compares motor and scale sees the readings without c. If the scale is lost, the loop continues with c on
//! the motor. When c is switched on with dual feedback, the table moves by c and returns with the time constant of the
//! feedback.

mod active;
pub mod axis;
pub mod backlash;
mod convert;
pub mod cycles;
pub mod dependence;
pub mod drift;
pub mod force;
pub mod force_settings;
pub mod friction_level;
pub mod geometry;
pub mod kind;
pub mod machine;
pub mod motion;
pub mod names;
pub mod octave_curve;
pub mod pitch;
pub mod presliding;
pub mod products;
pub mod reversal;
mod round_robin;
mod round_robin_evaluation;
pub mod settings;
pub mod slew;
pub mod speed_curves;
pub mod state;
pub mod table;
pub mod talk;

pub use axis::AxisCompensation;
pub use convert::AxisOf;
pub use dependence::Dependence;
pub use kind::CompensationKind;
pub use machine::Compensation;
pub use settings::CompensationSettings;
pub use state::Correction;
