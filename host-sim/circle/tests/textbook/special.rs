//! Single cases: lag, one direction, an arc, wrong sides of a limit, positions that contain a radius alone.

use std::f64::consts::{FRAC_PI_2, PI};

use circle::Analysis;
use circle::measured::Measured;
use circle::part::{Name, Part as Found};
use circle::radius_table::Nominal;
use files::log::Log;
use files::table::Table;

use super::generator::{Circle, Part};
use super::logs::{log, of_log};
use super::tables::{of_table, table};

/// A circle of 50 mm at 40 mm/s with noise of 0.2 µm.
fn circle(parts: &[Part]) -> Circle {
    Circle {
        radius_mm: 50.0,
        rad_per_s: 0.8,
        rate_hz: 500.0,
        parts: parts.to_vec(),
        noise_um: 0.2,
        correlation_s: 0.0,
        seed: 4,
    }
}

fn found<'a>(analysis: &'a Analysis, name: Name, axis: &str) -> Option<&'a Found> {
    analysis.parts.iter().find(|part| part.name == name && part.axis == axis)
}

/// The log with each axis changed by a function of the axis, its command about the centre and the time.
fn with_tool(circle: &Circle, tool: impl Fn(usize, f64) -> f64) -> Log {
    let mut log = log(circle);
    let samples = circle.samples();
    let noise = [0, 1].map(|sensor| circle.noise(sensor, samples.len()));
    for axis in 0..2 {
        let values =
            samples.iter().zip(&noise[axis]).map(|((time_s, ..), noise)| tool(axis, *time_s) + 1e-3 * noise);
        log.axes[axis].tool = Some(values.collect());
    }
    log
}

/// Angle of the command at a time, and direction; `None` while it stands.
fn angle(circle: &Circle, time_s: f64) -> (f64, f64) {
    let lap_s = 2.0 * PI / circle.rad_per_s;
    let (first, second) = (time_s - 0.3, time_s - 0.6 - lap_s);
    if second > 0.0 {
        (-circle.rad_per_s * second, -1.0)
    } else {
        (circle.rad_per_s * first.clamp(0.0, lap_s), 1.0)
    }
}

/// First-order axes with K = 40/s, in the steady state: late by φ = atan(ω/K), smaller by cos φ. At ω = 0.8 rad/s the radius shrinks by
/// 50 000·(1 − cos 0.02) = 10 µm, and nothing else deviates.
#[test]
fn a_first_order_lag_is_following_lag_alone() {
    let circle = circle(&[]);
    let phase = (0.8_f64 / 40.0).atan();
    let shrunk_um = 50_000.0 * (1.0 - phase.cos());
    let log = with_tool(&circle, |axis, time_s| {
        let (theta, direction) = angle(&circle, time_s);
        let late = theta - direction * phase;
        [12.0, -7.0][axis] + 50.0 * phase.cos() * if axis == 0 { late.cos() } else { late.sin() }
    });
    let analysis = of_log(&log);
    let lag = found(&analysis, Name::FollowingLag, "xy").unwrap();
    assert!((lag.um - shrunk_um).abs() < 0.02 * shrunk_um && lag.is_certain(), "{lag:?}");
    let delay = lag.details.iter().find(|detail| detail.key == "delay_ms").unwrap();
    assert!((delay.value - 1e3 * phase / 0.8).abs() < 0.05, "{delay:?}");
    assert!(
        analysis.parts.iter().all(|part| part.name == Name::FollowingLag || part.um < 0.2),
        "{:?}",
        analysis.parts
    );
    // F is the shrinkage, within five deviations of the mean of two samples of a sector: 5·0.2/√2 µm.
    let [min, max] = analysis.figures.radial_um();
    assert!((min + shrunk_um).abs() < 0.71 && (max + shrunk_um).abs() < 0.71, "{min} {max}");
}

/// The same delay as a dead time: the radius is the nominal one. A lag of the first order would have shrunk it; that it did not may be a
/// larger radius: neither is certain.
#[test]
fn a_dead_time_makes_lag_and_radius_ambiguous() {
    let circle = circle(&[]);
    let log = with_tool(&circle, |axis, time_s| {
        let (theta, direction) = angle(&circle, time_s);
        let late = theta - direction * 0.02;
        [12.0, -7.0][axis] + 50.0 * if axis == 0 { late.cos() } else { late.sin() }
    });
    let analysis = of_log(&log);
    let [lag, radius] = [Name::FollowingLag, Name::Radius].map(|name| found(&analysis, name, "xy").unwrap());
    assert!(lag.rivals == ["radius"] && radius.rivals == ["following_lag"], "{lag:?} {radius:?}");
    assert!((lag.um - radius.um).abs() < 0.1 && (lag.um - 10.0).abs() < 0.2, "{lag:?} {radius:?}");
}

