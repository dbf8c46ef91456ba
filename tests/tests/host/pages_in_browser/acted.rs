//! What cursor, magnification and choices do to a page, compared with the figures that it saves and with the JSON of the program.

use std::collections::BTreeMap;

use files::format::significant;
use serde_json::Value;

/// Lowest and highest words of a picture, pixels.
const WORDS_PX: std::ops::RangeInclusive<f64> = 9.0..=17.0;

/// The cursor goes to a point of a curve within this many pixels; the narrowest plane is wider than 250.
const SNAP: f64 = 6.0 / 250.0;

fn text(value: &Value) -> &str {
    value.as_str().unwrap()
}

/// Left end and width of the part of a plane that is shown, in its units.
fn part(state: &Value) -> [f64; 2] {
    [0, 2].map(|i| state["part"][i].as_f64().unwrap())
}

fn number(word: &str) -> f64 {
    word.replace('−', "-").parse().unwrap_or_else(|_| panic!("{word}"))
}

/// Points of each curve of a saved picture.
fn curves(csv: &str) -> BTreeMap<String, Vec<(f64, f64)>> {
    let mut curves: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
    for row in csv::Reader::from_reader(csv.as_bytes()).deserialize() {
        let (curve, x, y): (String, f64, f64) = row.unwrap();
        curves.entry(curve).or_default().push((x, y));
    }
    curves
}

/// Checks the first chart of a page at one width; `csv` is what it saves.
pub fn check_chart(seen: &Value, csv: &str) {
    let chart = &seen["chart"];
    assert!(WORDS_PX.contains(&chart["smallest"].as_f64().unwrap()), "{seen}");
    assert_eq!(chart["overlap"], false, "{seen}");
    let [left, width] = part(&chart["whole"]);
    let is_near = |state: &str, [from, length]: [f64; 2], tolerance: f64| {
        let [x, w] = part(&chart[state]);
        let off = ((x - from).abs() + (w - length).abs()) / width;
        assert!(off <= tolerance, "{state}: {off} {seen}");
    };
    // From a quarter to a half, each end at a point nearby.
    is_near("dragged", [left + 0.25 * width, 0.25 * width], 3.0 * SNAP);
    assert!((chart["range"].as_f64().unwrap() - 0.25).abs() <= 2.0 * SNAP, "{seen}");
    // About a cursor near the middle, and moved with it, which is farther than the middle of the part.
    let [nearer, moved] = ["nearer", "moved"].map(|state| part(&chart[state]));
    assert!((nearer[1] - 0.5 * width).abs() < 1e-6 * width && (moved[1] - nearer[1]).abs() < 1e-6 * width);
    is_near("nearer", [left + 0.25 * width, 0.5 * width], SNAP);
    is_near("nearest", [left + 0.25 * width, 0.5 * width], 0.5 / 40.0 + SNAP);
    for state in ["doubled", "farther", "reset", "clicked"] {
        is_near(state, [left, width], 1e-9);
        assert_eq!(chart[state]["labels"], chart["whole"]["labels"], "{state}");
        assert_eq!(chart[state]["canReset"], false, "{state}");
    }
    assert_eq!(chart["dragged"]["canReset"], true, "{seen}");
    check_labels(&chart["dragged"], text(&chart["digits"]));
    assert_ne!(chart["dragged"]["labels"], chart["whole"]["labels"]);
    check_reading(text(&chart["read"]["said"]), csv);
}

/// The labels of a part are within it, and at least two.
fn check_labels(state: &Value, digits: &str) {
    let unit = 10_f64.powf(number(digits.split(' ').next().unwrap()));
    let [from, length] = part(state);
    let labels: Vec<f64> =
        state["labels"].as_array().unwrap().iter().map(|label| number(text(label))).collect();
    assert!(labels.len() >= 2 && labels.is_sorted(), "{state}");
    let slack = 0.01 * length;
    let is_within = |label: &f64| (from - slack..=from + length + slack).contains(&(label * unit));
    assert!(labels.iter().all(is_within), "{state}");
}

