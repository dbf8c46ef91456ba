//! Sizes of the errors of one axis, and what each changes in its true values.

use std::f64::consts::TAU;

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::draw::one_of;
use super::effect::sinusoid_um;
use super::machine::Axis;
use super::pickup::Filter;
use super::plant::Sinusoid;
use super::servo::VELOCITY_TICK_S;

/// 2π times a frequency, 1/s.
pub(super) fn omega(frequency_hz: f64) -> f64 {
    TAU * frequency_hz
}

/// Draws sizes.
pub(super) struct Random<'a>(pub(super) &'a mut ChaCha8Rng);

impl Random<'_> {
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0.random_range(low..high)
    }

    /// Either sign.
    pub(super) fn signed(&mut self, low: f64, high: f64) -> f64 {
        let size = self.between(low, high);
        if self.0.random_bool(0.5) { size } else { -size }
    }
}

/// An encoder of this step in both loops and in the log.
pub(super) fn encoder_steps(axis: &mut Axis, step_m: f64) {
    axis.encoder_step_m = step_m;
    axis.sensors.motor.steps_per_unit = 1e-3 / step_m;
}

/// Draws the size of an error of one axis, sets it, and returns its parameters.
pub(super) fn of_axis(name: &str, axis: &mut Axis, sizes: &mut Random<'_>) -> Vec<(&'static str, f64)> {
    match name {
        "feedback_late" | "feedback_notch" | "feedback_low_pass" | "dead_time" | "loop_delay"
        | "velocity_fresh" | "drive_asymmetry" => of_loop(name, axis, sizes),
        "scale_gain" | "scale_wave" | "scale_growth" | "hum_50hz" => of_scale(name, axis, sizes),
        "probe_gain" => {
            axis.recording.probe_gain = sizes.signed(0.2e-3, 1e-3);
            vec![("percent", 100.0 * axis.recording.probe_gain)]
        }
        "force_gain" => {
            axis.recording.force_gain = sizes.signed(0.05, 0.15);
            vec![("percent", 100.0 * axis.recording.force_gain)]
        }
        "encoder_steps" => {
            let step_um = one_of(&[0.5, 1.0], sizes.0);
            encoder_steps(axis, 1e-6 * step_um);
            vec![("step_um", step_um)]
        }
        "stiffness_varies" => {
            let (part, period_mm) = (sizes.between(0.2, 0.5), sizes.between(200.0, 400.0));
            axis.mechanics.stiffness_wave =
                Sinusoid { amplitude: part, period: 1e-3 * period_mm, phase: sizes.between(0.0, TAU) };
            vec![("part", part), ("period_mm", period_mm)]
        }
        _ => of_tool(name, axis, sizes),
    }
}

/// Errors of the control loops and the drive.
fn of_loop(name: &str, axis: &mut Axis, sizes: &mut Random<'_>) -> Vec<(&'static str, f64)> {
    let servo = &mut axis.servo;
    match name {
        "feedback_late" => {
            servo.pickup.delay_s = sizes.between(0.5e-3, 2e-3);
            vec![("ms", 1e3 * servo.pickup.delay_s)]
        }
        "feedback_notch" => {
            let (frequency_hz, zeta) = (sizes.between(50.0, 70.0), sizes.between(0.2, 0.5));
            servo.pickup.filter = Filter::Notch([omega(frequency_hz), zeta]);
            vec![("frequency_hz", frequency_hz), ("damping_ratio", zeta)]
        }
        "feedback_low_pass" => {
            let frequency_hz = sizes.between(80.0, 300.0);
            servo.pickup.filter = Filter::LowPass(1.0 / omega(frequency_hz));
            vec![("frequency_hz", frequency_hz)]
        }
        "dead_time" => {
            let ticks = one_of(&[1.0, 2.0], sizes.0);
            servo.dead_s = ticks * VELOCITY_TICK_S;
            vec![("ms", 1e3 * servo.dead_s)]
        }
        "loop_delay" => {
            servo.delay_ticks = 1;
            servo.velocity_filter_s = sizes.between(0.3e-3, 0.6e-3);
            vec![("ticks", 1.0), ("filter_ms", 1e3 * servo.velocity_filter_s)]
        }
        "velocity_fresh" => {
            // The velocity over a window is half a window old, that of the backward difference half a tick.
            let fresher_ticks = sizes.between(0.1, 0.4);
            servo.velocity_window_s = Some((1.0 - 2.0 * fresher_ticks) * VELOCITY_TICK_S);
            vec![("ms", -1e3 * fresher_ticks * VELOCITY_TICK_S)]
        }
        _ => {
            servo.weakness = sizes.signed(0.05, 0.15);
            vec![("percent", 100.0 * servo.weakness)]
        }
    }
}

