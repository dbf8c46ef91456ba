//! Machines of rigid bodies with exact rotations, whose errors are no polynomials, measured with reversals, deviations of the servos and
//! noise: none of it is code of the crate.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use std::process::Command;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use volume::analysis::{Analysis, Verdict};
use volume::finding::{Finding, Known};
use volume::survey::Survey;
use volume::{analyse, sources};

const LOW_MM: [f64; 3] = [0.0, 0.0, -300.0];
const HIGH_MM: [f64; 3] = [500.0, 400.0, 0.0];

/// A smooth error: slope, sine and cube over the travel.
#[derive(Clone, Copy, Default)]
struct Curve {
    slope: f64,
    sine: f64,
    phase: f64,
    cube: f64,
}

impl Curve {
    fn at(&self, part: f64) -> f64 {
        let bend = self.sine * (0.7 * TAU * part + self.phase).sin();
        self.slope * part + bend + self.cube * (2.0 * part - 1.0).powi(3)
    }
}

struct Machine {
    chain: [usize; 3],
    /// µm along and µrad about x, y and z, of x, y and z.
    errors: [[Curve; 6]; 3],
    backlash_um: [f64; 3],
}

impl Machine {
    fn random(seed: u64, chain: [usize; 3], tilt_urad: f64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut errors = [[Curve::default(); 6]; 3];
        for (axis, curves) in errors.iter_mut().enumerate() {
            for (index, curve) in curves.iter_mut().enumerate() {
                let size = if index < 3 { 6.0 } else { tilt_urad };
                *curve = Curve {
                    slope: if index == axis { 0.0 } else { size * random.random_range(-1.0..1.0) },
                    sine: size * random.random_range(-1.0..1.0),
                    phase: random.random_range(0.0..TAU),
                    cube: size * random.random_range(-0.5..0.5),
                };
            }
            curves[axis].slope = 30.0 * random.random_range(-1.0..1.0);
        }
        Self { chain, errors, backlash_um: [3.0, 5.0, 2.0] }
    }

    /// Actual less commanded position of the tool, µm.
    fn error_um(&self, at_mm: [f64; 3]) -> [f64; 3] {
        let mut tool = Isometry3::identity();
        for axis in self.chain {
            let part = (at_mm[axis] - LOW_MM[axis]) / (HIGH_MM[axis] - LOW_MM[axis]);
            let value = |index: usize| self.errors[axis][index].at(part);
            let mut way = Vector3::new(value(0), value(1), value(2)) * 1e-3;
            way[axis] += at_mm[axis];
            let turn = Vector3::new(value(3), value(4), value(5)) * 1e-6;
            tool *= Isometry3::from_parts(Translation3::from(way), UnitQuaternion::from_scaled_axis(turn));
        }
        [0, 1, 2].map(|axis| 1e3 * (tool.translation.vector[axis] - at_mm[axis]))
    }

    /// A positioning test: three runs in both directions at 21 targets.
    fn positioning(&self, axis: usize, at_mm: [f64; 3], random: &mut ChaCha8Rng) -> String {
        let mut text = "run,approach,target_mm,deviation_um\n".to_owned();
        for run in 1..=3 {
            for (sign, mark) in [(1.0, "+"), (-1.0, "-")] {
                for index in 0..=20 {
                    let step = if sign > 0.0 { index } else { 20 - index };
                    let mut place_mm = at_mm;
                    place_mm[axis] = LOW_MM[axis] + (HIGH_MM[axis] - LOW_MM[axis]) * f64::from(step) / 20.0;
                    let um = self.error_um(place_mm)[axis] - sign * self.backlash_um[axis] / 2.0
                        + noise_um(random);
                    text += &format!("{run},{mark},{:.4},{um:.4}\n", place_mm[axis]);
                }
            }
        }
        text
    }

