//! The controller of the second simulator, as the contract writes it; see [`super::plant`].

use super::plant::STEP_S;

/// Steps of the plant in a tick of the velocity loop: 4 kHz.
pub const STEPS_A_VELOCITY_TICK: u32 = 5;
/// Steps of the plant in a sample: 1 kHz.
pub const STEPS_A_SAMPLE: u32 = 20;
/// Of the position loop and of the log.
pub const SAMPLE_S: f64 = 1e-3;
/// Of the velocity loop.
const VELOCITY_TICK_S: f64 = 0.25e-3;

/// k1 and k2 of the HPC filter.
const HPC: [f64; 2] = [8.0 / 3.0, 6.0];

/// The settings of one drive, SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// HPC in front of the gain.
    pub hpc: bool,
    /// Kp as it is in the drive.
    pub position_gain_per_s: f64,
    /// Kf, 1 for 100 %.
    pub feedforward: f64,
    /// Kv.
    pub velocity_gain_n_s_per_m: f64,
    /// Ti.
    pub integral_s: f64,
    /// Largest force.
    pub limit_n: f64,
    /// Time constant of dual feedback; none: the motor is fed back.
    pub dual_s: Option<f64>,
}

/// What one drive remembers.
#[derive(Clone, Debug, PartialEq)]
pub struct Servo {
    settings: Settings,
    last_command_m: f64,
    last_reading_m: f64,
    asked_m_per_s: f64,
    filtered_m: f64,
    filtered_m_per_s: f64,
    dual_m: f64,
    integral_m: f64,
    force_n: f64,
}

impl Servo {
    /// At rest where the command starts; `reading_m` is what the motor's sensor says there.
    #[must_use]
    pub fn new(settings: Settings, command_m: f64, reading_m: f64) -> Self {
        Self {
            settings,
            last_command_m: command_m,
            last_reading_m: reading_m,
            asked_m_per_s: 0.0,
            filtered_m: 0.0,
            filtered_m_per_s: 0.0,
            dual_m: 0.0,
            integral_m: 0.0,
            force_n: 0.0,
        }
    }

    /// Force of the last tick of the velocity loop, N.
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
        let lead_s = settings.feedforward / settings.position_gain_per_s;
        let ahead_m = lead_s * (command_m - self.last_command_m) / SAMPLE_S;
        self.last_command_m = command_m;
        let error_m = command_m + ahead_m - feedback_m;
        let asked_m = if self.settings.hpc { self.filtered(error_m) } else { error_m };
        self.asked_m_per_s = self.settings.position_gain_per_s * asked_m;
    }

    /// HPC filter k1k2Kp²/(s² + k2·Kp·s + k1k2Kp²) over one sample, in steps as fine as the plant's.
    fn filtered(&mut self, error_m: f64) -> f64 {
        let kp = self.settings.position_gain_per_s;
        let [k1, k2] = HPC;
        for _ in 0..STEPS_A_SAMPLE {
            let pull = k1 * k2 * kp * kp * (error_m - self.filtered_m) - k2 * kp * self.filtered_m_per_s;
            self.filtered_m_per_s += STEP_S * pull;
            self.filtered_m += STEP_S * self.filtered_m_per_s;
        }
        self.filtered_m
    }

    /// Tick of the velocity loop: Kv·(ev + ∫ev dt/Ti), the integral held while the force is at its limit.
    pub fn velocity_tick(&mut self, reading_m: f64) {
        let settings = &self.settings;
        let speed = (reading_m - self.last_reading_m) / VELOCITY_TICK_S;
        self.last_reading_m = reading_m;
        let error = self.asked_m_per_s - speed;
        let integral_m = self.integral_m + VELOCITY_TICK_S * error;
        let force_n = settings.velocity_gain_n_s_per_m * (error + integral_m / settings.integral_s);
        self.force_n = force_n.clamp(-settings.limit_n, settings.limit_n);
        if self.force_n == force_n {
            self.integral_m = integral_m;
        }
    }
}
