//! Logs of machines whose effects are known.

use std::collections::BTreeSet;
use std::path::Path;

use files::log::{Channel, Log};
use model::machine::Machine;
use tests::cases;

/// An effect: its axis and its name.
pub type Named = (String, String);

/// Logs of a machine whose effects are known.
#[derive(Clone)]
pub struct Case {
    /// Name in messages.
    pub name: String,
    /// The machine file.
    pub machine: String,
    /// Fit logs and validation logs.
    pub logs: [Vec<Log>; 2],
    /// The effects that the machine file lacks.
    pub truth: BTreeSet<Named>,
}

impl Case {
    /// The blind cases; `None` where there are no data.
    pub fn blind() -> Option<Vec<Self>> {
        Some(cases::folders()?.iter().map(|folder| Self::read(folder)).collect())
    }

    /// The blind case with this name.
    pub fn blind_named(name: &str) -> Option<Self> {
        let folders = cases::folders()?;
        folders.iter().find(|folder| folder.ends_with(name)).map(|folder| Self::read(folder))
    }

    /// A simulated machine with a backlash, an error of squareness and a late probe.
    pub fn simulated() -> Self {
        Self::simulated_with(&[
            ("x", "backlash", "width_um = 12.0"),
            ("x", "squareness", "um_per_m = 60.0"),
            ("y", "latency", "channel = \"tool\"\nms = 0.4"),
        ])
    }

    /// The demo's machine with effects: axis, name, parameters.
    pub fn simulated_with(effects: &[(&str, &str, &str)]) -> Self {
        let entry = |(axis, name, keys): &(&str, &str, &str)| {
            format!("[[axis.{axis}.effect]]\nname = \"{name}\"\n{keys}\n")
        };
        let effects_of_file: String = effects.iter().map(entry).collect();
        let true_machine =
            Machine::parse(&format!("{}\n{effects_of_file}", demo::MACHINE), "true.toml").unwrap();
        Self {
            name: "simulated".to_owned(),
            machine: demo::MACHINE.to_owned(),
            logs: demo::logs(&true_machine, 1).unwrap(),
            truth: effects.iter().map(|(axis, name, _)| ((*axis).to_owned(), (*name).to_owned())).collect(),
        }
    }

    fn read(folder: &Path) -> Self {
        let text = |file: &str| std::fs::read_to_string(folder.join(file)).unwrap();
        let truth: serde_json::Value = serde_json::from_str(&text("truth.json")).unwrap();
        let word = |effect: &serde_json::Value, key: &str| effect[key].as_str().unwrap().to_owned();
        let effects = truth["effects"].as_array().unwrap().iter();
        let logs =
            |prefix: &str| cases::logs(folder, prefix).iter().map(|path| Log::read(path).unwrap()).collect();
        Self {
            name: folder.file_name().unwrap().to_string_lossy().into_owned(),
            machine: text("machine.toml"),
            logs: ["fit_", "validate_"].map(logs),
            truth: effects.map(|effect| (word(effect, "axis"), word(effect, "name"))).collect(),
        }
    }

    /// The declared machine.
    pub fn machine(&self) -> Machine {
        Machine::parse(&self.machine, "machine.toml").unwrap()
    }

    /// Removes a channel of all axes from some of the fit logs and from all validation logs.
    pub fn without(mut self, channel: Channel, fit_logs: impl Fn(usize) -> bool) -> Self {
        let [fit, validate] = &mut self.logs;
        let fit = fit.iter_mut().enumerate().filter(|(number, _)| fit_logs(*number)).map(|(_, log)| log);
        for axis in fit.chain(validate).flat_map(|log| &mut log.axes) {
            *axis.channel_mut(channel) = None;
        }
        self
    }
}

/// The effects of a result, each with its axis, that are certain.
pub fn certain(json: &serde_json::Value) -> BTreeSet<Named> {
    of(json, |effect| effect["certainty"] == "certain")
}

/// All effects of a result, each with its axis.
pub fn named(json: &serde_json::Value) -> BTreeSet<Named> {
    of(json, |_| true)
}

fn of(json: &serde_json::Value, is_asked: impl Fn(&serde_json::Value) -> bool) -> BTreeSet<Named> {
    let word = |effect: &serde_json::Value, key: &str| effect[key].as_str().unwrap().to_owned();
    let effects = json["effects"].as_array().unwrap().iter();
    effects
        .filter(|effect| is_asked(effect))
        .map(|effect| (word(effect, "axis"), word(effect, "name")))
        .collect()
}
