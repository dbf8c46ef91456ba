//! Sensors and drive: the `[instruments]` table of a machine file.

use super::number_table::number_table;

number_table! {
    /// Sensors and drive of every axis. Absent values are those of a machine in good condition (`Instruments::typical`
    /// of the crate `plant`).
    InstrumentKeys {
        /// Resolution of the motor's encoder or resolver, in travel of the table.
        motor_resolution_um,
        /// Standard deviation of the motor reading.
        motor_noise_um,
        /// Age of the motor reading when the controller receives it.
        motor_latency_ms,
        /// Resolution of the linear scale.
        table_resolution_um,
        /// Standard deviation of the table reading.
        table_noise_um,
        /// Age of the table reading when the controller receives it.
        table_latency_ms,
        /// Resolution of the probe at the tool point.
        tool_resolution_um,
        /// Standard deviation of the tool reading.
        tool_noise_um,
        /// Resolution of the logged force.
        force_resolution_n,
        /// Standard deviation of the logged force.
        force_noise_n,
        /// Time constant of the drive's current loop, a first-order lag: 1/(2πf) at a bandwidth f.
        drive_time_constant_ms,
    }
}
