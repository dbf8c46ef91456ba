//! The sensors of a machine, their latencies, and the lag of its drives.

use super::sensors::Sensor;
use model::machine::Machine;

/// Sensors and drives, the same for every axis. They are not part of the declared model of a machine.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instruments {
    /// Motor encoder or resolver, m.
    pub motor: Sensor,
    /// Linear scale, m.
    pub table: Sensor,
    /// Tool-point probe, m.
    pub tool: Sensor,
    /// Force reading, N.
    pub force: Sensor,
    /// Time constant of the drive's current loop, a first-order lag, s; zero: no lag.
    pub drive_time_constant_s: f64,
    /// Latency of the motor reading at the controller, s.
    pub motor_latency_s: f64,
    /// Latency of the reading of the linear scale at the controller, s.
    pub table_latency_s: f64,
    /// Seed of all noise.
    pub seed: u64,
}

impl Instruments {
    /// The instruments of a machine in good condition: encoders and scales with a resolution of 10 nm, a grid encoder
    /// at the tool, and a current loop with a time constant of 0.1 ms.
    #[must_use]
    pub fn typical(seed: u64) -> Self {
        Self {
            motor: Sensor { resolution: 10e-9, noise: 10e-9 },
            table: Sensor { resolution: 10e-9, noise: 20e-9 },
            tool: Sensor { resolution: 10e-9, noise: 80e-9 },
            force: Sensor { resolution: 0.1, noise: 1.0 },
            drive_time_constant_s: 1e-4,
            seed,
            ..Self::default()
        }
    }

    /// The instruments of a machine file; those that it does not give are [`Instruments::typical`].
    #[must_use]
    pub fn of(machine: &Machine, seed: u64) -> Self {
        let typical = Self::typical(seed);
        let keys = machine.instruments.unwrap_or_default();
        let sensor = |typical: Sensor, resolution: Option<f64>, noise: Option<f64>, unit: f64| Sensor {
            resolution: resolution.map_or(typical.resolution, |value| unit * value),
            noise: noise.map_or(typical.noise, |value| unit * value),
        };
        let ms = |value: Option<f64>, typical: f64| value.map_or(typical, |ms| 1e-3 * ms);
        Self {
            motor: sensor(typical.motor, keys.motor_resolution_um, keys.motor_noise_um, 1e-6),
            table: sensor(typical.table, keys.table_resolution_um, keys.table_noise_um, 1e-6),
            tool: sensor(typical.tool, keys.tool_resolution_um, keys.tool_noise_um, 1e-6),
            force: sensor(typical.force, keys.force_resolution_n, keys.force_noise_n, 1.0),
            drive_time_constant_s: ms(keys.drive_time_constant_ms, typical.drive_time_constant_s),
            motor_latency_s: ms(keys.motor_latency_ms, 0.0),
            table_latency_s: ms(keys.table_latency_ms, 0.0),
            seed,
        }
    }

    /// These instruments with every sensor changed.
    #[must_use]
    pub fn with_sensors(self, change: impl Fn(Sensor) -> Sensor) -> Self {
        Self {
            motor: change(self.motor),
            table: change(self.table),
            tool: change(self.tool),
            force: change(self.force),
            ..self
        }
    }
}
