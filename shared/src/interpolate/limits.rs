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
