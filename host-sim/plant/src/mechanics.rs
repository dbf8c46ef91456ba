//! Motion of one axis: two masses and a screw, or one rigid mass.
//!
//! A step takes the linear part exactly ([`super::transition`]), however stiff it is, so that it is the friction alone
//! that asks for short steps. Friction is implicit: its mean over the step and the step's mean velocity follow from
//! each other, and both are linear. What depends on positions (gap, errors of the screw, ripple) is taken in the
//! middle of the step. The whole is of second order. Two axes may go beside each other, see [`super::lane`].

use wide::f64x2;

use super::friction::StepTime;
use super::guide::{Free, Guide};
use super::lane::Lane;
use super::motion::{AxisMotion, Motion};
use super::parameters::AxisParameters;
use super::screw::Spring;
use super::transition::{Masses, Transition};

/// How the axes of a register move in steps of one length.
#[derive(Clone, Debug)]
pub struct Stepper<L> {
    step: StepTime,
    touching: Transition<L>,
    /// In the gap of the screw; the same where there is none.
    apart: Transition<L>,
    /// Middle of the gap to its edge, m.
    half_gap_m: f64,
    guide: Guide<L>,
    /// Whether nothing but the drive pushes a motor, and the screws are true.
    plain_motor: bool,
    plain_screw: bool,
}

impl Stepper<f64> {
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
            guide: Guide::new(parameters),
            plain_motor: parameters.motor_coulomb_n == 0.0 && parameters.ripple.is_empty(),
            plain_screw: parameters.screw.is_true(),
        }
    }

    /// One step under a commanded force, N.
    #[inline]
    pub fn step(&self, parameters: &AxisParameters, motion: &mut AxisMotion, force_n: f64) {
        let middle_m = motion.motor_m + motion.motor_m_per_s * (0.5 * self.step.seconds);
        if parameters.spring.is_some() {
            let (linear, offset_m) = self.touch(parameters, motion, middle_m);
            self.elastic(&[parameters], motion, force_n, middle_m, linear, offset_m);
        } else {
            self.rigid(parameters, motion, force_n, middle_m);
        }
    }

    fn rigid(&self, parameters: &AxisParameters, motion: &mut AxisMotion, force_n: f64, middle_m: f64) {
        let (motor_m, table_m) = (motion.motor_m, motion.table_m);
        let [way_m, _] = self.push(&[parameters], motion, force_n, middle_m, &self.touching, 0.0);
        motion.motor_m = motor_m + way_m;
        let nominal_m = parameters.screw.nominal_m(motion.motor_m);
        motion.table_m = parameters.screw.carried_m(nominal_m, table_m);
    }

    /// Whether the screw touches the nut, and what is to be added to motor − table for the stretch of the spring.
    #[inline]
    fn touch(
        &self,
        parameters: &AxisParameters,
        motion: &AxisMotion,
        motor_m: f64,
    ) -> (&Transition<f64>, f64) {
        let error_m = parameters.screw.error_m(motor_m);
        if self.half_gap_m == 0.0 {
            return (&self.touching, error_m);
        }
        let table_m = motion.table_m + motion.table_m_per_s * (0.5 * self.step.seconds);
        let deflection_m = motor_m + error_m - table_m;
        if deflection_m.abs() <= self.half_gap_m {
            (&self.apart, 0.0)
        } else {
            (&self.touching, error_m - self.half_gap_m.copysign(deflection_m))
        }
    }

    /// Whether [`Stepper::beside`] may have it: an elastic axis without a gap.
    #[must_use]
    pub fn is_smooth(&self, parameters: &AxisParameters) -> bool {
        parameters.spring.is_some() && self.half_gap_m == 0.0
    }
}

impl Stepper<f64x2> {
    /// Two smooth axes beside each other; `None` where one has bristles and the other has not.
    #[must_use]
    pub fn beside(axes: [&Stepper<f64>; 2]) -> Option<Self> {
        let guide = Guide::beside(axes.map(|axis| axis.guide))?;
        let touching = Transition::beside(&axes.map(|axis| &axis.touching));
        Some(Self {
            step: axes[0].step,
            touching,
            apart: touching,
            half_gap_m: 0.0,
            guide,
            plain_motor: axes.iter().all(|axis| axis.plain_motor),
            plain_screw: axes.iter().all(|axis| axis.plain_screw),
        })
    }

    /// One step of both under their commanded forces, N.
    #[inline]
    pub fn step(&self, parameters: [&AxisParameters; 2], motion: &mut Motion<f64x2>, force_n: f64x2) {
        let middle_m = motion.motor_m + motion.motor_m_per_s * f64x2::splat(0.5 * self.step.seconds);
        let error_m = if self.plain_screw {
            f64x2::ZERO
        } else {
            f64x2::of(|axis| parameters[axis].screw.error_m(middle_m.lane(axis)))
        };
        self.elastic(&parameters, motion, force_n, middle_m, &self.touching, error_m);
    }
}

