use std::fs;
use std::path::PathBuf;

use super::*;

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
fn blocks_take_what_the_file_gives_and_defaults_for_the_rest() {
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
    let line = Block::Line { to_mm, feed_mm_per_min: 1200.0, acceleration_m_per_s2: 1.0 };
    assert_eq!(motion.blocks[1], line);
    let arc = Block::Arc {
        plane: ["x".to_owned(), "y".to_owned()],
        centre_mm: [40.0, 10.0],
        turns: -0.5,
        feed_mm_per_min: 600.0,
        acceleration_m_per_s2: 2.0,
    };
    assert_eq!(motion.blocks[2], arc);
    let Block::Line { to_mm, .. } = &motion.blocks[3] else { panic!("a line") };
    assert!((to_mm["x"] - 30.0).abs() < 1e-9, "half a turn about 40 leads from 50 to 30");
}

/// A quarter turn, counter-clockwise, leads from the first axis's + to the second's +.
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

/// Blocks, and what has to be said of them.
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
    ("[[block]]\ndwell_s = 1e9", "block[0]: expected an end within 3600 s"),
    ("[[block]]\ndwell_s = nan", "dwell_s: expected a finite number, found nan"),
    (
        "[[block]]\ndwell_s = 1.0\nfeed_mm_per_min = 1.0",
        "block[0]: expected a dwell without feed or acceleration",
    ),
    (
        "[[block]]\nline_to_mm = { z = 1.0 }",
        "line 7: block[0].line_to_mm.z: expected an axis that start_mm names (y, x), found 1.0",
    ),
    (
        "[[block]]\nline_to_mm = { x = 50.0 }",
        "block[0].line_to_mm: expected a target away from where the axes stand",
    ),
    ("[[block]]\nline_to_mm = { x = 1e6 }", "expected a travel within 100000 mm of zero"),
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

/// Plane, centre and turns of an arc, and what has to be said of them.
const BAD_ARCS: &[(&str, &str, &str, &str)] = &[
    ("'x', 'y'", "x = 50.0, y = 0.0", "1.0", "centre_mm: expected a centre away from where the"),
    ("'x', 'y'", "x = 0.0, y = 0.0", "0.0", "turns: expected a number other than 0, found 0.0"),
    ("'x', 'y'", "x = 0.0", "1.0", "centre_mm.y: expected this key, found none"),
    ("'x', 'y'", "x = 0.0, y = 0.0, z = 0.0", "1.0", "centre_mm.z: expected only the axes of the"),
    ("'x', 'y'", "x = -9e4, y = 0.0", "1.0", "centre_mm: expected a travel within 100000 mm of"),
    ("'x', 'y'", "x = 0.0, y = 0.0", "1e6", "expected an end within 3600 s"),
    ("'x', 'y'", "x = 0.0, y = 0.0", "1.0, r = 1.0", "r: unknown key, expected one of plane,"),
    ("'x', 'x'", "x = 0.0", "1.0", "plane[1]: expected another axis than the first, found 'x'"),
    ("'x', 'z'", "x = 0.0, z = 0.0", "1.0", "plane[1]: expected an axis that start_mm names (y, x)"),
    ("'x'", "x = 0.0", "1.0", "plane: expected an array of length 2, found an array of 1"),
];

fn assert_refused(blocks: &str, wanted: &str) {
    let said = parse(blocks).expect_err(blocks).to_string();
    assert!(said.starts_with("m.toml: ") && said.contains(wanted), "{said}\nfor\n{blocks}");
    assert!(!said.contains('\n'), "{said}");
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
}

