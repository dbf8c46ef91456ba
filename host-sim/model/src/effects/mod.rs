//! The catalogue of effects: behaviour of a machine that its declared model does not contain.
//!
//! Each effect has one file with a struct that implements [`EffectModel`], and one entry in [the list](Effect) below.
//! The simulated machine (crate `plant`) and the fit to measured data (crate `trace`) use the same struct. Its serde
//! form is the `[[axis.NAME.effect]]` entry of the machine file. The checks of a machine file, the reasons why an effect
//! could not be searched for, units, sentences, plots and tables are generated from its declaration.
//! `docs/adding-an-effect.md` describes the steps.
//!
//! The module `declaration` contains [`EffectModel`] and the types that describe an effect ([`Stage`], [`Parameter`]
//! with its [`Unit`], [`Coordinate`], [`EffectContext`], [`Prerequisite`], [`Distinction`], [`Abscissa`], [`Wording`],
//! [`Draw`]).

mod declaration;

mod backlash;
mod computation_delay;
mod constant_load;
mod crosstalk;
mod drive_asymmetry;
mod drive_dead_time;
mod drive_lag;
mod encoder_ellipticity;
mod feedforward_mismatch;
mod force_windup;
mod friction_asymmetry;
mod friction_map;
mod friction_memory;
mod friction_ripple;
mod friction_temperature;
mod friction_warm_up;
mod gear_hysteresis;
mod gravity;
mod inertial_windup;
mod intalk;
mod integral_time_mismatch;
mod latency;
mod load_angle;
mod loop_delay;
mod lost_motion;
mod microstep_error;
mod motor_stribeck;
mod pitch_cyclic;
mod pitch_map;
mod pitch_progressive;
mod position_delay;
mod position_load;
mod preload_variation;
mod presliding;
mod probe_gain;
mod probe_rotation;
mod quadratic_drag;
mod resolver_dividing;
mod resonance;
mod scale_cyclic;
mod scale_gain;
mod servo_mismatch;
mod shear_thinning;
mod slopes;
mod squareness;
mod stiffness_map;
mod straightness;
mod straightness_map;
mod stribeck;
mod thermal_drift;
mod thermal_growth;
mod thermal_rate;
mod torque_ripple;
mod velocity_filter;
mod velocity_gain_mismatch;
mod velocity_lag;
mod windup;
mod yaw;

use std::collections::BTreeMap;

use serde::de::value::MapDeserializer;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use shared::config::Rates;

use crate::axis::{Drive, Settings};
use declaration::{AnyEffect, EntryValue, catalogue};

pub use declaration::{
    Abscissa, Channel, Coordinate, DampedAgainst, Distinction, Draw, EffectCompensation, EffectContext,
    EffectModel, Found, Imitation, ImitationContext, LEAST_SLOPE_UM_PER_M, LoggedChannels, Misplaced, Mode,
    Neighbours, Occurrence, Parameter, PeriodicError, Placement, Prerequisite, ResidualOverOther,
    ResidualShape, ResidualWave, SlopeOf, Stage, Substitute, Timing, Unit, WaveOf, Wording, harmonic,
};

