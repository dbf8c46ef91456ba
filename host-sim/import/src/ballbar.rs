//! Tables of a ballbar: the radius over the angle or the time, as `lost-motion circle` reads them.

use std::fmt::Write;
use std::path::Path;

use files::error::{InputError, quoted};
use files::log::TIME;
use files::output::{OutputError, write_whole};
use files::table::MAX_MEASURED;

use crate::columns::{TIME_NAMES, position};
use crate::conversion::{Conversion, Units};
use crate::request::Request;
use crate::table::ForeignTable;
use crate::unit::Quantity;

/// Radius, mm.
const RADIUS: &str = "radius_mm";
/// Deviation from the nominal radius, µm.
const DEVIATION: &str = "radius_um";
/// Angle, degrees.
const ANGLE: &str = "angle_deg";
/// Direction of the travel; above 0 counter-clockwise.
const DIRECTION: &str = "direction";

/// The columns of a ballbar's table.
const COLUMNS: [&str; 5] = [RADIUS, DEVIATION, ANGLE, TIME, DIRECTION];

/// A table of a ballbar.
#[derive(Clone, Debug, PartialEq)]
pub struct BallbarTable {
    /// Names and values of its columns, of equal length.
    columns: Vec<(&'static str, Vec<f64>)>,
    /// One sentence for each assumption and change.
    pub notes: Vec<String>,
}

/// Whether these columns are those of a ballbar's table that `lost-motion circle` reads as it is.
#[must_use]
pub fn is_own(names: &[String]) -> bool {
    has_radius(names) && names.iter().all(|name| COLUMNS.contains(&name.as_str()))
}

/// Whether a column or a mapping says that a table is one of a ballbar.
#[must_use]
pub fn is_asked(table: &ForeignTable, request: &Request) -> bool {
    let mut mapped = request.mappings.iter().map(|mapping| &mapping.ours);
    mapped.any(|ours| is_radius(ours)) || table.columns.iter().any(|column| is_radius(&column.name))
}

/// Whether a table with these columns is one of radii, and no log.
#[must_use]
pub fn has_radius(names: &[String]) -> bool {
    names.iter().any(|name| is_radius(name))
}

fn is_radius(name: &str) -> bool {
    name == RADIUS || name == DEVIATION
}

/// The error of a table of radii in the place of a log.
#[must_use]
pub fn no_log(source: &str) -> InputError {
    InputError::expected(source, "a log", "a ballbar's table, which lost-motion circle reads")
}

/// The table of a ballbar in the columns of a foreign file.
///
/// # Errors
/// A name that is no column of such a table, a column that the file lacks, a unit that does not fit, neither angle nor time, no rows.
pub fn of(
    table: &ForeignTable,
    request: &Request,
    source: &str,
    mut notes: Vec<String>,
) -> Result<BallbarTable, InputError> {
    let named = named(table, request, source)?;
    let count = |is: &dyn Fn(&str) -> bool| named.iter().filter(|(ours, _)| is(ours)).count();
    if count(&is_radius) != 1 {
        return Err(table.at_header(InputError::expected(source, "one of radius_mm and radius_um", "both")));
    }
    let units = Units { request, source };
    let mut columns = Vec::new();
    for (ours, index) in named {
        let factor = factor(ours, table, index, &units, &mut notes)?;
        let values = table.columns[index].values.iter().map(|value| factor * value).collect();
        columns.push((ours, values));
    }
    let rows = columns.first().map_or(0, |(_, values): &(_, Vec<f64>)| values.len());
    let has = |name: &str, columns: &[(&str, Vec<f64>)]| columns.iter().any(|(ours, _)| *ours == name);
    if let (Some(rate_hz), false) = (request.rate_hz, has(TIME, &columns)) {
        columns.push((TIME, (0..rows).map(|row| row as f64 / rate_hz).collect()));
    }
    if !has(ANGLE, &columns) && !has(TIME, &columns) {
        let expected = "an angle (--map angle_deg=THEIRS) or a time (--map time_s=THEIRS, --rate HZ)";
        return Err(table.at_header(InputError::expected(source, expected, "neither")));
    }
    if columns.iter().any(|(_, values)| values.len() != rows) {
        return Err(InputError::expected(source, "columns of equal length", "arrays of several lengths"));
    }
    checked(BallbarTable { columns, notes }, source)
}

/// Our name and the index of each column that is used.
fn named(
    table: &ForeignTable,
    request: &Request,
    source: &str,
) -> Result<Vec<(&'static str, usize)>, InputError> {
    let ours = |name: &str, flag: &str| {
        let found = COLUMNS.into_iter().find(|column| *column == name);
        let expected = || format!("a column of a ballbar's table: {}", COLUMNS.join(", "));
        found.ok_or_else(|| InputError::expected(flag, expected(), quoted(name)))
    };
    let mut named: Vec<(&'static str, usize)> = Vec::new();
    for mapping in &request.mappings {
        let name = ours(&mapping.ours, "--map")?;
        if named.iter().any(|(other, _)| *other == name) {
            return Err(InputError::expected("--map", "each name once", quoted(name)));
        }
        named.push((name, position(table, &mapping.theirs, source)?));
    }
    for (index, column) in table.columns.iter().enumerate() {
        let is_time = TIME_NAMES.contains(&column.name.to_lowercase().as_str());
        let own = COLUMNS.into_iter().find(|ours| *ours == column.name).or(is_time.then_some(TIME));
        if let Some(own) = own
            && named.iter().all(|(other, used)| *other != own && *used != index)
        {
            named.push((own, index));
        }
    }
    for unit in &request.units {
        let name = ours(&unit.ours, "--unit")?;
        if named.iter().all(|(other, _)| *other != name) {
            return Err(InputError::expected("--unit", "the name of a mapped column", quoted(name)));
        }
    }
    Ok(named)
}

/// By what the values of a column are multiplied.
fn factor(
    ours: &'static str,
    table: &ForeignTable,
    index: usize,
    units: &Units<'_>,
    notes: &mut Vec<String>,
) -> Result<f64, InputError> {
    let column = &table.columns[index];
    let quantity = match ours {
        DIRECTION => return Ok(1.0),
        ANGLE => Quantity::Angle,
        TIME => Quantity::Time,
        _ => Quantity::Length,
    };
    let Conversion { factor, is_rate } = units.conversion(ours, quantity, column, notes)?;
    if is_rate {
        return Err(InputError::expected("--unit", "a radius, an angle or a time", "a velocity").at_key(ours));
    }
    let has_unit = column.unit.is_some() || units.request.units.iter().any(|unit| unit.ours == ours);
    Ok(if ours == DEVIATION && has_unit { 1e3 * factor } else { factor })
}

/// The table without rows that lack a value.
fn checked(mut table: BallbarTable, source: &str) -> Result<BallbarTable, InputError> {
    let rows = table.columns.first().map_or(0, |(_, values)| values.len());
    let is_whole = |row: usize| {
        let is_known = |(name, values): &(&str, Vec<f64>)| {
            values[row].is_finite() && (*name != DIRECTION || values[row] != 0.0)
        };
        table.columns.iter().all(is_known)
    };
    let whole: Vec<usize> = (0..rows).filter(|row| is_whole(*row)).collect();
    if whole.len() < 2 {
        return Err(InputError::expected(source, "two rows of numbers or more", whole.len()));
    }
    if whole.len() < rows {
        table.notes.push(format!("{} rows without a number are left out", rows - whole.len()));
    }
    for (name, values) in &mut table.columns {
        *values = whole.iter().map(|&row| values[row]).collect();
        if let Some(value) = values.iter().find(|value| value.abs() > MAX_MEASURED) {
            return Err(InputError::expected(source, "numbers from −1e9 to 1e9", value).at_key(name));
        }
    }
    table.notes.push(format!("a ballbar's table of {} rows", whole.len()));
    Ok(table)
}

impl BallbarTable {
    /// The table as CSV with all digits; `lost-motion circle` reads it.
    #[must_use]
    pub fn csv(&self) -> String {
        let names: Vec<&str> = self.columns.iter().map(|(name, _)| *name).collect();
        let mut text = names.join(",") + "\n";
        let rows = self.columns.first().map_or(0, |(_, values)| values.len());
        for row in 0..rows {
            for (number, (name, values)) in self.columns.iter().enumerate() {
                let separator = if number == 0 { "" } else { "," };
                // Writing to a string cannot fail.
                let _ = match *name {
                    DIRECTION => write!(text, "{separator}{}", if values[row] > 0.0 { '+' } else { '-' }),
                    _ => write!(text, "{separator}{}", values[row]),
                };
            }
            text.push('\n');
        }
        text
    }

    /// Writes the table as CSV, completely or not at all.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        write_whole(path, |out| out.write_all(self.csv().as_bytes()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_text(text: &str, mappings: &[&str], rate_hz: Option<f64>) -> Result<BallbarTable, String> {
        let mappings = mappings.iter().map(|text| text.parse().unwrap()).collect();
        let request = Request { mappings, rate_hz, ..Request::default() };
        let table = crate::separated::parse(text, None, "a.txt", &mut Vec::new()).unwrap();
        assert!(is_asked(&table, &request));
        of(&table, &request, "a.txt", Vec::new()).map_err(|error| error.to_string())
    }

    const MAPPINGS: [&str; 2] = ["radius_um=Abweichung", "angle_deg=Winkel"];

    #[test]
    fn a_foreign_table_becomes_that_of_a_circle() {
        let text = "Winkel (rad);Abweichung (mm);direction\n0;0,001;1\n0,5;0,002;-1\n1;;1\n";
        let table = of_text(text, &MAPPINGS, None).unwrap();
        let csv = table.csv();
        let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
        assert_eq!(rows[0], ["radius_um", "angle_deg", "direction"]);
        let near = |cell: &str, expected: f64| (cell.parse::<f64>().unwrap() - expected).abs() < 1e-12;
        assert!(
            near(rows[1][0], 1.0) && near(rows[2][0], 2.0) && near(rows[2][1], 0.5_f64.to_degrees()),
            "{csv}"
        );
        assert_eq!([rows[1][2], rows[2][2]], ["+", "-"]);
        // The row without a deviation.
        assert!(
            rows.len() == 3 && table.notes.iter().any(|note| note.starts_with("1 rows without")),
            "{table:?}"
        );
    }

    /// A deviation without a unit is in µm; a rate takes the place of times.
    #[test]
    fn a_rate_gives_the_times() {
        let table = of_text("Winkel;Abweichung\n0;1\n1;2\n", &MAPPINGS[..1], Some(4.0)).unwrap();
        assert_eq!(table.csv(), "radius_um,time_s\n1,0\n2,0.25\n");
    }

    #[test]
    fn what_is_missing_or_too_much_is_told() {
        let text = "Winkel;Abweichung\n0;1\n1;2\n";
        let message = |mappings: &[&str]| of_text(text, mappings, None).unwrap_err();
        assert!(
            message(&MAPPINGS[..1]).contains("a.txt: line 1: expected an angle (--map angle_deg=THEIRS)")
        );
        let both = ["radius_um=Winkel", "radius_mm=Abweichung"];
        assert!(message(&both).contains("expected one of radius_mm and radius_um, found both"));
        assert!(
            message(&["radius_um=Winkel", "x_motor_mm=Winkel"])
                .contains("--map: expected a column of a ballbar's table")
        );
    }

    #[test]
    fn own_tables_are_those_of_known_columns() {
        let is = |names: &[&str]| is_own(&names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>());
        assert!(is(&["angle_deg", "radius_um"]) && is(&["radius_mm", "time_s", "direction"]));
        assert!(!is(&["angle_deg", "time_s"]) && !is(&["angle_deg", "radius_mm", "note"]));
    }
}
