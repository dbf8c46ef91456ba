//! Speed, acceleration and jerk that a block is planned within.

/// Bisection steps for a speed: they narrow a bracket of 2⁶⁰ to one unit of 2⁻¹⁶.
const BISECTION_STEPS: u32 = 60;

/// Limits along the path, with 16 fraction bits: position units per tick, per tick² and per tick³.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Speed, at least 1.
    pub feed: u64,
    /// Acceleration, at least 1.
    pub acceleration: u64,
    /// Jerk, at least 1; `None`: the acceleration may jump.
    pub jerk: Option<u64>,
    /// Acceleration that is available for a joint.
    pub joint_acceleration: u64,
    /// Jerk that is available for a joint.
    pub joint_jerk: u64,
}

impl Limits {
    /// Limits of a line: half of the acceleration and jerk is available for joints.
    #[must_use]
    pub fn new(feed: u64, acceleration: u64, jerk: Option<u64>) -> Self {
        let joint_jerk = jerk.unwrap_or(0) / 2;
        Self { feed, acceleration, jerk, joint_acceleration: acceleration / 2, joint_jerk }
    }

    /// The limits for an arc whose end point is corrected by this fraction of its length (32 fraction bits). They are reduced
    /// by twice the fraction, since the correction may point in the direction of an acceleration.
    #[must_use]
    pub fn reduced_for_correction(self, fraction_q32: u64) -> Self {
        let reduced = |limit: u64| {
            let reduction = (u128::from(limit) * u128::from(fraction_q32)) >> 31;
            limit.saturating_sub(u64::try_from(reduction).unwrap_or(limit)).max(1)
        };
        Self {
            feed: reduced(self.feed),
            acceleration: reduced(self.acceleration),
            jerk: self.jerk.map(reduced),
            joint_acceleration: reduced(self.joint_acceleration),
            joint_jerk: reduced(self.joint_jerk),
        }
    }

    /// The limits along an arc of this radius (position units) that keep the magnitude of acceleration and jerk, with their
    /// centripetal components.
    ///
    /// A sixteenth of A is reserved for joints. Of the remainder, A*, the centripetal acceleration v²/R takes at most
    /// √¾·A*, and the path what that leaves, at least A*/2. Of the jerk J, the path takes half; v³/R² is limited to a
    /// quarter and 3va/R to a half, so that the total is at most √((½ + ¼)² + ½²)·J = 0.91·J; a sixteenth is reserved.
    #[must_use]
    pub fn on_arc(self, radius: i64) -> Self {
        let radius = u128::from(radius.unsigned_abs()).max(1);
        let joint_acceleration = self.acceleration / 16;
        let available = u128::from(self.acceleration - joint_acceleration);
        // √¾ = 0.8660
        let max_centripetal = available * 8660 / 10_000;
        let feed = u128::from(self.feed).min((max_centripetal.saturating_mul(radius) << 16).isqrt());
        let feed = self.jerk.map_or(feed, |jerk| feed_within_jerk(feed, radius, jerk)).max(1);
        let mut along = (available * available).saturating_sub(centripetal(feed, radius).pow(2)).isqrt();
        if let Some(jerk) = self.jerk {
            along = along.min(((u128::from(jerk) * radius).saturating_mul(1 << 16) / (6 * feed)).max(1));
        }
        #[expect(clippy::cast_possible_truncation, reason = "no limit is raised")]
        Self {
            feed: feed as u64,
            acceleration: along.max(1) as u64,
            jerk: self.jerk.map(|jerk| (jerk / 2).max(1)),
            joint_acceleration,
            joint_jerk: self.jerk.unwrap_or(0) / 16,
        }
    }

    /// The stricter of two limits each.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self {
            feed: self.feed.min(other.feed),
            acceleration: self.acceleration.min(other.acceleration),
            jerk: match (self.jerk, other.jerk) {
                (Some(one), Some(two)) => Some(one.min(two)),
                (one, two) => one.or(two),
            },
            joint_acceleration: self.joint_acceleration.min(other.joint_acceleration),
            joint_jerk: match (self.jerk, other.jerk) {
                (None, _) => other.joint_jerk,
                (_, None) => self.joint_jerk,
                _ => self.joint_jerk.min(other.joint_jerk),
            },
        }
    }
}

