//! Collects the measurements of a run, for a table that compares them at the end.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::Criterion;

/// Calls per clock reading: long compared with the 25 ns of a reading, short compared with a time slice of the scheduler.
const LAP: u64 = 16;

/// The measurements, in their order.
pub struct Compared {
    criterion: Criterion,
    rows: Vec<Row>,
}

struct Row {
    name: String,
    peer: String,
    ns: f64,
}

impl Default for Compared {
    fn default() -> Self {
        // The median is then reproducible to 1 %, and the whole run takes two minutes.
        let criterion = Criterion::default()
            .warm_up_time(Duration::from_millis(500))
            .measurement_time(Duration::from_secs(2))
            .without_plots()
            .configure_from_args();
        Self { criterion, rows: Vec::new() }
    }
}

impl Compared {
    /// Measures a routine that does its work `repeats` times per call. `peer` is the name of the row to compare it with; its
    /// own name or an empty one: none.
    pub fn row<R>(&mut self, name: &str, peer: &str, repeats: u32, mut routine: impl FnMut() -> R) {
        let mut laps = Vec::new();
        self.criterion.bench_function(name, |bencher| {
            bencher.iter_custom(|calls| {
                let mut elapsed = Duration::ZERO;
                let mut remaining = calls;
                while remaining > 0 {
                    let lap = remaining.min(LAP);
                    let began = Instant::now();
                    for _ in 0..lap {
                        black_box(routine());
                    }
                    let took = began.elapsed();
                    if lap == LAP {
                        laps.push(took.as_secs_f64() * 1e9 / (LAP as f64 * f64::from(repeats)));
                    }
                    elapsed += took;
                    remaining -= lap;
                }
                elapsed / repeats
            });
        });
        laps.sort_by(f64::total_cmp);
        // There are no laps if the command line selects other benchmarks or a test run.
        if let Some(&ns) = laps.get(laps.len() / 10) {
            self.rows.push(Row { name: name.into(), peer: peer.into(), ns });
        }
    }

    /// Prints the table. The time of a row is the 10 % quantile of its laps, because other programs slow down the rest.
    pub fn finish(self) {
        self.criterion.final_summary();
        if self.rows.is_empty() {
            return;
        }
        println!("\n{:<44}{:>12}  {:>8}  peer", "one of", "ns", "of peer");
        for row in &self.rows {
            let peer = self.rows.iter().find(|other| other.name == row.peer && row.peer != row.name);
            let ratio = peer.map_or(String::new(), |peer| format!("{:.2}", row.ns / peer.ns));
            let peer = peer.map_or("", |peer| &peer.name);
            println!("{:<44}{:>12.2}  {ratio:>8}  {peer}", row.name, row.ns);
        }
    }
}
