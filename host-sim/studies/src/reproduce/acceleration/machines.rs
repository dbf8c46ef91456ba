//! The machine with the data of the catalogue, the true machine, whose stiffness and masses differ, and the gains and
//! instruments of both.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::reproduce::study::ReproduceError;
use model::bodies::{JointKind, Structure};
use plant::sensors::Sensor;

/// Gains of the cascade, relative to the axis that they control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Position gain Kp, 1/s.
    pub position_per_s: f64,
    /// Bandwidth of the velocity loop (its gain divided by the mass), in multiples of Kp.
    pub velocity_ratio: f64,
    /// Integral time of the velocity loop, in multiples of the inverse of that bandwidth.
    pub integral_ratio: f64,
}

/// Resolution and noise of the measuring instruments.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instruments {
    /// Motor encoders and scales, m; the paper calls them internal.
    pub internal: Sensor,
    /// Probe at the tool, m; the paper calls it external.
    pub external: Sensor,
    /// Drive force, N.
    pub force: Sensor,
    /// Seed of all noise.
    pub seed: u64,
}

/// Standard deviations of the readings; errors are divided by them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Of the external reading, µm.
    pub tool_um: f64,
    /// Of the drive force, N.
    pub force_n: f64,
}

/// Stiffness of the true machine's guideways over that of the catalogue: the factor to be identified. Chosen for the
/// measured cross-talk of the paper, −1.55 µm per m/s².
pub const TRUE_GUIDEWAY_FACTOR: f64 = 0.38;

/// Individual guideways deviate from that factor by up to ± this fraction.
pub const GUIDEWAY_SCATTER: f64 = 0.08;

/// All other stiffness of the true machine deviates from the catalogue by up to ± this fraction.
const OTHER_SCATTER: f64 = 0.05;

/// Masses of the true machine deviate from the catalogue by up to ± this fraction.
const MASS_SCATTER: f64 = 0.005;

/// Seed of the true machine and of its readings.
const SEED: u64 = 4;

/// The paper prints no gains. Kp is chosen for the 4.7 m/s² that its simulated circle reaches. The velocity loop has the
/// usual ratios: three times the bandwidth, and an integral time of four times the inverse of that.
pub const GAINS: Gains = Gains { position_per_s: 120.0, velocity_ratio: 3.0, integral_ratio: 4.0 };

/// Standard uncertainty of the probe, m: half of the paper's U(k = 2) = 2.8 µm.
const EXTERNAL_M: f64 = 1.4e-6;

/// Noise of the scales, m. Not in the paper.
const INTERNAL_M: f64 = 20e-9;

/// Force ripple of the drives, N. Not in the paper.
const FORCE_N: f64 = 50.0;

/// Standard deviations of the readings, by which errors are divided.
pub const WEIGHTS: Weights = Weights { tool_um: 1e6 * EXTERNAL_M, force_n: FORCE_N };

/// The paper's instruments.
#[must_use]
pub fn instruments() -> Instruments {
    let sensor = |noise: f64| Sensor { resolution: 0.0, noise };
    Instruments {
        internal: sensor(INTERNAL_M),
        external: sensor(EXTERNAL_M),
        force: sensor(FORCE_N),
        seed: SEED,
    }
}

/// The machine with the data of the catalogue.
///
/// # Errors
/// If `machine.toml` is invalid.
pub fn catalogue() -> Result<Structure, ReproduceError> {
    toml::from_str(include_str!("machine.toml")).map_err(|error| ReproduceError::Numerics(error.to_string()))
}

/// The true machine: softer guideways, and every other value scattered.
#[must_use]
pub fn truth(catalogue: &Structure) -> Structure {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut about = |scatter: f64| 1.0 + scatter * (2.0 * random.random::<f64>() - 1.0);
    let mut truth = catalogue.clone();
    for joint in &mut truth.joint {
        let factor = match joint.kind {
            JointKind::Guideway => TRUE_GUIDEWAY_FACTOR * about(GUIDEWAY_SCATTER),
            JointKind::Foot | JointKind::Flange => about(OTHER_SCATTER),
        };
        joint.stiffness_n_per_um = joint.stiffness_n_per_um.map(|k| factor * k);
    }
    for axis in truth.axis.values_mut() {
        axis.stiffness_n_per_um *= about(OTHER_SCATTER);
    }
    for body in truth.body.values_mut() {
        let factor = about(MASS_SCATTER);
        body.mass_kg *= factor;
        body.inertia_kg_m2 = body.inertia_kg_m2.map(|element| factor * element);
    }
    truth
}
