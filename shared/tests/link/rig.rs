//! A server with drives on a simulated plant of two masses, and a host that speaks to it.

use crate::slide::Slide;
use std::collections::VecDeque;

use embedded_storage::nor_flash::NorFlash;
use shared::capture::ChannelSteps;
use shared::config::{AxisEnvelope, AxisSettings, Rates, Sensors};
use shared::drive::{
    Amplifier, AnyOutput, AxisInputs, Board, DriveSignal, DriveSystem, Duty, EnableSwitch, Inputs,
    StatusLight, SupplyLimits,
};
use shared::feedback::Reading;
use shared::link::message::{BoardSettings, FromBoard, Reply, Request};
use shared::link::packet::{self, Frame, Header};
use shared::link::report::AxisStatus;
use shared::link::stream::StreamPacket;
use shared::link::{
    BytePort, Envelope, HostedDrive, Identity, Receiver, Refusal, Server, SettingsMemory, Status, Times,
};
use shared::machine::Machine;
use shared::safety::{Fault, Power};
use shared::scalar::Fixed;
use shared::storage::memory::MemoryFlash;
use shared::storage::{Slots, Store};
use shared::units::{PER_NM, Position};

pub const TICK_HZ: u32 = 20_000;
/// 50 nm per count.
pub const COUNT: i64 = 50 * PER_NM;
pub const TIMES: Times = Times { hold_ms: 500, off_ms: 10_000, jog_ms: 300 };
pub const STEPS: ChannelSteps<2> =
    ChannelSteps { command: PER_NM / 16, motor: [COUNT; 2], table: [COUNT; 2], force_bits: 5 };
/// 80 KiB, as on the emulated board.
pub const CAPTURE_BYTES: usize = 80 * 1024;

/// Length of a slot, bytes: settings and a compensation of each axis.
pub const SLOT: u32 = 4096;
/// Identity of the board in its flash.
pub const BOARD: u32 = 0x4051_0002;
/// The two slots of the flash.
pub const SLOTS: Slots = Slots { starts: [0, SLOT], length: SLOT };
/// What a board tells of itself.
pub const IDENTITY: Identity<2> = Identity {
    board: "test board",
    software: "0",
    tick_hz: TICK_HZ,
    steps: STEPS,
    times: TIMES,
    homing: [None; 2],
    envelope: &ENVELOPE,
};

/// Generous ceilings, beyond what the tests upload.
pub static ENVELOPE: Envelope<2> = Envelope {
    axes: [AxisEnvelope {
        travel_m: Some([-0.15, 0.15]),
        fastest_m_per_s: 0.3,
        force_limit_n: 350.0,
        saturation_time_s: 1.5,
        following_error_limit_m: 5e-3,
        frozen_encoder_limit_m: 0.5e-3,
        scale_disagreement_limit_m: Some(1e-3),
        stop_deceleration_m_per_s2: 0.5,
        excitation_limit_n: 120.0,
        gantry_skew_limit_m: Some(1e-3),
    }; 2],
    supply: SupplyLimits { min_bus_mv: 36_000, max_bus_mv: 56_000, max_temperature_mc: 80_000 },
};

/// A flash of two slots with words of 4 bytes.
pub type Memory = MemoryFlash<8192, 1024, 4>;

const FULL_COUNTS: u16 = 8400;
const FULL_N: f64 = 400.0;

pub fn settings() -> BoardSettings<2> {
    let axis = AxisSettings {
        position_gain_per_s: 25.0,
        feedforward_percent: 100.0,
        velocity_gain_n_s_per_m: 3000.0,
        force_limit_n: 200.0,
        fastest_m_per_s: Some(0.15),
        travel_m: Some([-0.1, 0.1]),
        following_error_limit_m: 1e-3,
        sensors: Sensors::Motor {
            scale_disagreement_limit_m: Some(0.5e-3),
            frozen_encoder_limit_m: Some(0.3e-3),
        },
        ..AxisSettings::default()
    };
    BoardSettings { rates: Rates { velocity_loop_hz: 20_000.0, position_loop_divider: 5 }, axes: [axis; 2] }
}

