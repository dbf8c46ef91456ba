//! The physical parameters of an axis: its keys of the machine file in SI units, and its effects sorted by where they
//! act.

use model::axis::Mechanics;
use model::bodies;
use model::effects::{
    Channel, DriveAsymmetry, Effect, ForceWindup, InertialWindup, Latency, LostMotion, MotorStribeck,
    PeriodicError, TorqueRipple,
};
use model::machine::{Axis, Machine};
use model::servo::ServoParameters;

use super::friction::{self, Friction};
use super::friction_direction::{self, DRIVE_SLIP_M};
use super::load::Load;
use super::residuals::Residuals;
use super::scale::Scale;
use super::screw::{Screw, Spring};
use super::stepper::Stepper;
use super::tool_parameters::ToolParameters;

/// Stretch of a drive train that is practically rigid, m per m/s²: 1 nm under 1 m/s².
const LEAST_STRETCH_S2: f64 = 1e-9;

/// Damping ratio of a drive train of which nothing is known.
const DRIVE_TRAIN_DAMPING: f64 = 0.05;

/// The parameters of one axis, SI. Motor quantities are reflected to the table by the lead.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisParameters {
    /// Inertia of the motor side.
    pub motor_mass_kg: f64,
    /// Mass of the table side.
    pub table_mass_kg: f64,
    /// Coulomb friction of the motor and its bearings.
    pub motor_coulomb_n: f64,
    /// Rise of the motor's friction towards standstill.
    pub motor_stribeck: MotorStribeck,
    /// Friction of a drive whose velocity is commanded, as a trace has fitted it, N. It turns over with the travel.
    pub motor_turning_n: f64,
    /// Pitch errors and backlash between motor and table.
    pub screw: Screw,
    /// Elasticity between motor and table; `None`: motor and table are one rigid mass.
    pub spring: Option<Spring>,
    /// Wind-up under the measured force, for an axis whose masses are not known. Not simulated.
    pub forced_windup: Option<ForceWindup>,
    /// Wind-up under acceleration, for an axis whose masses and stiffness are not known. Not simulated.
    pub inertial_windup: InertialWindup,
    /// Gap and stretch under friction together, of such an axis. What is simulated of it is in `screw`, `spring` and `friction`.
    pub lost_motion: LostMotion,
    /// Errors of a stepper motor. Not simulated.
    pub stepper: Stepper,
    /// Friction of the guideway.
    pub friction: Friction,
    /// Forces on the table that do not depend on its motion.
    pub load: Load,
    /// Force ripple of the motor.
    pub ripple: Vec<TorqueRipple>,
    /// Errors of the motor's resolver or encoder.
    pub resolver: Vec<PeriodicError>,
    /// Difference of the drive's gain between both directions.
    pub drive_asymmetry: DriveAsymmetry,
    /// Errors of the linear scale.
    pub scale: Scale,
    /// Effects between table and tool.
    pub tool: ToolParameters,
    /// Effects in the controller.
    pub servo: ServoParameters,
    /// Latencies of the logged channels.
    pub latency: Vec<Latency>,
    /// Residuals of the logged channels that no effect describes.
    pub residuals: Residuals,
}

impl AxisParameters {
    /// All axes of a machine file, in its order. Where the file describes rigid bodies, masses and springs are those of
    /// the bodies.
    #[must_use]
    pub fn of_machine(machine: &Machine) -> Vec<Self> {
        let Some(structure) = &machine.structure else {
            return machine.axis.values().map(Self::of).collect();
        };
        let driven = |(axis, driven): (&Axis, &bodies::Axis)| {
            let moved = [&driven.to, &driven.from].into_iter().find_map(|name| structure.body.get(name));
            let mut axis = axis.clone();
            let mechanics = &mut axis.settings.mechanics;
            mechanics.motor_mass_kg = Some(driven.motor_mass_kg);
            mechanics.table_mass_kg = moved.map(|body| body.mass_kg);
            mechanics.stiffness_n_per_um = Some(driven.stiffness_n_per_um);
            mechanics.damping_n_s_per_m = Some(1e3 * driven.damping_n_s_per_mm);
            Self::of(&axis)
        };
        machine.axis.values().zip(structure.axis.values()).map(driven).collect()
    }