/// v²/R, with 16 fraction bits.
fn centripetal(feed: u128, radius: u128) -> u128 {
    (feed * feed / radius) >> 16
}

/// The greatest feed up to `feed` with v³/R² ≤ J/4.
fn feed_within_jerk(feed: u128, radius: u128, jerk: u64) -> u128 {
    let max = u128::from(jerk) / 4;
    let centripetal_jerk = |feed: u128| (centripetal(feed, radius) * feed / radius) >> 16;
    if centripetal_jerk(feed) <= max {
        return feed;
    }
    let (mut low, mut high) = (0, feed);
    for _ in 0..BISECTION_STEPS {
        let middle = u128::midpoint(low, high);
        if centripetal_jerk(middle) > max {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
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

    proptest! {
        /// By the documentation of [`Limits::on_arc`]: with A* = 15/16 A, v²/R ≤ √¾·A*, v³/R² ≤ J/4, a ≤ √(A*² − v⁴/R²), 3va/R ≤ J/2; and each is the
        /// greatest that is allowed, to 2e-4, the rounding of √¾ and of the small values among these.
        #[test]
        fn an_arc_has_the_greatest_feed_and_acceleration(
            feed in 4.0..6.0f64, acceleration in 2.0..4.0f64, jerk in prop::option::of(-1.0..3.0f64), radius in 7.0..11.0f64,
        ) {
            let [feed, acceleration, radius] = [feed, acceleration, radius].map(|power| 10f64.powf(power));
            let jerk = jerk.map(|power| 10f64.powf(power));
            #[expect(clippy::cast_possible_truncation, reason = "below 2⁵³")]
            let limits = Limits::new(q16(feed), q16(acceleration), jerk.map(q16)).on_arc(radius as i64);
            let available = acceleration * 15.0 / 16.0;
            let by_centripetal = (0.75f64.sqrt() * available * radius).sqrt();
            let by_jerk = jerk.map_or(f64::INFINITY, |jerk| (jerk / 4.0 * radius * radius).cbrt());
            let exact = feed.min(by_centripetal).min(by_jerk);
            let found = limits.feed as f64 / ONE;
            prop_assert!((found / exact - 1.0).abs() < 2e-4, "feed {found}, {exact}");
            let centripetal = found * found / radius;
            let exact = (available * available - centripetal * centripetal).sqrt();
            let exact = exact.min(jerk.map_or(f64::INFINITY, |jerk| jerk * radius / (6.0 * found)));
            let along = limits.acceleration as f64 / ONE;
            prop_assert!((along / exact - 1.0).abs() < 2e-4, "acceleration {along}, {exact}");
            prop_assert_eq!(limits.jerk.is_some(), jerk.is_some());
            if let (Some(found), Some(jerk)) = (limits.jerk, jerk) {
                prop_assert!((found as f64 / ONE - jerk / 2.0).abs() < 1e-4);
                prop_assert!((limits.joint_jerk as f64 / ONE - jerk / 16.0).abs() < 1e-4);
            }
            prop_assert!((limits.joint_acceleration as f64 / ONE - acceleration / 16.0).abs() < 1e-4);
        }
    }

    /// Of a block with a limit of the jerk and one without, the joint has that of the first.
    #[test]
    fn the_jerk_of_a_joint_is_that_of_the_block_that_has_a_limit() {
        let (with, without) = (Limits::new(100, 50, Some(20)), Limits::new(90, 60, None));
        for joint in [with.intersection(&without), without.intersection(&with)] {
            assert_eq!(
                (joint.feed, joint.acceleration, joint.jerk, joint.joint_jerk),
                (90, 50, Some(20), 10)
            );
        }
        let joint = with.intersection(&Limits::new(100, 50, Some(8)));
        assert_eq!((joint.jerk, joint.joint_jerk), (Some(8), 4));
    }
}
