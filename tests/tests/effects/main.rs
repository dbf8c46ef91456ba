//! What a machine file says, seen in a run: each effect of the catalogue, each instrument and each friction curve.
//!
//! Every test runs a machine twice in closed loop, with and without one entry of its file, on a motion that the entry
//! shows in. The expected size is an equation of the entry's definition, in the doc of the test, and the bound says
//! what the equation leaves out. The channels that an entry must not touch are the same to the last bit.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod bench;
mod bodies;
mod curve;
mod force;
mod instruments;
mod loops;
mod screw;
mod tool;

/// One test an effect, under its name; the list cannot name one that is not tested.
macro_rules! tested {
    ($($module:ident: $($name:ident),+;)+) => {
        $($(
            #[test]
            fn $name() {
                $module::$name();
            }
        )+)+

        const TESTED: &[&str] = &[$($(stringify!($name)),+),+];
    };
}

tested! {
    screw: backlash, pitch_progressive, pitch_cyclic, resolver_dividing, windup;
    force: stribeck, friction_asymmetry, torque_ripple, constant_load, presliding, shear_thinning, friction_memory,
        preload_variation, friction_ripple;
    loops: servo_mismatch, velocity_lag;
    tool: intalk, crosstalk, squareness, straightness, thermal_drift, latency, resonance;
}

#[test]
fn every_effect_of_the_catalogue_is_tested() {
    assert_eq!(TESTED, model::effects::names());
}
