use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::PathBuf;

use super::*;
use files::error::InputError;
use indexmap::IndexMap;
use shared::interpolate::Ramps;

const HEAD: &str = r#"
name = "m"
feed_mm_per_min = 600.0
acceleration_m_per_s2 = 1.0
start_mm = { y = 0.0, x = 50.0 }
"#;

const EXAMPLE: &str = include_str!("../../motions/circle.toml");

fn parse(blocks: &str) -> Result<Motion, InputError> {
    Motion::parse(&format!("{HEAD}{blocks}"), "m.toml")
}

#[test]
fn absent_values_of_a_block_are_the_defaults_of_the_file() {
    let motion = parse(
        r#"
        [[block]]
        dwell_s = 0.5
        [[block]]
        line_to_mm = { y = 10 }
        feed_mm_per_min = 1200.0
        [[block]]
        arc = { plane = ["x", "y"], centre_mm = { x = 40.0, y = 10.0 }, turns = -0.5 }
        acceleration_m_per_s2 = 2.0
        [[block]]
        line_to_mm = { y = 0 }
    "#,
    )
    .unwrap();
    assert_eq!(motion.start_mm.keys().collect::<Vec<_>>(), ["y", "x"], "as in the file");
    assert_eq!(motion.blocks[0], Block::Dwell { seconds: 0.5 });
    let to_mm = IndexMap::from([("y".to_owned(), 10.0), ("x".to_owned(), 50.0)]);
    let pace = Pace {
        feed_mm_per_min: 1200.0,
        acceleration_m_per_s2: 1.0,
        ramps: Ramps::Trapezoid,
        joint_tolerance_um: 0.0,
    };
    let line = Block::Line { to_mm, pace };
    assert_eq!(motion.blocks[1], line);
    let arc = Block::Arc {
        plane: ["x".to_owned(), "y".to_owned()],
        centre_mm: [40.0, 10.0],
        sweep: Sweep::Turns(-0.5),
        pace: Pace { feed_mm_per_min: 600.0, acceleration_m_per_s2: 2.0, ..pace },
    };
    assert_eq!(motion.blocks[2], arc);
    let Block::Line { to_mm, .. } = &motion.blocks[3] else { panic!("a line") };
    assert!((to_mm["x"] - 30.0).abs() < 1e-9, "half a turn about 40 ends at 30 if it starts at 50");
}

/// Ramps and joint tolerance (µm) of each block of a motion.
fn paces(head: &str, blocks: &str) -> Result<Vec<(Ramps, f64)>, InputError> {
    let motion = Motion::parse(&format!("{head}{HEAD}{blocks}"), "m.toml")?;
    let pace = |block: &Block| match block {
        Block::Dwell { .. } => None,
        Block::Line { pace, .. } | Block::Arc { pace, .. } => Some((pace.ramps, pace.joint_tolerance_um)),
    };
    Ok(motion.blocks.iter().filter_map(pace).collect())
}

#[test]
fn ramps_jerk_and_tolerance_of_a_block_replace_those_of_the_file() {
    let blocks = r#"
        [[block]]
        line_to_mm = { y = 1 }
        [[block]]
        line_to_mm = { y = 2 }
        ramps = "s-curve"
        jerk_m_per_s3 = 7.0
        joint_tolerance_um = 0
        [[block]]
        line_to_mm = { y = 3 }
        ramps = "exponential"
        joint_tolerance_um = 2.5
        [[block]]
        line_to_mm = { y = 4 }
        ramps = "after-interpolation"
        [[block]]
        line_to_mm = { y = 5 }
        ramps = "trapezoid"
    "#;
    let own = [
        (Ramps::SCurve { jerk_m_per_s3: 7.0 }, 0.0),
        (Ramps::Exponential, 2.5),
        (Ramps::AfterInterpolation, 10.0),
        (Ramps::Trapezoid, 10.0),
    ];
    let found = paces("joint_tolerance_um = 10\nramps = \"s-curve\"\njerk_m_per_s3 = 50", blocks).unwrap();
    assert_eq!(found[0], (Ramps::SCurve { jerk_m_per_s3: 50.0 }, 10.0));
    assert_eq!(found[1..], own);
    // Without values in the file: trapezoids and exact stops.
    let found = paces("", blocks).unwrap();
    assert_eq!(found[0], (Ramps::Trapezoid, 0.0));
    assert_eq!(found[3], (Ramps::AfterInterpolation, 0.0));
    // The default jerk of the file is used by a block without a jerk.
    let found = paces("jerk_m_per_s3 = 50", &blocks.replacen("jerk_m_per_s3 = 7.0", "", 1)).unwrap();
    assert_eq!(found[1].0, Ramps::SCurve { jerk_m_per_s3: 50.0 });
}

