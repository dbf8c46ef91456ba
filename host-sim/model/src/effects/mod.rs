//! The catalogue: what a machine may do that its declared model does not say.
//!
//! One effect is one file. The same struct bends the simulated machine (the crate `plant` holds one
//! of each) and explains the measured one (the crate `trace` fits its coordinates); its serde form
//! is the `[[axis.NAME.effect]]` entry of the machine file.

mod backlash;
mod constant_load;
mod crosstalk;
mod friction_asymmetry;
mod friction_memory;
mod friction_ripple;
pub mod harmonic;
mod intalk;
mod latency;
mod pitch_cyclic;
mod pitch_progressive;
mod preload_variation;
mod presliding;
mod resolver_dividing;
mod resonance;
mod servo_mismatch;
mod shear_thinning;
mod squareness;
mod straightness;
mod stribeck;
mod thermal_drift;
mod torque_ripple;
mod velocity_lag;
mod windup;

pub use backlash::Backlash;
pub use constant_load::ConstantLoad;
pub use crosstalk::Crosstalk;
pub use friction_asymmetry::FrictionAsymmetry;
pub use friction_memory::FrictionMemory;
pub use friction_ripple::FrictionRipple;
pub use intalk::Intalk;
pub use latency::{Channel, Latency};
pub use pitch_cyclic::PitchCyclic;
pub use pitch_progressive::PitchProgressive;
pub use preload_variation::PreloadVariation;
pub use presliding::Presliding;
pub use resolver_dividing::ResolverDividing;
pub use resonance::Resonance;
pub use servo_mismatch::ServoMismatch;
pub use shear_thinning::ShearThinning;
pub use squareness::Squareness;
pub use straightness::Straightness;
pub use stribeck::Stribeck;
pub use thermal_drift::ThermalDrift;
pub use torque_ripple::TorqueRipple;
pub use velocity_lag::VelocityLag;
pub use windup::Windup;

use serde::{Deserialize, Serialize};
use shared::config::Rates;

use crate::axis::Settings;

/// A place in the chain command → motor → table → tool at which the model is held against the log,
/// each driven by the measured signal upstream of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Motor reading against the declared loop driven by the command.
    Motor,
    /// Table scale against the mechanics driven by the measured motor.
    Table,
    /// Tool point against the structure driven by the measured tables.
    Tool,
    /// Drive force against the force that the measured motion needs.
    Force,
}

/// One of the numbers that an optimiser may move.
///
/// A coordinate is not always a reported parameter: a harmonic is fitted as its cosine and sine
/// parts, in which the model is linear, and reported as amplitude and phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinate {
    /// The value, in the unit of the effect's file entry.
    pub value: f64,
    /// A change that is small beside what the effect does and large beside rounding.
    pub step: f64,
    /// Least value that has a meaning.
    pub lower: f64,
    /// Greatest value that has a meaning.
    pub upper: f64,
    /// Least and greatest value of the range that is searched. A fit that ends there was stopped and has measured
    /// nothing. Infinite where a bound is exact (a size of zero) or holds one step only.
    pub limits: [f64; 2],
}

impl Coordinate {
    /// A coordinate that may take any sign.
    #[must_use]
    pub const fn signed(value: f64, step: f64, limit: f64) -> Self {
        Self { value, step, lower: -limit, upper: limit, limits: [-limit, limit] }
    }

    /// A coordinate that is positive and may be of any size within two bounds: a fit is led to it by factors of three,
    /// for a straight line from far away leads anywhere.
    #[must_use]
    pub fn scale(value: f64, lower: f64, upper: f64) -> Self {
        let [least, most] = [value / 3.0, 3.0 * value].map(|bound| bound.clamp(lower, upper));
        Self { value, step: 0.02 * value, lower: least, upper: most, limits: [lower, upper] }
    }

    /// A coordinate between two bounds. Both are limits of the search, but for a lower bound of zero: nothing is less.
    #[must_use]
    pub const fn between(value: f64, step: f64, lower: f64, upper: f64) -> Self {
        let least = if lower == 0.0 { f64::NEG_INFINITY } else { lower };
        Self { value, step, lower, upper, limits: [least, upper] }
    }

