//! The sequence on an axis without dynamics: it moves with constant acceleration, brakes, and passes switches and index pulses.

extern crate std;

mod legs;
mod limits;

use proptest::prelude::*;

use super::*;
use crate::homing::Direction;

const TICK_HZ: f64 = 20_000.0;

/// An axis of 200 mm, from 0 to 0.2 m, with limit switches on its last 5 mm.
struct Axis {
    /// Position, m, and speed, m/s.
    at_m: f64,
    speed: f64,
    /// End of the leg, m; `None`: brake.
    target_m: Option<f64>,
    feed: f64,
    acceleration: f64,
    /// The range in which the home switch is active, m.
    switch_m: [f64; 2],
    /// Index pulses at phase + k·spacing, m; a spacing of 0: none.
    index_phase_m: f64,
    index_spacing_m: f64,
    /// Reading of motor and scale at 0.
    offsets: [i64; 2],
    has_scale: bool,
    is_on: bool,
}

const SPACING_M: f64 = 0.005;

const SETTINGS: HomingSettings = HomingSettings {
    direction: Direction::Negative,
    mark: Mark::MotorIndex { spacing_m: SPACING_M },
    mark_position_m: -0.0125,
    search_speed_m_per_s: 0.05,
    approach_speed_m_per_s: 0.002,
    acceleration_m_per_s2: 1.0,
    search_distance_m: 0.25,
    back_off_distance_m: 0.02,
    at_limit: AtLimit::TurnRound,
    timeout_s: 60.0,
};

impl Axis {
    /// A switch from 30 to 40 mm, index pulses at 1.2 mm + k·5 mm.
    fn at(at_m: f64) -> Self {
        Self {
            at_m,
            speed: 0.0,
            target_m: None,
            feed: 0.0,
            acceleration: 1.0,
            switch_m: [0.03, 0.04],
            index_phase_m: 0.0012,
            index_spacing_m: SPACING_M,
            offsets: [123_456_789, -987_654_321],
            has_scale: true,
            is_on: true,
        }
    }

    fn units(m: f64) -> i64 {
        Position::from_m(m).unwrap().0
    }

    fn reading(&self, m: f64) -> Reading {
        let [motor, table] = self.offsets.map(|offset| Position(Self::units(m) + offset));
        Reading { motor, table: self.has_scale.then_some(table) }
    }

    /// Moves by a tick. Returns the index pulse that was passed, m.
    fn step(&mut self) -> Option<f64> {
        let from = self.at_m;
        let (target, brake) = match self.target_m {
            Some(target) => (target, self.speed * self.speed / 2.0 / self.acceleration),
            None => (self.at_m, f64::INFINITY),
        };
        let remaining = target - self.at_m;
        let wanted = if remaining.abs() > brake { self.feed * remaining.signum() } else { 0.0 };
        let change = self.acceleration / TICK_HZ;
        self.speed += (wanted - self.speed).clamp(-change, change);
        self.at_m += self.speed / TICK_HZ;
        if self.speed == 0.0 {
            self.target_m = None;
        }
        let cell = |m: f64| ((m - self.index_phase_m) / self.index_spacing_m).floor();
        let [low, high] = [from.min(self.at_m), from.max(self.at_m)];
        let passed = self.index_spacing_m > 0.0 && cell(low) < cell(high);
        passed.then(|| cell(high) * self.index_spacing_m + self.index_phase_m)
    }

    fn input(&self, index_m: Option<f64>) -> HomingInput {
        let [from, to] = self.switch_m;
        let index = index_m.map(|m| self.reading(m));
        HomingInput {
            home: (from..=to).contains(&self.at_m),
            limits: [self.at_m < 0.005, self.at_m > 0.195],
            home_reading: self.reading(self.at_m),
            reading: self.reading(self.at_m),
            command: Position(0),
            at_force_limit: None,
            motor_index: index.map(|reading| reading.motor),
            scale_index: index.and_then(|reading| reading.table),
            at_rest: self.target_m.is_none() && self.speed == 0.0,
            is_on: self.is_on,
        }
    }

    /// Runs a homing, with a chance to interfere in each tick. Returns the shift of the origin.
    fn home(
        &mut self,
        settings: &HomingSettings,
        mut each_tick: impl FnMut(u32, &mut Self, &mut Homing),
    ) -> Result<OriginShift, HomingError> {
        let mut homing = Homing::new(settings, TICK_HZ, true)?;
        let mut shift = None;
        for tick in 0.. {
            let index = self.step();
            match homing.tick(&self.input(index)) {
                Some(HomingAction::Halt) => self.target_m = None,
                Some(HomingAction::SetOrigin(origin)) => {
                    assert_eq!(self.speed.to_bits(), 0.0f64.to_bits(), "the origin is set at rest");
                    shift = Some(origin);
                }
                Some(action) => panic!("{action:?}"),
                None => {}
            }
            assert!((0.0..=0.2).contains(&self.at_m), "over the end of the travel: {}", self.at_m);
            each_tick(tick, self, &mut homing);
            if let Some(leg) = homing.leg_to_plan() {
                assert!(self.speed.abs() == 0.0, "a leg starts at rest");
                self.target_m = Some(self.at_m + leg.distance_m);
                (self.feed, self.acceleration) = (leg.speed_m_per_s, leg.acceleration_m_per_s2);
                homing.leg_planned(Ok(()));
            }
            match homing.status() {
                HomingStatus::Running => {}
                HomingStatus::Homed => return Ok(shift.expect("set before")),
                HomingStatus::Failed(error) => {
                    assert_eq!(shift, None, "a failed homing sets no origin");
                    return Err(error);
                }
            }
        }
        unreachable!()
    }

