//! Which column is which channel.

use files::error::{InputError, quoted};
use files::log::{ALLOWED, AxisLog, Channel, TIME, Unit, channel_of, unit_of_axis};

use crate::conversion::{Conversion, Units};
use crate::format::Format;
use crate::names::{likely, listed, no_column};
use crate::request::{Mapping, Request};
use crate::table::{ForeignColumn, ForeignTable};
use crate::unit::Quantity;

/// Names of columns of times that need no mapping.
pub(crate) const TIME_NAMES: [&str; 6] = [TIME, "time", "t", "timestamp", "zeit", "temps"];

/// The column of times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeColumn {
    /// Its index.
    pub column: usize,
    /// Seconds per unit of its values; `None`: it counts samples.
    pub factor: Option<f64>,
}

/// The column of a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenChannel {
    /// Name of the axis.
    pub axis: String,
    /// The channel.
    pub channel: Channel,
    /// Unit of the axis.
    pub unit: Unit,
    /// Index of the column.
    pub column: usize,
    /// How its values become those of a log.
    pub conversion: Conversion,
}

/// The columns of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// The times, if the file has any.
    pub time: Option<TimeColumn>,
    /// The channels; at least one.
    pub channels: Vec<ChosenChannel>,
}

/// Chooses the columns: those that are mapped, and those that have our names already.
///
/// # Errors
/// A name that is none of ours, a column that the file lacks, a unit that does not fit, or no channel at all.
pub fn choose(
    table: &ForeignTable,
    request: &Request,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<Chosen, InputError> {
    let named = named(table, request, source)?;
    let units = Units { request, source };
    let mut chosen = Chosen { time: None, channels: Vec::new() };
    for (ours, column) in &named {
        let (name, foreign) = (ours.as_str(), &table.columns[*column]);
        if name == TIME {
            let Conversion { factor, .. } = units.conversion(name, Quantity::Time, foreign, notes)?;
            chosen.time = Some(TimeColumn { column: *column, factor: Some(factor) });
            continue;
        }
        let Some((axis, channel, unit)) = channel_of(name) else { return Err(unknown(name)) };
        let of_axis = || unit_of_axis(axis, named.iter().map(|(ours, _)| ours.as_str()));
        let unit = unit.or_else(of_axis).unwrap_or(Unit::Millimetre);
        if let Some(other) = chosen.channels.iter().find(|other| other.axis == axis && other.unit != unit) {
            let expected = format!("unit {} as of its other columns", other.unit.suffix(channel));
            return Err(InputError::expected("--map", expected, quoted(name)));
        }
        let conversion = units.conversion(name, Quantity::of(unit, channel), foreign, notes)?;
        chosen.channels.push(ChosenChannel {
            axis: axis.to_owned(),
            channel,
            unit,
            column: *column,
            conversion,
        });
    }
    for unit in &request.units {
        if !named.iter().any(|(ours, _)| *ours == unit.ours) {
            return Err(InputError::expected("--unit", "the name of a mapped column", quoted(&unit.ours)));
        }
    }
    if chosen.time.is_none() {
        chosen.time = counter(table, &named);
    }
    if chosen.channels.is_empty() {
        let found =
            format!("the columns {}", listed(table.columns.iter().map(|column| column.name.as_str())));
        let expected = if has_circle(table) {
            "--map OURS=THEIRS for at least one channel, or --map angle_deg=THEIRS and --map radius_mm=THEIRS (or radius_um) of a ballbar"
        } else {
            "--map OURS=THEIRS for at least one channel, such as --map x_command_mm=THEIRS"
        };
        return Err(table.at_header(InputError::expected(source, expected, found)));
    }
    note_ignored(table, &named, &chosen, notes);
    Ok(chosen)
}

/// Our name and the index of each column that is used.
fn named(table: &ForeignTable, request: &Request, source: &str) -> Result<Vec<(String, usize)>, InputError> {
    let mut named: Vec<(String, usize)> = Vec::new();
    for Mapping { ours, theirs } in &request.mappings {
        if ours != TIME && channel_of(ours).is_none() {
            return Err(unknown(ours));
        }
        if named.iter().any(|(other, _)| other == ours) {
            return Err(InputError::expected("--map", "each name once", quoted(ours)));
        }
        named.push((ours.clone(), position(table, theirs, source)?));
    }
    for (index, column) in table.columns.iter().enumerate() {
        let is_free = |named: &[(String, usize)], ours: &str| {
            named.iter().all(|(other, used)| other != ours && *used != index)
        };
        if channel_of(&column.name).is_some() && is_free(&named, &column.name) {
            named.push((column.name.clone(), index));
        }
        let is_time = TIME_NAMES.contains(&column.name.to_lowercase().as_str());
        if is_time && is_free(&named, TIME) {
            named.push((TIME.to_owned(), index));
        }
    }
    Ok(named)
}

/// The column that the user names: exactly, or regardless of case and unit.
pub(crate) fn position(table: &ForeignTable, theirs: &str, source: &str) -> Result<usize, InputError> {
    let find = |is: &dyn Fn(&ForeignColumn) -> bool| table.columns.iter().position(is);
    let (name, _) = crate::unit::split(theirs);
    let found = find(&|column| column.name == theirs)
        .or_else(|| find(&|column| column.name.eq_ignore_ascii_case(name)));
    found.ok_or_else(|| {
        let names = table.columns.iter().map(|column| column.name.as_str());
        table.at_header(no_column(theirs, names, source))
    })
}

/// The error of a name that is none of ours.
fn unknown(ours: &str) -> InputError {
    let axis = ours.split('_').next().unwrap_or_default();
    let names: Vec<String> = Channel::ALL
        .into_iter()
        .flat_map(|channel| Unit::ALL.map(|unit| AxisLog::new(axis, unit).column(channel)))
        .chain([TIME.to_owned()])
        .collect();
    let expected = match likely(ours, names.iter().map(String::as_str)) {
        Some(name) => format!("{ALLOWED} (did you mean {name}?)"),
        None => ALLOWED.to_owned(),
    };
    InputError::expected("--map", expected, quoted(ours))
}

/// The first column of `halsampler -t`, which counts samples.
fn counter(table: &ForeignTable, named: &[(String, usize)]) -> Option<TimeColumn> {
    let is_free = named.iter().all(|(_, column)| *column != 0);
    let values = &table.columns.first()?.values;
    let steps = values.windows(2).filter(|pair| (pair[1] - pair[0]).to_bits() == 1f64.to_bits()).count();
    let counts =
        values.iter().all(|value| value.round().to_bits() == value.to_bits()) && 2 * steps > values.len();
    let is_counter = table.format == Format::Halsampler && is_free && counts;
    is_counter.then_some(TimeColumn { column: 0, factor: None })
}

fn note_ignored(table: &ForeignTable, named: &[(String, usize)], chosen: &Chosen, notes: &mut Vec<String>) {
    let is_used = |index: usize| {
        named.iter().any(|(_, used)| *used == index) || chosen.time.is_some_and(|time| time.column == index)
    };
    let is_clock = |index: usize| table.columns.iter().any(|column| column.times == Some(index));
    let ignored = (0..table.columns.len()).filter(|&index| !is_used(index) && !is_clock(index));
    let names: Vec<&str> = ignored.map(|index| table.columns[index].name.as_str()).collect();
    if !names.is_empty() {
        notes.push(format!("not used: {}", listed(names.into_iter())));
    }
}

/// Whether columns look like those of a ballbar: a radius or its deviation, and an angle.
fn has_circle(table: &ForeignTable) -> bool {
    let has = |words: &[&str]| {
        let mut names = table.columns.iter().map(|column| column.name.to_lowercase());
        names.any(|name| words.iter().any(|word| name.contains(word)))
    };
    has(&["radius", "deviation", "abweichung"]) && has(&["angle", "winkel"])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(mappings: &[&str], units: &[&str]) -> Request {
        Request {
            mappings: mappings.iter().map(|text| text.parse().unwrap()).collect(),
            units: units.iter().map(|text| text.parse().unwrap()).collect(),
            ..Request::default()
        }
    }

    fn chosen(text: &str, request: &Request) -> Result<(Chosen, Vec<String>), String> {
        let table = crate::separated::parse(text, None, "a.csv", &mut Vec::new()).unwrap();
        let mut notes = Vec::new();
        let chosen = choose(&table, request, "a.csv", &mut notes).map_err(|error| error.to_string())?;
        Ok((chosen, notes))
    }

    const TEXT: &str = "Time (ms),X cmd (in),X act,spindle\n0,1,2,3\n1,2,3,3\n2,3,4,3\n";

    #[test]
    fn columns_are_mapped_with_their_units() {
        let request = request(&["x_command_mm=X cmd", "x_motor_mm=x act"], &["x_motor_mm=um"]);
        let (chosen, notes) = chosen(&TEXT.replace("Time", "time"), &request).unwrap();
        assert_eq!(chosen.time, Some(TimeColumn { column: 0, factor: Some(1e-3) }));
        let of = |index: usize| (chosen.channels[index].column, chosen.channels[index].conversion.factor);
        assert_eq!([of(0), of(1)], [(1, 25.4), (2, 1e-3)]);
        assert!(notes.iter().any(|note| note == "not used: \"spindle\""), "{notes:?}");
    }

    #[test]
    fn names_that_are_nearly_right_are_proposed() {
        let of = |mapping: &str| chosen(TEXT, &request(&[mapping], &[])).unwrap_err();
        assert!(of("x_comand_mm=X cmd").contains("did you mean x_command_mm?"));
        assert!(of("x_command_mm=X cnd").contains("did you mean \"X cmd\"?"));
        assert!(of("x_command_mm=quite another").contains("\"Time\", \"X cmd\", \"X act\", \"spindle\""));
        assert!(chosen(TEXT, &request(&[], &[])).unwrap_err().contains("--map OURS=THEIRS"));
    }

    #[test]
    fn a_velocity_is_integrated_if_it_is_asked_for() {
        let text = TEXT.replace("X act", "v (mm/s)");
        let without = chosen(&text, &request(&["x_motor_mm=v"], &[])).unwrap_err();
        assert!(without.contains("--unit x_motor_mm=mm/s to integrate"), "{without}");
        let (with, notes) = chosen(&text, &request(&["x_motor_mm=v"], &["x_motor_mm=m/s"])).unwrap();
        assert_eq!(with.channels[0].conversion, Conversion { factor: 1e3, is_rate: true });
        assert!(notes.iter().any(|note| note.contains("begins at zero")), "{notes:?}");
    }

    #[test]
    fn a_temperature_of_a_rotary_axis_is_mapped_beside_its_angles() {
        let text = TEXT.replace("X act", "T guide (°C)");
        let with_angle = request(&["c_temperature_c=T guide", "c_motor_deg=X cmd"], &["c_motor_deg=deg"]);
        let (of_both, _) = chosen(&text, &with_angle).unwrap();
        assert!(of_both.channels.iter().all(|channel| channel.unit == Unit::Degree));
        assert_eq!(of_both.channels[0].channel, Channel::Temperature);
        let refused = chosen(&text, &request(&["c_temperature_c=X cmd"], &[])).unwrap_err();
        assert!(refused.contains("celsius or counts*SCALE"), "{refused}");
    }

    #[test]
    fn units_that_do_not_fit_are_refused() {
        let of = |unit: &str| chosen(TEXT, &request(&["x_command_mm=X cmd"], &[unit])).unwrap_err();
        assert!(of("x_command_mm=N").contains("mm, m, um, nm, in or counts*SCALE, found \"N\""));
        assert!(of("y_command_mm=um").contains("--unit: expected the name of a mapped column"));
    }
}