    /// The table of a ballbar: a turn in each direction.
    fn circle(
        &self,
        plane: [usize; 2],
        centre_mm: [f64; 3],
        radius_mm: f64,
        random: &mut ChaCha8Rng,
    ) -> String {
        let mut text = "angle_deg,radius_um,direction\n".to_owned();
        for (sign, name) in [(1.0, "ccw"), (-1.0, "cw")] {
            for index in 0..720 {
                let degrees = sign * f64::from(index) / 2.0;
                let (sin, cos) = degrees.to_radians().sin_cos();
                let mut place_mm = centre_mm;
                place_mm[plane[0]] += radius_mm * cos;
                place_mm[plane[1]] += radius_mm * sin;
                let mut error_um = self.error_um(place_mm);
                error_um[plane[0]] += 0.5 * self.backlash_um[plane[0]] * sign * sin.signum();
                error_um[plane[1]] -= 0.5 * self.backlash_um[plane[1]] * sign * cos.signum();
                let mismatch_um = sign * 4.0 * 2.0 * sin * cos;
                let um = error_um[plane[0]] * cos + error_um[plane[1]] * sin + mismatch_um - 7.0
                    + noise_um(random);
                text += &format!("{degrees},{um:.4},{name}\n");
            }
        }
        text
    }
}

/// Evenly distributed, 0.35 µm rms.
fn noise_um(random: &mut ChaCha8Rng) -> f64 {
    random.random_range(-0.6..0.6)
}

/// Lines along the axes and circles in the three planes, at places; what is held out is elsewhere.
struct Places {
    lines: Vec<(usize, [f64; 3], bool)>,
    circles: Vec<([usize; 2], [f64; 3], bool)>,
}

fn survey(folder: &Path, machine: &Machine, places: &Places, seed: u64) -> Survey {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let names = ["x", "y", "z"];
    let chain = machine.chain.map(|axis| format!("\"{}\"", names[axis])).join(", ");
    let mut toml = format!("chain = [{chain}]\n");
    for (index, (axis, at_mm, is_held_out)) in places.lines.iter().enumerate() {
        let file = format!("line{index}.csv");
        fs::write(folder.join(&file), machine.positioning(*axis, *at_mm, &mut random)).unwrap();
        let others = (0..3).filter(|other| other != axis);
        let at = others
            .map(|other| format!("{} = {:.1}", names[other], at_mm[other]))
            .collect::<Vec<_>>()
            .join(", ");
        toml += &format!(
            "[[positioning]]\nfile = \"{file}\"\naxis = \"{}\"\nat_mm = {{ {at} }}\nvalidate = {is_held_out}\n",
            names[*axis]
        );
    }
    for (index, (plane, at_mm, is_held_out)) in places.circles.iter().enumerate() {
        let file = format!("circle{index}.csv");
        let radius_mm = if *is_held_out { 90.0 } else { 120.0 };
        fs::write(folder.join(&file), machine.circle(*plane, *at_mm, radius_mm, &mut random)).unwrap();
        let [x, y, z] = at_mm;
        toml += &format!(
            "[[circle]]\nfiles = [\"{file}\"]\nplane = [\"{}\", \"{}\"]\nat_mm = {{ x = {x:.1}, y = {y:.1}, z = {z:.1} }}\nradius_mm = {radius_mm:.1}\nvalidate = {is_held_out}\n",
            names[plane[0]], names[plane[1]]
        );
    }
    Survey::parse(&toml, &folder.join("survey.toml")).unwrap()
}

/// A line of each axis and a circle in each plane: the least that shows positioning, squareness and straightness.
fn few() -> Places {
    let middle = [250.0, 200.0, -150.0];
    Places {
        lines: (0..3).map(|axis| (axis, middle, false)).collect(),
        circles: [[0, 1], [0, 2], [1, 2]].map(|plane| (plane, middle, false)).to_vec(),
    }
}

/// Three lines, each at a place of its own, and circles about one centre: tilts are open, and with them some squareness; positioning is that of
/// the line.
fn apart() -> Places {
    let lines = [[0.0, 50.0, -30.0], [100.0, 0.0, -200.0], [400.0, 300.0, 0.0]];
    let lines = (0..3).map(|axis| (axis, lines[axis], false)).collect();
    Places { lines, ..few() }
}

