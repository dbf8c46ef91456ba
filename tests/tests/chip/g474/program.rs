//! The program that would be flashed: its size, its stack, what can panic in it, and where in the flash it is.

use std::collections::BTreeSet;
use std::fs;

use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Endianness, Object};
use tests::chip::depth::{Declared, Depths};
use tests::chip::image::Image;
use tests::chip::vectors::{EXCEPTION_FRAME, Vectors};
use tests::chip::walk::{Walk, walk};
use tests::firmware::{DECLARED, FLASH, RAM, SERIAL, TICK, built};

/// RM0440, chapter 3: the end of the first bank, and the slots of the settings.
const SECOND_BANK: u32 = FLASH + 256 * 1024;
const SLOTS: u32 = FLASH + 384 * 1024;

/// Greatest size of what is executed from the first bank, bytes: 15/16 of it, so that a growth is noticed before it is full.
const BUDGET_BYTES: u32 = 240 * 1024;

/// Greatest size of the program with the initial values of its data, of the 384 KiB before the settings.
const WHOLE_BUDGET_BYTES: u32 = 360 * 1024;

/// Free RAM that must remain, bytes. SRAM1, SRAM2 and the alias of the core-coupled memory have as much as the main RAM of an STM32F405, and are one
/// range, too; but queues of CAN and the recording are in it, so that less is left than there.
const RESERVE_BYTES: u32 = (RAM.end - RAM.start) * 3 / 32;

/// Exception number of CAN: interrupt 21.
const CAN: usize = 16 + 21;

fn program() -> (Image, Vectors) {
    let image = Image::read(&fs::read(built("board-g474")).unwrap());
    let vectors = Vectors::read(&image, FLASH);
    (image, vectors)
}

fn assert_panic_free(image: &Image, walk: &Walk) {
    assert_eq!(walk.panics(image), Vec::<String>::new());
    assert!(walk.traps.is_empty(), "traps at {:x?}", walk.traps);
    assert!(walk.indirect.is_empty(), "calls with unknown targets at {:x?}", walk.indirect);
    assert!(walk.without_function.is_empty(), "no function at {:x?}", walk.without_function);
}

/// Neither the tick nor the interrupts of the ports; and the start, which can, is found.
#[test]
fn the_interrupts_cannot_panic() {
    let (image, vectors) = program();
    for (exception, instructions) in [(TICK, 1500), (SERIAL, 30), (CAN, 60)] {
        let walk = walk(&image, &[vectors.handler(exception)]);
        assert_panic_free(&image, &walk);
        println!("{exception}: {} functions, {} instructions", walk.reached.len(), walk.instructions);
        assert!(walk.instructions >= instructions, "{exception}: {} instructions", walk.instructions);
    }
    let start = walk(&image, &image.named(|name| name == "Reset"));
    assert!(start.panics(&image).iter().any(|chain| chain.contains("panicking")));
}

#[test]
fn stack_and_static_data_fit_the_ram() {
    let (image, vectors) = program();
    let worst = vectors.worst_case(&image, &DECLARED).unwrap_or_else(|obstacles| {
        let lines: Vec<_> = obstacles.iter().map(|obstacle| obstacle.describe(&image)).collect();
        panic!("its stack depth is unknown: {lines:#?}")
    });
    let data: u32 = image.data.iter().map(|range| range.end - range.start).sum();
    let stack = worst.bytes();
    println!("{}\n{stack} B of stack, {data} B of static data", worst.report(&image));
    let tick = vectors.handler(TICK);
    let tick = Depths::new(&image, &[tick], &Declared::NONE).unwrap().below(tick).bytes();
    assert!(tick >= 100 && stack >= tick + EXCEPTION_FRAME);
    let inside = RAM.start..=RAM.end;
    assert!(image.data.iter().all(|range| inside.contains(&range.start) && inside.contains(&range.end)));
    let floor = vectors.stack_floor(&image, &RAM);
    let free = vectors.initial_sp - floor;
    assert!(inside.contains(&vectors.initial_sp) && stack + RESERVE_BYTES <= free, "{stack} B of {free} B");
}

/// What lies where in the flash: address, bytes in the file, and whether it is executed or read there.
fn segments() -> Vec<(u32, u32, bool)> {
    let file = fs::read(built("board-g474")).unwrap();
    let elf = ElfFile32::<Endianness>::parse(file.as_slice()).unwrap();
    let endian = Endianness::Little;
    elf.segments()
        .map(|segment| segment.elf_program_header())
        .map(|header| (header.p_paddr(endian), header.p_filesz(endian), header.p_vaddr(endian)))
        .filter(|(_, bytes, _)| *bytes > 0)
        .map(|(at, bytes, runs_at)| (at, bytes, at == runs_at))
        .collect()
}

#[test]
fn the_program_is_within_its_budgets_and_before_the_settings() {
    let segments = segments();
    let first: u32 = segments
        .iter()
        .filter(|(at, _, in_place)| *in_place && *at < SECOND_BANK)
        .map(|(_, bytes, _)| bytes)
        .sum();
    let whole: u32 = segments.iter().map(|(_, bytes, _)| bytes).sum();
    println!("{first} B in the first bank, {whole} B in all");
    assert!(first > 64 * 1024, "less than the controller alone");
    assert!(first <= BUDGET_BYTES && whole <= WHOLE_BUDGET_BYTES, "{first} B and {whole} B");
    assert!(segments.iter().all(|(at, bytes, _)| at + bytes <= SLOTS));
    // What is read where it lies is in one of the banks, not across both.
    assert!(
        segments
            .iter()
            .all(|(at, bytes, in_place)| { !in_place || *at >= SECOND_BANK || at + bytes <= SECOND_BANK })
    );
    // All constants are in the first bank, whatever reads them: beyond it are functions of the start and of uploads, and initial values.
    let beyond: Vec<_> =
        segments.iter().filter(|(at, _, in_place)| *in_place && *at >= SECOND_BANK).collect();
    assert_eq!(beyond.len(), 1);
}

/// While a page of the settings is erased, the second bank cannot be read: no interrupt, no exception and nothing that erases or programs reaches a function there.
#[test]
fn what_runs_while_the_flash_is_erased_is_in_the_first_bank() {
    let (image, vectors) = program();
    let changes = image.named(|name| name.contains("g474..flash") || name.contains("4g4745flash"));
    assert!(!changes.is_empty(), "the functions of the flash are inlined");
    let roots: Vec<u32> = [TICK, SERIAL, CAN]
        .into_iter()
        .map(|exception| vectors.handler(exception))
        .chain(vectors.exceptions())
        .chain(changes)
        .collect();
    let reached = walk(&image, &roots).reached;
    assert!(reached.len() > 30);
    let beyond: BTreeSet<&String> = reached
        .keys()
        .filter(|at| (SECOND_BANK..SLOTS).contains(*at))
        .flat_map(|at| &image.functions[at].names)
        .collect();
    assert!(beyond.is_empty(), "{beyond:#?}");
    // The walk would find them: the start does.
    let start = walk(&image, &image.named(|name| name == "Reset")).reached;
    assert!(start.keys().any(|at| (SECOND_BANK..SLOTS).contains(at)));
}
