//! A host that is silent, and the enable switch.

use shared::drive::NotArmed;
use shared::interpolate::feed_hold::FeedState;
use shared::link::Refusal;
use shared::link::history::HistoryEvent;
use shared::link::message::{Reply, Request};
use shared::safety::{Fault, Power};

use super::rig::{Rig, TICK_HZ, TIMES};
use super::{jog_at, jog_by};

fn ticks(ms: u16) -> u32 {
    u32::from(ms) * TICK_HZ / 1000
}

/// The path stands 0.5 s after the last request, within the time that 30 mm/s take at 2 m/s²; the drives go off at 10 s.
#[test]
fn a_silent_host_holds_the_path_and_then_switches_the_drives_off() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&jog_by(0.09)), Reply::Done);
    rig.run(ticks(TIMES.hold_ms) - 100);
    assert_eq!(rig.drive.machine().feed_state(), FeedState::Running);
    rig.run(100 + ticks(30));
    assert_eq!((rig.drive.machine().feed_state(), rig.drive.machine().power()), (FeedState::Held, Power::On));
    let held = rig.drive.machine().command();
    rig.run(ticks(TIMES.off_ms) - ticks(TIMES.hold_ms) - ticks(30) - 10);
    assert_eq!((rig.drive.machine().command(), rig.drive.machine().power()), (held, Power::On));
    rig.run(20);
    assert_eq!(rig.drive.machine().power(), Power::Faulted(Fault::HostSilent));
    assert!(!rig.plant.enabled);
    // The host is back: it has to acknowledge and to enable, and the path is gone.
    let Reply::FaultHistory(history) = rig.request(&Request::FaultHistory) else { panic!("no history") };
    let events: Vec<_> = history.iter().map(|entry| entry.event).collect();
    assert_eq!(events, [HistoryEvent::Fault(Fault::HostSilent), HistoryEvent::HostSilentHold]);
    assert_eq!(rig.refusal(&Request::Enable), Refusal::Faulted(Fault::HostSilent));
    assert_eq!(rig.refusal(&Request::Resume), Refusal::NotHeld);
    assert_eq!(rig.request(&Request::Clear), Reply::Done);
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
    rig.run(1000);
    assert_eq!(rig.status().power, Power::On);
    assert!(rig.status().at_rest);
}

/// Axes that stand have no path to hold: the silence changes nothing before the drives go off. That is no fault: nothing was
/// interrupted, and the next enable switches them on.
#[test]
fn a_silent_host_holds_nothing_while_the_axes_stand() {
    let mut rig = Rig::enabled();
    rig.run(ticks(TIMES.hold_ms) + ticks(30));
    assert_eq!(
        (rig.drive.machine().feed_state(), rig.drive.machine().power()),
        (FeedState::Running, Power::On)
    );
    let Reply::FaultHistory(history) = rig.request(&Request::FaultHistory) else { panic!("no history") };
    assert!(history.is_empty(), "{history:?}");
    rig.run(ticks(TIMES.off_ms) - 10);
    assert!(rig.plant.enabled);
    rig.run(20);
    assert!(!rig.plant.enabled);
    assert_eq!(rig.status().power, Power::Off);
    let Reply::FaultHistory(history) = rig.request(&Request::FaultHistory) else { panic!("no history") };
    let events: Vec<_> = history.iter().map(|entry| entry.event).collect();
    assert_eq!(events, [HistoryEvent::HostSilentOff]);
    rig.run(1000);
    assert!(!rig.plant.enabled);
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
    rig.run(10);
    assert!(rig.plant.enabled);
}

/// A session that was opened is a host that is there, for the time after which a path is held.
#[test]
fn a_hello_is_heard_for_the_time_of_a_hold() {
    let mut rig = Rig::new();
    rig.run(ticks(TIMES.hold_ms) + 1);
    assert!(rig.drive.host_is_silent());
    rig.hello(2);
    assert!(!rig.drive.host_is_silent());
    // Two ticks and more were run for the hello.
    rig.run(ticks(TIMES.hold_ms) - 10);
    assert!(!rig.drive.host_is_silent());
    rig.run(10);
    assert!(rig.drive.host_is_silent());
}

