//! The waves that were found as force ripple of a compensation file.

use std::f64::consts::TAU;

use model::axis::Settings;
use shared::compensate::settings::{CYCLES, Cycle};

use super::fit::Wave;
use super::learned::{Learned, Measured};
use crate::compensate::CompensationFile;
use crate::compensate::cycles;
use crate::compensate::file::AxisCompensation;
use crate::compensate::plan::limit;

/// The tables, by the writer that also makes those of a traced model: one for each of the periods that has waves.
#[must_use]
pub fn tables(learned: &Learned, periods_mm: &[f64]) -> heapless::Vec<Cycle, CYCLES> {
    let mut waves = Vec::new();
    for (number, period_mm) in periods_mm.iter().enumerate() {
        let of_period = |wave: &&Measured| wave.candidate.of_period == number;
        let found: Vec<&Measured> = learned.found().filter(of_period).collect();
        // Waves of orders 2 and 3 are both in a table of the whole period, which has no wave of its own.
        let divisor = found.iter().fold(0, |divisor, wave| common_divisor(wave.candidate.order, divisor));
        if divisor > 0 {
            let whole_mm = period_mm / divisor as f64;
            waves.push(wave(whole_mm, Wave::new(0.0, 0.0)));
        }
        waves.extend(found.iter().map(|found| wave(found.candidate.period_mm, found.wave_n)));
    }
    cycles::tables(waves).0
}

/// amplitude·sin(2πx/period + phase), N.
fn wave(period_mm: f64, wave_n: Wave) -> cycles::Wave<'static> {
    let (amplitude_n, phase_rad) = wave_n.to_polar();
    let period_m = 1e-3 * period_mm;
    let value = move |position_m: f64| amplitude_n * libm::sin(TAU * position_m / period_m + phase_rad);
    cycles::Wave { period_m, amplitude: amplitude_n, value: Box::new(value) }
}

const fn common_divisor(one: usize, other: usize) -> usize {
    if other == 0 { one } else { common_divisor(other, one % other) }
}

/// Sets the tables of an axis in a compensation, in place of those for its ripple; what else it has remains. An axis without compensation
/// gets one with the bounds of a planned one. `board` is where it was learned, `effect` is the name of what is compensated.
pub fn set(
    file: &mut CompensationFile,
    (name, settings): (&str, &Settings),
    tables: heapless::Vec<Cycle, CYCLES>,
    (board, effect): (&str, &str),
) {
    let planned = || {
        let mut axis = AxisCompensation::default();
        limit(&mut axis.compensation, settings);
        axis
    };
    let axis = file.axis.entry(name.to_owned()).or_insert_with(planned);
    axis.compensation.ripple = tables;
    let learned = format!("cogging of {name} learned on {board}");
    let provenance = &mut file.provenance;
    provenance.model =
        if provenance.model.is_empty() { learned } else { format!("{}; {learned}", provenance.model) };
    provenance.program = format!("lost-motion {}", env!("CARGO_PKG_VERSION"));
    let item = format!("{name}: {effect}");
    if !provenance.compensates.contains(&item) {
        provenance.compensates.push(item);
    }
}
