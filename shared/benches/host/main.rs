//! Run time of the controller on the host, compared with crates that do the same: `cargo bench -p shared`.
//!
//! | module | measures | peer |
//! |---|---|---|
//! | [`laws`] | one step of a control law | `idsp`, the biquad in the same number format |
//! | [`tick`] | one tick of a machine of two axes | the same in f64 |
//! | [`planning`] | one block from rest to rest | `rsruckig` |
//!
//! Criterion measures and compares with the previous run; the table at the end compares each time with that of its peer in
//! the same run. An argument selects benchmarks by name, for example `cargo bench -p shared -- planning`.
#![allow(clippy::unwrap_used, reason = "a benchmark fails by panicking")]

mod compared;
mod laws;
mod planning;
mod tick;

use compared::Compared;

fn main() {
    let mut compared = Compared::default();
    laws::measure(&mut compared);
    tick::measure(&mut compared);
    planning::measure(&mut compared);
    compared.finish();
}
