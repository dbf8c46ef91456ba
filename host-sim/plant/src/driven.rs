//! The table driven by a motor with given motion; the tracer uses the measured motor.
//!
//! The only unknown is the deflection d = screw − table:
//!
//! ```text
//! m·d'' = m·a + friction + load − k·dz(d) − c·d',
//! ```
//!
//! with the acceleration a of the screw and the dead zone dz. The step is implicit in d and in the bristles: exact at
//! any step where motor and table are in quasi-static balance, and damping the oscillation of the table against a motor
//! that cannot yield. The real motor does yield, by nanometres at the frequency of that oscillation, which the noise of
//! its encoder hides; a step without damping would oscillate where the machine does not.

use super::friction::SlidingState;
use super::parameters::AxisParameters;
use super::presliding::{ExactStep, StepTime};
use super::screw::{Screw, Spring};
use model::effects::{GearHysteresis, LoopState};

/// Motion of the screw at the end of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScrewMotion {
    /// Position of an unloaded table, m; see [`super::screw::Screw::nominal_m`].
    pub nominal_m: f64,
    /// Its mean velocity over the step, m/s.
    pub velocity: f64,
    /// Its acceleration, m/s².
    pub acceleration: f64,
    /// The part of the velocity that is the rate of the pitch error, m/s: the damper is between motor and table, and
    /// this part does not act on it.
    pub error_velocity: f64,
    /// Half of the gap between screw and nut, m.
    pub half_gap_m: f64,
    /// Change of the compliance between screw and table, as a part of it.
    pub compliance_change: f64,
    /// Time on the session clock, s.
    pub time_s: f64,
}

impl ScrewMotion {
    /// At rest with the motor at a true position, m.
    #[must_use]
    #[inline]
    pub fn at(screw: &Screw, motor_m: f64) -> Self {
        Self {
            nominal_m: screw.nominal_m(motor_m),
            half_gap_m: screw.half_gap_m(motor_m),
            compliance_change: screw.compliance(motor_m) - 1.0,
            ..Self::default()
        }
    }
}

/// State of the table, relative to the screw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrivenTable {
    deflection_m: f64,
    deflection_rate: f64,
    bristle_m: f64,
    /// State of the drive train's hysteresis, and the stretch that it has followed.
    hysteresis: LoopState,
    stretch_m: f64,
    filtered_speed_m_per_s: f64,
    /// Position of the table of a rigid screw.
    table_m: f64,
    /// Force of the screw on the table, N.
    pub transmitted_n: f64,
}

impl DrivenTable {
    /// In balance behind a screw that moves steadily, or at rest without any force.
    #[must_use]
    pub fn settled(parameters: &AxisParameters, screw: ScrewMotion) -> Self {
        // Bristles reach their sliding deflection within micrometres; below this speed they may not have done so.
        const MOVING_M_PER_S: f64 = 1e-3;
        let mut table = Self { table_m: screw.nominal_m, ..Self::default() };
        if screw.velocity.abs() < MOVING_M_PER_S {
            return table;
        }
        let friction = &parameters.friction;
        table.filtered_speed_m_per_s = screw.velocity.abs();
        let sliding = table.sliding(screw);
        let level = friction.level_n(screw.velocity, sliding).copysign(screw.velocity);
        if friction.has_bristles() {
            table.bristle_m = level / friction.bristle_stiffness_n_per_m;
        }
        table.transmitted_n = parameters.table_mass_kg * screw.acceleration
            + level
            + friction.viscous_n(screw.velocity, screw.time_s)
            + parameters.load.force_n(screw.nominal_m);
        let gap_m = screw.half_gap_m.copysign(table.transmitted_n);
        if let Some(spring) = &parameters.spring {
            let stiffness = spring.stiffness_n_per_m / (1.0 + screw.compliance_change);
            table.stretch_m = stretch_under(table.transmitted_n, stiffness, &parameters.screw.hysteresis);
            table.hysteresis = parameters.screw.hysteresis.after(LoopState::default(), table.stretch_m);
            table.deflection_m = table.stretch_m + gap_m;
        } else {
            table.table_m -= gap_m;
        }
        table
    }

    /// Deflection of the guide's bristles, m.
    #[must_use]
    pub fn bristle_m(&self) -> f64 {
        self.bristle_m
    }

    /// Low-pass filtered speed, on which friction with memory depends, m/s.
    #[must_use]
    pub fn filtered_speed_m_per_s(&self) -> f64 {
        self.filtered_speed_m_per_s
    }

    /// State of the drive train's hysteresis, and the stretch that it has followed, m.
    #[must_use]
    pub fn hysteresis(&self) -> (LoopState, f64) {
        (self.hysteresis, self.stretch_m)
    }

