//! Errors of geometry from measurements on machines of rigid bodies: the machines are no code of the crate.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod controls;
mod machine;
mod places;

use std::fs;
use std::path::Path;

use import::request::Request;
use volume::analysis::{Analysis, Verdict};
use volume::finding::{Finding, Known};
use volume::sources;
use volume::survey::Survey;

use machine::{Curve, Machine};
use places::{analysed, apart, before_and_after_um, few, many, survey};

fn finding<'a>(analysis: &'a Analysis, name: &str) -> &'a Finding {
    analysis.findings.iter().find(|finding| finding.name == name).unwrap()
}

/// A machine whose only errors are the slopes of its screws and its squareness, µm over the travel.
fn square(slopes_um: [f64; 3], leans_um: [f64; 3]) -> Machine {
    let mut machine = Machine::random(0, [1, 0, 2], 0.0);
    machine.errors = [[Curve::default(); 6]; 3];
    for (axis, slope_um) in slopes_um.into_iter().enumerate() {
        machine.errors[axis][axis].slope = slope_um;
    }
    for (moved, along, um) in [(1, 0, leans_um[0]), (2, 0, leans_um[1]), (2, 1, leans_um[2])] {
        machine.errors[moved][along].slope = um;
    }
    machine
}

/// What remains: bends of a higher degree than the fitted ones, and tilts that the places do not resolve. The bounds: at least a fifth of
/// the noise of a mean of six readings (0.35 µm / √6), below which the result would know more than was measured.
#[test]
fn many_measurements_show_the_errors_of_the_volume() {
    let mut held_out = [0.0, 0.0];
    for (seed, chain) in
        [(1, [1, 0, 2]), (2, [0, 1, 2]), (3, [2, 1, 0]), (4, [1, 0, 2]), (5, [0, 2, 1]), (6, [2, 0, 1])]
    {
        let machine = Machine::random(seed, chain, 15.0);
        let analysis = analysed(&machine, &many(), seed);
        let [before_um, after_um] = before_and_after_um(&machine, &analysis);
        assert!(
            after_um < 0.3 * before_um && after_um > 0.03,
            "{seed}: {before_um} µm, after {after_um} µm\n{}",
            volume::text::of(&analysis)
        );
        assert_eq!(analysis.verdict, Verdict::Confirmed, "{seed}: {}", volume::text::of(&analysis));
        for judged in analysis.judged.iter().filter(|judged| judged.is_held_out) {
            held_out[0] += judged.before_um.powi(2);
            held_out[1] += judged.after_um.powi(2);
        }
        println!("seed {seed}: {before_um:.2} µm, after {after_um:.2} µm");
    }
    let [before, after] = held_out.map(|squares: f64| (squares / 12.0).sqrt());
    println!("held out: {before:.2} µm, after {after:.2} µm");
    assert!(after < 0.5 * before && after > 0.03, "{before} µm, after {after} µm");
}

/// Each value within its interval, and no error that the machine does not have: of 3 machines with 15 errors each that are zero, the
/// chance of one is 45 · 4.7·10⁻⁴.
#[test]
fn squareness_is_found_and_nothing_else() {
    for (seed, leans_um) in [(11, [20.0, -9.0, 6.0]), (12, [-3.0, 12.0, 0.0]), (13, [0.0, 0.0, 0.0])] {
        let machine = square([15.0, -8.0, 4.0], leans_um);
        for (places, may_be_open) in [(few(), false), (many(), false), (apart(), true)] {
            let analysis = analysed(&machine, &places, seed);
            let travels_mm = [400.0, 300.0, 300.0];
            for (index, name) in ["x-y", "x-z", "y-z"].into_iter().enumerate() {
                let per_m = 1e3 * leans_um[index] / travels_mm[index];
                match finding(&analysis, name).known {
                    Known::Shown { greatest, half_width, .. } => {
                        // Half a width beside the interval: 1.5 widths are 99.7 %.
                        assert!(
                            (greatest - per_m).abs() < 1.5 * half_width,
                            "{name}: {greatest} ± {half_width}, not {per_m}"
                        );
                        assert!(half_width < 3.0, "{name}: {half_width}");
                    }
                    Known::Small { at_most_um } => {
                        assert!(per_m == 0.0 && at_most_um < 1.0, "{name}: {at_most_um}");
                    }
                    Known::Open { .. } | Known::WithoutEffect => {
                        assert!(may_be_open, "{name} is open\n{}", volume::text::of(&analysis));
                    }
                }
            }
            let shown =
                analysis.findings.iter().filter(|finding| matches!(finding.known, Known::Shown { .. }));
            let names: Vec<&str> = shown.map(|finding| finding.name.as_str()).collect();
            let is_true = |name: &&str| ["EXX", "EYY", "EZZ", "x-y", "x-z", "y-z"].contains(name);
            assert!(names.iter().all(is_true), "{names:?}");
            assert!(["EXX", "EYY", "EZZ"].iter().all(|name| names.contains(name)), "{names:?}");
        }
    }
}