fn of_scale(name: &str, axis: &mut Axis, sizes: &mut Random<'_>) -> Vec<(&'static str, f64)> {
    let scale = &mut axis.scale;
    match name {
        "scale_gain" => {
            scale.gain = sizes.signed(20e-6, 60e-6);
            vec![("um_per_m", 1e6 * scale.gain)]
        }
        "scale_wave" => {
            let (amplitude_um, period_mm) = (sizes.between(1.5, 4.0), sizes.between(25.0, 120.0));
            scale.wave = sinusoid_um(amplitude_um, period_mm, sizes.between(0.0, TAU));
            vec![("amplitude_um", amplitude_um), ("period_mm", period_mm)]
        }
        "scale_growth" => {
            scale.growth = sizes.signed(15e-6, 40e-6);
            scale.growth_s = sizes.between(40.0, 200.0);
            vec![("um_per_m", 1e6 * scale.growth), ("time_constant_s", scale.growth_s)]
        }
        _ => {
            let amplitude_nm = sizes.between(40.0, 100.0);
            let phase = sizes.between(0.0, TAU);
            scale.hum = Sinusoid { amplitude: 1e-9 * amplitude_nm, period: 1.0 / HUM_HZ, phase };
            vec![("amplitude_um", 1e-3 * amplitude_nm), ("frequency_hz", HUM_HZ)]
        }
    }
}

/// Frequency of the mains.
const HUM_HZ: f64 = 50.0;

fn of_tool(name: &str, axis: &mut Axis, sizes: &mut Random<'_>) -> Vec<(&'static str, f64)> {
    match name {
        "two_drifts" => {
            let [fast_um, slow_um] = [sizes.signed(3.0, 8.0), sizes.signed(6.0, 15.0)];
            let [fast_s, slow_s] = [sizes.between(5.0, 12.0), sizes.between(300.0, 600.0)];
            [axis.drift_m, axis.drift_s] = [1e-6 * fast_um, fast_s];
            axis.slow_drift = Some([1e-6 * slow_um, slow_s]);
            vec![
                ("amplitude_um", fast_um),
                ("time_constant_s", fast_s),
                ("slow_amplitude_um", slow_um),
                ("slow_time_constant_s", slow_s),
            ]
        }
        "linear_drift" => {
            axis.drift_m_per_s = sizes.signed(20e-9, 80e-9);
            vec![("um_per_s", 1e6 * axis.drift_m_per_s)]
        }
        "mode_on_table" => {
            let (frequency_hz, zeta) = (sizes.between(30.0, 80.0), sizes.between(0.03, 0.15));
            axis.resonance = Some([omega(frequency_hz), zeta]);
            axis.is_tool_damped_by_table = true;
            vec![("frequency_hz", frequency_hz), ("damping_ratio", zeta)]
        }
        _ => {
            let [low_hz, high_hz] = [sizes.between(30.0, 50.0), sizes.between(90.0, 140.0)];
            let [low, high] = [sizes.between(0.03, 0.1), sizes.between(0.03, 0.1)];
            axis.resonance = Some([omega(low_hz), low]);
            axis.second_resonance = Some([omega(high_hz), high]);
            vec![("frequency_hz", low_hz), ("second_frequency_hz", high_hz)]
        }
    }
}