    /// One axis of a machine file. A mass that the file does not give is zero.
    #[must_use]
    pub fn of(axis: &Axis) -> Self {
        let mut parameters = Self {
            servo: ServoParameters::of(&axis.effect),
            residuals: Residuals { tables: axis.empirical.clone(), laws: axis.residual_law.clone() },
            ..Self::without_effects(&axis.settings.mechanics)
        };
        let turning_m_per_s2 = axis.fitted_velocity_drive().friction_m_per_s2;
        // Nothing stops a motor of infinite mass.
        if turning_m_per_s2 > 0.0 && parameters.motor_mass_kg.is_finite() {
            parameters.motor_turning_n = parameters.motor_mass_kg * turning_m_per_s2;
        }
        for effect in &axis.effect {
            parameters.add(effect);
        }
        parameters.divide_lost_motion();
        parameters
    }

    /// Travel of the command after a reversal before the table follows, µm: the gap, or the lost motion that contains it, plus twice the
    /// load angle of a stepper motor under friction.
    #[must_use]
    pub fn reversal_width_um(&self) -> f64 {
        let behind_motor_um = if self.lost_motion.width_um > 0.0 {
            self.lost_motion.width_um
        } else {
            self.screw.backlash.width_um
        };
        behind_motor_um + 2.0 * self.stepper.load_angle.friction_um
    }

    /// Describes lost motion by a gap; with a friction of the table, also by a unit mass on a spring with this friction: all that acts
    /// between motor and table then is relative to the mass.
    fn divide_lost_motion(&mut self) {
        let lost = &self.lost_motion;
        if lost.width_um > 0.0 {
            self.screw.backlash = lost.gap(self.inertial_windup.stretch_s2());
        }
        let (Some(friction), Some(presliding_um)) = (lost.friction_m_per_s2, lost.presliding_um) else {
            return;
        };
        let stretch_s2 = self.inertial_windup.stretch_s2().max(LEAST_STRETCH_S2);
        self.inertial_windup = InertialWindup::default();
        self.table_mass_kg = 1.0;
        self.friction.coulomb_n = friction;
        self.friction.bristle_stiffness_n_per_m = 1e6 * friction / presliding_um;
        self.spring = Some(Spring {
            stiffness_n_per_m: 1.0 / stretch_s2,
            damping_n_s_per_m: 2.0 * DRIVE_TRAIN_DAMPING / stretch_s2.sqrt(),
        });
    }

    fn without_effects(mechanics: &Mechanics) -> Self {
        let si = |value: Option<f64>| value.unwrap_or(0.0);
        Self {
            motor_mass_kg: si(mechanics.motor_mass_kg),
            table_mass_kg: si(mechanics.table_mass_kg),
            motor_coulomb_n: si(mechanics.motor_coulomb_n),
            spring: mechanics.spring_n_per_um().map(|stiffness| Spring {
                stiffness_n_per_m: 1e6 * stiffness,
                damping_n_s_per_m: si(mechanics.damping_n_s_per_m),
            }),
            friction: Friction {
                coulomb_n: si(mechanics.coulomb_n),
                viscous_n_s_per_m: si(mechanics.viscous_n_s_per_m),
                bristle_stiffness_n_per_m: 1e6 * si(mechanics.presliding_stiffness_n_per_um),
                bristle_damping_n_s_per_m: si(mechanics.presliding_damping_n_s_per_m),
                curve: mechanics.friction_curve.clone(),
                ..Friction::default()
            },
            ..Self::default()
        }
    }