/// What the cursor says of each curve is between the points on either side of it, and of one at least a point itself.
fn check_reading(said: &str, csv: &str) {
    let curves = curves(csv);
    let mut parts = said.split("; ");
    let place = parts.next().unwrap().split(' ').rev().nth(1).unwrap();
    let decimals = place.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let (x, rounding) = (number(place), 0.5 * 0.1_f64.powf(decimals as f64) + 1e-9);
    let mut exact = 0;
    let mut read = 0;
    for part in parts {
        let (name, points) = curves
            .iter()
            .find(|(name, _)| part.starts_with(name.as_str()))
            .unwrap_or_else(|| panic!("{part} {said}"));
        let values: Vec<f64> = part[name.len()..]
            .split_whitespace()
            .filter(|word| word.contains(|c: char| c.is_ascii_digit()))
            .map(number)
            .collect();
        let around = points.windows(2).filter(|pair| {
            let [low, high] = numerics::min_max([pair[0].0, pair[1].0]);
            low <= x + rounding && high >= x - rounding
        });
        let [low, high] = numerics::min_max(around.flat_map(|pair| [pair[0].1, pair[1].1]));
        let slack = 1e-9 + 1e-3 * high.abs().max(low.abs());
        assert!(
            values.iter().all(|value| (low - slack..=high + slack).contains(value)),
            "{part}: {low} to {high}"
        );
        let is_point = |value: &f64| {
            points.iter().any(|(at, y)| (at - x).abs() <= rounding && (y - value).abs() < 1e-12)
        };
        exact += values.iter().filter(|value| is_point(value)).count();
        read += 1;
    }
    assert!(read >= 1 && exact >= 1, "{said}");
}

/// Checks the choices of a circle: one for each cause of at least a hundredth of the whole, with the figures of the JSON.
pub fn check_choices(seen: &Value, budget: &Value) {
    let motion = &budget["motions"][0];
    let whole_um = motion["whole_um"]["rms"].as_f64().unwrap();
    let causes = motion["causes"].as_array().unwrap();
    let shown: Vec<&Value> =
        causes.iter().filter(|cause| cause["um"]["rms"].as_f64().unwrap().abs() >= 0.01 * whole_um).collect();
    let choices = seen["choices"].as_array().unwrap();
    // All causes, each taken out, and all again.
    assert_eq!(choices.len(), shown.len() + 2, "{seen}");
    assert_eq!(seen["isShown"], true);
    let um = |value: &Value| format!("{}\u{a0}µm", significant(value.as_f64().unwrap(), 3));
    for (choice, cause) in choices[1..].iter().zip(&shown) {
        let label = text(&choice["label"]);
        assert!(label.starts_with(&text(&cause["cause"]).replace('_', " ")), "{label}");
        assert!(label.ends_with(&format!("{} rms", um(&cause["um"]["rms"]))), "{label}");
        let said =
            format!("G = {} instead of {}.", um(&cause["without_um"]["G"]), um(&motion["whole_um"]["G"]));
        assert!(text(&choice["said"]).ends_with(&said), "{said} {choice}");
    }
    check_lines(choices);
}

/// With a cause taken out, its lines lie in front of those with all, which are pale then and as they were.
fn check_lines(choices: &[Value]) {
    let lines = |choice: &Value| -> Vec<(String, String)> {
        let lines = choice["lines"].as_array().unwrap().iter();
        lines.map(|line| (text(&line[0]).to_owned(), text(&line[1]).to_owned())).collect()
    };
    let all = lines(&choices[0]);
    assert_eq!(all.iter().map(|line| line.0.as_str()).collect::<Vec<_>>(), ["ccw", "cw"]);
    assert_eq!(lines(choices.last().unwrap()), all);
    for choice in &choices[1..choices.len() - 1] {
        let drawn = lines(choice);
        let classes: Vec<&str> = drawn.iter().map(|line| line.0.as_str()).collect();
        assert_eq!(classes, ["ccw pale", "cw pale", "ccw", "cw"]);
        assert!(drawn.iter().zip(&all).all(|(pale, own)| pale.1 == own.1), "{choice}");
        assert!(drawn[2..].iter().zip(&all).any(|(without, own)| without.1 != own.1), "{choice}");
    }
}

/// What the pointer says of a circle at 0° are the figures that it saves, to three digits.
pub fn check_circle_reading(hover: &str, csv: &str) {
    let curves = curves(csv);
    let mut parts = hover.split(", ");
    let degrees = number(parts.next().unwrap().trim_end_matches('°'));
    let mut read = 0;
    for part in parts {
        let (name, um) = part.strip_suffix(" µm").and_then(|part| part.rsplit_once(' ')).unwrap();
        let off = |angle: f64| ((angle - degrees + 540.0).rem_euclid(360.0) - 180.0).abs();
        // The nearest point is read, as far as the angle is told, with one decimal; none is read beyond 0.03 rad.
        let nearest = curves[name].iter().map(|point| off(point.0)).fold(f64::INFINITY, f64::min);
        assert!(nearest <= 0.03_f64.to_degrees() + 0.05, "{hover}: {nearest}");
        let near: Vec<f64> =
            curves[name].iter().filter(|point| off(point.0) <= nearest + 0.1).map(|point| point.1).collect();
        let um = number(um);
        assert!(near.iter().any(|value| (value - um).abs() <= 0.006 * value.abs()), "{hover}: {near:?}");
        read += 1;
    }
    assert_eq!(read, 2, "{hover}");
}
