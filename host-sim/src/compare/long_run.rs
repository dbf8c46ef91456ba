//! The path of the long run: every tick of it, without a loop around it.
//!
//! `shared` interpolates in integers whatever the number format of its laws, so one pass serves fixed,
//! f32 and f64. f32 positions need a pass of their own.

use shared::interpolate::{Path, PathError};
use shared::units::{PER_NM, Position};

use super::AXES;
use super::errors::{Spread, Sum, command_nm};
use super::exact::{Exact, Point, apart_nm, length};
use super::motion::{Motion, RADIUS_M, pieces};
use super::pipeline::start_of;
use super::single::{Way, position};

/// What the commands of a long run came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travelled {
    /// Ticks of the path.
    pub ticks: u64,
    /// Distances between command and exact path, or for f32 positions from the place that the command
    /// should have at that tick.
    pub command: Spread,
    /// From the programmed end to the last command, nm; for f32 positions along the path, for they may be a
    /// turn or more behind.
    pub end_nm: f64,
    /// Greatest difference between the last step into the end of a piece and the first out of its start,
    /// nm. Speed profiles are symmetric: this is what landing on the end point hides.
    pub landing_nm: f64,
}

/// Ticks the integer path through, at a rate of position loops, and calls `each` with the command before
/// and after.
fn travel(
    turns: u32,
    rate_hz: f64,
    mut each: impl FnMut(Point, Point),
) -> Result<(u64, f64, Point), PathError> {
    let mut path = Path::<AXES>::new(start_of(Motion::LongRun), rate_hz);
    let (mut ticks, mut landing_nm) = (0, 0.0_f64);
    for piece in pieces(turns) {
        // Circles of two axes are blocks of two axes.
        let Some(block) = piece.for_axes::<AXES>() else { continue };
        path.push(&block)?;
        let (mut first_nm, mut step_nm) = (None, 0.0);
        while !path.is_done() {
            let from = path.command();
            let to = path.advance();
            each(from, to);
            ticks += 1;
            if first_nm.is_none() || path.is_done() {
                step_nm = length(apart_nm(to, from));
                first_nm.get_or_insert(step_nm);
            }
        }
        landing_nm = landing_nm.max((step_nm - first_nm.unwrap_or(step_nm)).abs());
    }
    Ok((ticks, landing_nm, path.command()))
}

/// The exact circle of the long run.
fn circle() -> Exact {
    let start = start_of(Motion::LongRun);
    Exact::Circle { start, centre: [Position(0); AXES] }
}

/// The path as `shared` travels it.
///
/// # Errors
/// When the path refuses its blocks.
pub fn integers(turns: u32, rate_hz: f64) -> Result<Travelled, PathError> {
    // Off a circle about the origin: |radius − R|, without the vector.
    let radius_nm = RADIUS_M * 1e9;
    let mut sum = Sum::default();
    let (ticks, landing_nm, end) = travel(turns, rate_hz, |_, [x, y]| {
        let [x, y] = [x, y].map(|place| place.0 as f64 / PER_NM as f64);
        sum.add((length([x, y]) - radius_nm).abs());
    })?;
    let end_nm = length(apart_nm(end, circle().end()));
    Ok(Travelled { ticks, command: sum.spread(), end_nm, landing_nm })
}

/// The same path in f32 metres: one way that never lands, as it knows no greatest number of turns.
///
/// # Errors
/// When the path refuses its blocks.
pub fn singles(turns: u32, rate_hz: f64) -> Result<Travelled, PathError> {
    let mut sum = Sum::default();
    let Some(block) = pieces(turns).next() else {
        return Ok(Travelled { ticks: 0, command: Spread::default(), end_nm: 0.0, landing_nm: 0.0 });
    };
    let circle = circle();
    let mut way = Way::of(&block, start_of(Motion::LongRun));
    let (ticks, ..) = travel(turns, rate_hz, |from, to| {
        let command = way.go(way.step_m(from, to)).map(position);
        sum.add(command_nm(command, to, circle.off_nm(to)));
    })?;
    let end_nm = 1e9 * std::f64::consts::TAU * RADIUS_M * (way.turns() - f64::from(turns)).abs();
    Ok(Travelled { ticks, command: sum.spread(), end_nm, landing_nm: 0.0 })
}