    /// Adds an effect to the part of the axis that it acts on.
    fn add(&mut self, effect: &Effect) {
        match effect.clone() {
            Effect::Stribeck(e) => self.friction.stribeck = e,
            Effect::FrictionAsymmetry(e) => self.friction.asymmetry = e,
            Effect::ShearThinning(e) => self.friction.shear = e,
            Effect::FrictionMemory(e) => self.friction.memory = e,
            Effect::PreloadVariation(e) => self.friction.preload = e,
            Effect::FrictionRipple(e) => self.friction.ripple.push(e),
            Effect::MotorStribeck(e) => self.motor_stribeck = e,
            Effect::FrictionMap(e) => self.friction.map = e.curve(),
            Effect::FrictionWarmUp(e) => self.friction.warm_up = e,
            Effect::FrictionTemperature(e) => self.friction.temperature = e,
            Effect::QuadraticDrag(e) => self.friction.drag = e,
            Effect::Presliding(e) => self.friction.set_bristles(&e),
            Effect::TorqueRipple(e) => self.ripple.push(e),
            Effect::DriveAsymmetry(e) => self.drive_asymmetry = e,
            Effect::ConstantLoad(e) => self.load.constant.force_n += e.force_n,
            Effect::PositionLoad(e) => self.load.position = Some(e),
            Effect::Gravity(e) => self.load.gravity = Some(e),
            // Part of the controller: see `ServoParameters::of`.
            Effect::ServoMismatch(_)
            | Effect::VelocityLag(_)
            | Effect::VelocityFilter(_)
            | Effect::DriveDeadTime(_)
            | Effect::ComputationDelay(_)
            | Effect::LoopDelay(_)
            | Effect::PositionDelay(_)
            | Effect::FeedforwardMismatch(_)
            | Effect::VelocityGainMismatch(_)
            | Effect::IntegralTimeMismatch(_)
            | Effect::DriveLag(_) => {}
            Effect::ResolverDividing(e) => self.resolver.push(e.error()),
            Effect::EncoderEllipticity(e) => self.resolver.push(e.error()),
            Effect::Intalk(e) => self.tool.intalk = e,
            Effect::Crosstalk(e) => self.tool.crosstalk.push(e),
            Effect::Squareness(e) => self.tool.squareness.um_per_m += e.um_per_m,
            Effect::Straightness(e) => self.tool.straightness.push(e),
            Effect::Yaw(e) => self.tool.yaws.push(e),
            Effect::StraightnessMap(e) => self.tool.straightness_maps.push((e.source.clone(), e.curve())),
            Effect::ThermalDrift(e) => self.tool.drifts.push(e),
            Effect::ThermalRate(e) => self.tool.rate.um_per_min += e.um_per_min,
            Effect::ProbeRotation(e) => self.tool.probe.rotation.um_per_m += e.um_per_m,
            Effect::ProbeGain(e) => self.tool.probe.gain.um_per_m += e.um_per_m,
            Effect::ScaleGain(e) => self.scale.gain.um_per_m += e.um_per_m,
            Effect::ThermalGrowth(e) => self.scale.growth = Some(e),
            Effect::ScaleCyclic(e) => self.scale.periodic.push(e.error()),
            Effect::Resonance(e) => self.tool.resonances.push(e),
            Effect::Latency(e) => self.latency.push(e),
            Effect::Backlash(e) => self.screw.backlash = e,
            Effect::LostMotion(e) => self.lost_motion = e,
            Effect::InertialWindup(e) => self.inertial_windup = e,
            Effect::MicrostepError(e) => self.stepper.microsteps.push(e.error()),
            Effect::LoadAngle(e) => self.stepper.load_angle = e,
            Effect::PitchProgressive(e) => self.screw.progressive.slope_um_per_m += e.slope_um_per_m,
            Effect::PitchMap(e) => (self.screw.map, self.screw.gap_map) = (e.mean_error(), e.width()),
            Effect::PitchCyclic(e) => self.screw.periodic.push(e.error()),
            Effect::StiffnessMap(e) => self.screw.compliance_map = e.curve(),
            Effect::GearHysteresis(e) => self.screw.hysteresis = e,
            Effect::ForceWindup(e) => self.forced_windup = Some(e),
            Effect::Windup(e) => self.set_stiffness(e.stiffness_n_per_um),
        }
    }

