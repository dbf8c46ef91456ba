//! A host that sends anything to a servo board, while ticks run and switches are operated.
//!
//! Asserted: no panic; bytes that are no packet of the session change nothing; a request that is refused changes nothing; power
//! stages come on only after an enable that the board has confirmed, or in a direction check that it has; what did not come on has
//! not moved.
#![no_main]

#[allow(dead_code, reason = "written for the tests of `shared`")]
#[path = "../../shared/tests/link/rig.rs"]
mod rig;
#[allow(dead_code, reason = "written for the tests of `shared`")]
#[path = "../../shared/tests/slide.rs"]
mod slide;

use libfuzzer_sys::fuzz_target;
use rig::{BOARD, IDENTITY, Line, Memory, SLOTS, STEPS, TICK_HZ, TIMES, TestPlant, settings};
use shared::drive::{Amplifier, AnyOutput, DriveSystem, EnableSwitch, StatusLight};
use shared::interpolate::Block;
use shared::interpolate::following::FollowSettings;
use shared::link::message::{FromBoard, Jog, LONGEST_UPLOAD, Reply, Request, UploadKind};
use shared::link::packet::{self, Frame, Header};
use shared::link::report::{DirectionReport, SettingsReport};
use shared::link::{HostedDrive, LinkCounts, Receiver, Server, SettingsMemory, Status};
use shared::machine::Machine;
use shared::scalar::Fixed;
use shared::storage::Store;
use shared::units::Position;

/// Settling time of the enable switch, ticks.
const SETTLING: u32 = 20;

struct Board<'m> {
    server: Box<Server<2>>,
    drive: HostedDrive<'m, Fixed, 2>,
    memory: SettingsMemory<Memory>,
    plant: TestPlant,
    line: Line,
    receiver: Receiver,
    header: Header,
    /// An enable, or a direction check, was confirmed since the power stages were last on.
    permitted: bool,
    was_on: bool,
    /// The axes stood still in the last tick: axes that coast go on.
    stood: bool,
}

