//! Any text as the log of another program, with each preset of a text.
#![no_main]

mod importer;

use import::format::Format;
use libfuzzer_sys::fuzz_target;

// An input is a preset, then the file.
fuzz_target!(|data: &[u8]| {
    let Some((preset, bytes)) = data.split_first() else { return };
    let presets = [None, Some(Format::Text), Some(Format::Halsampler), Some(Format::Halscope), Some(Format::Twincat)];
    importer::import(presets[usize::from(*preset) % presets.len()], bytes);
});
