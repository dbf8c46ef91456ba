//! How fast a path may pass from one block to the next, and what that takes of its limits.
//!
//! At a joint the direction of travel jumps by u = |t₂ − t₁|, so at speed v the velocity jumps by v·u. One
//! tick takes it as an acceleration, or the filters of the axes stretch it over T ticks and round the
//! corner by κ ticks of it, and by κ₂ ticks² of the acceleration a of the ramps beside it
//! ([`super::smooth::Rounding`]):
//!
//! ```text
//! v·u ≤ A'·T,   u·(v·κ + a·κ₂) ≤ tolerance,   and with a jerk limit   v·u ≤ ½J'·T·T',   v²·(1/R₁ + 1/R₂) ≤ ½J'·T,
//! ```
//!
//! the last one for the acceleration towards the centre, which jumps where the curvature does. A' and J'
//! are what the blocks spare for their joints; what a joint takes of it their ramps do without. So without
//! filters a path passes at speed where it is smooth and all but stops where it has a corner.
//!
//! Joints that follow each other within the window W of the filters (or within one tick) add up. One beside a block
//! of length L, passed at v, has the share x = L/(L + W·(v + a·W/2)) of all that to itself: a·W/2 is what the ramps
//! can gain within a window. Of k + 1 joints within a window the blocks between them take no more than W, and at the
//! worst, evenly spread, these shares are 1/(k + 1) each.

use super::limits::Limits;
use super::smooth::Rounding;

/// An end of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct End<const N: usize> {
    /// Direction of travel, 62 fraction bits.
    pub direction: [i64; N],
    /// Radius of an arc, position units.
    pub radius: Option<i64>,
}

/// A joint, per tick with 16 fraction bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Joint {
    /// Greatest speed; 0: stop.
    pub speed: u64,
    /// Acceleration and jerk that it takes.
    pub acceleration: u64,
    /// See there.
    pub jerk: u64,
}

impl Joint {
    /// The joint between two blocks whose limits are `limits` both.
    ///
    /// `tolerance` is in position units, and so is the `length` of the shorter one; `ramps` is the acceleration of the
    /// ramps beside it.
    #[must_use]
    pub fn between<const N: usize>(
        from: &End<N>,
        to: &End<N>,
        limits: &Limits,
        ramps: u64,
        rounding: &Rounding,
        tolerance: u64,
        length: u64,
    ) -> Self {
        // u with 32 fraction bits.
        let jump = jump(from, to);
        let over_jump = |velocity: u128| (velocity << 32) / jump;
        let stretched = |limit: u64, ticks: u64| (u128::from(limit) * u128::from(ticks)) >> 16;
        let mut speed = over_jump(stretched(limits.spare_acceleration, rounding.stretch));
        let rounded = |own: u128| {
            if rounding.deviation == 0 {
                return u128::MAX;
            }
            let by_ramps = stretched(ramps, rounding.deviation_by_acceleration);
            let velocity = over_jump(u128::from(tolerance) << 16).min(u128::MAX >> 40);
            (((velocity * own) >> 32).saturating_sub(by_ramps) << 16) / u128::from(rounding.deviation)
        };
        speed = speed.min(rounded(1 << 32));
        let curvature_jumps = from.radius != to.radius;
        let radii = || [from.radius, to.radius].into_iter().flatten().filter(|_| curvature_jumps);
        if limits.jerk.is_some() {
            let acceleration = stretched(limits.spare_jerk, rounding.stretch) / 2;
            speed = speed.min(over_jump((acceleration * u128::from(rounding.rise)) >> 16));
            for radius in radii() {
                // Half of it for each side: v² ≤ ½J'·T·R/2.
                let squared = acceleration.saturating_mul(u128::from(radius.unsigned_abs())) << 15;
                speed = speed.min(squared.isqrt());
            }
        }
        let speed = speed.min(u128::from(limits.feed));
        let own = share(speed, stretched(ramps, rounding.window) / 2, rounding.window, length);
        let speed = ((speed * own) >> 32).min(rounded(own));
        let acceleration = (((speed * jump) >> 32) << 16).div_ceil(u128::from(rounding.stretch.max(1)));
        let mut jerk = (acceleration << 16).div_ceil(u128::from(rounding.rise.max(1)));
        for radius in radii() {
            let centripetal = speed * speed / u128::from(radius.unsigned_abs()).max(1);
            jerk += centripetal.div_ceil(u128::from(rounding.stretch.max(1)));
        }
        let narrow = |value: u128| u64::try_from(value).unwrap_or(u64::MAX);
        // Its neighbours within the window take as much.
        let all = |this: u128| narrow((this << 32).div_ceil(own));
        Self { speed: narrow(speed), acceleration: all(acceleration), jerk: all(jerk) }
    }
}

/// The limits of a block without what the joints at its two ends take: what its ramps may use.
#[must_use]
pub fn limits_of_ramps(limits: &Limits, entry: &Joint, exit: &Joint) -> Limits {
    let remaining = |limit: u64, one: u64, other: u64| limit.saturating_sub(one.max(other)).max(1);
    Limits {
        acceleration: remaining(limits.acceleration, entry.acceleration, exit.acceleration),
        jerk: limits.jerk.map(|jerk| remaining(jerk, entry.jerk, exit.jerk)),
        ..*limits
    }
}

/// The share of a window that a joint has to itself where alone it could be passed at `speed`, 32 fraction bits,
/// at least 1.
///
/// x = L/(L + W·(x·speed + gain)): with r = W·speed/L and b = 1 + W·gain/L, x = 2/(b + √(b² + 4r)).
fn share(speed: u128, gain: u128, window: u64, length: u64) -> u128 {
    let length = u128::from(length.max(1));
    let per_length = |speed: u128| (speed.min(1 << 64) * u128::from(window) / length).min(1 << 60);
    let (r, b) = (per_length(speed), (1 << 32) + per_length(gain));
    ((2 << 64) / (b + (b * b + (r << 34)).isqrt())).max(1)
}

/// |t₂ − t₁| with 32 fraction bits, rounded up.
fn jump<const N: usize>(from: &End<N>, to: &End<N>) -> u128 {
    let squares = from.direction.iter().zip(&to.direction).map(|(&a, &b)| {
        // Each at most 2 with 62 fraction bits.
        let difference = (i128::from(b) - i128::from(a)).unsigned_abs() >> 16;
        difference * difference
    });
    (squares.sum::<u128>().isqrt() >> 14) + 1
}
