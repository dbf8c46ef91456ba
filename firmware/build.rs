//! Selects the memory map for the linker script of cortex-m-rt by feature.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=memory");
    let chosen = |feature: &str| env::var_os(format!("CARGO_FEATURE_{feature}")).is_some();
    let map = match ["BOARD", "BOARD_G474", "EMULATED", "COST", "SERVO"].map(chosen) {
        [true, false, false, false, false] => "memory/board.x",
        [false, true, false, false, false] => "memory/board-g474.x",
        [false, false, true, false, false] => "memory/emulated.x",
        // `cost` implies `emulated`.
        [false, false, true, true, false] => "memory/cost.x",
        [false, false, false, false, true] => "memory/servo.x",
        // Without a feature there is no program to link.
        [false, false, false, false, false] => return,
        _ => panic!("choose one of board, board-g474, emulated, cost and servo: their memory maps differ"),
    };
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    fs::copy(map, out.join("memory.x")).expect("OUT_DIR can be written to");
    println!("cargo:rustc-link-search={}", out.display());
    // Sections are not aligned to pages: flash has none.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
}
