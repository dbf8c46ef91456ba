//! The axes of a machine whose structure is given as rigid bodies: they move together.
//!
//! Masses and springs between motor and tool are the structure's ([`super::bodies`]); an axis adds to it what is not
//! linear: friction of motor and guide, load and ripple, errors and gap of the screw.

use nalgebra::Vector3;

use model::bodies::{Assembly, Structure, StructureError};

use super::bodies::{Moving, Push};
use super::friction::StepTime;
use super::guide::Guide;
use super::motion::AxisMotion;
use super::parameters::AxisParameters;
use super::screw::Spring;

/// A structure in motion, with its axes.
pub struct Together {
    moving: Moving,
    axes: Vec<Carried>,
    pushes: Vec<Push>,
    step: StepTime,
    /// Share of the drives' lag that a step leaves, and its mean over the step.
    lag_left: f64,
    lag_mean: f64,
}

/// What stays the same of an axis.
struct Carried {
    motor_start_m: f64,
    table_start_m: f64,
    spring: Spring,
    /// Where the axis takes the tool against the workpiece, of length one.
    way: Vector3<f64>,
    guide: Guide<f64>,
}

impl Together {
    /// At rest with the motors at `start_m`; axes as [`AxisParameters::of_all`] has them.
    ///
    /// # Errors
    /// Where the structure cannot be built.
    pub fn new(
        structure: &Structure,
        parameters: &[AxisParameters],
        start_m: &[f64],
        drive_time_constant_s: f64,
        step_s: f64,
    ) -> Result<Self, StructureError> {
        let mut structure = structure.clone();
        for (axis, parameters) in structure.axis.values_mut().zip(parameters) {
            if let Some(spring) = &parameters.spring {
                axis.stiffness_n_per_um = 1e-6 * spring.stiffness_n_per_m;
            }
        }
        let mut assembly = Assembly::of(&structure)?;
        for (number, parameters) in parameters.iter().enumerate() {
            let guide = assembly.guides.row(number).into_owned();
            assembly.damping += guide.transpose() * guide * parameters.friction.viscous_n_s_per_m;
        }
        let (ways, moving) = (assembly.ways()?, Moving::new(&assembly, step_s)?);
        let carried =
            |(number, (axis, parameters)): (usize, (&model::bodies::Axis, &AxisParameters))| Carried {
                motor_start_m: start_m[number],
                table_start_m: parameters.screw.nominal_m(start_m[number]),
                spring: Spring {
                    stiffness_n_per_m: 1e6 * axis.stiffness_n_per_um,
                    damping_n_s_per_m: 1e3 * axis.damping_n_s_per_mm,
                },
                way: ways.column(number).normalize(),
                guide: Guide::new(parameters),
            };
        let lags = drive_time_constant_s > 0.0;
        let lag_left = if lags { (-step_s / drive_time_constant_s).exp() } else { 0.0 };
        Ok(Self {
            axes: structure.axis.values().zip(parameters).enumerate().map(carried).collect(),
            moving,
            pushes: vec![Push::default(); start_m.len()],
            step: StepTime::new(step_s),
            lag_left,
            lag_mean: if lags { (1.0 - lag_left) * drive_time_constant_s / step_s } else { 0.0 },
        })
    }

    /// What drive and screw of an axis push over the next step, from what its drive is commanded, N.
    pub fn drive(
        &mut self,
        axis: usize,
        parameters: &AxisParameters,
        motion: &mut AxisMotion,
        commanded_n: f64,
    ) {
        let lag_n = motion.drive_n - commanded_n;
        motion.drive_n = commanded_n + self.lag_left * lag_n;
        let drive_n = commanded_n + self.lag_mean * lag_n;
        // What follows from places and velocities is taken in the middle of the step, as far as that is known.
        let half_s = 0.5 * self.step.seconds;
        let middle_m = motion.motor_m + half_s * motion.motor_m_per_s;
        let about = motion.motor_m_per_s + 0.5 * motion.motor_change;
        let motor_n = parameters.motor_friction_n(about) - parameters.ripple_n(middle_m);
        let stretches = half_s * (motion.table_m_per_s - motion.motor_m_per_s);
        let stretch_m = self.moving.stretches_m()[axis] + stretches;
        let screw_n = self.axes[axis].screw_n(parameters, motion, middle_m, stretch_m);
        let push = &mut self.pushes[axis];
        (push.motor_n, push.screw_n) = (drive_n - motor_n, screw_n);
        self.moving.push(axis, *push);
    }