/// Lines at several places and circles at both ends of the third axis.
fn many() -> Places {
    let middle = [250.0, 200.0, -150.0];
    let mut places = few();
    for (axis, other, mm) in
        [(0, 1, 30.0), (0, 2, -20.0), (1, 0, 40.0), (1, 2, -280.0), (2, 0, 450.0), (2, 1, 370.0)]
    {
        let mut at_mm = middle;
        at_mm[other] = mm;
        places.lines.push((axis, at_mm, false));
    }
    for (plane, third, both_mm) in
        [([0, 1], 2, [-280.0, -20.0]), ([0, 2], 1, [30.0, 370.0]), ([1, 2], 0, [30.0, 470.0])]
    {
        for mm in both_mm {
            let mut at_mm = middle;
            at_mm[third] = mm;
            places.circles.push((plane, at_mm, false));
        }
    }
    places.lines.push((0, [250.0, 60.0, -60.0], true));
    // Within the positions at which the straightness was seen: beyond them the tables hold the last value.
    places.circles.push(([0, 1], [275.0, 220.0, -80.0], true));
    places
}

fn analysed(machine: &Machine, places: &Places, seed: u64) -> Analysis {
    let folder = tempfile::tempdir().unwrap();
    let survey = survey(folder.path(), machine, places, seed);
    analyse(survey.chain, sources::read(&survey).unwrap()).unwrap()
}

/// The rms over the volume of true errors, µm, and of what the result leaves of them. A displacement and a turn of the whole machine are
/// fitted to each and removed: no measurement between tool and workpiece shows them.
fn before_and_after_um(machine: &Machine, analysis: &Analysis) -> [f64; 2] {
    let mut random = ChaCha8Rng::seed_from_u64(99);
    // The volume that was measured, without its outermost tenth, where polynomials of a low degree end.
    let points: Vec<[f64; 3]> = (0..400)
        .map(|_| {
            [0, 1, 2].map(|axis| {
                let [low, high] = analysis.measured_mm[axis];
                low + (high - low) * random.random_range(0.1..0.9)
            })
        })
        .collect();
    let errors = |is_after: bool| -> Vec<[f64; 3]> {
        let of = |at_mm: &[f64; 3]| {
            let (truth, known) = (machine.error_um(*at_mm), analysis.error_um(*at_mm));
            [0, 1, 2].map(|axis| truth[axis] - if is_after { known[axis] } else { 0.0 })
        };
        points.iter().map(of).collect()
    };
    [false, true].map(|is_after| {
        let errors = errors(is_after);
        let matrix = nalgebra::DMatrix::from_fn(3 * points.len(), 6, |row, column| {
            let (at_mm, axis) = (points[row / 3], row % 3);
            match column {
                0..=2 => f64::from(u8::from(column == axis)),
                3 => [0.0, -at_mm[2], at_mm[1]][axis],
                4 => [at_mm[2], 0.0, -at_mm[0]][axis],
                _ => [-at_mm[1], at_mm[0], 0.0][axis],
            }
        });
        let values = nalgebra::DVector::from_iterator(3 * points.len(), errors.into_iter().flatten());
        let solved = matrix.clone().svd(true, true).solve(&values, 1e-12).unwrap();
        ((values - matrix * solved).norm_squared() / points.len() as f64).sqrt()
    })
}

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
    let error = sources::read(&survey).unwrap_err().to_string();
    assert!(error.contains("circle0.csv: expected a circle in both directions"), "{error}");
}

/// The error at a position by the tables of Beckhoff alone, read by this function: levers from the zero of the machine.
fn beckhoff_um(text: &str, chain: [usize; 3], at_mm: [f64; 3]) -> [f64; 3] {
    let mut own = [[0.0; 6]; 3];
    for (axis, block) in text.split('#').enumerate() {
        let rows: Vec<Vec<f64>> = block
            .lines()
            .filter(|line| line.starts_with(|c: char| c.is_ascii_digit() || c == '-'))
            .map(|line| line.split(' ').map(|value| value.parse().unwrap()).collect())
            .collect();
        let after = rows.iter().position(|row| row[0] > at_mm[axis]).unwrap_or(rows.len() - 1).max(1);
        let part = (at_mm[axis] - rows[after - 1][0]) / (rows[after][0] - rows[after - 1][0]);
        own[axis] = [1, 2, 3, 4, 5, 6]
            .map(|column| rows[after - 1][column] * (1.0 - part) + rows[after][column] * part);
    }
    let mut error_mm = Vector3::zeros();
    for (place, axis) in chain.into_iter().enumerate() {
        let mut lever_mm = Vector3::zeros();
        for other in &chain[place + 1..] {
            lever_mm[*other] = at_mm[*other];
        }
        let [x, y, z, a, b, c] = own[axis];
        error_mm += Vector3::new(x, y, z) + Vector3::new(a, b, c).cross(&lever_mm);
    }
    [0, 1, 2].map(|axis| 1e3 * error_mm[axis])
}

