//! The controller of the second simulator in f64, with the equations in docs/self-test.md; see [`super::plant`].

use std::collections::VecDeque;

use super::pickup::Pickup;
use super::plant::STEP_S;

/// Steps of the plant in a tick of the velocity loop: 4 kHz.
pub const STEPS_PER_VELOCITY_TICK: u32 = 5;
/// Steps of the plant in a sample: 1 kHz.
pub const STEPS_PER_SAMPLE: u32 = 20;
/// Period of the position loop and of the log, s.
pub const SAMPLE_S: f64 = 1e-3;
/// Period of the velocity loop, s.
pub const VELOCITY_TICK_S: f64 = 0.25e-3;

/// k1 and k2 of the HPC filter; see [`Servo::filtered`].
const HPC: [f64; 2] = [8.0 / 3.0, 6.0];

/// Settings of one drive, SI units. Lag, dead time and weakness are those of its power stage, [`super::drive`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// Whether the HPC filter is in front of the position gain.
    pub hpc: bool,
    /// True Kp of the drive.
    pub position_gain_per_s: f64,
    /// Kf, 1 for 100 %.
    pub feedforward: f64,
    /// Kv.
    pub velocity_gain_n_s_per_m: f64,
    /// Ti.
    pub integral_s: f64,
    /// Largest force, either sign.
    pub limit_n: f64,
    /// Time constant of dual feedback; none: motor feedback.
    pub dual_s: Option<f64>,
    /// Time constant with which the force follows the commanded force; 0: at once.
    pub lag_s: f64,
    /// Time after which a commanded force begins to act.
    pub dead_s: f64,
    /// Part of the force that is missing, below 1: positive in the positive direction, negative in the other.
    pub weakness: f64,
    /// The way of the positions to the position loop.
    pub pickup: Pickup,
    /// Time over which the velocity is measured, at most the period of the velocity loop; none: from one tick to the next.
    pub velocity_window_s: Option<f64>,
    /// Time constant of a filter of the measured velocity; 0: none.
    pub velocity_filter_s: f64,
    /// Bandwidth of a tracking loop with two equal poles that measures the velocity; none: differences.
    pub velocity_observer_hz: Option<f64>,
    /// Ticks of the velocity loop from the output of the position loop to the velocity loop.
    pub command_delay_ticks: usize,
    /// Ticks of the velocity loop from the reading to the force.
    pub delay_ticks: usize,
}

/// One drive with its state.
#[derive(Clone, Debug, PartialEq)]
pub struct Servo {
    settings: Settings,
    last_command_m: f64,
    last_reading_m: f64,
    set_m_per_s: f64,
    /// Velocities that are set but not yet followed, m/s, the oldest in front.
    pending_m_per_s: VecDeque<f64>,
    filtered_m: f64,
    filtered_m_per_s: f64,
    dual_m: f64,
    integral_m: f64,
    filtered_speed: f64,
    /// Position, m, and velocity, m/s, of the tracking loop.
    tracked: [f64; 2],
    /// Forces that are computed but not yet commanded, the oldest in front.
    pending_n: VecDeque<f64>,
    force_n: f64,
}

impl Servo {
    /// At rest at the start of the command; `reading_m` is the reading of the motor's sensor there.
    #[must_use]
    pub fn new(settings: Settings, command_m: f64, reading_m: f64) -> Self {
        let pending_n = vec![0.0; settings.delay_ticks].into();
        let pending_m_per_s = vec![0.0; settings.command_delay_ticks].into();
        Self {
            settings,
            pending_n,
            pending_m_per_s,
            filtered_speed: 0.0,
            tracked: [reading_m, 0.0],
            last_command_m: command_m,
            last_reading_m: reading_m,
            set_m_per_s: 0.0,
            filtered_m: 0.0,
            filtered_m_per_s: 0.0,
            dual_m: 0.0,
            integral_m: 0.0,
            force_n: 0.0,
        }
    }

    /// Commanded force, from the last tick of the velocity loop, N.
    #[must_use]
    pub fn force_n(&self) -> f64 {
        self.force_n
    }