    /// What the guide of an axis pushes over the next step, once every axis is driven.
    pub fn slide(&mut self, axis: usize, parameters: &AxisParameters, motion: &mut AxisMotion) {
        let free = self.moving.free(axis);
        self.pushes[axis].guide_n = self.axes[axis].guide.push_n(&[parameters], motion, free, self.step);
        self.moving.push(axis, self.pushes[axis]);
    }

    /// One step of the whole under the forces of its axes.
    pub fn step(&mut self) {
        self.moving.step();
    }

    /// Where the step has brought an axis; gives tool beyond table, m.
    pub fn show(&self, axis: usize, motion: &mut AxisMotion) -> f64 {
        let carried = &self.axes[axis];
        let moved_m = self.moving.scales_m()[axis];
        let motor_m = carried.motor_start_m + self.moving.motors_m()[axis];
        let table_m = carried.table_start_m + moved_m;
        let (motor_before, table_before) = (motion.motor_m_per_s, motion.table_m_per_s);
        motion.motor_m_per_s = self.moving.motors_m_per_s()[axis];
        motion.table_m_per_s = self.moving.scales_m_per_s()[axis];
        motion.motor_change = motion.motor_m_per_s - motor_before;
        motion.table_change = motion.table_m_per_s - table_before;
        (motion.motor_m, motion.table_m) = (motor_m, table_m);
        let along_m: f64 = carried.way.iter().zip(self.moving.tool_m().iter()).map(|(a, b)| a * b).sum();
        along_m - moved_m
    }

    /// Acceleration of the table over the last step, m/s².
    #[must_use]
    pub fn table_m_per_s2(&self, motion: &AxisMotion) -> f64 {
        motion.table_change * self.step.per_second
    }
}

