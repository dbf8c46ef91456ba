//! The axes of a machine whose structure is given as rigid bodies: they move together.
//!
//! Between motor and tool everything is the structure's ([`super::bodies`]); what an axis adds to it are the forces
//! that no linear structure has: friction of motor and guideway, load and ripple, all of which are put on the motor.

use nalgebra::Vector3;

use super::bodies::motion::Moving;
use super::bodies::{Assembly, Structure};
use super::mechanics::AxisMotion;
use super::parameters::AxisParameters;

/// A structure in motion, with its axes.
pub struct Together {
    moving: Moving,
    start_m: Vec<f64>,
    /// Where the axes take the tool against the workpiece, of length one.
    ways: Vec<Vector3<f64>>,
    forces_n: Vec<f64>,
    step_s: f64,
    /// Share of the drives' lag that a step leaves.
    lag_left: f64,
}

impl Together {
    /// At rest with its axes at `start_m`; `None` where the structure cannot be built.
    #[must_use]
    pub fn new(
        structure: &Structure,
        start_m: &[f64],
        drive_time_constant_s: f64,
        step_s: f64,
    ) -> Option<Self> {
        let assembly = Assembly::of(structure).ok()?;
        let ways = assembly.ways().ok()?;
        let moving = Moving::new(&assembly, step_s).ok()?;
        Some(Self {
            moving,
            start_m: start_m.to_vec(),
            ways: ways.column_iter().map(|way| way.normalize()).collect(),
            forces_n: vec![0.0; start_m.len()],
            step_s,
            lag_left: if drive_time_constant_s > 0.0 { (-step_s / drive_time_constant_s).exp() } else { 0.0 },
        })
    }

    /// The force of an axis for the next step, from what its drive is commanded, N.
    pub fn drive(
        &mut self,
        axis: usize,
        parameters: &AxisParameters,
        motion: &mut AxisMotion,
        commanded_n: f64,
    ) {
        // The mean over the step of what a lag of first order still lacks.
        motion.drive_n = commanded_n + self.lag_left * (motion.drive_n - commanded_n);
        let guide_n = parameters.friction.step(&mut motion.bristle_m, motion.table_m_per_s, self.step_s);
        let motor_n = parameters.motor_friction_n(motion.motor_m_per_s) - parameters.ripple_n(motion.motor_m);
        if let Some(place) = self.forces_n.get_mut(axis) {
            *place = motion.drive_n - guide_n - motor_n - parameters.load.force_n;
        }
    }

    /// One step of the whole under the forces of its axes.
    pub fn step(&mut self) {
        self.moving.step(&self.forces_n);
    }

    /// Where the step has brought an axis; gives tool beyond table, m.
    pub fn show(&self, axis: usize, motion: &mut AxisMotion) -> f64 {
        let start_m = self.start_m[axis];
        let (motor_m, table_m) =
            (start_m + self.moving.motors_m()[axis], start_m + self.moving.scales_m()[axis]);
        let (motor_before, table_before) = (motion.motor_m_per_s, motion.table_m_per_s);
        motion.motor_m_per_s = (motor_m - motion.motor_m) / self.step_s;
        motion.table_m_per_s = (table_m - motion.table_m) / self.step_s;
        motion.motor_change = motion.motor_m_per_s - motor_before;
        motion.table_change = motion.table_m_per_s - table_before;
        (motion.motor_m, motion.table_m) = (motor_m, table_m);
        let along_m: f64 = self.ways[axis].iter().zip(self.moving.tool_m().iter()).map(|(a, b)| a * b).sum();
        start_m + along_m - table_m
    }

    /// Acceleration of the table over the last step, m/s².
    #[must_use]
    pub fn table_m_per_s2(&self, motion: &AxisMotion) -> f64 {
        motion.table_change / self.step_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controller::{Format, PathBlock, PathShape};
    use crate::log::Log;
    use crate::machine::Machine;
    use crate::plant::desk::Instruments;
    use crate::simulate::{self, Run};

    const MACHINE: &str = include_str!("../../machines/bodies.toml");

    /// Twice round a circle of 40 mm radius in x and z at 0.2 m/s: 1 m/s² at 0.8 Hz, far below every mode. Then as often
    /// the other way: the drag of one axis leans the tool in phase with the acceleration of the other, and turns with it.
    fn circle() -> (Machine, Log) {
        let machine = Machine::parse(MACHINE, "bodies.toml").unwrap();
        let start_m = [0.04, 0.0, 0.0];
        let round = |turns| PathShape::Arc { plane: [0, 2], centre_m: [0.0, 0.0], turns };
        let blocks = [2.0, -2.0].map(|turns| PathBlock::new(round(turns), 0.2, 2.0));
        let mut controller = simulate::controller(&machine, Format::F64, &start_m).unwrap();
        let instruments = Instruments { drive_time_constant_s: 1e-4, ..Instruments::default() };
        let run = Run { machine: &machine, instruments, start_m: &start_m, blocks: &blocks, start_s: 0.0 };
        let log = run.log(controller.as_mut(), |_, _, _| ()).unwrap();
        (machine, log)
    }

    /// The tool leans by what the statics of the structure give for an acceleration: 0.8 Hz beside the lowest mode of
    /// some 30 Hz adds (0.8/30)² < 0.1 % to it, friction bends the screws, which the scales see.
    #[test]
    fn an_acceleration_leans_the_tool_as_the_statics_say() {
        let (machine, log) = circle();
        let talk = Assembly::of(machine.structure.as_ref().unwrap()).unwrap().talk_at_rest().unwrap();
        let lean_um = |axis: usize| -> Vec<f64> {
            let axis = &log.axes[axis];
            let pairs = axis.tool.as_ref().unwrap().iter().zip(axis.table.as_ref().unwrap());
            pairs.map(|(tool, table)| 1e3 * (tool - table)).collect()
        };
        let acceleration = |axis: usize| -> Vec<f64> {
            let table = log.axes[axis].table.as_ref().unwrap();
            // Over 40 ms, which is 0.2 rad of the circle: 0.3 % less.
            (20..table.len() - 20).map(|i| (table[i + 20] - 2.0 * table[i] + table[i - 20]) / 0.4).collect()
        };
        let (x, z) = (acceleration(0), acceleration(2));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for axis in [0, 2] {
            let lean = lean_um(axis);
            let lean = &lean[20..lean.len() - 20];
            let (xx, xz, zz) = (dot(&x, &x), dot(&x, &z), dot(&z, &z));
            let (xl, zl) = (dot(&x, lean), dot(&z, lean));
            let of_x = (xl * zz - zl * xz) / (xx * zz - xz * xz);
            let of_z = (zl * xx - xl * xz) / (xx * zz - xz * xz);
            for (seen, cause) in [(of_x, 0), (of_z, 2)] {
                let expected = talk.tool_um_s2_per_m[(axis, cause)];
                let off = (seen - expected).abs();
                assert!(
                    off < 0.02 + 0.03 * expected.abs(),
                    "{axis} by {cause}: {seen} of {expected} µm·s²/m"
                );
            }
        }
        assert!(talk.tool_um_s2_per_m[(0, 2)].abs() > 0.3, "there is something to be seen");
    }
}
