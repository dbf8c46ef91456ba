//! Latencies: of readings on their way to the controller, and of logged channels.

use std::collections::VecDeque;

/// A constant latency of a position that is read once per tick.
#[derive(Clone, Debug)]
pub struct Delay {
    /// Positions (m) and velocities (m/s) of the last ticks, the newest first, up to the tick that the reading lies in.
    past: VecDeque<(f64, f64)>,
    whole_ticks: usize,
    /// The rest of the latency, as a fraction of a tick.
    fraction: f64,
    tick_s: f64,
}

impl Delay {
    /// A latency (s) of a position that has been constant at `start_m`; `None` if there is no latency.
    #[must_use]
    pub fn new(delay_s: f64, tick_s: f64, start_m: f64) -> Option<Self> {
        if delay_s <= 0.0 {
            return None;
        }
        let ticks = delay_s / tick_s;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "not negative, and saturates"
        )]
        let whole_ticks = ticks.floor() as usize;
        Some(Self {
            past: VecDeque::from(vec![(start_m, 0.0); whole_ticks + 2]),
            whole_ticks,
            fraction: ticks.fract(),
            tick_s,
        })
    }

    /// The delayed position, m, at the tick with this position (m) and velocity (m/s). To be called once per tick.
    ///
    /// Between two ticks it is the cubic Hermite polynomial of their positions and velocities, exact for a constant
    /// acceleration.
    pub fn read(&mut self, position_m: f64, velocity: f64) -> f64 {
        self.past.rotate_right(1);
        self.past[0] = (position_m, velocity);
        let (newer, older) = (self.past[self.whole_ticks], self.past[self.whole_ticks + 1]);
        let (t, h) = (self.fraction, self.tick_s);
        let travel_m = older.0 - newer.0;
        newer.0 + travel_m * t * t * (3.0 - 2.0 * t) - h * newer.1 * t * (1.0 - t) * (1.0 - t)
            + h * older.1 * t * t * (1.0 - t)
    }
}

/// Latency of a logged position (the effect `latency`). A negative one extrapolates by velocity and acceleration.
#[derive(Clone, Debug)]
pub struct LogDelay {
    delay: Option<Delay>,
    early_s: f64,
}

impl LogDelay {
    /// A latency (s) of a position that has been constant at `start_m` and is logged once per sample.
    #[must_use]
    pub fn new(latency_s: f64, sample_s: f64, start_m: f64) -> Self {
        Self { delay: Delay::new(latency_s, sample_s, start_m), early_s: (-latency_s).max(0.0) }
    }

    /// Error of the logged position, m: true position − logged one, at a sample with this position (m), velocity (m/s)
    /// and acceleration (m/s²). To be called once per sample.
    pub fn lag_m(&mut self, position_m: f64, velocity: f64, acceleration: f64) -> f64 {
        match &mut self.delay {
            Some(delay) => position_m - delay.read(position_m, velocity),
            None => -self.early_s * (velocity + 0.5 * self.early_s * acceleration),
        }
    }
}

/// Latency of the logged force (the effect `latency`): linear interpolation between the forces of two ticks. A negative
/// latency is at most one tick, whose force the controller already knows.
#[derive(Clone, Debug)]
pub struct ForceDelay {
    /// Forces of the last ticks, N, the newest first.
    past_n: VecDeque<f64>,
    ticks: f64,
}

impl ForceDelay {
    /// A latency (s) of a force that has been 0; `None` if there is no latency.
    #[must_use]
    pub fn new(latency_s: f64, tick_s: f64) -> Option<Self> {
        let ticks = (latency_s / tick_s).max(-1.0);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "not negative, and saturates"
        )]
        let kept = ticks.max(0.0).floor() as usize + 2;
        (latency_s != 0.0).then(|| Self { past_n: VecDeque::from(vec![0.0; kept]), ticks })
    }

    /// Appends the force of a tick, N. To be called once per tick.
    pub fn push(&mut self, force_n: f64) {
        self.past_n.rotate_right(1);
        self.past_n[0] = force_n;
    }

    /// The logged force, N, before a tick with the force `next_n`.
    #[must_use]
    pub fn logged_n(&self, next_n: f64) -> f64 {
        let whole = self.ticks.floor();
        let fraction = self.ticks - whole;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "from 0 to the last that is kept"
        )]
        let at = |age: f64| if age < 0.0 { next_n } else { self.past_n[age as usize] };
        (1.0 - fraction) * at(whole) + fraction * at(whole + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x = 2 + 3t + 2t²: the reading is x(t − τ), for whole ticks and for fractions of them.
    #[test]
    fn a_reading_is_the_position_one_latency_ago() {
        let (tick_s, at) = (1e-3, |t: f64| 2.0 + 3.0 * t + 2.0 * t * t);
        for delay_s in [0.2e-3, 1e-3, 3.7e-3, 20e-3] {
            let mut delay = Delay::new(delay_s, tick_s, 2.0).unwrap();
            for tick in 0..100 {
                let t = f64::from(tick) * tick_s;
                let read = delay.read(at(t), 3.0 + 4.0 * t);
                if t > delay_s + tick_s {
                    assert!((read - at(t - delay_s)).abs() < 1e-12, "{delay_s} at {t}: {read}");
                }
            }
        }
    }

    /// A force that grows by 1 N a tick of 1 ms, logged between the ticks of 10 N and 11 N.
    #[test]
    fn a_logged_force_has_its_latency() {
        for (latency_s, expected_n) in
            [(-1e-3, 11.0), (-0.25e-3, 10.25), (0.5e-3, 9.5), (3e-3, 7.0), (-5e-3, 11.0)]
        {
            let mut delay = ForceDelay::new(latency_s, 1e-3).unwrap();
            (1..=10).for_each(|n| delay.push(f64::from(n)));
            assert!(
                (delay.logged_n(11.0) - expected_n).abs() < 1e-12,
                "{latency_s}: {}",
                delay.logged_n(11.0)
            );
        }
        assert!(ForceDelay::new(0.0, 1e-3).is_none());
    }

    #[test]
    fn a_constant_position_is_read_unchanged() {
        let mut delay = Delay::new(2.5e-3, 1e-3, 7.0).unwrap();
        assert!((0..10).all(|_| (delay.read(7.0, 0.0) - 7.0).abs() < 1e-15));
    }
}
