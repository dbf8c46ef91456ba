//! What an axis does beside its command: a table over the position, a backlash, and gains that change.

use commissioning::compensate::CompensationFile;
use commissioning::compensate::file::AxisCompensation;
use model::axis::Settings;
use model::machine::{Axis, Machine};
use model::servo::VelocityDrive;
use shared::compensate::CompensationSettings;
use shared::compensate::settings::{Cycle, POINTS, PitchSource, Points};

/// Points of a table per period of a periodic error, the first that fit: linear interpolation leaves 2 or 8 % of its amplitude.
const POINTS_PER_PERIOD: [f64; 2] = [16.0, 8.0];

/// The errors of an axis.
#[derive(Clone, Debug)]
pub struct AxisErrors<'a> {
    /// Name of the axis.
    pub axis: &'a str,
    /// Number of the axis in the machine file, from 0.
    pub number: usize,
    /// Settings as declared, with which the gains of the compensation are compared.
    pub declared: &'a Settings,
    /// A drive whose velocity is commanded, as a trace has fitted it.
    pub fitted: VelocityDrive,
    /// Period of the position loop, s.
    pub period_s: f64,
    /// What the compensation does.
    pub compensation: &'a AxisCompensation,
    /// Errors over the position; `None`: there are none.
    pub table: Option<ErrorTable>,
    /// Travel of the command after a reversal before the table follows, where it is the same everywhere, µm.
    pub backlash_um: f64,
    /// Why periodic errors are not in the table.
    pub unresolved: Option<String>,
}

/// Errors over evenly spaced positions, without the backlash that is the same everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorTable {
    /// First position, mm.
    pub start_mm: f64,
    /// Distance of the positions, mm.
    pub spacing_mm: f64,
    /// Actual − commanded position in positive direction, µm.
    pub forward_um: Vec<f64>,
    /// The error in negative direction, µm.
    pub backward_um: Vec<f64>,
}

impl<'a> AxisErrors<'a> {
    /// All axes that a compensation changes. A table has at most this many points; 0: the control has none.
    #[must_use]
    pub fn all(machine: &'a Machine, file: &'a CompensationFile, most_points: usize) -> Vec<Self> {
        let of_axis = |(name, compensation): (&'a String, &'a AxisCompensation)| {
            let (number, _, axis) = machine.axis.get_full(name)?;
            let period_s = 1.0 / machine.sample_rate_hz;
            Some(Self::of((name, number), (axis, period_s), compensation, most_points))
        };
        file.axis.iter().filter_map(of_axis).collect()
    }

