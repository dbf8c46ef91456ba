//! Stack and static data fit the RAM of the chip: a static analysis of the linked program.
//!
//! A stack that grows into the static data or below the RAM is not detected before the chip fails, and the emulated core has
//! more RAM than the chip. Therefore the frames of the functions are summed over all chains of calls.

use std::collections::BTreeMap;
use std::fs;

use tests::chip::depth::{Declared, Depths, Obstacle, SelfCall};
use tests::chip::image::{Function, Image, Section};
use tests::chip::vectors::{EXCEPTION_FRAME, Vectors};
use tests::chip::virtual_calls::VirtualCalls;
use tests::firmware::{DECLARED, FLASH, RAM, SETTINGS_SLOTS, TICK};

/// Bytes of the main RAM of the chip.
const RAM_BYTES: u32 = RAM.end - RAM.start;

/// Free RAM that must remain, bytes: an eighth of the RAM, because later compilers may inline differently.
const RESERVE_BYTES: u32 = RAM_BYTES / 8;

/// Greatest size of the program, bytes.
const FLASH_BUDGET_BYTES: u32 = 512 * 1024;

/// Lower bound of the tick: saved registers (r4 to r11, lr, d8 to d15) and forces and duties of two axes. A lower result
/// means that the analysis is incomplete.
const MIN_TICK_BYTES: u32 = 100;

/// The linked program, its vector table, and the bytes of its static data and of its deepest stack.
fn ram_use(program: &str, flash: u32) -> (Image, Vectors, [u32; 2]) {
    let path = tests::firmware::built(program);
    let image = Image::read(&fs::read(&path).expect("cargo has just built it"));
    let vectors = Vectors::read(&image, flash);
    let worst = vectors.worst_case(&image, &DECLARED).unwrap_or_else(|obstacles| {
        let lines: Vec<_> = obstacles.iter().map(|obstacle| obstacle.describe(&image)).collect();
        panic!("{program}: its stack depth is unknown: {lines:#?}")
    });
    let data: u32 = image.data.iter().map(|range| range.end - range.start).sum();
    println!("{program}:\n{}", worst.report(&image));
    println!(
        "{} B of stack and {data} B of static data: {} B of {RAM_BYTES} B are free, {RESERVE_BYTES} B must be",
        worst.bytes(),
        i64::from(RAM_BYTES) - i64::from(worst.bytes() + data)
    );
    let bytes = worst.bytes();
    (image, vectors, [data, bytes])
}

#[test]
fn stack_and_static_data_of_the_board_fit_its_ram() {
    let (image, vectors, [data, stack]) = ram_use("board", FLASH);
    let tick = vectors.handler(TICK);
    let tick = Depths::new(&image, &[tick], &Declared::NONE).expect("known above").below(tick);
    assert!(tick.bytes() >= MIN_TICK_BYTES, "a tick of {} B", tick.bytes());
    assert!(stack >= tick.bytes() + EXCEPTION_FRAME);
    assert!(data + stack + RESERVE_BYTES <= RAM_BYTES, "{data} B of static data, {stack} B of stack");
    // Both are within the RAM: the stack grows down from its start to the static data below it, or to the end of the
    // RAM.
    let inside = RAM.start..=RAM.end;
    assert!(image.data.iter().all(|range| inside.contains(&range.start) && inside.contains(&range.end)));
    assert!(inside.contains(&vectors.initial_sp));
    let floor = vectors.stack_floor(&image, &RAM);
    assert!(stack + RESERVE_BYTES <= vectors.initial_sp - floor, "{stack} B above {floor:#x}");
}

/// The program and the initial values of its data end before the sectors for the settings, and within their budget: two thirds of
/// the 768 KiB that are there, so that a growth is noticed before they are used up.
#[test]
fn the_program_of_the_board_leaves_the_sectors_for_settings_alone() {
    let file = fs::read(tests::firmware::built("board")).expect("cargo has just built it");
    let elf =
        object::read::elf::ElfFile32::<object::Endianness>::parse(file.as_slice()).expect("an ELF file");
    let end = object::Object::segments(&elf)
        .map(|segment| segment.elf_program_header())
        .map(|header| {
            use object::read::elf::ProgramHeader;
            let endian = object::Endianness::Little;
            (header.p_paddr(endian), header.p_filesz(endian))
        })
        // What is in flash has bytes in the file; memory without initial values has none.
        .filter(|(_, bytes)| *bytes > 0)
        .map(|(start, bytes)| start + bytes)
        .max()
        .expect("a segment");
    println!("{} B of flash", end - FLASH);
    assert!(end - FLASH > 64 * 1024, "less than the controller alone");
    assert!(end - FLASH <= FLASH_BUDGET_BYTES && SETTINGS_SLOTS[0] >= end, "{end:#x}");
}

