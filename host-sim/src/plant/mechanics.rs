//! Motion of one axis: two masses and a screw, or one rigid mass.
//!
//! A step takes the linear part exactly ([`super::transition`]), however stiff it is, so that it is the friction alone
//! that asks for short steps. Friction is implicit: its mean over the step and the step's mean velocity follow from
//! each other, and both are linear. What depends on positions (gap, errors of the screw, ripple) is taken in the
//! middle of the step. The whole is of second order. Two axes may go beside each other, see [`super::lane`].

use wide::f64x2;

use super::friction::{Bristles, StepTime};
use super::lane::Lane;
use super::parameters::AxisParameters;
use super::screw::Spring;
use super::transition::{Masses, Transition};

/// Positions (m) and velocities (m/s) of the axes of a register.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion<L> {
    /// Motor, true position.
    pub motor_m: L,
    /// Motor.
    pub motor_m_per_s: L,
    /// Table.
    pub table_m: L,
    /// Table.
    pub table_m_per_s: L,
    /// Bend of the guide's bristles.
    pub bristle_m: L,
    /// Force of the drive, N.
    pub drive_n: L,
    /// Friction of the guide without its viscous part, mean of the last step, N.
    pub friction_n: L,
    /// Change of the motor's velocity over the last step, m/s.
    pub motor_change: L,
    /// Change of the table's velocity over the last step, m/s.
    pub table_change: L,
}

/// Of one axis.
pub type AxisMotion = Motion<f64>;

impl<L: Lane> Motion<L> {
    /// The same of other registers, value by value.
    #[inline]
    fn map<M>(of: impl Fn(fn(&Motion<L>) -> L) -> M) -> Motion<M> {
        Motion {
            motor_m: of(|motion| motion.motor_m),
            motor_m_per_s: of(|motion| motion.motor_m_per_s),
            table_m: of(|motion| motion.table_m),
            table_m_per_s: of(|motion| motion.table_m_per_s),
            bristle_m: of(|motion| motion.bristle_m),
            drive_n: of(|motion| motion.drive_n),
            friction_n: of(|motion| motion.friction_n),
            motor_change: of(|motion| motion.motor_change),
            table_change: of(|motion| motion.table_change),
        }
    }
}

impl Motion<f64x2> {
    /// Two axes beside each other.
    #[must_use]
    #[inline]
    pub fn beside(axes: [&AxisMotion; 2]) -> Self {
        AxisMotion::map(|value| f64x2::new(axes.map(value)))
    }

    /// One of the two.
    #[must_use]
    #[inline]
    pub fn axis(&self, axis: usize) -> AxisMotion {
        Self::map(|value| value(self).lane(axis))
    }
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
            let relaxes = friction.relaxes_per_m(friction.level_n(v)) * v.abs();
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

/// What a table slides on.
#[derive(Clone, Copy, Debug)]
struct Guide<L> {
    /// `None`: friction without a presliding state.
    bristles: Option<Bristles<L>>,
    /// [`super::friction::Friction::relaxes_per_m`] where it is the same at every velocity.
    relaxes_per_m: Option<L>,
    load_n: L,
    asymmetry_n_s_per_m: L,
}

impl Stepper<f64> {
    /// Steps of `step_s` behind a drive that lags by its time constant (0: not at all).
    #[must_use]
    pub fn new(parameters: &AxisParameters, drive_time_constant_s: f64, step_s: f64) -> Self {
        let friction = &parameters.friction;
        let masses = Masses {
            motor_kg: parameters.motor_mass_kg,
            table_kg: parameters.table_mass_kg,
            viscous_n_s_per_m: friction.viscous_n_s_per_m,
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
            guide: Guide {
                bristles: friction.has_bristles().then(|| friction.bristles()),
                relaxes_per_m: friction.even_level_n().map(|level_n| friction.relaxes_per_m(level_n)),
                load_n: parameters.load.force_n,
                asymmetry_n_s_per_m: friction.asymmetry.half_difference_n_s_per_m,
            },
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
        let guides = axes.map(|axis| axis.guide);
        let bristles = match guides.map(|guide| guide.bristles) {
            [Some(a), Some(b)] => Some(Bristles {
                stiffness_n_per_m: f64x2::new([a.stiffness_n_per_m, b.stiffness_n_per_m]),
                damping_n_s_per_m: f64x2::new([a.damping_n_s_per_m, b.damping_n_s_per_m]),
            }),
            [None, None] => None,
            _ => return None,
        };
        let relaxes_per_m = match guides.map(|guide| guide.relaxes_per_m) {
            [Some(a), Some(b)] => Some(f64x2::new([a, b])),
            _ => None,
        };
        let touching = Transition::beside(&axes.map(|axis| &axis.touching));
        Some(Self {
            step: axes[0].step,
            touching,
            apart: touching,
            half_gap_m: 0.0,
            guide: Guide {
                bristles,
                relaxes_per_m,
                load_n: f64x2::new(guides.map(|guide| guide.load_n)),
                asymmetry_n_s_per_m: f64x2::new(guides.map(|guide| guide.asymmetry_n_s_per_m)),
            },
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
        let push_n = self.on_table(parameters, motion, linear, end);
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

    /// Mean push on the table, N, beside the spring: friction of the guide without its viscous part, and load.
    #[inline]
    fn on_table(
        &self,
        parameters: &[&AxisParameters],
        motion: &mut Motion<L>,
        linear: &Transition<L>,
        end: [L; 4],
    ) -> L {
        let about = motion.table_m_per_s + L::all(0.5) * motion.table_change;
        let load_n = self.guide.load_n + self.guide.asymmetry_n_s_per_m * about.abs();
        if let Some(bristles) = &self.guide.bristles {
            let relaxes_per_m = self.guide.relaxes_per_m.unwrap_or_else(|| {
                let friction = |axis: usize| &parameters[axis].friction;
                L::of(|axis| friction(axis).relaxes_per_m(friction(axis).level_n(about.lane(axis))))
            });
            let relaxation = relaxes_per_m * about.abs() * L::all(self.step.seconds);
            let mean = bristles.over(motion.bristle_m, relaxation, linear.mobility, self.step);
            let free = end[0] * L::all(self.step.per_second) - linear.mobility * load_n;
            motion.friction_n = mean.force_n(free);
            motion.bristle_m = mean.bristle_m(free - linear.mobility * motion.friction_n);
        } else {
            let holds_n = end[3] * linear.stops_n_s_per_m - load_n;
            motion.friction_n =
                L::of(|axis| parameters[axis].friction.dry_n(about.lane(axis), holds_n.lane(axis)));
        }
        L::all(0.0) - (motion.friction_n + load_n)
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
