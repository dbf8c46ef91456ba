//! The table of the board's machine is accepted, and its program runs, on a bench of two masses.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use firmware::setup::{AXES, METRES_PER_COUNT, SETTINGS, TICK_HZ, encoders, station};
use shared::axis::Reading;
use shared::drive::{Board, Duty};
use shared::feedback::encoder::Encoder;
use shared::machine::Machine;
use shared::safety::Power;

/// PWM counts on the board: 168 MHz / 20 kHz.
const FULL_COUNTS: u16 = 8400;

const MASS_KG: f64 = 15.0;
const COULOMB_N: f64 = 20.0;

/// Drives, masses and counters.
struct Bench {
    place_m: [f64; AXES],
    velocity: [f64; AXES],
    counters: [Encoder; AXES],
    duties: [Duty; AXES],
    power: Power,
    closed: bool,
}

impl Bench {
    /// What a counter of 16 bits shows: it wraps.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "wraps on purpose")]
    fn count(&self, axis: usize) -> u16 {
        ((self.place_m[axis] / METRES_PER_COUNT[axis]).floor() as i64 & 0xffff) as u16
    }

    fn step(&mut self) {
        for axis in 0..AXES {
            let Duty { reverse, counts } = self.duties[axis];
            let force = 400.0 * f64::from(counts) / f64::from(FULL_COUNTS) * if reverse { -1.0 } else { 1.0 };
            let friction = COULOMB_N * (self.velocity[axis] / 1e-4).tanh();
            self.velocity[axis] += (force - friction) / MASS_KG / f64::from(TICK_HZ);
            self.place_m[axis] += self.velocity[axis] / f64::from(TICK_HZ);
        }
    }
}

impl Board<AXES> for Bench {
    fn readings(&mut self) -> [Reading; AXES] {
        core::array::from_fn(|axis| Reading {
            motor: self.counters[axis].read(self.count(axis)),
            table: None,
        })
    }

    fn switch_closed(&mut self) -> bool {
        self.closed
    }

    fn set_duties(&mut self, duties: [Duty; AXES]) {
        self.duties = duties;
    }

    fn set_power(&mut self, power: Power) {
        self.power = power;
    }

    fn is_late(&mut self) -> bool {
        false
    }
}

#[test]
fn the_board_goes_round_its_circle_when_the_switch_is_closed_afresh() {
    let mut machine = Machine::UNCONFIGURED;
    let mut station = station(&mut machine, FULL_COUNTS).unwrap();
    let mut bench = Bench {
        place_m: [0.0; AXES],
        velocity: [0.0; AXES],
        counters: encoders([0; AXES]).unwrap(),
        duties: [Duty::default(); AXES],
        power: Power::Off,
        // As somebody may have left it.
        closed: true,
    };
    let mut run = |bench: &mut Bench, milliseconds: u32| {
        let mut farthest = 0f64;
        for _ in 0..milliseconds * (TICK_HZ / 1000) {
            station.tick(bench);
            bench.step();
            let [x, y] = bench.place_m;
            farthest = farthest.max(((x + 0.01).hypot(y) - 0.01).abs());
        }
        farthest
    };
    run(&mut bench, 500);
    assert_eq!((bench.power, bench.place_m), (Power::Off, [0.0; AXES]));
    bench.closed = false;
    run(&mut bench, 100);
    bench.closed = true;
    // A second of dwell, a turn and a half of 62.8 mm at 33.3 mm/s, and the ramp.
    let mut farthest = run(&mut bench, 1000 + 2827 + 100);
    assert_eq!(bench.power, Power::On);
    assert!(bench.place_m[0] < -0.019, "{:?}", bench.place_m);
    farthest = farthest.max(run(&mut bench, 2000));
    assert_eq!(bench.power, Power::On);
    // Back at the start but for friction: the last 10 µm raise the integral by Kv/Ti·Kp·10 µm = 38 N/s only.
    assert!(bench.place_m.iter().all(|place| place.abs() < 30e-6), "{:?}", bench.place_m);
    // On the way never off the circle by half the following error that would have ended it.
    assert!(farthest < 0.5 * SETTINGS[0].following_error_limit_m, "{farthest}");
    bench.closed = false;
    run(&mut bench, 1);
    assert_eq!((bench.power, bench.duties), (Power::Off, [Duty::default(); AXES]));
}
