extern crate std;

use proptest::prelude::*;

use super::*;

const TICK_S: f64 = 5e-5;
const SETTINGS: ProbeSettings =
    ProbeSettings { distance_m: 0.05, speed_m_per_s: 2e-3, acceleration_m_per_s2: 0.5, retracts: false };

fn position(m: f64) -> Position {
    Position::from_m(m).unwrap()
}

/// Drives on, an axis whose sensors are exact.
fn input(m: f64, touched: bool) -> ProbeInput {
    let motor = position(m);
    let touch = Touch { command: motor, motor, table: Some(motor) };
    ProbeInput { touched, touch, command: motor, at_rest: false, is_on: true }
}

/// A probing whose approach has begun.
fn approaching(settings: &ProbeSettings) -> Probing {
    let mut probing = Probing::new(settings).unwrap();
    assert_eq!(probing.leg_to_plan().map(|leg| leg.distance_m), Some(settings.distance_m));
    probing.leg_planned(Ok(()));
    for _ in 0..3 {
        assert!(!probing.tick(&input(0.0, false)) && probing.leg_to_plan().is_none());
    }
    probing
}

proptest! {
    /// An axis at a constant speed v reaches a surface at s between two ticks. The latched reading x is the first at or beyond s, so that
    /// 0 ≤ ±(x − s) < v·tick; positions are rounded to units of 2⁻⁴⁰ m or so, for which 1 pm is left on either side.
    #[test]
    fn the_latched_position_is_within_the_way_of_a_tick_behind_the_edge(
        speed in 1e-6..0.5f64, ticks in 2.0..500.0f64, from in -0.5..0.5f64, positive in any::<bool>(),
    ) {
        let sign = if positive { 1.0 } else { -1.0 };
        let way = speed * TICK_S;
        let surface = from + sign * ticks * way;
        let distance_m = sign * 1000.0 * way;
        let mut probing = approaching(&ProbeSettings { distance_m, speed_m_per_s: speed, ..SETTINGS });
        let mut halts = 0;
        for tick in 1..=1000 {
            let m = from + sign * f64::from(tick) * way;
            halts += u32::from(probing.tick(&input(m, sign * (m - surface) >= 0.0)));
        }
        prop_assert_eq!(halts, 1);
        let halts_again = probing.tick(&ProbeInput { at_rest: true, ..input(0.0, true) });
        prop_assert!(!halts_again);
        let ProbeStatus::Touched(touch) = probing.status() else { panic!("{:?}", probing.status()) };
        for latched in [touch.command, touch.motor, touch.table.unwrap()] {
            let behind = sign * (latched.to_m() - surface);
            prop_assert!((-1e-12..way + 1e-12).contains(&behind), "{} m of {} m", behind, way);
        }
    }
}

/// The way back is that from the command at rest to the latched one, in both directions; the probe may be touched meanwhile.
#[test]
fn it_moves_back_to_the_latched_command_if_it_should() {
    for (touched_m, rest_m, retracts) in [(0.01, 0.0125, true), (-0.01, -0.0125, true), (0.01, 0.0125, false)]
    {
        let mut probing = approaching(&ProbeSettings { retracts, ..SETTINGS });
        assert!(probing.tick(&input(touched_m, true)));
        assert!(!probing.tick(&input(rest_m, true)) && probing.status() == ProbeStatus::Running);
        assert!(!probing.tick(&ProbeInput { at_rest: true, ..input(rest_m, true) }));
        if retracts {
            let leg = probing.leg_to_plan().unwrap();
            assert!((leg.distance_m - (touched_m - rest_m)).abs() < 1e-12, "{leg:?}");
            assert_eq!(leg.speed_m_per_s.to_bits(), SETTINGS.speed_m_per_s.to_bits());
            probing.leg_planned(Ok(()));
            assert!(!probing.tick(&input(touched_m, true)) && probing.status() == ProbeStatus::Running);
            assert!(!probing.tick(&ProbeInput { at_rest: true, ..input(touched_m, true) }));
        }
        let ProbeStatus::Touched(touch) = probing.status() else { panic!("{:?}", probing.status()) };
        assert_eq!((touch.command, touch.motor), (position(touched_m), position(touched_m)));
        assert_eq!(probing.leg_to_plan(), None);
    }
}

