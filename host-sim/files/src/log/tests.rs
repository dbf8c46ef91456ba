use std::fs;
use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;

use super::*;

const LOG: &str = "\
time_s,x_command_mm,x_motor_mm,x_force_n,c_motor_deg,c_force_nm
5.000,1.0,1.5,-3,0.25,1e-1
5.001,2.0,2.5,-4,0.50,2e-1
5.002,3.0,3.5,-5,0.75,3e-1
5.003,4.0,4.5,-6,1.00,4e-1
";

fn message(bytes: &[u8]) -> String {
    let result = Log::parse(bytes, "fit.csv");
    result.err().unwrap_or_else(|| panic!("accepted")).to_string()
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn a_log_has_the_values_of_the_file() {
    let log = Log::parse(LOG.as_bytes(), "fit.csv").unwrap();
    assert_eq!((log.source.as_str(), log.len(), log.axes.len()), ("fit.csv", 4, 2));
    assert!((log.start_s - 5.0).abs() < 1e-12 && (log.sample_time_s - 1e-3).abs() < 1e-12);
    let (x, c) = (log.axis("x").unwrap(), log.axis("c").unwrap());
    assert_eq!((x.unit, c.unit), (Unit::Millimetre, Unit::Degree));
    assert_eq!(x.command.as_deref(), Some(&[1.0, 2.0, 3.0, 4.0][..]));
    assert_eq!(c.channel(Channel::Force), Some(&[0.1, 0.2, 0.3, 0.4][..]));
    assert_eq!((&x.table, &x.tool, &x.added_force), (&None, &None, &None));
}

/// A temperature is in degrees Celsius on every axis, wherever its column stands, and survives a round trip.
#[test]
fn a_temperature_does_not_show_the_unit_of_its_axis() {
    let text = "time_s,c_temperature_c,x_temperature_c,c_motor_deg\n0.000,20.5,19,1\n0.001,20.6,19,2\n0.002,20.7,19,3\n";
    let log = Log::parse(text.as_bytes(), "fit.csv").unwrap();
    let [c, x] = ["c", "x"].map(|name| log.axis(name).unwrap());
    assert_eq!((c.unit, x.unit), (Unit::Degree, Unit::Millimetre));
    assert_eq!(c.temperature.as_deref(), Some(&[20.5, 20.6, 20.7][..]));
    let mut written = Vec::new();
    log.write_csv(&mut written).unwrap();
    assert_eq!(Log::parse(&written, "fit.csv").unwrap(), log);
    let mixed = text.replace("c_motor_deg", "c_motor_deg,c_table_mm");
    assert!(message(mixed.as_bytes()).contains("c_table_mm: expected unit deg as in c_motor_deg, found mm"));
}

#[test]
fn spaces_quotes_line_ends_and_byte_order_marks_are_ignored() {
    let expected = Log::parse(LOG.as_bytes(), "fit.csv").unwrap();
    let variants = [
        format!("\u{feff}{LOG}"),
        LOG.replace('\n', "\r\n"),
        LOG.trim_end().to_owned(),
        format!("{LOG}\n\n"),
        LOG.replace(',', " , "),
        LOG.replace("x_motor_mm", "\"x_motor_mm\""),
    ];
    for text in variants {
        assert_eq!(Log::parse(text.as_bytes(), "fit.csv").unwrap(), expected, "{text:?}");
    }
}

#[test]
fn names_of_axes_may_contain_digits_and_underscores() {
    let text = LOG.replace("c_", "a1_b_").replace("x_command_mm", "x_added_force_n");
    let log = Log::parse(text.as_bytes(), "fit.csv").unwrap();
    assert!(log.axis("a1_b").is_some());
    assert!(log.axis("x").unwrap().added_force.is_some(), "not the force of an axis x_added");
}

#[test]
fn a_wrong_header_is_an_error_that_names_the_column() {
    let cases = [
        ("time_s", "x_tool_mm", "line 1: time_s: expected this column, found none"),
        (
            "x_motor_mm",
            "x_command_mm",
            "line 1: x_command_mm: expected one column of this name, found a second one",
        ),
        ("x_motor_mm", "time_s", "line 1: time_s: expected one column of this name, found a second one"),
        (
            "x_motor_mm",
            "x_motr_mm",
            "line 1: x_motr_mm: expected a column time_s, or, of an axis x: x_command_mm, x_motor_mm, x_table_mm, x_tool_mm, x_force_n, x_added_force_n, x_temperature_c (rotary: _deg and _nm), found \"x_motr_mm\"",
        ),
        (
            "x_motor_mm",
            "x_motor_um",
            "line 1: x_motor_um: expected a column time_s, or, of an axis x: x_command_mm",
        ),
        (
            "x_motor_mm",
            "_motor_mm",
            "line 1: _motor_mm: expected a column time_s, or, of an axis x: x_command_mm",
        ),
        (
            "x_motor_mm",
            "1x_motor_mm",
            "line 1: 1x_motor_mm: expected a column time_s, or, of an axis x: x_command_mm",
        ),
        (
            "x_motor_mm",
            "",
            "line 1: unnamed column: expected a column time_s, or, of an axis x: x_command_mm",
        ),
        ("x_motor_mm", "x_motor_deg", "line 1: x_motor_deg: expected unit mm as in x_command_mm, found deg"),
        ("x_force_n", "x_force_nm", "line 1: x_force_nm: expected unit n as in x_command_mm, found nm"),
        (LOG, "time_s\n0\n1\n", "line 1: expected a column of an axis (time_s, or, of an axis x"),
        (LOG, "speed_rpm,torque_mnm\n1,2\n", "line 1: speed_rpm: expected a column time_s"),
        (LOG, "0.0,1.0\n0.1,2.0\n", "line 1: 0.0: expected a column time_s, or, of an axis x: x_command_mm"),
        (LOG, "time_s;x_motor_mm\n0;1\n", "line 1: expected commas between the columns, found \";\""),
        (LOG, "time_s\tx_motor_mm\n0\t1\n", "line 1: expected commas between the columns, found \"\\t\""),
        (LOG, "Dear reader,\nthis is a letter.\n", "line 1: Dear reader: expected a column time_s"),
        (LOG, "Dear reader\nthis is a letter.\n", "line 1: Dear reader: expected a column time_s"),
    ];
    check(&cases);
}

#[test]
fn a_wrong_row_is_an_error_that_names_line_and_column() {
    let cases = [
        ("3.5", "NaN", "line 4: x_motor_mm: expected a finite number, found \"NaN\""),
        ("3.5", "-inf", "line 4: x_motor_mm: expected a finite number, found \"-inf\""),
        ("3.5", "-2e9", "line 4: x_motor_mm: expected a number from −1e9 to 1e9, found \"-2e9\""),
        ("3.5", "1e999", "line 4: x_motor_mm: expected a finite number, found \"1e999\""),
        ("3.5", "", "line 4: x_motor_mm: expected a finite number, found nothing"),
        ("3.5", "3.5mm", "line 4: x_motor_mm: expected a finite number, found \"3.5mm\""),
        ("5.002", "noon", "line 4: time_s: expected a finite number, found \"noon\""),
        ("3.5,", "", "line 4: expected 6 values as in the header, found 5"),
        ("3.5,", "3.5,3.5,", "line 4: expected 6 values as in the header, found 7"),
        ("\n5.002", "\n\n\n5.oo2", "line 6: time_s: expected a finite number"),
        ("5.002", "5.001", "line 4: time_s: expected a time after 5.001, found 5.001"),
        ("5.002", "4.002", "line 4: time_s: expected a time after 5.001, found 4.002"),
        ("5.003", "5.004", "line 5: time_s: expected 5.003 (uniform sampling without gaps), found 5.004"),
        ("5.003", "5.0031", "line 5: time_s: expected 5.003 (uniform sampling without gaps), found 5.0031"),
        ("5.003", "9.0", "line 5: time_s: expected 5.003 (uniform sampling without gaps), found 9"),
    ];
    check(&cases);
}

#[test]
fn a_text_without_two_samples_is_an_error() {
    let header = "time_s,x_motor_mm\n";
    assert_eq!(message(b""), "fit.csv: expected a header line, found an empty file");
    assert_eq!(message(b"\n \n"), "fit.csv: expected a header line, found an empty file");
    let none = message(header.as_bytes());
    assert_eq!(none, "fit.csv: expected two samples or more, found none");
    let one = message(format!("{header}0,1\n").as_bytes());
    assert_eq!(one, "fit.csv: expected two samples or more, found one");
    let binary = message(b"time_s,x_motor_mm\n\x00\x01");
    assert_eq!(binary, "fit.csv: line 2: expected a CSV text in UTF-8, found byte 0x00");
    let png = message(b"\x89PNG\r\n");
    assert_eq!(png, "fit.csv: line 1: expected a CSV text in UTF-8, found byte 0x89");
}

/// Replaces the first text by the second in [`LOG`] and checks the error message, with LF and with CRLF.
fn check(cases: &[(&str, &str, &str)]) {
    for (from, to, expected) in cases {
        let text = LOG.replacen(from, to, 1);
        assert_ne!(text, LOG);
        for text in [text.replace('\n', "\r\n"), text] {
            let message = message(text.as_bytes());
            assert!(message.starts_with("fit.csv: "), "{message}");
            assert!(message.contains(expected), "{message}\nexpected {expected}");
            assert!(!message.contains('\n'), "{message}");
        }
    }
}

#[test]
fn an_unclosed_quote_is_an_error_in_one_line() {
    let text = LOG.replacen("3.5", "\"3.5", 1);
    let message = message(text.as_bytes());
    assert!(message.contains("line 4: expected 6 values as in the header, found 3"), "{message}");
}

/// Each replacement of one character gives a valid log or an error message of one line.
#[test]
fn no_edit_of_one_character_causes_a_panic() {
    for at in 0..LOG.len() {
        for edit in ["", "\"", ",", "\n", "\r", "-", "9", "e", ".", "ä", "\0"] {
            let text = format!("{}{edit}{}", &LOG[..at], &LOG[at + 1..]);
            match Log::parse(text.as_bytes(), "fit.csv") {
                Ok(log) => assert!(log.len() >= 2),
                Err(error) => assert!(!error.to_string().contains('\n')),
            }
        }
    }
}

#[test]
fn an_unreadable_file_is_an_error_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let message = |path: &Path| Log::read(path).unwrap_err().to_string();
    assert!(message(folder.path()).contains(": expected a readable file: "));
    let missing = message(&folder.path().join("no.csv"));
    assert!(missing.contains("no.csv: expected a readable file: "), "{missing}");
}

