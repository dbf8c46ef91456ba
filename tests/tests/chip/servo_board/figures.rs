//! The figures for people on the emulated board: the chip computes the bits that this computer does.

use std::thread::sleep;
use std::time::{Duration, Instant};

use firmware::bench::{SUPPLY_LIMITS, THERMISTOR, THERMISTOR_COUNTS, signals};
use firmware::setup::TICK_HZ;
use shared::figures::Thermistor;
use shared::link::message::{Reply, Request};
use shared::link::report::{Activity, Status};
use shared::units::PER_NM;

use super::emulated_board::EmulatedBoard;
use super::raw_link::{RawLink, frame};

/// Longest wait for a second of the board's time, which a busy computer runs more slowly.
const LONGEST_WAIT: Duration = Duration::from_mins(2);

/// A host that asks for the status, one request after the other.
struct Asking {
    link: RawLink,
    sequence: u32,
}

impl Asking {
    fn reply(&mut self, request: &Request) -> Reply {
        self.sequence += 1;
        let frame = frame(self.link.header(self.sequence), request);
        self.link.exchange(&[frame], 1).pop().expect("a reply")
    }

    fn status(&mut self) -> Status {
        let Reply::Status(status) = self.reply(&Request::Status) else { panic!("no status") };
        status
    }
}

/// In every state of a jog over 0.1 mm, which is five periods of the signals: amplitude, level, phase and health of the signals at the reading
/// in the status, and the temperature of the counts. The rms of a second in which x stands is between the least and the greatest error that the host sees
/// meanwhile; a half and a count of 50 nm are left for what is between two requests.
#[test]
fn the_figures_of_the_chip_are_those_of_the_host_to_the_last_bit() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let mut host = Asking { link: RawLink::open(&board), sequence: 0 };
    let thermistor = Thermistor::new(&THERMISTOR, SUPPLY_LIMITS.max_temperature_mc).unwrap();
    let temperature = thermistor.temperature_mc(THERMISTOR_COUNTS);
    assert!(temperature.is_some_and(|mc| (mc - 31_000).abs() < 50), "{temperature:?}");
    assert_eq!(host.status().axes[0].rms, None);
    assert_eq!(host.reply(&Request::Enable), Reply::Done);
    let jog = shared::link::message::Jog {
        axis: 0,
        velocity_m_per_s: 4e-4,
        acceleration_m_per_s2: 0.1,
        distance_m: Some(1e-4),
    };
    assert_eq!(host.reply(&Request::Jog(jog)), Reply::Done);
    let (mut phases, started) = (Vec::new(), Instant::now());
    loop {
        let status = host.status();
        let [x, y] = status.axes.clone().into_array().unwrap();
        assert_eq!(x.signals, Some(signals(x.motor).figures()), "{x:?}");
        assert_eq!((y.signals, status.supply.temperature_mc), (None, temperature));
        phases.push(x.signals.unwrap().phase_deg);
        if status.activity == Activity::Idle && phases.len() > 1 {
            break;
        }
        assert!(started.elapsed() < LONGEST_WAIT, "{status:?}");
    }
    phases.dedup();
    assert!(phases.len() > 30, "{} phases", phases.len());
    assert!(phases.iter().any(|deg| *deg < -90.0) && phases.iter().any(|deg| *deg > 90.0), "{phases:?}");
    // Standing until a window is complete that began after the jog.
    let (from, mut errors_nm) = (host.status().tick, Vec::new());
    let figures = loop {
        let status = host.status();
        let [x, _] = status.axes.clone().into_array().unwrap();
        errors_nm.push(((x.command - x.motor) as f64 / PER_NM as f64).abs());
        if status.tick > from + 2 * u64::from(TICK_HZ) {
            break x.rms.expect("a complete second");
        }
        assert!(started.elapsed() < LONGEST_WAIT, "{status:?}");
        sleep(Duration::from_millis(50));
    };
    let least_nm = errors_nm.iter().copied().fold(f64::INFINITY, f64::min) / 1.5 - 50.0;
    let most_nm = errors_nm.iter().copied().fold(0.0, f64::max) * 1.5 + 50.0;
    assert!((least_nm..most_nm).contains(&f64::from(figures.error_nm)), "{figures:?}, {errors_nm:?} nm");
    // The friction of the table, 20 N, holds whatever force is less.
    assert!((0.1..25.0).contains(&figures.force_n), "{figures:?}");
}

/// What a person reads.
#[test]
fn status_and_monitor_show_them() {
    let Some(board) = EmulatedBoard::armed() else { return };
    let status = board.succeeds("board status --port bench");
    assert!(status.contains("power stages: 31 °C"), "{status}");
    // 20·log₁₀(1430/1500) = −0.41 dB; (1430 − 1050)/450 = 84 %. Rounded to whole counts: at most 0.7 of 1430.
    assert!(
        status.contains("x: signals: 1430 counts, -0.41 dB from the middle of their limits; phase "),
        "{status}"
    );
    assert!(status.contains(" of a period, health 84 %"), "{status}");
    assert!(!status.contains("rms"), "{status}");
    board.succeeds("board enable --port bench");
    let status = board.status_with(&["x: rms of a second: error ", "y: rms of a second: error "]);
    assert!(status.contains(" N; signals: 1430 counts"), "{status}");
    let line = board.succeeds("board monitor --port bench --lines 1");
    assert_eq!(line.matches("(rms of a second: ").count(), 2, "{line}");
}