#[test]
fn what_ends_it_has_a_name() {
    let failed = |probing: &Probing| match probing.status() {
        ProbeStatus::Failed(error) => error,
        other => panic!("{other:?}"),
    };
    // In the first three ticks of the motion, in which nothing can have been touched; not in the fourth.
    for free in 0..4 {
        let mut probing = Probing::new(&SETTINGS).unwrap();
        probing.leg_planned(Ok(()));
        for _ in 0..free {
            assert!(!probing.tick(&input(0.0, false)));
        }
        assert!(probing.tick(&input(0.0, true)));
        if free < 3 {
            assert_eq!(failed(&probing), ProbeError::Active, "{free} ticks");
        } else {
            assert_eq!(probing.status(), ProbeStatus::Running);
        }
    }
    let mut probing = approaching(&SETTINGS);
    assert!(probing.tick(&ProbeInput { at_rest: true, ..input(0.05, false) }));
    assert_eq!(failed(&probing), ProbeError::NotTouched);
    let mut probing = Probing::new(&SETTINGS).unwrap();
    probing.leg_planned(Err(PathError::QueueFull));
    assert_eq!(failed(&probing), ProbeError::Path(PathError::QueueFull));
    // Before, at and behind the touch.
    for touched in [None, Some(false), Some(true)] {
        for (ends, error) in [(false, ProbeError::DrivesOff), (true, ProbeError::Stopped)] {
            let mut probing = approaching(&SETTINGS);
            if let Some(touched) = touched {
                assert_eq!(probing.tick(&input(0.01, touched)), touched);
            }
            if ends {
                probing.stop();
            } else {
                assert!(probing.tick(&ProbeInput { is_on: false, ..input(0.01, true) }));
            }
            assert_eq!(failed(&probing), error);
            // It stays so, and asks for nothing.
            assert!(!probing.tick(&input(0.02, true)) && probing.leg_to_plan().is_none());
            probing.leg_planned(Ok(()));
            probing.stop();
            assert_eq!(failed(&probing), error);
        }
    }
}

/// Between the request of a motion and its plan, a tick sees neither a touch nor the end of the motion.
#[test]
fn a_motion_that_is_not_planned_yet_ends_nothing() {
    let mut probing = Probing::new(&SETTINGS).unwrap();
    assert!(!probing.tick(&ProbeInput { at_rest: true, ..input(0.0, true) }));
    assert_eq!(probing.status(), ProbeStatus::Running);
}

#[test]
fn settings_outside_their_ranges_are_refused() {
    for wrong in [0.0, f64::NAN, f64::INFINITY] {
        for settings in [
            ProbeSettings { distance_m: wrong, ..SETTINGS },
            ProbeSettings { distance_m: -wrong, ..SETTINGS },
            ProbeSettings { speed_m_per_s: wrong, ..SETTINGS },
            ProbeSettings { acceleration_m_per_s2: wrong, ..SETTINGS },
        ] {
            assert_eq!(Probing::new(&settings).map(|_| ()), Err(ProbeError::Setting), "{settings:?}");
        }
    }
    for settings in [
        ProbeSettings { speed_m_per_s: -2e-3, ..SETTINGS },
        ProbeSettings { acceleration_m_per_s2: -0.5, ..SETTINGS },
    ] {
        assert_eq!(settings.check(), Err(ProbeError::Setting));
    }
    assert_eq!(ProbeSettings { distance_m: -0.05, ..SETTINGS }.check(), Ok(()));
}