#[test]
fn bad_heads_are_refused_with_key_and_expectation() {
    let block = "[[block]]\ndwell_s = 1.0\n";
    let cases = [
        ("name = \"m\"", "title = \"m\"", "line 2: title: unknown key, expected one of name"),
        ("600.0", "0", "line 3: feed_mm_per_min: expected a number above 0, found 0"),
        ("1.0", "-1.0", "line 4: acceleration_m_per_s2: expected a number above 0, found -1.0"),
        ("x = 50.0", "\"x 1\" = 1", "start_mm.x 1: expected a name that starts with a letter"),
        ("x = 50.0", "x = 1e9", "line 5: start_mm.x: expected a travel within 100000 mm of zero"),
        ("{ y = 0.0, x = 50.0 }", "{}", "line 5: start_mm: expected at least one axis"),
        ("feed_mm_per_min = 600.0", "", "m.toml: feed_mm_per_min: expected this key, found none"),
    ];
    for (from, to, wanted) in cases {
        let text = format!("{}{block}", HEAD.replacen(from, to, 1));
        let said = Motion::parse(&text, "m.toml").unwrap_err().to_string();
        assert!(said.starts_with("m.toml: ") && said.contains(wanted), "{said}\nfor\n{text}");
    }
}

/// Time of a path with a stop at both ends.
fn trapezoid_s(length_mm: f64, feed_mm_per_min: f64, acceleration_m_per_s2: f64) -> f64 {
    let (v, a) = (feed_mm_per_min / 60.0, 1e3 * acceleration_m_per_s2);
    if length_mm < v * v / a { 2.0 * (length_mm / a).sqrt() } else { length_mm / v + v / a }
}

fn duration_s(motion: &Motion) -> f64 {
    let mut at_mm = motion.start_mm.clone();
    let mut total_s = 0.0;
    for block in &motion.blocks {
        total_s += match block {
            Block::Dwell { seconds } => *seconds,
            Block::Line { to_mm, feed_mm_per_min, acceleration_m_per_s2 } => {
                let squares = to_mm.iter().map(|(name, to)| (to - at_mm[name]).powi(2));
                let length_mm = squares.sum::<f64>().sqrt();
                at_mm.clone_from(to_mm);
                trapezoid_s(length_mm, *feed_mm_per_min, *acceleration_m_per_s2)
            }
            Block::Arc { plane, centre_mm, turns, feed_mm_per_min, acceleration_m_per_s2 } => {
                assert!(turns.fract() == 0.0, "the examples turn whole circles");
                let [x, y] = plane.each_ref().map(|name| at_mm[name]);
                let radius_mm = (x - centre_mm[0]).hypot(y - centre_mm[1]);
                let length_mm = TAU * radius_mm * turns.abs();
                trapezoid_s(length_mm, *feed_mm_per_min, *acceleration_m_per_s2)
            }
        };
    }
    total_s
}

#[test]
fn the_motions_that_ship_read_and_last_as_long_as_a_test_should() {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("motions");
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let motion = Motion::read(&path).unwrap();
        let seconds = duration_s(&motion);
        // Long enough for reversals and corners; the demo's are shorter, as all of it ends within 10 s.
        let is_demo = path.file_stem().unwrap().to_str().unwrap().starts_with("demo");
        let least = if is_demo { 3.0 } else { 5.0 };
        assert!((least..=20.0).contains(&seconds), "{} lasts {seconds} s", path.display());
        assert_eq!(motion.start_mm.keys().collect::<Vec<_>>(), ["x", "y"]);
        names.push(path.file_stem().unwrap().to_str().unwrap().to_owned());
    }
    for name in ["circle", "corner", "reversals", "small_circle", "steps"] {
        assert!(names.contains(&name.to_owned()), "{name} is missing");
    }
}

/// Whatever one slip of the finger makes of a motion file, it is read or refused in one line.
#[test]
fn no_slip_breaks_the_reader() {
    for at in 0..EXAMPLE.len() {
        for slip in ["", "\"", "[", "]", ".", "\n", "-", "9", "e", " ", "=", "ä"] {
            let text = format!("{}{slip}{}", &EXAMPLE[..at], &EXAMPLE[at + 1..]);
            if let Err(error) = Motion::parse(&text, "m.toml") {
                assert!(!error.to_string().contains('\n'));
            }
        }
    }
}