    fn sliding(&self, screw: ScrewMotion) -> SlidingState {
        SlidingState {
            position_m: screw.nominal_m,
            filtered_speed_m_per_s: self.filtered_speed_m_per_s,
            time_s: screw.time_s,
        }
    }

    /// Position of the table, m, behind the screw of the last step.
    #[must_use]
    pub fn position_m(&self, parameters: &AxisParameters, screw: ScrewMotion) -> f64 {
        if parameters.spring.is_some() { screw.nominal_m - self.deflection_m } else { self.table_m }
    }

    /// One step, at whose end the screw has the given motion.
    #[inline]
    pub fn step(&mut self, step: &DrivenStep<'_>, screw: ScrewMotion) {
        let memory = &step.parameters.friction.memory;
        if memory.remembers() {
            self.filtered_speed_m_per_s +=
                memory.share(step.time.seconds) * (screw.velocity.abs() - self.filtered_speed_m_per_s);
        }
        match step.parameters.spring {
            Some(_) => self.step_elastic(step, screw),
            None => self.step_rigid(step, screw),
        }
    }

    fn step_rigid(&mut self, step: &DrivenStep<'_>, screw: ScrewMotion) {
        let parameters = step.parameters;
        let deflection_m = screw.nominal_m - self.table_m;
        self.table_m = screw.nominal_m - deflection_m.clamp(-screw.half_gap_m, screw.half_gap_m);
        let sliding = self.sliding(screw);
        let friction =
            parameters.friction.step(&mut self.bristle_m, screw.velocity, sliding, step.time.seconds);
        self.transmitted_n = parameters.table_mass_kg * screw.acceleration
            + friction
            + parameters.load.force_n(screw.nominal_m);
    }

    #[inline]
    fn step_elastic(&mut self, step: &DrivenStep<'_>, screw: ScrewMotion) {
        let per_h = step.time.per_second;
        // The mean velocity of the screw over the step, less the rate of the deflection at its beginning.
        let about = screw.velocity - self.deflection_rate;
        let friction = step.friction(self.bristle_m, about, self.sliding(screw));
        // All forces but that of the screw are explicit_n − inertia·d.
        let inertia = step.mass_per_h2 + friction.slope_n_s_per_m * per_h;
        let explicit_n = step.mass * screw.acceleration
            + step.mass_per_h2 * self.deflection_m
            + step.mass_per_h * self.deflection_rate
            + friction.offset_n
            + friction.slope_n_s_per_m * (screw.velocity + self.deflection_m * per_h)
            + step.parameters.load.force_n(screw.nominal_m);
        let stiffness = step.stiffness / (1.0 + screw.compliance_change);
        let in_gap = explicit_n.abs() <= screw.half_gap_m * inertia;
        let gap_m = screw.half_gap_m.copysign(explicit_n);
        // Behind a hysteresis of offset_n + slope·(stretch − stretch before).
        let behind = |hysteresis: LoopForce| {
            (explicit_n - hysteresis.offset_n
                + hysteresis.slope_n_per_m * (gap_m + self.stretch_m)
                + stiffness * gap_m
                + step.damping_per_h * self.deflection_m
                + step.damping * screw.error_velocity)
                / (inertia + stiffness + hysteresis.slope_n_per_m + step.damping_per_h)
        };
        let mut loop_n = 0.0;
        let deflection = if in_gap {
            (self.hysteresis, self.stretch_m) = (LoopState::default(), 0.0);
            explicit_n / inertia
        } else if step.has_hysteresis {
            // The slope of the loop to where the step ends without a loop, and then to where it ends with this slope.
            let hysteresis = &step.parameters.screw.hysteresis;
            let to = |stretch_m: f64| LoopForce::to(hysteresis, (self.hysteresis, self.stretch_m), stretch_m);
            let mut end_m = behind(LoopForce::constant(hysteresis, self.hysteresis));
            for _ in 0..LOOP_ITERATIONS {
                end_m = behind(to(end_m - gap_m));
            }
            (self.hysteresis, self.stretch_m) =
                (hysteresis.after(self.hysteresis, end_m - gap_m - self.stretch_m), end_m - gap_m);
            loop_n = hysteresis.carried_n(self.hysteresis);
            end_m
        } else {
            behind(LoopForce::default())
        };
        let rate = (deflection - self.deflection_m) * per_h;
        self.bristle_m =
            friction.bristles.bristle_m(self.bristle_m, screw.velocity - rate, step.time.seconds);
        self.transmitted_n = if in_gap {
            0.0
        } else {
            stiffness * (deflection - gap_m) + loop_n + step.damping * (rate - screw.error_velocity)
        };
        self.deflection_m = deflection;
        self.deflection_rate = rate;
    }
}