/// Squareness of 8 µm and servo mismatch of 6 µm: in the counter-clockwise direction alone, an oval of 14 µm.
#[test]
fn one_direction_names_the_rival_of_squareness() {
    let circle = circle(&[Part::Squareness(8.0), Part::Servo(6.0)]);
    let both = of_table(&table(&circle), Nominal { radius_mm: Some(50.0), ..Nominal::default() });
    assert!((found(&both, Name::Squareness, "xy").unwrap().um - 8.0).abs() < 0.2);
    assert!((found(&both, Name::ServoMismatch, "xy").unwrap().um - 6.0).abs() < 0.2);
    let lines = table(&circle);
    let half: Vec<&str> = lines.lines().take(lines.lines().count() / 2).collect();
    let one = of_table(&half.join("\n"), Nominal { radius_mm: Some(50.0), ..Nominal::default() });
    let squareness = found(&one, Name::Squareness, "xy").unwrap();
    assert!(squareness.rivals.contains(&"servo_mismatch"), "{squareness:?}");
    assert!((squareness.um - 14.0).abs() < 0.7, "{squareness:?}");
    assert_eq!((one.figures.hysteresis_um, one.figures.bidirectional_um), (None, None));
    assert!(both.figures.hysteresis_um.is_some());
}

/// Positions that were computed from a radius and the nominal angle have no deviation along the circle: taken as positions, the oval of
/// 10 µm would have half its size.
#[test]
fn positions_that_contain_a_radius_alone_are_seen() {
    let circle = circle(&[]);
    let log = with_tool(&circle, |axis, time_s| {
        let (theta, _) = angle(&circle, time_s);
        let radius = 50.0 + 5e-3 * (2.0 * theta).sin();
        [12.0, -7.0][axis] + radius * if axis == 0 { theta.cos() } else { theta.sin() }
    });
    let analysis = of_log(&log);
    let squareness = found(&analysis, Name::Squareness, "xy").unwrap();
    assert!((squareness.um - 10.0).abs() < 0.2, "{squareness:?}");
    assert!(analysis.measured.notes.iter().any(|note| note.contains("only the radius")));
}

/// The sign of a backlash says whether it is there, or compensated too much.
#[test]
fn a_backlash_that_is_compensated_too_much_has_the_other_sign() {
    for um in [6.0, -6.0] {
        let analysis = of_log(&log(&circle(&[Part::Backlash(0, um)])));
        let part = found(&analysis, Name::Backlash, "x").unwrap();
        let signed = part.details.iter().find(|detail| detail.key == "signed_um").unwrap();
        assert!((signed.value - um).abs() < 0.1, "{signed:?}");
        assert!(part.rivals.contains(&"windup"), "{part:?}");
    }
}

/// A sawtooth of 4 µm with steps of 0.02 mm of travel while |vx| is below a fifth of the speed.
#[test]
fn steps_at_low_speed_are_stick_slip_and_ambiguous() {
    let circle = circle(&[Part::Squareness(6.0)]);
    let mut log = log(&circle);
    let limit = 0.2_f64.asin();
    let tool = log.axes[0].tool.as_mut().unwrap();
    for ((_, theta, at), mm) in circle.samples().iter().zip(tool.iter_mut()) {
        let from_reversal = (theta + FRAC_PI_2).rem_euclid(PI) - FRAC_PI_2;
        if at.is_some() && from_reversal.abs() < limit {
            let place = 50.0 * theta.cos() / 0.02;
            *mm += 4e-3 * (place - place.floor() - 0.5);
        }
    }
    let analysis = of_log(&log);
    let part = found(&analysis, Name::StickSlip, "x").unwrap();
    assert!((part.um - 4.0).abs() < 1.0 && !part.is_certain(), "{part:?}");
    assert!(found(&analysis, Name::StickSlip, "y").is_none(), "{:?}", analysis.parts);
    let none = of_log(&super::logs::log(&self::circle(&[Part::Spike(0, 6.0, 0.05)])));
    assert!(none.parts.iter().all(|part| part.name != Name::StickSlip), "{:?}", none.parts);
}

/// Arcs of 280° are evaluated, of 250° refused; a line is no circle.
#[test]
fn three_quarters_of_a_turn_are_needed() {
    let circle = circle(&[Part::Scale(8.0)]);
    let nominal = Nominal { radius_mm: Some(50.0), ..Nominal::default() };
    let csv = table(&circle);
    let part = |degrees: f64| {
        let rows = 0.5 * (csv.lines().count() - 1) as f64 * degrees / 360.0;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of rows")]
        let rows = rows as usize;
        csv.lines().take(1 + rows).collect::<Vec<_>>().join("\n")
    };
    let analysis = of_table(&part(285.0), nominal);
    let scale = found(&analysis, Name::ScaleMismatch, "xy").unwrap();
    assert!((scale.um - 8.0).abs() < 0.8, "{scale:?}");
    let short = part(250.0);
    let table = Table::parse(short.as_bytes(), "arc.csv").unwrap();
    let measured = Measured::of_radius_tables(vec![(table, "arc.csv".to_owned())], nominal).unwrap();
    let error = circle::analyse(measured).unwrap_err().to_string();
    assert!(error.starts_with("arc.csv: expected three quarters of a turn or more"), "{error}");
    let mut line = log(&circle);
    for axis in &mut line.axes {
        let count = axis.command.as_ref().unwrap().len();
        axis.command = Some((0..count).map(|i| 1e-3 * i as f64).collect());
    }
    let error = Measured::of_logs(std::slice::from_ref(&line)).unwrap_err().to_string();
    assert!(error.contains("log.csv: expected a command with a circle"), "{error}");
    line.axes.iter_mut().for_each(|axis| axis.tool = None);
    assert!(
        Measured::of_logs(std::slice::from_ref(&line))
            .unwrap_err()
            .to_string()
            .contains("expected a measured position")
    );
}

