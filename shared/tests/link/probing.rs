//! Probing by a host.

use proptest::prelude::*;

use shared::link::Refusal;
use shared::link::message::{Reply, Request};
use shared::link::refusal::SettingProblem;
use shared::link::report::{Activity, AxisStatus};
use shared::probing::{ProbeError, ProbeSettings, ProbeStatus, Touch};
use shared::safety::Power;
use shared::units::PER_NM;

use super::rig::{COUNT, Rig, TICK_HZ, settings};

const PROBE: ProbeSettings =
    ProbeSettings { distance_m: 0.02, speed_m_per_s: 5e-3, acceleration_m_per_s2: 0.5, retracts: true };

/// The surface, m.
const AT_M: f64 = 6e-3;

fn request(settings: ProbeSettings) -> Request {
    Request::Probe { axis: 0, settings }
}

fn status(rig: &Rig) -> Option<ProbeStatus> {
    rig.drive.status(Default::default(), Default::default()).probe
}

/// Runs a probing to its end and to rest, and returns its state. `rig.logged` has the readings of each tick up to the end.
fn probe(rig: &mut Rig, settings: ProbeSettings) -> ProbeStatus {
    assert_eq!(rig.request(&request(settings)), Reply::Done);
    (rig.log, rig.logged) = (true, Vec::new());
    for _ in 0..30 * TICK_HZ {
        rig.run(1);
        // The host is there.
        rig.drive.heard();
        match status(rig) {
            Some(ProbeStatus::Running) => {}
            other => {
                rig.log = false;
                rig.run(4000);
                rig.drive.heard();
                return other.expect("a probing has run");
            }
        }
    }
    panic!("the probing does not end")
}