#[test]
fn a_jerk_is_required_by_s_curves_and_refused_otherwise() {
    const LINE: &str = "[[block]]\nline_to_mm = { x = 1.0 }\n";
    let cases = [
        ("ramps = 's-curve'", "", "jerk_m_per_s3: expected a value beside ramps = \"s-curve\", found none"),
        ("jerk_m_per_s3 = 5", "", "line 1: jerk_m_per_s3: expected no jerk, as ramps is not \"s-curve\""),
        ("ramps = 's-curve'\njerk_m_per_s3 = 0", "", "jerk_m_per_s3: expected a number above 0, found 0"),
        ("ramps = 'sine'", "", "line 1: ramps: expected one of trapezoid, s-curve, exponential, after-"),
        ("joint_tolerance_um = -1", "", "joint_tolerance_um: expected a number from 0 to 1000000, found -1"),
        ("", "ramps = 's-curve'", "block[0].jerk_m_per_s3: expected a value beside ramps"),
        ("", "jerk_m_per_s3 = 5", "block[0].jerk_m_per_s3: expected no jerk, as ramps is not"),
        ("", "ramps = 's-curve'\njerk_m_per_s3 = -5", "block[0].jerk_m_per_s3: expected a number above 0"),
        ("", "joint_tolerance_um = 1e7", "block[0].joint_tolerance_um: expected a number from 0 to"),
    ];
    for (head, block, wanted) in cases {
        let message = paces(head, &format!("{LINE}{block}")).expect_err(wanted).to_string();
        assert!(message.starts_with("m.toml: ") && message.contains(wanted), "{message}\nwanted {wanted}");
        assert!(!message.contains('\n'), "{message}");
    }
}

/// From (50, 0) about the origin to (0, 50), the arc is a quarter of a turn (78.54 mm) counter-clockwise or three quarters
/// (235.62 mm) clockwise. At 3.926 mm/min these take 1200.3 s and 3600.9 s, of which the second exceeds 3600 s.
#[test]
fn the_direction_of_an_arc_selects_one_of_two_arcs_to_its_end() {
    let arc = |direction: &str| {
        parse(&format!(
            r#"
            [[block]]
            arc = {{ plane = ["x", "y"], centre_mm = {{ x = 0, y = 0 }}, to_mm = {{ y = 50, x = 0 }}, direction = "{direction}" }}
            feed_mm_per_min = 3.926
            [[block]]
            line_to_mm = {{ x = 1.0 }}
        "#
        ))
    };
    let motion = arc("positive").unwrap();
    let Block::Arc { sweep, .. } = &motion.blocks[0] else { panic!("an arc") };
    assert_eq!(*sweep, Sweep::To { to_mm: [0.0, 50.0], direction: Direction::Positive });
    let Block::Line { to_mm, .. } = &motion.blocks[1] else { panic!("a line") };
    assert_eq!(*to_mm, IndexMap::from([("y".to_owned(), 50.0), ("x".to_owned(), 1.0)]));
    let message = arc("negative").unwrap_err().to_string();
    assert!(message.contains("block[0]: expected a total duration of at most 3600 s"), "{message}");
}