/// The tests on the emulated core replace tests on the board, so its program must fit the same RAM.
#[test]
fn stack_and_static_data_of_the_emulated_core_fit_the_same_ram() {
    let (_, _, [data, stack]) = ram_use("emulated", 0);
    assert!(data + stack + RESERVE_BYTES <= RAM_BYTES, "{data} B of static data, {stack} B of stack");
}

/// The emulated servo board has the memory of its linker script. The chip of the board has 192 KiB in both banks, which a recording
/// of half a second and the conversion of a compensation on the stack exceed together.
#[test]
fn stack_and_static_data_of_the_servo_board_fit_its_memory() {
    const SERVO_RAM: u32 = 256 * 1024;
    let (_, _, [data, stack]) = ram_use("servo", 0);
    assert!(data + stack + RESERVE_BYTES <= SERVO_RAM, "{data} B of static data, {stack} B of stack");
}

/// A program by hand at 0x1000, with a function for each slice of halfwords.
fn by_hand(functions: &[&[u16]]) -> Image {
    let mut image = Image { marks: BTreeMap::from([(0x1000, true)]), ..Image::default() };
    let mut bytes = Vec::new();
    for (number, halves) in functions.iter().enumerate() {
        let start = 0x1000 + u32::try_from(bytes.len()).expect("a few bytes");
        bytes.extend(halves.iter().flat_map(|half| half.to_le_bytes()));
        let end = 0x1000 + u32::try_from(bytes.len()).expect("a few bytes");
        image.functions.insert(start, Function { names: vec![format!("f{number}")], end });
    }
    image.sections.push(Section { address: 0x1000, bytes });
    image
}

/// Bytes below the first function.
fn depth(functions: &[&[u16]]) -> Result<u32, Vec<Obstacle>> {
    Depths::new(&by_hand(functions), &[0x1000], &Declared::NONE).map(|depths| depths.below(0x1000).bytes())
}

const LEAF: &[u16] = &[0x4770]; // bx lr

#[test]
fn frames_are_summed_along_the_deepest_chain() {
    let outer: &[u16] = &[
        0xb5f0, //         push {r4-r7, lr}: 20
        0xf5ad, 0x3db1, // sub.w sp, sp, #90624
        0xf000, 0xf805, // bl f1
        0xf000, 0xf805, // bl f2
        0xf50d, 0x3db1, // add.w sp, sp, #90624
        0xbdf0, //         pop {r4-r7, pc}
    ];
    let shallow: &[u16] = &[0xb510, 0xbd10]; // push and pop of 8
    let deep: &[u16] = &[
        0xed2d, 0x8b04, // vpush {d8, d9}: 16
        0xf249, 0x4440, // movw r4, #0x9440: 37,952
        0xf2c0, 0x0401, // movt r4, #1: 65,536 more
        0xebad, 0x0d04, // sub.w sp, sp, r4
        0x4770, //         bx lr
    ];
    assert_eq!(depth(&[outer, shallow, deep]), Ok(20 + 90_624 + 16 + 65_536 + 0x9440));
    // Without the call of the deepest function.
    let mut without = outer.to_vec();
    without[5..7].copy_from_slice(&[0xbf00, 0xbf00]);
    assert_eq!(depth(&[&without, shallow, deep]), Ok(20 + 90_624 + 8));
}

