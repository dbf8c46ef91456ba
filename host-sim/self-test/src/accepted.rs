//! The names that a trace may give to the errors of the measuring chain, and to what a gap of knowledge hides.

use super::naming::{Naming, fault, named};

/// Names of a delay in the loop, wherever in it.
const DELAYS: &[&str] = &[
    "computation_delay",
    "loop_delay",
    "velocity_filter",
    "velocity_lag",
    "drive_lag",
    "position_delay",
    "dead_time",
];
/// Names of a late or filtered position feedback.
const POSITION: &[&str] = &["position_delay", "position_filter", "loop_delay"];
/// Names of backlash and wind-up that nothing separates.
const LOST: &[&str] = &["lost_motion", "windup"];

/// The accepted names, in the order of [`super::chain::NAMES`], then of [`super::gap::NAMES`]. A name that is not accepted may be
/// an imitation only: called ambiguous, with an accepted or true name among its rivals.
pub(super) const NAMINGS: [Naming; 35] = [
    named("feedback_late", POSITION),
    named("feedback_notch", POSITION),
    named("feedback_low_pass", POSITION),
    named("command_shifted", &["latency", "command_latency", "command_delay"]),
    named("probe_rotated", &["probe_rotation"]),
    named("probe_gain", &["probe_gain"]),
    named("probe_mounting", &["probe_rotation", "probe_gain"]),
    named("scale_gain", &["scale_gain"]),
    named("scale_wave", &["scale_wave", "scale_cyclic", "scale_map"]),
    named("scale_growth", &["scale_growth", "scale_gain", "thermal_growth", "axis_growth"]),
    fault("hum_50hz", "hum"),
    named("force_gain", &["force_gain", "torque_constant"]),
    named("drive_asymmetry", &["drive_asymmetry", "force_asymmetry"]),
    named("timestamp_jitter", &["timestamp_jitter", "jitter"]),
    named("dead_time", &["dead_time", "drive_dead_time", "loop_delay"]),
    named("loop_delay", DELAYS),
    named("velocity_fresh", &["velocity_lag"]),
    named(
        "two_drifts",
        &["thermal_drift", "thermal_rate", "drift_rate", "thermal_drift_rate", "linear_drift"],
    ),
    named("linear_drift", &["thermal_rate", "drift_rate", "thermal_drift_rate", "linear_drift"]),
    named("two_modes", &["resonance"]),
    named("stiffness_varies", &["windup", "stiffness_map"]),
    named("encoder_steps", &[]),
    named("quant", &[]),
    Naming {
        estimated: Some(("resonance", &["frequency_hz", "damping_ratio"])),
        ..named("mode_on_table", &["resonance"])
    },
    named("no_stiffness", LOST),
    named("no_motor_coulomb", &[]),
    named("no_force", &[]),
    named("motor_and_force", &[]),
    named("motor_and_tool", LOST),
    named("tool_alone", &["lost_motion"]),
    named("no_table", LOST),
    named("no_controller", &[]),
    named("no_masses", LOST),
    named("coarse_log", &[]),
    named("no_drive", &["lost_motion", "windup", "drive_bandwidth"]),
];

/// Declared values that may be called beyond their tolerance because of a true effect or error.
#[must_use]
pub(super) fn excuses(name: &str, key: &str) -> bool {
    matches!(name, "windup" | "stiffness_varies") && matches!(key, "stiffness_n_per_um" | "damping_n_s_per_m")
}

#[cfg(test)]
mod tests {
    use super::super::{chain, gap};
    use super::*;

    #[test]
    fn every_error_and_every_gap_has_its_names() {
        let named: Vec<&str> = NAMINGS.iter().map(|naming| naming.extra).collect();
        assert_eq!(named, chain::NAMES.into_iter().chain(gap::NAMES).collect::<Vec<_>>());
    }
}
