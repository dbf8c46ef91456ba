//! What an axis is made of: the machine file's axis in SI, with its effects put where they act.

use model::effects::{
    Channel, ConstantLoad, Crosstalk, Effect, Intalk, Latency, ResolverDividing, Resonance, Squareness,
    Straightness, ThermalDrift, TorqueRipple, Windup,
};
use model::machine::{Axis, Machine};

use super::friction::Friction;
use super::screw::{Screw, Spring};
use model::bodies;
use model::servo::ServoParameters;

/// Sharpness of the motor's own friction, m/s in tanh(v/0.2 mm/s).
const MOTOR_SIGN_WIDTH_M_PER_S: f64 = 0.2e-3;

/// Smoothed sign of the motor's friction, −1 to 1, at a velocity (m/s).
#[must_use]
#[inline]
pub fn motor_friction_sign(velocity: f64) -> f64 {
    (velocity / MOTOR_SIGN_WIDTH_M_PER_S).tanh()
}

/// Everything that the simulation of one axis needs, SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisParameters {
    /// Motor side, reflected to the table.
    pub motor_mass_kg: f64,
    /// Table side.
    pub table_mass_kg: f64,
    /// Level of the motor's own friction.
    pub motor_coulomb_n: f64,
    /// Errors between motor and table.
    pub screw: Screw,
    /// Elasticity between motor and table; `None`: rigid, one mass.
    pub spring: Option<Spring>,
    /// Wind-up by a measured force, of an axis whose masses are not known.
    pub forced_windup: Option<Windup>,
    /// Of the table.
    pub friction: Friction,
    /// On the table.
    pub load: ConstantLoad,
    /// On the motor.
    pub ripple: Vec<TorqueRipple>,
    /// Of the motor reading.
    pub dividing: Vec<ResolverDividing>,
    /// Between table and tool.
    pub tool: ToolParameters,
    /// Of the controller.
    pub servo: ServoParameters,
    /// Channels that are logged late.
    pub late: Vec<Latency>,
}

/// Effects between table and tool.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ToolParameters {
    /// Per own acceleration.
    pub intalk: Intalk,
    /// Per another axis's acceleration.
    pub crosstalk: Vec<Crosstalk>,
    /// Per the other axis's position.
    pub squareness: Squareness,
    /// Per the square of another axis's position.
    pub straightness: Vec<Straightness>,
    /// Over the session.
    pub drift: Option<ThermalDrift>,
    /// Swing behind the table.
    pub resonance: Option<Resonance>,
}

impl AxisParameters {
    /// All axes of a machine file as a simulation moves them: motors and screws are those of the bodies, where it has
    /// bodies.
    #[must_use]
    pub fn of_all(machine: &Machine) -> Vec<Self> {
        let Some(structure) = &machine.structure else {
            return machine.axis.values().map(Self::of).collect();
        };
        let driven = |(axis, driven): (&Axis, &bodies::Axis)| {
            let moved = [&driven.to, &driven.from].into_iter().find_map(|name| structure.body.get(name));
            Self::of(&Axis {
                motor_mass_kg: Some(driven.motor_mass_kg),
                table_mass_kg: moved.map(|body| body.mass_kg),
                stiffness_n_per_um: Some(driven.stiffness_n_per_um),
                damping_n_s_per_m: Some(1e3 * driven.damping_n_s_per_mm),
                ..axis.clone()
            })
        };
        machine.axis.values().zip(structure.axis.values()).map(driven).collect()
    }

    /// The axis of a machine file. Masses that it lacks are zero.
    #[must_use]
    pub fn of(axis: &Axis) -> Self {
        let mut parameters = Self { servo: ServoParameters::of(axis), ..Self::without_effects(axis) };
        for effect in &axis.effect {
            parameters.add(effect);
        }
        parameters
    }

    fn without_effects(axis: &Axis) -> Self {
        let si = |value: Option<f64>| value.unwrap_or(0.0);
        Self {
            motor_mass_kg: si(axis.motor_mass_kg),
            table_mass_kg: si(axis.table_mass_kg),
            motor_coulomb_n: si(axis.motor_coulomb_n),
            spring: axis.stiffness_n_per_um.map(|stiffness| Spring {
                stiffness_n_per_m: 1e6 * stiffness,
                damping_n_s_per_m: si(axis.damping_n_s_per_m),
            }),
            friction: Friction {
                coulomb_n: si(axis.coulomb_n),
                viscous_n_s_per_m: si(axis.viscous_n_s_per_m),
                bristle_stiffness_n_per_m: 1e6 * si(axis.presliding_stiffness_n_per_um),
                bristle_damping_n_s_per_m: si(axis.presliding_damping_n_s_per_m),
                curve: axis.friction_curve.clone(),
                ..Friction::default()
            },
            ..Self::default()
        }
    }