fn touched(status: ProbeStatus) -> Touch {
    match status {
        ProbeStatus::Touched(touch) => touch,
        other => panic!("{other:?}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// The readings are those of the first tick at or beyond the surface, so that they are at most the way of a tick beyond it, speed/tick rate,
    /// and at most a count of the sensor, to which they are rounded down, before or behind it. A twentieth is left for the ripple of the
    /// speed: the axis has moved by at least 3 mm, 30 time constants of the position loop at the greatest speed.
    #[test]
    fn the_latched_readings_are_those_of_the_edge(
        at_m in 3e-3..18e-3f64, speed_m_per_s in 1e-3..0.02f64, positive in any::<bool>(),
    ) {
        let sign = if positive { 1.0 } else { -1.0 };
        let mut rig = Rig::enabled();
        rig.plant.workpiece_m = Some(sign * at_m);
        let settings = ProbeSettings { distance_m: sign * 0.02, speed_m_per_s, ..PROBE };
        let touch = touched(probe(&mut rig, settings));
        prop_assert_eq!(touch.table, Some(touch.motor));
        let behind_m = sign * touch.motor.to_m() - at_m;
        let (way_m, count_m) = (speed_m_per_s / f64::from(TICK_HZ), COUNT as f64 / PER_NM as f64 * 1e-9);
        prop_assert!(behind_m >= -count_m, "{behind_m} m before the surface");
        prop_assert!(behind_m <= 1.05 * way_m + count_m, "{behind_m} m behind it, of {way_m} m");
        // The reading is one of the run, and the one of the tick before was before the surface, to within a count.
        let tick = rig.logged.iter().position(|readings| readings[0].motor == touch.motor).unwrap();
        let before_m = sign * rig.logged[tick - 1][0].motor.to_m() - at_m;
        prop_assert!(before_m < count_m, "{before_m} m");
    }
}

/// A sample of the probe that differs from its neighbours, every 13 ms, stops nothing: the latched reading is that of the surface, within the way
/// of a tick and a count.
#[test]
fn a_spike_is_no_touch() {
    let mut rig = Rig::enabled();
    rig.plant.workpiece_m = Some(AT_M);
    rig.plant.contact.spike_every = 257;
    let touch = touched(probe(&mut rig, PROBE));
    let behind_m = touch.motor.to_m() - AT_M;
    let (way_m, count_m) = (PROBE.speed_m_per_s / f64::from(TICK_HZ), COUNT as f64 / PER_NM as f64 * 1e-9);
    assert!((-count_m..=1.05 * way_m + count_m).contains(&behind_m), "{behind_m} m");
}

/// The axis is stopped a tick after the first sample of a touch, or two if the contact bounces between: beyond the latched command it goes by v²/(2a),
/// by what the command moves in this time, and by half of a position tick either way. The readings and the command are those of the first sample
/// in both cases.
#[test]
fn the_first_sample_of_a_touch_is_latched_also_with_a_bounce() {
    let v = PROBE.speed_m_per_s;
    let way_m = v * v / (2.0 * settings().axes[0].stop_deceleration_m_per_s2);
    let position_tick_m = v / settings().rates.position_loop_hz();
    for (bounces, ticks) in [(false, 1.0), (true, 2.0)] {
        let mut rig = Rig::enabled();
        rig.plant.workpiece_m = Some(AT_M);
        rig.plant.contact.bounces = bounces;
        assert_eq!(rig.request(&request(ProbeSettings { retracts: false, ..PROBE })), Reply::Done);
        let now = |rig: &Rig| rig.drive.status(Default::default(), Default::default()).axes[0];
        let (mut before, mut first) = (now(&rig).command, None);
        for _ in 0..2 * TICK_HZ {
            rig.run(1);
            rig.drive.heard();
            let AxisStatus { command, motor, table, .. } = now(&rig);
            if first.is_none() && rig.plant.contact.touched_samples == 1 {
                // A tick starts with the command of the tick before.
                first = Some(Touch { command: before, motor, table });
            }
            before = command;
        }
        let latched = touched(status(&rig).unwrap());
        assert_eq!(Some(latched), first, "bounces: {bounces}");
        let beyond_m = now(&rig).command.to_m() - latched.command.to_m() - way_m;
        let least_m = -0.5 * position_tick_m - 1e-12;
        let most_m = ticks * v / f64::from(TICK_HZ) + position_tick_m + 1e-12;
        assert!((least_m..most_m).contains(&beyond_m), "{beyond_m} m beyond, {least_m} to {most_m}");
    }
}

/// The axis ends at the command of the touch, beyond which it has gone by v²/(2a), to within half of what the command moves in a position tick, in
/// which its speed is constant; without a retraction it stays there.
#[test]
fn it_retracts_to_the_latched_command_or_stays() {
    let v = PROBE.speed_m_per_s;
    let way_m = v * v / (2.0 * settings().axes[0].stop_deceleration_m_per_s2);
    let half_m = 0.5 * v * (1.0 / settings().rates.position_loop_hz());
    for (retracts, range_m) in [(true, 0.0..=1e-12), (false, way_m - half_m - 1e-12..=way_m + half_m + 1e-12)]
    {
        let mut rig = Rig::enabled();
        rig.plant.workpiece_m = Some(AT_M);
        let touch = touched(probe(&mut rig, ProbeSettings { retracts, ..PROBE }));
        let status = rig.status();
        assert_eq!((status.activity, status.at_rest, status.power), (Activity::Idle, true, Power::On));
        let beyond_m = status.axes[0].command.to_m() - touch.command.to_m();
        assert!(range_m.contains(&beyond_m), "{beyond_m} m of {range_m:?}");
    }
}

/// Each by its name, and nothing moves on.
#[test]
fn what_is_no_touch_is_named() {
    // Touched before: refused, and no tick moves the axis.
    let mut rig = Rig::enabled();
    rig.plant.workpiece_m = Some(0.0);
    rig.run(1);
    assert_eq!(rig.refusal(&request(PROBE)), Refusal::Probe(ProbeError::Active));
    assert_eq!((rig.status().probe, rig.status().activity), (None, Activity::Idle));
    // Not touched: the axis stands at the end of the distance.
    let mut rig = Rig::enabled();
    assert_eq!(probe(&mut rig, PROBE), ProbeStatus::Failed(ProbeError::NotTouched));
    let at_m = rig.status().axes[0].command.to_m();
    assert!((at_m - PROBE.distance_m).abs() < 1e-9 && rig.status().at_rest, "{at_m} m");
    // Ended from outside, 2.5 mm before the surface.
    for (halt, error) in [(Request::Stop, ProbeError::Stopped), (Request::Disable, ProbeError::DrivesOff)] {
        let mut rig = Rig::enabled();
        rig.plant.workpiece_m = Some(AT_M);
        assert_eq!(rig.request(&request(PROBE)), Reply::Done);
        for _ in 0..14_000 {
            rig.run(1);
            rig.drive.heard();
        }
        assert_eq!(rig.request(&halt), Reply::Done);
        rig.run(2000);
        let status = rig.status();
        assert_eq!(status.probe, Some(ProbeStatus::Failed(error)));
        assert!(status.at_rest || status.power == Power::Off, "{status:?}");
        let at_m = rig.plant.position_m[0];
        assert!((3.4e-3..3.7e-3).contains(&at_m), "{at_m} m");
    }
}

/// The result of a probing that has ended is not changed by a stop.
#[test]
fn a_stop_behind_the_end_changes_no_result() {
    let mut rig = Rig::enabled();
    rig.plant.workpiece_m = Some(AT_M);
    let ended = probe(&mut rig, PROBE);
    touched(ended);
    assert_eq!(rig.request(&Request::Stop), Reply::Done);
    rig.run(2000);
    assert_eq!(rig.status().probe, Some(ended));
}

/// Without the drives on it moves nothing; a motion beyond what the axis may do is refused by the name of its limit.
#[test]
fn what_the_axis_may_not_do_is_refused() {
    let mut rig = Rig::new();
    rig.close_switch();
    assert_eq!(rig.refusal(&request(PROBE)), Refusal::DrivesOff);
    let mut rig = Rig::enabled();
    let axis = settings().axes[0];
    let limit = 0.9 * axis.fastest_m_per_s.unwrap();
    let fast = ProbeSettings { speed_m_per_s: 1.001 * limit, ..PROBE };
    assert_eq!(rig.refusal(&request(fast)), Refusal::TooFast { block: 0, axis: 0, limit_m_per_s: limit });
    for distance_m in [0.2001, -0.2001] {
        let refusal = rig.refusal(&request(ProbeSettings { distance_m, ..PROBE }));
        let Refusal::Setting { axis: 0, name, problem } = refusal else { panic!("{refusal:?}") };
        assert_eq!(
            (name.as_str(), problem),
            ("travel_m", SettingProblem::AboveCeiling { value: 0.2001, ceiling: 0.2 })
        );
    }
    let invalid = ProbeSettings { acceleration_m_per_s2: 0.0, ..PROBE };
    assert_eq!(rig.refusal(&request(invalid)), Refusal::Probe(ProbeError::Setting));
    assert_eq!(rig.refusal(&Request::Probe { axis: 2, settings: PROBE }), Refusal::NoSuchAxis);
    assert_eq!(rig.status().probe, None);
    // The travel ends before the distance: the path rejects the motion.
    let far = ProbeSettings { distance_m: 0.15, ..PROBE };
    assert!(matches!(probe(&mut rig, far), ProbeStatus::Failed(ProbeError::Path(_))));
    assert_eq!(rig.status().axes[0].command.to_m().to_bits(), 0.0f64.to_bits());
    // Another motion waits for the end of a probing.
    assert_eq!(rig.request(&request(PROBE)), Reply::Done);
    rig.run(100);
    assert_eq!(rig.refusal(&request(PROBE)), Refusal::Moving);
    assert_eq!(rig.status().activity, Activity::Probing);
}

/// A silent host holds the path of a probing; nothing is touched meanwhile, and the drives go off by a fault.
#[test]
fn a_silent_host_ends_it() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&request(PROBE)), Reply::Done);
    rig.run(11 * TICK_HZ);
    let status = rig.status();
    assert!(matches!(status.power, Power::Faulted(_)), "{status:?}");
    assert_eq!(status.probe, Some(ProbeStatus::Failed(ProbeError::DrivesOff)));
    // 5 mm/s for 0.5 s, and the deceleration.
    assert!((2e-3..2.6e-3).contains(&rig.plant.position_m[0]), "{} m", rig.plant.position_m[0]);
}
