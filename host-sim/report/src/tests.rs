use std::fs;

use super::certificate::Circumstances;
use super::sentences;
use super::trace_page::{Extra, html, write};
use budget::traced;
use files::log::{AxisLog, Log, Unit};
use model::machine::Machine;
use pages::markup::text;
use trace::Identification;

/// A circle in both directions of two axes of which only motor and table were logged; the table of x has 4 µm of
/// backlash.
fn log(source: &str, radius_mm: f64, shift: f64) -> Log {
    const TURN: u32 = 2400;
    let noise = |i: u32, seed: f64| 1e-5 * ((f64::from(i) * 12.9898 + seed).sin() * 43_758.545).fract();
    let turn = |i: u32| std::f64::consts::TAU * f64::from(i) / f64::from(TURN) + shift;
    let angles: Vec<f64> = (0..=TURN).map(turn).chain((0..200).map(|_| turn(TURN))).collect();
    let angles: Vec<f64> = angles.iter().copied().chain(angles.iter().rev().copied()).collect();
    let axis = |name: &str, at: fn(f64) -> f64, gap_mm: f64, seed: f64| {
        let command: Vec<f64> = angles.iter().map(|angle| radius_mm * at(*angle)).collect();
        let mut behind = 0.0;
        let table = command.iter().zip(0..).map(|(&mm, i)| {
            behind = f64::clamp(behind, mm - 0.5 * gap_mm, mm + 0.5 * gap_mm);
            behind + noise(i, seed)
        });
        let table = Some(table.collect());
        AxisLog {
            command: Some(command.clone()),
            motor: Some(command),
            table,
            ..AxisLog::new(name, Unit::Millimetre)
        }
    };
    let axes = vec![axis("x", f64::cos, 0.004, 1.0), axis("y", f64::sin, 0.0, 2.0)];
    Log::new(source, 0.0, 0.001, axes)
}

fn traced() -> Identification {
    let text =
        "name = \"<b>&\"\nsample_rate_hz = 1000.0\n[axis.x]\nlead_mm = 10.0\n[axis.y]\nlead_mm = 10.0\n";
    let machine = Machine::parse(text, "m.toml").unwrap();
    let (fit, validate) = (log("/home/me/fit.csv", 20.0, 0.3), log("/home/me/validate.csv", 25.0, 0.9));
    trace::trace(&machine, &[fit], &[validate], &|_| ()).unwrap()
}

fn extra(truth: &str) -> Extra {
    let truth = vec![("x".to_owned(), toml::from_str(truth).unwrap())];
    Extra {
        title: "A <i> title".to_owned(),
        lead: vec!["Seed 7 & \"more\".".to_owned()],
        truth: Some(truth),
        ..Extra::default()
    }
}

/// Every tag that is opened is closed, in order.
fn assert_balanced(html: &str) {
    let mut open: Vec<&str> = Vec::new();
    for tag in html.split('<').skip(1) {
        let (inside, _) = tag.split_once('>').unwrap_or_else(|| panic!("a tag without end: <{tag}"));
        let name = inside.split([' ', '\n']).next().unwrap().trim_end_matches('/');
        if let Some(name) = inside.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "closed out of order");
        } else if !inside.ends_with('/') && !["!DOCTYPE", "meta", "col"].contains(&name) {
            open.push(name);
        }
        assert_eq!(inside.matches('"').count() % 2, 0, "quotes in <{inside}>");
    }
    assert_eq!(open, Vec::<&str>::new());
}

#[test]
fn the_page_is_well_formed_escaped_and_self_contained() {
    let trace = traced();
    let html = html(&trace, &extra("name = 'backlash'\nwidth_um = 4"));
    assert_balanced(&html);
    for foreign in ["http", "url(", "@import", "src=", "href=", "/home/me"] {
        assert!(!html.contains(foreign), "{foreign}");
    }
    assert!(html.contains("<h1>A &lt;i&gt; title</h1>"));
    assert!(html.contains("Seed 7 &amp; &quot;more&quot;."));
    for (name, value) in
        [("machine", "&lt;b&gt;&amp;"), ("logs fitted", "fit.csv"), ("logs held out", "validate.csv")]
    {
        assert!(html.contains(&format!("<tr><th scope=\"row\">{name}</th><td>{value}</td></tr>")), "{name}");
    }
}

