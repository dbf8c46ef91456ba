//! `lost-motion reproduce`: tables, JSON, page.

use serde_json::Value;

use super::work_folder::WorkFolder;
use tests::tables::{rows, shows};

#[test]
fn tables_json_and_page_have_every_paper() {
    let folder = WorkFolder::with(&[("other.txt", "")]);
    let stdout = folder.succeeds("reproduce --json out.json --report report");
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
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
        // The table has a line with the same verdict.
        let verdict = if result["agrees"] == true { "agrees" } else { "DIFFERS" };
        let is_row = |line: &&str| line.trim_start().starts_with(quantity) && line.ends_with(verdict);
        assert!(stdout.lines().any(|line| is_row(&line)), "{quantity}: {verdict} in {stdout}");
        if papers.last() != Some(&paper) {
            papers.push(paper);
        }
        assert_verdict(result);
    }
    assert_eq!(papers.len(), 4, "{papers:?}");
    assert_the_page(results);
    let agree = results.iter().filter(|result| result["agrees"] == true).count();
    assert!(
        stdout.starts_with(&format!("{agree} of {} figures of 4 papers agree", results.len())),
        "{stdout}"
    );
    let page = folder.read("report/report.html");
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    assert!(page.matches("<svg").count() >= 4, "a plot for each paper");
    assert!(!page.contains("http") && page.matches("<script").count() <= 1 && !page.contains("NaN"));
}

/// `docs/reproduce.md` has every row, in this order.
fn assert_the_page(results: &[Value]) {
    let rows = rows("reproduce.md", "| quantity | printed | within | ours | unit | verdict |");
    assert_eq!(rows.len(), results.len());
    for (row, result) in rows.iter().zip(results) {
        let verdict = if result["agrees"] == true { "agrees" } else { "differs" };
        let [quantity, _, _, ours, unit, shown] = &row[..] else { panic!("{row:?}") };
        assert_eq!([quantity, unit, shown], [&result["quantity"], &result["unit"], &Value::from(verdict)]);
        assert!(shows(ours, result["ours"].as_f64().unwrap()), "docs/reproduce.md: {row:?}: {result}");
    }
}

/// If the paper prints a bound, the verdict states whether the bound holds; if it prints a number, whether ours agrees, which
/// is within 12 % at most.
fn assert_verdict(result: &Value) {
    let (ours, agrees) = (result["ours"].as_f64().unwrap(), result["agrees"] == true);
    let Some(bound) = result["printed"].as_str() else {
        let printed = result["printed"].as_f64().unwrap();
        assert!(!agrees || (ours - printed).abs() < 0.12 * printed.abs(), "{result}");
        return;
    };
    let number = |text: &str| -> f64 { text.trim().parse().unwrap() };
    let holds = match (bound.strip_prefix('<'), bound.strip_prefix('>'), bound.split_once(" to ")) {
        (Some(max), ..) => ours < number(max),
        (_, Some(min), _) => ours > number(min),
        (.., Some((min, max))) => number(min) <= ours && ours <= number(max),
        _ => panic!("{result}"),
    };
    assert_eq!(holds, agrees, "{result}");
}

#[test]
fn an_output_that_cannot_be_written_is_named() {
    let folder = WorkFolder::with(&[("file", "")]);
    let before = folder.contents();
    let message = folder.fails("reproduce --json nowhere/out.json", 1);
    assert!(message.contains("nowhere/out.json: not written: there is no folder"), "{message}");
    let message = folder.fails("reproduce --report file", 1);
    assert!(message.contains("file"), "{message}");
    assert!(folder.contents() == before);
}
