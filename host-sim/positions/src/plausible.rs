//! Whether the numbers of a column are positions in mm: a wrong unit or sign is named and, where it is sure, put right.

use files::error::InputError;

use super::raw::Raw;

/// Largest relative difference of a factor from the one that is recognised.
const NEAR: f64 = 0.1;

/// Largest distance of a position from its target, as a fraction of the least distance of two targets.
const FAR: f64 = 0.25;

/// Largest share of readings that are far from their target.
const MAX_FAR: f64 = 0.1;

/// Turns positions into deviations, µm.
///
/// # Errors
/// Numbers that are neither positions in a known unit nor near their targets.
pub(crate) fn in_millimetres(
    raw: &mut Vec<Raw>,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<(), InputError> {
    let Some(factor) = per_target(raw) else { return Ok(()) };
    let is_near = |expected: f64| (factor / expected - 1.0).abs() < NEAR;
    let (name, unit, to_mm) = match () {
        () if is_near(1.0) => ("", "", 1.0),
        () if is_near(1e3) => ("µm", "um", 1e-3),
        () if is_near(1e-3) => ("m", "m", 1e3),
        () if is_near(1.0 / 25.4) => ("inches", "in", 25.4),
        () if is_near(-1.0) => ("positions that count the other way", "", -1.0),
        () if factor.abs() < 0.5 => return Err(of_deviations(raw, source)),
        () => {
            let expected = "positions near their targets";
            let found = format!("positions that change by {factor:.4} mm for each mm of the targets");
            return Err(InputError::expected(source, expected, found).at_key("measured_mm"));
        }
    };
    if !name.is_empty() {
        let line = raw.first().map_or(0, |reading| reading.line);
        let says =
            if unit.is_empty() { String::new() } else { format!("; --unit measured_mm={unit} says so") };
        notes.push(format!(
            "{source}: from line {line}: measured_mm: the numbers are {name}, and taken as such{says}."
        ));
    }
    for reading in raw.iter_mut() {
        reading.value = to_mm * reading.value - reading.target_mm;
    }
    near_targets(raw, source, notes)?;
    for reading in raw.iter_mut() {
        reading.value *= 1e3;
    }
    Ok(())
}

/// Change of the numbers for each mm of the targets: the median of neighbouring readings.
fn per_target(raw: &[Raw]) -> Option<f64> {
    let slope = |pair: &[Raw]| {
        let step_mm = pair[1].target_mm - pair[0].target_mm;
        (step_mm != 0.0).then(|| (pair[1].value - pair[0].value) / step_mm)
    };
    numerics::median(&raw.windows(2).filter_map(slope).collect::<Vec<_>>())
}

/// The error of numbers that do not follow the targets.
fn of_deviations(raw: &[Raw], source: &str) -> InputError {
    /// Largest plausible deviation, mm.
    const MAX_MM: f64 = 0.5;
    let greatest = numerics::max_abs(raw.iter().map(|reading| reading.value));
    let unit = if greatest > MAX_MM { "" } else { " --unit deviation_um=mm" };
    InputError::expected(source, "positions that follow the targets", "deviations")
        .at_key("measured_mm")
        .with_advice(&format!(
            "deviations in {} are read with --map deviation_um=THEIRS{unit}",
            if unit.is_empty() { "µm" } else { "mm" }
        ))
}

/// Takes single readings in µm as such, leaves out those far from their target, and the zero of the laser.
fn near_targets(raw: &mut Vec<Raw>, source: &str, notes: &mut Vec<String>) -> Result<(), InputError> {
    let far_mm = far_mm(raw);
    let zero_mm =
        numerics::median(&raw.iter().map(|reading| reading.value).collect::<Vec<_>>()).unwrap_or(0.0);
    if zero_mm.abs() > far_mm {
        notes.push(format!(
            "{source}: the zero of measured_mm is {zero_mm:.4} mm from that of target_mm; this is left out of the deviations."
        ));
        for reading in raw.iter_mut() {
            reading.value -= zero_mm;
        }
    }
    let mut far = Vec::new();
    for (index, reading) in raw.iter_mut().enumerate().filter(|(_, reading)| reading.value.abs() > far_mm) {
        let as_um = 1e-3 * (reading.value + reading.target_mm) - reading.target_mm;
        if as_um.abs() < far_mm && reading.target_mm.abs() > far_mm {
            notes.push(format!(
                "{source}: line {}: measured_mm: a number in µm, taken as such.",
                reading.line
            ));
            reading.value = as_um;
        } else {
            far.push((index, reading.line, reading.value));
        }
    }
    leave_out(raw, &far, "measured_mm", source, notes)
}

/// Leaves out deviations, µm, that are far beyond a target.
///
/// # Errors
/// More than one in ten of them.
pub(crate) fn deviations(
    raw: &mut Vec<Raw>,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<(), InputError> {
    let far_mm = far_mm(raw);
    let is_far = |(_, reading): &(usize, &Raw)| 1e-3 * reading.value.abs() > far_mm;
    let far = raw.iter().enumerate().filter(is_far);
    let far: Vec<_> = far.map(|(index, reading)| (index, reading.line, 1e-3 * reading.value)).collect();
    leave_out(raw, &far, "deviation_um", source, notes)
}

/// Distance from a target from which on a reading is no reading of it, mm.
fn far_mm(raw: &[Raw]) -> f64 {
    let mut targets: Vec<f64> = raw.iter().map(|reading| reading.target_mm).collect();
    targets.sort_by(f64::total_cmp);
    let travel_mm = numerics::peak_to_peak(targets.iter().copied());
    let steps = targets.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 1e-3 * travel_mm);
    FAR * numerics::min(steps).min(travel_mm)
}

/// Leaves out readings by their index, line and distance from the target, mm.
fn leave_out(
    raw: &mut Vec<Raw>,
    far: &[(usize, usize, f64)],
    key: &str,
    source: &str,
    notes: &mut Vec<String>,
) -> Result<(), InputError> {
    let Some(&(_, line, first_mm)) = far.first() else { return Ok(()) };
    if far.len() as f64 > MAX_FAR * raw.len() as f64 {
        let found = format!("one {first_mm:.4} mm from it");
        let error = InputError::expected(source, "a position near its target", found);
        return Err(error.at_line(line).at_key(key));
    }
    for (_, line, mm) in far {
        notes.push(format!("{source}: line {line}: {key}: {mm:.4} mm from its target, left out."));
    }
    let mut index = 0..raw.len();
    raw.retain(|_| index.next().is_some_and(|index| far.iter().all(|(other, ..)| *other != index)));
    Ok(())
}
