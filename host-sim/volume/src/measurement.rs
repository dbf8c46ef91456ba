//! A measurement as equations: the mean of both directions at each place.
//!
//! Backlash, friction, wind-up and deviations of the servos have opposite signs in the two directions and cancel in their mean; what
//! is left is geometry, and errors that depend on acceleration.

use std::f64::consts::{FRAC_PI_2, TAU};

use circle::measured::Measured;
use circle::samples::Observed;
use files::error::InputError;
use positions::iso::{Position, positions};
use positions::measured::Test;

use super::component::Axis;
use super::survey::{Measurement, What};
use super::vector::unit;

/// Sectors of a circle, and their width, rad.
const SECTORS: usize = 180;
const SECTOR_RAD: f64 = TAU / SECTORS as f64;

/// Angle at either side of a reversal in which friction may displace the axes alike in both directions, rad.
const AT_REVERSAL_RAD: f64 = 10.0 / 360.0 * TAU;

/// Fewest sectors of a circle.
const MIN_SECTORS: usize = 36;

/// Median of the square of a normal variable with variance 1.
const MEDIAN_OF_SQUARE: f64 = 0.455;

/// Fewest targets of a positioning test.
const MIN_TARGETS: usize = 3;

/// One equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Position of x, y and z, mm.
    pub at_mm: [f64; 3],
    /// The direction in which the error was measured.
    pub direction: [f64; 3],
    /// Actual position less commanded one in this direction, µm.
    pub value_um: f64,
}

/// The equations of one measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Name of its first file.
    pub source: String,
    /// What was measured.
    pub what: What,
    /// Whether it judges the fit and takes no part in it.
    pub is_held_out: bool,
    /// The equations.
    pub rows: Vec<Row>,
    /// What is unknown of the instrument: columns, one value for each row.
    pub unknowns: Vec<Vec<f64>>,
    /// Standard deviation of a value by what the measurement itself shows, µm.
    pub scatter_um: f64,
    /// What was assumed or left out.
    pub notes: Vec<String>,
}

/// The measurements that are fitted: those that are not held out.
pub fn fitted(groups: &[Group]) -> impl Iterator<Item = &Group> {
    groups.iter().filter(|group| !group.is_held_out)
}

impl Group {
    /// The rows of a positioning test. The origin of its readings is unknown.
    ///
    /// # Errors
    /// Fewer than three targets.
    pub fn of_test(test: &Test, axis: Axis, place: &Measurement) -> Result<Self, InputError> {
        let positions = positions(test);
        let is_one_way = positions.iter().all(|position| position.mean_um().is_none());
        let (mut rows, mut notes) = (Vec::new(), test.notes.clone());
        for position in &positions {
            let of_one_way = || position.ways.into_iter().flatten().next().filter(|_| is_one_way);
            let Some(value_um) = position.mean_um().or_else(|| Some(of_one_way()?.mean_um)) else {
                let mm = position.target_mm;
                notes.push(format!("Target {mm} mm was approached from one side only: left out."));
                continue;
            };
            let mut at_mm = place.at_mm;
            at_mm[axis as usize] = position.target_mm;
            rows.push(Row { at_mm, direction: unit(axis), value_um });
        }
        if rows.len() < MIN_TARGETS {
            let expected = "three targets or more that were approached from both sides, or all from one";
            return Err(InputError::expected(&test.source, expected, rows.len().to_string()));
        }
        if is_one_way {
            notes.push("Approached from one side only: its reversal is in the origin.".to_owned());
        }
        let scatter_um = scatter_um(&positions, &rows);
        let unknowns = vec![vec![1.0; rows.len()]];
        let is_held_out = place.is_held_out;
        Ok(Self {
            source: test.source.clone(),
            what: place.what,
            is_held_out,
            rows,
            unknowns,
            scatter_um,
            notes,
        })
    }