    /// The same with bounds that hold one step only: the next may go on from there.
    #[must_use]
    pub const fn stepwise(self) -> Self {
        Self { limits: [f64::NEG_INFINITY, f64::INFINITY], ..self }
    }

    /// The limit of the search at which the value stands, if it does: a step that was cut off there ends within
    /// rounding of it, and the last per mille before it is no more than that.
    #[must_use]
    pub fn limit(&self) -> Option<f64> {
        const NEAR: f64 = 1e-3;
        let [least, most] = self.limits;
        let is_at = |limit: f64, beyond: f64| limit.is_finite() && beyond >= -NEAR * limit.abs();
        if is_at(most, self.value - most) {
            return Some(most);
        }
        is_at(least, least - self.value).then_some(least)
    }
}

/// What starting values may be drawn from: the axis as declared, and its neighbours.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// Declared axis.
    pub axis: &'a Settings,
    /// Whether the axis is the machine's first.
    pub first: bool,
    /// Names of the machine's other axes.
    pub others: &'a [String],
    /// Which stages the logs and the declared model allow, in no order.
    pub stages: &'a [Stage],
    /// Where the logged motor or table was, least and greatest, mm.
    pub travel_mm: [f64; 2],
}

impl Surroundings<'_> {
    /// Whether friction is all that lies between the motor and the force that was logged. Beside a linear
    /// scale it is what bends the screw, too, and fine differences of it are lost in what a machine file
    /// leaves open of the drive train: they are not looked for there.
    #[must_use]
    pub fn shows_friction_alone(&self) -> bool {
        let has = |stage| self.stages.contains(&stage);
        self.axis.has_mass() && has(Stage::Force) && !has(Stage::Table)
    }
}

/// One kind of effect.
pub trait Kind: Sized + Clone {
    /// The stages whose residual it shapes, the one that it is first looked for in at the head.
    fn stages(&self) -> &'static [Stage];

    /// The points from which a fit of this effect is started: none if the axis lacks what the
    /// effect needs. Several where the error is not convex (a period, a time constant).
    fn starts(around: &Surroundings<'_>) -> Vec<Self>;

    /// The numbers to fit.
    fn coordinates(&self) -> Vec<Coordinate>;

    /// Whether it is larger than what a declared model leaves open in any case.
    fn is_material(&self, _declared: &Settings, _rates: Rates) -> bool {
        true
    }

    /// The same effect at other coordinates, in the order of [`Kind::coordinates`].
    #[must_use]
    fn at(&self, coordinates: &[f64]) -> Self;

    /// Name and value of each reported parameter, in contract units.
    fn parameters(&self) -> Vec<(&'static str, f64)>;
}

macro_rules! catalogue {
    ($($variant:ident = $name:literal),+ $(,)?) => {
        /// An effect with its parameters, as it stands in a machine file.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "name", rename_all = "snake_case")]
        pub enum Effect { $(
            #[doc = concat!("See [`", stringify!($variant), "`].")]
            $variant($variant),
        )+ }

        /// The names of all effects, in catalogue order.
        pub const NAMES: &[&str] = &[$($name),+];

        impl Effect {
            /// The contract's name of the effect.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self { $(Self::$variant(_) => $name,)+ }
            }

            /// The stages whose residual the effect shapes.
            #[must_use]
            pub fn stages(&self) -> &'static [Stage] {
                match self { $(Self::$variant(e) => e.stages(),)+ }
            }

            /// The numbers to fit.
            #[must_use]
            pub fn coordinates(&self) -> Vec<Coordinate> {
                match self { $(Self::$variant(e) => e.coordinates(),)+ }
            }

            /// Whether it is larger than what a declared model leaves open in any case.
            #[must_use]
            pub fn is_material(&self, declared: &Settings, rates: Rates) -> bool {
                match self { $(Self::$variant(e) => e.is_material(declared, rates),)+ }
            }

            /// The same effect at other coordinates.
            #[must_use]
            pub fn at(&self, x: &[f64]) -> Self {
                match self { $(Self::$variant(e) => Self::$variant(e.at(x)),)+ }
            }

            /// Name and value of each reported parameter.
            #[must_use]
            pub fn parameters(&self) -> Vec<(&'static str, f64)> {
                match self { $(Self::$variant(e) => e.parameters(),)+ }
            }
        }

        /// Every starting point of every effect that the surroundings allow.
        #[must_use]
        pub fn candidates(around: &Surroundings<'_>) -> Vec<Effect> {
            let mut all = Vec::new();
            $(all.extend(<$variant as Kind>::starts(around).into_iter().map(Effect::$variant));)+
            all
        }
    };
}