    fn of(
        (axis, number): (&'a str, usize),
        (declared, period_s): (&'a Axis, f64),
        compensation: &'a AxisCompensation,
        most_points: usize,
    ) -> Self {
        let settings = &compensation.compensation;
        let (table, unresolved) = match ErrorTable::of(compensation, most_points) {
            Ok(table) => (table, None),
            Err(Unresolved { period_mm, without }) => {
                let why = format!(
                    "{axis}: its periodic error of {period_mm} mm is not in the table, which would need more than {most_points} points."
                );
                (without, Some(why))
            }
        };
        let backlash_um = 1e6 * settings.backlash_width_m.unwrap_or(0.0);
        Self {
            axis,
            number,
            declared: &declared.settings,
            fitted: declared.fitted_velocity_drive(),
            period_s,
            compensation,
            table,
            backlash_um,
            unresolved,
        }
    }

    /// Name of the axis as most controls write it.
    #[must_use]
    pub fn upper(&self) -> String {
        self.axis.to_uppercase()
    }

    /// Position, mm, and error in positive and in negative direction, µm, with half of the backlash each: the table is behind in the
    /// direction of motion. Without a table over the position there are no rows.
    pub fn rows(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let half_um = 0.5 * self.backlash_um;
        self.table.iter().flat_map(move |table| {
            let errors = table.forward_um.iter().zip(&table.backward_um);
            table
                .positions_mm()
                .zip(errors)
                .map(move |(mm, (forward_um, backward_um))| [mm, forward_um - half_um, backward_um + half_um])
        })
    }

    /// The backlash, with the mean by which the directions of the table differ, µm: for a control with one table of both.
    #[must_use]
    pub fn mean_backlash_um(&self) -> f64 {
        self.backlash_um + self.table.as_ref().map_or(0.0, ErrorTable::mean_difference_um)
    }

    /// Whether a control has something to compensate over the position.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.table.is_some() || self.backlash_um > 0.0
    }
}

/// Periodic errors that a table cannot resolve, and the table without them.
struct Unresolved {
    period_mm: f64,
    without: Option<ErrorTable>,
}

impl ErrorTable {
    fn of(compensation: &AxisCompensation, most_points: usize) -> Result<Option<Self>, Unresolved> {
        let settings = &compensation.compensation;
        let Some(travel_mm) = travel_mm(compensation).filter(|_| most_points >= 2) else { return Ok(None) };
        let shortest_mm = settings.screw.iter().map(|cycle| 1e3 * cycle.period_m).reduce(f64::min);
        let without = || {
            let has_pitch = settings.pitch.is_some();
            has_pitch.then(|| Self::sampled(settings, &[], travel_mm, most_points.min(POINTS)))
        };
        let Some(period_mm) = shortest_mm else { return Ok(without()) };
        let length_mm = travel_mm[1] - travel_mm[0];
        let count = |per_period: f64| (per_period * length_mm / period_mm).ceil() + 1.0;
        let fits = POINTS_PER_PERIOD.into_iter().map(count).find(|count| *count <= most_points as f64);
        let Some(count) = fits else { return Err(Unresolved { period_mm, without: without() }) };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most the points of a table"
        )]
        let count = (count as usize).max(POINTS.min(most_points));
        Ok(Some(Self::sampled(settings, &settings.screw, travel_mm, count)))
    }

    fn sampled(
        settings: &CompensationSettings,
        cycles: &[Cycle],
        [start_mm, end_mm]: [f64; 2],
        count: usize,
    ) -> Self {
        let spacing_mm = (end_mm - start_mm) / (count - 1) as f64;
        let at = |points: &dyn Fn(f64) -> f64| -> Vec<f64> {
            (0..count).map(|k| 1e6 * points(1e-3 * spacing_mm.mul_add(k as f64, start_mm))).collect()
        };
        let periodic = |x: f64| cycles.iter().map(|cycle| periodic(cycle, x)).sum::<f64>();
        let pitch = settings.pitch.as_ref();
        // A scale that reads too much leaves the table behind by its error.
        let sign = if pitch.is_some_and(|pitch| pitch.of == PitchSource::Scale) { -1.0 } else { 1.0 };
        let forward = pitch.map(|pitch| &pitch.forward);
        let backward = pitch.and_then(|pitch| pitch.backward.as_ref()).or(forward);
        let value = |points: Option<&Points>, x: f64| sign * points.map_or(0.0, |points| linear(points, x));
        Self {
            start_mm,
            spacing_mm,
            forward_um: at(&|x| value(forward, x) + periodic(x)),
            backward_um: at(&|x| value(backward, x) + periodic(x)),
        }
    }

    /// The positions, mm.
    pub fn positions_mm(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.forward_um.len()).map(|k| self.spacing_mm.mul_add(k as f64, self.start_mm))
    }

    /// Mean of both directions, µm.
    pub fn mean_um(&self) -> impl Iterator<Item = f64> + '_ {
        self.forward_um.iter().zip(&self.backward_um).map(|(forward, backward)| 0.5 * (forward + backward))
    }

    /// Mean difference of the errors in negative and in positive direction, µm.
    fn mean_difference_um(&self) -> f64 {
        numerics::mean(self.backward_um.iter().zip(&self.forward_um).map(|(back, forth)| back - forth))
    }

    /// Whether the directions differ by more than the backlash.
    #[must_use]
    pub fn has_directions(&self) -> bool {
        self.forward_um != self.backward_um
    }
}

/// The travel of the tables, mm.
fn travel_mm(compensation: &AxisCompensation) -> Option<[f64; 2]> {
    let of_points = |points: &Points| {
        let length_m = points.spacing_m * (points.values.len() - 1) as f64;
        [1e3 * points.start_m, 1e3 * (points.start_m + length_m)]
    };
    let pitch = compensation.compensation.pitch.as_ref();
    pitch.map(|pitch| of_points(&pitch.forward)).or(compensation.mapped_mm)
}

/// A table of the controller at a position, m; beyond its ends the last value.
fn linear(points: &Points, x_m: f64) -> f64 {
    let last = points.values.len() - 1;
    let at = ((x_m - points.start_m) / points.spacing_m).clamp(0.0, last as f64);
    interpolated(|k| points.values[k.min(last)], at)
}

/// A periodic table of the controller at a position, m.
fn periodic(cycle: &Cycle, x_m: f64) -> f64 {
    let count = cycle.values.len();
    let at = (x_m / cycle.period_m).rem_euclid(1.0) * count as f64;
    interpolated(|k| cycle.values[k % count], at)
}

/// Linear between the values at whole numbers.
fn interpolated(value: impl Fn(usize) -> f64, at: f64) -> f64 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index of the table")]
    let k = at.floor() as usize;
    let part = at - k as f64;
    value(k) * (1.0 - part) + value(k + 1) * part
}