/// Each axis.
const TABLE: Slide = Slide { mass_kg: 15.0, viscous_n_s_per_m: 0.0, coulomb_n: 20.0 };

/// Two masses with friction.
#[derive(Default)]
#[expect(clippy::struct_excessive_bools, reason = "switches and wires")]
pub struct TestPlant {
    pub position_m: [f64; 2],
    velocity: [f64; 2],
    forces_n: [f64; 2],
    pub enabled: bool,
    pub switch_closed: bool,
    pub stopped: bool,
    pub emergency_stop: bool,
    pub scale_lost: bool,
    /// Where x is stopped in the negative direction, m, and how fast it can move further there, m/s.
    pub stop: Option<(f64, f64)>,
    /// Each tick ends late.
    pub late: bool,
    /// Range in which the home switch of x is active, m.
    pub home_switch_m: Option<[f64; 2]>,
    /// Range in which the home switch of y is active, m.
    pub second_switch_m: Option<[f64; 2]>,
    /// Where a workpiece begins that the probe of x touches, m; it extends away from zero.
    pub workpiece_m: Option<f64>,
    /// Active limit switches of each axis, at the negative and the positive end.
    pub limits: [[bool; 2]; 2],
    pub contact: Contact,
    /// External counters at the inputs of the axes.
    pub counters: [Option<u32>; 2],
}

/// How the contact of the probe is.
#[derive(Default)]
pub struct Contact {
    /// Every so many samples one reads the opposite; 0: none does.
    pub spike_every: u32,
    /// The second sample of a touch reads not touched.
    pub bounces: bool,
    /// Samples, and those since the probe has touched.
    pub samples: u32,
    pub touched_samples: u32,
}

impl Contact {
    /// The sample of a probe that touches or does not.
    const fn sample(&mut self, touches: bool) -> bool {
        self.samples += 1;
        self.touched_samples = if touches { self.touched_samples + 1 } else { 0 };
        let is_spike = self.spike_every > 0 && self.samples.is_multiple_of(self.spike_every);
        touches != is_spike && !(self.bounces && self.touched_samples == 2)
    }
}

impl TestPlant {
    pub fn step(&mut self) {
        let tick_s = 1.0 / f64::from(TICK_HZ);
        for axis in 0..2 {
            let force = if self.enabled { self.forces_n[axis] } else { 0.0 };
            TABLE.step(&mut self.position_m[axis], &mut self.velocity[axis], force, tick_s);
        }
        if let Some((stop_m, gives)) = self.stop
            && self.position_m[0] < stop_m
            && self.velocity[0] < -gives
        {
            self.position_m[0] += (-gives - self.velocity[0]) * tick_s;
            self.velocity[0] = -gives;
        }
    }

    /// The force on an axis, N.
    pub fn force_n(&self, axis: usize) -> f64 {
        if self.enabled { self.forces_n[axis] } else { 0.0 }
    }

    #[expect(clippy::cast_possible_truncation, reason = "counts")]
    fn counted(m: f64) -> Position {
        Position((m / 50e-9).floor() as i64 * COUNT)
    }
}

impl Board<2, DriveSignal> for TestPlant {
    fn inputs(&mut self) -> Inputs<2> {
        let [x_m, y_m] = self.position_m;
        let is_in = |range: Option<[f64; 2]>, at_m| {
            range.is_some_and(|[from_m, to_m]| (from_m..=to_m).contains(&at_m))
        };
        let (home, y_home) = (is_in(self.home_switch_m, x_m), is_in(self.second_switch_m, y_m));
        let [mut x, mut y] = self.limits.map(|limits| AxisInputs { limits, ..AxisInputs::NONE });
        [x.counter, y.counter] = self.counters;
        let touches = self.workpiece_m.is_some_and(|at_m| at_m.signum() * (x_m - at_m) >= 0.0);
        let probe_touched = self.contact.sample(touches);
        Inputs {
            axes: [AxisInputs { home, ..x }, AxisInputs { home: y_home, ..y }],
            probe_touched,
            emergency_stop: self.emergency_stop,
            ..Inputs::NONE
        }
    }

