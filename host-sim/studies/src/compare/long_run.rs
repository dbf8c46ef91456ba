//! The path of the long run in every tick, without control loops.
//!
//! `shared` interpolates in integers for every number format of the control laws, so that fixed, f32 and f64 have the
//! same path errors. The path in f32 metres ([`SinglePath`]) takes the same steps.

use std::f64::consts::TAU;

use shared::interpolate::{Path, PathError};
use shared::units::{PER_NM, Position};

use super::errors::{Spread, SpreadSum};
use super::motion::{Motion, RADIUS_M, circle_blocks};
use super::point::{AXES, difference_nm, length};
use super::single_path::SinglePath;

/// Errors of the commands of a long run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LongRunPath {
    /// Ticks of the path.
    pub ticks: u64,
    /// Distances of the integer commands from the exact path.
    pub integer: Spread,
    /// Distance of the last integer command from the programmed end, nm.
    pub end_nm: f64,
    /// Largest correction by which the last command of a block is set to its programmed end, nm: the distance
    /// of that end from the vertex of the parabola through the three previous commands.
    pub landing_nm: f64,
    /// Distances of the commands in f32 metres from the exact path at that tick.
    pub single: Spread,
    /// Distance along the path between the end of the path in f32 and the programmed end, nm; it may be several turns.
    /// The path in f32 is one block without a programmed end.
    pub single_end_nm: f64,
}

/// Runs a number of turns with `rate_hz` commands per second.
///
/// # Errors
/// When the path refuses its blocks.
pub fn run(turns: u32, rate_hz: f64) -> Result<LongRunPath, PathError> {
    let start = Motion::LongRun.start();
    let mut path = Path::<AXES>::new(start, rate_hz);
    let mut single_path: Option<SinglePath> = None;
    let mut result = LongRunPath::default();
    let (mut integer, mut single) = (SpreadSum::default(), SpreadSum::default());
    for circle in circle_blocks(turns) {
        // Always `Some`: a circle in two axes.
        let Some(block) = circle.for_axes::<AXES>() else { continue };
        path.push(&block)?;
        let single_path = single_path.get_or_insert_with(|| SinglePath::new(&circle, start));
        let mut before = [start; 3];
        while !path.is_done() {
            let from = path.command();
            before.rotate_right(1);
            before[0] = from;
            let to = path.advance();
            result.ticks += 1;
            let [u, v] = to.map(nm);
            integer.add((length([u, v]) - 1e9 * RADIUS_M).abs());
            let [x, y] =
                single_path.advance(single_path.step_m(from, to)).map(|metres| 1e9 * f64::from(metres));
            // The integer path serves as the exact one: its error is five orders of magnitude smaller.
            single.add(length([x - u, y - v]));
        }
        let end = path.command();
        let distances_nm = before.map(|at| length(difference_nm(end, at)));
        result.landing_nm = result.landing_nm.max(vertex_nm(distances_nm));
    }
    result.integer = integer.spread();
    result.single = single.spread();
    result.end_nm = length(difference_nm(path.command(), start));
    let missing = single_path.map_or(0.0, |path| f64::from(turns) - path.turns());
    result.single_end_nm = 1e9 * TAU * RADIUS_M * missing.abs();
    Ok(result)
}

/// Vertex of the parabola through three distances from the end, the nearest first, nm: zero, where a constant
/// deceleration comes to rest at the end, at a tick or between two.
fn vertex_nm([r1, r2, r3]: [f64; 3]) -> f64 {
    let (deceleration, slope) = (r3 - 2.0 * r2 + r1, (r3 - r1) / 2.0);
    (r2 - slope * slope / (2.0 * deceleration)).abs()
}

/// A position in nm, to 1e-8 nm on this circle.
fn nm(position: Position) -> f64 {
    position.0 as f64 / PER_NM as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three turns at 4 kHz.
    fn short() -> LongRunPath {
        run(3, 4000.0).unwrap()
    }

    #[test]
    fn the_integer_path_stays_on_the_circle_and_closes() {
        let short = short();
        // 3 · 2π · 100 mm at 1/6 m/s take 11.310 s; v²/R = 0.278 m/s² of 15/16 m/s² leave 0.895 for the ramps: 0.186 s.
        assert!((45_980..45_988).contains(&short.ticks), "{}", short.ticks);
        assert!(short.end_nm == 0.0, "{}", short.end_nm);
        // A position is rounded to 1e-6 nm in each axis.
        assert!(short.integer.max < 2e-5 && short.integer.rms > 1e-8, "{:?}", short.integer);
        // Roundings of half a unit, 5e-7 nm, in distances of up to 280 nm.
        assert!(short.landing_nm < 1e-4, "{}", short.landing_nm);
    }

    /// A tick is 41.67 µm long, the same in every tick at constant feed. The rounding error of each sum is at most half
    /// a unit in the last place, 30 nm above 0.5 m, which bounds the error. Between two powers of two the rounding is
    /// the same in every tick and does not average out, so that the drift is more than a few units.
    #[test]
    fn sums_in_single_precision_drift() {
        let short = short();
        let bound = short.ticks as f64 * 29.9;
        assert!(short.single_end_nm < bound && short.single_end_nm > 500.0, "{}", short.single_end_nm);
        assert!(short.single.max > 500.0 && short.single.max < bound, "{:?}", short.single);
        assert!(short.single.rms < short.single.max);
        // Twice the duration gives twice the distance, except for the ramps: a drift.
        let ratio = run(6, 4000.0).unwrap().single_end_nm / short.single_end_nm;
        assert!((1.8..2.2).contains(&ratio), "{ratio}");
    }
}
