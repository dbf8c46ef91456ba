//! A trace from the machine file that `lost-motion trace --model` writes.

use std::collections::BTreeMap;

use files::error::InputError;
use indexmap::IndexMap;
use jiff::civil::Date;
use model::axis::KeyNames;
use model::machine::Machine;
use model::machine::evidence::Certainty;

use crate::record::{Figure, Group, Name, Names, Record, Trust, undated};

/// A trace from the machine file that it wrote: the parameters of its effects. `None` if it is no machine file.
///
/// # Errors
/// A machine file that cannot be read, or one without a date.
pub fn read(text: &str, source: &str, day: Option<Date>) -> Result<Option<Record>, InputError> {
    if !text.lines().any(|line| line.trim_start().starts_with("[axis.")) {
        return Ok(None);
    }
    let machine = Machine::parse(text, source)?;
    let day = day.ok_or_else(|| undated(source))?;
    let mut names = Names::default();
    let mut figures = IndexMap::new();
    for (axis, declared) in &machine.axis {
        let is_rotary = declared.settings.names == KeyNames::Rotary;
        for (index, effect) in declared.effect.iter().enumerate() {
            let of = names.of(axis, effect.name(), effect.distinction().source());
            let evidence = declared.evidence.get(index).filter(|known| known.effect == effect.name());
            let parameters = effect.declared_parameters();
            for (at, (parameter, value)) in parameters.iter().zip(effect.values()).enumerate() {
                let half_width = evidence.and_then(|known| known.half_widths.get(at)).copied();
                if parameter.is_list || half_width == Some(0.0) {
                    continue;
                }
                let (axis, of) = (axis.clone(), of.clone());
                let name = Name { group: Group::Effect, axis, of, key: parameter.key_on(is_rotary) };
                let trust = trust(evidence.map(|known| known.certainty), half_width);
                figures.insert(name, Figure { value, half_width, trust });
            }
        }
    }
    Ok(Some(Record {
        source: source.to_owned(),
        day,
        machine: Some(machine.name),
        serial: None,
        temperature_c: None,
        figures,
        costs: BTreeMap::new(),
        not_testable: Vec::new(),
    }))
}

/// How far a value of a model counts.
fn trust(certainty: Option<Certainty>, half_width: Option<f64>) -> Trust {
    match certainty {
        None | Some(Certainty::Declared) => Trust::Declared,
        Some(Certainty::Ambiguous) => Trust::Ambiguous,
        Some(Certainty::Certain) if half_width.is_some() => Trust::Certain,
        Some(Certainty::Certain) => Trust::NoInterval,
    }
}