#[test]
fn every_obstacle_is_reported() {
    let unknown = |functions: &[&[u16]]| depth(functions).expect_err("unknown");
    // blx r3
    assert_eq!(unknown(&[&[0x4798, 0x4770]]), [Obstacle::Indirect(0x1000)]);
    // b.n to an address after the last function
    assert_eq!(unknown(&[&[0xe07e]]), [Obstacle::NoFunction(0x1000)]);
    // mov sp, r7
    assert_eq!(unknown(&[&[0xbf00, 0x46bd, 0x4770]]), [Obstacle::Unknown(0x1002)]);
    // sub.w sp, sp, r4 without a constant in r4
    assert_eq!(unknown(&[&[0xbf00, 0xebad, 0x0d04]]), [Obstacle::Unknown(0x1002)]);
    // push {r0}, and a branch back to it
    assert_eq!(unknown(&[&[0xbf00, 0xb401, 0xd1fd, 0x4770]]), [Obstacle::Looped(0x1002)]);
    // bl to itself
    assert_eq!(unknown(&[&[0xf7ff, 0xfffe, 0x4770]]), [Obstacle::Recursion(vec![0x1000])]);
    // The same with a limit of three frames: push {r4-r7, lr} and bl.
    let image = by_hand(&[&[0xb5f0, 0xf7ff, 0xfffd, 0xbdf0]]);
    let twice_more = [SelfCall { name: "f0", frames: 3 }];
    let declared = Declared { self_calls: &twice_more, ..Declared::NONE };
    let three = Depths::new(&image, &[0x1000], &declared).expect("an end");
    assert_eq!(three.below(0x1000).bytes(), 3 * 20);
    // f0 calls f1, which calls f0, and a leaf outside of the recursion
    let ring: [&[u16]; 3] = [&[0xf000, 0xf800], &[0xf7ff, 0xfffc, 0xf000, 0xf800], LEAF];
    assert_eq!(unknown(&ring), [Obstacle::Recursion(vec![0x1000, 0x1004])]);
}

/// A call through a register in a function that calls a trait object: the deepest of its methods counts, and a table that is too short
/// for the trait does not.
#[test]
fn methods_of_a_trait_object_are_called_through_its_table() {
    let caller: &[u16] = &[0xb510, 0x4798, 0xbd10]; // push of 8, blx r3, pop
    let method: &[u16] = &[0xb5f0, 0xbdf0]; // push and pop of 20
    let mut image = by_hand(&[caller, LEAF, method, LEAF]);
    // No drop; 12 bytes, aligned to 4; two methods: f1 and f2. Behind it a constant.
    let words = [0u32, 12, 4, 0x1007, 0x1009, 0x55];
    let bytes = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    image.sections.push(Section { address: 0x2000, bytes });
    let depth = |name, methods| {
        let calls = [VirtualCalls { callers: &["f0"], method: name, methods }];
        let declared = Declared { virtual_calls: &calls, ..Declared::NONE };
        Depths::new(&image, &[0x1000], &declared).map(|depths| depths.below(0x1000).bytes())
    };
    assert_eq!((depth("f1", 2), depth("f2", 2)), (Ok(8 + 20), Ok(8 + 20)));
    let unknown = Err(vec![Obstacle::Indirect(0x1002)]);
    assert_eq!((depth("f3", 2), depth("f1", 3)), (unknown.clone(), unknown.clone()));
    // Not declared for this function.
    assert_eq!(Depths::new(&image, &[0x1000], &Declared::NONE).map(|_| 0), unknown);
}

/// Nested exceptions, each with the frame that the core pushes.
#[test]
fn exceptions_are_nested_with_the_frames_of_the_core() {
    let mut image = by_hand(&[&[0xb510, 0xbd10], &[0xb5f0, 0xbdf0], LEAF]);
    let words = [0x2000_8000u32, 0x1001, 0x1009, 0x1009, 0x1009, 0x1005, 0];
    let bytes = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    image.sections.push(Section { address: 0, bytes });
    let vectors = Vectors::read(&image, 0);
    let worst = vectors.worst_case(&image, &Declared::NONE).expect("known");
    // Handlers: f1 of 20 bytes and f2 as interrupts, f2 again as hard fault and as the non-maskable one.
    assert_eq!((vectors.initial_sp, vectors.exceptions().len()), (0x2000_8000, 2));
    assert_eq!(worst.bytes(), 8 + 20 + 4 * EXCEPTION_FRAME);
}
