//! The tick of the chip cannot panic: a static analysis of the linked program.
//!
//! A servo drive that stops in a panic handler no longer controls its axis. Therefore every call and jump that is
//! reachable from the tick is followed.

use std::collections::BTreeMap;
use std::fs;

use tests::chip::image::{Function, Image, Section};
use tests::chip::vectors::Vectors;
use tests::chip::walk::{Walk, walk};
use tests::firmware::{FLASH, TICK};

fn program(name: &str) -> Image {
    let path = tests::firmware::built(name);
    Image::read(&fs::read(&path).expect("cargo has just built it"))
}

/// Asserts that a walk has no panics, traps or unresolved calls, and is as large as the whole controller.
fn assert_panic_free(image: &Image, walk: &Walk, functions: usize, instructions: usize) {
    assert_eq!(walk.panics(image), Vec::<String>::new());
    assert!(walk.traps.is_empty(), "traps at {:x?}", walk.traps);
    assert!(walk.indirect.is_empty(), "calls with unknown targets at {:x?}", walk.indirect);
    assert!(
        walk.without_function.is_empty(),
        "calls of addresses without a function at {:x?}",
        walk.without_function
    );
    println!("{} functions, {} instructions", walk.reached.len(), walk.instructions);
    assert!(walk.reached.len() >= functions && walk.instructions >= instructions);
}

#[test]
fn the_tick_of_the_board_cannot_panic() {
    let image = program("board");
    let tick = Vectors::read(&image, FLASH).handler(TICK);
    assert_eq!(image.functions[&tick].names, ["TIM2"], "RTIC names the handler after its interrupt");
    // Interpolation of an arc, two position and velocity loops, two outputs: 2,000 instructions at least.
    assert_panic_free(&image, &walk(&image, &[tick]), 5, 1500);
}

#[test]
fn the_walk_finds_the_panics_of_the_start_up() {
    let image = program("board");
    let walk = walk(&image, &image.named(|name| name == "Reset"));
    // `init` can panic on wrong settings, so the walk must find panics there.
    let panics = walk.panics(&image);
    assert!(
        panics.iter().any(|chain| chain.starts_with("Reset → ") && chain.contains("panicking")),
        "{panics:#?}"
    );
}

#[test]
fn the_ticks_of_the_emulated_core_cannot_panic() {
    let image = program("emulated");
    let ticks = image.named(|name| name.contains("7session4tick"));
    assert_eq!(ticks.len(), 3, "one per number format");
    for tick in ticks {
        assert_panic_free(&image, &walk(&image, &[tick]), 3, 1500);
    }
}

/// The tick of the emulated servo board of two axes and of four: the simulated machine, the loops, the supervision of the host, recording and stream.
#[test]
fn the_tick_of_the_servo_board_cannot_panic() {
    /// The exception of the system timer.
    const SYSTEM_TIMER: usize = 15;
    for name in ["servo", "servo-four"] {
        let image = program(name);
        let tick = Vectors::read(&image, 0).handler(SYSTEM_TIMER);
        assert_panic_free(&image, &walk(&image, &[tick]), 5, 2500);
    }
}

/// The figures for people are in the programs of both boards, and the tick reaches none of their functions.
#[test]
fn no_tick_reaches_the_figures_for_people() {
    for (name, base, exception) in [("board", FLASH, TICK), ("servo", 0, 15), ("servo-four", 0, 15)] {
        let image = program(name);
        let is_figure = |name: &str| {
            ["7figures11square_root", "7figures9logarithm", "7figures9phase_deg", "micromath"]
                .iter()
                .any(|function| name.contains(function))
        };
        // The functions that the compiler may not inline.
        assert!(image.named(is_figure).len() >= 3, "{name}: {}", image.named(is_figure).len());
        let tick = Vectors::read(&image, base).handler(exception);
        let walk = walk(&image, &[tick]);
        let reached = walk.reached.keys().flat_map(|start| &image.functions[start].names);
        let figures: Vec<&String> = reached.filter(|name| is_figure(name)).collect();
        assert!(figures.is_empty(), "{name}: {figures:?}");
    }
}

/// Machine code by hand at 0x1000: a tick with a tail call of a function that calls a panic.
#[test]
fn a_panic_behind_a_tail_call_is_found_and_data_is_not_decoded() {
    let halves: [u16; 8] = [
        0xb500, // tick: push {lr}
        0xe001, //       b.n other
        0xf7ff, 0xfffe, // data with the encoding of a call
        0xf000, 0xf800, // other: bl panic
        0xbd00, //       pop {pc}
        0xe7fe, // panic: b.n panic
    ];
    let mut image = Image::default();
    let bytes = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
    image.sections.push(Section { address: 0x1000, bytes });
    image.marks = BTreeMap::from([(0x1000, true), (0x1004, false), (0x1008, true)]);
    let mut function = |start, end, name: &str| {
        image.functions.insert(start, Function { names: vec![name.to_owned()], end });
    };
    function(0x1000, 0x1008, "tick");
    function(0x1008, 0x100c, "other");
    function(0x100c, 0x1010, "core::panicking::panic");
    let found = walk(&image, &[0x1000]);
    assert_eq!(found.panics(&image), ["tick → other → core::panicking::panic"]);
    assert_eq!(found.instructions, 5);
}
