//! The files of controls have the errors.

use std::fs;
use std::process::Command;

use nalgebra::Vector3;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::machine::{HIGH_MM, LOW_MM, Machine};
use super::places::{analysed, many};

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
