//! Circles in three planes, in both directions, and the coefficients fitted to them (sections 2.1 and 2.3).
//!
//! Set point: the internal reading scaled onto the circle (equations (5) and (6)); set acceleration: −ω² times the set
//! point. Out of the plane, the error is fitted by a plane over both accelerations, which gives the cross-talk
//! (equation (9)). In the plane, cross-talk tilts the ellipse and in-talk stretches it (equations (7) and (8)): the tilt
//! is removed, an upright ellipse is fitted to the external and to the internal points, and the difference of their
//! half axes is −ω²·r times the in-talk.

use std::f64::consts::TAU;

use nalgebra::Matrix3;
use shared::interpolate::{Block, Ramps};

use super::closed_loop::{AXES, ClosedLoop, Row, SAMPLE_S};
use super::least_squares::{ellipse_half_axes_m, linear_fit};
use crate::reproduce::study::ReproduceError;

/// Radius of the paper's circle, m.
pub const RADIUS_M: f64 = 2e-3;

/// Turns of a circle.
const TURNS: u32 = 14;

/// Turns discarded at either end, in which the transients of the ramps decay.
const DISCARDED_TURNS: u32 = 3;

/// Acceleration limit of the block over the centripetal acceleration; the excess is available to the ramps.
const ACCELERATION_MARGIN: f64 = 2.0;

