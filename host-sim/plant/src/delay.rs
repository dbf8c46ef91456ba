//! A reading that is on its way for a time: what a sensor's electronics make of a position that moves.

use std::collections::VecDeque;

/// Positions and velocities of the last ticks, and how long a reading takes.
#[derive(Clone, Debug)]
pub struct Delay {
    /// The newest first; one more than the reading is ticks old, for the tick that it lies in.
    past: VecDeque<(f64, f64)>,
    whole_ticks: usize,
    /// Of a tick, beyond the whole ones.
    part: f64,
    tick_s: f64,
}

impl Delay {
    /// Of something that has stood at `start_m` for long, read once a tick; `None` where it takes no time.
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
            part: ticks.fract(),
            tick_s,
        })
    }

    /// What a reading of this tick says, m, of what is at `place_m` and moves with a velocity (m/s).
    ///
    /// Between two ticks it is the cubic of their positions and velocities, which an even acceleration follows exactly.
    pub fn read(&mut self, place_m: f64, velocity: f64) -> f64 {
        self.past.rotate_right(1);
        self.past[0] = (place_m, velocity);
        let (newer, older) = (self.past[self.whole_ticks], self.past[self.whole_ticks + 1]);
        let (t, h) = (self.part, self.tick_s);
        let way_m = older.0 - newer.0;
        newer.0 + way_m * t * t * (3.0 - 2.0 * t) - h * newer.1 * t * (1.0 - t) * (1.0 - t)
            + h * older.1 * t * t * (1.0 - t)
    }
}

/// A channel of the log that is late by the effect of that name. It may be early: then it is where its velocity and its
/// acceleration take it.
#[derive(Clone, Debug)]
pub struct Late {
    delay: Option<Delay>,
    early_s: f64,
}

impl Late {
    /// Of something that has stood at `start_m` for long, logged once a sample.
    #[must_use]
    pub fn new(late_s: f64, sample_s: f64, start_m: f64) -> Self {
        Self { delay: Delay::new(late_s, sample_s, start_m), early_s: (-late_s).max(0.0) }
    }

    /// How far the log is behind what it should show, m.
    pub fn behind_m(&mut self, place_m: f64, velocity: f64, acceleration: f64) -> f64 {
        match &mut self.delay {
            Some(delay) => place_m - delay.read(place_m, velocity),
            None => -self.early_s * (velocity + 0.5 * self.early_s * acceleration),
        }
    }
}

/// The force channel of the log, that is late by the effect of that name. A force stands for a tick: between two of
/// them it goes straight. Early is at most what the drive has been asked for by then, the tick to come.
#[derive(Clone, Debug)]
pub struct LateForce {
    /// Of the ticks that are over, N, the newest first.
    past_n: VecDeque<f64>,
    ticks: f64,
}

impl LateForce {
    /// Of a drive that has given nothing; `None` where the log is in time.
    #[must_use]
    pub fn new(late_s: f64, tick_s: f64) -> Option<Self> {
        let ticks = (late_s / tick_s).max(-1.0);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "not negative, and saturates"
        )]
        let kept = ticks.max(0.0).floor() as usize + 2;
        (late_s != 0.0).then(|| Self { past_n: VecDeque::from(vec![0.0; kept]), ticks })
    }

    /// Once a tick: the force that is given over it, N.
    pub fn give(&mut self, force_n: f64) {
        self.past_n.rotate_right(1);
        self.past_n[0] = force_n;
    }

    /// What is logged, N, when `coming_n` is what the next tick will give.
    #[must_use]
    pub fn logged_n(&self, coming_n: f64) -> f64 {
        let whole = self.ticks.floor();
        let part = self.ticks - whole;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 0 to what is kept")]
        let at = |age: f64| if age < 0.0 { coming_n } else { self.past_n[age as usize] };
        (1.0 - part) * at(whole) + part * at(whole + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x = 2 + 3t + 2t²: what is read is x(t − τ), for whole ticks and for parts of them.
    #[test]
    fn shows_where_it_was_a_time_ago() {
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

    /// A force that grows by 1 N a tick of 1 ms, logged when 10 N have been given and 11 N come.
    #[test]
    fn a_force_is_logged_as_late_as_it_is_said_to_be() {
        for (late_s, expected_n) in
            [(-1e-3, 11.0), (-0.25e-3, 10.25), (0.5e-3, 9.5), (3e-3, 7.0), (-5e-3, 11.0)]
        {
            let mut late = LateForce::new(late_s, 1e-3).unwrap();
            (1..=10).for_each(|n| late.give(f64::from(n)));
            assert!((late.logged_n(11.0) - expected_n).abs() < 1e-12, "{late_s}: {}", late.logged_n(11.0));
        }
        assert!(LateForce::new(0.0, 1e-3).is_none());
    }

    #[test]
    fn what_stood_is_read_where_it_stood() {
        let mut delay = Delay::new(2.5e-3, 1e-3, 7.0).unwrap();
        assert!((0..10).all(|_| (delay.read(7.0, 0.0) - 7.0).abs() < 1e-15));
    }
}