catalogue! {
    Backlash = "backlash",
    PitchProgressive = "pitch_progressive",
    PitchCyclic = "pitch_cyclic",
    ResolverDividing = "resolver_dividing",
    Windup = "windup",
    Stribeck = "stribeck",
    FrictionAsymmetry = "friction_asymmetry",
    TorqueRipple = "torque_ripple",
    ConstantLoad = "constant_load",
    Presliding = "presliding",
    ShearThinning = "shear_thinning",
    FrictionMemory = "friction_memory",
    PreloadVariation = "preload_variation",
    FrictionRipple = "friction_ripple",
    ServoMismatch = "servo_mismatch",
    VelocityLag = "velocity_lag",
    Intalk = "intalk",
    Crosstalk = "crosstalk",
    Squareness = "squareness",
    Straightness = "straightness",
    ThermalDrift = "thermal_drift",
    Latency = "latency",
    Resonance = "resonance",
}

impl Effect {
    /// The numbers to fit on an axis with these loops, which bound the age of a speed.
    #[must_use]
    pub fn searched(&self, rates: Rates) -> Vec<Coordinate> {
        match self {
            Self::VelocityLag(lag) => vec![lag.within(rates)],
            _ => self.coordinates(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Machine;

    fn all() -> Vec<Effect> {
        let machine = Machine::parse(crate::examples::DEMO_MACHINE, "demo.toml").unwrap();
        let others = machine.others("x");
        let stages = [Stage::Motor, Stage::Table, Stage::Tool, Stage::Force];
        let axis = &machine.axis["x"].settings;
        let travel_mm = [0.0, 100.0];
        let around = Surroundings { axis, first: true, others: &others, stages: &stages, travel_mm };
        // Without a linear scale and presliding, what only then is looked for.
        let mut bare = axis.clone();
        bare.mechanics.presliding_stiffness_n_per_um = None;
        bare.mechanics.presliding_damping_n_s_per_m = None;
        let stages = [Stage::Force, Stage::Motor];
        let few = Surroundings { axis: &bare, first: true, others: &[], stages: &stages, travel_mm };
        let mut all = candidates(&around);
        let finer = candidates(&few).into_iter().filter(|effect| !all.contains(effect)).collect::<Vec<_>>();
        all.extend(finer);
        all
    }

    #[test]
    fn every_effect_is_tried_on_a_machine_that_shows_everything() {
        let tried: std::collections::BTreeSet<&str> = all().iter().map(Effect::name).collect();
        assert_eq!(tried, NAMES.iter().copied().collect());
    }

    #[test]
    fn coordinates_lead_back_to_the_same_effect() {
        for effect in all() {
            let moved: Vec<f64> = effect.coordinates().iter().map(|c| c.value + c.step).collect();
            let there = effect.at(&moved);
            let back: Vec<f64> = there.coordinates().iter().map(|c| c.value).collect();
            for (moved, back) in moved.iter().zip(&back) {
                assert!((moved - back).abs() < 1e-9 * moved.abs().max(1.0), "{effect:?}: {moved} {back}");
            }
        }
    }

    #[test]
    fn a_file_entry_reads_back_as_it_was_written() {
        for effect in all() {
            let text = toml::to_string(&effect).unwrap();
            assert!(text.contains(&format!("name = \"{}\"", effect.name())), "{text}");
            assert_eq!(toml::from_str::<Effect>(&text).unwrap(), effect);
        }
    }
}
