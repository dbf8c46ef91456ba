//! Measurements that are kept, so that the end of a run can set them beside each other.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::Criterion;

/// Calls between two looks at the clock: long beside the 25 ns or so that the clock takes, short beside the time
/// that the system lets another program have.
const LAP: u64 = 16;

/// What was measured, in the order of measuring.
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
        // Long enough for a median to the percent, and the whole run takes two minutes.
        let criterion = Criterion::default()
            .warm_up_time(Duration::from_millis(500))
            .measurement_time(Duration::from_secs(2))
            .without_plots()
            .configure_from_args();
        Self { criterion, rows: Vec::new() }
    }
}

impl Compared {
    /// Measures a routine that does its work `repeats` times a call; `peer` is the name of the row to set it
    /// against, its own or empty where there is none.
    pub fn row<R>(&mut self, name: &str, peer: &str, repeats: u32, mut routine: impl FnMut() -> R) {
        let mut laps = Vec::new();
        self.criterion.bench_function(name, |bencher| {
            bencher.iter_custom(|calls| {
                let mut elapsed = Duration::ZERO;
                let mut left = calls;
                while left > 0 {
                    let lap = left.min(LAP);
                    let began = Instant::now();
                    for _ in 0..lap {
                        black_box(routine());
                    }
                    let took = began.elapsed();
                    if lap == LAP {
                        laps.push(took.as_secs_f64() * 1e9 / (LAP as f64 * f64::from(repeats)));
                    }
                    elapsed += took;
                    left -= lap;
                }
                elapsed / repeats
            });
        });
        laps.sort_by(f64::total_cmp);
        // None where the command line has chosen others, or asks for a test run.
        if let Some(&ns) = laps.get(laps.len() / 10) {
            self.rows.push(Row { name: name.into(), peer: peer.into(), ns });
        }
    }

    /// Prints the table: of each row the time that a tenth of the laps keeps below, for the rest have shared the
    /// processor with other programs.
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