    /// Tick of the position loop: e = command + (Kf/Kp)·d(command)/dt − feedback.
    pub fn position_tick(&mut self, command_m: f64, motor_m: f64, table_m: f64) {
        let settings = &self.settings;
        let feedback_m = match settings.dual_s {
            None => motor_m,
            Some(time_s) => {
                self.dual_m += SAMPLE_S / time_s * (table_m - motor_m - self.dual_m);
                motor_m + self.dual_m
            }
        };
        let feedforward_s = settings.feedforward / settings.position_gain_per_s;
        let feedforward_m = feedforward_s * (command_m - self.last_command_m) / SAMPLE_S;
        self.last_command_m = command_m;
        let error_m = command_m + feedforward_m - feedback_m;
        let filtered_m = if self.settings.hpc { self.filtered(error_m) } else { error_m };
        self.set_m_per_s = self.settings.position_gain_per_s * filtered_m;
    }

    /// HPC filter k1k2Kp²/(s² + k2·Kp·s + k1k2Kp²) over one sample, in steps of the plant.
    fn filtered(&mut self, error_m: f64) -> f64 {
        let kp = self.settings.position_gain_per_s;
        let [k1, k2] = HPC;
        for _ in 0..STEPS_PER_SAMPLE {
            let acceleration =
                k1 * k2 * kp * kp * (error_m - self.filtered_m) - k2 * kp * self.filtered_m_per_s;
            self.filtered_m_per_s += STEP_S * acceleration;
            self.filtered_m += STEP_S * self.filtered_m_per_s;
        }
        self.filtered_m
    }

    /// Tick of the velocity loop: Kv·(ev + ∫ev dt/Ti), with the integral held while the force is at its limit. `earlier_m` is the
    /// reading of [`Settings::velocity_window_s`] ago.
    pub fn velocity_tick(&mut self, reading_m: f64, earlier_m: Option<f64>) {
        let speed = self.speed(reading_m, earlier_m);
        self.pending_m_per_s.push_back(self.set_m_per_s);
        let followed_m_per_s = self.pending_m_per_s.pop_front().unwrap_or_default();
        let settings = &self.settings;
        let error = followed_m_per_s - speed;
        let integral_m = self.integral_m + VELOCITY_TICK_S * error;
        let force_n = settings.velocity_gain_n_s_per_m * (error + integral_m / settings.integral_s);
        self.pending_n.push_back(force_n.clamp(-settings.limit_n, settings.limit_n));
        if force_n.abs() <= settings.limit_n {
            self.integral_m = integral_m;
        }
        self.force_n = self.pending_n.pop_front().unwrap_or_default();
    }

