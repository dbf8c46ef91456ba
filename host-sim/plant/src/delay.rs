//! Latencies: of readings on their way to the controller, and of logged channels.

use std::collections::VecDeque;

use model::servo::ServoParameters;

/// Whole ticks of a delay and the rest as a fraction of a tick; `None` if there is no delay.
fn in_ticks(delay_s: f64, tick_s: f64) -> Option<(usize, f64)> {
    let ticks = delay_s / tick_s;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive, and saturates")]
    (delay_s > 0.0).then(|| (ticks.floor() as usize, ticks.fract()))
}

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
        Self::in_motion(delay_s, tick_s, start_m, 0.0)
    }

    /// A latency (s) of a position that has moved steadily at `velocity` (m/s) and is at `start_m` in the first tick; `None` if
    /// there is no latency.
    #[must_use]
    pub fn in_motion(delay_s: f64, tick_s: f64, start_m: f64, velocity: f64) -> Option<Self> {
        let (whole_ticks, fraction) = in_ticks(delay_s, tick_s)?;
        Some(Self {
            past: (1..=whole_ticks + 2)
                .map(|age| (start_m - velocity * tick_s * age as f64, velocity))
                .collect(),
            whole_ticks,
            fraction,
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

/// Latency of the logged command (the effect `latency`), of at most one sample either way: the parabola through the last three
/// commands, exact for a constant acceleration.
#[derive(Clone, Debug)]
pub struct CommandDelay {
    late_samples: f64,
    /// The last two commands, m, the newest first.
    past_m: Option<[f64; 2]>,
}

impl CommandDelay {
    /// A latency (s) of a command that is logged once per sample.
    #[must_use]
    pub fn new(latency_s: f64, sample_s: f64) -> Self {
        Self { late_samples: latency_s / sample_s, past_m: None }
    }

    /// The logged command, m, at a sample with this command (m). To be called once per sample.
    pub fn logged_m(&mut self, command_m: f64) -> f64 {
        let [last_m, before_m] = self.past_m.unwrap_or([command_m; 2]);
        self.past_m = Some([command_m, last_m]);
        let late = self.late_samples;
        let curvature = before_m - 2.0 * last_m + command_m;
        command_m + late * (last_m - command_m) + 0.5 * late * (late - 1.0) * curvature
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

/// Dead time of a force that is commanded once per tick and acts later (the effect `drive_dead_time`).
#[derive(Clone, Debug)]
pub struct DeadTime {
    /// Commanded forces, N, the newest first, up to the oldest that still acts.
    commanded_n: VecDeque<f64>,
    whole_ticks: usize,
    /// The rest of the dead time, as a fraction of a tick.
    fraction: f64,
}

impl DeadTime {
    /// A dead time (s) of a force that has been `start_n`; `None` if there is none.
    #[must_use]
    pub fn new(delay_s: f64, tick_s: f64, start_n: f64) -> Option<Self> {
        let (whole_ticks, fraction) = in_ticks(delay_s, tick_s)?;
        let commanded_n = VecDeque::from(vec![start_n; whole_ticks + 2]);
        Some(Self { commanded_n, whole_ticks, fraction })
    }

    /// Mean force that acts during a tick, N, whose commanded force is `force_n`. To be called once per tick.
    pub fn acting_n(&mut self, force_n: f64) -> f64 {
        self.commanded_n.rotate_right(1);
        self.commanded_n[0] = force_n;
        let [newer_n, older_n] = [self.whole_ticks, self.whole_ticks + 1].map(|age| self.commanded_n[age]);
        self.fraction * older_n + (1.0 - self.fraction) * newer_n
    }
}

/// A force on its way from the velocity loop to the motor (the effects `computation_delay` and `drive_dead_time`).
#[derive(Clone, Debug)]
pub struct ForcePath {
    computation: Option<DeadTime>,
    dead_time: Option<DeadTime>,
}

impl ForcePath {
    /// The path of a force that has been `start_n`.
    #[must_use]
    pub fn new(servo: &ServoParameters, tick_s: f64, start_n: f64) -> Self {
        Self {
            computation: DeadTime::new(tick_s * servo.computation_delay.periods, tick_s, start_n),
            dead_time: DeadTime::new(servo.dead_time.seconds(), tick_s, start_n),
        }
    }

    /// The force that is output, and logged, in a tick, and the mean force that acts, N, from the one that the velocity loop computes. To be
    /// called once per tick.
    pub fn output_and_acting_n(&mut self, computed_n: f64) -> [f64; 2] {
        let late = |delay: &mut Option<DeadTime>, force_n| {
            delay.as_mut().map_or(force_n, |delay| delay.acting_n(force_n))
        };
        let output_n = late(&mut self.computation, computed_n);
        [output_n, late(&mut self.dead_time, output_n)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::effects::{ComputationDelay, DriveDeadTime};

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

    /// A force of 1 N from tick 0 on, 1.3 ticks late: it acts from 0.3 of tick 1 on.
    #[test]
    fn a_force_acts_one_dead_time_later() {
        let mut drive = DeadTime::new(1.3e-3, 1e-3, 0.0).unwrap();
        for expected_n in [0.0, 0.7, 1.0] {
            let acting_n = drive.acting_n(1.0);
            assert!((acting_n - expected_n).abs() < 1e-9, "{acting_n}");
        }
        assert!(DeadTime::new(0.0, 1e-3, 0.0).is_none());
    }

    /// One period to compute, and half a period until the drive acts.
    #[test]
    fn a_force_is_output_after_its_computation_and_acts_after_the_dead_time() {
        let servo = ServoParameters {
            computation_delay: ComputationDelay { periods: 1.0 },
            dead_time: DriveDeadTime { ms: 0.5 },
            ..ServoParameters::default()
        };
        let (mut late, mut at_once) =
            (ForcePath::new(&servo, 1e-3, 0.0), ForcePath::new(&ServoParameters::default(), 1e-3, 0.0));
        let assert_near = |found: [f64; 2], expected: [f64; 2]| {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {expected:?}");
        };
        for expected_n in [[0.0, 0.0], [1.0, 0.5], [1.0, 1.0]] {
            assert_near(late.output_and_acting_n(1.0), expected_n);
            assert_near(at_once.output_and_acting_n(1.0), [1.0, 1.0]);
        }
    }

    /// x = 3t + 2t².
    #[test]
    fn a_logged_command_has_its_latency() {
        let at = |t: f64| 3.0 * t + 2.0 * t * t;
        for late_s in [0.4e-3, -0.7e-3, 0.0] {
            let mut delay = CommandDelay::new(late_s, 1e-3);
            for i in 0..20 {
                let t = 1e-3 * f64::from(i);
                let logged = delay.logged_m(at(t));
                assert!(i < 2 || (logged - at(t - late_s)).abs() < 1e-12, "{late_s} at {t}: {logged}");
            }
        }
    }

    #[test]
    fn a_position_in_motion_is_read_behind_it() {
        let mut delay = Delay::in_motion(2.5e-3, 1e-3, 7.0, 0.2).unwrap();
        assert!((0..10).all(|tick| {
            (delay.read(7.0 + 2e-4 * f64::from(tick), 0.2) - 7.0 - 2e-4 * (f64::from(tick) - 2.5)).abs()
                < 1e-12
        }));
    }

    #[test]
    fn a_constant_position_is_read_unchanged() {
        let mut delay = Delay::new(2.5e-3, 1e-3, 7.0).unwrap();
        assert!((0..10).all(|_| (delay.read(7.0, 0.0) - 7.0).abs() < 1e-15));
    }
}
