//! What a tick costs on the emulated core, part by part: `cargo cost` prints the same table.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;
use std::process::Command;

/// A line of the table: part, format, median, worst.
type Row = (String, String, u32, u32);

fn table() -> Vec<Row> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let output =
        Command::new(env!("CARGO")).args(["cost", "--quiet"]).current_dir(workspace).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    print!("{text}");
    text.lines().filter_map(row).collect()
}

/// The last four columns are one word each; the head has no numbers there.
fn row(line: &str) -> Option<Row> {
    let mut words = line.split_whitespace().rev();
    let _ratio = words.next()?;
    let (worst, median, format) = (words.next()?.parse().ok()?, words.next()?.parse().ok()?, words.next()?);
    let mut part: Vec<&str> = words.collect();
    part.reverse();
    Some((part.join(" "), format.into(), median, worst))
}

fn cost(table: &[Row], part: &str, format: &str) -> (u32, u32) {
    let row = table.iter().find(|row| row.0 == part && row.1 == format);
    let &(_, _, median, worst) = row.unwrap_or_else(|| panic!("no {part} in {format}"));
    (median, worst)
}

#[test]
fn a_tick_costs_what_it_is_made_of_and_no_more() {
    let table = table();
    for (format, most) in [("fixed", 2900), ("f32", 3400), ("f64", 28_000)] {
        let (median, worst) = cost(&table, "tick of two axes, all on", format);
        // Of two axes, each runs its loops and filters, and the path its cheapest geometry.
        let of = |part| cost(&table, part, format).0;
        let axis = of("position loop of an axis") + of("PI") + of("notch") + of("low-pass");
        let parts = 2 * axis + of("compensation of two axes") + cost(&table, "path, a line", "all").0;
        // The compiler may join what is one function there: a tenth.
        assert!(10 * median > 9 * parts, "{format}: {median} in all, {parts} in parts");
        assert!(median <= most, "{format}: {median} instructions, expected {most} at most");
        // The worst is a tick in which a block ends.
        assert!(10 * worst <= 14 * median, "{format}: {worst} at worst, {median} as a rule");
    }
}

/// What takes no branch costs the same in every tick: a count that wandered would not be one of instructions.
#[test]
fn fixed_point_laws_cost_the_same_every_tick() {
    let table = table();
    for part in ["P", "HPC", "feed-forward", "dual feedback"] {
        let (median, worst) = cost(&table, part, "fixed");
        assert!(median > 0 && median == worst, "{part}: {median} to {worst}");
    }
}
