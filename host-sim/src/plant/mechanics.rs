//! Motion of one axis: two masses and a screw, or one rigid mass.
//!
//! A step takes the linear part exactly ([`super::transition`]), however stiff it is, so that it is the friction alone
//! that asks for short steps. Friction is implicit: its mean over the step and the step's mean velocity follow from
//! each other, and both are linear. What depends on positions (gap, errors of the screw, ripple) is taken in the
//! middle of the step. The whole is of second order.

use super::friction::StepTime;
use super::parameters::AxisParameters;
use super::screw::Spring;
use super::transition::{Masses, Transition};

/// Positions (m) and velocities (m/s) of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisMotion {
    /// Motor, true position.
    pub motor_m: f64,
    /// Motor.
    pub motor_m_per_s: f64,
    /// Table.
    pub table_m: f64,
    /// Table.
    pub table_m_per_s: f64,
    /// Bend of the guide's bristles.
    pub bristle_m: f64,
    /// Force of the drive, N.
    pub drive_n: f64,
    /// Friction of the guide without its viscous part, mean of the last step, N.
    pub friction_n: f64,
    /// Change of the motor's velocity over the last step, m/s.
    pub motor_change: f64,
    /// Change of the table's velocity over the last step, m/s.
    pub table_change: f64,
}

impl AxisMotion {
    /// At rest with the motor at a place and no force anywhere.
    #[must_use]
    pub fn at_rest(parameters: &AxisParameters, motor_m: f64) -> Self {
        Self { motor_m, table_m: parameters.screw.nominal_m(motor_m), ..Self::default() }
    }

    /// Acceleration of the table at this moment, m/s².
    #[must_use]
    pub fn table_m_per_s2(&self, parameters: &AxisParameters) -> f64 {
        let friction = &parameters.friction;
        let v = self.table_m_per_s;
        let guide_n = if friction.has_bristles() {
            let relaxes = friction.bristle_stiffness_n_per_m * v.abs() / friction.level_n(v).max(1e-9);
            friction.bristle_stiffness_n_per_m * self.bristle_m
                + friction.bristle_damping_n_s_per_m * (v - relaxes * self.bristle_m)
        } else {
            self.friction_n
        };
        let resistance_n = guide_n + friction.viscous_n(v) + parameters.load.force_n;
        let Some(spring) = &parameters.spring else {
            let drive_n = self.drive_n + parameters.ripple_n(self.motor_m)
                - parameters.motor_friction_n(self.motor_m_per_s);
            return (drive_n - resistance_n) / (parameters.motor_mass_kg + parameters.table_mass_kg);
        };
        let deflection_m = parameters.screw.nominal_m(self.motor_m) - self.table_m;
        let stretch_m = deflection_m - parameters.screw.backlash.swallowed_m(deflection_m);
        let touches = parameters.screw.backlash.width_um == 0.0 || stretch_m != 0.0;
        let damping_n = spring.damping_n_s_per_m * (self.motor_m_per_s - v);
        let screw_n = if touches { spring.stiffness_n_per_m * stretch_m + damping_n } else { 0.0 };
        (screw_n - resistance_n) / parameters.table_mass_kg
    }
}

/// How an axis moves in steps of one length.
#[derive(Clone, Copy, Debug)]
pub struct Stepper {
    step: StepTime,
    touching: Transition,
    /// In the gap of the screw; the same where there is none.
    apart: Transition,
    /// Middle of the gap to its edge, m.
    half_gap_m: f64,
}

impl Stepper {
    /// Steps of `step_s` behind a drive that lags by its time constant (0: not at all).
    #[must_use]
    pub fn new(parameters: &AxisParameters, drive_time_constant_s: f64, step_s: f64) -> Self {
        let masses = Masses {
            motor_kg: parameters.motor_mass_kg,
            table_kg: parameters.table_mass_kg,
            viscous_n_s_per_m: parameters.friction.viscous_n_s_per_m,
        };
        let of_two =
            |spring: Option<&Spring>| Transition::of_two(masses, spring, drive_time_constant_s, step_s);
        let half_gap_m = parameters.screw.backlash.half_m();
        let touching = match &parameters.spring {
            Some(spring) => of_two(Some(spring)),
            None => Transition::of_one(masses, drive_time_constant_s, step_s),
        };
        let has_gap = half_gap_m > 0.0 && parameters.spring.is_some();
        Self {
            step: StepTime::new(step_s),
            touching,
            apart: if has_gap { of_two(None) } else { touching },
            half_gap_m,
        }
    }

