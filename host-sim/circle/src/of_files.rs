//! A circle from whatever was given: logs, or tables of radii, one for each direction.

use files::error::InputError;
use files::log::Log;
use files::table::Table;

use super::measured::Measured;
use super::radius_table::Nominal;

impl Measured {
    /// The circle of one or two logs, or of one or two tables, each with its name.
    ///
    /// # Errors
    /// Logs beside tables, nominal values beside logs, and what is no circle.
    pub fn of_files(
        logs: &[Log],
        tables: Vec<(Table<'_>, String)>,
        nominal: Nominal,
    ) -> Result<Self, InputError> {
        match (&tables[..], logs) {
            (_, []) => Self::of_radius_tables(tables, nominal),
            ([], [first, ..]) if nominal != Nominal::default() => {
                let expected = "a table with radius_mm or radius_um beside --radius, --feed or --start";
                Err(InputError::expected(&first.source, expected, "a log"))
            }
            ([], logs) => Self::of_logs(logs),
            ([(_, table), ..], [first, ..]) => {
                let expected = format!("a table with radius_mm or radius_um, as {table}");
                Err(InputError::expected(&first.source, expected, "a log"))
            }
        }
    }
}
