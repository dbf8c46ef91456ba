//! The radius of a ballbar over angle or time: a CSV table.
//!
//! | column | |
//! |---|---|
//! | `radius_mm` or `radius_um` | radius, or deviation from the nominal radius, positive outwards |
//! | `angle_deg` | angle from + of the first axis to + of the second |
//! | `time_s` | instead of the angle, or beside it; a vibration is only found with it |
//! | `direction` | `ccw` or `cw`, or the sign of a number; without it, the direction in which the angle grows or falls |
//!
//! Without angles, the speed must be known and constant: each run in one direction starts at the start angle. Two files, one for each
//! direction, are read as one table after the other.

use std::f64::consts::TAU;
use std::ops::Range;

use files::error::InputError;
use files::table::{Row, Table};
use numerics::wrapped;

use super::measured::{Measured, faults};
use super::samples::{Instant, Observed, Samples};

/// A longer time between two rows, in typical ones, separates two runs.
const MAX_PAUSE: f64 = 1.5;

/// Smallest number of rows of a run.
const MIN_ROWS: usize = 10;

/// What a table does not contain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Nominal {
    /// Nominal radius, mm.
    pub radius_mm: Option<f64>,
    /// Speed along the circle, mm/min, for tables without angles.
    pub feed_mm_per_min: Option<f64>,
    /// Angle at which each run starts, degrees, for tables without angles.
    pub start_deg: f64,
}

/// The columns of a table.
struct Columns {
    radius: usize,
    is_deviation: bool,
    angle: Option<usize>,
    time: Option<usize>,
    direction: Option<usize>,
}

/// A row of a table.
#[derive(Clone, Copy, Debug)]
struct Reading {
    radius: f64,
    angle: Option<f64>,
    time_s: Option<f64>,
    direction: Option<f64>,
}

impl Columns {
    fn of(table: &Table<'_>) -> Result<Self, InputError> {
        const ALLOWED: &str = "one of each of radius_mm or radius_um, angle_deg, time_s, direction";
        let (mut radius, mut angle, mut time, mut direction, mut is_deviation) =
            (None, None, None, None, false);
        for (index, name) in table.names().iter().enumerate() {
            let place = match name.as_str() {
                "radius_mm" => &mut radius,
                "radius_um" => {
                    is_deviation = true;
                    &mut radius
                }
                "angle_deg" => &mut angle,
                "time_s" => &mut time,
                "direction" => &mut direction,
                other => return Err(table.header_error(ALLOWED, files::error::quoted(other))),
            };
            if place.replace(index).is_some() {
                return Err(table.header_error(ALLOWED, "a second one").at_key(name));
            }
        }
        let radius = radius.ok_or_else(|| table.header_error("a column radius_mm or radius_um", "none"))?;
        if angle.is_none() && time.is_none() {
            return Err(table.header_error("a column angle_deg or time_s", "none"));
        }
        Ok(Self { radius, is_deviation, angle, time, direction })
    }

    fn reading(&self, row: &Row<'_, '_>) -> Result<Reading, InputError> {
        let number = |column: Option<usize>| column.map(|column| row.measured(column)).transpose();
        let time_s = self.time.map(|column| row.finite(column)).transpose()?;
        let direction = self.direction.map(|column| match row.text(column).to_ascii_lowercase().as_str() {
            "ccw" | "+" | "1" | "+1" => Ok(1.0),
            "cw" | "-" | "−" | "-1" => Ok(-1.0),
            _ => Err(row.cell_error(column, "ccw, cw, + or -")),
        });
        Ok(Reading {
            radius: row.measured(self.radius)?,
            angle: number(self.angle)?.map(f64::to_radians),
            time_s,
            direction: direction.transpose()?,
        })
    }
}

