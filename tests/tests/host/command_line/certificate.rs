//! The page of a trace as a certificate: limits, circumstances, and what is refused.

use serde_json::Value;

use super::work_folder::{MACHINE, MOTION, SIMULATE, WorkFolder, log};

fn folder() -> WorkFolder {
    WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", MOTION), ("fit.csv", log())])
}

const TRACE: &str = "trace --machine machine.toml --fit fit.csv --json out.json --report report";

/// Greatest contour error of the log at the tool, µm, and the limits of the JSON.
fn judged(folder: &WorkFolder) -> (f64, Vec<Value>) {
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    let greatest_um = json["contour"][0]["max_um"].as_f64().unwrap();
    assert_eq!(json["contour"][0]["channel"], "tool");
    (greatest_um, json["limits"].as_array().unwrap().clone())
}

#[test]
fn limits_are_judged_by_the_tool_in_text_json_and_page() {
    let folder = folder();
    folder.succeeds(TRACE);
    let (greatest_um, limits) = judged(&folder);
    assert!(limits.is_empty() && !folder.read("report/report.html").contains("<h2>Limits"));
    // Twice and half of the greatest error: noise makes no such difference. The log has no full circle: the budget predicts its G.
    let command = format!(
        "{TRACE} --limit greatest={} --limit greatest={} --limit G=1000",
        2.0 * greatest_um,
        0.5 * greatest_um
    );
    let stdout = folder.succeeds(&command);
    let (_, limits) = judged(&folder);
    let of = |key: &str| limits.iter().map(|limit| limit[key].clone()).collect::<Vec<_>>();
    assert_eq!(of("name"), ["greatest", "greatest", "G"]);
    assert_eq!(of("result")[..2], ["pass", "fail"]);
    assert_eq!(of("basis"), ["measured", "measured", "predicted"]);
    for limit in &limits[..2] {
        assert!((limit["value_um"].as_f64().unwrap() - greatest_um).abs() < 1e-9, "{limit}");
    }
    let page = folder.read("report/report.html");
    for (limit, line) in limits.iter().zip(stdout.lines().filter(|line| line.starts_with("Limit "))) {
        let result = limit["result"].as_str().unwrap();
        assert!(line.contains(&format!(": {result}; ")), "{line}");
        assert!(page.contains(&format!("<td class=\"result\">{result}</td>")), "{result}");
    }
    assert_eq!(stdout.lines().filter(|line| line.starts_with("Limit ")).count(), 3, "{stdout}");
    assert!(page.contains("beyond the limit: greatest"), "the verdict has it");
}

#[test]
fn a_check_fails_if_a_limit_is_not_known_to_be_kept() {
    let folder = folder();
    folder.succeeds(&format!("{TRACE} --limit greatest=1000 --check"));
    // Without --check, a limit that is not kept is a result as any other.
    folder.succeeds(&format!("{TRACE} --limit greatest=0.001"));
    let message = folder.fails(&format!("{TRACE} --limit greatest=0.001 --limit rms=1000 --check"), 1);
    assert!(message.contains("greatest (fail)") && !message.contains("rms"), "{message}");
    assert_eq!(judged(&folder).1.len(), 2, "the outputs are written");
}

#[test]
fn a_log_without_the_tool_passes_nothing_by_prediction() {
    let folder = folder();
    // Without both columns of the tool.
    let names: Vec<&str> = log().lines().next().unwrap().split(',').collect();
    let kept = |line: &str| {
        let fields = line.split(',').zip(&names).filter(|(_, name)| !name.contains("_tool_"));
        fields.map(|(field, _)| field).collect::<Vec<_>>().join(",") + "\n"
    };
    let without: String = log().lines().map(kept).collect();
    std::fs::write(folder.path().join("fit.csv"), without).unwrap();
    let message = folder.fails(&format!("{TRACE} --limit G=1000 --check"), 1);
    assert!(message.contains("G (unknown)"), "{message}");
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    assert!(json["limits"][0]["why"].as_str().unwrap().contains("were not measured"), "{json}");
}

