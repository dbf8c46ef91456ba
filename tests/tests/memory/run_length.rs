//! The memory of a run that is logged to a file does not depend on its length.

use crate::{ALLOCATOR, ONE_AT_A_TIME};
use std::fs;
use std::path::Path;

use files::log::{Log, write_rows};
use model::machine::Machine;
use motion::PathBlock;
use plant::instruments::Instruments;
use plant::simulate::{Run, Sample, controller};
use shared::scalar::Format;

/// Peak memory of a run (bytes, beyond that before it) and size of its log.
fn peak_and_file_bytes(machine: &Machine, seconds: f64, out: &Path) -> (usize, u64) {
    let blocks = [PathBlock::dwell(seconds)];
    let before = ALLOCATOR.current_usage();
    ALLOCATOR.reset_peak_usage();
    let start_m = [0.0; 2];
    let mut controller = controller(machine, Format::Fixed, &start_m).unwrap();
    let instruments = Instruments::typical(1);
    let run = Run { machine, instruments, start_m: &start_m, blocks: &blocks, start_s: 0.0 };
    write_rows(out, &run.empty_log(), |rows| {
        let on_sample = |samples: &[Sample]| rows.row(samples.iter().flat_map(Sample::values));
        run.rows(controller.as_mut(), |_, _, _| {}, on_sample).map_err(std::io::Error::other)
    })
    .unwrap();
    (ALLOCATOR.peak_usage() - before, fs::metadata(out).unwrap().len())
}

#[test]
fn memory_does_not_grow_with_the_length_of_a_run() {
    let _guard = ONE_AT_A_TIME.lock().unwrap();
    let machine = Machine::parse(include_str!("../../../host-sim/machines/vmc.toml"), "vmc.toml").unwrap();
    let folder = tempfile::tempdir().unwrap();
    for name in ["log.csv", "log.csv.gz"] {
        let out = folder.path().join(name);
        let (short, short_file) = peak_and_file_bytes(&machine, 2.0, &out);
        let (long, long_file) = peak_and_file_bytes(&machine, 40.0, &out);
        // 20 times the rows are 20 times the file. In memory the additional rows would be 38 s · 1000/s · 10 columns of
        // 8 bytes: 3 MB.
        assert!(long_file > 15 * short_file, "{name}: {short_file} and {long_file} bytes of file");
        assert!(long < short + 1000, "{name}: {short} and {long} bytes of memory");
        let log = Log::read(&out).unwrap();
        assert_eq!(log.len(), 40_001, "{name}");
    }
}
