//! A host that only listens: the board holds the path and then switches the drives off, after the times that it declares.

use std::time::{Duration, Instant};

use ::board::{Client, Port};
use shared::interpolate::feed_hold::FeedState;
use shared::link::history::{HistoryEntry, HistoryEvent};
use shared::link::message::{Jog, Reply, Request};
use shared::link::report::Activity;
use shared::safety::{Fault, Power};

use super::emulated_board::EmulatedBoard;

/// Ticks per sample of the stream, from which the host knows the time of the board without a request.
const DECIMATION: u32 = 200;

/// Longest wait, of a computer on which the emulated board is slower than real time.
const TIMEOUT: Duration = Duration::from_mins(4);

/// A jog of 150 mm at 10 mm/s, longer than the board waits.
const JOG: Jog = Jog { axis: 0, distance_m: Some(0.15), velocity_m_per_s: 0.01, acceleration_m_per_s2: 0.5 };

/// Listens until the stream has reached a tick of the board.
fn listen_until(client: &mut Client, tick: u64) {
    let started = Instant::now();
    let mut reached = 0;
    while reached < tick {
        assert!(started.elapsed() < TIMEOUT, "tick {reached} of {tick}");
        client.listen(Duration::from_millis(50)).unwrap();
        while let Some(packet) = client.streamed() {
            let last = u64::from(packet.first) + u64::from(packet.samples) - 1;
            reached = packet.start + last * u64::from(DECIMATION);
        }
    }
}

#[test]
fn a_silent_host_holds_the_path_and_then_switches_the_drives_off() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let port = Port::socket(&board.path().join("run").join("link")).unwrap();
    let mut client = Client::connect(port, Duration::from_secs(5)).unwrap();
    let times = client.welcome().times;
    let ticks_per_ms = client.welcome().rates.velocity_loop_hz / 1e3;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of ticks")]
    let ticks = |ms: u16| (f64::from(ms) * ticks_per_ms).round() as u64;
    client.enable().unwrap();
    client.command(&Request::Stream { decimation: DECIMATION }).unwrap();
    client.command(&Request::Jog(JOG)).unwrap();
    // The last request: its tick is that from which the board counts.
    let status = client.status().unwrap();
    assert_eq!((status.activity, status.feed, status.power), (Activity::Jog, FeedState::Running, Power::On));
    let silent_from = status.tick;
    listen_until(&mut client, silent_from + ticks(times.off_ms) + 1000);

    let Reply::FaultHistory(history) = client.request(&Request::FaultHistory).unwrap() else { panic!() };
    let after = |event: HistoryEvent| {
        let is = |entry: &&HistoryEntry| entry.event == event && entry.tick >= silent_from;
        history.iter().find(is).unwrap_or_else(|| panic!("{event:?}: {history:?}")).tick - silent_from
    };
    // To the tick. A tick may begin between the reception of the request and the reply.
    let (held, off) = (after(HistoryEvent::HostSilentHold), after(HistoryEvent::Fault(Fault::HostSilent)));
    assert!(held.abs_diff(ticks(times.hold_ms)) <= 2, "held after {held} ticks");
    assert!(off.abs_diff(ticks(times.off_ms)) <= 2, "off after {off} ticks");
    let status = client.status().unwrap();
    assert_eq!(status.power, Power::Faulted(Fault::HostSilent));
    // 10 mm/s for 0.5 s, and at least one and at most ten times the few ms between jog and status.
    let at_m = status.axes[0].command.to_m();
    assert!(at_m > 4.8e-3 && at_m < 15e-3, "{at_m}");
    // One host at a time.
    drop(client);
    // It does not go on by itself.
    let refused = board.fails(1, "board resume --port bench");
    assert!(refused.contains("nothing is held"), "{refused}");
    board.succeeds("board clear --port bench");
    board.succeeds("board enable --port bench");
    assert!((bench_x_mm(&board) - 1e3 * at_m).abs() < 0.1);
}

/// The command of x, mm.
fn bench_x_mm(board: &EmulatedBoard) -> f64 {
    let status = board.succeeds("board status --port bench");
    let line = status.lines().find(|line| line.starts_with("x ")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}