    fn readings(&mut self) -> [Reading; 2] {
        self.position_m.map(|m| {
            let position = Self::counted(m);
            Reading { motor: position, table: (!self.scale_lost).then_some(position) }
        })
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.switch_closed
    }

    fn hardware_stop_active(&mut self) -> bool {
        self.stopped
    }

    fn set_signals(&mut self, signals: [DriveSignal; 2]) {
        self.forces_n = signals.map(|signal| {
            let DriveSignal::Pwm(Duty { reverse, counts }) = signal else { return 0.0 };
            FULL_N * f64::from(counts) / f64::from(FULL_COUNTS) * if reverse { -1.0 } else { 1.0 }
        });
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.enabled = enabled;
    }

    fn set_light(&mut self, _: bool) {}

    fn next_tick_due(&mut self) -> bool {
        self.late
    }
}

/// The line between host and board.
#[derive(Default)]
pub struct Line {
    pub to_board: VecDeque<u8>,
    pub to_host: Vec<u8>,
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

pub struct Rig<F = Memory> {
    pub memory: SettingsMemory<F>,
    pub server: Box<Server<2>>,
    pub drive: HostedDrive<'static, Fixed, 2>,
    pub plant: TestPlant,
    pub line: Line,
    receiver: Receiver,
    pub session: u32,
    pub sequence: u32,
    pub streamed: Vec<StreamPacket>,
    /// The readings of each tick, oldest first, while `log` is set.
    pub logged: Vec<[Reading; 2]>,
    pub log: bool,
}

impl Rig {
    /// With a session, the enable switch open, and nothing in the flash.
    pub fn new() -> Self {
        Self::with_flash(Memory::erased())
    }

    /// A rig with an identity and settings of its own.
    pub fn of(identity: &Identity<2>, settings: BoardSettings<2>) -> Self {
        Self::assembled(Memory::erased(), None, identity, settings)
    }

    /// With the drives on.
    pub fn enabled() -> Self {
        let mut rig = Self::new();
        rig.enable();
        rig
    }
}

impl<F: NorFlash> Rig<F> {
    /// A start of the board with a flash. With a session, the enable switch open.
    pub fn with_flash(flash: F) -> Self {
        Self::started(flash, None)
    }

    /// A rig after a run that was ended by a fault.
    pub fn started(flash: F, previous_fault: Option<Fault>) -> Self {
        Self::assembled(flash, previous_fault, &IDENTITY, settings())
    }

    fn assembled(
        flash: F,
        previous_fault: Option<Fault>,
        identity: &Identity<2>,
        settings: BoardSettings<2>,
    ) -> Self {
        let settings = identity.envelope.admit(settings).unwrap();
        let machine = Box::leak(Box::new(
            Machine::<Fixed, 2>::new(settings.rates, &settings.axes, [Position(0); 2]).unwrap(),
        ));
        let amplifiers = [FULL_N; 2].map(|n| AnyOutput::Pwm(Amplifier::new(n, FULL_COUNTS).unwrap()));
        let system = DriveSystem::new(machine, amplifiers, EnableSwitch::new(400), StatusLight::new(5000));
        let memory = vec![0; CAPTURE_BYTES].leak();
        let mut rig = Self {
            memory: SettingsMemory::new(Store::new(flash, SLOTS, BOARD).unwrap()),
            server: Box::new(Server::new(*identity, settings)),
            drive: HostedDrive::new(system, TICK_HZ, TIMES, &STEPS, memory),
            plant: TestPlant::default(),
            line: Line::default(),
            receiver: Receiver::NEW,
            session: 0,
            sequence: 0,
            streamed: Vec::new(),
            logged: Vec::new(),
            log: false,
        };
        rig.server.load(&mut rig.drive, &mut rig.memory, previous_fault);
        rig.hello(1);
        rig
    }