#[test]
fn gzip_is_recognised_by_suffix_or_content_and_must_be_complete() {
    let folder = tempfile::tempdir().unwrap();
    let save = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    };
    let whole = packed(LOG.as_bytes());
    for name in ["a.csv.gz", "a.csv", "A.CSV.GZ"] {
        assert_eq!(Log::read(&save(name, &whole)).unwrap().len(), 4, "{name}");
    }
    for (name, bytes) in [("cut.csv.gz", &whole[..whole.len() - 12]), ("plain.csv.gz", LOG.as_bytes())] {
        let message = Log::read(&save(name, bytes)).unwrap_err().to_string();
        assert!(message.contains(&format!("{name}: expected a complete gzip file: ")), "{message}");
        assert!(!message.contains('\n'), "{message}");
    }
    let empty = Log::read(&save("empty.csv.gz", b"")).unwrap_err().to_string();
    assert!(empty.contains("expected a header line, found an empty file"), "{empty}");
}

#[test]
fn a_written_log_is_read_unchanged() {
    let folder = tempfile::tempdir().unwrap();
    let base = Log::parse(LOG.as_bytes(), "fit.csv").unwrap();
    let clocks = [(5.0, 1e-3), (122.315, 1e-3), (0.1234, 1.0 / 3000.0), (0.0, 0.25), (7.0, 5e-8)];
    for name in ["out.csv", "out.csv.gz"] {
        for (start_s, sample_time_s) in clocks {
            let path = folder.path().join(name);
            let log = Log { start_s, sample_time_s, ..base.clone() };
            log.write(&path).unwrap();
            let back = Log::read(&path).unwrap();
            assert_eq!(back.axes, log.axes);
            assert!((back.start_s - start_s).abs() < 1e-9, "{}", back.start_s);
            assert!((back.sample_time_s / sample_time_s - 1.0).abs() < 1e-5);
        }
    }
    let bytes = fs::read(folder.path().join("out.csv.gz")).unwrap();
    assert!(bytes.starts_with(&[0x1f, 0x8b]));
}