#[test]
fn the_page_has_all_sections_with_their_results() {
    let trace = traced();
    let page = html(&trace, &extra("name = 'backlash'\nwidth_um = 4"));
    let sections = [
        "Machine and logs",
        "Effects found",
        "Residuals before",
        "The circle",
        "The residual of",
        "Unexplained residuals",
        "Candidates tested",
    ];
    let positions: Vec<usize> =
        sections.iter().map(|name| page.find(&format!("<h2>{name}")).unwrap()).collect();
    assert!(positions.is_sorted(), "{positions:?}");
    let verdict = page.find("class=\"verdict\">One undeclared effect was found").unwrap();
    assert!(verdict < positions[0], "the verdict stands first");
    let (_, way) = page.split_once("<details><summary>How was this found?</summary>").unwrap();
    assert!(way.contains("<h2>Candidates tested"), "candidates are folded away");
    assert!(page.contains(&text(&sentences::sentence(&trace.axes()[0], &trace.axes()[0].found[0], None)).0));
    // Its machine file declares neither stiffness nor masses, and no force is logged.
    let parts = "gap and stretch under friction together, or the screw has a gap of up to this width, or the drive train is stretched";
    assert!(page.contains(parts));
    assert!(page.contains("; it explains the table residual of held-out motions, which is "));
    assert!(page.contains("y: no undeclared effect found"));
    let truth = text("4.000 µm backlash between screw and table").0;
    assert!(page.contains(&format!("<td class=\"sentence\">{truth}</td>")), "the truth");
    assert!(page.contains("a circle of 25.0 mm radius"));
    assert!(page.contains("class=\"cw\" points") && page.contains("class=\"ccw\" points"));
    assert!(page.contains("x, tool: could not be evaluated; required: a tool channel."));
    assert!(page.contains("mean residual") && page.contains("velocity, mm/s"));
    assert!(page == html(&trace, &extra("name = 'backlash'\nwidth_um = 4")), "the same bytes again");
}

#[test]
fn the_page_names_what_it_was_told_and_nothing_else() {
    let trace = traced();
    let told = Circumstances {
        traced: traced::Circumstances {
            serial: Some("SN <7>".to_owned()),
            operator: Some("A. Smith".to_owned()),
            date: Some("2026-11-27".to_owned()),
            temperature_c: Some(21.5),
        },
        command_line: Some("lost-motion trace --fit fit.csv".to_owned()),
    };
    let page = html(&trace, &Extra { circumstances: told, ..extra("name = 'backlash'\nwidth_um = 4") });
    let row = |name: &str, value: &str| format!("<th scope=\"row\">{name}</th><td>{value}</td>");
    let told = [
        row("serial number", "SN &lt;7&gt;"),
        row("operator", "A. Smith"),
        row("date", "2026-11-27"),
        row("command line", "lost-motion trace --fit fit.csv"),
    ];
    let positions: Vec<usize> = told.iter().map(|row| page.find(row.as_str()).unwrap()).collect();
    assert!(positions.is_sorted(), "{positions:?}");
    assert!(page.contains(&row("program", &format!("lost-motion {}", env!("CARGO_PKG_VERSION")))));
    // Without them, there is no row.
    let page = html(&trace, &extra("name = 'backlash'\nwidth_um = 4"));
    for name in ["serial number", "operator", "date", "command line"] {
        assert!(!page.contains(&format!("<th scope=\"row\">{name}</th>")), "{name}");
    }
}

#[test]
fn limits_stand_on_the_page_with_their_result_and_in_the_verdict() {
    let trace = traced();
    // Nothing was measured at the tool, and there is no budget.
    let limits = traced::limits(&trace, &[], None, &["G=8".parse().unwrap()]);
    let page = html(&trace, &Extra { limits, ..extra("name = 'backlash'\nwidth_um = 4") });
    assert!(page.contains("<td class=\"result\">unknown</td>"), "{page}");
    assert!(page.contains("not known whether within the limit: G.</p>"), "{page}");
}

#[test]
fn the_comparison_with_the_truth_lists_missed_and_false_effects() {
    let page = html(&traced(), &extra("name = 'windup'\nstiffness_n_per_um = 120"));
    assert!(page.contains("<td>not found</td>"));
    assert!(
        page.contains("<th scope=\"row\">x</th><td>none</td><td"),
        "the backlash, which is not among the true effects"
    );
}

#[test]
fn the_page_is_written_into_a_folder_that_is_created() {
    let folder = tempfile::tempdir().unwrap();
    let inner = folder.path().join("a").join("b");
    let trace = traced();
    let path = write(&inner, &trace, &Extra::default()).unwrap();
    assert_eq!(path, inner.join("report.html"));
    assert_eq!(fs::read_to_string(&path).unwrap(), html(&trace, &Extra::default()));
    let message = write(&path, &trace, &Extra::default()).unwrap_err().to_string();
    assert!(message.contains("report.html: not written"), "{message}");
}