/// A quarter turn counter-clockwise rotates + of the first axis to + of the second.
#[test]
fn positive_turns_are_counter_clockwise() {
    let motion = parse(
        r#"
        [[block]]
        arc = { plane = ["x", "y"], centre_mm = { x = 0.0, y = 0.0 }, turns = 1.25 }
        [[block]]
        line_to_mm = { x = 7.0 }
    "#,
    );
    let Block::Line { to_mm, .. } = &motion.unwrap().blocks[1] else { panic!("a line") };
    assert!((to_mm["y"] - 50.0).abs() < 1e-9);
}

/// Blocks and the expected error.
const BAD_BLOCKS: &[(&str, &str)] = &[
    ("", "block: expected at least one [[block]], found none"),
    ("block = []", "line 6: block: expected at least one [[block]]"),
    ("[[block]]", "line 6: block[0]: expected exactly one of dwell_s, line_to_mm, arc"),
    (
        "[[block]]\ndwell_s = 1.0\nline_to_mm = { x = 1.0 }",
        "block[0]: expected exactly one of dwell_s, line_to_mm, arc",
    ),
    ("[[block]]\nwait_s = 1.0", "line 7: block[0].wait_s: unknown key, expected one of"),
    ("[[block]]\ndwell_s = 0", "block[0].dwell_s: expected a number above 0, found 0"),
    ("[[block]]\ndwell_s = 1e9", "block[0]: expected a total duration of at most 3600 s"),
    ("[[block]]\ndwell_s = nan", "dwell_s: expected a finite number, found nan"),
    (
        "[[block]]\ndwell_s = 1.0\nfeed_mm_per_min = 1.0",
        "block[0]: expected a dwell without feed, acceleration, ramps,",
    ),
    (
        "[[block]]\nline_to_mm = { z = 1.0 }",
        "line 7: block[0].line_to_mm.z: expected an axis of start_mm (y, x), found 1.0",
    ),
    (
        "[[block]]\nline_to_mm = { x = 50.0 }",
        "block[0].line_to_mm: expected a target other than the current position",
    ),
    ("[[block]]\nline_to_mm = { x = 1e6 }", "expected a position within 100000 mm of zero"),
    ("[[block]]\nline_to_mm = { x = '5' }", "line_to_mm.x: expected a number, found '5'"),
    (
        "[[block]]\nline_to_mm = { x = 1.0 }\nfeed_mm_per_min = -5",
        "line 8: block[0].feed_mm_per_min: expected a number above 0, found -5",
    ),
    (
        "[[block]]\nline_to_mm = { x = 1.0 }\nacceleration_m_per_s2 = 0.0",
        "block[0].acceleration_m_per_s2: expected a number above 0, found 0.0",
    ),
];

/// Keys of an arc about the origin from (50, 0), in addition to plane and centre, and the expected error.
const BAD_ENDS: &[(&str, &str)] = &[
    ("", "line 7: block[0].arc: expected either turns, or to_mm with direction"),
    (
        "turns = 1.0, to_mm = { x = 0, y = 50 }, direction = 'positive'",
        "block[0].arc: expected either turns, or to_mm with direction",
    ),
    ("turns = 1.0, direction = 'positive'", "block[0].arc: expected either turns, or to_mm with direction"),
    ("to_mm = { x = 0, y = 50 }", "arc.direction: expected a value beside to_mm, found none"),
    ("direction = 'negative'", "arc.to_mm: expected a value beside direction, found none"),
    (
        "to_mm = { x = 0, y = 50 }, direction = 'left'",
        "line 7: block[0].arc.direction: expected positive or negative, found 'left'",
    ),
    ("to_mm = { x = 0 }, direction = 'positive'", "arc.to_mm.y: expected this key, found none"),
    (
        "to_mm = { x = 0, y = 50, z = 0 }, direction = 'positive'",
        "arc.to_mm.z: expected only the axes of the plane (x, y), found 0",
    ),
    (
        "to_mm = { x = 50.0, y = 0 }, direction = 'positive'",
        "line 7: block[0].arc.to_mm: expected a point other than the current position: a full circle is given by",
    ),
    (
        "to_mm = { x = 0, y = 50.0021 }, direction = 'positive'",
        "line 7: block[0].arc.to_mm: expected a point within 0.002 mm of the circle of radius 50.000000 mm: its \
         distance is 0.002100 mm",
    ),
];