pub use backlash::Backlash;
pub use computation_delay::ComputationDelay;
pub use constant_load::ConstantLoad;
pub use crosstalk::Crosstalk;
pub use drive_asymmetry::DriveAsymmetry;
pub use drive_dead_time::DriveDeadTime;
pub use drive_lag::DriveLag;
pub use encoder_ellipticity::EncoderEllipticity;
pub use feedforward_mismatch::FeedforwardMismatch;
pub use force_windup::ForceWindup;
pub use friction_asymmetry::FrictionAsymmetry;
pub use friction_map::FrictionMap;
pub use friction_memory::FrictionMemory;
pub use friction_ripple::FrictionRipple;
pub use friction_temperature::FrictionTemperature;
pub use friction_warm_up::FrictionWarmUp;
pub use gear_hysteresis::{GearHysteresis, LoopState};
pub use gravity::Gravity;
pub use inertial_windup::InertialWindup;
pub use intalk::Intalk;
pub use integral_time_mismatch::IntegralTimeMismatch;
pub use latency::{LONGEST_LATENCY_MS, Latency};
pub use load_angle::LoadAngle;
pub use loop_delay::LoopDelay;
pub use lost_motion::LostMotion;
pub use microstep_error::MicrostepError;
pub use motor_stribeck::MotorStribeck;
pub use pitch_cyclic::PitchCyclic;
pub use pitch_map::PitchMap;
pub use pitch_progressive::PitchProgressive;
pub use position_delay::PositionDelay;
pub use position_load::PositionLoad;
pub use preload_variation::PreloadVariation;
pub use presliding::Presliding;
pub use probe_gain::ProbeGain;
pub use probe_rotation::ProbeRotation;
pub use quadratic_drag::QuadraticDrag;
pub use resolver_dividing::ResolverDividing;
pub use resonance::Resonance;
pub use scale_cyclic::ScaleCyclic;
pub use scale_gain::ScaleGain;
pub use servo_mismatch::ServoMismatch;
pub use shear_thinning::ShearThinning;
pub use squareness::Squareness;
pub use stiffness_map::StiffnessMap;
pub use straightness::Straightness;
pub use straightness_map::{SlopeOfMap, StraightnessMap};
pub use stribeck::Stribeck;
pub use thermal_drift::ThermalDrift;
pub use thermal_growth::{GrowingPart, ThermalGrowth};
pub use thermal_rate::ThermalRate;
pub use torque_ripple::TorqueRipple;
pub use velocity_filter::VelocityFilter;
pub use velocity_gain_mismatch::VelocityGainMismatch;
pub use velocity_lag::VelocityLag;
pub use windup::Windup;
pub use yaw::Yaw;