    /// One step under a commanded force, N.
    #[inline]
    pub fn step(&self, parameters: &AxisParameters, motion: &mut AxisMotion, force_n: f64) {
        let AxisMotion { motor_m, motor_m_per_s, table_m, table_m_per_s, .. } = *motion;
        let half_s = 0.5 * self.step.seconds;
        let motor_middle_m = motor_m + motor_m_per_s * half_s;
        let friction_n = parameters.motor_friction_n(motor_m_per_s + 0.5 * motion.motor_change);
        let push_n = force_n + parameters.ripple_n(motor_middle_m) - friction_n;
        let lag_n = motion.drive_n - force_n;

        let (linear, offset_m) = if parameters.spring.is_some() {
            self.touch(parameters, motor_middle_m, table_m + table_m_per_s * half_s)
        } else {
            (&self.touching, table_m - motor_m)
        };
        let stretch_m = motor_m - table_m + offset_m;
        let end = linear.end(stretch_m, [motor_m_per_s, table_m_per_s], lag_n, push_n);
        let push_n = self.on_table(parameters, motion, linear, end.to_array());
        let [way_m, stretch_m, motor_end, table_end] = linear.pushed(end, push_n);

        motion.drive_n = force_n + linear.lag_left * lag_n;
        motion.motor_change = motor_end - motor_m_per_s;
        motion.table_change = table_end - table_m_per_s;
        (motion.motor_m_per_s, motion.table_m_per_s) = (motor_end, table_end);
        if parameters.spring.is_some() {
            motion.table_m = table_m + way_m;
            motion.motor_m = motion.table_m + stretch_m - offset_m;
        } else {
            motion.motor_m = motor_m + way_m;
            let nominal_m = parameters.screw.nominal_m(motion.motor_m);
            motion.table_m = parameters.screw.carried_m(nominal_m, table_m);
        }
    }

    /// Whether the screw touches the nut, and what is to be added to motor − table for the stretch of the spring.
    #[inline]
    fn touch(&self, parameters: &AxisParameters, motor_m: f64, table_m: f64) -> (&Transition, f64) {
        let error_m = parameters.screw.error_m(motor_m);
        if self.half_gap_m == 0.0 {
            return (&self.touching, error_m);
        }
        let deflection_m = motor_m + error_m - table_m;
        if deflection_m.abs() <= self.half_gap_m {
            (&self.apart, 0.0)
        } else {
            (&self.touching, error_m - self.half_gap_m.copysign(deflection_m))
        }
    }

