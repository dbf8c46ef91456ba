//! Sections 2.1 and 2.3 of the paper: circles in three planes, both ways, and what is fitted to them.
//!
//! Equations (5) and (6) make the set point of the internal reading, by scaling it onto the circle; its acceleration
//! is −ω² times the set point. Out of the plane the error is a plane over both accelerations (cross-talk,
//! equation (9)). In the plane cross-talk tilts an ellipse and in-talk stretches it, equations (7) and (8): with the tilt taken
//! out, an upright ellipse is fitted to the external and to the internal points, and the difference of their half
//! axes is −ω²·r times the in-talk.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector, Matrix3};
use shared::interpolate::{Block, Ramps};

use super::bench::{AXES, Bench, Row, SAMPLE_S};
use crate::reproduce::ReproduceError;

/// The paper's circle.
pub const RADIUS_M: f64 = 2e-3;

/// Turns of a circle, and those at either end that are not looked at: the ramps ring out in them.
const TURNS: u32 = 14;
const SPARED_TURNS: u32 = 3;

/// Acceleration that the block is given, of the one towards the centre: what is left is for the ramps.
const MARGIN: f64 = 2.0;

/// The planes by their two axes.
const PLANES: [[u8; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// Even turns of a circle with the acceleration of each row.
#[derive(Clone, Debug)]
pub struct Lap {
    /// The plane's axes.
    pub plane: [usize; 2],
    /// Whole turns, about their centre.
    pub rows: Vec<Row>,
    /// Set acceleration in the plane, m/s².
    pub acceleration: Vec<[f64; 2]>,
    /// Angular frequency, rad/s; its sign is that of the turns.
    pub rad_per_s: f64,
    /// Mean radius of the internal points, m.
    pub radius_m: f64,
}

/// What was measured on circles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Rows: displaced along; columns: accelerated along; µm per m/s².
    pub talk_um_s2_per_m: Matrix3<f64>,
    /// Standard errors of the cross-talk by the scatter about the plane; not given (0) for in-talk.
    pub deviation_um_s2_per_m: Matrix3<f64>,
    /// What each drive feels, kg.
    pub felt_kg: [f64; AXES],
    /// Mean acceleration that was reached, m/s².
    pub reached_m_per_s2: f64,
    /// Mean angular frequency, rad/s.
    pub rad_per_s: f64,
}

/// Runs circles with a set acceleration (m/s²) in all planes, both ways.
///
/// # Errors
/// When the loop does not hold.
pub fn run(bench: &Bench, set_m_per_s2: f64) -> Result<Vec<Lap>, ReproduceError> {
    let feed = (set_m_per_s2 * RADIUS_M).sqrt();
    let mut laps = Vec::new();
    for (number, plane) in (0u64..).zip(PLANES) {
        for (way, turns) in [(0, f64::from(TURNS)), (1, -f64::from(TURNS))] {
            let mut start = [0.0; AXES];
            start[usize::from(plane[0])] = RADIUS_M;
            // On the circle itself the acceleration turns with ω³·r, 250 m/s³ at 5 m/s²: the ramps may have more.
            let ramps = Ramps::SCurve { jerk_m_per_s3: 1000.0 };
            let block = Block::arc(plane, [0.0, 0.0], turns, feed, MARGIN * set_m_per_s2).with_ramps(ramps);
            let rows = bench.reseeded(2 * number + way).run(start, &[block])?;
            laps.push(Lap::of(plane.map(usize::from), &rows)?);
        }
    }
    Ok(laps)
}

impl Lap {
    /// The even turns of a record.
    fn of(plane: [usize; 2], rows: &[Row]) -> Result<Self, ReproduceError> {
        let [p, q] = plane;
        let mut angle = 0.0;
        let mut last = 0.0;
        let unwrapped = |row: &Row| {
            let now = row.scale_m[q].atan2(row.scale_m[p]);
            angle += (now - last + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
            last = now;
            angle
        };
        let angles: Vec<f64> = rows.iter().map(unwrapped).collect();
        let turned = |angle: &f64| angle.abs() / TAU;
        let passes = |turns: u32| angles.iter().position(|angle| turned(angle) >= f64::from(turns));
        let (Some(from), Some(to)) = (passes(SPARED_TURNS), passes(TURNS - SPARED_TURNS)) else {
            return Err(ReproduceError::Numerics("a circle has too few turns".to_owned()));
        };
        let time: Vec<f64> = (from..to).map(|i| i as f64 * SAMPLE_S).collect();
        let line = solve(&[&vec![1.0; time.len()], &time], &angles[from..to])?;
        let mut lap = Self {
            plane,
            rows: rows[from..to].to_vec(),
            acceleration: Vec::new(),
            rad_per_s: line.coefficients[1],
            radius_m: 0.0,
        };
        lap.centre();
        let radius = |row: &Row| row.scale_m[p].hypot(row.scale_m[q]);
        lap.radius_m = numerics::mean(lap.rows.iter().map(radius));
        let pull = lap.rad_per_s.powi(2) * lap.radius_m;
        lap.acceleration =
            lap.rows.iter().map(|row| [p, q].map(|axis| -pull * row.scale_m[axis] / radius(row))).collect();
        Ok(lap)
    }

    /// About the means over whole turns.
    fn centre(&mut self) {
        for axis in 0..AXES {
            let scale = numerics::mean(self.rows.iter().map(|row| row.scale_m[axis]));
            let tool = numerics::mean(self.rows.iter().map(|row| row.tool_m[axis]));
            for row in &mut self.rows {
                row.scale_m[axis] -= scale;
                row.tool_m[axis] -= tool;
            }
        }
    }

    /// One of the plane's accelerations over the rows.
    fn accelerations(&self, index: usize) -> Vec<f64> {
        self.acceleration.iter().map(|both| both[index]).collect()
    }
}

/// The coefficients of circles in all planes.
///
/// # Errors
/// Where a fit has no solution.
pub fn evaluate(laps: &[Lap]) -> Result<Measured, ReproduceError> {
    let mut talk = Matrix3::zeros();
    let mut deviation = Matrix3::zeros();
    let mut felt_kg = [0.0; AXES];
    let in_plane =
        |plane: [usize; 2]| -> Vec<&Lap> { laps.iter().filter(|lap| lap.plane == plane).collect() };
    for plane in PLANES.map(|plane| plane.map(usize::from)) {
        let laps = in_plane(plane);
        let [first, second] = [0, 1].map(|i| pooled(&laps, |lap| lap.accelerations(i)));
        let normal = AXES - plane[0] - plane[1];
        let error = |axis: usize| pooled(&laps, |lap| lap.rows.iter().map(|row| row.error_m(axis)).collect());
        let flat = solve(&[&first, &second], &error(normal))?;
        for (axis, i) in plane.into_iter().zip(0..) {
            talk[(normal, axis)] = 1e6 * flat.coefficients[i];
            deviation[(normal, axis)] = 1e6 * flat.deviation[i];
            let force = pooled(&laps, |lap| lap.rows.iter().map(|row| row.force_n[axis]).collect());
            // Each axis turns in two planes.
            felt_kg[axis] += 0.5 * solve(&[&first, &second], &force)?.coefficients[i];
        }
    }
    let cross = talk;
    for lap in laps {
        let [p, q] = lap.plane;
        let upright = |point: fn(&Row) -> [f64; AXES], tilt: &Matrix3<f64>| {
            let straight = |(row, a): (&Row, &[f64; 2])| {
                let at = point(row);
                [at[p] - 1e-6 * tilt[(p, q)] * a[1], at[q] - 1e-6 * tilt[(q, p)] * a[0]]
            };
            half_axes(&lap.rows.iter().zip(&lap.acceleration).map(straight).collect::<Vec<_>>())
        };
        let external = upright(|row| row.tool_m, &cross)?;
        let internal = upright(|row| row.scale_m, &Matrix3::zeros())?;
        let pull = lap.rad_per_s.powi(2) * lap.radius_m;
        for (axis, i) in lap.plane.into_iter().zip(0..) {
            // Two planes, both ways.
            talk[(axis, axis)] -= 0.25e6 * (external[i] - internal[i]) / pull;
        }
    }
    let mean = |of: fn(&Lap) -> f64| numerics::mean(laps.iter().map(of));
    Ok(Measured {
        talk_um_s2_per_m: talk,
        deviation_um_s2_per_m: deviation,
        felt_kg,
        reached_m_per_s2: mean(|lap| lap.rad_per_s.powi(2) * lap.radius_m),
        rad_per_s: mean(|lap| lap.rad_per_s.abs()),
    })
}

/// Half axes of the upright ellipse x²/A² + y²/B² = 1 through points, least squares in 1/A² and 1/B² and the
/// centre's shares of x and y.
///
/// # Errors
/// Where the points lie on no ellipse.
pub fn half_axes(points: &[[f64; 2]]) -> Result<[f64; 2], ReproduceError> {
    // In radii, so that all four unknowns are of the size of one.
    let column = |of: fn(f64, f64) -> f64| -> Vec<f64> {
        points.iter().map(|[x, y]| of(x / RADIUS_M, y / RADIUS_M)).collect()
    };
    let columns = [column(|x, _| x * x), column(|_, y| y * y), column(|x, _| x), column(|_, y| y)];
    let conic = solve(&columns.each_ref().map(Vec::as_slice), &vec![1.0; points.len()])?.coefficients;
    let (a, b) = (conic[0], conic[1]);
    // x²·a + x·c = a·(x + c/2a)² − c²/4a.
    let whole = 1.0 + conic[2].powi(2) / (4.0 * a) + conic[3].powi(2) / (4.0 * b);
    if a > 0.0 && b > 0.0 {
        Ok([a, b].map(|share| RADIUS_M * (whole / share).sqrt()))
    } else {
        Err(ReproduceError::Numerics("the points lie on no ellipse".to_owned()))
    }
}

/// A least-squares solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// One a column.
    pub coefficients: Vec<f64>,
    /// Their standard errors by the scatter about the fit.
    pub deviation: Vec<f64>,
}

/// Least squares by the normal equations: the columns are of one size and far from parallel.
///
/// # Errors
/// Where there is none.
pub fn solve(columns: &[&[f64]], right: &[f64]) -> Result<Solution, ReproduceError> {
    let design = DMatrix::from_fn(right.len(), columns.len(), |row, column| columns[column][row]);
    let right = DVector::from_row_slice(right);
    let failed = |what: &str| ReproduceError::Numerics(format!("least squares: {what}"));
    let normal =
        design.tr_mul(&design).cholesky().ok_or_else(|| failed("the columns are not independent"))?;
    let solution = normal.solve(&design.tr_mul(&right));
    let scatter = (&design * &solution - &right).norm_squared() / (right.len() as f64 - columns.len() as f64);
    let deviation = normal.inverse().diagonal().map(|share| (scatter * share).sqrt());
    Ok(Solution {
        coefficients: solution.iter().copied().collect(),
        deviation: deviation.iter().copied().collect(),
    })
}

fn pooled(laps: &[&Lap], of: impl Fn(&Lap) -> Vec<f64>) -> Vec<f64> {
    laps.iter().flat_map(|lap| of(lap)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::acceleration::bench::Instruments;
    use crate::reproduce::acceleration::machines;
    use model::bodies::Assembly;

    /// An upright ellipse a few µm from a circle and from the origin has the half axes that it was made with.
    #[test]
    fn the_half_axes_of_an_ellipse_are_found() {
        let (a, b, x0, y0) = (2.003e-3, 1.996e-3, 4e-6, -7e-6);
        let at = |i: u32| TAU * f64::from(i) / 100.0;
        let points: Vec<[f64; 2]> = (0..100).map(|i| [x0 + a * at(i).cos(), y0 + b * at(i).sin()]).collect();
        let [found_a, found_b] = half_axes(&points).unwrap();
        assert!((found_a - a).abs() < 1e-12 && (found_b - b).abs() < 1e-12, "{found_a} {found_b}");
        // A hyperbola is none.
        let open: Vec<[f64; 2]> = (0..100).map(|i| [1e-3 * at(i).cosh(), 1e-3 * at(i).sinh()]).collect();
        assert!(half_axes(&open).is_err());
    }

    /// Circles of the whole loop, evaluated like a measurement, give the closed form at their frequency to 1 % and
    /// that at rest to what the lowest mode, 30 Hz, can add to it at 8 Hz: (8/30)²/(1 − (8/30)²) = 8 %.
    #[test]
    fn simulated_circles_give_the_closed_form() {
        let catalogue = machines::catalogue().unwrap();
        let assembly = Assembly::of(&catalogue).unwrap();
        let lowest_hz = assembly.natural_frequencies_hz().unwrap()[AXES];
        let bench = Bench::new(&catalogue, machines::GAINS, Instruments::default()).unwrap();
        let measured = evaluate(&run(&bench, 5.0).unwrap()).unwrap();
        let closed = assembly.talk_at(measured.rad_per_s).unwrap();
        let at_rest = assembly.talk_at_rest().unwrap();
        let share = (measured.rad_per_s / (TAU * lowest_hz)).powi(2);
        let bound = share / (1.0 - share);
        assert!((0.05..0.1).contains(&bound), "{bound}");
        for (found, (closed, at_rest)) in measured
            .talk_um_s2_per_m
            .iter()
            .zip(closed.tool_um_s2_per_m.iter().zip(at_rest.tool_um_s2_per_m.iter()))
        {
            // Small ones are what is left between large ones.
            assert!((found - closed).abs() < 0.01 * closed.abs() + 2e-3, "{found} {closed}");
            assert!((found - at_rest).abs() < bound * at_rest.abs() + 5e-3, "{found} {at_rest}");
        }
        for axis in 0..AXES {
            assert!((measured.felt_kg[axis] / closed.force_kg[(axis, axis)] - 1.0).abs() < 5e-3);
        }
        // P control without feed-forward lags: the circle is smaller, but not by more than 1/√(1 + (ω/Kp)²).
        let least = 5.0 / (1.0 + (50.0 / machines::GAINS.position_per_s).powi(2)).sqrt();
        assert!((least..5.0).contains(&measured.reached_m_per_s2), "{least} {}", measured.reached_m_per_s2);
    }
}
