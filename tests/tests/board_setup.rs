//! The table of the board's machine is accepted, and it holds, travels and stops on a bench of two masses.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use firmware::setup::{AXES, METRES_PER_COUNT, SETTINGS, TICK_HZ, drive_system};
use shared::axis::Reading;
use shared::drive::{Board, DriveSystem, Duty};
use shared::feedback::encoder::Encoder;
use shared::interpolate::Block;
use shared::machine::Machine;
use shared::safety::{Fault, FaultKind, Power};
use shared::scalar::Fixed;

/// PWM counts on the board: 168 MHz / 20 kHz.
const FULL_COUNTS: u16 = 8400;

const MASS_KG: f64 = 15.0;
const COULOMB_N: f64 = 20.0;

/// Drives, masses and counters.
struct Bench {
    place_m: [f64; AXES],
    /// What the counters see: the same, unless they stand.
    shown_m: [f64; AXES],
    velocity: [f64; AXES],
    counters: [Encoder; AXES],
    duties: [Duty; AXES],
    enabled: bool,
    closed: bool,
    lit: bool,
}

impl Bench {
    /// What a counter of 16 bits shows: it wraps.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "wraps on purpose")]
    fn count(&self, axis: usize) -> u16 {
        ((self.shown_m[axis] / METRES_PER_COUNT[axis]).floor() as i64 & 0xffff) as u16
    }

    fn step(&mut self) {
        for axis in 0..AXES {
            let Duty { reverse, counts } = self.duties[axis];
            let force = 400.0 * f64::from(counts) / f64::from(FULL_COUNTS) * if reverse { -1.0 } else { 1.0 };
            let friction = COULOMB_N * (self.velocity[axis] / 1e-4).tanh();
            self.velocity[axis] += (force - friction) / MASS_KG / f64::from(TICK_HZ);
            self.place_m[axis] += self.velocity[axis] / f64::from(TICK_HZ);
        }
        self.shown_m = self.place_m;
    }
}

impl Board<AXES> for Bench {
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

    fn set_duties(&mut self, duties: [Duty; AXES]) {
        self.duties = duties;
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

impl Bench {
    /// At zero, the enable switch closed, as somebody may have left it.
    fn new() -> Self {
        Self {
            place_m: [0.0; AXES],
            shown_m: [0.0; AXES],
            velocity: [0.0; AXES],
            counters: METRES_PER_COUNT.map(|metres| Encoder::new(metres, 0).unwrap()),
            duties: [Duty::default(); AXES],
            enabled: false,
            closed: true,
            lit: false,
        }
    }
}

/// Two turns of a circle of 10 mm radius at 2 m/min that starts at zero.
const CIRCLE: Block<AXES> = Block::arc([0, 1], [-0.01, 0.0], 2.0, 2.0 / 60.0, 0.5);

#[test]
fn the_board_holds_when_it_is_enabled_and_travels_what_it_is_given() {
    let mut machine = Machine::UNCONFIGURED;
    let mut bench = Bench::new();
    let mut system = drive_system(&mut machine, FULL_COUNTS, None).unwrap();
    let run = |system: &mut DriveSystem<'_, Fixed, AXES>, bench: &mut Bench, milliseconds: u32| {
        let mut farthest = 0f64;
        for _ in 0..milliseconds * (TICK_HZ / 1000) {
            system.tick(bench);
            bench.step();
            let [x, y] = bench.place_m;
            farthest = farthest.max(((x + 0.01).hypot(y) - 0.01).abs());
        }
        farthest
    };
    run(&mut system, &mut bench, 500);
    assert_eq!((bench.enabled, bench.place_m), (false, [0.0; AXES]));
    bench.closed = false;
    run(&mut system, &mut bench, 100);
    // Pushed by hand before the first enable: it holds there.
    bench.place_m = [0.0031, -0.002];
    bench.shown_m = bench.place_m;
    run(&mut system, &mut bench, 1);
    bench.closed = true;
    run(&mut system, &mut bench, 1000);
    assert!(bench.enabled && !bench.lit);
    assert_eq!(bench.place_m.map(f64::to_bits), [0.0031, -0.002].map(f64::to_bits));
    bench.closed = false;
    run(&mut system, &mut bench, 1);
    assert_eq!((bench.enabled, bench.duties), (false, [Duty::default(); AXES]));

    bench.place_m = [0.0; AXES];
    bench.shown_m = bench.place_m;
    run(&mut system, &mut bench, 100);
    system.machine_mut().push(&CIRCLE).unwrap();
    bench.closed = true;
    // A turn and a half of 62.8 mm at 33.3 mm/s, and the ramp.
    let mut farthest = run(&mut system, &mut bench, 20 + 2827 + 100);
    assert!(bench.enabled && bench.place_m[0] < -0.019, "{:?}", bench.place_m);
    farthest = farthest.max(run(&mut system, &mut bench, 2000));
    assert!(bench.enabled && !bench.lit);
    // Back at the start but for friction: the last 10 µm raise the integral by Kv/Ti·Kp·10 µm = 38 N/s only.
    assert!(bench.place_m.iter().all(|place| place.abs() < 30e-6), "{:?}", bench.place_m);
    // On the way never off the circle by half the following error that would have ended it.
    assert!(farthest < 0.5 * SETTINGS[0].following_error_limit_m, "{farthest}");
    bench.closed = false;
    run(&mut system, &mut bench, 1);
    assert_eq!((bench.enabled, bench.duties), (false, [Duty::default(); AXES]));
}

/// An encoder that stands from the middle of the motion on: the stages are cut before the axis has gone 1.5 mm on. The
/// following error alone would let it run for 5 mm.
#[test]
fn a_frozen_encoder_cuts_the_stages() {
    let mut machine = Machine::UNCONFIGURED;
    let mut bench = Bench::new();
    bench.closed = false;
    let mut system = drive_system(&mut machine, FULL_COUNTS, None).unwrap();
    (0..1000).for_each(|_| system.tick(&mut bench));
    system.machine_mut().push(&CIRCLE).unwrap();
    bench.closed = true;
    let mut ticks = 0;
    while !bench.lit {
        system.tick(&mut bench);
        // X alone: it has come to 2 mm, and its counter shows no more.
        let shown = bench.place_m[0].max(-0.002);
        bench.step();
        bench.shown_m[0] = shown;
        ticks += 1;
        assert!(ticks < 40_000, "{:?}", bench.place_m);
    }
    let fault = Fault::Axis { axis: 0, kind: FaultKind::EncoderFrozen };
    assert_eq!(system.machine_mut().power(), Power::Faulted(fault));
    assert!(!bench.enabled);
    assert!(bench.place_m[0] < -0.002 && bench.place_m[0] > -0.0035, "{:?}", bench.place_m);
}

#[test]
fn a_run_that_a_watchdog_ended_is_acknowledged_before_the_board_comes_on() {
    let mut machine = Machine::UNCONFIGURED;
    let mut bench = Bench::new();
    bench.closed = false;
    let mut system = drive_system(&mut machine, FULL_COUNTS, Some(Fault::Watchdog)).unwrap();
    let mut run = |bench: &mut Bench, closed, ticks| {
        bench.closed = closed;
        (0..ticks).for_each(|_| system.tick(bench));
        (bench.enabled, bench.lit)
    };
    assert_eq!(run(&mut bench, false, 1000), (false, true));
    // Closed, it does not come on; opened again, the fault is acknowledged.
    assert_eq!(run(&mut bench, true, 1000), (false, true));
    assert_eq!(run(&mut bench, false, 1000), (false, false));
    assert_eq!(run(&mut bench, true, 1000), (true, false));
}
