//! The motion that would refute a law, and what the law predicts there as a number.
//!
//! The machine is simulated along [`Strokes`] within the travel, speed and acceleration of the logs, without noise of its sensors. The law is evaluated
//! there, and stated for the two instants between which it changes most.

use super::distinguishing_motion::run;
use super::strokes::Strokes;
use crate::analysis::law::FoundLaw;
use crate::analysis::law::reversals::near_reversals;
use crate::analysis::law::samples::columns_of;
use crate::analysis::law::spread::neighbours;
use crate::input::signals::{AxisSignals, Signals};
use crate::options::TraceOptions;
use crate::prediction::law_terms::LogVariables;
use crate::prediction::table_variable;
use model::machine::Machine;
use model::residual_law::Term;
use model::residual_table::TableVariable;
use motion::Lines;
use plant::instruments::Instruments;
use plant::sensors::Sensor;

/// The 97.5 % point of the normal distribution.
const NORMAL_975: f64 = 1.96;

/// Largest acceleration of a steady motion, as a fraction of the largest of all axes.
const STEADY: f64 = 0.05;

/// Time at the start that is not stated, s: the motion begins with a longer standstill.
const SETTLING_S: f64 = 0.3;

/// A motion that would refute a law.
#[derive(Clone, Debug)]
pub struct Refutation {
    /// The motion.
    pub motion: Lines,
    /// Which axis moves where, and how.
    pub how: String,
    /// What the law predicts; `None` if the machine file does not suffice to simulate the motion.
    pub prediction: Option<Prediction>,
}

/// The change of the residual between two instants by a law, µm or N.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// The instants.
    pub instants: [Instant; 2],
    /// The change.
    pub change: f64,
    /// Half of its 95 % interval by the values of the law.
    pub half_width: f64,
    /// Half of the 95 % interval of a measured change: also by what the law leaves of the held-out logs at either instant.
    pub tolerance: f64,
}

/// An instant of a motion.
#[derive(Clone, Debug)]
pub struct Instant {
    /// Time since its start, s.
    pub at_s: f64,
    /// The variables of the law with their values, in the units of tables.
    pub values: Vec<(TableVariable, f64)>,
}

impl Refutation {
    /// The motion that would refute a law of an axis of a machine, by its number; `None` if the axes do not move in the logs.
    #[must_use]
    pub fn of(
        law: &FoundLaw,
        (machine, axis): (&Machine, usize),
        logs: &[Signals],
        options: &TraceOptions,
    ) -> Option<Self> {
        let names: Vec<String> = machine.axis.keys().cloned().collect();
        let terms: Vec<&Term> = law.terms.iter().map(|found| &found.term).collect();
        let Strokes { motion, how } = Strokes::of(&terms, (&names, axis), logs, &options.admission)?;
        let quiet = Instruments::typical(1).with_sensors(|_| Sensor::default());
        let log = run(machine, motion.motion()?, quiet);
        let signals = log.map(|log| Signals::new(&log, &names, &options.samples));
        let prediction = signals.and_then(|signals| prediction(law, axis, &signals));
        Some(Self { motion, how, prediction })
    }

    /// How large the predicted change is, in units of the tolerance.
    #[must_use]
    pub fn clarity(&self) -> f64 {
        self.prediction.as_ref().map_or(0.0, |prediction| prediction.change.abs() / prediction.tolerance)
    }

    /// Text of the motion file.
    #[must_use]
    pub fn to_toml(&self) -> String {
        self.motion.to_toml(&format!("{}: would refute a law.", self.how))
    }
}

/// The change of a law between the instants of a log at which it is smallest and largest.
fn prediction(law: &FoundLaw, axis: usize, signals: &Signals) -> Option<Prediction> {
    let terms: Vec<Term> = law.terms.iter().map(|found| found.term.clone()).collect();
    let mut variables: Vec<TableVariable> = terms.iter().flat_map(Term::variables).collect();
    variables.sort_unstable_by_key(|variable| format!("{variable:?}"));
    variables.dedup();
    let of_log = LogVariables::new(signals, axis, law.stage, &variables);
    if !terms.iter().all(|term| of_log.has(term)) {
        return None;
    }
    let parts: Vec<[Vec<f64>; 2]> = terms.iter().map(|term| of_log.parts(term)).collect();
    let value = |sample: usize| -> f64 {
        let of_term = |(term, [first, second]): (&Term, &[Vec<f64>; 2])| {
            let [a, b] = term.coefficients();
            a * first[sample] + b * second[sample]
        };
        terms.iter().zip(&parts).map(of_term).sum()
    };
    let samples: Vec<(usize, f64)> =
        stated(signals, &variables).into_iter().map(|sample| (sample, value(sample))).collect();
    let (from, least) = samples.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (to, most) = samples.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let half_width = law.spread.half_width(&slopes(&terms, &of_log, [from, to]));
    let left = NORMAL_975 * 2f64.sqrt() * law.after.validate;
    let instant = |sample: usize| Instant {
        at_s: sample as f64 * signals.sample_s,
        values: variables
            .iter()
            .filter_map(|&one| Some((one, table_variable::values(signals, axis, one)?[sample])))
            .collect(),
    };
    Some(Prediction {
        instants: [from, to].map(instant),
        change: most - least,
        half_width,
        tolerance: libm::hypot(half_width, left),
    })
}

/// The samples that are stated: in steady motion, as the machine itself differs from its simulation most where it accelerates, unless the law depends on
/// acceleration or force; after the settling, and not near a reversal.
fn stated(signals: &Signals, variables: &[TableVariable]) -> Vec<usize> {
    let motions = || signals.axes.iter().filter_map(AxisSignals::table_or_motor);
    let reversals: Vec<Vec<bool>> = motions().map(near_reversals).collect();
    let largest = numerics::max_abs(motions().flat_map(|motion| motion.acceleration.iter().copied()));
    let is_steady =
        |sample: usize| motions().all(|motion| motion.acceleration[sample].abs() <= STEADY * largest);
    let of_acceleration = |one: &TableVariable| {
        use TableVariable::{AccelerationMPerS2, ForceN, OtherAccelerationMPerS2};
        matches!(one, AccelerationMPerS2 | OtherAccelerationMPerS2 | ForceN)
    };
    let is_any = variables.iter().any(of_acceleration);
    let is_settled = |sample: usize| sample as f64 * signals.sample_s >= SETTLING_S;
    let is_stated = |&sample: &usize| {
        is_settled(sample)
            && reversals.iter().all(|near| !near.get(sample).copied().unwrap_or(true))
            && (is_any || is_steady(sample))
    };
    (0..signals.len()).filter(is_stated).collect()
}

/// The derivatives of the change of a law between two samples with respect to its values: coefficients, then periods and distances.
fn slopes(terms: &[Term], of_log: &LogVariables<'_>, [from, to]: [usize; 2]) -> Vec<f64> {
    let changes = |term: &Term| of_log.parts(term).map(|part| part[to] - part[from]);
    let of_coefficients = terms.iter().flat_map(|term| changes(term).into_iter().take(columns_of(term)));
    let of_length = |pair: [Term; 2]| -> f64 {
        let of_neighbour = |neighbour: &Term| {
            let ([a, b], [x, y]) = (neighbour.coefficients(), changes(neighbour));
            a * x + b * y
        };
        pair.iter().map(of_neighbour).sum()
    };
    of_coefficients.chain(terms.iter().filter_map(neighbours).map(of_length)).collect()
}
