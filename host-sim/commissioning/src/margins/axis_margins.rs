//! The margins of the axes of a machine file.

use shared::config::{AxisSettings, Rates, ScheduledOver};

use super::linear_axis::LinearAxis;
use super::margin::{At, Margins};
use super::mechanics::Condition;
use model::axis::Feedback;
use model::machine::Machine;
use model::servo;
use plant::instruments::Instruments;
use plant::parameters::AxisParameters;

/// Lowest and highest position gain of the search for the highest, 1/s.
const GAINS_PER_S: [f64; 2] = [1.0, 1e4];

/// Margins that a loop must have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarginLimits {
    /// Gain margin, dB.
    pub gain_db: f64,
    /// Phase margin, degrees.
    pub phase_deg: f64,
}

impl Default for MarginLimits {
    /// The gain may double, and the phase may lag by 30° more: the lower ends of what textbooks of servo control recommend
    /// (6 to 12 dB and 30 to 60°; Åström and Murray, *Feedback Systems*, 2nd edition, section 10.3).
    fn default() -> Self {
        Self { gain_db: 6.0, phase_deg: 30.0 }
    }
}

/// Why an axis has no margins.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MarginError {
    /// A key that the machine file lacks.
    #[error("axis {axis}: lacks {key}")]
    Lacks {
        /// Name of the axis.
        axis: String,
        /// The key.
        key: &'static str,
    },
}

/// The smallest margins of a loop over all conditions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopMargins {
    /// The condition in which the closed loop is not stable, if there is one.
    pub unstable: Option<Condition>,
    /// Gain margin, dB, and its condition.
    pub gain_db: Option<(At, Condition)>,
    /// Phase margin, degrees, and its condition.
    pub phase_deg: Option<(At, Condition)>,
}

impl LoopMargins {
    fn of(margins: &[(Condition, Margins)]) -> Self {
        let least = |margin: fn(&Margins) -> Option<At>| {
            let all = margins.iter().filter_map(|(condition, margins)| Some((margin(margins)?, *condition)));
            all.min_by(|a, b| a.0.value.total_cmp(&b.0.value))
        };
        Self {
            unstable: margins.iter().find(|(_, margins)| !margins.is_stable).map(|(condition, _)| *condition),
            gain_db: least(|margins| margins.gain_db),
            phase_deg: least(|margins| margins.phase_deg),
        }
    }

    /// Whether the loop is stable and has these margins.
    #[must_use]
    pub fn meet(&self, limits: MarginLimits) -> bool {
        let reaches = |margin: Option<(At, Condition)>, least| margin.is_none_or(|(at, _)| at.value >= least);
        self.unstable.is_none()
            && reaches(self.gain_db, limits.gain_db)
            && reaches(self.phase_deg, limits.phase_deg)
    }
}

/// The margins of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisMargins {
    /// Name of the axis.
    pub axis: String,
    /// Of the velocity loop, with the position loop open.
    pub velocity: LoopMargins,
    /// Of the position loop.
    pub position: LoopMargins,
    /// Kp, 1/s.
    pub position_gain_per_s: f64,
    /// Highest Kp at which the position loop has the margins that are asked for, up to 10 000/s; `None`: even the lowest, 1/s,
    /// does not have them.
    pub highest_position_gain_per_s: Option<f64>,
}

/// What the margins of an axis follow from.
#[derive(Clone, Debug)]
pub struct AxisLoops {
    settings: AxisSettings,
    rates: Rates,
    parameters: AxisParameters,
    instruments: Instruments,
    feedback: Feedback,
}

impl AxisMargins {
    /// Whether both loops have these margins.
    #[must_use]
    pub fn meet(&self, limits: MarginLimits) -> bool {
        self.velocity.meet(limits) && self.position.meet(limits)
    }
}

impl AxisLoops {
    /// The loops of all axes of a machine, in the order of its file.
    ///
    /// # Errors
    /// The first axis that lacks a key of its controller or its masses.
    pub fn of_machine(machine: &Machine, instruments: &Instruments) -> Result<Vec<Self>, MarginError> {
        let axes = machine.axis.iter().zip(AxisParameters::of_machine(machine));
        axes.map(|((name, axis), parameters)| {
            let lacks = |key| MarginError::Lacks { axis: name.clone(), key };
            let is_elastic = parameters.spring.is_some();
            if parameters.motor_mass_kg + parameters.table_mass_kg <= 0.0
                || (is_elastic && parameters.table_mass_kg <= 0.0)
            {
                return Err(lacks("table_mass_kg"));
            }
            if is_elastic && parameters.motor_mass_kg <= 0.0 {
                return Err(lacks("motor_mass_kg"));
            }
            Ok(Self {
                settings: servo::settings(&axis.settings, &parameters.servo).map_err(lacks)?,
                rates: machine.rates(),
                parameters,
                instruments: *instruments,
                feedback: axis.settings.sensors.feedback,
            })
        })
        .collect()
    }