#[test]
fn written_values_have_a_resolution_of_a_tenth_of_a_nanometre_and_of_a_millinewton() {
    let mut axis = AxisLog::new("x", Unit::Millimetre);
    axis.tool = Some(vec![-1_234.567_890_12, 0.000_000_1]);
    axis.force = Some(vec![0.1234, -20_000.0]);
    let log = Log::new("", 0.0, 2.5e-4, [axis]);
    let mut bytes = Vec::new();
    log.write_csv(&mut bytes).unwrap();
    let expected = "time_s,x_tool_mm,x_force_n\n\
                  0.00000,-1234.5678901,0.1234\n\
                  0.00025,0.0000001,-20000.0000\n";
    assert_eq!(String::from_utf8(bytes).unwrap(), expected);
}

#[test]
fn a_slice_keeps_its_times() {
    let mut axis = AxisLog::new("x", Unit::Millimetre);
    axis.motor = Some((0..10).map(f64::from).collect());
    let log = Log::new("", 5.0, 0.5, [axis]);
    let part = log.slice(4..7);
    assert_eq!(part.axes[0].motor, Some(vec![4.0, 5.0, 6.0]));
    assert_eq!(part.axes[0].table, None);
    assert_eq!((part.len(), part.is_empty()), (3, false));
    assert!((part.start_s - 7.0).abs() < 1e-12);
    assert!((part.time_s(2) - log.time_s(6)).abs() < 1e-12);
}
