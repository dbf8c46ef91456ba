//! Speed of the closed loop: two axes of two masses with `LuGre` friction on a circle, velocity loops at 20 kHz.
//!
//! `cargo bench -p host-sim --bench speed`. Each figure is the 10 % quantile of the laps, since other programs slow
//! down the rest. Steps are steps of the plant per tick; accuracy is the distance of the tool point from that of a converged
//! run with many more steps. [`plain`] is the same job without the crates of the program, for comparison.
#![expect(clippy::unwrap_used, reason = "a benchmark that cannot run stops")]

mod plain;

use std::hint::black_box;
use std::time::Instant;

use model::machine::Machine;
use motion::{PathBlock, PathShape};
use plant::controller::{AxisOutput, Controller};
use plant::instruments::Instruments;
use plant::machine_sim::MachineSim;
use plant::simulate;
use shared::axis::Reading;
use shared::scalar::Format;
use shared::units::Position;

use plain::Plain;

const TICK_HZ: f64 = 20_000.0;
const RADIUS_M: f64 = 0.05;
const START_M: [f64; 2] = [RADIUS_M, 0.0];
const FEED_M_PER_S: f64 = 0.1;
const ACCELERATION_M_PER_S2: f64 = 2.0;

/// Ticks of a lap, the unit of a time measurement, and laps.
const LAP: u32 = 2000;
const LAPS: usize = 300;

/// The machine of the benchmark: two axes with a position loop in every `divider`-th tick.
fn machine(divider: u32) -> Machine {
    machine_of(2, divider)
}

fn machine_of(axes: usize, divider: u32) -> Machine {
    let axis = "controller = \"p\"\nposition_gain_per_s = 50.0\nfeedforward_percent = 60.0\n\
                velocity_gain_n_s_per_m = 60000.0\nvelocity_integral_time_s = 0.016\nforce_limit_n = 20000.0\n\
                motor_mass_kg = 90.0\ntable_mass_kg = 160.0\nstiffness_n_per_um = 200.0\ndamping_n_s_per_m = 10000.0\n\
                coulomb_n = 180.0\nviscous_n_s_per_m = 1000.0\npresliding_stiffness_n_per_um = 40.0\n\
                presliding_damping_n_s_per_m = 2000.0\n";
    let rate_hz = TICK_HZ / f64::from(divider);
    let top = format!("name = \"b\"\nsample_rate_hz = {rate_hz:.1}\nvelocity_loop_rate_hz = {TICK_HZ:.1}\n");
    let axes = ["x", "y", "z"].iter().take(axes).map(|name| format!("[axis.{name}]\n{axis}"));
    Machine::parse(&(top + &axes.collect::<String>()), "benchmark").unwrap()
}

/// The closed loop on a circle of 50 mm radius at 100 mm/s.
struct Loop {
    controller: Box<dyn Controller>,
    machine_sim: MachineSim,
    readings: Vec<Reading>,
    outputs: Vec<AxisOutput>,
}

impl Loop {
    fn new(machine: &Machine, format: Format, steps: u32) -> Self {
        let mut controller = simulate::controller(machine, format, &START_M).unwrap();
        let circle = PathShape::Arc { plane: [0, 1], centre_m: [0.0, 0.0], turns: 900.0 };
        controller.push(&PathBlock::new(circle, FEED_M_PER_S, ACCELERATION_M_PER_S2)).unwrap();
        controller.enable().unwrap();
        Self {
            controller,
            machine_sim: MachineSim::with_steps(machine, Instruments::default(), &START_M, steps).unwrap(),
            readings: vec![Reading { motor: Position(0), table: None }; 2],
            outputs: vec![AxisOutput::default(); 2],
        }
    }

    fn tick(&mut self) {
        self.machine_sim.read(&mut self.readings);
        self.controller.tick(&self.readings, &mut self.outputs).unwrap();
        self.machine_sim.step(self.outputs.iter().map(|output| output.force_n));
    }

    fn tool_m(&mut self) -> [f64; 2] {
        let measured =
            self.machine_sim.measure(&self.readings, self.outputs.iter().map(|output| output.force_n), 0.0);
        [measured[0].tool_m, measured[1].tool_m]
    }
}

/// Time of a tick, ns.
fn cost<T>(mut job: T, tick: impl Fn(&mut T)) -> f64 {
    let mut laps: Vec<f64> = (0..LAPS)
        .map(|_| {
            let start = Instant::now();
            (0..LAP).for_each(|_| tick(black_box(&mut job)));
            start.elapsed().as_secs_f64() * 1e9 / f64::from(LAP)
        })
        .collect();
    laps.sort_by(f64::total_cmp);
    laps[LAPS / 10]
}

/// Tool points of the first second, one per millisecond, m.
fn tool<T>(mut job: T, tick: impl Fn(&mut T), tool_m: impl Fn(&mut T) -> [f64; 2]) -> Vec<f64> {
    let mut points = Vec::new();
    for ticks in 0..20_000 {
        tick(&mut job);
        if ticks % 20 == 0 {
            points.extend(tool_m(&mut job));
        }
    }
    points
}

fn rms_nm(a: &[f64], b: &[f64]) -> f64 {
    numerics::rms(a.iter().zip(b).map(|(a, b)| 1e9 * (a - b)))
}

fn print_cost(name: &str, divider: u32, steps: u32, ns: f64) {
    let loop_hz = TICK_HZ / f64::from(divider);
    println!("{name:<12}{loop_hz:>13.0} Hz{steps:>12}{ns:>14.1}{:>16.0}", 1e9 / TICK_HZ / ns);
}

fn main() {
    println!(
        "{:<12}{:>16}{:>12}{:>14}{:>16}",
        "format", "position loop", "steps", "ns a tick", "of real time"
    );
    for (format, name) in [(Format::F64, "f64"), (Format::F32, "f32"), (Format::Fixed, "fixed")] {
        for divider in [1, 4] {
            for steps in [1, 5] {
                let ns = cost(Loop::new(&machine(divider), format, steps), Loop::tick);
                print_cost(name, divider, steps, ns);
            }
        }
    }
    for divider in [1, 4] {
        for steps in [1, 5] {
            print_cost("plain loop", divider, steps, cost(Plain::new(&machine(divider), steps), Plain::tick));
        }
    }
    println!("\n{:<12}{:>16}{:>12}{:>14}", "axes", "plant alone", "steps", "ns a tick");
    for axes in 1..=3 {
        for steps in [1, 5, 10] {
            let machine_sim = MachineSim::with_steps(
                &machine_of(axes, 4),
                Instruments::default(),
                &[0.0; 3][..axes],
                steps,
            )
            .unwrap();
            let ns = cost(machine_sim, |machine_sim| machine_sim.step([100.0; 3].into_iter()));
            println!("{axes:<12}{:>16}{steps:>12}{ns:>14.1}", "");
        }
    }
    println!("\n{:<12}{:>10}{:>26}", "format", "steps", "tool from converged, nm");
    let machine = machine(4);
    let points = |steps| tool(Loop::new(&machine, Format::F64, steps), Loop::tick, Loop::tool_m);
    let plain_points = |steps| tool(Plain::new(&machine, steps), Plain::tick, |plain| plain.tool_m());
    let converged = points(128);
    for steps in [1, 2, 5, 64] {
        println!("{:<12}{steps:>10}{:>26.4}", "f64", rms_nm(&points(steps), &converged));
    }
    for steps in [1, 2, 5, 64] {
        println!("{:<12}{steps:>10}{:>26.4}", "plain loop", rms_nm(&plain_points(steps), &converged));
    }
}