/// A host that only asks for the status is not silent.
#[test]
fn a_host_that_asks_for_the_status_is_not_silent() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&jog_by(0.09)), Reply::Done);
    for _ in 0..8 {
        rig.run(ticks(TIMES.hold_ms) - 10);
        assert_eq!(rig.status().power, Power::On);
    }
    // 90 mm at 30 mm/s take 3.06 s.
    assert!(rig.status().at_rest && (rig.plant.position_m[0] - 0.09).abs() < 50e-6);
}

/// Garbage and requests of another session do not keep the drives on.
#[test]
fn only_requests_of_the_session_end_the_silence() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&jog_by(0.09)), Reply::Done);
    let session = rig.session;
    rig.session ^= 1;
    for _ in 0..10 {
        rig.run(ticks(100));
        assert_eq!(rig.refusal(&Request::Status), Refusal::Session);
        assert_eq!(rig.send_bytes(&[1, 2, 3, 0]), []);
    }
    rig.session = session;
    assert_eq!(rig.drive.machine().feed_state(), FeedState::Held);
}

/// A jog at a speed that is not renewed for 0.3 s ends by itself, within the time that its speed needs.
#[test]
fn a_jog_at_a_speed_ends_without_a_renewal() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&jog_at(-0.03)), Reply::Done);
    for _ in 0..10 {
        rig.run(ticks(TIMES.jog_ms) - 10);
        assert_eq!(rig.request(&jog_at(-0.03)), Reply::Done);
    }
    assert!(rig.plant.position_m[0] < -0.03 * 10.0 * 0.29 + 0.002, "{:?}", rig.plant.position_m);
    rig.run(ticks(TIMES.jog_ms) + ticks(30));
    assert!(rig.status().at_rest);
    let stopped = rig.drive.machine().command();
    rig.run(2000);
    assert_eq!(rig.drive.machine().command(), stopped);
    assert_eq!(rig.status().power, Power::On);
}

#[test]
fn the_switch_has_to_permit_an_enable_and_switches_off_at_once() {
    let mut rig = Rig::new();
    assert_eq!(rig.refusal(&Request::Enable), Refusal::NotArmed(NotArmed::Switch));
    // Closed since the start, without an edge.
    rig.close_switch();
    assert!(rig.status().not_armed.is_none() && !rig.plant.enabled);
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
    rig.run(1);
    assert!(rig.plant.enabled);
    rig.plant.switch_closed = false;
    rig.run(1);
    assert!(!rig.plant.enabled);
    assert_eq!(rig.refusal(&Request::Enable), Refusal::NotArmed(NotArmed::Switch));
}

/// A pressed emergency stop is named also while the drives are off, and its release is no closed switch.
#[test]
fn a_pressed_emergency_stop_is_named_instead_of_the_switch() {
    let mut rig = Rig::new();
    rig.close_switch();
    rig.plant.emergency_stop = true;
    rig.run(1);
    assert_eq!((rig.status().power, rig.status().not_armed), (Power::Off, Some(NotArmed::EmergencyStop)));
    assert_eq!(rig.refusal(&Request::Enable), Refusal::NotArmed(NotArmed::EmergencyStop));
    rig.plant.emergency_stop = false;
    rig.run(1);
    assert_eq!((rig.status().power, rig.status().not_armed), (Power::Off, Some(NotArmed::Switch)));
    assert_eq!(rig.refusal(&Request::Enable), Refusal::NotArmed(NotArmed::Switch));
}

/// After a stop by hardware the host cannot enable until the switch has been operated.
#[test]
fn a_stop_by_hardware_needs_the_switch() {
    let mut rig = Rig::enabled();
    rig.plant.stopped = true;
    rig.run(1);
    assert!(!rig.plant.enabled);
    rig.plant.stopped = false;
    assert_eq!(rig.refusal(&Request::Enable), Refusal::Faulted(Fault::HardwareStop));
    assert_eq!(rig.request(&Request::Clear), Reply::Done);
    assert_eq!(rig.refusal(&Request::Enable), Refusal::NotArmed(NotArmed::Switch));
    rig.close_switch();
    assert_eq!(rig.request(&Request::Enable), Reply::Done);
}