#[test]
fn the_page_names_its_circumstances_and_is_the_same_again() {
    let folder = folder();
    let command = format!("{TRACE} --serial SN-4711 --operator Smith --date 2026-11-27");
    let mut pages = [(); 2].map(|()| {
        folder.succeeds(&command);
        folder.read("report/report.html")
    });
    assert!(pages[0] == pages[1], "the same input gives the same bytes");
    let page = std::mem::take(&mut pages[0]);
    for told in ["SN-4711", "Smith", "2026-11-27", "fit.csv", &format!("lost-motion {command}")] {
        assert!(page.contains(&format!("<td>{told}</td>")), "{told}");
    }
    assert!(page.len() < 1_000_000, "{}", page.len());
    folder.succeeds(&format!("{TRACE} --date today"));
    let page = folder.read("report/report.html");
    let (_, rest) = page.split_once("<th scope=\"row\">date</th><td>").unwrap();
    let date: Vec<&str> = rest.split_once('<').unwrap().0.split('-').collect();
    assert_eq!(date.iter().map(|part| part.len()).collect::<Vec<_>>(), [4, 2, 2]);
}

#[test]
fn bad_limits_and_dates_are_refused_in_one_line() {
    let folder = folder();
    for (arguments, expected) in [
        ("--limit H=8", "expected NAME=µm, with NAME one of G, rms, greatest, corner"),
        ("--limit G=eight", "a number of µm above 0"),
        ("--limit G=-8", "a number of µm above 0"),
        ("--date 27.11.2026", "expected a date, as 2026-11-27, or today"),
        ("--check", "--limit"),
    ] {
        let message = folder.fails(&format!("{TRACE} {arguments}"), 2);
        assert!(message.contains(expected) && message.lines().count() == 1, "{arguments}: {message}");
    }
    let message = folder.fails("trace --machine machine.toml --fit fit.csv --serial 1", 2);
    assert!(message.contains("--report"), "{message}");
}

#[test]
fn limits_after_a_change_are_judged_by_the_log_after_it() {
    let folder = folder();
    // Another run of the motion: the same with other noise.
    folder.succeeds(&format!("{} --seed 7", SIMULATE.replace("out.csv", "after.csv")));
    let verify =
        "verify --machine machine.toml --before fit.csv --after after.csv --json out.json --report report";
    folder.succeeds(&format!("{verify} --limit greatest=1000 --check"));
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    let limit = &json["limits"][0];
    assert_eq!(
        (&limit["result"], &limit["basis"], &limit["of"]),
        (&"pass".into(), &"measured".into(), &"after".into())
    );
    let after_um = &json["motions"][0]["contour_error_um"]["after"]["max"];
    assert!((limit["value_um"].as_f64().unwrap() - after_um.as_f64().unwrap()).abs() < 1e-9, "{json}");
    assert!(folder.read("report/report.html").contains("<td class=\"result\">pass</td>"));
    let message = folder.fails(&format!("{verify} --limit G=1000 --check"), 1);
    assert!(message.contains("G (unknown)"), "without a full circle: {message}");
}

#[test]
fn shells_and_manuals_know_every_verb() {
    let folder = folder();
    let overview = folder.succeeds("--help");
    let verbs: Vec<&str> =
        overview.lines().filter_map(|line| line.strip_prefix("  ")?.split(' ').next()).collect();
    let is_verb =
        |verb: &&str| verb.starts_with(char::is_lowercase) && !["help", "lost-motion"].contains(verb);
    let verbs: Vec<&str> = verbs.into_iter().filter(is_verb).collect();
    assert!(verbs.len() > 20, "{overview}");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = folder.succeeds(&format!("completions {shell}"));
        assert!(verbs.iter().all(|verb| script.contains(verb)) && script.contains("limit"), "{shell}");
    }
    folder.succeeds("man --out-dir pages");
    for verb in &verbs {
        assert!(folder.read(&format!("pages/lost-motion-{verb}.1")).contains(".TH"), "{verb}");
    }
    assert!(folder.read("pages/lost-motion.1").contains("SUBCOMMANDS"));
    assert!(folder.fails("completions tcsh", 2).contains("bash"));
}
