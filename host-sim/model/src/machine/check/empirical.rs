//! Checks of the tables `[[axis.NAME.empirical]]`.

use super::Context;
use crate::machine::Machine;
use crate::residual_table::{ResidualTable, TableChannel};
use files::error::InputError;

/// Largest number of points; a trace writes up to 32.
const MOST_POINTS: usize = 1000;

impl Context<'_> {
    /// Two points or more that increase, as many values in the unit of the channel, another axis where the variable is one of
    /// it, and each pair of channel and variable once.
    pub(super) fn empirical(&self, machine: &Machine) -> Result<(), InputError> {
        let tables = &self.axis.empirical;
        for (index, table) in tables.iter().enumerate() {
            let key = format!("empirical[{index}]");
            self.points(&key, table)?;
            if table.variable.is_of_other_axis() && machine.axis.len() < 2 {
                return Err(
                    self.refuse(&format!("{key}.variable"), "a variable of this axis, as there is no other")
                );
            }
            let is_same =
                |other: &ResidualTable| (other.channel, other.variable) == (table.channel, table.variable);
            if tables[..index].iter().any(is_same) {
                return Err(self.refuse(&key, "at most one table of this channel and variable"));
            }
        }
        Ok(())
    }

    fn points(&self, key: &str, table: &ResidualTable) -> Result<(), InputError> {
        let at = format!("{key}.at");
        let is_increasing = table.at.windows(2).all(|two| two[0] < two[1]);
        if !(2..=MOST_POINTS).contains(&table.at.len()) || !is_increasing {
            return Err(self.refuse(&at, &format!("2 to {MOST_POINTS} numbers that increase")));
        }
        let ([of_channel, other], present) = if table.channel == TableChannel::Force {
            (["error_n", "error_um"], &table.error_um)
        } else {
            (["error_um", "error_n"], &table.error_n)
        };
        if !present.is_empty() {
            return Err(
                self.refuse(&format!("{key}.{other}"), &format!("{of_channel}, the unit of this channel"))
            );
        }
        if table.error().len() != table.at.len() {
            return Err(
                self.refuse(&format!("{key}.{of_channel}"), &format!("{} numbers as in at", table.at.len()))
            );
        }
        if table.at.iter().chain(table.error()).any(|value| !value.is_finite()) {
            return Err(self.refuse(key, "finite numbers"));
        }
        Ok(())
    }
}
