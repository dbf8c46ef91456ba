//! Joints: how fast a path may pass from one block to the next, and the acceleration and jerk that this takes.
//!
//! At a joint the direction of travel jumps by u = |t₂ − t₁|, so at speed v the velocity jumps by v·u. Without filters,
//! one tick takes it as an acceleration; the filters of the axes stretch it over T ticks, with a rise time T', and
//! cut the corner by κ ticks of the velocity step plus κ₂ ticks² of the acceleration a of the adjacent ramps
//! ([`super::smooth::CornerRounding`]):
//!
//! ```text
//! v·u ≤ A'·T,   u·(v·κ + a·κ₂) ≤ tolerance,   and with a jerk limit   v·u ≤ ½J'·T·T',   v²·(1/R₁ + 1/R₂) ≤ ½J'·T
//! ```
//!
//! The last condition is for the centripetal acceleration, which jumps where the curvature does. A' and J' are the parts
//! of the limits that the blocks reserve for their joints; what a joint uses is subtracted from the limits of their
//! ramps ([`limits_of_ramps`]). So without filters a path passes a smooth joint at speed and nearly stops at a corner.
//!
//! The demands of joints that follow each other within the window W of the filters (or within one tick) add up. A joint
//! next to a block of length L, passed at v, may use the fraction x = L/(L + W·(v + a·W/2)), where a·W/2 is what the ramps
//! can add to the speed within a window. The blocks between k + 1 joints within a window take no more than W; in the worst
//! case, evenly spaced, these fractions are 1/(k + 1) each.

use super::limits::Limits;
use super::smooth::CornerRounding;

/// An end of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlockEnd<const N: usize> {
    /// Unit vector of the direction of travel, 62 fraction bits.
    pub direction: [i64; N],
    /// Radius of an arc, position units; `None` for a line.
    pub radius: Option<i64>,
}

/// A joint between two blocks, and what limits the speed there.
#[derive(Clone, Copy, Debug)]
pub struct Corner<'a, const N: usize> {
    /// End of the first block.
    pub from: &'a BlockEnd<N>,
    /// Start of the second block.
    pub to: &'a BlockEnd<N>,
    /// Limits that hold for both blocks.
    pub limits: &'a Limits,
    /// Acceleration of the adjacent ramps, per tick² with 16 fraction bits.
    pub ramp_acceleration: u64,
    /// Effect of the axis filters on a corner.
    pub rounding: &'a CornerRounding,
    /// Greatest distance of the command from the corner, position units.
    pub tolerance: u64,
    /// Length of the shorter block, position units.
    pub length: u64,
}

/// Speed at a joint, and what it takes of the limits of its blocks: per tick, with 16 fraction bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct JointLimits {
    /// Greatest speed; 0: stop.
    pub speed: u64,
    /// Acceleration that the joint takes.
    pub acceleration: u64,
    /// Jerk that the joint takes.
    pub jerk: u64,
}

