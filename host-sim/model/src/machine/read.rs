//! Reads a machine file.

use std::path::Path;

use files::document::{Document, read_text};
use files::error::InputError;

use super::declared::Machine;
use super::{check, rotary};
use crate::axis::KeyNames;

impl Machine {
    /// Reads a machine file.
    ///
    /// # Errors
    /// If the file cannot be read, or does not describe a machine that can exist.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        Self::parse(&read_text(path)?, &path.display().to_string())
    }

    /// Reads the text of a machine file; `source` names it in error messages.
    ///
    /// # Errors
    /// If the text does not describe a machine that can exist.
    pub fn parse(text: &str, source: &str) -> Result<Self, InputError> {
        let written = Document::parse(text, source)?;
        let linear = rotary::to_linear(&written)?;
        let document = Document::parse(&linear.text, source)?.written_as(&written, linear.renamed);
        check::effects(&document)?;
        let mut machine: Self = document.deserialize()?;
        let order = document.children("axis");
        let position = |name: &String| order.iter().position(|key| key[5..] == name[..]);
        machine.axis.sort_by_cached_key(|name, _| position(name));
        for name in &linear.axes {
            if let Some(axis) = machine.axis.get_mut(name) {
                axis.settings.names = KeyNames::Rotary;
            }
        }
        check::machine(&machine, &document)?;
        Ok(machine)
    }
}
