//! Motion of one axis over a step: motor and table on an elastic screw, or one rigid mass.
//!
//! A step takes the linear part exactly ([`super::transition`]), however stiff it is, so that the friction alone
//! requires short steps. Friction is implicit: its mean over the step and the mean velocity of the step follow from two
//! linear equations ([`super::guide`]). What depends on positions (backlash, pitch errors, ripple) is evaluated in the
//! middle of the step. The whole is of second order in the step. Two axes can be moved at once, see [`super::lane`].

use model::effects::LoopState;
use wide::f64x2;

use super::axis_motion::AxisMotion;
use super::following::HEAVIEST_KG;
use super::guide::{FreeStep, Guide};
use super::lane::Lane;
use super::parameters::AxisParameters;
use super::presliding::StepTime;
use super::screw::Spring;
use super::transition::{Masses, Transition};

/// Steps of one length of the axes of a register.
#[derive(Clone, Debug)]
pub struct Stepper<L> {
    step: StepTime,
    /// Screw and nut in contact.
    in_contact: Transition<L>,
    /// The nut within the gap of the screw; `None`: there is no gap.
    in_gap: Option<Transition<L>>,
    /// Whether screw and nut are always in contact, with the same stiffness everywhere.
    is_coupling_constant: bool,
    guide: Guide<L>,
    /// Whether the motors have neither friction nor ripple.
    is_motor_ideal: bool,
    /// Whether the screws have no pitch errors.
    is_screw_exact: bool,
}

/// What acts on the axes of a register over a step.
#[derive(Clone, Copy)]
struct StepInput<'a, L> {
    parameters: &'a [&'a AxisParameters],
    /// Commanded force of the drives, N.
    force_n: L,
    /// True position of the motors in the middle of the step, m.
    middle_m: L,
}

/// How the screws couple motors and tables over a step.
#[derive(Clone, Copy)]
struct Coupling<'a, L> {
    transition: &'a Transition<L>,
    /// Stretch of the spring of constant stiffness − (motor − table), m: pitch error, edge of the backlash, and by what it yields more.
    offset_m: L,
}

impl Stepper<f64> {
    /// Steps of `step_s` behind a drive with a first-order lag; time constant 0: no lag.
    #[must_use]
    pub fn new(parameters: &AxisParameters, drive_time_constant_s: f64, step_s: f64) -> Self {
        let masses = Masses {
            motor_kg: parameters.motor_mass_kg.min(HEAVIEST_KG),
            table_kg: parameters.table_mass_kg,
            viscous_n_s_per_m: parameters.friction.viscous_n_s_per_m,
        };
        let two_masses =
            |spring: Option<&Spring>| Transition::two_masses(masses, spring, drive_time_constant_s, step_s);
        let in_contact = match &parameters.spring {
            Some(spring) => two_masses(Some(spring)),
            None => Transition::one_mass(masses, drive_time_constant_s, step_s),
        };
        let has_gap = parameters.screw.has_gap() && parameters.spring.is_some();
        Self {
            step: StepTime::new(step_s),
            in_contact,
            in_gap: has_gap.then(|| two_masses(None)),
            is_coupling_constant: parameters.screw.is_coupling_constant(),
            guide: Guide::new(parameters),
            is_motor_ideal: !parameters.has_motor_friction()
                && parameters.motor_turning_n == 0.0
                && parameters.ripple.is_empty(),
            is_screw_exact: parameters.screw.is_exact(),
        }
    }

    /// One step under a commanded force, N.
    #[inline]
    pub fn step(&self, parameters: &AxisParameters, motion: &mut AxisMotion, force_n: f64) {
        let middle_m = motion.motor_m + motion.motor_m_per_s * (0.5 * self.step.seconds);
        let input = StepInput { parameters: &[parameters], force_n, middle_m };
        if parameters.spring.is_some() {
            let coupling = self.coupling(parameters, motion, middle_m);
            self.elastic(motion, input, coupling);
        } else {
            self.rigid(parameters, motion, input);
        }
    }

