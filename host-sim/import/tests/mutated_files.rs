//! The seeds of the fuzz targets with random changes: what the targets assert holds without the nightly compiler, too.
//!
//! `MUTATIONS` is the number of changed files for each seed (200); the long run of `tests/deep.sh fuzz` finds its way by coverage.

#[path = "../../../fuzz/fuzz_targets/importer.rs"]
mod importer;

use std::fs;
use std::path::{Path, PathBuf};

use import::format::Format;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Presets of the first byte of a seed, as in the target of this name.
const TARGETS: [(&str, &[Option<Format>]); 2] = [
    (
        "import_text",
        &[None, Some(Format::Text), Some(Format::Halsampler), Some(Format::Halscope), Some(Format::Twincat)],
    ),
    (
        "import_binary",
        &[Some(Format::Matlab), Some(Format::Numpy), Some(Format::Parquet), Some(Format::Mcap)],
    ),
];

/// The seeds of a target, sorted by name.
fn seeds(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds").join(target);
    let entries = fs::read_dir(folder).expect("the seeds").map(|entry| entry.expect("a file").path());
    let mut seeds: Vec<_> = entries.map(|path| (path.clone(), fs::read(path).expect("a file"))).collect();
    seeds.sort();
    seeds
}

/// One to four changes of single bytes, of four neighbours (a length), of the end, or of a part that is repeated.
fn changed(bytes: &[u8], random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..random.random_range(1..=4) {
        if bytes.len() < 8 {
            break;
        }
        let at = random.random_range(0..bytes.len() - 4);
        match random.random_range(0..6) {
            0 => bytes[at] ^= 1 << random.random_range(0..8),
            1 => bytes[at] = random.random(),
            2 => bytes[at..at + 4].fill([0x00, 0x7f, 0xff][random.random_range(0..3)]),
            3 => bytes.truncate(at),
            4 => drop(bytes.remove(at)),
            _ => {
                let part = bytes[at..].iter().take(32).copied().collect::<Vec<u8>>();
                let to = random.random_range(0..bytes.len());
                bytes.splice(to..to, part);
            }
        }
    }
    bytes
}

#[test]
fn no_change_of_a_file_causes_a_panic() {
    let count = std::env::var("MUTATIONS").map_or(200, |count| count.parse().unwrap());
    for (target, presets) in TARGETS {
        let seeds = seeds(target);
        assert!(seeds.len() >= 5, "{target}");
        for (path, seed) in seeds {
            let (first, bytes) = seed.split_first().unwrap();
            let preset = presets[usize::from(*first) % presets.len()];
            let mut random = ChaCha8Rng::seed_from_u64(1);
            for number in 0..count {
                let changed = changed(bytes, &mut random);
                let outcome = std::panic::catch_unwind(|| importer::import(preset, &changed));
                assert!(outcome.is_ok(), "{}: change {number}", path.display());
            }
        }
    }
}

/// Seeds that are refused as they are, with a part of the message: other names of columns, and a file that once caused a
/// subtraction below zero.
const REFUSED: [(&str, &str); 3] = [
    ("comma", "expected a column of the file"),
    ("german", "expected a column of the file"),
    ("mcap_overlong_record", "a record that is longer than its chunk"),
];

/// Unchanged, each seed is a log with its columns 1 and 2, or is refused for the reason beside its name.
#[test]
fn the_seeds_are_read() {
    let read = |preset, bytes: &[u8]| {
        let mappings = vec!["x_motor_mm=1".parse().unwrap()];
        let request =
            import::request::Request { mappings, rate_hz: Some(1000.0), preset, ..Default::default() };
        import::of_bytes(bytes, "a", &request)
    };
    for (target, presets) in TARGETS {
        for (path, seed) in seeds(target) {
            let (first, bytes) = seed.split_first().unwrap();
            let result = read(presets[usize::from(*first) % presets.len()], bytes);
            let name = path.file_name().and_then(|name| name.to_str()).expect("a name");
            match REFUSED.iter().find(|(refused, _)| *refused == name) {
                None => assert!(result.is_ok(), "{name}: {result:?}"),
                Some((_, reason)) => {
                    let error = result.expect_err(name).to_string();
                    assert!(error.contains(reason), "{name}: {error}");
                }
            }
        }
    }
}