impl<L: Lane> Stepper<L> {
    /// One step of axes with a spring, to whose motor − table `offset_m` is added for its stretch.
    #[inline]
    fn elastic(
        &self,
        parameters: &[&AxisParameters],
        motion: &mut Motion<L>,
        force_n: L,
        middle_m: L,
        linear: &Transition<L>,
        offset_m: L,
    ) {
        let table_m = motion.table_m;
        let stretch_m = motion.motor_m - table_m + offset_m;
        let [way_m, stretch_m] = self.push(parameters, motion, force_n, middle_m, linear, stretch_m);
        motion.table_m = table_m + way_m;
        motion.motor_m = motion.table_m + stretch_m - offset_m;
    }

    /// Drives and tables pushed over a step: velocities, friction and drive then, and way of the table and stretch.
    #[inline]
    fn push(
        &self,
        parameters: &[&AxisParameters],
        motion: &mut Motion<L>,
        force_n: L,
        middle_m: L,
        linear: &Transition<L>,
        stretch_m: L,
    ) -> [L; 2] {
        let (motor_m_per_s, table_m_per_s) = (motion.motor_m_per_s, motion.table_m_per_s);
        let push_n = self.on_motor(parameters, motion, force_n, middle_m);
        let lag_n = motion.drive_n - force_n;
        let end = linear.end(stretch_m, [motor_m_per_s, table_m_per_s], lag_n, push_n);
        let free = Free {
            mean_m_per_s: end[0] * L::all(self.step.per_second),
            end_m_per_s: end[3],
            mobility: linear.mobility,
            stops_n_s_per_m: linear.stops_n_s_per_m,
        };
        let push_n = self.guide.push_n(parameters, motion, free, self.step);
        let [way_m, stretch_m, motor_end, table_end] = linear.pushed(end, push_n);

        motion.drive_n = force_n + linear.lag_left * lag_n;
        motion.motor_change = motor_end - motor_m_per_s;
        motion.table_change = table_end - table_m_per_s;
        (motion.motor_m_per_s, motion.table_m_per_s) = (motor_end, table_end);
        [way_m, stretch_m]
    }

    /// Mean push on the motor, N: of the drive, its ripple, and its own friction.
    #[inline]
    fn on_motor(&self, parameters: &[&AxisParameters], motion: &Motion<L>, force_n: L, middle_m: L) -> L {
        if self.plain_motor {
            return force_n;
        }
        let about = motion.motor_m_per_s + L::all(0.5) * motion.motor_change;
        let friction_n = L::of(|axis| parameters[axis].motor_friction_n(about.lane(axis)));
        force_n + L::of(|axis| parameters[axis].ripple_n(middle_m.lane(axis))) - friction_n
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::Friction;
    use model::effects::{Backlash, FrictionAsymmetry, PitchCyclic, Stribeck, TorqueRipple};

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
        numerics::rms(a.iter().zip(b).map(|(a, b)| 1e9 * (a - b)))
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

    /// Two axes that differ in all there is, beside each other and each alone: the same to the last bit.
    #[test]
    fn beside_each_other_they_move_as_alone() {
        let mut rough = axis();
        rough.motor_coulomb_n = 0.0;
        rough.screw.cyclic = vec![PitchCyclic { amplitude_um: 2.0, period_mm: 5.0, phase_rad: 0.3 }];
        rough.ripple = vec![TorqueRipple { amplitude_n: 15.0, period_mm: 4.0, phase_rad: 1.0 }];
        rough.load.force_n = 40.0;
        let mut plain = axis();
        (plain.motor_coulomb_n, plain.table_mass_kg) = (0.0, 210.0);
        let mut rising = axis();
        rising.friction.stribeck = Stribeck { static_excess_n: 60.0, velocity_mm_s: 3.0 };
        rising.friction.asymmetry = FrictionAsymmetry { half_difference_n_s_per_m: 90.0 };
        let dry = |mass_kg: f64| {
            let mut dry = AxisParameters { table_mass_kg: mass_kg, ..axis() };
            dry.friction.bristle_stiffness_n_per_m = 0.0;
            dry
        };
        for [a, b] in [
            [rough, plain.clone()],
            [plain.clone(), plain.clone()],
            [rising, axis()],
            [dry(160.0), dry(90.0)],
        ] {
            let alone = [&a, &b].map(|parameters| Stepper::new(parameters, 1e-4, 5e-5));
            let beside = Stepper::beside([&alone[0], &alone[1]]).unwrap();
            let mut one_by_one = [AxisMotion::default(); 2];
            let mut motion = Motion::<f64x2>::beside(one_by_one.each_ref());
            for tick in 0..4000 {
                let force_n = [1.0, -0.7].map(|share| share * 2000.0 * (f64::from(tick) * 5e-5 * 40.0).sin());
                beside.step([&a, &b], &mut motion, f64x2::new(force_n));
                for (axis, (stepper, parameters)) in alone.iter().zip([&a, &b]).enumerate() {
                    stepper.step(parameters, &mut one_by_one[axis], force_n[axis]);
                }
            }
            assert_eq!([motion.axis(0), motion.axis(1)], one_by_one);
            assert!(one_by_one.iter().all(|motion| motion.table_m.abs() > 1e-4), "they moved");
        }
        let alone = [&axis(), &dry(160.0)].map(|parameters| Stepper::new(parameters, 1e-4, 5e-5));
        assert!(Stepper::beside([&alone[0], &alone[1]]).is_none(), "bristles beside none");
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