/// The directions in two logs are one circle: squareness and servo mismatch, which one direction alone confuses, come apart, and every part
/// is that of the one log within the samples that the cut costs (of 0.2 µm of noise each).
#[test]
fn directions_in_two_logs_are_one_circle() {
    let circle = circle(&[Part::Squareness(8.0), Part::Servo(6.0), Part::Backlash(0, 5.0)]);
    let whole = log(&circle);
    let cut = |log: &Log, rows: std::ops::Range<usize>| {
        let mut part = log.clone();
        part.source = format!("{}.csv", rows.start);
        part.start_s = log.start_s + rows.start as f64 * log.sample_time_s;
        for axis in &mut part.axes {
            for channel in [&mut axis.command, &mut axis.tool] {
                *channel = channel.as_ref().map(|values| values[rows.clone()].to_vec());
            }
        }
        part
    };
    let count = whole.axes[0].command.as_ref().unwrap().len();
    let halves = [cut(&whole, 0..count / 2), cut(&whole, count / 2..count)];
    let of_both = circle::analyse(Measured::of_logs(&halves).unwrap()).unwrap();
    let of_one = of_log(&whole);
    assert!(of_both.figures.hysteresis_um.is_some());
    for (name, axes, um) in
        [(Name::Squareness, "xy", 8.0), (Name::ServoMismatch, "xy", 6.0), (Name::Backlash, "x", 5.0)]
    {
        let [both, one] = [&of_both, &of_one].map(|analysis| found(analysis, name, axes).unwrap().um);
        assert!((both - one).abs() < 0.1 && (both - um).abs() < 0.3, "{name:?}: {both} {one}");
    }
    let mut other = halves[1].clone();
    for axis in &mut other.axes {
        for channel in [&mut axis.command, &mut axis.tool] {
            channel.iter_mut().flatten().for_each(|mm| *mm *= 1.01);
        }
    }
    let error = Measured::of_logs(&[halves[0].clone(), other]).unwrap_err().to_string();
    assert!(
        error.contains(": expected a circle of radius 50.000 mm, as in 0.csv, found 50.500 mm"),
        "{error}"
    );
}

/// The same circle as one table with falling angles for clockwise, as two files, as deviations in µm with a column of directions, and
/// over time at a known speed.
#[test]
fn the_dialects_of_a_table_give_the_same_parts() {
    let circle = circle(&[Part::Servo(9.0), Part::Backlash(1, 5.0)]);
    let csv = table(&circle);
    let nominal = Nominal { radius_mm: Some(50.0), ..Nominal::default() };
    let reference = of_table(&csv, nominal);
    let rows: Vec<Vec<f64>> =
        csv.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    let middle = rows.len() / 2;
    let way = |i: usize| if i < middle { "ccw" } else { "cw" };
    let mut deviations = "angle_deg,radius_um,direction\n".to_owned();
    let mut timed = "time_s,radius_mm,direction\n".to_owned();
    let mut files = ["angle_deg,radius_mm\n".to_owned(), "angle_deg,radius_mm\n".to_owned()];
    for (i, row) in rows.iter().enumerate() {
        deviations += &format!("{},{:.4},{}\n", row[1], 1e3 * (row[2] - 50.0), way(i));
        timed += &format!("{},{},{}\n", row[0], row[2], way(i));
        files[usize::from(i >= middle)] += &format!("{},{}\n", row[1], row[2]);
    }
    let tables =
        files.iter().map(|text| (Table::parse(text.as_bytes(), "f.csv").unwrap(), "f.csv".to_owned()));
    let two = circle::analyse(Measured::of_radius_tables(tables.collect(), nominal).unwrap()).unwrap();
    let feed = Nominal { feed_mm_per_min: Some(2400.0), ..nominal };
    for analysis in [two, of_table(&deviations, nominal), of_table(&timed, feed)] {
        for (name, axis) in [(Name::ServoMismatch, "xy"), (Name::Backlash, "y")] {
            let [expected, um] =
                [&reference, &analysis].map(|analysis| found(analysis, name, axis).unwrap().um);
            // The angle from time is that of the first reading, up to one sample, 0.1°, off.
            assert!((um - expected).abs() < 0.02 * expected, "{name:?}: {um} {expected}");
        }
    }
    let unknown = of_table(&csv, Nominal::default());
    assert!(!unknown.measured.has_nominal_radius && found(&unknown, Name::Radius, "xy").is_none());
}
