//! The machine of the catalogue, and the one that stands in the shop.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::bench::{Gains, Instruments};
use super::identify::Weights;
use crate::reproduce::ReproduceError;
use model::bodies::{JointKind, Structure};
use plant::sensors::Sensor;

/// Share of the catalogue's stiffness that the guideways of the true machine have: what is to be found. It is chosen
/// for the cross-talk that the paper measured, −1.55 µm per m/s².
pub const TRUE_SHARE: f64 = 0.38;

/// Scatter of the true machine about that and about all other data of the catalogue, either way: no model has it.
pub const GUIDEWAY_SCATTER: f64 = 0.08;
const OTHER_SCATTER: f64 = 0.05;
const MASS_SCATTER: f64 = 0.005;

/// Of the true machine and of its readings.
const SEED: u64 = 4;

/// The paper prints no gains. Kp is chosen for the 4.7 m/s² that its simulated circle reaches; the velocity loop is three
/// times as fast, and its integral time four times the inverse of that, as is usual.
pub const GAINS: Gains = Gains { position_per_s: 120.0, velocity_ratio: 3.0, integral_ratio: 4.0 };

/// The probe's standard uncertainty: half of the paper's U(k = 2) = 2.8 µm, m.
const EXTERNAL_M: f64 = 1.4e-6;

/// The scales' noise, m, and the drives' force ripple, N: not in the paper.
const INTERNAL_M: f64 = 20e-9;
const FORCE_N: f64 = 50.0;

/// What the errors are weighed by.
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

/// As the catalogue has it.
///
/// # Errors
/// Where the file cannot be read.
pub fn catalogue() -> Result<Structure, ReproduceError> {
    toml::from_str(include_str!("machine.toml")).map_err(|error| ReproduceError::Numerics(error.to_string()))
}

/// As it stands in the shop: softer guideways, and nothing else quite as it should be.
#[must_use]
pub fn truth(catalogue: &Structure) -> Structure {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut about = |scatter: f64| 1.0 + scatter * (2.0 * random.random::<f64>() - 1.0);
    let mut truth = catalogue.clone();
    for joint in &mut truth.joint {
        let share = match joint.kind {
            JointKind::Guideway => TRUE_SHARE * about(GUIDEWAY_SCATTER),
            JointKind::Foot | JointKind::Flange => about(OTHER_SCATTER),
        };
        joint.stiffness_n_per_um = joint.stiffness_n_per_um.map(|k| share * k);
    }
    for axis in truth.axis.values_mut() {
        axis.stiffness_n_per_um *= about(OTHER_SCATTER);
    }
    for body in truth.body.values_mut() {
        let share = about(MASS_SCATTER);
        body.mass_kg *= share;
        body.inertia_kg_m2 = body.inertia_kg_m2.map(|element| share * element);
    }
    truth
}
