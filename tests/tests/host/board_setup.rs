//! The settings of the board are accepted. With them a simulated machine of two masses holds, moves and stops.

use crate::slide::Slide;
use firmware::f405::CORE_HZ;
use firmware::setup::{
    AXES, BoardDrives, ENVELOPE, METRES_PER_COUNT, SETTINGS, TABLE, TICK_HZ, drive_system, tick_clock,
};
use shared::axis::Reading;
use shared::drive::{Board, DriveSignal, Duty};
use shared::feedback::encoder::Encoder;
use shared::interpolate::{Block, PathError};
use shared::machine::Machine;
use shared::safety::{Fault, FaultKind, Power};

/// PWM counts on the board: 168 MHz / 20 kHz.
const FULL_COUNTS: u16 = 8400;

/// Each axis.
const SLIDE: Slide = Slide { mass_kg: 15.0, viscous_n_s_per_m: 0.0, coulomb_n: 20.0 };

/// A simulated board: drives, masses and encoder counters.
struct TestMachine {
    position_m: [f64; AXES],
    /// Position at the encoders: the same, unless an encoder is frozen.
    encoder_m: [f64; AXES],
    velocity: [f64; AXES],
    counters: [Encoder; AXES],
    duties: [Duty; AXES],
    enabled: bool,
    closed: bool,
    lit: bool,
}

impl TestMachine {
    /// Value of a counter of 16 bits, which wraps.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "wraps on purpose")]
    fn count(&self, axis: usize) -> u16 {
        ((self.encoder_m[axis] / METRES_PER_COUNT[axis]).floor() as i64 & 0xffff) as u16
    }

    fn step(&mut self) {
        for axis in 0..AXES {
            let Duty { reverse, counts } = self.duties[axis];
            let force = 400.0 * f64::from(counts) / f64::from(FULL_COUNTS) * if reverse { -1.0 } else { 1.0 };
            let tick_s = 1.0 / f64::from(TICK_HZ);
            SLIDE.step(&mut self.position_m[axis], &mut self.velocity[axis], force, tick_s);
        }
        self.encoder_m = self.position_m;
    }
}

impl Board<AXES, DriveSignal> for TestMachine {
    fn readings(&mut self) -> [Reading; AXES] {
        core::array::from_fn(|axis| Reading {
            motor: self.counters[axis].read(self.count(axis)),
            table: None,
        })
    }

    fn enable_switch_closed(&mut self) -> bool {
        self.closed
    }

    fn hardware_stop_active(&mut self) -> bool {
        false
    }

    fn set_signals(&mut self, signals: [DriveSignal; AXES]) {
        self.duties = signals.map(|signal| match signal {
            DriveSignal::Pwm(duty) => duty,
            DriveSignal::Analog(_) | DriveSignal::Steps { .. } => panic!("the table has drives with PWM"),
        });
    }

    fn set_enabled(&mut self, enabled: bool) {
        self.enabled = enabled;
    }

    fn set_light(&mut self, lit: bool) {
        self.lit = lit;
    }

    fn next_tick_due(&mut self) -> bool {
        false
    }
}

impl TestMachine {
    /// At zero, with the enable switch closed since before the start.
    fn new() -> Self {
        Self {
            position_m: [0.0; AXES],
            encoder_m: [0.0; AXES],
            velocity: [0.0; AXES],
            counters: METRES_PER_COUNT.map(|metres| Encoder::new(metres, 0).unwrap()),
            duties: [Duty::default(); AXES],
            enabled: false,
            closed: true,
            lit: false,
        }
    }
}

/// Two turns of a circle of 10 mm radius at 2 m/min, from zero.
const CIRCLE: Block<AXES> = Block::arc([0, 1], [-0.01, 0.0], 2.0, 2.0 / 60.0, 0.5);

