//! The whole board on the model: ticks, interrupts, server, and a host at the serial port or at CAN.

use std::collections::VecDeque;

use firmware::g474::flash::SettingsFlash;
use firmware::g474::{IDENTITY, Memory, Parts, Settings, StartError, settings_memory};
use firmware::setup::{AXES, CAN_FROM_BOARD, CAN_TO_BOARD, LINK_SETTINGS, SWITCH_SETTLING_TICKS};
use firmware::two_drives::Drive;
use shared::link::can_frames::{CanFrame, LengthCode};
use shared::link::packet;
use shared::link::{FromBoard, Receiver, Reply, Request, Server, SharedDrive, Welcome};
use shared::machine::Machine;
use shared::scalar::Fixed;

use super::flash_model::{FlashModel, Remains};
use super::model::{GPIOA, GPIOB, GPIOC, Model, TIM1, set_can_flags};
use crate::board_boot::host::next_packet;

/// Input data of a port.
const IDR: u32 = 0x10;

/// Bits of port B, all high: safety contacts closed, the switch open.
pub const CONTACTS: u32 = 1 << 1 | 1 << 5 | 1 << 4 | 1 << 13 | 1 << 2 | 1 << 3 | 1 << 12;
pub const SWITCH: u32 = 1 << 15;

/// Results of ADC2: bus voltage and temperature (chapter 21), 48 V and 25 °C.
const BUS: u32 = 0x5000_0188;
const TEMPERATURE: u32 = 0x5000_018c;

/// At which port the host is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    Serial,
    Can,
}

pub struct Board {
    pub model: &'static Model,
    pub parts: Parts<&'static Model>,
    pub server: Server<AXES>,
    pub memory: Settings<&'static Model>,
    pub host: Host,
}

/// The host's side of a session.
pub struct Host {
    pub port: Port,
    receiver: Receiver,
    session: u32,
    sequence: u32,
    /// Frames that wait for a place in the device.
    frames: VecDeque<CanFrame>,
    pub replies: VecDeque<Reply>,
}

/// The drives behind a lock, as RTIC's: nothing else runs that needs them while it is held.
struct Beside<'a> {
    drive: &'a mut Drive,
    model: &'static Model,
}

impl SharedDrive<'static, Fixed, AXES> for Beside<'_> {
    fn with<R>(&mut self, access: impl FnOnce(&mut Drive) -> R) -> R {
        self.model.with(|state| state.flash.ticks_are_held_off = true);
        let result = access(self.drive);
        self.model.with(|state| state.flash.ticks_are_held_off = false);
        result
    }
}

impl Host {
    /// Ends what was sent before, as a host does that repeats a request.
    pub fn end_of_packet(&mut self) {
        self.frames.extend(CanFrame::of_stream(&[0]).map(|(frame, _)| frame));
    }
}

fn leaked<T>(value: T) -> &'static mut T {
    Box::leak(Box::new(value))
}

/// Starts the board on a model.
pub fn parts_on(model: &'static Model) -> Result<Parts<&'static Model>, StartError> {
    let queue = || leaked([const { heapless::spsc::Queue::new() }; 2]);
    let memory = Memory {
        machine: leaked(Machine::<Fixed, AXES>::UNCONFIGURED),
        serial: queue(),
        can: leaked([const { heapless::spsc::Queue::new() }; 2]),
        receiver: leaked(Receiver::NEW),
        capture: Box::leak(vec![0; 5 * 1024].into_boxed_slice()),
    };
    Parts::new(model, memory)
}

/// A model with inputs of a machine that is at rest.
pub fn model(flash: Remains) -> &'static Model {
    let model = Model::new(FlashModel::new(flash, usize::MAX, 0));
    model.set(GPIOA + IDR, 1 << 3 | 1 << 10 | 1 << 15);
    model.set(GPIOB + IDR, CONTACTS);
    // 2.1547 V and 0.75 V of 3.3 V, 12 bits.
    model.set(BUS, 2674);
    model.set(TEMPERATURE, 931);
    model
}

impl Board {
    pub fn start(port: Port) -> Self {
        Self::with(model(Remains::erased()), port)
    }

    pub fn with(model: &'static Model, port: Port) -> Self {
        let parts = parts_on(model).unwrap();
        let flash: SettingsFlash<&'static Model> = parts.flash;
        let host = Host {
            port,
            receiver: Receiver::NEW,
            session: 0,
            sequence: 0,
            frames: VecDeque::new(),
            replies: VecDeque::new(),
        };
        let server = Server::new(IDENTITY, LINK_SETTINGS);
        let mut board = Self { model, parts, server, memory: settings_memory(flash), host };
        let Self { parts: Parts { drive, previous_fault, .. }, server, memory, .. } = &mut board;
        server.load(&mut Beside { drive, model }, memory, *previous_fault);
        board
    }

