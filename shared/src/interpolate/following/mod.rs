//! An axis follows an external counter: electronic gearing from the encoder of a master.
//!
//! ```text
//! setpoint  s = command at engagement + (counts since then)·distance/counts      exact, rounded down to a position unit
//! observer  e = s − (ŝ + v̂),   ŝ ← ŝ + v̂ + (2α − α²)·e,   v̂ ← v̂ + α²·e          α = ω/f, both poles at 1 − α
//! command   v → v̂ + β·(ŝ − p − v̂),   p ← p + v                                   β = 1/(τ·f)
//! ```
//!
//! f is the rate of the position ticks, ω = [`TRACKING_PER_S`], 1/τ = [`CATCH_UP_PER_S`]. A single count changes the velocity of the command by
//! (α² + β·(2α − α²))·f of its distance, 0.0054·f at 4 kHz where the setpoint itself changes it by f: the feed-forward of the axis has no kick. At
//! a constant speed of the counter the command is at the setpoint.
//!
//! | what | how |
//! |---|---|
//! | ratio | [`gear::Gear`]: a rational number; the remainder is kept, so that the setpoint does not drift however long the counter turns |
//! | engagement | the axis stands, and its command is the setpoint of the count of that tick: nothing jumps, also if the counter turns already |
//! | limits | speed and acceleration of the order. What is lost by them is caught up, with at most a·τ/2 more speed than that of the counter; a counter that stops faster than the axis can is overshot by v²/(2a), and the axis returns |
//! | lag | beyond the distance of the order between setpoint and command the axis stops with a fault ([`FaultKind::GearLag`](crate::safety::FaultKind::GearLag)): the counter is faster than the axis may be |
//! | travel | an axis that could no longer stop within its travel if it went on stops before its end with a fault ([`FaultKind::SoftLimit`](crate::safety::FaultKind::SoftLimit)) |
//! | hold, stop, silence of the host, faults that stop | the axis decelerates with the declared deceleration, and no longer follows: a hold cannot be resumed, since the counter has gone on meanwhile |
//!
//! Others do the same: LinuxCNC's `limit3` follows a position within limits of speed and acceleration and catches up; Beckhoff's
//! `E_GearInMultiMasterSyncMode` has `POSSYNC1`, by which a position difference of a dynamic limitation is caught up later; SEW's `MC_GearIn` has
//! `CatchUp`. The `MC_GearIn` of `PLCopen`, without it, loses what the limits take: a counter of steps would then no longer tell the position. Unlike
//! these, whose lag has no bound of its own, the axis stops when the lag is beyond a declared distance.
//!
//! A counter whose wire breaks stands; nothing here can tell it from a master that stands.

pub mod follower;
pub mod gear;
mod settings;

pub use follower::Ending;
pub use settings::{FollowError, FollowSettings};

/// Bandwidth ω of the observer of the setpoint, rad/s.
pub const TRACKING_PER_S: f64 = 250.0;

/// Rate at which the command approaches the setpoint, 1/τ, per second.
pub const CATCH_UP_PER_S: f64 = 50.0;