    /// The rows of a circle. Centre and radius are unknown, and of a probe for both axes its angle.
    ///
    /// # Errors
    /// A circle that was not measured at the tool, of other axes, or in one direction only.
    pub fn of_circle(measured: &Measured, plane: [Axis; 2], place: &Measurement) -> Result<Self, InputError> {
        let refused =
            |expected: &str, found: &str| Err(InputError::expected(&measured.source, expected, found));
        if !measured.is_at_tool() {
            return refused("a circle that was measured at the tool", measured.channel);
        }
        let own: Vec<Option<Axis>> = measured.axes.iter().map(|name| Axis::of(name)).collect();
        let plane = match own[..] {
            // A table of radii does not name its axes.
            _ if measured.channel == "radius" => plane,
            [Some(a), Some(b)] if plane.contains(&a) && plane.contains(&b) => [a, b],
            _ => {
                let expected = format!("a circle of {} and {}", plane[0].name(), plane[1].name());
                return refused(&expected, &measured.axes.join(" and "));
            }
        };
        let sectors = sectors(measured);
        if sectors.len() < MIN_SECTORS {
            let expected =
                format!("a circle in both directions, with both in {MIN_SECTORS} sectors of 2° or more");
            return refused(&expected, &sectors.len().to_string());
        }
        let radius_mm = measured.samples.radius_mm;
        let (rows, circular): (Vec<Row>, Vec<[f64; 4]>) =
            sectors.iter().flat_map(|sector| of_sector(sector, plane, place.at_mm, radius_mm)).unzip();
        let columns = if measured.samples.has_both_axes() { 4 } else { 3 };
        let unknowns = (0..columns).map(|column| circular.iter().map(|row| row[column]).collect()).collect();
        let (source, notes) = (measured.source.clone(), measured.notes.clone());
        let is_held_out = place.is_held_out;
        let channels = sectors.first().map_or(1, |(_, values_um)| values_um.len());
        let values_um: Vec<f64> = rows.iter().map(|row| row.value_um).collect();
        let scatter_um = by_second_differences(&values_um, channels);
        Ok(Self { source, what: place.what, is_held_out, rows, unknowns, scatter_um, notes })
    }

    /// What a least-squares fit of the unknowns of the instrument alone leaves of values of its rows.
    #[must_use]
    pub fn without_instrument(&self, values_um: &[f64]) -> Vec<f64> {
        let columns = nalgebra::DMatrix::from_fn(self.rows.len(), self.unknowns.len(), |row, column| {
            self.unknowns[column][row]
        });
        let values = nalgebra::DVector::from_column_slice(values_um);
        let solved = columns.clone().svd(true, true).solve(&values, 1e-9);
        match solved {
            Ok(solved) => (values - columns * solved).iter().copied().collect(),
            Err(_) => values_um.to_vec(),
        }
    }
}

/// The equations of a sector, each with what a displacement along both axes of the plane, a change of the radius, and, where both axes were
/// measured, a turn of the probe adds to it.
fn of_sector(
    (angle, values_um): &(f64, Vec<f64>),
    plane: [Axis; 2],
    centre_mm: [f64; 3],
    radius_mm: f64,
) -> Vec<(Row, [f64; 4])> {
    let (sin, cos) = libm::sincos(*angle);
    let mut at_mm = centre_mm;
    at_mm[plane[0] as usize] += radius_mm * cos;
    at_mm[plane[1] as usize] += radius_mm * sin;
    let row = |direction, value_um| Row { at_mm, direction, value_um };
    if let [first_um, second_um] = values_um[..] {
        return vec![
            (row(unit(plane[0]), first_um), [1.0, 0.0, cos, -sin]),
            (row(unit(plane[1]), second_um), [0.0, 1.0, sin, cos]),
        ];
    }
    let mut outwards = [0.0; 3];
    outwards[plane[0] as usize] = cos;
    outwards[plane[1] as usize] = sin;
    vec![(row(outwards, values_um[0]), [cos, sin, 1.0, 0.0])]
}