    fn rigid(&self, parameters: &AxisParameters, motion: &mut AxisMotion, input: StepInput<f64>) {
        let (motor_m, table_m) = (motion.motor_m, motion.table_m);
        let [travel_m, _] = self.apply(motion, input, &self.in_contact, 0.0);
        motion.motor_m = motor_m + travel_m;
        let nominal_m = parameters.screw.nominal_m(motion.motor_m);
        motion.table_m = parameters.screw.rigid_table_m(motion.motor_m, nominal_m, table_m);
    }

    /// Whether screw and nut are in contact in the middle of the step, and the offset of the spring. The hysteresis follows the stretch there.
    #[inline]
    fn coupling(
        &self,
        parameters: &AxisParameters,
        motion: &mut AxisMotion,
        middle_m: f64,
    ) -> Coupling<'_, f64> {
        let error_m = parameters.screw.error_m(middle_m);
        if self.is_coupling_constant {
            return Coupling { transition: &self.in_contact, offset_m: error_m };
        }
        let table_m = motion.table_m + motion.table_m_per_s * (0.5 * self.step.seconds);
        let deflection_m = middle_m + error_m - table_m;
        let is_in_gap = |_: &&_| deflection_m.abs() <= parameters.screw.half_gap_m(middle_m);
        if let Some(transition) = self.in_gap.as_ref().filter(is_in_gap) {
            (motion.stretch_m, motion.hysteresis) = (0.0, LoopState::default());
            return Coupling { transition, offset_m: 0.0 };
        }
        let offset_m = error_m - parameters.screw.yielded_m(middle_m, deflection_m);
        let stretch_m = deflection_m - parameters.screw.absorbed_m(middle_m, deflection_m);
        let loop_m = hysteresis_m(parameters, motion, stretch_m);
        Coupling { transition: &self.in_contact, offset_m: offset_m + loop_m }
    }

    /// Whether [`Stepper::pair`] accepts the axis: it has a spring of the same stiffness everywhere, and no backlash.
    #[must_use]
    pub fn can_be_paired(&self, parameters: &AxisParameters) -> bool {
        parameters.spring.is_some() && self.is_coupling_constant
    }
}

impl Stepper<f64x2> {
    /// Two axes in one register, both of which [can be paired](Stepper::can_be_paired); `None` if only one of them
    /// has bristles.
    #[must_use]
    pub fn pair(axes: [&Stepper<f64>; 2]) -> Option<Self> {
        let guide = Guide::pair(axes.map(|axis| axis.guide))?;
        let in_contact = Transition::joined(&axes.map(|axis| &axis.in_contact));
        Some(Self {
            step: axes[0].step,
            in_contact,
            in_gap: None,
            is_coupling_constant: true,
            guide,
            is_motor_ideal: axes.iter().all(|axis| axis.is_motor_ideal),
            is_screw_exact: axes.iter().all(|axis| axis.is_screw_exact),
        })
    }

    /// One step of both under their commanded forces, N.
    #[inline]
    pub fn step(&self, parameters: [&AxisParameters; 2], motion: &mut AxisMotion<f64x2>, force_n: f64x2) {
        let middle_m = motion.motor_m + motion.motor_m_per_s * f64x2::splat(0.5 * self.step.seconds);
        let offset_m = if self.is_screw_exact {
            f64x2::ZERO
        } else {
            f64x2::of(|axis| parameters[axis].screw.error_m(middle_m.lane(axis)))
        };
        let input = StepInput { parameters: &parameters, force_n, middle_m };
        self.elastic(motion, input, Coupling { transition: &self.in_contact, offset_m });
    }
}

impl<L: Lane> Stepper<L> {
    /// One step of axes with a spring.
    #[inline]
    fn elastic(&self, motion: &mut AxisMotion<L>, input: StepInput<L>, coupling: Coupling<L>) {
        let Coupling { transition, offset_m } = coupling;
        let table_m = motion.table_m;
        let stretch_m = motion.motor_m - table_m + offset_m;
        let [travel_m, stretch_m] = self.apply(motion, input, transition, stretch_m);
        motion.table_m = table_m + travel_m;
        motion.motor_m = motion.table_m + stretch_m - offset_m;
    }