    /// The position of the mark that a shift declares, m: where both sensors, shifted, read the position of the mark.
    fn marks_m(&self, settings: &HomingSettings, shift: OriginShift) -> [f64; 2] {
        let mark = Self::units(settings.mark_position_m);
        let [motor, table] = self.offsets;
        [mark - shift.motor - motor, mark - shift.table - table].map(|units| Position(units).to_m())
    }
}

fn undisturbed(_: u32, _: &mut Axis, _: &mut Homing) {}

/// The first index in the direction of approach after the edge of the switch.
fn expected_index_m(axis: &Axis, direction: Direction) -> f64 {
    let [from, to] = axis.switch_m;
    let cell = |m: f64| (m - axis.index_phase_m) / axis.index_spacing_m;
    let number = match direction {
        Direction::Negative => cell(to).floor(),
        Direction::Positive => cell(from).ceil(),
    };
    axis.index_phase_m + number * axis.index_spacing_m
}

proptest! {
    #![proptest_config(ProptestConfig { cases: if cfg!(miri) { 1 } else { 60 }, ..ProptestConfig::default() })]

    /// From every place of the travel, in both directions, wherever switch and index are: the same mark is found, for motor and
    /// scale. The latched index is exact, so that only the rounding of this test to position units remains, 1 fm.
    #[test]
    fn the_index_is_found_from_everywhere(
        start in 0.001..0.199f64, switch in 0.03..0.16f64, width in 0.001..0.01f64, index in 0.1..0.9f64, positive: bool,
    ) {
        let direction = if positive { Direction::Positive } else { Direction::Negative };
        let mut axis = Axis::at(start);
        axis.switch_m = [switch, switch + width];
        // A part of the spacing behind the edge, outside of the ambiguous sixteenth.
        axis.index_phase_m = match direction {
            Direction::Negative => switch + width - index * SPACING_M,
            Direction::Positive => switch + index * SPACING_M,
        };
        let settings = HomingSettings { direction, ..SETTINGS };
        let expected = expected_index_m(&axis, direction);
        let shift = axis.home(&settings, undisturbed).unwrap();
        for mark_m in axis.marks_m(&settings, shift) {
            prop_assert!((mark_m - expected).abs() < 3e-15, "{} instead of {}", mark_m, expected);
        }
    }

    /// Without an index the mark is the edge, found in a tick of the approach: 2 mm/s × 50 µs.
    #[test]
    fn the_edge_is_found_within_a_tick_of_the_approach(start in 0.001..0.199f64, positive: bool) {
        let direction = if positive { Direction::Positive } else { Direction::Negative };
        let settings = HomingSettings { direction, mark: Mark::SwitchEdge, ..SETTINGS };
        let mut axis = Axis::at(start);
        let edge_m = axis.switch_m[usize::from(!positive)];
        let shift = axis.home(&settings, undisturbed).unwrap();
        for mark_m in axis.marks_m(&settings, shift) {
            let beyond = (mark_m - edge_m) * direction.sign();
            prop_assert!((-1e-12..=0.002 / TICK_HZ + 1e-12).contains(&beyond), "{beyond}");
        }
    }
}

#[test]
fn the_index_of_the_scale_is_a_mark_too() {
    let settings = HomingSettings { mark: Mark::ScaleIndex { within_m: 0.02 }, ..SETTINGS };
    let mut axis = Axis::at(0.1);
    // Even at the very edge of the switch: a single pulse is not ambiguous.
    (axis.index_phase_m, axis.index_spacing_m) = (0.04 - 50e-6, 1.0);
    let shift = axis.home(&settings, undisturbed).unwrap();
    for mark_m in axis.marks_m(&settings, shift) {
        assert!((mark_m - 0.03995).abs() < 3e-15);
    }
}