/// Plane, centre and turns of an arc, and the expected error.
const BAD_ARCS: &[(&str, &str, &str, &str)] = &[
    ("'x', 'y'", "x = 50.0, y = 0.0", "1.0", "centre_mm: expected a centre other than the current"),
    ("'x', 'y'", "x = 0.0, y = 0.0", "0.0", "turns: expected a number other than 0, found 0.0"),
    ("'x', 'y'", "x = 0.0", "1.0", "centre_mm.y: expected this key, found none"),
    ("'x', 'y'", "x = 0.0, y = 0.0, z = 0.0", "1.0", "centre_mm.z: expected only the axes of the"),
    ("'x', 'y'", "x = -9e4, y = 0.0", "1.0", "centre_mm: expected a position within 100000 mm of"),
    ("'x', 'y'", "x = 0.0, y = 0.0", "1e6", "expected a total duration of at most 3600 s"),
    ("'x', 'y'", "x = 0.0, y = 0.0", "1.0, r = 1.0", "r: unknown key, expected one of plane,"),
    ("'x', 'x'", "x = 0.0", "1.0", "plane[1]: expected another axis than the first, found 'x'"),
    ("'x', 'z'", "x = 0.0, z = 0.0", "1.0", "plane[1]: expected an axis of start_mm (y, x)"),
    ("'x'", "x = 0.0", "1.0", "plane: expected an array of length 2, found an array of 1"),
];

fn assert_refused(blocks: &str, wanted: &str) {
    let message = parse(blocks).expect_err(blocks).to_string();
    assert!(message.starts_with("m.toml: ") && message.contains(wanted), "{message}\nfor\n{blocks}");
    assert!(!message.contains('\n'), "{message}");
}

#[test]
fn bad_blocks_are_refused_with_key_and_expectation() {
    for (blocks, wanted) in BAD_BLOCKS {
        assert_refused(blocks, wanted);
    }
    for (plane, centre, turns, wanted) in BAD_ARCS {
        let arc = format!("plane = [{plane}], centre_mm = {{ {centre} }}, turns = {turns}");
        assert_refused(&format!("[[block]]\narc = {{ {arc} }}"), wanted);
    }
    for (end, wanted) in BAD_ENDS {
        let comma = if end.is_empty() { "" } else { ", " };
        let arc = format!("plane = ['x', 'y'], centre_mm = {{ x = 0, y = 0 }}{comma}{end}");
        assert_refused(&format!("[[block]]\narc = {{ {arc} }}"), wanted);
    }
}

#[test]
fn bad_heads_are_refused_with_key_and_expectation() {
    let block = "[[block]]\ndwell_s = 1.0\n";
    let cases = [
        ("name = \"m\"", "title = \"m\"", "line 2: title: unknown key, expected one of name"),
        ("600.0", "0", "line 3: feed_mm_per_min: expected a number above 0, found 0"),
        ("1.0", "-1.0", "line 4: acceleration_m_per_s2: expected a number above 0, found -1.0"),
        ("x = 50.0", "\"x 1\" = 1", "start_mm.x 1: expected a name that starts with a letter"),
        ("x = 50.0", "x = 1e9", "line 5: start_mm.x: expected a position within 100000 mm of zero"),
        ("{ y = 0.0, x = 50.0 }", "{}", "line 5: start_mm: expected at least one axis"),
        ("feed_mm_per_min = 600.0", "", "m.toml: feed_mm_per_min: expected this key, found none"),
    ];
    for (from, to, wanted) in cases {
        let text = format!("{}{block}", HEAD.replacen(from, to, 1));
        let message = Motion::parse(&text, "m.toml").unwrap_err().to_string();
        assert!(message.starts_with("m.toml: ") && message.contains(wanted), "{message}\nfor\n{text}");
    }
}

