//! Instructions of a tick on the emulated core and of its parts: `cargo cost` and `cargo cost-four` print the same table.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use tests::tables;

/// A row of the table: part, format, median, maximum.
type Row = (String, String, u32, u32);

static TABLE: LazyLock<Vec<Row>> =
    LazyLock::new(|| ["cost", "cost-four"].into_iter().flat_map(printed).collect());

/// The rows that a program of this alias prints.
fn printed(alias: &str) -> Vec<Row> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let output =
        Command::new(env!("CARGO")).args([alias, "--quiet"]).current_dir(workspace).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    print!("{text}");
    text.lines().filter_map(row).collect()
}

/// The row of a line. Its last four columns have one word each; those of the header are not numbers.
fn row(line: &str) -> Option<Row> {
    let mut words = line.split_whitespace().rev();
    let _ratio = words.next()?;
    let (max, median, format) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?, words.next()?);
    let mut part: Vec<&str> = words.collect();
    part.reverse();
    Some((part.join(" "), format.into(), median, max))
}

fn cost(part: &str, format: &str) -> (u32, u32) {
    let row = TABLE.iter().find(|row| row.0 == part && row.1 == format);
    let &(_, _, median, max) = row.unwrap_or_else(|| panic!("no {part} in {format}"));
    (median, max)
}

#[test]
fn the_cost_of_a_tick_is_that_of_its_parts() {
    for (format, limit) in [("fixed", 2285), ("f32", 3390), ("f64", 32_700)] {
        let (median, max) = cost("tick of two axes, all on", format);
        // Two axes with their loops and filters, and the path on its cheapest shape.
        let of = |part| cost(part, format).0;
        let axis = of("position loop of an axis") + of("PI") + of("notch") + of("low-pass");
        let parts = 2 * axis + of("compensation of two axes") + cost("path, a line", "all").0;
        // The compiler may optimise across parts: 10 %.
        assert!(10 * median > 9 * parts, "{format}: {median} instructions, the parts {parts}");
        assert!(median <= limit, "{format}: {median} instructions, expected {limit} at most");
        // The maximum is a tick in which a segment of a speed ramp ends.
        assert!(100 * max <= 120 * median, "{format}: maximum {max}, median {median}");
    }
    // The set of compensations for which the aim of 1600 instructions was set, and with which it took 2668.
    let (median, max) = cost("tick, nine compensations", "fixed");
    assert!(median <= 1715 && max <= 1990 && 100 * max <= 120 * median, "{median}, {max}");
    // At a feed override the path takes longer. The worst tick is still within half of the 8400 cycles of a board, as an instruction may
    // take two of them.
    let path = |part| cost(part, "all").1;
    let (_, worst) = cost("tick of two axes, all on", "fixed");
    let at_override = worst + path("path, an arc at 150 %") - path("path, an arc");
    assert!(at_override <= 8400 / 2, "{at_override} instructions");
    // Two products on each axis are none of "all on".
    let products = cost("and two products", "fixed").1 - cost("compensation, empty", "fixed").0;
    assert!((100..=220).contains(&products), "{products} instructions");
    assert!(at_override + 2 * products <= 8400 / 2, "{at_override} and twice {products} instructions");
    let all = |format| cost("tick of two axes, all on", format).0;
    assert!(all("fixed") <= all("f32"), "fixed point {}, f32 {}", all("fixed"), all("f32"));
}

/// With the divider of the board, what depends on commands only is computed in the ticks before a position tick: none has all of it.
#[test]
fn a_tick_of_the_board_has_the_loops_or_the_path_or_the_corrections() {
    let of = |part| cost(part, "fixed");
    let path = cost("path, an arc, S-curve behind it", "all");
    for (all, position, at_once, aim) in [
        ("board, nine compensations", "board, nine, position tick", "tick, nine compensations", 1300),
        ("board, all on", "board, all, position tick", "tick of two axes, all on", 1650),
    ] {
        let (all, position, at_once) = (of(all), of(position), of(at_once));
        assert!(all.1 <= aim, "{all:?}");
        // The velocity loops and filters of both axes are in every tick; the worst tick has the end of a segment of a ramp, too.
        let velocity = 2 * (of("PI").0 + of("notch").0 + of("low-pass").0);
        assert!(10 * all.1 > 9 * (velocity + path.1), "{all:?}");
        // A position tick is the whole but path, motions and corrections, and has the loops of both axes.
        assert!(position.1 <= at_once.0 - path.0, "{position:?} of {at_once:?}");
        let loops = velocity + 2 * of("position loop of an axis").0;
        assert!(position.0 > loops, "{position:?}, the loops {loops}");
    }
}

/// Four axes cost at most twice as much as two, and their worst tick is within half of the 8400 cycles of the board's chip, as an instruction
/// may take two of them.
#[test]
fn the_tick_of_four_axes_is_within_that_of_twice_two() {
    for (four, two) in [
        ("board of four axes, all on", "board, all on"),
        ("board of four axes, position tick", "board, all, position tick"),
    ] {
        let (four, two) = (cost(four, "fixed"), cost(two, "fixed"));
        assert!(four.0 > two.0 && four.0 <= 2 * two.0 && four.1 <= 2 * two.1, "{four:?}, {two:?}");
        assert!(four.1 <= 8400 / 2, "{four:?}");
    }
}

/// Code without branches executes the same number of instructions in every tick; a difference would be an error of the count.
#[test]
fn fixed_point_laws_cost_the_same_in_every_tick() {
    for part in ["P", "HPC", "feed-forward", "dual feedback"] {
        let (median, max) = cost(part, "fixed");
        assert!(median > 0 && median == max, "{part}: {median} to {max}");
    }
}

/// Instructions do not depend on the computer: `docs/speed.md` has every row as it is printed.
#[test]
fn the_page_has_the_table() {
    let rows = tables::rows("speed.md", "| part | format | median | worst | worst/median |");
    let shown = rows.into_iter().map(|row| {
        let [part, format, median, worst, _] = row.try_into().expect("five cells");
        ([part, format], [median, worst])
    });
    let shown: BTreeMap<[String; 2], [String; 2]> = shown.collect();
    let counted = TABLE.iter().map(|(part, format, median, max)| {
        ([part.clone(), format.clone()], [median.to_string(), max.to_string()])
    });
    let counted: BTreeMap<_, _> = counted.collect();
    for (row, figures) in &counted {
        assert_eq!(shown.get(row), Some(figures), "docs/speed.md: {row:?}");
    }
    assert_eq!(shown.len(), counted.len(), "docs/speed.md has a row that is not printed");
}