    pub fn enable(&mut self) {
        self.close_switch();
        assert_eq!(self.request(&Request::Enable), Reply::Done);
        self.run(10);
        assert_eq!(self.status().power, Power::On);
    }

    pub fn close_switch(&mut self) {
        self.plant.switch_closed = false;
        self.run(1000);
        self.plant.switch_closed = true;
        self.run(1000);
    }

    pub fn hello(&mut self, nonce: u32) {
        let Reply::Welcome(welcome) =
            self.send(Header { session: 0, sequence: 0 }, &Request::Hello { nonce })
        else {
            panic!("no welcome")
        };
        (self.session, self.sequence) = (welcome.session, 0);
    }

    pub fn run(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.plant.step();
            if self.log {
                let readings = self.plant.readings();
                self.logged.push(readings);
            }
            self.drive.tick(&mut self.plant);
            self.poll();
        }
    }

    pub fn poll(&mut self) {
        self.server.poll(&mut self.line, &mut self.drive, &mut self.memory);
    }

    /// Sends the next request and returns its reply.
    pub fn request(&mut self, request: &Request) -> Reply {
        self.sequence += 1;
        self.send(Header { session: self.session, sequence: self.sequence }, request)
    }

    /// Why a request is refused. It has changed nothing but what the ticks of its transmission do.
    pub fn refusal(&mut self, request: &Request) -> Refusal {
        let state = |rig: &Self| {
            let status = rig.drive.status(Default::default(), Default::default());
            let is_held = status.at_rest && status.power.is_on();
            let at_rest = is_held.then(|| status.axes.iter().map(|axis| axis.command).collect::<Vec<_>>());
            let homed: Vec<_> = status.axes.iter().map(|axis| axis.homed).collect();
            (
                status.power,
                status.not_armed,
                status.activity,
                status.feed_override.percent,
                status.capture,
                at_rest,
                homed,
            )
        };
        let before = state(self);
        let Reply::Refused(refusal) = self.request(request) else { panic!("not refused: {request:?}") };
        assert_eq!(state(self), before, "{refusal:?}");
        refusal
    }

    /// The state of both axes.
    pub fn axes(&self) -> [AxisStatus; 2] {
        self.drive.status(Default::default(), Default::default()).axes.into_array().unwrap()
    }

    pub fn status(&mut self) -> Status {
        match self.request(&Request::Status) {
            Reply::Status(status) => status,
            reply => panic!("{reply:?}"),
        }
    }

    /// Sends a request with any header.
    pub fn send(&mut self, header: Header, request: &Request) -> Reply {
        let mut frame = Frame::new();
        packet::encode(header, request, &mut frame).unwrap();
        self.send_bytes(&frame).pop().expect("a reply")
    }

    /// Sends bytes; ticks go on until the board has taken them. Returns the replies.
    pub fn send_bytes(&mut self, bytes: &[u8]) -> Vec<Reply> {
        self.line.to_board.extend(bytes);
        while !self.line.to_board.is_empty() {
            self.run(1);
        }
        self.run(1);
        self.replies()
    }

    /// Replies that have arrived; keeps the packets of the stream.
    pub fn replies(&mut self) -> Vec<Reply> {
        let bytes = std::mem::take(&mut self.line.to_host);
        let mut replies = Vec::new();
        for byte in bytes {
            let Some(packet) = self.receiver.push(byte) else { continue };
            match packet::message(packet.unwrap().message).unwrap() {
                FromBoard::Reply(reply) => replies.push(reply),
                FromBoard::Stream(samples) => self.streamed.push(samples),
            }
        }
        replies
    }
}

/// Pseudo-random numbers (xorshift64*, Vigna 2016), the same in every run.
pub struct Draws(pub u64);

impl Draws {
    pub fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    pub fn below(&mut self, end: usize) -> usize {
        usize::try_from(self.next() >> 33).unwrap() % end
    }

    #[expect(clippy::cast_possible_truncation, reason = "a byte")]
    pub fn byte(&mut self) -> u8 {
        (self.next() >> 40) as u8
    }
}