/// Standard deviation of the mean at a target, from run to run; with one run, from the second differences over the targets.
fn scatter_um(positions: &[Position], rows: &[Row]) -> f64 {
    let (mut squares, mut freedoms, mut readings) = (0.0, 0.0, 0.0);
    for way in positions.iter().flat_map(|position| position.ways).flatten() {
        let freedom = way.count as f64 - 1.0;
        squares += freedom * way.deviation_um.unwrap_or(0.0).powi(2);
        freedoms += freedom;
        readings += way.count as f64;
    }
    if freedoms > 0.0 {
        return (squares / freedoms / (readings / rows.len() as f64)).sqrt();
    }
    let values_um: Vec<f64> = rows.iter().map(|row| row.value_um).collect();
    by_second_differences(&values_um, 1)
}

/// Standard deviation of values from their second differences, which have six times the variance of independent values. `channels` are
/// interleaved.
fn by_second_differences(values_um: &[f64], channels: usize) -> f64 {
    let ends = 2 * channels;
    let second = |part: &[f64]| (part[0] - 2.0 * part[channels] + part[ends]).powi(2);
    let squares: Vec<f64> = values_um.windows(ends + 1).map(second).collect();
    (numerics::median(&squares).unwrap_or(0.0) / (6.0 * MEDIAN_OF_SQUARE)).sqrt()
}

/// The sector of an angle from 0 to a turn, rad.
fn sector_of(angle: f64) -> usize {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to the number of sectors")]
    let sector = (angle / SECTOR_RAD) as usize;
    sector.min(SECTORS - 1)
}

/// The samples of one direction in a sector: their number, the sums of their angles from the sector's middle, rad, and of what was measured.
#[derive(Clone, Default)]
struct Sector {
    number: f64,
    beyond_rad: f64,
    sums_um: Vec<f64>,
}

impl Sector {
    fn add(&mut self, beyond_rad: f64, values_um: impl Iterator<Item = f64>) {
        self.number += 1.0;
        self.beyond_rad += beyond_rad;
        for (index, um) in values_um.enumerate() {
            match self.sums_um.get_mut(index) {
                Some(sum_um) => *sum_um += um,
                None => self.sums_um.push(um),
            }
        }
    }
}

/// The mean angle of each sector that was measured in both directions, rad, and the mean of both, µm: of the radius, or of both axes.
fn sectors(measured: &Measured) -> Vec<(f64, Vec<f64>)> {
    let samples = &measured.samples;
    let channels: Vec<&Vec<f64>> = match &samples.observed {
        Observed::Both(both) => both.iter().collect(),
        Observed::Radial(radius) => vec![radius],
    };
    let middle = |sector: usize| (sector as f64 + 0.5) * SECTOR_RAD;
    let mut sectors = vec![[Sector::default(), Sector::default()]; SECTORS];
    for (index, instant) in samples.instants.iter().enumerate() {
        let angle = instant.angle.rem_euclid(TAU);
        let sector = sector_of(angle);
        let values_um = channels.iter().map(|channel| channel[index]);
        sectors[sector][usize::from(instant.direction < 0.0)].add(angle - middle(sector), values_um);
    }
    let is_at_reversal = |angle: f64| {
        let beyond = angle.rem_euclid(FRAC_PI_2);
        beyond.min(FRAC_PI_2 - beyond) < AT_REVERSAL_RAD
    };
    let mean = |(sector, [there, back]): (usize, [Sector; 2])| {
        let is_measured = there.number > 0.0 && back.number > 0.0;
        is_measured.then(|| {
            let of_both = |sum: f64, other: f64| 0.5 * (sum / there.number + other / back.number);
            let angle = middle(sector) + of_both(there.beyond_rad, back.beyond_rad);
            let values = there.sums_um.iter().zip(&back.sums_um).map(|(sum, other)| of_both(*sum, *other));
            (angle, values.collect())
        })
    };
    let means = sectors.into_iter().enumerate().filter_map(mean);
    means.filter(|(angle, _)| !is_at_reversal(*angle)).collect()
}