impl JointLimits {
    /// The greatest speed at a corner, and what it takes.
    #[must_use]
    pub fn plan<const N: usize>(corner: &Corner<'_, N>) -> Self {
        let &Corner { from, to, limits, rounding, .. } = corner;
        // u with 32 fraction bits.
        let jump = jump(from, to);
        let over_jump = |velocity: u128| (velocity << 32) / jump;
        let mut speed = over_jump(stretched(limits.joint_acceleration, rounding.stretch));
        speed = speed.min(corner.speed_within_tolerance(jump, 1 << 32));
        let curvature_jumps = from.radius != to.radius;
        let radii = || [from.radius, to.radius].into_iter().flatten().filter(|_| curvature_jumps);
        if limits.jerk.is_some() {
            let acceleration = stretched(limits.joint_jerk, rounding.stretch) / 2;
            speed = speed.min(over_jump((acceleration * u128::from(rounding.rise)) >> 16));
            for radius in radii() {
                // Half for each side: v² ≤ ½J'·T·R/2.
                let squared = acceleration.saturating_mul(u128::from(radius.unsigned_abs())) << 15;
                speed = speed.min(squared.isqrt());
            }
        }
        let speed = speed.min(u128::from(limits.feed));
        let ramp_gain = stretched(corner.ramp_acceleration, rounding.window) / 2;
        let fraction = window_fraction(speed, ramp_gain, rounding.window, corner.length);
        let speed = ((speed * fraction) >> 32).min(corner.speed_within_tolerance(jump, fraction));
        let acceleration = (((speed * jump) >> 32) << 16).div_ceil(u128::from(rounding.stretch.max(1)));
        let mut jerk = (acceleration << 16).div_ceil(u128::from(rounding.rise.max(1)));
        for radius in radii() {
            let centripetal = speed * speed / u128::from(radius.unsigned_abs()).max(1);
            jerk += centripetal.div_ceil(u128::from(rounding.stretch.max(1)));
        }
        let narrow = |value: u128| u64::try_from(value).unwrap_or(u64::MAX);
        // The neighbouring joints within the window take as much.
        let in_window = |own: u128| narrow((own << 32).div_ceil(fraction));
        Self { speed: narrow(speed), acceleration: in_window(acceleration), jerk: in_window(jerk) }
    }
}

impl<const N: usize> Corner<'_, N> {
    /// The greatest speed that stays within a fraction (32 fraction bits) of the tolerance: v = (x·tolerance/u − a·κ₂)/κ.
    fn speed_within_tolerance(&self, jump: u128, fraction: u128) -> u128 {
        if self.rounding.deviation == 0 {
            return u128::MAX;
        }
        let by_ramps = stretched(self.ramp_acceleration, self.rounding.deviation_by_acceleration);
        let velocity = ((u128::from(self.tolerance) << 16 << 32) / jump).min(u128::MAX >> 40);
        (((velocity * fraction) >> 32).saturating_sub(by_ramps) << 16) / u128::from(self.rounding.deviation)
    }
}

/// The limits of a block minus what the joints at its two ends take: the limits of its ramps.
#[must_use]
pub fn limits_of_ramps(limits: &Limits, entry: &JointLimits, exit: &JointLimits) -> Limits {
    let remaining = |limit: u64, one: u64, other: u64| limit.saturating_sub(one.max(other)).max(1);
    Limits {
        acceleration: remaining(limits.acceleration, entry.acceleration, exit.acceleration),
        jerk: limits.jerk.map(|jerk| remaining(jerk, entry.jerk, exit.jerk)),
        ..*limits
    }
}

/// A limit times a number of ticks with 16 fraction bits.
fn stretched(limit: u64, ticks_q16: u64) -> u128 {
    (u128::from(limit) * u128::from(ticks_q16)) >> 16
}

/// The fraction of a window, 32 fraction bits and at least 1, that a joint may use which alone could be passed at `speed`.
///
/// From x = L/(L + W·(x·speed + gain)), with r = W·speed/L and b = 1 + W·gain/L: x = 2/(b + √(b² + 4r)).
fn window_fraction(speed: u128, gain: u128, window: u64, length: u64) -> u128 {
    let length = u128::from(length.max(1));
    let per_length = |speed: u128| (speed.min(1 << 64) * u128::from(window) / length).min(1 << 60);
    let (r, b) = (per_length(speed), (1 << 32) + per_length(gain));
    ((2 << 64) / (b + (b * b + (r << 34)).isqrt())).max(1)
}

/// u = |t₂ − t₁| with 32 fraction bits, rounded up.
fn jump<const N: usize>(from: &BlockEnd<N>, to: &BlockEnd<N>) -> u128 {
    let squares = from.direction.iter().zip(&to.direction).map(|(&a, &b)| {
        // The magnitude of each is at most 2, with 62 fraction bits.
        let difference = (i128::from(b) - i128::from(a)).unsigned_abs() >> 16;
        difference * difference
    });
    (squares.sum::<u128>().isqrt() >> 14) + 1
}
