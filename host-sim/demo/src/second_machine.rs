//! The controller of `shared` on a machine of the second simulator, the one of the self-test, which shares no code with the plant.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use shared::axis::Reading;

use commissioning::compensate::controller_host::ControllerHost;
use commissioning::compensate::file::CompensationFile;
use commissioning::compensate::prediction::{self, PredictionError, TestMotion};
use commissioning::compensate::round_trip::{MachineUnderTest, Sensing};
use files::log::Log;
use model::machine::Machine;
use plant::machine_sim::{Measurement, position};
use plant::simulate::Plant;
use self_test::case::Case;
use self_test::machine::{Axis, TwoAxes};
use self_test::sensors::{Sensor, Sensors};
use self_test::servo::STEPS_PER_VELOCITY_TICK;

/// A machine of the second simulator.
pub struct SecondMachine {
    /// The declared machine with the settings that its drives have in truth.
    machine: Machine,
    axes: [Axis; 2],
    seed: u64,
}

impl SecondMachine {
    /// The machine of a case.
    #[must_use]
    pub fn of(case: &Case, seed: u64) -> Self {
        let mut machine = case.machine.clone();
        for (declared, truth) in machine.axis.values_mut().zip(&case.axes) {
            let controller = &mut declared.settings.controller;
            controller.position_gain_per_s = Some(truth.servo.position_gain_per_s);
            controller.feedforward_percent = Some(100.0 * truth.servo.feedforward);
            controller.velocity_gain_n_s_per_m = Some(truth.servo.velocity_gain_n_s_per_m);
            controller.velocity_integral_time_s = Some(truth.servo.integral_s);
        }
        Self { machine, axes: case.axes.clone(), seed }
    }

    /// Its axes with other sensors.
    fn with_sensing(&self, sensing: Sensing) -> [Axis; 2] {
        let noiseless = |sensor: Sensor| Sensor { noise: 0.0, ..sensor };
        self.axes.clone().map(|axis| match sensing {
            Sensing::Installed => axis,
            Sensing::Noiseless => {
                let Sensors { motor, table, tool, force } = axis.sensors;
                let [motor, table, tool, force] = [motor, table, tool, force].map(noiseless);
                Axis { sensors: Sensors { motor, table, tool, force }, ..axis }
            }
            Sensing::Ideal => Axis { sensors: Sensors::ideal(), encoder_step_m: 0.0, ..axis },
        })
    }
}

impl MachineUnderTest for SecondMachine {
    fn log(
        &self,
        file: &CompensationFile,
        test: &TestMotion,
        run: u64,
        sensing: Sensing,
    ) -> Result<Log, PredictionError> {
        let axes = self.with_sensing(sensing);
        let plant = |_: &Machine, start_m: &[f64]| {
            let start_m = [0, 1].map(|i| start_m.get(i).copied().unwrap_or(0.0));
            Ok(Running {
                axes: TwoAxes::new(&axes, start_m, test.start_s),
                sensors: axes.each_ref().map(|axis| axis.sensors),
                forces_n: [0.0; 2],
                random: ChaCha8Rng::seed_from_u64(self.seed + run),
            })
        };
        prediction::log_of_plant((&self.machine, plant), file, test, ControllerHost::Host)
    }
}

/// Its axes with the sensors of their log.
struct Running<'a> {
    axes: TwoAxes<'a>,
    sensors: [Sensors; 2],
    /// Forces of the last tick, N.
    forces_n: [f64; 2],
    random: ChaCha8Rng,
}

impl Plant for Running<'_> {
    fn read(&mut self, readings: &mut [Reading]) {
        let (motors_m, tables_m) = (self.axes.readings_m(), self.axes.scales_m());
        for ((reading, motor_m), table_m) in readings.iter_mut().zip(motors_m).zip(tables_m) {
            *reading = Reading { motor: position(motor_m), table: Some(position(table_m)) };
        }
    }

    fn measure(
        &mut self,
        _readings: &[Reading],
        _next_n: impl Iterator<Item = f64>,
        _time_s: f64,
    ) -> Vec<Measurement> {
        let (tables_m, tools_m) = (self.axes.logged_tables_m(), self.axes.logged_tools_m());
        let mut read_m = |sensor: Sensor, m: f64| 1e-3 * sensor.read(1e3 * m, &mut self.random);
        let positions_m = [0, 1].map(|i| {
            let sensors = self.sensors[i];
            [read_m(sensors.table, tables_m[i]), read_m(sensors.tool, tools_m[i])]
        });
        let forces_n = [0, 1].map(|i| self.sensors[i].force.read(self.forces_n[i], &mut self.random));
        let measured = positions_m.into_iter().zip(forces_n);
        let measurement = |([table_m, tool_m], force_n): ([f64; 2], f64)| Measurement {
            motor_offset_m: 0.0,
            tool_m,
            table_m,
            force_n,
        };
        measured.map(measurement).collect()
    }

    fn step(&mut self, forces_n: impl Iterator<Item = f64>) {
        for (force_n, next_n) in self.forces_n.iter_mut().zip(forces_n) {
            *force_n = next_n;
        }
        for _ in 0..STEPS_PER_VELOCITY_TICK {
            self.axes.step(self.forces_n);
        }
    }
}
