//! A homing by a host to a hard stop.

use shared::homing::HardStopSettings;
use shared::link::Refusal;
use shared::link::message::{Reply, Request};
use shared::link::refusal::SettingProblem;
use shared::link::report::{HomingFailure, HomingReport};
use shared::safety::Power;

use super::rig::{IDENTITY, Rig, settings};

/// Friction of 20 N leaves 40 N of the force limit at the stop.
const STOP: HardStopSettings = HardStopSettings {
    force_n: -60.0,
    speed_m_per_s: 3e-3,
    acceleration_m_per_s2: 0.5,
    standstill_s: 0.03,
    search_distance_m: 0.012,
    back_off_distance_m: 1e-3,
    stop_position_m: -0.05,
};

/// The stop of x, m.
const AT_M: f64 = -0.01;

fn request(settings: HardStopSettings) -> Request {
    Request::HomeToStop { axis: 0, settings }
}

/// Runs a homing to its end with a force within the limit; returns its state and the greatest force of x, N.
fn home(rig: &mut Rig, settings: HardStopSettings) -> (HomingReport, f64) {
    let limit_n = rig.drive.machine().force_limit_n(0).unwrap();
    assert_eq!(rig.request(&request(settings)), Reply::Done);
    let mut greatest_n = 0.0f64;
    for _ in 0..40 * 20_000 {
        rig.run(1);
        // The host is there.
        rig.drive.heard();
        let homing = rig.drive.status(Default::default(), Default::default()).homing;
        if homing != HomingReport::Running {
            assert_eq!(
                rig.drive.machine().force_limit_n(0),
                Some(limit_n),
                "the force limit of the settings"
            );
            rig.run(4000);
            return (homing, greatest_n);
        }
        assert_eq!(rig.drive.machine().force_limit_n(0), Some(settings.force_n.abs()));
        greatest_n = greatest_n.max(rig.plant.force_n(0).abs());
    }
    panic!("the homing does not end")
}

/// The stop is rigid, so that its position is that of the reading to a count of 50 nm and the travel in a tick, 0.15 µm. The axis then stands
/// off by the declared distance, once the integral has overcome the friction against the overshoot: 40 N at 150,000 N/m/s times 25/s times
/// the overshoot of 10 µm take 1.1 s, after which a count of 50 nm and the tick of the stop are left.
#[test]
fn the_stop_is_the_reference_and_the_axis_backs_off() {
    let mut rig = Rig::enabled();
    rig.plant.stop = Some((AT_M, 0.0));
    let (homing, greatest_n) = home(&mut rig, STOP);
    assert_eq!(homing, HomingReport::Homed);
    // The limit is reached, and rounded to a PWM count of 0.05 N.
    assert!((59.9..=60.05).contains(&greatest_n), "{greatest_n} N");
    let status = rig.status();
    assert!(status.axes[0].homed && status.power == Power::On);
    let true_m = rig.plant.position_m[0] - AT_M + STOP.stop_position_m;
    let read_m = status.axes[0].motor.to_m();
    assert!((read_m - true_m).abs() < 0.25e-6, "{read_m} m, {true_m} m");
    for _ in 0..100 {
        rig.run(400);
        rig.drive.heard();
    }
    let off_m = rig.plant.position_m[0] - AT_M;
    assert!((off_m - STOP.back_off_distance_m).abs() < 1.5e-6, "{off_m} m");
}

/// A second homing, which starts beside the stop, and one that starts at it, find the same position.
#[test]
fn a_homing_from_the_stop_finds_it_again() {
    for start_m in [AT_M + 1e-3, AT_M] {
        let mut rig = Rig::new();
        rig.plant.stop = Some((AT_M, 0.0));
        rig.plant.position_m[0] = start_m;
        rig.enable();
        assert_eq!(home(&mut rig, STOP).0, HomingReport::Homed);
        let true_m = rig.plant.position_m[0] - AT_M + STOP.stop_position_m;
        let read_m = rig.status().axes[0].motor.to_m();
        assert!((read_m - true_m).abs() < 0.25e-6, "{read_m} m, {true_m} m");
    }
}

