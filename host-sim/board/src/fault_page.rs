//! The table of faults in `docs/safety.md`: names, messages and reactions are those of the code. What triggers a fault, and the test that
//! shows it, are written by hand. `BLESS=1` rewrites the first ones, and adds a row for a new fault.

use std::fs;
use std::path::Path;

use shared::safety::{Fault, FaultKind, Reaction};

use super::refusal;

const HEADING: &str = "## 7. Faults";
const HEAD: &str = "| fault | message | of | reaction | triggered by | test |\n|---|---|---|---|---|---|\n";

/// The columns of the code: name, message, what it is a fault of, reaction.
fn of_code() -> Vec<[String; 4]> {
    let axes = FaultKind::ALL.map(|kind| Fault::Axis { axis: 0, kind });
    let row = |fault: Fault| {
        let (name, of) = match fault {
            Fault::Axis { kind, .. } => (format!("{kind:?}"), "an axis"),
            other => (format!("{other:?}"), "the machine"),
        };
        let message = refusal::fault(fault);
        let reaction = match fault.reaction() {
            Reaction::DriveOff => "drives off",
            Reaction::Stop => "stop along the path, then drives off",
            Reaction::Warn => "warning",
        };
        let message = message.strip_prefix("x: ").unwrap_or(&message).to_owned();
        [format!("`{name}`"), message, of.to_owned(), reaction.to_owned()]
    };
    axes.into_iter().chain(Fault::OF_THE_MACHINE).map(row).collect()
}

fn cells(line: &str) -> Vec<&str> {
    line.trim_matches('|').split('|').map(str::trim).collect()
}

/// The table with the columns of the code, and those by hand from the lines of a page.
fn table(page: &str) -> String {
    let rows = of_code().into_iter().map(|row| {
        let shown = page.lines().map(cells).find(|cells| cells.len() == 6 && cells[0] == row[0]);
        let by_hand = shown.map_or(["", ""], |cells| [cells[4], cells[5]]);
        format!("| {} | {} |\n", row.join(" | "), by_hand.join(" | "))
    });
    HEAD.to_owned() + &rows.collect::<String>()
}

/// A test of a cell, as `file` and name of the function: `` `file`: `name` ``.
fn test_of(cell: &str) -> (&str, &str) {
    let mut words = cell.split('`').skip(1).step_by(2);
    (words.next().unwrap_or_default(), words.next().unwrap_or_default())
}

#[test]
fn the_page_has_each_fault_with_its_message_and_reaction() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let path = root.join("docs/safety.md");
    let page = fs::read_to_string(&path).unwrap();
    let (before, section) = page.split_once(HEADING).expect("a section of the faults");
    let start = section.find("| fault |").expect("a table");
    let length = section[start..].find("\n\n").map_or(section.len() - start, |end| end + 1);
    let (shown, wanted) = (&section[start..start + length], table(section));
    if std::env::var_os("BLESS").is_some() {
        let section = section.replace(shown, &wanted);
        fs::write(&path, format!("{before}{HEADING}{section}")).unwrap();
        return;
    }
    assert_eq!(shown, wanted, "docs/safety.md: BLESS=1 rewrites the columns of the code");
    for cells in shown.lines().skip(2).map(cells) {
        assert!(!cells[4].is_empty(), "what triggers {}", cells[0]);
        let (file, name) = test_of(cells[5]);
        let text = fs::read_to_string(root.join(file)).unwrap_or_default();
        assert!(text.contains(&format!("fn {name}(")), "{}: no test {name} in {file}", cells[0]);
    }
}