    /// Sets the stiffness of a drive train that has one.
    fn set_stiffness(&mut self, n_per_um: f64) {
        if let Some(spring) = &mut self.spring {
            spring.stiffness_n_per_m = 1e6 * n_per_um;
        }
    }

    /// Friction of the motor at its velocity (m/s), N, against the motion: level·tanh(v/w), see
    /// [`friction::smoothed_sign`].
    #[must_use]
    #[inline]
    pub fn motor_friction_n(&self, velocity: f64) -> f64 {
        if !self.has_motor_friction() {
            return 0.0;
        }
        self.motor_level_n(velocity) * friction::smoothed_sign(velocity)
    }

    /// Direction of the motor's friction that turns over, −1 to 1, after a travel, m; see [`friction_direction`].
    #[must_use]
    #[inline]
    pub fn motor_direction(&self, before: f64, travel_m: f64) -> f64 {
        if self.motor_turning_n == 0.0 {
            return before;
        }
        friction_direction::after(before, travel_m, DRIVE_SLIP_M)
    }

    /// Level of the motor's friction at its velocity (m/s), N.
    #[must_use]
    #[inline]
    pub fn motor_level_n(&self, velocity: f64) -> f64 {
        self.motor_coulomb_n + self.motor_stribeck.rise_n(velocity)
    }

    /// Whether the motor has friction.
    #[must_use]
    #[inline]
    pub fn has_motor_friction(&self) -> bool {
        self.motor_coulomb_n != 0.0 || self.motor_stribeck.static_excess_n != 0.0
    }

    /// Sum of all force ripple of the motor, N, at a true motor position (m); it adds to the force of the drive.
    #[must_use]
    #[inline]
    pub fn torque_ripple_n(&self, motor_m: f64) -> f64 {
        self.ripple.iter().map(|ripple| ripple.force_n(motor_m)).sum()
    }

    /// Error of the motor's resolver or encoder, m: reading − true position, at a true motor position (m).
    #[must_use]
    #[inline]
    pub fn resolver_error_m(&self, motor_m: f64) -> f64 {
        self.resolver.iter().map(|error| error.error_m(motor_m)).sum()
    }

    /// The axis with the motor as commanded in the place of its reading: the errors of a stepper motor are then those of the reading,
    /// with the opposite sign.
    #[must_use]
    pub fn with_motor_as_commanded(&self) -> Self {
        let mut parameters = self.clone();
        parameters.resolver.extend(self.stepper.microsteps.iter().map(|error| error.reversed()));
        parameters
    }

    /// True motor position, m, of a reading (m): the inverse of motor + [`AxisParameters::resolver_error_m`], by two
    /// fixed-point iterations.
    ///
    /// With an amplitude A and a period λ each iteration reduces the error by 2π·A/λ, some 1e-3; what remains of A is
    /// (2π·A/λ)², some 1e-6.
    #[must_use]
    #[inline]
    pub fn motor_of_reading_m(&self, reading_m: f64) -> f64 {
        reading_m - self.resolver_error_m(reading_m - self.resolver_error_m(reading_m))
    }

    /// Logs a channel later by a time, s.
    pub fn add_latency(&mut self, channel: Channel, late_s: f64) {
        self.latency.push(Latency { channel, ms: 1e3 * late_s });
    }

    /// Latency of a logged channel, s; negative: it is logged early.
    #[must_use]
    pub fn latency_s(&self, channel: Channel) -> f64 {
        let of = |latency: &Latency| if latency.channel == channel { 1e-3 * latency.ms } else { 0.0 };
        self.latency.iter().map(of).sum()
    }
}
