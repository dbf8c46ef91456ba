//! Phases made into a position: a resolver on a screw, a linear scale, a counter.
//!
//! All three show only where in a cycle they stand. The steps from phase to phase add up to the
//! cycles travelled, an integer, and the position is a pure function of that sum:
//!
//! ```text
//! travelled += step·(phase − last)      a cycle is step·2³²
//! position   = travelled·pitch/2⁶⁴      rounded down
//! ```
//!
//! so nothing can drift, and a phase that comes back gives the position that it gave before.
//!
//! The pitch is the ratio of a distance, whole in position units, to a number of cycles (lead to pole
//! pairs). It is held to 2⁻⁶¹ of itself, with `step` the power of two that lets it: a pitch of whole
//! position units is exact, and with it every sum of cycles; any other, such as a third of 10 mm, is
//! wrong by less than a quarter of a unit (0.25 fm) in a hundred metres, whichever way and however
//! often they are travelled.

use super::phase::Phase;
use crate::units::Position;

/// Shortest cycle, m: 2³¹ of them, which is what the sum holds, are 107 m.
pub const MIN_PITCH_M: f64 = 50e-9;

/// Something that shows a phase and is asked for a position.
#[derive(Clone, Copy, Debug)]
pub struct Transducer {
    /// Position units a cycle, times 2³²/step.
    pitch: i64,
    /// 2⁶⁴/position units a cycle.
    inverse: i64,
    /// A power of two.
    step: i32,
    last: Phase,
    travelled: i64,
}

impl Transducer {
    /// A transducer that passes `cycles` cycles in `distance_m` and stands at position zero while it
    /// shows `start`. The distance is rounded to a position unit and negative where the phase falls as
    /// the axis goes forward.
    ///
    /// A resolver: the lead and its pole pairs. A linear scale: its pitch and 1, or its length and the
    /// cycles on it. A counter: 65,536 times the lead and the counts in a lead.
    ///
    /// `None` unless a cycle is [`MIN_PITCH_M`] or longer and the distance within
    /// [`crate::units::TRAVEL_LIMIT_M`].
    #[must_use]
    pub fn new(distance_m: f64, cycles: u32, start: Phase) -> Option<Self> {
        let distance = Position::from_m(distance_m)?.0;
        if cycles == 0 || distance_m.abs() / f64::from(cycles) < MIN_PITCH_M {
            return None;
        }
        let bits = 64 - (distance.unsigned_abs() / u64::from(cycles)).leading_zeros();
        // From 30 bits on the pitch fills 62; a shorter one is multiplied by 2³².
        let lift = bits.saturating_sub(30);
        let (distance, cycles) = (i128::from(distance), i128::from(cycles));
        Some(Self {
            pitch: nearest(distance << (32 - lift), cycles)?,
            inverse: nearest(cycles << 64, distance)?,
            step: 1 << lift,
            last: start,
            travelled: 0,
        })
    }

    /// The position where the transducer shows `phase`, at most half a cycle after the last call.
    pub fn read(&mut self, phase: Phase) -> Position {
        let moved = i64::from(phase.difference(self.last)) * i64::from(self.step);
        self.last = phase;
        self.travelled = self.travelled.wrapping_add(moved);
        Position(high(self.travelled, self.pitch, 0))
    }

    /// The position where the transducer shows `phase` after its signal was lost for any time: the phase
    /// tells the place in the cycle, and `near` which cycle.
    ///
    /// `near` is where another sensor sees the axis, less than half a cycle off: for a scale the motor
    /// and what was between the two. With a `near` that is further off, whole cycles are lost.
    pub fn resume(&mut self, phase: Phase, near: Position) -> Position {
        let found = self.read(phase);
        let cycles = high(near - found, self.inverse, 1 << 63);
        let missed = cycles.wrapping_mul(i64::from(self.step)) << 32;
        self.travelled = self.travelled.wrapping_add(missed);
        self.read(phase)
    }
}

/// The integer nearest to a ratio, where there is one.
fn nearest(above: i128, below: i128) -> Option<i64> {
    let half = if (above < 0) == (below < 0) { below / 2 } else { -below / 2 };
    i64::try_from((above + half).checked_div(below)?).ok()
}

