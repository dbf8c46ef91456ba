//! The worked example of `docs/compensation.md`: its commands are run, and what it shows of their output is compared. `BLESS=1`
//! writes the outputs again.

use std::fs;
use std::path::{Path, PathBuf};

use super::work_folder::{MACHINE, WorkFolder};

/// Motions of the example.
const MOTIONS: [&str; 4] = ["demo_circle", "demo_travel", "demo_ballbar", "demo_corner"];

/// A part of the example: text, or a fenced block with its language.
struct Part<'a> {
    language: Option<&'a str>,
    text: &'a str,
}

fn document() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("docs").join("compensation.md")
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
    let same = |(a, b): (&String, &String)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 0.02 + 0.05 * b.abs(),
        _ => a == b,
    };
    found.len() == shown.len() && found.iter().zip(&shown).all(same)
}

#[test]
fn the_example_shows_what_its_commands_print() {
    let text = fs::read_to_string(document()).unwrap();
    let (head, example) = text.split_once("## Worked example\n").unwrap();
    let folder = WorkFolder::with(&[("true.toml", MACHINE)]);
    for sub in ["machines", "motions"] {
        fs::create_dir_all(folder.path().join("host-sim").join(sub)).unwrap();
    }
    fs::write(folder.path().join("host-sim/machines/demo.toml"), MACHINE).unwrap();
    let motions = Path::new(env!("CARGO_MANIFEST_DIR")).with_file_name("host-sim").join("motions");
    for motion in MOTIONS {
        let name = format!("{motion}.toml");
        fs::copy(motions.join(&name), folder.path().join("host-sim/motions").join(&name)).unwrap();
    }
    let (mut written, mut stdout, mut commands) = (String::new(), String::new(), 0);
    for part in parts(example) {
        let Some(language) = part.language else {
            written += part.text;
            continue;
        };
        let mut shown = part.text.to_owned();
        match language {
            "toml" => fs::write(folder.path().join("true.toml"), format!("{MACHINE}\n{shown}")).unwrap(),
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
                assert!(is_same(&found, &shown), "found:\n{found}\nin docs/compensation.md:\n{shown}");
            }
        }
        written += &format!("```{language}\n{shown}```");
    }
    assert!(commands >= 8, "{commands}");
    if std::env::var_os("BLESS").is_some() {
        fs::write(document(), format!("{head}## Worked example\n{written}")).unwrap();
    }
}

/// The output without blanks at the ends of its lines.
fn trimmed(stdout: &str) -> String {
    stdout.lines().fold(String::new(), |text, line| text + line.trim_end() + "\n")
}
