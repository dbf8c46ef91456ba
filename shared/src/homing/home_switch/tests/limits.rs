//! Limits that are met exactly: the distance to the index pulse, and that of backing off.

use super::*;

/// Position of the edge of the switch, units.
const EDGE: Position = Position(777_777);

/// The state of an approach that has passed the edge and waits for the pulse, and what it does in a tick at a distance from the
/// edge, with a pulse at a distance from it.
fn at_distance(
    mark: Mark,
    distance: u64,
    index: Option<u64>,
) -> (Homing, Result<Option<HomingAction>, HomingError>) {
    let mut homing = Homing::new(&HomingSettings { mark, ..SETTINGS }, TICK_HZ, true).unwrap();
    homing.progress.phase = Phase::Moving(Leg::ToIndex { edge: EDGE });
    // Towards the negative end.
    let beyond = |distance: u64| Position(EDGE.0 - distance.cast_signed());
    let [at, index] = [Some(distance), index].map(|distance| distance.map(beyond));
    let action = homing.tick(&HomingInput {
        home: true,
        limits: [false; 2],
        home_reading: Reading { motor: EDGE, table: Some(EDGE) },
        reading: Reading { motor: at.unwrap(), table: at },
        command: Position(0),
        at_force_limit: None,
        motor_index: index,
        scale_index: index,
        at_rest: false,
        is_on: true,
    });
    match homing.status() {
        HomingStatus::Failed(error) => (homing, Err(error)),
        _ => (homing, Ok(action)),
    }
}

const MARKS: [Mark; 2] =
    [Mark::MotorIndex { spacing_m: SPACING_M }, Mark::ScaleIndex { within_m: SPACING_M }];

/// The pulse is missing once the axis has gone further than one spacing, not before and not at it.
#[test]
fn a_pulse_is_missing_after_one_spacing_and_no_unit_before() {
    for mark in MARKS {
        let (homing, ended) = at_distance(mark, 0, None);
        assert_eq!(ended, Ok(None));
        let spacing = homing.index_distance;
        assert_eq!(at_distance(mark, spacing, None).1, Ok(None));
        assert_eq!(at_distance(mark, spacing + 1, None).1, Err(HomingError::IndexNotFound));
    }
}

/// A pulse of the motor a sixteenth of the spacing from the edge, on either side, is the last that is accepted; the single pulse
/// of a scale has no neighbour to be confused with.
#[test]
fn the_last_accepted_pulse_is_a_sixteenth_of_the_spacing_from_the_edge() {
    let [motor, scale] = MARKS;
    let spacing = at_distance(motor, 0, None).0.index_distance;
    let margin = spacing / 16;
    for (distance, accepted) in
        [(margin - 1, false), (margin, true), (spacing - margin, true), (spacing - margin + 1, false)]
    {
        let ended = at_distance(motor, distance, Some(distance)).1;
        let expected =
            if accepted { Ok(Some(HomingAction::Halt)) } else { Err(HomingError::IndexTooCloseToSwitch) };
        assert_eq!(ended, expected, "{distance} of {spacing} units");
        let ended = at_distance(scale, distance, Some(distance)).1;
        assert_eq!(ended, Ok(Some(HomingAction::Halt)), "{distance} of {spacing} units");
    }
}

/// Braking from the search speed takes v²/2a, exact in these binary fractions: backing off by that much is accepted, by less is not.
#[test]
fn the_distance_of_backing_off_is_at_least_the_braking_distance() {
    for (speed, acceleration, braking_m) in
        [(0.0625, 1.0, 0.001_953_125), (0.0625, 0.25, 0.007_812_5), (0.125, 4.0, 0.001_953_125)]
    {
        let refused = |back_off_distance_m| {
            let settings = HomingSettings {
                search_speed_m_per_s: speed,
                acceleration_m_per_s2: acceleration,
                back_off_distance_m,
                ..SETTINGS
            };
            Homing::new(&settings, TICK_HZ, false).err()
        };
        assert_eq!(refused(braking_m), None, "{speed} m/s, {acceleration} m/s²");
        let error = Some(HomingError::Setting("back_off_distance_m"));
        assert_eq!(refused(braking_m * (1.0 - 1e-9)), error, "{speed} m/s, {acceleration} m/s²");
    }
}

/// The message of a setting has its name, that of a motion the reason of the path; each of the others says something of its own.
#[test]
fn the_messages_of_the_errors_name_what_is_wrong() {
    use std::string::ToString;
    let message = HomingError::Setting("timeout_s").to_string();
    assert!(message.contains("timeout_s"), "{message}");
    let message = HomingError::Path(PathError::QueueFull).to_string();
    assert!(message.contains(&PathError::QueueFull.to_string()), "{message}");
    let words = [
        (HomingError::NotReady, "drives that are on"),
        (HomingError::SwitchNotFound, "no home switch"),
        (HomingError::SwitchStuck, "did not open"),
        (HomingError::IndexNotFound, "no index"),
        (HomingError::IndexTooCloseToSwitch, "too close"),
        (HomingError::LimitSwitch, "limit switch"),
        (HomingError::ScaleMissing, "scale"),
        (HomingError::Timeout, "time limit"),
        (HomingError::Stopped, "was stopped"),
        (HomingError::DrivesOff, "drives went off"),
    ];
    for (error, words) in words {
        assert!(error.to_string().contains(words), "{error}");
    }
}
