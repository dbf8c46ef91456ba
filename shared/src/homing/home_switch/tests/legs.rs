//! The legs of a homing: where each goes, by what it starts on and by what it meets.

use super::*;

const DIRECTIONS: [Direction; 2] = [Direction::Negative, Direction::Positive];

/// An axis at rest; the limit switch ahead is active or not.
fn input(direction: Direction, home: bool, ahead: bool) -> HomingInput {
    HomingInput {
        limits: [ahead && direction == Direction::Negative, ahead && direction == Direction::Positive],
        home,
        at_rest: true,
        ..Axis::at(0.1).input(None)
    }
}

/// Distance and speed of the leg that is to be planned.
fn planned(homing: &mut Homing) -> Option<(f64, f64)> {
    let leg = homing.leg_to_plan()?;
    homing.leg_planned(Ok(()));
    Some((leg.distance_m, leg.speed_m_per_s))
}

fn homing(direction: Direction, mark: Mark) -> Homing {
    // All lengths differ, and none is 1 or 2 in any unit of the equations.
    let settings = HomingSettings { direction, mark, back_off_distance_m: 0.03, ..SETTINGS };
    Homing::new(&settings, TICK_HZ, true).unwrap()
}

/// Free: a search in the direction of homing. On the switch: off it, against that direction. On the limit switch ahead: a search
/// against that direction.
#[test]
fn the_first_leg_depends_on_the_switches_at_the_start() {
    for direction in DIRECTIONS {
        let first = |home, ahead| {
            let mut homing = homing(direction, SETTINGS.mark);
            assert_eq!(homing.tick(&input(direction, home, ahead)), None);
            planned(&mut homing).unwrap()
        };
        let (forwards, speed) = (direction.sign(), SETTINGS.search_speed_m_per_s);
        assert_eq!(first(false, false), (forwards * SETTINGS.search_distance_m, speed));
        assert_eq!(first(true, false), (-forwards * 0.03, speed));
        assert_eq!(first(false, true), (-forwards * SETTINGS.search_distance_m, speed));
    }
}

/// A search that meets the switch stops there. Backing off ends within its distance beside the switch and brakes within that
/// distance once more, so that the edge is at most twice as far away; the mark is an index distance further.
#[test]
fn a_search_stops_at_the_switch_and_the_approach_reaches_the_mark() {
    let marks = [(Mark::SwitchEdge, 0.0), (Mark::MotorIndex { spacing_m: 0.005 }, 0.005)];
    for direction in DIRECTIONS {
        for (mark, index_m) in marks {
            let mut homing = homing(direction, mark);
            assert_eq!(homing.tick(&input(direction, false, false)), None);
            planned(&mut homing).unwrap();
            let on_switch = HomingInput { at_rest: false, ..input(direction, true, false) };
            assert_eq!(homing.tick(&on_switch), Some(HomingAction::Halt));
            assert_eq!(planned(&mut homing), None, "before the axis stands");
            assert_eq!(homing.tick(&input(direction, true, false)), None);
            let forwards = direction.sign();
            assert_eq!(planned(&mut homing), Some((-forwards * 0.03, SETTINGS.search_speed_m_per_s)));
            // On the switch, then off it, then at rest beside it.
            assert_eq!(homing.tick(&on_switch), None);
            let beside = input(direction, false, false);
            assert_eq!(homing.tick(&HomingInput { at_rest: false, ..beside }), Some(HomingAction::Halt));
            assert_eq!(homing.tick(&beside), None);
            let (distance_m, speed) = planned(&mut homing).unwrap();
            assert!((distance_m - forwards * (2.0 * 0.03 + index_m)).abs() < 1e-15, "{distance_m} m");
            assert_eq!(speed.to_bits(), SETTINGS.approach_speed_m_per_s.to_bits());
        }
    }
}

/// Planning takes longer than a tick. What is planned is the leg that the first tick has decided on, at the switch or beside it, and no tick
/// until the leg is planned changes it: the motion of one leg with the reactions of another would not end at its switch.
#[test]
fn a_leg_does_not_change_while_it_is_planned() {
    for (home, distance_m) in [(true, SETTINGS.back_off_distance_m), (false, -SETTINGS.search_distance_m)] {
        let mut homing = Homing::new(&SETTINGS, TICK_HZ, false).unwrap();
        assert_eq!(homing.leg_to_plan(), None);
        for at_switch in [home, !home, home] {
            assert_eq!(homing.tick(&input(Direction::Negative, at_switch, false)), None);
            assert_eq!(homing.leg_to_plan().map(|leg| leg.distance_m), Some(distance_m));
        }
    }
}