impl Measured {
    /// The circle of one table, or of two with one direction each.
    ///
    /// # Errors
    /// Columns or cells that are not as described, or a nominal value that is missing.
    pub fn of_radius_tables(tables: Vec<(Table<'_>, String)>, nominal: Nominal) -> Result<Self, InputError> {
        let mut runs: Vec<Vec<Reading>> = Vec::new();
        let (mut is_deviation, mut source, mut notes) = (false, String::new(), Vec::new());
        for (mut table, name) in tables {
            let columns = Columns::of(&table)?;
            if !source.is_empty() && columns.is_deviation != is_deviation {
                return Err(table.header_error("the same columns as in the first file", "other ones"));
            }
            is_deviation = columns.is_deviation;
            let readings = read(&mut table, &columns)?;
            check(&columns, nominal, &name)?;
            if columns.direction.is_none() && columns.angle.is_none() {
                notes.push("No directions are given: counter-clockwise is assumed.".to_owned());
            }
            runs.extend(split(readings));
            if source.is_empty() {
                source = name;
            }
        }
        of_runs(&runs, is_deviation, nominal, (source, notes))
    }
}

fn read(table: &mut Table<'_>, columns: &Columns) -> Result<Vec<Reading>, InputError> {
    let mut readings = Vec::new();
    while let Some(row) = table.next_row()? {
        readings.push(columns.reading(&row)?);
    }
    Ok(readings)
}

/// Checks that what the table lacks is given.
fn check(columns: &Columns, nominal: Nominal, source: &str) -> Result<(), InputError> {
    if columns.is_deviation && nominal.radius_mm.is_none() {
        return Err(InputError::expected(source, "--radius MM beside radius_um", "none"));
    }
    if columns.angle.is_none() && nominal.feed_mm_per_min.is_none() {
        return Err(InputError::expected(source, "--feed MM_PER_MIN, or a column angle_deg", "none"));
    }
    Ok(())
}

/// The runs in one direction, each in the order of its travel.
fn split(mut readings: Vec<Reading>) -> Vec<Vec<Reading>> {
    if readings.iter().all(|reading| reading.direction.is_none()) {
        let directions: Vec<f64> = travel(&readings);
        readings.iter_mut().zip(directions).for_each(|(reading, d)| reading.direction = Some(d));
    }
    let steps: Vec<f64> =
        readings.windows(2).filter_map(|pair| Some((pair[1].time_s? - pair[0].time_s?).abs())).collect();
    let longest_s = MAX_PAUSE * numerics::median(&steps).unwrap_or(f64::INFINITY);
    let is_one = |a: &Reading, b: &Reading| {
        let pause_s = a.time_s.zip(b.time_s).map_or(0.0, |(from, to)| (to - from).abs());
        a.direction == b.direction && pause_s <= longest_s
    };
    let mut runs: Vec<Vec<Reading>> = readings.chunk_by(is_one).map(<[Reading]>::to_vec).collect();
    runs.retain(|run| run.len() >= MIN_ROWS);
    for run in &mut runs {
        let travelled: f64 = run.windows(2).map(step).sum();
        // A clockwise run may be listed by rising angles.
        if travelled * run[0].direction.unwrap_or(1.0) < 0.0 {
            run.reverse();
        }
    }
    runs
}

/// Angle from one reading to the next, rad.
fn step(pair: &[Reading]) -> f64 {
    pair[0].angle.zip(pair[1].angle).map_or(0.0, |(from, to)| wrapped(to - from, TAU))
}

/// Direction of each reading from the change of its angle; +1 without angles.
fn travel(readings: &[Reading]) -> Vec<f64> {
    let steps: Vec<f64> = readings.windows(2).map(step).collect();
    let mut last = steps.iter().find(|step| **step != 0.0).map_or(1.0, |step| step.signum());
    let of = |i: usize| {
        let step = steps.get(i).or(steps.last()).copied().unwrap_or(0.0);
        if step != 0.0 {
            last = step.signum();
        }
        last
    };
    (0..readings.len()).map(of).collect()
}

/// The samples of all runs.
fn of_runs(
    runs: &[Vec<Reading>],
    is_deviation: bool,
    nominal: Nominal,
    (source, mut notes): (String, Vec<String>),
) -> Result<Measured, InputError> {
    let all = || runs.iter().flatten();
    if all().next().is_none() {
        return Err(InputError::expected(&source, "rows", "none"));
    }
    let mean_mm = numerics::mean(all().map(|reading| reading.radius));
    let radius_mm = nominal.radius_mm.unwrap_or(mean_mm);
    if radius_mm <= 0.0 {
        return Err(InputError::expected(&source, "a positive mean radius", mean_mm).at_key("radius_mm"));
    }
    if nominal.radius_mm.is_none() {
        notes.push(
            "The nominal radius is not given (--radius): neither F nor the part radius is known.".to_owned(),
        );
    }
    let deviation_um =
        |reading: &Reading| if is_deviation { reading.radius } else { 1e3 * (reading.radius - radius_mm) };
    let (mut instants, mut arcs, mut observed) = (Vec::new(), Vec::new(), Vec::new());
    for (number, run) in runs.iter().enumerate() {
        let start = instants.len();
        instants.extend(placed(run, radius_mm, nominal).into_iter().map(|at| Instant { arc: number, ..at }));
        observed.extend(run.iter().map(deviation_um));
        arcs.push(start..instants.len());
    }
    let sample_s = all().next().and_then(|first| first.time_s).and_then(|_| period_s(runs));
    let mut samples = Samples {
        radius_mm,
        speed_mm_s: None,
        sample_s,
        instants,
        arcs,
        observed: Observed::Radial(Vec::new()),
    };
    set_speeds(&mut samples);
    let is_fault: Vec<usize> = faults(&observed);
    samples.observed = Observed::Radial(observed);
    if !is_fault.is_empty() {
        notes.push(format!("{} readings far from their neighbours are left out.", is_fault.len()));
        samples = samples.filtered(|i| is_fault.binary_search(&i).is_err());
    }
    let starts_rad = vec![0.0; samples.arcs.len()];
    let axes = ["x".to_owned(), "y".to_owned()];
    let has_nominal_radius = nominal.radius_mm.is_some();
    Ok(Measured {
        source,
        axes,
        channel: "radius",
        has_nominal_radius,
        delay_s: None,
        samples,
        starts_rad,
        notes,
    })
}

/// The instants of a run.
fn placed(run: &[Reading], radius_mm: f64, nominal: Nominal) -> Vec<Instant> {
    let start_s = run.first().and_then(|first| first.time_s).unwrap_or(0.0);
    let rad_per_s = nominal.feed_mm_per_min.unwrap_or(0.0) / 60.0 / radius_mm;
    let at = |reading: &Reading| {
        let direction = reading.direction.unwrap_or(1.0);
        let time_s = reading.time_s.unwrap_or(0.0);
        let travelled = rad_per_s * (time_s - start_s).abs();
        let angle = reading.angle.unwrap_or(nominal.start_deg.to_radians() + direction * travelled);
        Instant { time_s, ..Instant::new(angle.rem_euclid(TAU), direction) }
    };
    run.iter().map(at).collect()
}

/// Time from one reading to the next, if it is the same throughout all runs.
fn period_s(runs: &[Vec<Reading>]) -> Option<f64> {
    const TOLERANCE: f64 = 0.05;
    let steps: Vec<f64> = runs
        .iter()
        .flat_map(|run| run.windows(2).filter_map(|pair| Some((pair[1].time_s? - pair[0].time_s?).abs())))
        .collect();
    let median = numerics::median(&steps)?;
    (median > 0.0 && steps.iter().all(|step| (step - median).abs() < TOLERANCE * median)).then_some(median)
}

/// Sets the speed of each arc from times and angles.
fn set_speeds(samples: &mut Samples) {
    let speed = |samples: &Samples, arc: &Range<usize>| {
        let times = &samples.instants[arc.clone()];
        let duration = times.last()?.time_s - times.first()?.time_s;
        (duration != 0.0).then(|| samples.radius_mm * samples.swept_rad(arc) / duration.abs())
    };
    let speeds: Option<Vec<f64>> = samples.arcs.iter().map(|arc| speed(samples, arc)).collect();
    let Some(speeds) = speeds else { return };
    let top = numerics::max_abs(speeds.iter().copied());
    samples.speed_mm_s = Some(top);
    for at in &mut samples.instants {
        at.speed = speeds[at.arc] / top;
    }
}
