//! Which column is what: by our names, by usual ones, or as the user maps them.

use files::error::{InputError, quoted};
use import::names::{likely, listed, no_column};
use import::request::{Mapping, UnitOf};
use import::unit::{Quantity, split};

use super::rows::{Row, Rows};

/// What a column may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Number or name of the run.
    Run,
    /// Direction of the approach.
    Approach,
    /// Where the axis was sent.
    Target,
    /// Where it came to.
    Measured,
    /// Where it came to less where it was sent.
    Deviation,
    /// Time on the clock of the session.
    Time,
}

/// The roles with our names, and with usual other ones, without unit and in lower case.
const NAMES: [(Role, &str, &[&str]); 6] = [
    (Role::Run, "run", &["lauf", "cycle"]),
    (Role::Approach, "approach", &["direction", "richtung"]),
    (Role::Target, "target_mm", &["target", "nominal", "soll"]),
    (Role::Measured, "measured_mm", &["measured", "actual", "ist"]),
    (Role::Deviation, "deviation_um", &["deviation", "error", "abweichung"]),
    (Role::Time, "time_s", &["time", "t", "zeit"]),
];

/// What the user says of the columns.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Which column is which.
    pub mappings: Vec<Mapping>,
    /// Units that the header does not say, or says wrongly.
    pub units: Vec<UnitOf>,
}

/// A column that is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// What it is.
    pub role: Role,
    /// Its index.
    pub index: usize,
    /// By what its numbers are multiplied to be mm, µm or s.
    pub factor: f64,
}

impl Role {
    /// Our name of a column.
    #[must_use]
    pub fn name(self) -> &'static str {
        NAMES.iter().find(|(role, ..)| *role == self).map_or("", |(_, name, _)| name)
    }

    fn quantity(self) -> Option<(Quantity, f64)> {
        match self {
            Self::Run | Self::Approach => None,
            Self::Target | Self::Measured => Some((Quantity::Length, 1.0)),
            // Lengths are in mm.
            Self::Deviation => Some((Quantity::Length, 1e3)),
            Self::Time => Some((Quantity::Time, 1.0)),
        }
    }
}