    /// Mean push on the table, N, beside the spring: friction of the guide without its viscous part, and load.
    #[inline]
    fn on_table(
        &self,
        parameters: &AxisParameters,
        motion: &mut AxisMotion,
        linear: &Transition,
        end: [f64; 4],
    ) -> f64 {
        let friction = &parameters.friction;
        let about = motion.table_m_per_s + 0.5 * motion.table_change;
        let load_n = parameters.load.force_n + friction.asymmetry.force_n(about);
        if friction.has_bristles() {
            let mean = friction.over(motion.bristle_m, about, linear.mobility, self.step);
            let free = end[0] * self.step.per_second - linear.mobility * load_n;
            motion.friction_n = mean.force_n(free);
            motion.bristle_m = mean.bristle_m(free - linear.mobility * motion.friction_n);
        } else if let Some(force_n) = friction.through_zero_n(about) {
            motion.friction_n = force_n;
        } else {
            // It can stop the table and hold it, but not push it.
            let level_n = friction.level_n(about);
            motion.friction_n = (end[3] * linear.stops_n_s_per_m - load_n).clamp(-level_n, level_n);
        }
        -(motion.friction_n + load_n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::Backlash;
    use crate::plant::friction::Friction;

    fn axis() -> AxisParameters {
        AxisParameters {
            motor_mass_kg: 90.0,
            table_mass_kg: 160.0,
            motor_coulomb_n: 30.0,
            spring: Some(Spring { stiffness_n_per_m: 2e8, damping_n_s_per_m: 1e4 }),
            friction: Friction {
                coulomb_n: 180.0,
                viscous_n_s_per_m: 1000.0,
                bristle_stiffness_n_per_m: 4e7,
                bristle_damping_n_s_per_m: 2000.0,
                ..Friction::default()
            },
            ..AxisParameters::default()
        }
    }

    /// Table in every tick of a push and a pull with a reversal between them, m.
    fn pushed(parameters: &AxisParameters, steps: u32) -> Vec<f64> {
        let stepper = Stepper::new(parameters, 1e-4, 5e-5 / f64::from(steps));
        let mut motion = AxisMotion::default();
        (0..4000)
            .map(|tick| {
                let force_n = 2000.0 * (f64::from(tick) * 5e-5 * 40.0).sin() + 150.0;
                (0..steps).for_each(|_| stepper.step(parameters, &mut motion, force_n));
                motion.table_m
            })
            .collect()
    }

    fn rms_nm(a: &[f64], b: &[f64]) -> f64 {
        let squares: f64 = a.iter().zip(b).map(|(a, b)| (1e9 * (a - b)).powi(2)).sum();
        (squares / a.len() as f64).sqrt()
    }

    /// Of second order: an eighth of the step, a sixty-fourth of the error; between steps it does not fall evenly, for
    /// what bends at a reversal is met at another part of the step.
    #[test]
    fn converges_with_the_square_of_the_step() {
        let fine = pushed(&axis(), 256);
        let [whole, eighth] = [1, 8].map(|steps| rms_nm(&pushed(&axis(), steps), &fine));
        assert!(whole < 20.0, "{whole} nm");
        assert!((32.0..128.0).contains(&(whole / eighth)), "{whole} {eighth}");
    }

    #[test]
    fn a_gap_is_crossed_freely() {
        let mut with_gap = axis();
        with_gap.screw.backlash = Backlash { width_um: 20.0 };
        let fine = pushed(&with_gap, 64);
        let whole = rms_nm(&pushed(&with_gap, 1), &fine);
        // The touch is met to a step: 50 µs at the 3 mm/s of the crossing are 150 nm.
        assert!((0.1..150.0).contains(&whole), "{whole} nm");
    }

    #[test]
    fn a_rigid_mass_stops_and_stays() {
        let parameters = AxisParameters {
            table_mass_kg: 100.0,
            friction: Friction { coulomb_n: 20.0, ..Friction::default() },
            ..AxisParameters::default()
        };
        let stepper = Stepper::new(&parameters, 0.0, 1e-3);
        let mut motion = AxisMotion { motor_m_per_s: -1e-3, table_m_per_s: -1e-3, ..AxisMotion::default() };
        stepper.step(&parameters, &mut motion, 0.0);
        // 20 N on 100 kg over 1 ms: 0.2 mm/s.
        assert!((motion.table_m_per_s + 0.8e-3).abs() < 1e-12);
        (0..9).for_each(|_| stepper.step(&parameters, &mut motion, 0.0));
        assert!(motion.table_m_per_s.abs() < 1e-15);
        // 19 N do not move it.
        let place_m = motion.table_m;
        stepper.step(&parameters, &mut motion, 19.0);
        assert!((motion.table_m - place_m).abs() < 1e-15);
    }

    /// Constant force on one free mass: x = F·t²/2m, to the last digits at any step.
    #[test]
    fn what_is_linear_is_exact() {
        let parameters = AxisParameters { table_mass_kg: 100.0, ..AxisParameters::default() };
        let stepper = Stepper::new(&parameters, 0.0, 1e-2);
        let mut motion = AxisMotion::default();
        (0..100).for_each(|_| stepper.step(&parameters, &mut motion, 50.0));
        assert!((motion.motor_m - 0.25).abs() < 1e-12);
        assert!((motion.table_m_per_s2(&parameters) - 0.5).abs() < 1e-12);
    }
}