impl Board<'_> {
    fn poll(&mut self) {
        while !self.line.to_board.is_empty() {
            self.server.poll(&mut self.line, &mut self.drive, &mut self.memory);
        }
        self.server.poll(&mut self.line, &mut self.drive, &mut self.memory);
    }

    /// Everything that a status tells, without the counters of the link.
    fn state(&self) -> Status {
        self.drive.status(LinkCounts::default(), SettingsReport::PROGRAM)
    }

    fn ticks(&mut self, count: u32) {
        for _ in 0..count {
            let before = self.plant.position_m;
            self.plant.step();
            let checking = matches!(self.state().direction, DirectionReport::Running { .. });
            self.drive.tick(&mut self.plant);
            if self.plant.enabled {
                assert!(self.permitted || self.was_on && checking, "on without an enable");
                assert!(self.plant.switch_closed, "on with an open switch");
                self.was_on = true;
            } else {
                if self.was_on {
                    (self.permitted, self.was_on) = (false, false);
                } else if self.stood {
                    assert_eq!(self.plant.position_m, before, "a motion with the drives off");
                }
            }
            self.stood = self.plant.position_m == before && !self.plant.enabled;
            self.poll();
        }
    }

    /// The replies that have arrived.
    fn replies(&mut self) -> Vec<Reply> {
        let bytes = std::mem::take(&mut self.line.to_host);
        let mut replies = Vec::new();
        for byte in bytes {
            let Some(packet) = self.receiver.push(byte) else { continue };
            let packet = packet.expect("the board sends packets");
            if let FromBoard::Reply(reply) = packet::message(packet.message).expect("and messages") {
                replies.push(reply);
            }
        }
        replies
    }

    /// Sends bytes that are no packet of the session.
    fn garbage(&mut self, bytes: &[u8]) {
        let is_packet = |part: &[u8]| packet::decode(&mut part.to_vec()).is_ok();
        if bytes.split(|byte| *byte == 0).any(is_packet) {
            return;
        }
        let before = self.state();
        // A zero before ends what was there.
        self.line.to_board.push_back(0);
        self.line.to_board.extend(bytes);
        self.line.to_board.push_back(0);
        self.poll();
        assert_eq!(self.state(), before, "garbage has changed something");
    }

    fn request(&mut self, request: &Request) {
        let before = self.state();
        self.header.sequence += 1;
        let mut frame = Frame::new();
        packet::encode(self.header, request, &mut frame).expect("requests fit");
        self.line.to_board.extend(&frame);
        self.replies();
        self.poll();
        let [reply] = &self.replies()[..] else { panic!("no reply, or several: {request:?}") };
        match (request, reply) {
            (Request::Hello { .. }, Reply::Welcome(welcome)) => {
                self.header = Header { session: welcome.session, sequence: 0 };
            }
            (Request::Enable | Request::CheckDirection { .. }, Reply::Done) => self.permitted = true,
            (_, Reply::Refused(refusal)) => {
                // A refused access to the flash may have begun.
                let changes = matches!(request, Request::Apply { .. } | Request::Save | Request::BeginSave);
                assert!(changes || self.state() == before, "{request:?}: {refusal:?} has changed something");
            }
            _ => {}
        }
    }

    /// Settings with some of their bytes replaced, or the same of nothing as a compensation.
    fn upload(&mut self, patches: &[u8]) {
        let mut buffer = [0; LONGEST_UPLOAD];
        let bytes = postcard::to_slice(&settings(), &mut buffer).expect("they fit");
        for patch in patches[1..].chunks_exact(2 + 8) {
            let at = usize::from(u16::from_le_bytes([patch[0], patch[1]])) % bytes.len();
            for (byte, new) in bytes[at..].iter_mut().zip(&patch[2..]) {
                *byte = *new;
            }
        }
        let kind = match patches[0] % 4 {
            3 => UploadKind::Compensation { axis: patches[0] / 4 % 3 },
            _ => UploadKind::Settings,
        };
        let contents = if kind == UploadKind::Settings { &*bytes } else { &patches[1..] };
        let mut offset = 0;
        for part in contents.chunks(packet::MAX_MESSAGE - 100) {
            let bytes = heapless::Vec::from_slice(part).expect("a part");
            self.request(&Request::Upload { offset, bytes });
            offset += u16::try_from(part.len()).expect("short");
        }
        let length = u16::try_from(contents.len()).expect("short");
        self.request(&Request::Apply { kind, length, checksum: packet::checksum(contents) });
    }

    /// Turns the counter at the input of x by some counts, and has an axis follow it.
    fn turn_and_follow(&mut self, first: u8, counts: usize) {
        let before = self.plant.counters[0].unwrap_or_default();
        self.plant.counters[0] = u32::try_from(counts).ok().map(|counts| before.wrapping_add(counts));
        let settings = FollowSettings {
            input: 0,
            distance_m: 5e-3,
            counts: 4000,
            speed_m_per_s: 0.05,
            acceleration_m_per_s2: 2.0,
            lag_m: 1e-5 * f64::from(first),
        };
        self.request(&Request::Follow { axis: first & 1, settings });
    }

    /// One of the actions of an input.
    fn act(&mut self, tag: u8, bytes: &[u8]) {
        let first = bytes.first().copied().unwrap_or(0);
        match tag % 17 {
            0 | 1 => self.garbage(bytes),
            2..=5 => {
                if let Ok(request) = packet::message::<Request>(bytes) {
                    self.request(&request);
                }
            }
            6 => self.ticks(1 + u32::from(first)),
            7 => self.ticks(20 * u32::from(first)),
            8 => self.plant.switch_closed = first & 1 == 1,
            9 => {
                // Operated, with the time that it needs.
                self.plant.switch_closed = false;
                self.ticks(SETTLING + 5);
                self.plant.switch_closed = true;
                self.ticks(SETTLING + 5);
            }
            10 => self.plant.stopped = first & 1 == 1,
            11 => self.plant.scale_lost = first & 1 == 1,
            12 => self.request(&Request::Enable),
            13 => self.request(&Request::Jog(Jog {
                axis: first & 1,
                distance_m: (first & 2 == 0).then(|| 1e-4 * f64::from(first)),
                velocity_m_per_s: 0.03,
                acceleration_m_per_s2: 0.5,
            })),
            14 if !bytes.is_empty() => self.upload(bytes),
            14 => self.request(&Request::BeginSave),
            15 => self.turn_and_follow(first, bytes.len()),
            _ => {
                self.request(&Request::NewMotion);
                self.request(&Request::add_block(Block::line([1e-4 * f64::from(first), 0.0], 0.03, 0.5)));
                self.request(&Request::StartMotion { blocks: 1 });
            }
        }
    }
}

// An input is a sequence of actions: a tag, a length, bytes.
fuzz_target!(|data: &[u8]| {
    let settings = IDENTITY.envelope.admit(settings()).expect("they are within it");
    let mut machine = Box::new(
        Machine::<Fixed, 2>::new(settings.rates, &settings.axes, [Position(0); 2])
            .expect("they are accepted"),
    );
    let amplifiers = [400.0; 2].map(|n| AnyOutput::Pwm(Amplifier::new(n, 8400).expect("accepted")));
    let switch = EnableSwitch::new(SETTLING);
    let system = DriveSystem::new(&mut machine, amplifiers, switch, StatusLight::new(5000));
    let mut recording = [0; 2048];
    let mut board = Board {
        server: Box::new(Server::new(IDENTITY, settings)),
        drive: HostedDrive::new(system, TICK_HZ, TIMES, &STEPS, &mut recording),
        memory: SettingsMemory::new(Store::new(Memory::erased(), SLOTS, BOARD).expect("they fit")),
        plant: TestPlant::default(),
        line: Line::default(),
        receiver: Receiver::NEW,
        header: Header { session: 0, sequence: 0 },
        permitted: false,
        was_on: false,
        stood: true,
    };
    board.server.load(&mut board.drive, &mut board.memory, None);
    board.ticks(1);
    board.request(&Request::Hello { nonce: 1 });
    let mut rest = data;
    while let [tag, length, bytes @ ..] = rest {
        let (bytes, behind) = bytes.split_at(usize::from(*length).min(bytes.len()));
        rest = behind;
        board.act(*tag, bytes);
    }
});
