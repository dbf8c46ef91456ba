//! `lost-motion reproduce`: its tables, its JSON, its page.

use serde_json::Value;

use super::desk::Desk;

#[test]
fn the_papers_are_reproduced_said_written_and_drawn() {
    let desk = Desk::with(&[("other.txt", "")]);
    let said = desk.done("reproduce --json out.json --report report");
    let json: Value = serde_json::from_str(&desk.read("out.json")).unwrap();
    assert_eq!(json.as_object().unwrap().keys().collect::<Vec<_>>(), ["results"]);
    let results = json["results"].as_array().unwrap();
    let mut papers: Vec<&str> = Vec::new();
    for result in results {
        let keys = ["agrees", "ours", "paper", "printed", "quantity", "unit"];
        assert_eq!(result.as_object().unwrap().keys().collect::<Vec<_>>(), keys, "{result}");
        assert!(
            result["ours"].is_f64() && result["agrees"].is_boolean() && result["unit"].is_string(),
            "{result}"
        );
        let (quantity, paper) = (result["quantity"].as_str().unwrap(), result["paper"].as_str().unwrap());
        // A line of the table, with the same verdict.
        let verdict = if result["agrees"] == true { "agrees" } else { "DIFFERS" };
        let is_row = |line: &&str| line.trim_start().starts_with(quantity) && line.ends_with(verdict);
        assert!(said.lines().any(|line| is_row(&line)), "{quantity}: {verdict} in {said}");
        if papers.last() != Some(&paper) {
            papers.push(paper);
        }
        printed_bounds_hold(result);
    }
    assert_eq!(papers.len(), 4, "{papers:?}");
    let agree = results.iter().filter(|result| result["agrees"] == true).count();
    assert!(said.starts_with(&format!("{agree} of {} figures of 4 papers agree", results.len())), "{said}");
    let page = desk.read("report/report.html");
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    assert!(page.matches("<svg").count() >= 4, "a picture for each paper");
    assert!(!page.contains("http") && !page.contains("<script") && !page.contains("NaN"));
}

/// Where a bound is printed, the verdict is arithmetic; where a number is, it lies near it.
fn printed_bounds_hold(result: &Value) {
    let (ours, agrees) = (result["ours"].as_f64().unwrap(), result["agrees"] == true);
    let Some(words) = result["printed"].as_str() else {
        let printed = result["printed"].as_f64().unwrap();
        assert!(!agrees || (ours - printed).abs() < 0.12 * printed.abs(), "{result}");
        return;
    };
    let number = |text: &str| -> f64 { text.trim().parse().unwrap() };
    let holds = match (words.strip_prefix('<'), words.strip_prefix('>'), words.split_once(" to ")) {
        (Some(most), ..) => ours < number(most),
        (_, Some(least), _) => ours > number(least),
        (.., Some((least, most))) => number(least) <= ours && ours <= number(most),
        _ => panic!("{result}"),
    };
    assert_eq!(holds, agrees, "{result}");
}

#[test]
fn what_cannot_be_written_is_named() {
    let desk = Desk::with(&[("file", "")]);
    let before = desk.content();
    let said = desk.fails("reproduce --json nowhere/out.json", 1);
    assert!(said.contains("nowhere/out.json: not written: there is no folder"), "{said}");
    let said = desk.fails("reproduce --report file", 1);
    assert!(said.contains("file"), "{said}");
    assert!(desk.content() == before);
}