    /// The measured velocity, m/s.
    fn speed(&mut self, reading_m: f64, earlier_m: Option<f64>) -> f64 {
        if let Some(bandwidth_hz) = self.settings.velocity_observer_hz {
            let kept = libm::exp(-std::f64::consts::TAU * bandwidth_hz * VELOCITY_TICK_S);
            let [position_m, speed] = &mut self.tracked;
            let off_m = reading_m - *position_m - VELOCITY_TICK_S * *speed;
            *position_m += VELOCITY_TICK_S * *speed + (1.0 - kept * kept) * off_m;
            *speed += (1.0 - kept) * (1.0 - kept) * off_m / VELOCITY_TICK_S;
            return *speed;
        }
        let (since_m, window_s) = match (earlier_m, self.settings.velocity_window_s) {
            (Some(earlier_m), Some(window_s)) => (earlier_m, window_s),
            _ => (self.last_reading_m, VELOCITY_TICK_S),
        };
        self.last_reading_m = reading_m;
        let speed = (reading_m - since_m) / window_s;
        if self.settings.velocity_filter_s == 0.0 {
            return speed;
        }
        let kept = libm::exp(-VELOCITY_TICK_S / self.settings.velocity_filter_s);
        self.filtered_speed = speed + kept * (self.filtered_speed - speed);
        self.filtered_speed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lag_of_the_filter_is_that_of_its_transfer_function() {
        let kp = 50.0;
        let settings = Settings { hpc: true, position_gain_per_s: kp, ..Settings::default() };
        let mut servo = Servo::new(settings, 0.0, 0.0);
        let slope = 0.1;
        let mut lag_m = 0.0;
        for tick in 0..1000 {
            let error_m = slope * SAMPLE_S * f64::from(tick);
            lag_m = error_m - servo.filtered(error_m);
        }
        // The filter delays a ramp by k2·Kp/(k1k2·Kp²). Holding the input over a sample adds half a sample; the output is
        // that of the end of the sample, one sample early. The tolerance is one step of the integration.
        let lag_s = HPC[1] / (HPC[0] * HPC[1] * kp) + 0.5 * SAMPLE_S - SAMPLE_S;
        assert!((lag_m / slope - lag_s).abs() < STEP_S, "{} {lag_s}", lag_m / slope);
    }

    type Change = fn(&mut Settings);

    /// Speeds that a velocity loop measures of a position t²/2, 1 m/s², in ticks from 0 on.
    fn speeds(change: impl Fn(&mut Settings), ticks: u32) -> Vec<f64> {
        let mut settings = Settings {
            position_gain_per_s: 1.0,
            velocity_gain_n_s_per_m: 1.0,
            integral_s: f64::INFINITY,
            limit_n: f64::INFINITY,
            ..Settings::default()
        };
        change(&mut settings);
        let at_m = |time_s: f64| 0.5 * time_s * time_s;
        let window_s = settings.velocity_window_s;
        let mut servo = Servo::new(settings, 0.0, 0.0);
        let mut measured = |tick: u32| {
            let time_s = VELOCITY_TICK_S * f64::from(tick);
            servo.velocity_tick(at_m(time_s), window_s.map(|window_s| at_m(time_s - window_s)));
            // The set speed is 0, and Kv 1: the force is −speed.
            -servo.force_n()
        };
        (1..=ticks).map(&mut measured).collect()
    }

    #[test]
    fn a_measured_velocity_is_as_old_as_its_window_filter_and_delay_say() {
        let filter_s = 0.45e-3;
        let kept = (-VELOCITY_TICK_S / filter_s).exp();
        let tracked = (-std::f64::consts::TAU * 300.0 * VELOCITY_TICK_S).exp();
        let cases: [(Change, f64); 5] = [
            (|_| {}, 0.5 * VELOCITY_TICK_S),
            (|settings| settings.velocity_window_s = Some(0.1e-3), 0.05e-3),
            // A ramp behind y = x + kept·(y − x) is kept/(1 − kept) ticks late.
            (|settings| settings.velocity_filter_s = 0.45e-3, VELOCITY_TICK_S * (0.5 + kept / (1.0 - kept))),
            // Two such filters.
            (
                |settings| settings.velocity_observer_hz = Some(300.0),
                VELOCITY_TICK_S * (0.5 + 2.0 * tracked / (1.0 - tracked)),
            ),
            (|settings| settings.delay_ticks = 1, 1.5 * VELOCITY_TICK_S),
        ];
        for (change, age_s) in cases {
            let speed = speeds(change, 200)[199];
            // At 1 m/s², the speed is the time; the filter has settled to e^−110.
            assert!((200.0 * VELOCITY_TICK_S - speed - age_s).abs() < 1e-9, "{speed} {age_s}");
        }
    }

    /// Kp = Kv = 1 and no integral: the force is the command of the position loop, which came 3 ticks earlier.
    #[test]
    fn a_velocity_command_reaches_the_velocity_loop_its_delay_later() {
        let settings = Settings {
            position_gain_per_s: 1.0,
            velocity_gain_n_s_per_m: 1.0,
            integral_s: 1e9,
            limit_n: 1e9,
            command_delay_ticks: 3,
            ..Settings::default()
        };
        let mut servo = Servo::new(settings, 0.0, 0.0);
        servo.position_tick(0.1, 0.0, 0.0);
        for expected_n in [0.0, 0.0, 0.0, 0.1, 0.1] {
            servo.velocity_tick(0.0, None);
            assert!((servo.force_n() - expected_n).abs() < 1e-9, "{}", servo.force_n());
        }
    }

    #[test]
    fn the_integral_is_held_while_the_force_is_at_its_limit() {
        let settings = Settings {
            position_gain_per_s: 1.0,
            velocity_gain_n_s_per_m: 1e4,
            integral_s: 0.01,
            limit_n: 500.0,
            ..Settings::default()
        };
        let mut servo = Servo::new(settings, 0.0, 0.0);
        servo.position_tick(0.1, 0.0, 0.0);
        (0..1000).for_each(|_| servo.velocity_tick(0.0, None));
        assert_eq!(servo.force_n().to_bits(), 500.0_f64.to_bits());
        assert!(servo.integral_m.abs() < 1e-12, "{}", servo.integral_m);
    }
}