impl Carried {
    /// What the screw's errors and its gap add to its spring and damper, N on the nut.
    fn screw_n(&self, parameters: &AxisParameters, motion: &AxisMotion, motor_m: f64, stretch_m: f64) -> f64 {
        let screw = &parameters.screw;
        // Both are counted from the start, where the screw holds the table without force.
        let error_m = screw.error_m(motor_m) - screw.error_m(self.motor_start_m);
        let swallowed_m = screw.backlash.swallowed_m(error_m - stretch_m);
        let apart = screw.backlash.half_m() > 0.0 && swallowed_m.abs() < screw.backlash.half_m();
        let ahead_m_per_s = motion.table_m_per_s - motion.motor_m_per_s;
        let damper_n = if apart { self.spring.damping_n_s_per_m * ahead_m_per_s } else { 0.0 };
        self.spring.stiffness_n_per_m * (error_m - swallowed_m) + damper_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::instruments::Instruments;
    use crate::simulate::{self, Run};
    use files::log::Log;
    use link::controller::{Format, PathBlock, PathShape};
    use model::machine::Machine;

    const MACHINE: &str = model::examples::BODIES_MACHINE;

    /// Twice round a circle of 40 mm radius in x and z at 0.2 m/s: 1 m/s² at 0.8 Hz, far below every mode. Then as often
    /// the other way: the drag of one axis leans the tool in phase with the acceleration of the other, and turns with it.
    fn circle() -> (Machine, Log) {
        run(MACHINE, 0.2, 2.0)
    }

    fn run(machine: &str, feed_m_per_s: f64, turns: f64) -> (Machine, Log) {
        let machine = Machine::parse(machine, "bodies.toml").unwrap();
        let start_m = [0.04, 0.0, 0.0];
        let round = |turns| PathShape::Arc { plane: [0, 2], centre_m: [0.0, 0.0], turns };
        let blocks = [turns, -turns].map(|turns| PathBlock::new(round(turns), feed_m_per_s, 2.0));
        let mut controller = simulate::controller(&machine, Format::F64, &start_m).unwrap();
        let instruments = Instruments { drive_time_constant_s: 1e-4, ..Instruments::default() };
        let run = Run { machine: &machine, instruments, start_m: &start_m, blocks: &blocks, start_s: 0.0 };
        let log = run.log(controller.as_mut(), |_, _, _| ()).unwrap();
        (machine, log)
    }

    /// A slow half circle, there and back, with keys and effects on x, beside the same without: what each adds to table − motor (µm) and to
    /// the force (N) while x goes ahead, and while it goes back; and the motor's places (mm) then.
    fn added(keys: &str, effect: &str) -> [[Vec<[f64; 3]>; 2]; 2] {
        let with = MACHINE.replacen("[axis.x]", &format!("[axis.x]\n{keys}"), 1) + effect;
        [MACHINE, &with].map(|machine| {
            let (_, log) = run(machine, 0.02, 0.5);
            let x = &log.axes[0];
            let [motor, table, force] =
                [&x.motor, &x.table, &x.force].map(|channel| channel.as_ref().unwrap());
            [1.0, -1.0].map(|sign| {
                // Well on its way: beyond 10 of 20 mm/s.
                let goes = |i: &usize| sign * (motor[i + 1] - motor[i - 1]) / 2e-3 > 10.0;
                let row = |i: usize| [1e3 * (table[i] - motor[i]), force[i], motor[i]];
                (1..motor.len() - 1).filter(goes).map(row).collect()
            })
        })
    }

    fn mean(rows: &[[f64; 3]], column: usize) -> f64 {
        numerics::mean(rows.iter().map(|row| row[column]))
    }

    /// One body on a guide, driven through its centre, is an axis: what is known of that (`mechanics`) holds for bodies.
    /// Both take friction and lag over a step as its mean.
    #[test]
    fn a_body_on_a_guide_is_an_axis() {
        let axis = "name = \"a\"\nsample_rate_hz = 1000.0\nvelocity_loop_rate_hz = 4000.0\n\
            [axis.x]\ncontroller = \"p\"\nposition_gain_per_s = 40.0\nvelocity_gain_n_s_per_m = 80000.0\n\
            velocity_integral_time_s = 0.02\nforce_limit_n = 15000.0\nfeedback = \"motor\"\nmotor_mass_kg = 120.0\n\
            table_mass_kg = 250.0\nstiffness_n_per_um = 200.0\ndamping_n_s_per_m = 12000.0\nmotor_coulomb_n = 40.0\n\
            viscous_n_s_per_m = 1500.0\n";
        let body = "[structure.body.table]\nmass_kg = 250.0\ninertia_kg_m2 = [5.0, 5.0, 5.0, 0.0, 0.0, 0.0]\n\
            centre_mm = [0.0, 0.0, 0.0]\n[[structure.joint]]\nkind = \"guideway\"\nfrom = \"ground\"\nto = \"table\"\n\
            at_mm = [[-200.0, -200.0, 0.0], [200.0, -200.0, 0.0], [-200.0, 200.0, 0.0], [200.0, 200.0, 0.0]]\n\
            stiffness_n_per_um = [0.0, 500.0, 500.0]\n[structure.axis.x]\nfrom = \"ground\"\nto = \"table\"\n\
            direction = [1.0, 0.0, 0.0]\nat_mm = [0.0, 0.0, 0.0]\nscale_at_mm = [0.0, 0.0, 0.0]\nmotor_mass_kg = 120.0\n\
            stiffness_n_per_um = 200.0\ndamping_n_s_per_mm = 12.0\n[structure.tool]\nbody = \"table\"\n\
            at_mm = [0.0, 0.0, 0.0]\n[structure.workpiece]\nbody = \"ground\"\nat_mm = [0.0, 0.0, 0.0]\n";
        let sliding = "coulomb_n = 250.0\npresliding_stiffness_n_per_um = 40.0\npresliding_damping_n_s_per_m = 2000.0\n";
        let gap = "coulomb_n = 250.0\npresliding_stiffness_n_per_um = 40.0\npresliding_damping_n_s_per_m = 2000.0\n\
            [[axis.x.effect]]\nname = \"backlash\"\nwidth_um = 8.0\n";
        let effects = "coulomb_n = 250.0\n[[axis.x.effect]]\nname = \"pitch_cyclic\"\namplitude_um = 2.0\nperiod_mm = 5.0\n\
            phase_rad = 0.4\n[[axis.x.effect]]\nname = \"torque_ripple\"\namplitude_n = 30.0\nperiod_mm = 4.0\n\
            phase_rad = 0.0\n[[axis.x.effect]]\nname = \"constant_load\"\nforce_n = 90.0\n\
            [[axis.x.effect]]\nname = \"friction_asymmetry\"\nhalf_difference_n_s_per_m = 200.0\n";
        // The gap opens and closes a step of 80 µs apart, at some mm/s.
        for (extra, bound_nm) in [("coulomb_n = 250.0\n", 1.0), (sliding, 1.0), (gap, 40.0), (effects, 1.0)] {
            let run = |machine: &str| {
                let machine = Machine::parse(machine, "one.toml").unwrap();
                let there = |to_m: f64| PathBlock::new(PathShape::Line { to_m: vec![to_m] }, 0.04, 1.0);
                let blocks = [there(0.02), PathBlock::dwell(0.2), there(-0.01)];
                let mut controller = simulate::controller(&machine, Format::F64, &[0.0]).unwrap();
                let instruments = Instruments { drive_time_constant_s: 5e-4, ..Instruments::default() };
                let run =
                    Run { machine: &machine, instruments, start_m: &[0.0], blocks: &blocks, start_s: 0.0 };
                run.log(controller.as_mut(), |_, _, _| ()).unwrap().axes.remove(0)
            };
            let (alone, with_body) = (format!("{axis}{extra}"), format!("{axis}{extra}{body}"));
            let [alone, with_body] = [alone, with_body].map(|machine| run(&machine).table.unwrap());
            let apart = numerics::max_abs(alone.iter().zip(&with_body).map(|(a, b)| 1e6 * (a - b)));
            assert!(apart < bound_nm, "{apart} nm apart with {extra}");
            assert!(alone.iter().any(|mm| *mm > 19.0));
        }
    }

    fn off(seen: f64, expected: f64, part: f64) -> bool {
        (seen - expected).abs() > part * expected.abs()
    }

    /// Sliding friction F turns the force over by 2F, and bends the screw by 2F/k, through which it goes. Where there is
    /// a gap the nut is half of it behind on each way.
    #[test]
    fn friction_and_gap_turn_over_with_the_way() {
        let over = |rows: &[Vec<[f64; 3]>; 2], column| mean(&rows[0], column) - mean(&rows[1], column);
        // As steady as the loop goes, which is to some per mille of it.
        let [without, with] = added("coulomb_n = 300.0", "");
        let (bend_um, force_n) = (over(&with, 0) - over(&without, 0), over(&with, 1) - over(&without, 1));
        assert!(!off(force_n, 600.0, 0.01), "{force_n} N");
        assert!(!off(bend_um, -600.0 / 150.0, 0.01), "{bend_um} µm");
        let soft = "[[axis.x.effect]]\nname = \"windup\"\nstiffness_n_per_um = 75.0\n";
        let [_, soft] = added("coulomb_n = 300.0", soft);
        let bend_um = over(&soft, 0) - over(&with, 0);
        // The drag that is there without friction bends the softer screw more, too.
        let drag_n = over(&without, 0) * -150.0;
        assert!(!off(bend_um, -(600.0 + drag_n) * (1.0 / 75.0 - 1.0 / 150.0), 0.01), "{bend_um} µm");
        let gap = "[[axis.x.effect]]\nname = \"backlash\"\nwidth_um = 12.0\n";
        let [without, with] = added("", gap);
        let swallowed_um = over(&with, 0) - over(&without, 0);
        assert!(!off(swallowed_um, -12.0, 0.01), "{swallowed_um} µm");
        let force_n = over(&with, 1) - over(&without, 1);
        assert!(force_n.abs() < 5.0, "{force_n} N");
    }

    #[test]
    fn a_screw_of_another_lead_takes_the_table_farther() {
        let lead = "[[axis.x.effect]]\nname = \"pitch_progressive\"\nslope_um_per_m = 200.0\n";
        let [without, with] = added("", lead);
        for (without, with) in without.iter().zip(&with) {
            let slope = |rows: &[[f64; 3]]| {
                let (mean_um, mean_mm) = (mean(rows, 0), mean(rows, 2));
                let products = rows.iter().map(|row| (row[0] - mean_um) * (row[2] - mean_mm)).sum::<f64>();
                1e3 * products / rows.iter().map(|row| (row[2] - mean_mm).powi(2)).sum::<f64>()
            };
            let slope = slope(with) - slope(without);
            assert!(!off(slope, 200.0, 0.01), "{slope} µm/m");
        }
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