    /// Puts an effect where it acts.
    fn add(&mut self, effect: &Effect) {
        match effect.clone() {
            Effect::Stribeck(e) => self.friction.stribeck = e,
            Effect::FrictionAsymmetry(e) => self.friction.asymmetry = e,
            Effect::ShearThinning(e) => self.friction.shear = e,
            Effect::FrictionMemory(e) => self.friction.memory = e,
            Effect::PreloadVariation(e) => self.friction.preload = e,
            Effect::FrictionRipple(e) => self.friction.ripple.push(e),
            Effect::Presliding(e) => {
                self.friction.bristle_stiffness_n_per_m = 1e6 * e.stiffness_n_per_um;
                self.friction.bristle_damping_n_s_per_m = e.damping_n_s_per_m;
            }
            Effect::TorqueRipple(e) => self.ripple.push(e),
            Effect::ConstantLoad(e) => self.load.force_n += e.force_n,
            // Part of the controller: see `ServoParameters::of`.
            Effect::ServoMismatch(_) | Effect::VelocityLag(_) => {}
            Effect::ResolverDividing(e) => self.dividing.push(e),
            Effect::Intalk(e) => self.tool.intalk = e,
            Effect::Crosstalk(e) => self.tool.crosstalk.push(e),
            Effect::Squareness(e) => self.tool.squareness.um_per_m += e.um_per_m,
            Effect::Straightness(e) => self.tool.straightness.push(e),
            Effect::ThermalDrift(e) => self.tool.drift = Some(e),
            Effect::Resonance(e) => self.tool.resonance = Some(e),
            Effect::Latency(e) => self.late.push(e),
            Effect::Backlash(e) => self.screw.backlash = e,
            Effect::PitchProgressive(e) => self.screw.progressive.slope_um_per_m += e.slope_um_per_m,
            Effect::PitchCyclic(e) => self.screw.cyclic.push(e),
            Effect::Windup(e) if e.friction_n.is_some() => self.forced_windup = Some(e),
            Effect::Windup(e) => {
                if let Some(spring) = &mut self.spring {
                    spring.stiffness_n_per_m = 1e6 * e.stiffness_n_per_um;
                }
            }
        }
    }

    /// Friction of the motor itself, N, against its velocity (m/s).
    #[must_use]
    #[inline]
    pub fn motor_friction_n(&self, velocity: f64) -> f64 {
        if self.motor_coulomb_n == 0.0 {
            return 0.0;
        }
        self.motor_coulomb_n * motor_friction_sign(velocity)
    }

    /// Force of all torque ripple, N, at a motor position (m).
    #[must_use]
    #[inline]
    pub fn ripple_n(&self, motor_m: f64) -> f64 {
        self.ripple.iter().map(|ripple| ripple.force_n(motor_m)).sum()
    }

    /// Reading − true position of the motor, m.
    #[must_use]
    #[inline]
    pub fn dividing_m(&self, motor_m: f64) -> f64 {
        self.dividing.iter().map(|dividing| dividing.error_m(motor_m)).sum()
    }

    /// How late a channel is logged, s.
    #[must_use]
    pub fn late_s(&self, channel: Channel) -> f64 {
        let of = |late: &Latency| if late.channel == channel { 1e-3 * late.ms } else { 0.0 };
        self.late.iter().map(of).sum()
    }

    /// A step (s) short enough for what is not linear.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        self.fastest().1
    }

    /// The key of the machine file behind what is fastest of all that is not linear, and a step (s) short enough for
    /// it: the guide's bristles under the table, the motor's own friction about standstill, the touch at the edges of
    /// a gap.
    #[must_use]
    pub fn fastest(&self) -> (&'static str, f64) {
        let (motor_kg, table_kg) = match self.spring {
            Some(_) => (self.motor_mass_kg, self.table_mass_kg),
            None => (self.motor_mass_kg + self.table_mass_kg, self.motor_mass_kg + self.table_mass_kg),
        };
        let bristles = (self.friction.bristle_stiffness_n_per_m / table_kg).sqrt();
        let motor = self.motor_coulomb_n / MOTOR_SIGN_WIDTH_M_PER_S / motor_kg;
        let touch = match &self.spring {
            Some(spring) if self.screw.backlash.width_um > 0.0 => {
                (spring.stiffness_n_per_m * (motor_kg.recip() + table_kg.recip())).sqrt()
            }
            _ => 0.0,
        };
        // Per step: radians of the bristles' swing and of the screw's, and share of a velocity that friction stops.
        let rates = [
            ("presliding_stiffness_n_per_um", bristles / 0.06),
            ("motor_coulomb_n", motor / 0.2),
            ("stiffness_n_per_um", touch / 0.1),
        ];
        let slow = ("velocity_loop_rate_hz", 1e3);
        let (key, rate) =
            rates.into_iter().fold(slow, |fastest, rate| if rate.1 > fastest.1 { rate } else { fastest });
        (key, rate.recip())
    }
}
