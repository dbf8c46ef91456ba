//! Round trips of many machines: logged, traced, compensated, run again.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde_json::{Value, json};

use super::second_machine::SecondMachine;
use super::{Compensated, DemoError, MACHINE, compensated, draw_several, logs};
use commissioning::compensate::controller_host::ControllerHost;
use commissioning::compensate::file::{AxisCompensation, CompensationFile};
use commissioning::compensate::limits::{Limit, Limits};
use commissioning::compensate::round_trip::{MachineUnderTest, SimulatedMachine, totals_um};
use commissioning::compensate::servo::ControllerChange;
use model::axis::Law;
use model::machine::Machine;
use plant::instruments::Instruments;
use self_test::case::Case;
use self_test::truth::Truth;
use trace::Identification;

/// How far the measured error may be from the predicted one, as a fraction.
pub const MAX_PREDICTION_ERROR: f64 = 0.15;

/// Velocity feed-forward that is already set, as in published comparisons: Kf, %, and time ahead of the command, s.
pub const FEEDFORWARD: (f64, f64) = (100.0, 1.25e-3);

/// The round trip of one machine.
#[derive(Clone, Debug)]
pub struct RoundTrip {
    /// Seed of the machine.
    pub seed: u64,
    /// Its effects, as `axis: name`.
    pub effects: Vec<String>,
    /// The effects found, in the order of the axes.
    pub found: Vec<String>,
    /// Contour error before, as predicted, and after, µm rms over all motions.
    pub contour_um: [f64; 3],
    /// What limits the error that is left.
    pub limits: Limits,
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
            "limits": self.limits.json(),
        })
    }

    /// Relative difference of the measured error from the predicted one.
    #[must_use]
    pub fn prediction_error(&self) -> f64 {
        (self.contour_um[2] / self.contour_um[1] - 1.0).abs()
    }
}

/// Which machines make the round trip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Machines {
    /// Who simulates them.
    pub simulator: Simulator,
    /// Whether they have [`FEEDFORWARD`] before the compensation.
    pub has_feedforward: bool,
}

/// Who simulates the machines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Simulator {
    /// The plant of this program: machines of the demonstration, logged with the feed-forward that they have.
    Plant,
    /// The second simulator: machines of the self-test, logged with its own controller and the feed-forward of each machine.
    SelfTest,
}

/// Executes the round trips of `count` machines with one to three effects of the catalogue, from the first seed on. `done` receives
/// the number of finished machines.
///
/// # Errors
/// If a machine cannot be simulated, traced or compensated.
pub fn round_trips(
    machines: Machines,
    first_seed: u64,
    count: u64,
    done: &(dyn Fn(usize) + Sync),
) -> Result<Vec<RoundTrip>, DemoError> {
    let finished = AtomicUsize::new(0);
    let is_taken = |seed: &u64| machines.simulator == Simulator::Plant || is_like_demo(*seed);
    let seeds: Vec<u64> = (first_seed..).filter(is_taken).zip(0..count).map(|(seed, _)| seed).collect();
    let one = |(number, seed): (usize, u64)| {
        let trip = match machines.simulator {
            Simulator::Plant => of_demo(&declared(machines.has_feedforward)?, seed, 1 + number % 3),
            Simulator::SelfTest => of_self_test(seed, machines.has_feedforward),
        };
        done(1 + finished.fetch_add(1, Ordering::Relaxed));
        trip
    };
    seeds.into_par_iter().enumerate().map(one).collect()
}

/// The declared machine of the demonstration, as it is or with [`FEEDFORWARD`].
///
/// # Errors
/// If its file is invalid.
pub fn declared(has_feedforward: bool) -> Result<Machine, DemoError> {
    let mut declared = Machine::parse(MACHINE, "machines/demo.toml")?;
    if has_feedforward {
        for axis in declared.axis.values_mut() {
            axis.settings.controller.feedforward_percent = Some(FEEDFORWARD.0);
            axis.settings.controller.feedforward_ahead_s = Some(FEEDFORWARD.1);
        }
    }
    Ok(declared)
}

/// The round trip of a machine of the demonstration with this number of effects.
fn of_demo(declared: &Machine, seed: u64, effects: usize) -> Result<RoundTrip, DemoError> {
    let (truth, effects) = draw_several(declared, seed, effects);
    let [fit, validate] = logs(&truth, seed)?;
    let trace = trace::trace(declared, &fit, &validate, &|_| ())?;
    let effects = effects.iter().map(|(axis, effect)| format!("{axis}: {}", effect.name())).collect();
    let instruments = Instruments::typical(seed);
    let machine_under_test =
        SimulatedMachine { machine: &truth, instruments, controller_host: ControllerHost::Host };
    round_trip(seed, effects, &trace, (&machine_under_test, &CompensationFile::none(declared)))
}

/// Seed of the cases of the self-test that make round trips; the seed of a machine is the number of its case.
const SELF_TEST_SEED: u64 = 1;

/// Whether a case of the self-test has one to three effects, all of them of the catalogue.
fn is_like_demo(number: u64) -> bool {
    let effects = Case::undeclared(SELF_TEST_SEED, number);
    (1..=3).contains(&effects.len()) && !effects.iter().any(Truth::is_outside)
}

/// The round trip of the machine of a case of the self-test.
fn of_self_test(number: u64, has_feedforward: bool) -> Result<RoundTrip, DemoError> {
    let case = Case::draw(SELF_TEST_SEED, number)?;
    let trace = trace::trace(&case.machine, &case.fit, &case.validate, &|_| ())?;
    let effects = case.truths.iter().map(|truth| format!("{}: {}", truth.axis, truth.name)).collect();
    let mut before = CompensationFile::none(&case.machine);
    if has_feedforward {
        let (percent, ahead_s) = FEEDFORWARD;
        let controller = ControllerChange {
            law: Some(Law::P),
            feedforward_percent: Some(percent),
            feedforward_ahead_s: Some(ahead_s),
            ..ControllerChange::default()
        };
        let axis = AxisCompensation { controller, ..AxisCompensation::default() };
        before.axis = case.machine.axis.keys().map(|name| (name.clone(), axis.clone())).collect();
    }
    round_trip(number, effects, &trace, (&SecondMachine::of(&case, number), &before))
}

fn round_trip(
    seed: u64,
    effects: Vec<String>,
    trace: &Identification,
    machine_under_test: (&dyn MachineUnderTest, &CompensationFile),
) -> Result<RoundTrip, DemoError> {
    let Compensated { motions, limits, .. } = compensated(&trace.better_machine(), machine_under_test, seed)?;
    Ok(RoundTrip { seed, effects, found: trace.found_names(), contour_um: totals_um(&motions), limits })
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
    /// On how many machines each of [`Limit::ALL`] is the largest part of what is left.
    pub limited_by: [usize; 4],
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
            limited_by: Limit::ALL
                .map(|limit| trips.iter().filter(|trip| trip.limits.largest() == limit).count()),
        })
    }

    /// As JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        let limited_by: serde_json::Map<String, Value> = Limit::ALL
            .iter()
            .zip(self.limited_by)
            .map(|(limit, machines)| (limit.word().to_owned(), json!(machines)))
            .collect();
        json!({
            "machines": self.count,
            "median_ratio": self.median_ratio,
            "ratio_of_nine_in_ten": self.ninth_ratio,
            "min_ratio": self.min_ratio,
            "predicted_within_15_percent": self.predicted,
            "limited_by": limited_by,
        })
    }
}
