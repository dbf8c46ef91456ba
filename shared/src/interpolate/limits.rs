//! Speed, acceleration and jerk that a block is planned within.

/// Bisection steps for a speed: they narrow a bracket of 2⁶⁰ to one unit of 2⁻¹⁶.
const BISECTION_STEPS: u32 = 60;

/// What a block must keep to, per tick, with 16 fraction bits: position units, per tick, per tick².
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Speed along the path, at least 1.
    pub feed: u64,
    /// Acceleration along the path, at least 1.
    pub acceleration: u64,
    /// Jerk along the path, at least 1; `None`: the acceleration may jump.
    pub jerk: Option<u64>,
    /// Acceleration that a joint may take.
    pub spare_acceleration: u64,
    /// Jerk that a joint may take.
    pub spare_jerk: u64,
}

impl Limits {
    /// Limits of which a joint may take half.
    #[must_use]
    pub fn new(feed: u64, acceleration: u64, jerk: Option<u64>) -> Self {
        let spare_jerk = jerk.unwrap_or(0) / 2;
        Self { feed, acceleration, jerk, spare_acceleration: acceleration / 2, spare_jerk }
    }

    /// The same for a path that is drawn aside by this share of its length (32 fraction bits): less by twice that, as
    /// what is aside may point where an acceleration does.
    #[must_use]
    pub fn less(self, aside: u64) -> Self {
        let less = |limit: u64| {
            let part = (u128::from(limit) * u128::from(aside)) >> 31;
            limit.saturating_sub(u64::try_from(part).unwrap_or(limit)).max(1)
        };
        Self {
            feed: less(self.feed),
            acceleration: less(self.acceleration),
            jerk: self.jerk.map(less),
            spare_acceleration: less(self.spare_acceleration),
            spare_jerk: less(self.spare_jerk),
        }
    }

    /// What keeps the whole acceleration and jerk on an arc, with the part towards the centre.
    ///
    /// A sixteenth of A is spared for the joints. Of the rest, A*, towards the centre goes v²/R, at most
    /// √¾·A*; along the path what that leaves, at least A*/2. Of the jerk, half goes along the path; v³/R² is
    /// kept to a quarter, and 3va/R to a half of it, so that all three together stay below
    /// √((½ + ¼)² + ½²)·J = 0.91·J, and a sixteenth is spared.
    #[must_use]
    pub fn on_radius(self, radius: i64) -> Self {
        let radius = u128::from(radius.unsigned_abs()).max(1);
        let spare_acceleration = self.acceleration / 16;
        let greatest = u128::from(self.acceleration - spare_acceleration);
        // √¾ = 0.8660
        let centripetal = greatest * 8660 / 10_000;
        let mut feed = u128::from(self.feed).min((centripetal.saturating_mul(radius) << 16).isqrt());
        let towards_centre = |feed: u128| (feed * feed / radius) >> 16;
        if let Some(jerk) = self.jerk {
            let most = u128::from(jerk) / 4;
            let turning = |feed: u128| (towards_centre(feed) * feed / radius) >> 16;
            if turning(feed) > most {
                let (mut low, mut high) = (0, feed);
                for _ in 0..BISECTION_STEPS {
                    let middle = u128::midpoint(low, high);
                    if turning(middle) > most {
                        high = middle;
                    } else {
                        low = middle;
                    }
                }
                feed = low;
            }
        }
        let feed = feed.max(1);
        let mut along = (greatest * greatest).saturating_sub(towards_centre(feed).pow(2)).isqrt();
        if let Some(jerk) = self.jerk {
            along = along.min(((u128::from(jerk) * radius).saturating_mul(1 << 16) / (6 * feed)).max(1));
        }
        #[expect(clippy::cast_possible_truncation, reason = "none is more than it was")]
        Self {
            feed: feed as u64,
            acceleration: along.max(1) as u64,
            jerk: self.jerk.map(|jerk| (jerk / 2).max(1)),
            spare_acceleration,
            spare_jerk: self.jerk.unwrap_or(0) / 16,
        }
    }

    /// What keeps the limits of both.
    #[must_use]
    pub fn both(&self, other: &Self) -> Self {
        Self {
            feed: self.feed.min(other.feed),
            acceleration: self.acceleration.min(other.acceleration),
            jerk: match (self.jerk, other.jerk) {
                (Some(one), Some(two)) => Some(one.min(two)),
                (one, two) => one.or(two),
            },
            spare_acceleration: self.spare_acceleration.min(other.spare_acceleration),
            spare_jerk: match (self.jerk, other.jerk) {
                (None, _) => other.spare_jerk,
                (_, None) => self.spare_jerk,
                _ => self.spare_jerk.min(other.spare_jerk),
            },
        }
    }
}