    /// Applies all forces of a step: updates velocities, friction and drive; gives travel of the table and stretch of
    /// the spring at the end, m.
    #[inline]
    fn apply(
        &self,
        motion: &mut AxisMotion<L>,
        input: StepInput<L>,
        transition: &Transition<L>,
        stretch_m: L,
    ) -> [L; 2] {
        let StepInput { parameters, force_n, .. } = input;
        let (motor_m_per_s, table_m_per_s) = (motion.motor_m_per_s, motion.table_m_per_s);
        let on_motor_n = self.on_motor_n(motion, input);
        let lag_n = motion.drive_n - force_n;
        let end = transition.end(stretch_m, [motor_m_per_s, table_m_per_s], lag_n, on_motor_n);
        let free = FreeStep {
            mean_m_per_s: end[0] * L::all(self.step.per_second),
            end_m_per_s: end[3],
            mobility: transition.mobility,
            stopping_n_s_per_m: transition.stopping_n_s_per_m,
        };
        let on_table_n = self.guide.force_n(parameters, motion, free, self.step);
        let [travel_m, stretch_m, motor_end, table_end] = transition.with_table_force(end, on_table_n);

        if !self.is_motor_ideal {
            let half_s = L::all(0.5 * self.step.seconds);
            motion.motor_direction = turned(parameters, motion, half_s * (motor_m_per_s + motor_end));
        }
        motion.drive_n = force_n + transition.lag_left * lag_n;
        motion.motor_change = motor_end - motor_m_per_s;
        motion.table_change = table_end - table_m_per_s;
        (motion.motor_m_per_s, motion.table_m_per_s) = (motor_end, table_end);
        [travel_m, stretch_m]
    }

    /// Mean force on the motor, N: commanded force and ripple, less friction at the extrapolated velocity in the middle
    /// of the step.
    #[inline]
    fn on_motor_n(&self, motion: &AxisMotion<L>, input: StepInput<L>) -> L {
        let StepInput { parameters, force_n, middle_m } = input;
        if self.is_motor_ideal {
            return force_n;
        }
        let about = motion.motor_m_per_s + L::all(0.5) * motion.motor_change;
        let direction = turned(parameters, motion, L::all(0.5 * self.step.seconds) * about);
        let friction_n = L::of(|axis| {
            let turning_n = parameters[axis].motor_turning_n * direction.lane(axis);
            parameters[axis].motor_friction_n(about.lane(axis)) + turning_n
        });
        force_n + L::of(|axis| parameters[axis].torque_ripple_n(middle_m.lane(axis))) - friction_n
    }
}

/// Stretch of the spring that would carry what its hysteresis does after it has come to a stretch, m.
fn hysteresis_m(parameters: &AxisParameters, motion: &mut AxisMotion, stretch_m: f64) -> f64 {
    let hysteresis = &parameters.screw.hysteresis;
    let Some(spring) = parameters.spring.as_ref().filter(|_| hysteresis.acts()) else { return 0.0 };
    motion.hysteresis = hysteresis.after(motion.hysteresis, stretch_m - motion.stretch_m);
    motion.stretch_m = stretch_m;
    hysteresis.carried_n(motion.hysteresis) / spring.stiffness_n_per_m
}