    /// These loops with another position gain, 1/s.
    #[must_use]
    pub fn with_position_gain(&self, gain_per_s: f64) -> Self {
        let mut other = self.clone();
        other.settings.position_gain_per_s = gain_per_s;
        other
    }

    /// The linear model in a condition.
    #[must_use]
    pub fn linear(&self, condition: Condition) -> LinearAxis {
        LinearAxis::new(&self.settings, self.rates, &self.parameters, &self.instruments, condition)
    }

    fn conditions(&self) -> impl Iterator<Item = Condition> {
        Condition::ALL.into_iter().filter(|condition| condition.is_possible(&self.parameters))
    }

    /// These loops with each velocity gain that a gain schedule gives them: at its points, between which are no others; over position also
    /// the gain before the axis is homed. Without a schedule, the loops as they are.
    fn scheduled(&self) -> Vec<Self> {
        let Some(schedule) = &self.settings.gain_schedule else { return vec![self.clone()] };
        let not_homed = (schedule.over == ScheduledOver::Position).then_some(1.0);
        let ratios = schedule.iter().map(|point| point.ratio).chain(not_homed);
        let with_ratio = |ratio: f64| {
            let mut loops = self.clone();
            loops.settings.velocity_gain_n_s_per_m *= ratio;
            loops
        };
        ratios.map(with_ratio).collect()
    }

    /// Margins of the velocity loop.
    #[must_use]
    pub fn velocity(&self) -> LoopMargins {
        let of = |axis: LinearAxis| Margins::of(&axis.velocity_loop(), axis.tick_s(), true);
        LoopMargins::of(&self.each(self.conditions(), of))
    }

    /// Margins of the position loop. Within the backlash the scale does not move: only a loop that is closed by the motor alone
    /// has margins there.
    #[must_use]
    pub fn position(&self) -> LoopMargins {
        let is_closed =
            |condition: &Condition| *condition != Condition::InBacklash || self.feedback == Feedback::Motor;
        let of = |axis: LinearAxis| Margins::of(&axis.position_loop(), axis.position_tick_s(), false);
        LoopMargins::of(&self.each(self.conditions().filter(is_closed), of))
    }

    /// The margins in each condition, with each scheduled gain.
    fn each(
        &self,
        conditions: impl Iterator<Item = Condition>,
        margins: impl Fn(LinearAxis) -> Margins,
    ) -> Vec<(Condition, Margins)> {
        let loops = self.scheduled();
        let of = |condition| loops.iter().map(move |loops| (condition, loops.linear(condition)));
        conditions.flat_map(of).map(|(condition, axis)| (condition, margins(axis))).collect()
    }

    /// Highest Kp, 1/s, up to which the position loop has these margins; `None`: the lowest does not have them.
    #[must_use]
    pub fn highest_position_gain_per_s(&self, limits: MarginLimits) -> Option<f64> {
        self.highest_usable_position_gain_per_s(|loops| loops.position().meet(limits))
    }

    /// Highest Kp, 1/s, up to which these loops are usable; `None`: with the lowest they are not.
    #[must_use]
    pub fn highest_usable_position_gain_per_s(&self, is_usable: impl Fn(&Self) -> bool) -> Option<f64> {
        const STEP: f64 = 1.1;
        const HALVINGS: usize = 10;
        let is_usable = |gain: f64| is_usable(&self.with_position_gain(gain));
        let [lowest, highest] = GAINS_PER_S;
        if !is_usable(lowest) {
            return None;
        }
        let mut usable = lowest;
        while usable < highest && is_usable(usable * STEP) {
            usable *= STEP;
        }
        if usable >= highest {
            return Some(highest);
        }
        let (mut low, mut high) = (usable, usable * STEP);
        for _ in 0..HALVINGS {
            let middle = (low * high).sqrt();
            if is_usable(middle) { low = middle } else { high = middle }
        }
        Some(low)
    }
}

/// The margins of all axes of a machine; the highest position gain is the one with `limits`.
///
/// # Errors
/// The first axis that lacks a key.
pub fn of_machine(
    machine: &Machine,
    instruments: &Instruments,
    limits: MarginLimits,
) -> Result<Vec<AxisMargins>, MarginError> {
    let loops = AxisLoops::of_machine(machine, instruments)?;
    let of = |(name, loops): (&String, AxisLoops)| AxisMargins {
        axis: name.clone(),
        velocity: loops.velocity(),
        position: loops.position(),
        position_gain_per_s: loops.settings.position_gain_per_s,
        highest_position_gain_per_s: loops.highest_position_gain_per_s(limits),
    };
    Ok(machine.axis.keys().zip(loops).map(of).collect())
}
