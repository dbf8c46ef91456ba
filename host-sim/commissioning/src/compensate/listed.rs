//! The parts of a compensation as items for a reader: what each does, and why others are left out.

use std::collections::{BTreeMap, BTreeSet};

use crate::compensate::choice::{Choice, Part, Strength};
use crate::compensate::law_parts::law_terms;
use crate::compensate::planning::Planning;
use model::axis::Drive;
use model::effects::EffectCompensation;
use model::residual_table::first_other;

/// Why a part has no setting, and what to do instead.
const NO_SETTING: (&str, &str) = (
    "no setting of the controller is left for it: tables of two periods, one source of cross-talk and straightness, three products, friction \
     only as part of the force feed-forward",
    "remove its cause, or join effects of the same period",
);

/// Why an error over the position is not compensated, and what to do instead.
const BEYOND: (&str, &str) = (
    "it is not known where the motions are: they leave its map by more than a tenth of its travel",
    "measure the travel of the motions, or plan with motions within the map",
);

/// Why parts are left out.
#[derive(Clone, Debug)]
pub(crate) struct LeftOut {
    /// They change no setting.
    pub idle: BTreeSet<Part>,
    /// The motions leave the travel in which they are known.
    pub unknown: BTreeSet<Part>,
    /// They make a motion worse: its name.
    pub worse: BTreeMap<Part, String>,
}

/// What is compensated, and what the model predicts of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Name of the effect, or of the part of the declared model.
    pub effect: String,
    /// Name of the axis; all axes: empty.
    pub axis: String,
    /// What the controller does.
    pub does: String,
    /// Rms of the contour error without this item and with all others, µm.
    pub before_um: f64,
    /// Rms of the contour error with all items, µm.
    pub after_um: f64,
}

/// What is not compensated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotCompensated {
    /// Name of the effect, or of the part of the declared model.
    pub effect: String,
    /// Name of the axis; all axes: empty.
    pub axis: String,
    /// Why.
    pub why: String,
    /// What to do instead.
    pub instead: String,
}

impl Planning<'_> {
    /// Whether the drive of an axis, by its number, is commanded by a velocity.
    fn commands_velocity(&self, axis: usize) -> bool {
        self.model.axis[axis].settings.controller.drive == Drive::Velocity
    }

    /// Names of effect and axis of a part.
    pub(crate) fn names(&self, part: &Part) -> (String, String) {
        let axis = |index: usize| self.model.axis.get_index(index).map_or("", |(name, _)| name).to_owned();
        match *part {
            Part::Effect(index, effect) => {
                (self.model.axis[index].effect[effect].name().to_owned(), axis(index))
            }
            Part::LawTerm(index, law, term) => {
                let other = axis(first_other(index));
                let term = &self.model.axis[index].residual_law[law].term[term];
                (format!("law: {}", term.form(&axis(index), &other)), axis(index))
            }
            Part::Force(index) => {
                let name =
                    if self.commands_velocity(index) { "friction_feedforward" } else { "force_feedforward" };
                (name.to_owned(), axis(index))
            }
            Part::Stretch(index) => ("stretch".to_owned(), axis(index)),
            Part::Feedforward => ("velocity_feedforward".to_owned(), String::new()),
            Part::Law => ("control_law".to_owned(), String::new()),
        }
    }

    pub(crate) fn item(&self, (part, choice): (&Part, &Choice), before_um: f64, after_um: f64) -> Item {
        let (effect, axis) = self.names(part);
        let Strength { percent, stretch, .. } = choice.strength;
        let does = match part {
            Part::Effect(index, effect) => {
                self.model.axis[*index].effect[*effect].compensation().description()
            }
            Part::LawTerm(..) => {
                "the value of the term for the commanded motion is subtracted from the command; a law holds for motions like those measured"
                    .to_owned()
            }
            Part::Force(index) if self.commands_velocity(*index) => {
                "the velocity that friction takes from the drive after a reversal is added to its command"
                    .to_owned()
            }
            Part::Force(_) => {
                "the force for the commanded acceleration, friction and load is added to the controller's"
                    .to_owned()
            }
            Part::Stretch(_) if stretch < 1.0 => format!(
                "{} % of the stretch of the drive under the modelled force is added to the command: friction falls at rest",
                100.0 * stretch
            ),
            Part::Stretch(_) => {
                "the stretch of the drive under the modelled force is added to the command".to_owned()
            }
            Part::Feedforward if percent < 100.0 => {
                format!("Kf is set to {percent} % on all axes: with 100 % they overshoot where they stop")
            }
            Part::Feedforward => "Kf is set to 100 % on all axes".to_owned(),
            Part::Law => "P control takes the place of HPC, which filters the feed-forward, too".to_owned(),
        };
        Item { effect, axis, does, before_um, after_um }
    }

    pub(crate) fn not_compensated(&self, off: &BTreeSet<Part>, left_out: &LeftOut) -> Vec<NotCompensated> {
        let mut list = Vec::new();
        for (name, axis) in &self.model.axis {
            for effect in &axis.effect {
                if let EffectCompensation::Not { why, instead } = effect.compensation() {
                    let (why, instead) = (why.to_owned(), instead.to_owned());
                    list.push(NotCompensated {
                        effect: effect.name().to_owned(),
                        axis: name.clone(),
                        why,
                        instead,
                    });
                }
            }
        }
        let with_tables = self.model.axis.iter().filter(|(_, axis)| !axis.empirical.is_empty());
        list.extend(with_tables.map(|(name, _)| NotCompensated {
            effect: "empirical".to_owned(),
            axis: name.clone(),
            why: "a table of a residual does not say what causes it, and holds for motions like those measured".to_owned(),
            instead: "find its cause; a table of the error over the position can be entered as a pitch_map".to_owned(),
        }));
        list.extend(self.model.axis.values().enumerate().flat_map(|(index, axis)| {
            law_terms(axis, index).filter_map(|(part, _, refused)| {
                let ((effect, axis), (why, instead)) = (self.names(&part), refused?);
                Some(NotCompensated { effect, axis, why: why.to_owned(), instead: instead.to_owned() })
            })
        }));
        list.extend(off.iter().map(|part| {
            let (effect, axis) = self.names(part);
            let (why, instead) = if left_out.unknown.contains(part) {
                (BEYOND.0.to_owned(), BEYOND.1)
            } else if left_out.idle.contains(part) {
                (NO_SETTING.0.to_owned(), NO_SETTING.1)
            } else if let Some(motion) = left_out.worse.get(part) {
                (
                    format!("with it the simulated contour error of the motion {motion} is larger than without compensation"),
                    "remove its cause",
                )
            } else {
                (
                    "the simulated contour error is smaller without it".to_owned(),
                    "measure with motions that show it more",
                )
            };
            NotCompensated { effect, axis, why, instead: instead.to_owned() }
        }));
        list
    }
}