/// Direction of the motors' friction that turns over, after a travel, m.
fn turned<L: Lane>(parameters: &[&AxisParameters], motion: &AxisMotion<L>, travel_m: L) -> L {
    L::of(|axis| parameters[axis].motor_direction(motion.motor_direction.lane(axis), travel_m.lane(axis)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::Friction;
    use model::effects::{
        Backlash, FrictionAsymmetry, GearHysteresis, PeriodicError, PositionLoad, Stribeck, TorqueRipple,
    };
    use model::position_curve::PositionCurve;

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

    /// Position of the table after every tick under a sinusoidal force, which reverses the motion, m.
    fn positions(parameters: &AxisParameters, steps: u32) -> Vec<f64> {
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

    /// Second order: an eighth of the step, a sixty-fourth of the error. Between these steps the error does not fall
    /// evenly, since a reversal lies in another part of a step each time.
    #[test]
    fn converges_with_the_square_of_the_step() {
        let fine = positions(&axis(), 256);
        let [error, of_eighth] = [1, 8].map(|steps| rms_nm(&positions(&axis(), steps), &fine));
        assert!(error < 20.0, "{error} nm");
        assert!((32.0..128.0).contains(&(error / of_eighth)), "{error} {of_eighth}");
    }

    /// In steady motion under 280 N, spring and loop carry the 280 N of the friction of the table: 200 N/µm of the stretch, and of 40 N what eight elements carry
    /// after its history, each of which slips at its own stretch.
    #[test]
    fn a_loop_carries_what_its_history_says() {
        const SLIPS_AT_M: [f64; 8] =
            [0.2020e-6, 0.3950e-6, 0.5660e-6, 0.7430e-6, 0.9435e-6, 1.1905e-6, 1.5400e-6, 2.2360e-6];
        let mut parameters = axis();
        parameters.motor_coulomb_n = 0.0;
        parameters.screw.hysteresis = GearHysteresis { force_n: 40.0, travel_um: 0.5 };
        let stepper = Stepper::new(&parameters, 0.0, 2e-5);
        let mut motion = AxisMotion::default();
        let (mut elements, mut before_m) = ([0.0_f64; 8], 0.0);
        for force_n in [280.0, -280.0, 280.0] {
            for _ in 0..100_000 {
                stepper.step(&parameters, &mut motion, force_n);
                let stretch_m = motion.motor_m - motion.table_m;
                for (element, slips_at_m) in elements.iter_mut().zip(SLIPS_AT_M) {
                    *element = (*element + (stretch_m - before_m) / slips_at_m).clamp(-1.0, 1.0);
                }
                before_m = stretch_m;
            }
            let z = elements.iter().sum::<f64>() / 8.0;
            let carried_n = 2e8 * before_m + 40.0 * z;
            assert!((carried_n - force_n).abs() < 0.3, "{carried_n} {z} {motion:?}");
            assert!(40.0 * z.abs() > 4.0, "{z}");
        }
    }

    /// Where the spring is softer, the resonance of motor and table is slower by the square root: of free masses m and M on a spring of
    /// k/1.44, √(k·(1/m + 1/M))/1.2. The coupling in the middle of a step is of second order, (ω·h)²/24 = 0.04 % of ω.
    #[test]
    fn a_softer_spring_oscillates_slower() {
        let mut parameters = AxisParameters {
            motor_mass_kg: 90.0,
            table_mass_kg: 160.0,
            spring: Some(Spring { stiffness_n_per_m: 2e8, damping_n_s_per_m: 0.0 }),
            ..AxisParameters::default()
        };
        parameters.screw.compliance_map = PositionCurve::new(&[-1.0, 1.0], &[0.44, 0.44]);
        let stepper = Stepper::new(&parameters, 0.0, 5e-5);
        let mut motion = AxisMotion { motor_m: 1e-5, ..AxisMotion::default() };
        let stretches: Vec<f64> = (0..4000)
            .map(|_| {
                stepper.step(&parameters, &mut motion, 0.0);
                motion.motor_m - motion.table_m
            })
            .collect();
        let rises = stretches.windows(2).filter(|two| two[0] < 0.0 && two[1] >= 0.0).count();
        // 0.2 s of 262.1 Hz/1.2; a count of whole periods is off by less than one.
        let expected = 0.2 * (2e8_f64 * (1.0 / 90.0 + 1.0 / 160.0)).sqrt() / std::f64::consts::TAU / 1.2;
        assert!((rises as f64 - expected).abs() < 1.0, "{rises} {expected}");
        // Nothing damps or drives it.
        let largest = |part: &[f64]| part.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let kept = largest(&stretches[3800..]) / largest(&stretches[..200]);
        assert!((0.98..1.02).contains(&kept), "{kept}");
    }

    #[test]
    fn backlash_is_crossed_without_force() {
        let mut with_gap = axis();
        with_gap.screw.backlash = Backlash { width_um: 20.0 };
        let fine = positions(&with_gap, 64);
        let error = rms_nm(&positions(&with_gap, 1), &fine);
        // The contact is found to one step: 50 µs at the 3 mm/s of the crossing are 150 nm.
        assert!((0.1..150.0).contains(&error), "{error} nm");
    }

    /// A friction that turns over within s yields under a force F below it until 1 − e^(−x/s) = F/friction: under half of it by ln 2 of 5 µm.
    /// The force rises within a second, so that the mass oscillates by less than 2.5 µm/(√(1 m/s²/5 µm)·1 s) = 6 nm about it.
    #[test]
    fn a_friction_that_turns_over_yields() {
        let parameters =
            AxisParameters { motor_mass_kg: 1000.0, motor_turning_n: 1000.0, ..AxisParameters::default() };
        let stepper = Stepper::new(&parameters, 0.0, 1e-4);
        let mut motion = AxisMotion::default();
        (0..10_000).for_each(|i| stepper.step(&parameters, &mut motion, 0.05 * f64::from(i)));
        let exact_m = 5e-6 * 2.0_f64.ln();
        assert!((motion.motor_m - exact_m).abs() < 12e-9, "{}", motion.motor_m);
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
        let position_m = motion.table_m;
        stepper.step(&parameters, &mut motion, 19.0);
        assert!((motion.table_m - position_m).abs() < 1e-15);
    }

    /// Two axes with different parameters, as a pair and each alone: the same to the last bit.
    #[test]
    fn a_pair_moves_as_its_axes_do_alone() {
        let mut rough = axis();
        rough.motor_coulomb_n = 0.0;
        rough.screw.periodic = vec![PeriodicError { amplitude_um: 2.0, period_mm: 5.0, phase_rad: 0.3 }];
        let (period_mm, phase_rad) = (4.0, 1.0);
        rough.ripple = vec![TorqueRipple { amplitude_n: 15.0, period_mm, phase_rad, fitted_period_mm: None }];
        rough.load.constant.force_n = 40.0;
        rough.load.position = Some(PositionLoad { slope_n_per_m: 900.0, ..PositionLoad::default() });
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
            let pair = Stepper::pair([&alone[0], &alone[1]]).unwrap();
            let mut one_by_one = [AxisMotion::default(); 2];
            let mut motion = AxisMotion::<f64x2>::pair(one_by_one.each_ref());
            for tick in 0..4000 {
                let force_n =
                    [1.0, -0.7].map(|factor| factor * 2000.0 * (f64::from(tick) * 5e-5 * 40.0).sin());
                pair.step([&a, &b], &mut motion, f64x2::new(force_n));
                for (axis, (stepper, parameters)) in alone.iter().zip([&a, &b]).enumerate() {
                    stepper.step(parameters, &mut one_by_one[axis], force_n[axis]);
                }
            }
            assert_eq!([motion.axis(0), motion.axis(1)], one_by_one);
            assert!(one_by_one.iter().all(|motion| motion.table_m.abs() > 1e-4), "they moved");
        }
        let alone = [&axis(), &dry(160.0)].map(|parameters| Stepper::new(parameters, 1e-4, 5e-5));
        assert!(Stepper::pair([&alone[0], &alone[1]]).is_none(), "one has bristles and the other has none");
    }

    /// Constant force on one free mass: x = F·t²/2m, to the last digits with any step.
    #[test]
    fn linear_motion_is_exact() {
        let parameters = AxisParameters { table_mass_kg: 100.0, ..AxisParameters::default() };
        let stepper = Stepper::new(&parameters, 0.0, 1e-2);
        let mut motion = AxisMotion::default();
        (0..100).for_each(|_| stepper.step(&parameters, &mut motion, 50.0));
        assert!((motion.motor_m - 0.25).abs() < 1e-12);
        assert!((motion.table_m_per_s2(&parameters) - 0.5).abs() < 1e-12);
    }
}
