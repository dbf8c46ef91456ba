//! The machine file with a comment for each value, and what is said on the terminal.

use model::axis::{Drive, KeyNames, Tolerated};
use model::machine::{Axis, rotary};

use crate::initial::{Initial, Value};
use crate::rough::Origin;

/// The text of the file, from the names of the logs.
#[must_use]
pub fn file(initial: &Initial, logs: &[String]) -> String {
    let mut text = format!(
        "# Written by `lost-motion init` from {}.\n# A value without a comment is as declared. The tolerances are the intervals of the fit with a margin: a trace \
         moves\n# the values within them. What is not in this file is unknown.\n",
        logs.join(", ")
    );
    let mut axis = String::new();
    for line in initial.machine.to_toml().lines() {
        if let Some(table) = line.strip_prefix("[axis.").and_then(|rest| rest.strip_suffix(']')) {
            table.clone_into(&mut axis);
        }
        let key = line.split_once(" = ").map(|(key, _)| key);
        let names = initial.machine.axis.get(&axis).map_or(KeyNames::Linear, |axis| axis.settings.names);
        let is_it = |own| Some(rotary::written(own, 1.0, names).0) == key;
        let value = initial.values.iter().find(|((name, own), _)| *name == axis && is_it(*own));
        text += line;
        if let Some((_, value)) = value.filter(|(_, value)| value.origin != Origin::Known) {
            text += &format!("  # {}", value.source());
        }
        text.push('\n');
    }
    text
}

impl Value {
    /// Where the value comes from, in words, with its tolerance: the interval of the fit alone lacks the errors of the model.
    fn source(&self) -> String {
        match (self.origin, self.tolerance_percent) {
            (Origin::Known, _) => "declared".to_owned(),
            (Origin::Usual, _) => "usual value: the logs hardly show it".to_owned(),
            (Origin::Logs | Origin::Regression, None) => "from the logs".to_owned(),
            (Origin::Logs | Origin::Regression, Some(percent)) => format!("± {percent} % from the logs"),
        }
    }
}

/// What was found and what stays unknown: a sentence for each axis, then its values.
#[must_use]
pub fn summary(initial: &Initial) -> String {
    let mut text = String::new();
    for (name, axis) in &initial.machine.axis {
        text += &format!("{name}: {}.\n", drive(axis));
        for ((_, key), value) in initial.values.iter().filter(|((own, _), _)| own == name) {
            let tolerated = Tolerated::with_key(key);
            let Some(number) = tolerated.and_then(|tolerated| (tolerated.get)(&axis.settings)) else {
                continue;
            };
            let (key, number) = rotary::written(key, number, axis.settings.names);
            text += &format!("  {key:<30} {number:>12}  {}\n", value.source());
        }
    }
    for note in &initial.notes {
        text += &format!("{note}\n");
    }
    text
}

/// The drive and its loops in words.
fn drive(axis: &Axis) -> String {
    let controller = &axis.settings.controller;
    let closed = format!("closed by {}", axis.settings.sensors.feedback.word());
    match (controller.drive, controller.law) {
        (Drive::Torque, Some(law)) => {
            format!("drive with a force command, {} position loop {closed}", law.word())
        }
        (Drive::Torque, None) => "drive with a force command, the loops are not known".to_owned(),
        (Drive::Velocity, _) => format!("drive with a velocity command, position loop {closed}"),
        (Drive::Stepper, _) => "stepper motor without a loop".to_owned(),
    }
}