/// The planes, each by its two axes.
const PLANES: [[u8; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// The steady turns of a circle, with the set acceleration of each row.
#[derive(Clone, Debug)]
pub struct CircleRecord {
    /// The plane's axes.
    pub plane: [usize; 2],
    /// Whole turns; readings relative to their mean.
    pub rows: Vec<Row>,
    /// Set acceleration of the plane's axes, m/s².
    pub acceleration: Vec<[f64; 2]>,
    /// Angular frequency, rad/s; positive counter-clockwise.
    pub rad_per_s: f64,
    /// Mean radius of the internal points, m.
    pub radius_m: f64,
}

/// Coefficients measured on circles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// In-talk (diagonal) and cross-talk, µm per m/s². Row: direction of the error; column: accelerated axis.
    pub talk_um_s2_per_m: Matrix3<f64>,
    /// Standard errors of the cross-talk, from the residuals of the plane fit; 0 for the in-talk.
    pub deviation_um_s2_per_m: Matrix3<f64>,
    /// Effective mass at each drive, kg.
    pub effective_kg: [f64; AXES],
    /// Mean centripetal acceleration reached, m/s².
    pub reached_m_per_s2: f64,
    /// Mean angular frequency, rad/s.
    pub rad_per_s: f64,
}

/// Runs circles with a set acceleration (m/s²) in all planes and both directions.
///
/// # Errors
/// If the simulation fails.
pub fn run(machine: &ClosedLoop, set_m_per_s2: f64) -> Result<Vec<CircleRecord>, ReproduceError> {
    let feed = (set_m_per_s2 * RADIUS_M).sqrt();
    let mut circles = Vec::new();
    for (number, plane) in (0u64..).zip(PLANES) {
        for (direction, turns) in [(0, f64::from(TURNS)), (1, -f64::from(TURNS))] {
            let mut start = [0.0; AXES];
            start[usize::from(plane[0])] = RADIUS_M;
            // The circle itself has a jerk of ω³·r, 250 m/s³ at 5 m/s²; the ramps may use more.
            let ramps = Ramps::SCurve { jerk_m_per_s3: 1000.0 };
            let block = Block::arc(plane, [0.0, 0.0], turns, feed, ACCELERATION_MARGIN * set_m_per_s2)
                .with_ramps(ramps);
            let rows = machine.reseeded(2 * number + direction).run(start, &[block])?;
            circles.push(CircleRecord::new(plane.map(usize::from), &rows)?);
        }
    }
    Ok(circles)
}

impl CircleRecord {
    /// Extracts the steady turns of a record.
    fn new(plane: [usize; 2], rows: &[Row]) -> Result<Self, ReproduceError> {
        let [p, q] = plane;
        let mut angle = 0.0;
        let mut last = 0.0;
        let unwrapped = |row: &Row| {
            let now = libm::atan2(row.scale_m[q], row.scale_m[p]);
            angle += numerics::wrapped(now - last, TAU);
            last = now;
            angle
        };
        let angles: Vec<f64> = rows.iter().map(unwrapped).collect();
        let turned = |angle: &f64| angle.abs() / TAU;
        let row_after = |turns: u32| angles.iter().position(|angle| turned(angle) >= f64::from(turns));
        let (Some(from), Some(to)) = (row_after(DISCARDED_TURNS), row_after(TURNS - DISCARDED_TURNS)) else {
            return Err(ReproduceError::Numerics("a circle has too few turns".to_owned()));
        };
        let time: Vec<f64> = (from..to).map(|i| i as f64 * SAMPLE_S).collect();
        let line = linear_fit(&[&vec![1.0; time.len()], &time], &angles[from..to])?;
        let mut record = Self {
            plane,
            rows: rows[from..to].to_vec(),
            acceleration: Vec::new(),
            rad_per_s: line.coefficients[1],
            radius_m: 0.0,
        };
        record.subtract_means();
        let radius = |row: &Row| libm::hypot(row.scale_m[p], row.scale_m[q]);
        record.radius_m = numerics::mean(record.rows.iter().map(radius));
        let centripetal = record.centripetal_m_per_s2();
        let set = |row: &Row| [p, q].map(|axis| -centripetal * row.scale_m[axis] / radius(row));
        record.acceleration = record.rows.iter().map(set).collect();
        Ok(record)
    }

    /// Subtracts the mean over whole turns, which is the centre of the circle.
    fn subtract_means(&mut self) {
        for axis in 0..AXES {
            let scale = numerics::mean(self.rows.iter().map(|row| row.scale_m[axis]));
            let tool = numerics::mean(self.rows.iter().map(|row| row.tool_m[axis]));
            for row in &mut self.rows {
                row.scale_m[axis] -= scale;
                row.tool_m[axis] -= tool;
            }
        }
    }

    /// ω²·r, m/s².
    fn centripetal_m_per_s2(&self) -> f64 {
        self.rad_per_s.powi(2) * self.radius_m
    }

    /// Acceleration of one of the plane's axes over the rows, m/s².
    fn accelerations(&self, index: usize) -> Vec<f64> {
        self.acceleration.iter().map(|both| both[index]).collect()
    }

    /// Half axes, m, of the points with the tilt by cross-talk (µm per m/s²) removed.
    fn half_axes_m(
        &self,
        point: fn(&Row) -> [f64; AXES],
        cross_talk: &Matrix3<f64>,
    ) -> Result<[f64; 2], ReproduceError> {
        let [p, q] = self.plane;
        let upright = |(row, a): (&Row, &[f64; 2])| {
            let at = point(row);
            [at[p] - 1e-6 * cross_talk[(p, q)] * a[1], at[q] - 1e-6 * cross_talk[(q, p)] * a[0]]
        };
        let points: Vec<[f64; 2]> = self.rows.iter().zip(&self.acceleration).map(upright).collect();
        ellipse_half_axes_m(&points, RADIUS_M)
    }
}

/// The coefficients from circles in all planes.
///
/// # Errors
/// If a fit has no solution.
pub fn evaluate(circles: &[CircleRecord]) -> Result<Measured, ReproduceError> {
    let mut measured = plane_fits(circles)?;
    let cross_talk = measured.talk_um_s2_per_m;
    for circle in circles {
        let external = circle.half_axes_m(|row| row.tool_m, &cross_talk)?;
        let internal = circle.half_axes_m(|row| row.scale_m, &Matrix3::zeros())?;
        for (axis, i) in circle.plane.into_iter().zip(0..) {
            // Mean over four circles: each axis is in two planes, each run in both directions.
            measured.talk_um_s2_per_m[(axis, axis)] -=
                0.25e6 * (external[i] - internal[i]) / circle.centripetal_m_per_s2();
        }
    }
    Ok(measured)
}

/// Cross-talk, effective masses and means; the in-talk is left at 0.
fn plane_fits(circles: &[CircleRecord]) -> Result<Measured, ReproduceError> {
    let mut talk = Matrix3::zeros();
    let mut deviation = Matrix3::zeros();
    let mut effective_kg = [0.0; AXES];
    for plane in PLANES.map(|plane| plane.map(usize::from)) {
        let in_plane: Vec<&CircleRecord> = circles.iter().filter(|circle| circle.plane == plane).collect();
        let [first, second] = [0, 1].map(|i| concatenated(&in_plane, |circle| circle.accelerations(i)));
        let normal = AXES - plane[0] - plane[1];
        let error =
            concatenated(&in_plane, |circle| circle.rows.iter().map(|row| row.error_m(normal)).collect());
        let fit = linear_fit(&[&first, &second], &error)?;
        for (axis, i) in plane.into_iter().zip(0..) {
            talk[(normal, axis)] = 1e6 * fit.coefficients[i];
            deviation[(normal, axis)] = 1e6 * fit.standard_errors[i];
            let force =
                concatenated(&in_plane, |circle| circle.rows.iter().map(|row| row.force_n[axis]).collect());
            // Mean over the two planes that each axis is in.
            effective_kg[axis] += 0.5 * linear_fit(&[&first, &second], &force)?.coefficients[i];
        }
    }
    let mean = |of: fn(&CircleRecord) -> f64| numerics::mean(circles.iter().map(of));
    Ok(Measured {
        talk_um_s2_per_m: talk,
        deviation_um_s2_per_m: deviation,
        effective_kg,
        reached_m_per_s2: mean(CircleRecord::centripetal_m_per_s2),
        rad_per_s: mean(|circle| circle.rad_per_s.abs()),
    })
}

/// One quantity of several circles, one after the other.
fn concatenated(circles: &[&CircleRecord], of: impl Fn(&CircleRecord) -> Vec<f64>) -> Vec<f64> {
    circles.iter().flat_map(|circle| of(circle)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::acceleration::machines;
    use crate::reproduce::acceleration::machines::Instruments;
    use model::bodies::Assembly;

    /// Simulated circles, evaluated like a measurement, give the closed form at their frequency to 1 %, and the
    /// quasi-static one to the amplification that the lowest mode (30 Hz) has at 8 Hz: (8/30)²/(1 − (8/30)²) = 8 %.
    #[test]
    fn simulated_circles_give_the_closed_form() {
        let catalogue = machines::catalogue().unwrap();
        let assembly = Assembly::of(&catalogue).unwrap();
        let lowest_hz = assembly.natural_frequencies_hz().unwrap()[AXES];
        let machine = ClosedLoop::new(&catalogue, machines::GAINS, Instruments::default()).unwrap();
        let measured = evaluate(&run(&machine, 5.0).unwrap()).unwrap();
        let closed = assembly.talk_at(measured.rad_per_s).unwrap();
        let at_rest = assembly.talk_at_rest().unwrap();
        let ratio = (measured.rad_per_s / (TAU * lowest_hz)).powi(2);
        let bound = ratio / (1.0 - ratio);
        assert!((0.05..0.1).contains(&bound), "{bound}");
        for (found, (closed, at_rest)) in measured
            .talk_um_s2_per_m
            .iter()
            .zip(closed.tool_um_s2_per_m.iter().zip(at_rest.tool_um_s2_per_m.iter()))
        {
            // Small coefficients are differences of large ones: an absolute tolerance in addition to the relative one.
            assert!((found - closed).abs() < 0.01 * closed.abs() + 2e-3, "{found} {closed}");
            assert!((found - at_rest).abs() < bound * at_rest.abs() + 5e-3, "{found} {at_rest}");
        }
        for axis in 0..AXES {
            assert!((measured.effective_kg[axis] / closed.force_kg[(axis, axis)] - 1.0).abs() < 5e-3);
        }
        // P control without feed-forward lags: the circle shrinks, by a factor of at least 1/√(1 + (ω/Kp)²).
        let min = 5.0 / (1.0 + (50.0 / machines::GAINS.position_per_s).powi(2)).sqrt();
        assert!((min..5.0).contains(&measured.reached_m_per_s2), "{min} {}", measured.reached_m_per_s2);
    }
}
