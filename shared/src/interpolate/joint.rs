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
//! can add to the speed within a window. The feed is no such demand: a joint that may be passed at the feed with its fraction is. The blocks between k + 1 joints within a window take no more than W; in the worst
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
        let window = Window {
            ticks: rounding.window,
            ramp_gain: stretched(corner.ramp_acceleration, rounding.window) / 2,
            length: u128::from(corner.length.max(1)),
        };
        let within = |fraction: u128| {
            ((speed.min(1 << 64) * fraction) >> 32).min(corner.speed_within_tolerance(jump, fraction))
        };
        let feed = u128::from(limits.feed);
        let at_feed = window.fraction_at(feed);
        let (speed, fraction) = if feed <= within(at_feed) {
            (feed, at_feed)
        } else {
            let fraction = window.fraction_of(speed);
            (within(fraction).min(feed), fraction)
        };
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

/// The window in which the effects of joints add up, beside a block.
struct Window {
    /// W, ticks with 16 fraction bits.
    ticks: u64,
    /// What the ramps can add to the speed within it, a·W/2.
    ramp_gain: u128,
    /// L, the length of the block, position units.
    length: u128,
}

impl Window {
    /// The part of a block that is passed within the window at a speed, 32 fraction bits.
    fn per_length(&self, speed: u128) -> u128 {
        (speed.min(1 << 64) * u128::from(self.ticks) / self.length).min(1 << 60)
    }

    /// The fraction that a joint may use which is passed at a speed, 32 fraction bits and at least 1: x = L/(L + W·(v + gain)).
    fn fraction_at(&self, speed: u128) -> u128 {
        ((1 << 64) / ((1 << 32) + self.per_length(speed) + self.per_length(self.ramp_gain))).max(1)
    }

    /// The fraction that a joint may use which alone could be passed at a speed V, and is passed at x·V, 32 fraction bits and at least 1.
    ///
    /// From x = L/(L + W·(x·V + gain)), with r = W·V/L and b = 1 + W·gain/L: x = 2/(b + √(b² + 4r)).
    fn fraction_of(&self, alone: u128) -> u128 {
        let (r, b) = (self.per_length(alone), (1 << 32) + self.per_length(self.ramp_gain));
        ((2 << 64) / (b + (b * b + (r << 34)).isqrt())).max(1)
    }
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const ONE: f64 = 65_536.0;

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "below 2⁵³")]
    fn q16(value: f64) -> u64 {
        (value * ONE) as u64
    }

    /// A corner of an angle, with filters; a side may be an arc.
    struct Case {
        angle: f64,
        radius: Option<f64>,
        feed: f64,
        jerk: Option<f64>,
        tolerance: f64,
        /// Ticks: deviation, deviation by acceleration, stretch, rise, window.
        rounding: [f64; 5],
        ramp: f64,
        length: f64,
    }

    const ACCELERATION: f64 = 200.0;

    impl Case {
        /// Speed, acceleration and jerk by the equations of the module, per tick.
        fn exact(&self) -> [f64; 3] {
            let [kappa, kappa2, stretch, rise, window] = self.rounding;
            let jump = 2.0 * (self.angle / 2.0).sin();
            let within = |fraction: f64| {
                if kappa > 0.0 {
                    ((fraction * self.tolerance / jump - self.ramp * kappa2) / kappa).max(0.0)
                } else {
                    f64::INFINITY
                }
            };
            let centripetal = self.radius.map_or(0.0, f64::recip);
            let joint_jerk = self.jerk.map_or(f64::INFINITY, |jerk| jerk / 2.0);
            let speed = (ACCELERATION / 2.0 * stretch / jump)
                .min(within(1.0))
                .min(joint_jerk / 2.0 * stretch * rise / jump)
                .min((joint_jerk / 2.0 * stretch / centripetal).sqrt());
            let at_feed = self.length / (self.length + window * (self.feed + window * self.ramp / 2.0));
            let (speed, fraction) = if self.feed <= (speed * at_feed).min(within(at_feed)) {
                (self.feed, at_feed)
            } else {
                // x·(L + W·(x·v + a·W/2)) = L.
                let (r, b) =
                    (window * speed / self.length, 1.0 + window * window * self.ramp / 2.0 / self.length);
                let fraction = 2.0 / (b + (b * b + 4.0 * r).sqrt());
                ((speed * fraction).min(within(fraction)).min(self.feed), fraction)
            };
            let acceleration = speed * jump / stretch;
            let jerk = acceleration / rise + speed * speed * centripetal / stretch;
            [speed, acceleration / fraction, jerk / fraction]
        }

        fn found(&self) -> [f64; 3] {
            let one = f64::from(1 << 31).powi(2);
            #[expect(clippy::cast_possible_truncation, reason = "unit vectors and lengths")]
            let (direction, radius) = (
                |angle: f64| [(angle.cos() * one) as i64, (angle.sin() * one) as i64],
                self.radius.map(|radius| radius as i64),
            );
            let [deviation, deviation_by_acceleration, stretch, rise, window] = self.rounding.map(q16);
            let rounding = CornerRounding { deviation, deviation_by_acceleration, stretch, rise, window };
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "lengths")]
            let joint = JointLimits::plan(&Corner {
                from: &BlockEnd { direction: direction(0.3), radius: None },
                to: &BlockEnd { direction: direction(0.3 + self.angle), radius },
                limits: &Limits::new(q16(self.feed), q16(ACCELERATION), self.jerk.map(q16)),
                ramp_acceleration: q16(self.ramp),
                rounding: &rounding,
                tolerance: self.tolerance as u64,
                length: self.length as u64,
            });
            [joint.speed, joint.acceleration, joint.jerk].map(|value| value as f64 / ONE)
        }
    }

    proptest! {
        /// To 1e-3: a jump has 32 fraction bits, speeds, accelerations and jerks 16.
        #[test]
        fn a_joint_is_that_of_its_equations(
            angle in 0.02..3.0f64, radius in prop::option::of(1e6..1e9f64), feed in 1e3..1e5f64, jerk in prop::option::of(5.0..100.0f64),
            tolerance in 1e4..1e7f64, filtered: bool, stretch in 2.0..60.0f64, ramp in 1.0..200.0f64, length in 1e4..1e8f64,
        ) {
            let rounding = if filtered {
                [stretch / 8.0, stretch * stretch / 48.0, stretch, 1.0 + stretch / 4.0, 1.5 * stretch]
            } else {
                [0.0, 0.0, 1.0, 1.0, 1.0]
            };
            let case = Case { angle, radius, feed, jerk, tolerance: tolerance.trunc(), rounding, ramp, length: length.trunc() };
            let [exact, found] = [case.exact(), case.found()];
            for (name, (exact, found)) in ["speed", "acceleration", "jerk"].into_iter().zip(exact.into_iter().zip(found)) {
                prop_assert!((found - exact).abs() <= 1e-3 * exact + 0.02, "{name}: {found}, {exact}");
            }
        }
    }

    /// What a joint takes is missing to the ramps; a limit is never zero.
    #[test]
    fn ramps_have_what_the_joints_leave() {
        let joint = |acceleration, jerk| JointLimits { speed: 5, acceleration, jerk };
        let limits = Limits::new(1000, 100, Some(40));
        let ramps = limits_of_ramps(&limits, &joint(30, 7), &joint(20, 9));
        assert_eq!((ramps.feed, ramps.acceleration, ramps.jerk), (1000, 70, Some(31)));
        let ramps = limits_of_ramps(&limits, &joint(200, 7), &joint(20, 90));
        assert_eq!((ramps.acceleration, ramps.jerk), (1, Some(1)));
    }
}
