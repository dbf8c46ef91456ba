//! How fast the closed loop runs: two axes of two masses with `LuGre` friction on a circle, velocity loops at 20 kHz.
//!
//! `cargo bench -p host-sim --bench speed`. Each figure is that of the fastest tenth of the laps, for the others have
//! shared the processor with other programs; steps a tick are what the plant takes of them, and accuracy is the tool
//! point against a run with as many steps as change nothing any more.
#![expect(clippy::unwrap_used, reason = "a benchmark that cannot run stops")]

use std::hint::black_box;
use std::time::Instant;

use host_sim::controller::{AxisOutput, Controller, Format, PathBlock, PathShape};
use host_sim::machine::Machine;
use host_sim::plant::desk::{Desk, Instruments};
use host_sim::simulate;
use shared::axis::Reading;
use shared::units::Position;

const TICK_HZ: f64 = 20_000.0;
const START_M: [f64; 2] = [0.05, 0.0];

/// Ticks of a lap, and laps.
const LAP: u32 = 2000;
const LAPS: usize = 300;

/// The plant of the benchmark; with a position loop in every `divider`-th tick.
fn machine(divider: u32) -> Machine {
    let axis = "controller = \"p\"\nposition_gain_per_s = 50.0\nfeedforward_percent = 60.0\n\
                velocity_gain_n_s_per_m = 60000.0\nvelocity_integral_time_s = 0.016\nforce_limit_n = 20000.0\n\
                motor_mass_kg = 90.0\ntable_mass_kg = 160.0\nstiffness_n_per_um = 200.0\ndamping_n_s_per_m = 10000.0\n\
                coulomb_n = 180.0\nviscous_n_s_per_m = 1000.0\npresliding_stiffness_n_per_um = 40.0\n\
                presliding_damping_n_s_per_m = 2000.0\n";
    let rate_hz = TICK_HZ / f64::from(divider);
    let top = format!("name = \"b\"\nsample_rate_hz = {rate_hz:.1}\nvelocity_loop_rate_hz = {TICK_HZ:.1}\n");
    Machine::parse(&format!("{top}[axis.x]\n{axis}[axis.y]\n{axis}"), "benchmark").unwrap()
}

/// A loop that goes round a circle of 50 mm at 100 mm/s.
struct Loop {
    controller: Box<dyn Controller>,
    desk: Desk,
    readings: Vec<Reading>,
    outputs: Vec<AxisOutput>,
}

impl Loop {
    fn new(machine: &Machine, format: Format, steps: u32) -> Self {
        let mut controller = simulate::controller(machine, format, &START_M).unwrap();
        let circle = PathShape::Arc { plane: [0, 1], centre_m: [0.0, 0.0], turns: 900.0 };
        controller.push(&PathBlock::new(circle, 0.1, 2.0)).unwrap();
        controller.enable().unwrap();
        Self {
            controller,
            desk: Desk::with_steps(machine, Instruments::default(), &START_M, steps),
            readings: vec![Reading { motor: Position(0), table: None }; 2],
            outputs: vec![AxisOutput::default(); 2],
        }
    }

    fn tick(&mut self) {
        self.desk.read(&mut self.readings);
        self.controller.tick(&self.readings, &mut self.outputs).unwrap();
        self.desk.step(self.outputs.iter().map(|output| output.force_n));
    }

    /// ns a tick.
    fn cost(&mut self) -> f64 {
        let mut laps: Vec<f64> = (0..LAPS)
            .map(|_| {
                let began = Instant::now();
                (0..LAP).for_each(|_| black_box(&mut *self).tick());
                began.elapsed().as_secs_f64() * 1e9 / f64::from(LAP)
            })
            .collect();
        laps.sort_by(f64::total_cmp);
        laps[LAPS / 10]
    }

    /// Tool points of a second of circle, its beginning included, a row a millisecond, m.
    fn tool(&mut self) -> Vec<f64> {
        let mut points = Vec::new();
        for tick in 0..20_000 {
            self.tick();
            if tick % 20 == 0 {
                points.extend(self.desk.row(&self.readings, 0.0).iter().map(|row| row.tool_m));
            }
        }
        points
    }
}

fn rms_nm(a: &[f64], b: &[f64]) -> f64 {
    (a.iter().zip(b).map(|(a, b)| (1e9 * (a - b)).powi(2)).sum::<f64>() / a.len() as f64).sqrt()
}

fn main() {
    println!(
        "{:<10}{:>16}{:>12}{:>14}{:>16}",
        "format", "position loop", "steps", "ns a tick", "of real time"
    );
    for (format, name) in [(Format::F64, "f64"), (Format::F32, "f32"), (Format::Fixed, "fixed")] {
        for divider in [1, 4] {
            for steps in [1, 5] {
                let ns = Loop::new(&machine(divider), format, steps).cost();
                let loop_hz = TICK_HZ / f64::from(divider);
                println!("{name:<10}{loop_hz:>13.0} Hz{steps:>12}{ns:>14.1}{:>16.0}", 1e9 / TICK_HZ / ns);
            }
        }
    }
    println!("\n{:<10}{:>26}", "steps", "tool from converged, nm");
    let machine = machine(4);
    let converged = Loop::new(&machine, Format::F64, 128).tool();
    for steps in [1, 2, 5, 64] {
        let off = rms_nm(&Loop::new(&machine, Format::F64, steps).tool(), &converged);
        println!("{steps:<10}{off:>26.4}");
    }
}