/// The constants of all steps of one length.
#[derive(Clone, Debug)]
pub struct DrivenStep<'a> {
    parameters: &'a AxisParameters,
    time: StepTime,
    mass: f64,
    mass_per_h: f64,
    mass_per_h2: f64,
    stiffness: f64,
    damping: f64,
    damping_per_h: f64,
    has_hysteresis: bool,
}

impl<'a> DrivenStep<'a> {
    /// Steps of `step_s` of an axis.
    #[must_use]
    pub fn new(parameters: &'a AxisParameters, step_s: f64) -> Self {
        let of_spring = |value: fn(&Spring) -> f64| parameters.spring.as_ref().map_or(0.0, value);
        let (mass, time) = (parameters.table_mass_kg, StepTime::new(step_s));
        let per_h = time.per_second;
        let damping = of_spring(|spring| spring.damping_n_s_per_m);
        Self {
            parameters,
            time,
            mass,
            mass_per_h: mass * per_h,
            mass_per_h2: mass * per_h * per_h,
            stiffness: of_spring(|spring| spring.stiffness_n_per_m),
            damping,
            damping_per_h: damping * per_h,
            has_hysteresis: parameters.screw.hysteresis.acts(),
        }
    }

    /// Steps per second.
    #[must_use]
    pub const fn per_second(&self) -> f64 {
        self.time.per_second
    }

    /// Friction of the step about a velocity, m/s.
    #[inline]
    fn friction(&self, bristle_m: f64, about: f64, sliding: SlidingState) -> StepFriction {
        let friction = &self.parameters.friction;
        let viscous = friction.viscous_n_s_per_m;
        let beyond_linear_n = friction.beyond_linear_n(about, sliding.time_s);
        if !friction.has_bristles() {
            let mut no_bristle_m = 0.0;
            let dry_n = friction.step(&mut no_bristle_m, about, sliding, self.time.seconds)
                - friction.viscous_n(about, sliding.time_s);
            let bristles = ExactStep::default();
            return StepFriction { offset_n: dry_n + beyond_linear_n, slope_n_s_per_m: viscous, bristles };
        }
        let level_n = friction.level_n(about, sliding);
        let bristles = friction.bristles().exact_step(bristle_m, about, level_n, self.time);
        StepFriction {
            offset_n: bristles.offset_n + beyond_linear_n,
            slope_n_s_per_m: bristles.slope_n_s_per_m + viscous,
            bristles,
        }
    }
}

/// Iterations of the slope of a hysteresis over a step. Each leaves of the error at most the part of the loop's stiffness in that of spring and inertia.
const LOOP_ITERATIONS: usize = 3;

/// Force of a hysteresis over one step as offset + slope·(stretch − stretch before).
#[derive(Clone, Copy, Default)]
struct LoopForce {
    offset_n: f64,
    slope_n_per_m: f64,
}

impl LoopForce {
    /// That of a state which does not change.
    fn constant(hysteresis: &GearHysteresis, state: LoopState) -> Self {
        Self { offset_n: hysteresis.carried_n(state), slope_n_per_m: 0.0 }
    }

    /// The one that is exact at a stretch, m, from a state and the stretch that it has followed.
    fn to(hysteresis: &GearHysteresis, (state, from_m): (LoopState, f64), stretch_m: f64) -> Self {
        let moved_m = stretch_m - from_m;
        let change_n = hysteresis.carried_n(hysteresis.after(state, moved_m)) - hysteresis.carried_n(state);
        let slope_n_per_m = if moved_m == 0.0 { 0.0 } else { change_n / moved_m };
        Self { slope_n_per_m, ..Self::constant(hysteresis, state) }
    }
}

/// Stretch of a drive train that was loaded from nothing by a force, m: k·s + force·z(s) = F, by Newton's method. F/k is beyond the root, and the function
/// bends downwards: after the first step, all are on one side of the root.
fn stretch_under(force_n: f64, stiffness_n_per_m: f64, hysteresis: &GearHysteresis) -> f64 {
    const STEPS: usize = 12;
    let rigid_m = force_n / stiffness_n_per_m;
    if !hysteresis.acts() {
        return rigid_m;
    }
    (0..STEPS).fold(rigid_m, |stretch_m, _| {
        let loop_n = hysteresis.carried_n(hysteresis.after(LoopState::default(), stretch_m));
        let slope = stiffness_n_per_m + hysteresis.sticking_n_per_m(stretch_m);
        stretch_m - (stiffness_n_per_m * stretch_m + loop_n - force_n) / slope
    })
}

/// Whole friction over one step as offset + slope·v, with the mean velocity v of the step (m/s).
struct StepFriction {
    offset_n: f64,
    slope_n_s_per_m: f64,
    bristles: ExactStep,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::friction::Friction;
    use model::effects::Backlash;
    use model::position_curve::PositionCurve;

