//! Sensors and drive: the `[instruments]` table of a machine file.

use super::number_table::number_table;

number_table! {
    /// Sensors and drive of every axis. What is absent is as on a well-kept machine
    /// (`Instruments::typical` of the crate `plant`).
    InstrumentKeys {
        /// Step of the motor's encoder or resolver, at the table.
        motor_resolution_um,
        /// Standard deviation of its reading.
        motor_noise_um,
        /// Age of its reading when the controller gets it.
        motor_latency_ms,
        /// Step of the linear scale.
        table_resolution_um,
        /// Standard deviation of its reading.
        table_noise_um,
        /// Age of its reading when the controller gets it.
        table_latency_ms,
        /// Step of the probe at the tool point.
        tool_resolution_um,
        /// Standard deviation of its reading.
        tool_noise_um,
        /// Step of the logged force.
        force_resolution_n,
        /// Standard deviation of the logged force.
        force_noise_n,
        /// Of the drive's current loop, a first-order lag: 1/(2πf) of its bandwidth f.
        drive_time_constant_ms,
    }
}
