//! Any bytes as a MAT-file, an array or an archive of NumPy, a Parquet or an MCAP file.
#![no_main]

mod importer;

use import::format::Format;
use libfuzzer_sys::fuzz_target;

// An input is a preset, then the file.
fuzz_target!(|data: &[u8]| {
    let Some((preset, bytes)) = data.split_first() else { return };
    let presets = [Format::Matlab, Format::Numpy, Format::Parquet, Format::Mcap];
    importer::import(Some(presets[usize::from(*preset) % presets.len()]), bytes);
});