#[test]
fn each_failure_is_named() {
    let fails = |axis: &mut Axis, settings: &HomingSettings| axis.home(settings, undisturbed).unwrap_err();
    // The switch is beyond the search distance; a limit comes first; the limit is no place to turn round.
    let near = HomingSettings { search_distance_m: 0.02, ..SETTINGS };
    assert_eq!(fails(&mut Axis::at(0.1), &near), HomingError::SwitchNotFound);
    let mut without_switch = Axis { switch_m: [1.0, 2.0], ..Axis::at(0.1) };
    assert_eq!(fails(&mut without_switch, &SETTINGS), HomingError::LimitSwitch);
    let no_turn = HomingSettings { at_limit: AtLimit::Fail, ..SETTINGS };
    assert_eq!(fails(&mut Axis::at(0.02), &no_turn), HomingError::LimitSwitch);
    assert_eq!(fails(&mut Axis::at(0.002), &no_turn), HomingError::LimitSwitch);
    // A switch that is wider than the distance to back off.
    let mut wide = Axis { switch_m: [0.01, 0.18], ..Axis::at(0.1) };
    assert_eq!(fails(&mut wide, &SETTINGS), HomingError::SwitchStuck);
    let mut without_index = Axis { index_spacing_m: 0.0, ..Axis::at(0.1) };
    assert_eq!(fails(&mut without_index, &SETTINGS), HomingError::IndexNotFound);
    let mut without_scale = Axis { has_scale: false, ..Axis::at(0.1) };
    assert_eq!(fails(&mut without_scale, &SETTINGS), HomingError::ScaleMissing);
    let short = HomingSettings { timeout_s: 0.5, ..SETTINGS };
    assert_eq!(fails(&mut Axis::at(0.1), &short), HomingError::Timeout);
}

/// Within a sixteenth of the spacing on either side of the edge the next homing could find the neighbouring pulse.
#[test]
fn an_index_close_to_the_edge_is_refused() {
    for (part, refused) in
        [(0.03, true), (0.06, true), (0.065, false), (0.93, false), (0.94, true), (0.99, true)]
    {
        let mut axis = Axis::at(0.1);
        axis.index_phase_m = 0.04 - part * SPACING_M;
        let homed = axis.home(&SETTINGS, undisturbed);
        assert_eq!(homed.err(), refused.then_some(HomingError::IndexTooCloseToSwitch), "{part}");
    }
}

/// In every tick of a homing a stop, or drives that go off, end it with the axis at rest within its braking distance.
#[test]
fn a_stop_ends_the_homing_in_any_tick() {
    let mut ticks = 0;
    Axis::at(0.02).home(&SETTINGS, |tick, _, _| ticks = tick).unwrap();
    for at in (0..ticks).step_by(if cfg!(miri) { 30_000 } else { 997 }) {
        let stopped = Axis::at(0.02).home(&SETTINGS, |tick, _, homing| {
            if tick == at {
                homing.stop();
            }
        });
        assert_eq!(stopped, Err(HomingError::Stopped), "{at}");
        let off = Axis::at(0.02).home(&SETTINGS, |tick, axis, _| axis.is_on = tick < at);
        assert_eq!(off, Err(HomingError::DrivesOff), "{at}");
    }
}

#[test]
fn a_rejected_motion_ends_the_homing() {
    let mut homing = Homing::new(&SETTINGS, TICK_HZ, false).unwrap();
    homing.leg_planned(Err(PathError::QueueFull));
    assert_eq!(homing.status(), HomingStatus::Failed(HomingError::Path(PathError::QueueFull)));
    assert_eq!(homing.tick(&Axis::at(0.1).input(None)), None);
}

#[test]
fn settings_out_of_range_are_named() {
    let error = |change: fn(&mut HomingSettings)| {
        let mut settings = SETTINGS;
        change(&mut settings);
        Homing::new(&settings, TICK_HZ, false).err()
    };
    let named = |name| Some(HomingError::Setting(name));
    assert_eq!(error(|_| {}), None);
    assert_eq!(error(|s| s.search_speed_m_per_s = 0.0), named("search_speed_m_per_s"));
    assert_eq!(error(|s| s.approach_speed_m_per_s = f64::NAN), named("approach_speed_m_per_s"));
    assert_eq!(error(|s| s.acceleration_m_per_s2 = -1.0), named("acceleration_m_per_s2"));
    assert_eq!(error(|s| s.timeout_s = f64::INFINITY), named("timeout_s"));
    assert_eq!(error(|s| s.search_distance_m = 101.0), named("search_distance_m"));
    assert_eq!(error(|s| s.mark_position_m = f64::NAN), named("mark_position_m"));
    assert_eq!(error(|s| s.mark = Mark::MotorIndex { spacing_m: 0.0 }), named("spacing_m"));
    assert_eq!(error(|s| s.mark = Mark::ScaleIndex { within_m: -1.0 }), named("within_m"));
    // 50 mm/s with 1 m/s² brake in 1.25 mm.
    assert_eq!(error(|s| s.back_off_distance_m = 1.2e-3), named("back_off_distance_m"));
    assert_eq!(error(|s| s.back_off_distance_m = 1.3e-3), None);
}