/// Duration of a motion, with a trapezoidal velocity profile for each block that ends with an exact stop. Joints and
/// other ramps change it by some tenths of a second.
fn duration_s(motion: &Motion) -> f64 {
    let mut at_mm = motion.start_mm.clone();
    let mut total_s = 0.0;
    for block in &motion.blocks {
        let (length_mm, pace) = match block {
            Block::Dwell { seconds } => {
                total_s += seconds;
                continue;
            }
            Block::Line { to_mm, pace } => {
                let squares = to_mm.iter().map(|(name, to)| (to - at_mm[name]).powi(2));
                let length_mm = squares.sum::<f64>().sqrt();
                at_mm.clone_from(to_mm);
                (length_mm, pace)
            }
            Block::Arc { plane, centre_mm, sweep, pace } => {
                let start_mm = plane.each_ref().map(|name| at_mm[name]);
                let radius_mm = (start_mm[0] - centre_mm[0]).hypot(start_mm[1] - centre_mm[1]);
                let turns = match sweep {
                    Sweep::Turns(turns) => {
                        assert!(
                            turns.fract() == 0.0,
                            "arcs of the examples are whole circles or end at a point"
                        );
                        turns.abs()
                    }
                    Sweep::To { to_mm, .. } => {
                        for (name, to_mm) in plane.iter().zip(to_mm) {
                            at_mm[name] = *to_mm;
                        }
                        let chord_mm = (to_mm[0] - start_mm[0]).hypot(to_mm[1] - start_mm[1]);
                        // Arcs to a point are at most half a turn in the examples.
                        (0.5 * chord_mm / radius_mm).min(1.0).asin() / PI
                    }
                };
                (TAU * radius_mm * turns, pace)
            }
        };
        let (v, a) = (pace.feed_mm_per_min / 60.0, 1e3 * pace.acceleration_m_per_s2);
        let ramps_s = if pace.joint_tolerance_um > 0.0 { 0.0 } else { v / a };
        total_s += if length_mm < v * v / a { 2.0 * (length_mm / a).sqrt() } else { length_mm / v + ramps_s };
    }
    total_s
}

#[test]
fn motion_files_of_the_repository_are_valid_and_last_5_to_20_s() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).with_file_name("motions");
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let motion = Motion::read(&path).unwrap();
        let seconds = duration_s(&motion);
        // Long enough for reversals and corners. Motions of the demo are shorter, as the whole demo takes at most 10 s.
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let least = if name.starts_with("demo") { 3.0 } else { 5.0 };
        assert!((least..=20.0).contains(&seconds), "{} lasts {seconds} s", path.display());
        let axes = motion.start_mm.keys().map(String::as_str).collect::<Vec<_>>();
        let expected: &[&str] = if name == "bench_four" { &["x", "y", "z", "u"] } else { &["x", "y"] };
        assert_eq!(axes, expected, "{name}");
        names.push(name);
    }
    for name in ["circle", "corner", "pocket", "reversals", "small_circle", "steps"] {
        assert!(names.contains(&name.to_owned()), "{name} is missing");
    }
}

/// Each typing error of one character gives a valid motion or an error message of one line.
#[test]
fn no_typing_error_causes_a_panic() {
    for at in 0..EXAMPLE.len() {
        for typed in ["", "\"", "[", "]", ".", "\n", "-", "9", "e", " ", "=", "ä"] {
            let text = format!("{}{typed}{}", &EXAMPLE[..at], &EXAMPLE[at + 1..]);
            if let Err(error) = Motion::parse(&text, "m.toml") {
                assert!(!error.to_string().contains('\n'));
            }
        }
    }
}