    fn axis() -> AxisParameters {
        AxisParameters {
            table_mass_kg: 200.0,
            spring: Some(Spring { stiffness_n_per_m: 200e6, damping_n_s_per_m: 1e4 }),
            friction: Friction {
                coulomb_n: 200.0,
                viscous_n_s_per_m: 1000.0,
                bristle_stiffness_n_per_m: 4e7,
                bristle_damping_n_s_per_m: 2000.0,
                ..Friction::default()
            },
            ..AxisParameters::default()
        }
    }

    /// Screw − table, m, at 20 mm/s after more than 1 mm of travel forwards, and backwards.
    fn lag(parameters: &AxisParameters) -> (f64, f64) {
        let h = 5e-4;
        let mut table = DrivenTable::default();
        let mut screw = ScrewMotion::default();
        let step = DrivenStep::new(parameters, h);
        let mut lags = (0.0, 0.0);
        for (velocity, steps) in [(0.02, 100), (-0.02, 200), (0.02, 200)] {
            for _ in 0..steps {
                let nominal_m = screw.nominal_m + velocity * h;
                screw = ScrewMotion { velocity, ..ScrewMotion::at(&parameters.screw, nominal_m) };
                table.step(&step, screw);
            }
            let lag = screw.nominal_m - table.position_m(parameters, screw);
            if velocity > 0.0 { lags.0 = lag } else { lags.1 = lag }
        }
        lags
    }

    #[test]
    fn stretches_by_friction_over_stiffness() {
        // (200 N + 1000 N·s/m · 0.02 m/s)/200 N/µm = 1.1 µm in either direction.
        let (forwards, backwards) = lag(&axis());
        assert!(
            (forwards - 1.1e-6).abs() < 1e-9 && (backwards + 1.1e-6).abs() < 1e-9,
            "{forwards:e} {backwards:e}"
        );
    }

    /// 40 % more of the 1.1 µm of the spring.
    #[test]
    fn stretches_more_where_the_drive_train_is_softer() {
        let mut softer = axis();
        softer.screw.compliance_map = PositionCurve::new(&[-1.0, 1.0], &[0.4, 0.4]);
        let (forwards, backwards) = lag(&softer);
        assert!(
            (forwards - 1.54e-6).abs() < 1e-9 && (backwards + 1.54e-6).abs() < 1e-9,
            "{forwards:e} {backwards:e}"
        );
    }

    /// Spring and loop together carry the 220 N of friction, in either direction: 200 N/µm of the stretch, and of 40 N what eight elements carry after its history, each of which
    /// slips at its own stretch.
    #[test]
    fn a_loop_carries_what_its_history_says() {
        const SLIPS_AT_M: [f64; 8] =
            [0.2020e-6, 0.3950e-6, 0.5660e-6, 0.7430e-6, 0.9435e-6, 1.1905e-6, 1.5400e-6, 2.2360e-6];
        let mut gear = axis();
        gear.screw.hysteresis = GearHysteresis { force_n: 40.0, travel_um: 0.5 };
        let h = 5e-4;
        let step = DrivenStep::new(&gear, h);
        let (mut table, mut screw) = (DrivenTable::default(), ScrewMotion::default());
        let (mut elements, mut before_m) = ([0.0_f64; 8], 0.0);
        for (velocity, steps) in [(0.02, 100), (-0.02, 200), (0.02, 200)] {
            for _ in 0..steps {
                let nominal_m = screw.nominal_m + velocity * h;
                screw = ScrewMotion { velocity, ..ScrewMotion::at(&gear.screw, nominal_m) };
                table.step(&step, screw);
                let stretch_m = screw.nominal_m - table.position_m(&gear, screw);
                for (element, slips_at_m) in elements.iter_mut().zip(SLIPS_AT_M) {
                    *element = (*element + (stretch_m - before_m) / slips_at_m).clamp(-1.0, 1.0);
                }
                before_m = stretch_m;
            }
            let z = elements.iter().sum::<f64>() / 8.0;
            let carried_n = 200e6 * before_m + 40.0 * z;
            assert!((carried_n - 220f64.copysign(velocity)).abs() < 0.2, "{carried_n} {z}");
            assert!(40.0 * z.abs() > 4.0, "{z}");
        }
    }

    #[test]
    fn backlash_adds_half_its_width_in_either_direction() {
        let mut with_gap = axis();
        with_gap.screw.backlash = Backlash { width_um: 10.0 };
        let (forwards, backwards) = lag(&with_gap);
        // Half the gap on either side, and the stretch.
        assert!(
            (forwards - 6.1e-6).abs() < 1e-9 && (backwards + 6.1e-6).abs() < 1e-9,
            "{forwards:e} {backwards:e}"
        );
    }
}