fn points() -> Vec<[f64; 3]> {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let point = |_| [0, 1, 2].map(|axis| random.random_range(LOW_MM[axis]..HIGH_MM[axis]));
    (0..200).map(point).collect()
}

/// To the digits that are written: 10⁻⁶ mm, and 10⁻⁹ rad over 800 mm.
#[test]
fn tables_of_beckhoff_have_the_errors() {
    let machine = Machine::random(41, [1, 0, 2], 15.0);
    let analysis = analysed(&machine, &many(), 41);
    let text = volume::beckhoff::csv(&analysis);
    assert!(text.contains("\nX EXX EYX EZX EAX EBX ECX\n") && text.contains("#\nZ EXZ"), "{text}");
    for at_mm in points() {
        let (own, read) = (analysis.error_um(at_mm), beckhoff_um(&text, [1, 0, 2], at_mm));
        let largest_um = (0..3).map(|axis| (own[axis] - read[axis]).abs()).fold(0.0, f64::max);
        assert!(largest_um < 0.01, "{at_mm:?}: {own:?} {read:?}");
    }
}

/// The plain C of the component, compiled: the errors of the analysis to the digits that are written.
#[test]
fn the_component_of_linuxcnc_computes_the_errors() {
    let machine = Machine::random(42, [2, 1, 0], 15.0);
    let analysis = analysed(&machine, &many(), 42);
    let text = volume::linuxcnc::component(&analysis);
    let [from, to] = volume::linuxcnc::PLAIN;
    let plain = text.split_once(from).unwrap().1.split_once(to).unwrap().0;
    let folder = tempfile::tempdir().unwrap();
    let main = "\n#include <stdio.h>\nint main(void) { double p[3], e[3]; while (scanf(\"%lf %lf %lf\", p, p + 1, p + 2) == 3) { \
                volume_error(p, e); printf(\"%.9f %.9f %.9f\\n\", e[0], e[1], e[2]); } return 0; }\n";
    fs::write(folder.path().join("volume.c"), plain.to_owned() + main).unwrap();
    let build = Command::new("cc")
        .args(["-Wall", "-Werror", "-o", "volume", "volume.c"])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(build.status.success(), "{}", String::from_utf8_lossy(&build.stderr));
    // The whole component, where LinuxCNC is installed.
    if Command::new("halcompile").arg("--help").output().is_ok() {
        fs::write(folder.path().join("volumekins.comp"), &text).unwrap();
        let whole = ["--compile", "volumekins.comp"];
        let build = Command::new("halcompile").args(whole).current_dir(&folder).output().unwrap();
        assert!(build.status.success(), "{}", String::from_utf8_lossy(&build.stderr));
    }
    let input: String = points().iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
    fs::write(folder.path().join("points"), input).unwrap();
    let points_file = fs::File::open(folder.path().join("points")).unwrap();
    let run = Command::new(folder.path().join("volume")).stdin(points_file).output().unwrap();
    let lines = String::from_utf8(run.stdout).unwrap();
    assert_eq!(lines.lines().count(), points().len());
    for (at_mm, line) in points().into_iter().zip(lines.lines()) {
        let computed: Vec<f64> = line.split(' ').map(|value| 1e3 * value.parse::<f64>().unwrap()).collect();
        let own = analysis.error_um(at_mm);
        let largest_um = (0..3).map(|axis| (own[axis] - computed[axis]).abs()).fold(0.0, f64::max);
        assert!(largest_um < 0.002, "{at_mm:?}: {own:?} {computed:?}");
    }
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
