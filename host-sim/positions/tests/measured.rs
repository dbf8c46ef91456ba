//! The measured axis of `LOST_MOTION_DATA`, if that is set.

use positions::columns::Request;
use positions::effects::Feedback;
use positions::measured::Test;
use positions::{Options, analyse, readings, text};

#[test]
fn scratch() {
    let Some(root) = std::env::var_os("LOST_MOTION_DATA") else { return };
    let path = std::path::Path::new(&root).join("data/positioning/x.csv");
    let all = std::fs::read_to_string(path).unwrap();
    let runs = |is: &dyn Fn(&str) -> bool| -> Test {
        let lines: Vec<&str> =
            all.lines().enumerate().filter(|(i, line)| *i == 0 || is(&line[..1])).map(|(_, l)| l).collect();
        readings::of_text(&lines.join("\n"), "x.csv", &Request::default(), Vec::new()).unwrap()
    };
    let options = Options { axis: "x".to_owned(), feedback: Feedback::Motor };
    for split in ["123/45", "12345/", "234/5", "1234/5", "12/3", "345/12", "1/2", "12/345"] {
        let (a, b) = split.split_once('/').unwrap();
        let validate = if b.is_empty() { vec![] } else { vec![runs(&|r| b.contains(r))] };
        let start = std::time::Instant::now();
        let analysis = analyse(runs(&|r| a.contains(r)), validate, &options).unwrap();
        println!(
            "==== {split} {:?} {:?} {:?}\n{}",
            start.elapsed(),
            analysis.fit.variant,
            analysis.grid.course,
            text::of(&analysis)
        );
    }
}