// Effects are searched for and listed in this order.
catalogue! {
    Backlash,
    LostMotion,
    PitchProgressive,
    PitchCyclic,
    ResolverDividing,
    MicrostepError,
    EncoderEllipticity,
    PitchMap,
    ScaleGain,
    ScaleCyclic,
    ThermalGrowth,
    Windup,
    ForceWindup,
    InertialWindup,
    StiffnessMap,
    GearHysteresis,
    Stribeck,
    FrictionAsymmetry,
    TorqueRipple,
    ConstantLoad,
    DriveAsymmetry,
    PositionLoad,
    Gravity,
    MotorStribeck,
    FrictionWarmUp,
    FrictionTemperature,
    FrictionMap,
    Presliding,
    ShearThinning,
    FrictionMemory,
    PreloadVariation,
    FrictionRipple,
    QuadraticDrag,
    LoadAngle,
    ServoMismatch,
    VelocityLag,
    VelocityFilter,
    FeedforwardMismatch,
    VelocityGainMismatch,
    IntegralTimeMismatch,
    DriveLag,
    DriveDeadTime,
    ComputationDelay,
    LoopDelay,
    PositionDelay,
    Intalk,
    Crosstalk,
    Squareness,
    Straightness,
    StraightnessMap,
    Yaw,
    ProbeRotation,
    ProbeGain,
    ThermalDrift,
    ThermalRate,
    Latency,
    Resonance,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Machine;

    /// Initial guesses of all effects.
    fn all() -> Vec<Effect> {
        let machine = Machine::parse(crate::examples::DEMO_MACHINE, "demo.toml").unwrap();
        let others = machine.others("x");
        let stages = [Stage::Motor, Stage::Table, Stage::Tool, Stage::Force];
        let axis = &machine.axis["x"].settings;
        let travel_mm = [0.0, 100.0];
        let residual = &ResidualShape::over("y");
        let with_all_stages = EffectContext {
            axis,
            logged: LoggedChannels::ALL,
            first: true,
            others: &others,
            stages: &stages,
            travel_mm,
            effects: &["backlash"],
            residual,
        };
        // Some effects are searched for only without a linear scale, or only if no presliding is declared.
        let mut bare = axis.clone();
        bare.mechanics.presliding_stiffness_n_per_um = None;
        bare.mechanics.presliding_damping_n_s_per_m = None;
        let stages = [Stage::Force, Stage::Motor];
        let without_table = EffectContext { axis: &bare, others: &[], stages: &stages, ..with_all_stages };
        // The angle of the probe is searched on the second axis.
        let second = EffectContext { first: false, ..with_all_stages };
        let mut unknown = Settings::default();
        unknown.mechanics.lead_mm = Some(5.0);
        unknown.controller.drive = Drive::Stepper;
        let no_force = LoggedChannels { force: false, ..LoggedChannels::ALL };
        let stepper = EffectContext { axis: &unknown, logged: no_force, ..with_all_stages };
        let turning = Settings { names: crate::axis::KeyNames::Rotary, ..axis.clone() };
        let rotary = EffectContext { axis: &turning, ..with_all_stages };
        let mut all = initial_guesses(&with_all_stages);
        let added = initial_guesses(&without_table)
            .into_iter()
            .chain(initial_guesses(&second))
            .chain(initial_guesses(&stepper))
            .chain(initial_guesses(&rotary))
            .chain(of_the_scale())
            .chain(KINDS.iter().flat_map(|kind| (kind.assumed)()))
            .filter(|effect| !all.contains(effect))
            .collect::<Vec<_>>();
        all.extend(added);
        all
    }

    /// Errors of the scale are searched as those of the screw, and exchanged for them where the probe shows them.
    fn of_the_scale() -> [Effect; 2] {
        let cyclic =
            ScaleCyclic { amplitude_um: 1.0, period_mm: 40.0, phase_rad: 0.3, fitted_period_mm: None };
        [Effect::ScaleGain(ScaleGain::default()), Effect::ScaleCyclic(cyclic)]
    }

    #[test]
    fn every_effect_has_an_initial_guess_or_is_assumed() {
        let tried: std::collections::BTreeSet<&str> = all().iter().map(Effect::name).collect();
        assert_eq!(tried, names().into_iter().collect());
    }

    #[test]
    fn an_effect_at_given_coordinates_returns_these_coordinates() {
        for effect in all() {
            let moved: Vec<f64> = effect.coordinates().iter().map(|c| c.value + c.step).collect();
            let back: Vec<f64> = effect.at(&moved).coordinates().iter().map(|c| c.value).collect();
            for (moved, back) in moved.iter().zip(&back) {
                assert!((moved - back).abs() < 1e-9 * moved.abs().max(1.0), "{effect:?}: {moved} {back}");
            }
        }
    }

    #[test]
    fn a_written_file_entry_is_read_as_the_same_effect() {
        for effect in all() {
            let text = toml::to_string(&effect).unwrap();
            assert!(text.contains(&format!("name = \"{}\"", effect.name())), "{text}");
            assert_eq!(toml::from_str::<Effect>(&text).unwrap(), effect);
        }
    }

    #[test]
    fn a_sentence_expresses_the_sign_in_words_and_uses_the_units_of_the_axis() {
        let sentence =
            |text: &str, is_rotary| toml::from_str::<Effect>(text).unwrap().sentence(&[], is_rotary);
        let load = "name = 'constant_load'\nforce_n = -3.5";
        assert_eq!(sentence(load, false), "a constant load of 3.500 N opposes motion in − direction");
        assert_eq!(sentence(load, true), "a constant load of 3.500 N·m opposes motion in − direction");
        assert!(sentence("name = 'servo_mismatch'\npercent = -4", false).contains("4.000 % below"));
        let late = "name = 'latency'\nchannel = 'tool'\nms = 2";
        assert!(sentence(late, false).contains("tool reading is logged 2.000 ms late"));
        let pitch = "name = 'pitch_progressive'\nslope_um_per_m = -40";
        assert_eq!(sentence(pitch, false), "the screw moves the table 40.00 µm/m less than its nominal lead");
        assert!(sentence(pitch, true).contains("gear moves the table 40.00 ppm less than its nominal ratio"));
        let preload =
            "name = 'preload_variation'\ncentre_mm = 5\nslope_n_per_m = 2\ncurvature_n_per_m2 = 0.5";
        assert!(sentence(preload, true).contains("about 5.000°: slope 2.000 N·m per 1000°"));
    }

    #[test]
    fn an_effect_is_compensated_or_has_its_reason() {
        let intalk = Effect::Intalk(Intalk::default()).compensation();
        assert!(
            matches!(intalk, EffectCompensation::Compensated { does, .. } if does.contains("acceleration"))
        );
        let resonance = Resonance::of_tool(62.5, 0.02);
        assert!(resonance.compensation().description().contains("smoothing_s = 0.0160,"));
        let latency = Latency { channel: Channel::Tool, ms: 1.0 };
        for effect in [Effect::DriveLag(DriveLag::default()), Effect::Latency(latency)] {
            let EffectCompensation::Not { why, .. } = effect.compensation() else {
                panic!("{effect:?} is compensated")
            };
            assert!(!why.is_empty());
        }
    }
}
