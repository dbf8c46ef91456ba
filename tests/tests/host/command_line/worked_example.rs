//! Worked examples of documents: their commands are run, and what they show of the output is compared. `BLESS=1` writes the outputs
//! again.

use std::fs;
use std::path::{Path, PathBuf};

use super::work_folder::{MACHINE, WorkFolder};

/// A part of the example: text, or a fenced block with its language.
struct Part<'a> {
    language: Option<&'a str>,
    text: &'a str,
}

/// An example of a page, which has its machine and motions in the folders of the repository.
struct Example {
    /// Page in the folder `docs`.
    page: &'static str,
    /// The heading before the example.
    heading: &'static str,
    /// The heading after it; none if it is the end of the page.
    until: Option<&'static str>,
    /// The machine file that is declared, by its path and with its text.
    machine: [&'static str; 2],
    /// The file of the machine that is run: the declared one with the blocks of TOML that the example shows.
    true_machine: &'static str,
    motions: &'static [&'static str],
    min_commands: usize,
}

fn document(page: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs").join(page)
}

/// The parts of the text after the heading.
fn parts(example: &str) -> Vec<Part<'_>> {
    let fenced = |text| {
        let (language, text): (&str, &str) = str::split_once(text, '\n').unwrap();
        Part { language: Some(language), text }
    };
    let split = example.split("```").enumerate();
    split
        .map(|(index, text)| if index % 2 == 1 { fenced(text) } else { Part { language: None, text } })
        .collect()
}

/// Words are equal; numbers within 5 % or 0.02, for other processors.
fn is_same(found: &str, shown: &str) -> bool {
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let (found, shown) = (words(found), words(shown));
    let number = |word: &str| word.replace('−', "-").parse::<f64>();
    let same = |(a, b): (&String, &String)| match (number(a), number(b)) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 0.02 + 0.05 * b.abs(),
        _ => a == b,
    };
    found.len() == shown.len() && found.iter().zip(&shown).all(same)
}

impl Example {
    fn folder(&self) -> WorkFolder {
        let [machine, text] = self.machine;
        let folder = WorkFolder::with(&[(self.true_machine, text)]);
        for sub in ["machines", "motions"] {
            fs::create_dir_all(folder.path().join("host-sim").join(sub)).unwrap();
        }
        fs::write(folder.path().join(machine), text).unwrap();
        let motions = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("host-sim").join("motions");
        for motion in self.motions {
            let name = format!("{motion}.toml");
            fs::copy(motions.join(&name), folder.path().join("host-sim/motions").join(&name)).unwrap();
        }
        folder
    }

    fn check(&self) {
        let page = document(self.page);
        let text = fs::read_to_string(&page).unwrap();
        let heading = format!("## {}\n", self.heading);
        let (head, rest) = text.split_once(&heading).unwrap();
        let end = self.until.map_or(rest.len(), |next| rest.find(&format!("\n## {next}\n")).unwrap());
        let (example, tail) = rest.split_at(end);
        let folder = self.folder();
        let (mut written, mut stdout, mut commands) = (String::new(), String::new(), 0);
        for part in parts(example) {
            let Some(language) = part.language else {
                written += part.text;
                continue;
            };
            let mut shown = part.text.to_owned();
            match language {
                "toml" => {
                    let machine = format!("{}\n{shown}", self.machine[1]);
                    fs::write(folder.path().join(self.true_machine), machine).unwrap();
                }
                "sh" => {
                    let joined = shown.replace("\\\n", " ");
                    for command in joined.lines() {
                        stdout = folder.succeeds(command.strip_prefix("lost-motion ").unwrap());
                        commands += 1;
                    }
                }
                _ if std::env::var_os("BLESS").is_some() => shown = trimmed(&stdout),
                _ => {
                    let found = trimmed(&stdout);
                    assert!(is_same(&found, &shown), "found:\n{found}\nin {}:\n{shown}", self.page);
                }
            }
            written += &format!("```{language}\n{shown}```");
        }
        assert!(commands >= self.min_commands, "{commands}");
        if std::env::var_os("BLESS").is_some() {
            fs::write(page, format!("{head}{heading}{written}{tail}")).unwrap();
        }
    }
}

#[test]
fn the_example_of_a_compensation() {
    let example = Example {
        page: "compensation.md",
        heading: "Worked example",
        until: None,
        machine: ["host-sim/machines/demo.toml", MACHINE],
        true_machine: "true.toml",
        motions: &["demo_circle", "demo_travel", "demo_ballbar", "demo_corner"],
        min_commands: 8,
    };
    example.check();
}

#[test]
fn the_example_of_your_own_log() {
    let example = Example {
        page: "your-log.md",
        heading: "Try it on a simulated machine",
        until: None,
        machine: ["host-sim/machines/vmc.toml", include_str!("../../../../host-sim/machines/vmc.toml")],
        true_machine: "worn.toml",
        motions: &["pocket", "circle"],
        min_commands: 6,
    };
    example.check();
}

#[test]
fn the_example_of_a_circle() {
    let example = Example {
        page: "circle.md",
        heading: "A run",
        until: Some("What is read"),
        machine: ["host-sim/machines/demo.toml", MACHINE],
        true_machine: "unused.toml",
        motions: &["circle"],
        min_commands: 2,
    };
    example.check();
}

/// The output without blanks at the ends of its lines.
fn trimmed(stdout: &str) -> String {
    stdout.lines().fold(String::new(), |text, line| text + line.trim_end() + "\n")
}