    /// Inputs of port B.
    pub fn set_contacts(&self, bits: u32) {
        self.model.set(GPIOB + IDR, bits);
    }

    /// A tick, each interrupt, and a round of the idle loop.
    pub fn tick(&mut self) {
        let Parts { hardware, drive, watchdog, .. } = &mut self.parts;
        self.model.begin_tick();
        hardware.begin_tick();
        watchdog.feed();
        drive.tick(hardware);
        self.exchange();
        let Parts { serial, can, ports, drive, .. } = &mut self.parts;
        serial.service();
        can.service();
        let mut drive = Beside { drive, model: self.model };
        ports.service(&mut drive);
        self.server.poll(ports, &mut drive, &mut self.memory);
        serial.service();
        can.service();
    }

    pub fn ticks(&mut self, count: u32) {
        (0..count).for_each(|_| self.tick());
    }

    /// What the line moves in a tick: all bytes that the interrupt took, and three frames each way.
    fn exchange(&mut self) {
        let Host { port, receiver, session, sequence, frames, replies } = &mut self.host;
        while let Some(frame) = frames.front() {
            let to_board = u32::from(CAN_TO_BOARD);
            if !self.model.with(|state| state.can.receive(to_board, frame)) {
                break;
            }
            frames.pop_front();
            set_can_flags(self.model, 1);
        }
        let mut bytes = self.model.with(|state| std::mem::take(&mut state.sent));
        if *port == Port::Can {
            assert!(bytes.is_empty(), "sent at the other port: {bytes:x?}");
        }
        while let Some(sent) = self.model.with(|state| state.can.transmit()) {
            set_can_flags(self.model, 1 << 7);
            // CAN FD with the faster rate.
            assert_eq!((sent.identifier, sent.header >> 20), (u32::from(CAN_FROM_BOARD), 0b11));
            let mut data = [0; 64];
            data[..sent.data.len()].copy_from_slice(&sent.data);
            let frame = CanFrame::received(LengthCode::from_low_bits((sent.header >> 16 & 15) as u8), data);
            bytes.extend(frame.stream().unwrap());
        }
        for byte in bytes {
            let Some(received) = receiver.push(byte) else { continue };
            let packet = received.unwrap();
            if let FromBoard::Reply(reply) = packet::message::<FromBoard>(packet.message).unwrap() {
                if let Reply::Welcome(Welcome { session: new, .. }) = &reply {
                    (*session, *sequence) = (*new, 0);
                }
                replies.push_back(reply);
            }
        }
    }

    /// Sends a request and runs until its reply.
    pub fn ask(&mut self, request: &Request) -> Reply {
        self.send(request);
        for _ in 0..400 {
            self.tick();
            if let Some(reply) = self.host.replies.pop_front() {
                return reply;
            }
        }
        panic!("no reply to {request:?}")
    }

    /// Sends a request. It arrives while the board runs.
    pub fn send(&mut self, request: &Request) {
        let host = &mut self.host;
        let frame = next_packet(host.session, &mut host.sequence, request);
        if host.port == Port::Serial {
            for byte in frame {
                // A byte each time the interrupt runs, as on the line.
                self.model.with(|state| state.received.push_back(byte));
                self.parts.serial.service();
            }
        } else {
            let mut rest = &frame[..];
            while let Some((frame, taken)) = CanFrame::of_stream(rest) {
                host.frames.push_back(frame);
                rest = &rest[taken..];
            }
        }
    }

    /// With a session, and the drives on.
    pub fn enabled(port: Port) -> Self {
        let mut board = Self::start(port);
        assert!(matches!(board.ask(&Request::Hello { nonce: 3 }), Reply::Welcome(_)));
        board.ticks(SWITCH_SETTLING_TICKS + 10);
        board.set_contacts(CONTACTS | SWITCH);
        board.ticks(SWITCH_SETTLING_TICKS + 10);
        assert_eq!(board.outputs(), [false, false]);
        assert_eq!(board.ask(&Request::Enable), Reply::Done);
        board.ticks(2);
        assert_eq!(board.outputs(), [true, true]);
        board
    }

    /// Whether the main output of the PWM and the enable pin are on.
    pub fn outputs(&self) -> [bool; 2] {
        [self.model.word(TIM1 + 0x44) & 1 << 15 != 0, self.model.word(GPIOB + 0x14) & 1 << 14 != 0]
    }

    /// Input data of port C.
    pub fn set_homes(&self, bits: u32) {
        self.model.set(GPIOC + IDR, bits);
    }
}