/// Without a stop the axis ends at the search distance; if what it pushes gives way, more slowly than the command, it is no stop. With a
/// force limit below the friction of 20 N it does not even move away.
#[test]
fn what_is_no_stop_is_named() {
    for (stop, force_n, failure) in [
        (None, -60.0, HomingFailure::StopNotFound),
        (Some((AT_M, 1e-3)), -60.0, HomingFailure::StopYields),
        (Some((AT_M, 0.0)), -15.0, HomingFailure::HeldFast),
    ] {
        let mut rig = Rig::enabled();
        rig.plant.stop = stop;
        let (homing, _) = home(&mut rig, HardStopSettings { force_n, ..STOP });
        assert_eq!(homing, HomingReport::Failed(failure));
        let status = rig.status();
        assert!(!status.axes[0].homed && status.at_rest && status.power == Power::On, "{status:?}");
    }
}

/// More force than the axis has, a longer standstill than its force may be at the limit, or a command that moves on at the stop by what a monitor
/// would take for a fault: refused before anything moves.
#[test]
fn what_a_monitor_would_end_is_refused_by_name() {
    let mut rig = Rig::enabled();
    let axis = settings().axes[0];
    let refused = |rig: &mut Rig, settings| match rig.refusal(&request(settings)) {
        Refusal::Setting { axis: 0, name, problem: SettingProblem::AboveCeiling { ceiling, .. } } => {
            (name, ceiling)
        }
        other => panic!("{other:?}"),
    };
    let over = HardStopSettings { force_n: 200.5, ..STOP };
    assert_eq!(refused(&mut rig, over), ("force_limit_n".chars().collect(), axis.force_limit_n));
    let over = HardStopSettings { standstill_s: axis.saturation_time_s + 1e-3, speed_m_per_s: 1e-5, ..STOP };
    assert_eq!(refused(&mut rig, over), ("saturation_time_s".chars().collect(), axis.saturation_time_s));
    // Half of 0.3 mm in 30 ms.
    let over = HardStopSettings { speed_m_per_s: 5.1e-3, ..STOP };
    assert_eq!(refused(&mut rig, over).0, "frozen_encoder_limit_m".chars().collect::<heapless::String<48>>());
    let invalid = HardStopSettings { back_off_distance_m: 0.0, ..STOP };
    assert_eq!(rig.refusal(&request(invalid)), Refusal::Homing(HomingFailure::Setting));
    assert_eq!(rig.refusal(&Request::HomeToStop { axis: 2, settings: STOP }), Refusal::NoSuchAxis);
    assert_eq!(rig.status().homing, HomingReport::None);
}

/// A stop, and the drives going off, end it; the force limit is that of the settings again.
#[test]
fn what_ends_it_restores_the_force() {
    for halt in [Request::Stop, Request::Disable] {
        let mut rig = Rig::enabled();
        rig.plant.stop = Some((AT_M, 0.0));
        assert_eq!(rig.request(&request(STOP)), Reply::Done);
        rig.run(20_000);
        assert_eq!(rig.drive.machine().force_limit_n(0), Some(60.0));
        assert_eq!(rig.request(&halt), Reply::Done);
        rig.run(400);
        assert!(matches!(rig.status().homing, HomingReport::Failed(_)));
        assert_eq!(rig.drive.machine().force_limit_n(0), Some(200.0));
    }
}

/// With a limited force an axis would fall that has a brake, or a preload of its weight. A known preload of zero is that of a horizontal axis.
#[test]
fn an_axis_that_carries_a_weight_is_refused() {
    use shared::config::{AxisSettings, Brake};
    let brake = Some(Brake { release_s: 0.0, engage_s: 0.0 });
    let horizontal = AxisSettings { preload_n: Some(0.0), ..settings().axes[0] };
    let weighted = |preload_n: f64| AxisSettings { preload_n: Some(preload_n), ..horizontal };
    for (axis, is_refused) in [
        (horizontal, false),
        (weighted(30.0), true),
        (weighted(-30.0), true),
        (AxisSettings { brake, ..horizontal }, true),
    ] {
        let mut settings = settings();
        settings.axes[0] = axis;
        let mut rig = Rig::of(&IDENTITY, settings);
        rig.enable();
        rig.run(2000);
        rig.drive.heard();
        if is_refused {
            assert_eq!(rig.refusal(&request(STOP)), Refusal::Homing(HomingFailure::Weight));
            assert_ne!(
                rig.drive.status(Default::default(), Default::default()).homing,
                HomingReport::Running
            );
        } else {
            assert_eq!(rig.request(&request(STOP)), Reply::Done);
        }
    }
}
