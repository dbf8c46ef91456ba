//! A board of 1 to 4 axes on the host: the program of the emulated board without its chip.

use firmware::bench::{Bench, Constants, drive_system};
use firmware::setup::TICK_HZ;
use shared::interpolate::Block;
use shared::link::message::{FromBoard, Jog, Reply, Request};
use shared::link::packet::{self, Frame, Header};
use shared::link::{BytePort, HostedDrive, Receiver, Refusal, Server, SettingsMemory};
use shared::machine::Machine;
use shared::safety::{Fault, FaultKind, Power};
use shared::scalar::Fixed;
use shared::storage::memory::MemoryFlash;
use shared::storage::{Slots, Store};
use std::collections::VecDeque;

const SLOTS: Slots = Slots { starts: [0, 4096], length: 4096 };

/// The bytes between host and board.
#[derive(Default)]
struct Line {
    to_board: VecDeque<u8>,
    to_host: Vec<u8>,
}

impl BytePort for Line {
    fn read(&mut self) -> Option<u8> {
        self.to_board.pop_front()
    }

    fn write(&mut self, bytes: &[u8]) -> usize {
        self.to_host.extend_from_slice(bytes);
        bytes.len()
    }
}

/// A board with a session.
struct TestBoard<const N: usize> {
    drive: HostedDrive<'static, Fixed, N>,
    bench: Bench<N>,
    server: Box<Server<N>>,
    memory: SettingsMemory<MemoryFlash<8192, 4096, 4>>,
    line: Line,
    session: u32,
    sequence: u32,
}

impl<const N: usize> TestBoard<N> {
    /// A board whose drives are on, and what it is.
    fn enabled() -> (Self, usize) {
        let machine = Box::leak(Box::new(Machine::UNCONFIGURED));
        let identity = Constants::<N>::IDENTITY;
        let system = drive_system(machine).unwrap();
        let capture = vec![0; 4096].leak();
        let mut board = Self {
            drive: HostedDrive::new(system, TICK_HZ, identity.times, &identity.steps, capture),
            bench: Bench::new(),
            server: Box::new(Server::new(identity, Constants::<N>::SETTINGS)),
            memory: SettingsMemory::new(Store::new(MemoryFlash::erased(), SLOTS, 1).unwrap()),
            line: Line::default(),
            session: 0,
            sequence: 0,
        };
        board.run(1000);
        board.bench.operator_inputs().enable_switch = true;
        board.run(1000);
        let Reply::Welcome(welcome) = board.request(&Request::Hello { nonce: 1 }) else { panic!() };
        (board.session, board.sequence) = (welcome.session, 0);
        assert_eq!(board.request(&Request::Enable), Reply::Done);
        board.run(10);
        (board, welcome.steps.axes.len())
    }

    fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.bench.step();
            self.drive.tick(&mut self.bench);
            self.server.poll(&mut self.line, &mut self.drive, &mut self.memory);
        }
    }

    fn request(&mut self, request: &Request) -> Reply {
        self.sequence += 1;
        let mut frame = Frame::new();
        packet::encode(Header { session: self.session, sequence: self.sequence }, request, &mut frame)
            .unwrap();
        self.line.to_board.extend(&frame);
        let mut receiver = Receiver::NEW;
        for _ in 0..1000 {
            self.run(1);
            for byte in std::mem::take(&mut self.line.to_host) {
                if let Some(Ok(packet)) = receiver.push(byte)
                    && let Ok(FromBoard::Reply(reply)) = packet::message(packet.message)
                {
                    return reply;
                }
            }
        }
        panic!("no reply to {request:?}")
    }
}

/// What a board of `N` axes shows and takes, and what it refuses as for another number.
fn a_board_of<const N: usize>() {
    let (mut board, told) = TestBoard::<N>::enabled();
    assert_eq!(told, N);
    let count = u8::try_from(N).unwrap();
    let jog = |axis, metres| {
        Request::Jog(Jog {
            axis,
            distance_m: Some(metres),
            velocity_m_per_s: 0.1,
            acceleration_m_per_s2: 0.5,
        })
    };
    // The last axis moves, and no other.
    assert_eq!(board.request(&jog(count - 1, 1e-3)), Reply::Done);
    board.run(5000);
    let Reply::Status(status) = board.request(&Request::Status) else { panic!() };
    let commands: Vec<f64> = status.axes.iter().map(|axis| axis.command.to_m()).collect();
    assert_eq!(commands.len(), N);
    for (axis, metres) in commands.iter().enumerate() {
        let expected = if axis + 1 == N { 1e-3 } else { 0.0 };
        assert!((metres - expected).abs() < 1e-12, "{commands:?}");
    }
    assert_eq!(board.request(&jog(count, 1e-3)), Reply::Refused(Refusal::NoSuchAxis));
    assert_eq!(board.request(&Request::NewMotion), Reply::Done);
    let of_all = [
        Request::add_block(Block::line([0.0], 0.03, 0.5)),
        Request::add_block(Block::line([0.0; 2], 0.03, 0.5)),
        Request::add_block(Block::line([0.0; 3], 0.03, 0.5)),
        Request::add_block(Block::line([0.0; 4], 0.03, 0.5)),
    ];
    for (axes, request) in (1u8..).zip(&of_all) {
        let is_refused = board.request(request) == Reply::Refused(Refusal::Axes { board: count });
        assert_eq!(is_refused, axes != count, "a line of {axes} axes on a board of {count}");
    }
    a_fault_of_the_last_axis_stops_all(&mut board, &jog(count - 1, 0.3));
}

/// The last axis is moved onto its limit switch, which stops every axis: no force is left.
fn a_fault_of_the_last_axis_stops_all<const N: usize>(board: &mut TestBoard<N>, away: &Request) {
    assert_eq!(board.request(away), Reply::Done);
    for _ in 0..400 {
        board.run(200);
        // The host is there.
        let Reply::Status(status) = board.request(&Request::Status) else { panic!() };
        if let Power::Faulted(fault) = status.power {
            let axis = u8::try_from(N - 1).unwrap();
            assert_eq!(fault, Fault::Axis { axis, kind: FaultKind::LimitSwitch });
            assert!(status.axes.iter().all(|axis| axis.force_n.abs() < f32::EPSILON), "{status:?}");
            return;
        }
    }
    panic!("no fault");
}

#[test]
fn a_board_has_one_axis() {
    a_board_of::<1>();
}

#[test]
fn a_board_has_two_axes() {
    a_board_of::<2>();
}

#[test]
fn a_board_has_three_axes() {
    a_board_of::<3>();
}

#[test]
fn a_board_has_four_axes() {
    a_board_of::<4>();
}