/// One line and one circle for each axis and plane do not tell a tilt from a bend: neither is told, the machine's tilt of 60 µrad is in
/// no table.
#[test]
fn a_tilt_that_one_place_does_not_show_is_not_determined() {
    let mut machine = square([15.0, -8.0, 4.0], [20.0, -9.0, 6.0]);
    machine.errors[0][4].slope = 60.0;
    let analysis = analysed(&machine, &few(), 21);
    let tilt = finding(&analysis, "EBX");
    assert!(
        matches!(&tilt.known, Known::Open { shown_by } if shown_by == "positioning tests of x at two positions of z"),
        "{tilt:?}"
    );
    assert!(analysis.tables.iter().flat_map(|table| &table.about_urad).flatten().all(|urad| *urad == 0.0));
    // With lines at two heights it is: 60 µrad over the travel, from the middle.
    let analysis = analysed(&machine, &many(), 21);
    let Known::Shown { greatest, half_width, .. } = finding(&analysis, "EBX").known else {
        panic!("{analysis:?}")
    };
    assert!((greatest.abs() - 30.0).abs() < 1.5 * half_width, "{greatest} ± {half_width}");
}

#[test]
fn a_circle_in_one_direction_is_refused() {
    let machine = square([0.0; 3], [0.0; 3]);
    let folder = tempfile::tempdir().unwrap();
    let survey = survey(folder.path(), &machine, &few(), 31);
    let path = folder.path().join("circle0.csv");
    let text = fs::read_to_string(&path).unwrap();
    let one: Vec<&str> = text.lines().filter(|line| !line.ends_with(",cw")).collect();
    fs::write(&path, one.join("\n")).unwrap();
    let error = sources::read(&survey, &Request::default()).unwrap_err().to_string();
    assert!(error.contains("circle0.csv: expected a circle in both directions"), "{error}");
}

/// Tables with names of another program, semicolons and directions in words, with what the user says of their columns, are the measurements from which they were made.
#[test]
fn tables_of_another_program_are_mapped() {
    let machine = square([20.0, 0.0, 0.0], [10.0, 0.0, 0.0]);
    let folder = tempfile::tempdir().unwrap();
    let survey = survey(folder.path(), &machine, &few(), 31);
    let own = sources::read(&survey, &Request::default()).unwrap();
    let mut circles = 0;
    for entry in fs::read_dir(folder.path()).unwrap() {
        let path = entry.unwrap().path();
        if path.file_name().unwrap().to_str().unwrap().starts_with("circle") {
            let text = fs::read_to_string(&path).unwrap();
            let (header, rows) = text.split_once('\n').unwrap();
            assert_eq!(header, "angle_deg,radius_um,direction");
            fs::write(&path, format!("Winkel,Abweichung,Richtung\n{rows}").replace(',', ";")).unwrap();
            circles += 1;
        }
    }
    assert!(circles > 1, "{circles}");
    assert!(sources::read(&survey, &Request::default()).unwrap_err().to_string().contains("--map"));
    let mappings = ["angle_deg=Winkel", "radius_um=Abweichung", "direction=Richtung"];
    let mappings = mappings.map(|text| text.parse().unwrap()).to_vec();
    let mapped = sources::read(&survey, &Request { mappings, ..Request::default() }).unwrap();
    let texts = [own, mapped].map(|groups| volume::text::of(&volume::analyse(survey.chain, groups).unwrap()));
    let results =
        texts.map(|text| text.lines().filter(|line| !line.contains(".csv")).collect::<Vec<_>>().join("\n"));
    assert_eq!(results[0], results[1]);
}

#[test]
fn what_a_survey_lacks_is_named_with_its_line() {
    let line = "[[positioning]]\nfile = \"x.csv\"\naxis = \"x\"\nat_mm = { y = 0.0, z = 0.0 }\n";
    let chain = "chain = [\"x\", \"y\", \"z\"]\n";
    let whole = format!("{chain}{line}");
    assert!(Survey::parse(&whole, Path::new("s.toml")).is_ok());
    for (old, new, message) in [
        ("\"z\"]", "\"y\"]", "s.toml: line 1: chain: expected x, y and z in their order"),
        ("axis = \"x\"", "axis = \"u\"", "line 4: positioning[0].axis: expected x, y or z, found \"u\""),
        (", z = 0.0", "", "line 5: positioning[0].at_mm: expected the position of z"),
        ("{ y", "{ x = 1.0, y", "line 5: positioning[0].at_mm.x: expected the other two axes alone"),
        ("file =", "files =", "line 3: positioning[0].files"),
        (
            "0.0 }\n",
            "0.0 }\nvalidate = true\n",
            "expected a [[positioning]] or [[circle]] without validate = true",
        ),
    ] {
        assert!(whole.contains(old), "{old}");
        let error = Survey::parse(&whole.replacen(old, new, 1), Path::new("s.toml")).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}