/// The columns of a table; what was assumed is added to `notes`.
///
/// # Errors
/// A name that is none of ours, a column that the file lacks, a unit that does not fit.
pub fn choose(
    rows: &Rows,
    request: &Request,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<Vec<Column>, InputError> {
    let numbered = Row { line: 1, cells: (1..=rows.width).map(|number| number.to_string()).collect() };
    let header = rows.header.as_ref().unwrap_or(&numbered);
    let at_header = |error: InputError| error.at_line(header.line);
    let mut found: Vec<(Role, usize)> = Vec::new();
    for Mapping { ours, theirs } in &request.mappings {
        let role = role_named(ours, "--map")?;
        if found.iter().any(|(other, _)| *other == role) {
            return Err(InputError::expected("--map", "each name once", quoted(ours)));
        }
        found.push((role, position(header, theirs, source)?));
    }
    for (index, cell) in header.cells.iter().enumerate() {
        let Some(role) = role_of(cell) else { continue };
        if found.iter().all(|(other, used)| *other != role && *used != index) {
            found.push((role, index));
        }
    }
    let has = |role: Role| found.iter().any(|(other, _)| *other == role);
    if has(Role::Measured) && has(Role::Deviation) {
        found.retain(|(role, _)| *role != Role::Deviation);
    }
    let has = |role: Role| found.iter().any(|(other, _)| *other == role);
    let lacking = [Role::Run, Role::Target].into_iter().find(|role| !has(*role));
    let lacking = lacking.or((!has(Role::Measured) && !has(Role::Deviation)).then_some(Role::Measured));
    if let Some(role) = lacking {
        return Err(at_header(lack(role, header, &found, source)));
    }
    note_ignored(header, &found, notes);
    let column = |(role, index): (Role, usize)| {
        let factor = factor(role, &header.cells[index], request, (source, header.line))?;
        Ok(Column { role, index, factor })
    };
    units_are_used(request, &found)?;
    found.into_iter().map(column).collect()
}

/// The role of our name.
fn role_named(name: &str, flag: &str) -> Result<Role, InputError> {
    let found = NAMES.iter().find(|(_, own, _)| *own == name).map(|(role, ..)| *role);
    found.ok_or_else(|| {
        let names = NAMES.map(|(_, own, _)| own);
        let expected = match likely(name, names.into_iter()) {
            Some(own) => format!("one of {} (did you mean {own}?)", names.join(", ")),
            None => format!("one of {}", names.join(", ")),
        };
        InputError::expected(flag, expected, quoted(name))
    })
}

/// The role of a cell of the header.
fn role_of(cell: &str) -> Option<Role> {
    let own = NAMES.iter().find(|(_, own, _)| *own == cell).map(|(role, ..)| *role);
    let name = split(cell).0.to_lowercase();
    let usual = || NAMES.iter().find(|(_, own, usual)| *own == name || usual.contains(&name.as_str()));
    own.or_else(|| usual().map(|(role, ..)| *role))
}

/// The column that the user names: exactly, or regardless of case and unit.
fn position(header: &Row, theirs: &str, source: &str) -> Result<usize, InputError> {
    let cells = &header.cells;
    let same = |cell: &String| split(cell).0.eq_ignore_ascii_case(split(theirs).0);
    let found = cells.iter().position(|cell| cell == theirs).or_else(|| cells.iter().position(same));
    found.ok_or_else(|| no_column(theirs, cells.iter().map(String::as_str), source).at_line(header.line))
}

/// The error of a column that there is not, with the unused one whose name is most like it.
fn lack(role: Role, header: &Row, found: &[(Role, usize)], source: &str) -> InputError {
    let is_free = |(index, _): &(usize, &String)| found.iter().all(|(_, used)| used != index);
    let free: Vec<&str> =
        header.cells.iter().enumerate().filter(is_free).map(|(_, cell)| cell.as_str()).collect();
    let name = role.name();
    let expected = if role == Role::Measured {
        "a column measured_mm or deviation_um".to_owned()
    } else {
        format!("a column {name}")
    };
    let near = likely(name, free.iter().copied());
    let advice = near.map_or(String::new(), |near| format!("; is it {}? --map {name}={near}", quoted(near)));
    let found = format!("the columns {}{advice}", listed(header.cells.iter().map(String::as_str)));
    InputError::expected(source, expected, found).with_advice("--map OURS=THEIRS says which column it is")
}

/// By what the numbers of a column are multiplied. The header is in this line of the file.
fn factor(
    role: Role,
    cell: &str,
    request: &Request,
    (source, line): (&str, usize),
) -> Result<f64, InputError> {
    let Some((quantity, scale)) = role.quantity() else { return Ok(1.0) };
    let asked = request.units.iter().find(|unit| unit.ours == role.name()).map(|unit| unit.unit.as_str());
    // Our own name says the unit.
    let told = if cell == role.name() { None } else { split(cell).1 };
    let Some(unit) = asked.or(told) else { return Ok(1.0) };
    let error =
        |place: &str| InputError::expected(place, quantity.allowed(), quoted(unit)).at_key(role.name());
    let at_place = || if asked.is_some() { error("--unit") } else { error(source).at_line(line) };
    Ok(scale * quantity.factor(unit).ok_or_else(at_place)?)
}

/// Refuses a unit of a column that there is not.
fn units_are_used(request: &Request, found: &[(Role, usize)]) -> Result<(), InputError> {
    for unit in &request.units {
        let role = role_named(&unit.ours, "--unit")?;
        if found.iter().all(|(other, _)| *other != role) || role.quantity().is_none() {
            let expected = "the name of a column with a unit that the file has";
            return Err(InputError::expected("--unit", expected, quoted(&unit.ours)));
        }
    }
    Ok(())
}

fn note_ignored(header: &Row, found: &[(Role, usize)], notes: &mut Vec<String>) {
    let is_free = |(index, _): &(usize, &String)| found.iter().all(|(_, used)| used != index);
    let free: Vec<&str> =
        header.cells.iter().enumerate().filter(is_free).map(|(_, cell)| cell.as_str()).collect();
    if !free.is_empty() {
        notes.push(format!("Columns that are not used: {}.", listed(free.into_iter())));
    }
}
