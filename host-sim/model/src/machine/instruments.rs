//! What reads the machine: the `[instruments]` table of a machine file.

use serde::{Deserialize, Serialize};

/// Sensors and drive of every axis. What is absent is as on a well-kept machine
/// (`Instruments::typical` of the crate `plant`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InstrumentKeys {
    /// Step of the motor's encoder or resolver, at the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motor_resolution_um: Option<f64>,
    /// Standard deviation of its reading.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motor_noise_um: Option<f64>,
    /// How old its reading is when the controller gets it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motor_latency_ms: Option<f64>,
    /// Step of the linear scale.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table_resolution_um: Option<f64>,
    /// Standard deviation of its reading.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table_noise_um: Option<f64>,
    /// How old its reading is when the controller gets it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub table_latency_ms: Option<f64>,
    /// Step of the probe at the tool point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool_resolution_um: Option<f64>,
    /// Standard deviation of its reading.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool_noise_um: Option<f64>,
    /// Step of the logged force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_resolution_n: Option<f64>,
    /// Standard deviation of the logged force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_noise_n: Option<f64>,
    /// Of the drive's current loop, a first-order lag: 1/2πf of its bandwidth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drive_time_constant_ms: Option<f64>,
}

impl InstrumentKeys {
    /// Every key with its value.
    #[must_use]
    pub fn all(&self) -> [(&'static str, Option<f64>); 11] {
        [
            ("motor_resolution_um", self.motor_resolution_um),
            ("motor_noise_um", self.motor_noise_um),
            ("motor_latency_ms", self.motor_latency_ms),
            ("table_resolution_um", self.table_resolution_um),
            ("table_noise_um", self.table_noise_um),
            ("table_latency_ms", self.table_latency_ms),
            ("tool_resolution_um", self.tool_resolution_um),
            ("tool_noise_um", self.tool_noise_um),
            ("force_resolution_n", self.force_resolution_n),
            ("force_noise_n", self.force_noise_n),
            ("drive_time_constant_ms", self.drive_time_constant_ms),
        ]
    }
}