/// (a·b + rounding)/2⁶⁴, towards −∞.
fn high(a: i64, b: i64, rounding: i128) -> i64 {
    ((i128::from(a) * i128::from(b) + rounding) >> 64) as i64
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const QUARTER: u32 = 1 << 30;

    /// What it shows after so many quarters of a cycle, one after the other.
    fn after(transducer: &mut Transducer, quarters: i64) -> Position {
        let mut place = Position(0);
        for _ in 0..quarters.abs() {
            let step = if quarters < 0 { QUARTER.wrapping_neg() } else { QUARTER };
            place = transducer.read(Phase(transducer.last.0.wrapping_add(step)));
        }
        place
    }

    #[test]
    fn a_resolver_of_three_pole_pairs_comes_back_to_the_lead() {
        // A third of 10 mm is not whole in position units; three of them are.
        let lead = Position::from_m(0.01).unwrap().0;
        let mut resolver = Transducer::new(0.01, 3, Phase(77)).unwrap();
        // 25,000 turns are 250 m: beyond the travel limit, and the unit is not yet lost.
        let place = after(&mut resolver, 4 * 3 * 25_000).0;
        assert!((place - 25_000 * lead).abs() <= 1, "{}", place - 25_000 * lead);
        assert_eq!(after(&mut resolver, -4 * 3 * 25_000), Position(0));
    }

    #[test]
    #[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
    fn a_scale_of_whole_units_is_exact() {
        // 2 mm: ¼ of it is whole, too.
        let pitch = Position::from_m(0.002).unwrap().0;
        let mut scale = Transducer::new(0.002, 1, Phase(0)).unwrap();
        for quarters in 1..=200_000 {
            assert_eq!(after(&mut scale, 1).0, pitch / 4 * quarters);
        }
    }

    #[test]
    fn a_scale_may_be_mounted_the_other_way() {
        let mut there = Transducer::new(0.002, 7, Phase(5)).unwrap();
        let mut back = Transducer::new(-0.002, 7, Phase(5)).unwrap();
        for k in 1..1000u32 {
            let phase = Phase(k.wrapping_mul(987_654_321));
            assert!((there.read(phase).0 + back.read(phase).0).abs() <= 1);
        }
    }

    #[test]
    fn refuses_what_it_cannot_count() {
        let refused = [
            (f64::NAN, 1),
            (f64::INFINITY, 1),
            (0.0, 1),
            (0.01, 0),
            (49e-9, 1),
            (0.01, 1_000_000),
            (101.0, 1),
        ];
        for (distance_m, cycles) in refused {
            assert!(Transducer::new(distance_m, cycles, Phase(0)).is_none(), "{distance_m} {cycles}");
        }
        assert!(
            Transducer::new(50e-9, 1, Phase(0)).is_some() && Transducer::new(-100.0, 1, Phase(0)).is_some()
        );
    }

    proptest! {
        /// However far the axis went unseen, the place is the one that it would have had.
        #[test]
        fn a_signal_that_comes_back_finds_its_cycle(
            nm in 50i64..100_000_000, backwards: bool, cycles in 1u32..1000, start: u32,
            share in -1.0f64..1.0, within: u32, off in -0.49f64..0.49,
        ) {
            let distance_m = nm as f64 * 1e-9 * f64::from(cycles) * if backwards { -1.0 } else { 1.0 };
            prop_assume!(distance_m.abs() <= 100.0);
            let pitch_m = distance_m / f64::from(cycles);
            let mut never_lost = Transducer::new(distance_m, cycles, Phase(start)).unwrap();
            let mut lost = never_lost;
            // Up to a hundred metres away.
            #[expect(clippy::cast_possible_truncation, reason = "below 2³¹ cycles")]
            let away = (share * 99.0 / pitch_m) as i64;
            let phase = Phase(start.wrapping_add(within));
            never_lost.travelled = (away * i64::from(never_lost.step)) << 32;
            let place = never_lost.read(phase);
            let near = Position::from_m(place.to_m() + off * pitch_m).unwrap();
            prop_assert_eq!(lost.resume(phase, near), place);
            prop_assert_eq!(lost.travelled, never_lost.travelled);
        }

        /// Against the same ratio in 128 bits. Both round down, with ¼ of a unit between them: at most one apart.
        #[test]
        fn any_walk_is_exact(
            nm in 50i64..100_000_000, cycles in 1u32..1000,
            steps in prop::collection::vec(any::<i32>(), 1..200), start: u32,
        ) {
            let distance_m = nm as f64 * 1e-9 * f64::from(cycles);
            prop_assume!(distance_m <= 100.0);
            let mut transducer = Transducer::new(distance_m, cycles, Phase(start)).unwrap();
            let distance = i128::from(Position::from_m(distance_m).unwrap().0);
            let (mut phase, mut sum) = (start, 0i128);
            for step in steps {
                phase = phase.wrapping_add_signed(step);
                sum += i128::from(step);
                let exact = (sum * distance).div_euclid(i128::from(cycles) << 32);
                let found = i128::from(transducer.read(Phase(phase)).0);
                prop_assert!((found - exact).abs() <= 1, "{} {}", found, exact);
            }
        }
    }
}
