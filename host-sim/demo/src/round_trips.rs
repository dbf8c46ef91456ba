//! Round trips of many machines: logged, traced, compensated, run again.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde_json::{Value, json};

use super::{DemoError, MACHINE, compensated, draw_several, logs};
use compensate::place::Place;
use compensate::round_trip::totals_um;
use model::machine::Machine;

/// How far the measured error may be from the predicted one, as a fraction.
pub const MAX_PREDICTION_ERROR: f64 = 0.15;

/// Velocity feed-forward that is set before the machine is logged: that of published comparisons.
const SET: (f64, f64) = (100.0, 1.25e-3);

/// The round trip of one machine.
#[derive(Clone, Debug)]
pub struct RoundTrip {
    /// Seed of the machine.
    pub seed: u64,
    /// Its effects, as `axis: name`.
    pub effects: Vec<String>,
    /// The effects found, likewise.
    pub found: Vec<String>,
    /// Contour error before, as predicted, and after, µm rms over all motions.
    pub contour_um: [f64; 3],
}

impl RoundTrip {
    /// Contour error before over that after.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.contour_um[0] / self.contour_um[2]
    }

    /// As JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        let [before, predicted, after] = self.contour_um;
        json!({
            "seed": self.seed,
            "effects": self.effects,
            "found": self.found,
            "contour_error_um": {"before": before, "predicted": predicted, "after": after},
        })
    }

    /// Relative difference of the measured error from the predicted one.
    #[must_use]
    pub fn prediction_error(&self) -> f64 {
        (self.contour_um[2] / self.contour_um[1] - 1.0).abs()
    }
}

/// Executes the round trips of `count` machines with one to three effects, from the first seed on. With `has_feedforward`, the
/// velocity feed-forward of the machine is already set. `done` receives the number of finished machines.
///
/// # Errors
/// If a machine cannot be simulated, traced or compensated.
pub fn round_trips(
    first_seed: u64,
    count: u64,
    has_feedforward: bool,
    done: &(dyn Fn(usize) + Sync),
) -> Result<Vec<RoundTrip>, DemoError> {
    let mut declared = Machine::parse(MACHINE, "machines/demo.toml")?;
    if has_feedforward {
        for axis in declared.axis.values_mut() {
            axis.settings.controller.feedforward_percent = Some(SET.0);
            axis.settings.controller.feedforward_ahead_s = Some(SET.1);
        }
    }
    let finished = AtomicUsize::new(0);
    (0..count)
        .into_par_iter()
        .map(|number| {
            let seed = first_seed + number;
            let effects = 1 + (number % 3) as usize;
            let (truth, effects) = draw_several(&declared, seed, effects);
            let [fit, validate] = logs(&truth, seed)?;
            let trace = trace::trace(&declared, &fit, &validate, &|_| ())?;
            let compensated = compensated(&trace.better_machine(), &truth, seed, Place::Host)?;
            let found = trace.axes.iter().flat_map(|axis| {
                axis.found.iter().map(|found| format!("{}: {}", axis.axis, found.effect.name()))
            });
            done(1 + finished.fetch_add(1, Ordering::Relaxed));
            Ok(RoundTrip {
                seed,
                effects: effects.iter().map(|(axis, effect)| format!("{axis}: {}", effect.name())).collect(),
                found: found.collect(),
                contour_um: totals_um(&compensated.motions),
            })
        })
        .collect()
}

/// The figures of many round trips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Number of machines.
    pub count: usize,
    /// Contour error before over that after: median.
    pub median_ratio: f64,
    /// The ratio that nine of ten machines reach.
    pub ninth_ratio: f64,
    /// Smallest ratio.
    pub min_ratio: f64,
    /// Fraction of machines whose measured error is within [`MAX_PREDICTION_ERROR`] of the predicted one.
    pub predicted: f64,
}

impl Figures {
    /// The figures of at least one round trip.
    #[must_use]
    pub fn of(trips: &[RoundTrip]) -> Option<Self> {
        let mut ratios: Vec<f64> = trips.iter().map(RoundTrip::ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let predicted = trips.iter().filter(|trip| trip.prediction_error() <= MAX_PREDICTION_ERROR).count();
        Some(Self {
            count: trips.len(),
            median_ratio: *ratios.get(ratios.len() / 2)?,
            ninth_ratio: *ratios.get(ratios.len() / 10)?,
            min_ratio: *ratios.first()?,
            predicted: predicted as f64 / trips.len() as f64,
        })
    }

    /// As JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "machines": self.count,
            "median_ratio": self.median_ratio,
            "ratio_of_nine_in_ten": self.ninth_ratio,
            "min_ratio": self.min_ratio,
            "predicted_within_15_percent": self.predicted,
        })
    }
}