#[test]
fn the_board_holds_when_it_is_enabled_and_follows_its_path() {
    let mut machine = Machine::UNCONFIGURED;
    let mut test_machine = TestMachine::new();
    let mut system = drive_system(&mut machine, FULL_COUNTS, tick_clock(CORE_HZ)).unwrap();
    let run = |system: &mut BoardDrives<'_>, test_machine: &mut TestMachine, milliseconds: u32| {
        let mut max_error = 0f64;
        for _ in 0..milliseconds * (TICK_HZ / 1000) {
            system.tick(test_machine);
            test_machine.step();
            let [x, y] = test_machine.position_m;
            max_error = max_error.max(((x + 0.01).hypot(y) - 0.01).abs());
        }
        max_error
    };
    run(&mut system, &mut test_machine, 500);
    assert_eq!((test_machine.enabled, test_machine.position_m), (false, [0.0; AXES]));
    test_machine.closed = false;
    run(&mut system, &mut test_machine, 100);
    // Moved by hand before the first enable, the machine holds its new position.
    test_machine.position_m = [0.0031, -0.002];
    test_machine.encoder_m = test_machine.position_m;
    run(&mut system, &mut test_machine, 1);
    test_machine.closed = true;
    run(&mut system, &mut test_machine, 1000);
    assert!(test_machine.enabled && !test_machine.lit);
    assert_eq!(test_machine.position_m.map(f64::to_bits), [0.0031, -0.002].map(f64::to_bits));
    test_machine.closed = false;
    run(&mut system, &mut test_machine, 1);
    assert_eq!((test_machine.enabled, test_machine.duties), (false, [Duty::default(); AXES]));

    test_machine.position_m = [0.0; AXES];
    test_machine.encoder_m = test_machine.position_m;
    run(&mut system, &mut test_machine, 100);
    // Its soft limits need a reference, so that a program is refused; a jog is not.
    assert_eq!(system.machine_mut().push(&CIRCLE), Err(PathError::NotHomed { axis: 0 }));
    system.machine_mut().jog(&CIRCLE).unwrap();
    test_machine.closed = true;
    // A turn and a half of 62.8 mm each at 33.3 mm/s takes 2827 ms; the ramp takes less than 100 ms more.
    let mut max_error = run(&mut system, &mut test_machine, 20 + 2827 + 100);
    assert!(test_machine.enabled && test_machine.position_m[0] < -0.019, "{:?}", test_machine.position_m);
    max_error = max_error.max(run(&mut system, &mut test_machine, 2000));
    assert!(test_machine.enabled && !test_machine.lit);
    // Back at the start within the friction: at an error of 10 µm the integral part rises by only Kv/Ti·Kp·10 µm = 38 N/s.
    assert!(test_machine.position_m.iter().all(|m| m.abs() < 30e-6), "{:?}", test_machine.position_m);
    // The contour error was always below half of the limit of the following error.
    assert!(max_error < 0.5 * SETTINGS[0].following_error_limit_m, "{max_error}");
    test_machine.closed = false;
    run(&mut system, &mut test_machine, 1);
    assert_eq!((test_machine.enabled, test_machine.duties), (false, [Duty::default(); AXES]));
}

/// An encoder freezes during the motion: the power stages are off before the axis has moved by another 1.5 mm. The limit of
/// the following error alone would allow 5 mm.
#[test]
fn a_frozen_encoder_switches_the_power_stages_off() {
    let mut machine = Machine::UNCONFIGURED;
    let mut test_machine = TestMachine::new();
    test_machine.closed = false;
    let mut system = drive_system(&mut machine, FULL_COUNTS, tick_clock(CORE_HZ)).unwrap();
    for _ in 0..1000 {
        system.tick(&mut test_machine);
    }
    system.machine_mut().jog(&CIRCLE).unwrap();
    test_machine.closed = true;
    let mut ticks = 0;
    while !test_machine.lit {
        system.tick(&mut test_machine);
        // Only X: its counter freezes at −2 mm.
        let frozen_m = test_machine.position_m[0].max(-0.002);
        test_machine.step();
        test_machine.encoder_m[0] = frozen_m;
        ticks += 1;
        assert!(ticks < 40_000, "{:?}", test_machine.position_m);
    }
    let fault = Fault::Axis { axis: 0, kind: FaultKind::EncoderFrozen };
    assert_eq!(system.machine_mut().power(), Power::Faulted(fault));
    assert!(!test_machine.enabled);
    assert!(
        test_machine.position_m[0] < -0.002 && test_machine.position_m[0] > -0.0035,
        "{:?}",
        test_machine.position_m
    );
}

/// An axis whose envelope has a limit for its scale has one, and no other.
#[test]
fn the_envelope_knows_the_scales_of_the_table() {
    for (axis, envelope) in TABLE.iter().zip(&ENVELOPE.axes) {
        assert_eq!(axis.scale_m_per_count.is_some(), envelope.scale_disagreement_limit_m.is_some());
    }
}

#[test]
fn after_a_watchdog_reset_an_enable_of_the_board_needs_an_acknowledgement() {
    let mut machine = Machine::UNCONFIGURED;
    let mut test_machine = TestMachine::new();
    test_machine.closed = false;
    let mut system = drive_system(&mut machine, FULL_COUNTS, tick_clock(CORE_HZ)).unwrap();
    system.machine_mut().inhibit_enable(Fault::Watchdog);
    let mut run = |test_machine: &mut TestMachine, closed, ticks| {
        test_machine.closed = closed;
        for _ in 0..ticks {
            system.tick(test_machine);
        }
        (test_machine.enabled, test_machine.lit)
    };
    assert_eq!(run(&mut test_machine, false, 1000), (false, true));
    // Closing the switch does not enable the drives; opening it again acknowledges the fault.
    assert_eq!(run(&mut test_machine, true, 1000), (false, true));
    assert_eq!(run(&mut test_machine, false, 1000), (false, false));
    assert_eq!(run(&mut test_machine, true, 1000), (true, false));
}
