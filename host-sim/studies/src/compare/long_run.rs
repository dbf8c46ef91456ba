//! The path of the long run: every tick of it, without a loop around it.
//!
//! `shared` interpolates in integers whatever the number format of its laws, so what is found of its path
//! holds for fixed, f32 and f64. The way in f32 metres goes along beside it.

use std::f64::consts::TAU;

use shared::interpolate::{Path, PathError};
use shared::units::{PER_NM, Position};

use super::AXES;
use super::errors::{Spread, Sum};
use super::exact::{apart_nm, length};
use super::motion::{Motion, RADIUS_M, pieces};
use super::pipeline::start_of;
use super::single::Way;

/// What the commands of a long run came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Travelled {
    /// Ticks of the path.
    pub ticks: u64,
    /// Distances between the integer command and the exact path.
    pub integers: Spread,
    /// From the programmed end to the last integer command, nm.
    pub end_nm: f64,
    /// What landing on the end of a piece hides, nm, at the most: how far from it the parabola through the
    /// last three commands before it comes to rest.
    pub landing_nm: f64,
    /// Distances between the command in f32 metres and the place where it should be at that tick.
    pub singles: Spread,
    /// How far along the path the way in f32 ends from where it should, nm: that may be turns. The way never
    /// lands, as f32 knows no greatest number of turns.
    pub singles_end_nm: f64,
}

/// Goes round for a number of turns, with a command every 1/`rate_hz`.
///
/// # Errors
/// When the path refuses its blocks.
pub fn travel(turns: u32, rate_hz: f64) -> Result<Travelled, PathError> {
    let start = start_of(Motion::LongRun);
    let mut path = Path::<AXES>::new(start, rate_hz);
    let mut way: Option<Way> = None;
    let mut travelled = Travelled::default();
    let (mut integers, mut singles) = (Sum::default(), Sum::default());
    for piece in pieces(turns) {
        // Circles of two axes are blocks of two axes.
        let Some(block) = piece.for_axes::<AXES>() else { continue };
        path.push(&block)?;
        let way = way.get_or_insert_with(|| Way::of(&piece, start));
        let mut before = [start; 3];
        while !path.is_done() {
            let from = path.command();
            before.rotate_right(1);
            before[0] = from;
            let to = path.advance();
            travelled.ticks += 1;
            let [u, v] = to.map(nm);
            integers.add((length([u, v]) - 1e9 * RADIUS_M).abs());
            let [x, y] = way.go(way.step_m(from, to)).map(|metres| 1e9 * f64::from(metres));
            // The integer path stands for the exact one: it is five orders of magnitude closer to it.
            singles.add(length([x - u, y - v]));
        }
        let end = path.command();
        travelled.landing_nm = travelled.landing_nm.max(rest_nm(before.map(|at| length(apart_nm(end, at)))));
    }
    travelled.integers = integers.spread();
    travelled.singles = singles.spread();
    travelled.end_nm = length(apart_nm(path.command(), start));
    let behind = way.map_or(0.0, |way| f64::from(turns) - way.turns());
    travelled.singles_end_nm = 1e9 * TAU * RADIUS_M * behind.abs();
    Ok(travelled)
}

/// Where the parabola through three distances from the end, the nearest first, has its vertex: zero, where
/// an even deceleration comes to rest on the end, between ticks or on one.
fn rest_nm([r1, r2, r3]: [f64; 3]) -> f64 {
    let (deceleration, slope) = (r3 - 2.0 * r2 + r1, (r3 - r1) / 2.0);
    (r2 - slope * slope / (2.0 * deceleration)).abs()
}

/// A position in nm, to 1e-8 nm on this circle.
fn nm(place: Position) -> f64 {
    place.0 as f64 / PER_NM as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three turns at 4 kHz.
    fn short() -> Travelled {
        travel(3, 4000.0).unwrap()
    }

    #[test]
    fn integers_close_and_stay_on_the_circle() {
        let short = short();
        // 3 · 2π · 100 mm at 1/6 m/s take 11.310 s; v²/R = 0.278 m/s² of 15/16 m/s² leave 0.895 for the ramps: 0.186 s.
        assert!((45_980..45_988).contains(&short.ticks), "{}", short.ticks);
        assert!(short.end_nm == 0.0, "{}", short.end_nm);
        // A position is rounded to 1e-6 nm in each axis.
        assert!(short.integers.max < 2e-5 && short.integers.rms > 1e-8, "{:?}", short.integers);
        // Roundings of half a unit, 5e-7 nm, in distances of up to 280 nm.
        assert!(short.landing_nm < 1e-4, "{}", short.landing_nm);
    }

    /// A tick goes 41.67 µm, the same in every tick of the cruise. Each sum is rounded to half a unit
    /// in the last place, 30 nm from 0.5 m on: that bounds the loss. Between two powers of two the
    /// rounding is the same in every tick and does not average out: it must show as more than a few units.
    #[test]
    fn sums_in_single_precision_run_away() {
        let short = short();
        let bound = short.ticks as f64 * 29.9;
        assert!(short.singles_end_nm < bound && short.singles_end_nm > 500.0, "{}", short.singles_end_nm);
        assert!(short.singles.max > 500.0 && short.singles.max < bound, "{:?}", short.singles);
        assert!(short.singles.rms < short.singles.max);
        // Twice as long, twice as far: it is a drift, within the share of the ramps.
        let ratio = travel(6, 4000.0).unwrap().singles_end_nm / short.singles_end_nm;
        assert!((1.8..2.2).contains(&ratio), "{ratio}");
    }
}
