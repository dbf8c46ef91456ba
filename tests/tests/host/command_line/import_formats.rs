//! Binary formats: what is written is read back, by this program and by Python's libraries, and what those write is read.
//!
//! Python is asked where `python3` has the libraries (`pip install numpy scipy pyarrow mcap pytcs`); elsewhere those tests are skipped with a
//! message.

use std::io::{Write, stderr};
use std::path::Path;
use std::process::Command;

use files::log::{Channel, Log};

use super::work_folder::{MACHINE, WorkFolder, log};

/// Runs a script in a folder and gives its stdout; `None` where `python3` or a library is missing, with a message on stderr.
pub fn python(folder: &Path, libraries: &str, script: &str) -> Option<String> {
    let has = |code: &str| {
        Command::new("python3").args(["-c", code]).output().is_ok_and(|run| run.status.success())
    };
    if !has(&format!("import {libraries}")) {
        // Not `eprintln!`: the harness does not show its output of a passing test.
        let _ = writeln!(stderr(), "SKIPPED: python3 has not all of {libraries}");
        return None;
    }
    let run = Command::new("python3").args(["-c", script]).current_dir(folder).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    Some(String::from_utf8(run.stdout).unwrap())
}

fn read(folder: &WorkFolder, name: &str) -> Log {
    Log::parse(folder.read(name).as_bytes(), name).unwrap()
}

/// CSV has seven decimals of a position, and the log has no more: by way of another format the text stays the same.
#[test]
fn a_log_comes_back_from_parquet_and_mcap() {
    let folder = WorkFolder::with(&[("log.csv", log())]);
    for name in ["log.parquet", "log.mcap"] {
        folder.succeeds(&format!("import log.csv --out {name}"));
        let stdout = folder.succeeds(&format!("import {name} --out back.csv"));
        assert!(stdout.contains("recognised by content"), "{stdout}");
        assert!(folder.read("back.csv") == log(), "{name}");
    }
}

/// A text export of TwinCAT Scope in German: a column of times for each channel, of 1 ms, 0.2 ms and 5 ms, with all lines of its header.
fn scope_export() -> String {
    let channels = [("x_soll", 1.0), ("x_ist", 1.0), ("fein", 0.2), ("grob", 5.0)];
    let german = |number: String| number.replace('.', ",");
    let header = |key: &str, value: &dyn Fn(&str, f64) -> String| {
        let cells: Vec<String> =
            channels.iter().map(|(name, period_ms)| format!("{key}\t{}", value(name, *period_ms))).collect();
        cells.join("\t") + "\r\n"
    };
    let mut text = "Name\tscope\r\nFile\tscope.csv\r\nStarttime of export\t132959733843760000\tMontag, 2. Mai 2022\t15:56:24.376\r\n\
                    Endtime of export\t132959733853750000\tMontag, 2. Mai 2022\t15:56:25.375\r\n\r\n\r\n"
        .to_owned();
    text += &header("Name", &|name, _| name.to_owned());
    text += &header("SymbolComment", &|_, _| String::new());
    text += &header("Data-Type", &|_, _| "REAL64".to_owned());
    text += &header("SampleTime[ms]", &|_, period_ms| german(format!("{period_ms}")));
    text += &header("SymbolName", &|name, _| format!("MAIN.{name}"));
    text += &header("Offset", &|_, _| "0".to_owned());
    text += &header("ScaleFactor", &|_, _| "1".to_owned());
    text += &header("Unit", &|_, _| "(None)".to_owned());
    text += &header("Unit ScaleFactor", &|_, _| "1".to_owned());
    text += &header("Unit Offset", &|_, _| "0".to_owned());
    text += "\r\n";
    for row in 0..5000_u32 {
        let cell = |(name, period_ms): &(&str, f64)| {
            let t_ms = f64::from(row) * period_ms;
            let mm = 10.0 * (3e-3 * t_ms).sin() - if *name == "x_ist" { 0.01 } else { 0.0 };
            if t_ms < 1000.0 { german(format!("{t_ms:.1}\t{mm:.9}")) } else { "\t".to_owned() }
        };
        text += &(channels.iter().map(cell).collect::<Vec<_>>().join("\t") + "\r\n");
    }
    text + "EOF\r\n"
}

/// pytcs, which reads exports of TwinCAT Scope, finds the values in the file that are in the imported log, within the seven decimals of that.
#[test]
fn python_reads_the_same_of_an_export_of_twincat() {
    let folder = WorkFolder::with(&[("scope.csv", scope_export())]);
    let stdout =
        folder.succeeds("import scope.csv --out log.csv --map x_command_mm=x_soll --map x_motor_mm=x_ist");
    assert!(stdout.contains("TwinCAT Scope") && stdout.contains("4 channels in 4 groups"), "{stdout}");
    assert_eq!(read(&folder, "log.csv").len(), 1000);
    let script = r#"
import csv
from pytcs import ScopeFile
scope = ScopeFile("scope.csv")
scope.load()
rows = list(csv.DictReader(open("log.csv")))
for ours, theirs in (("x_command_mm", "x_soll"), ("x_motor_mm", "x_ist")):
    channel = scope[theirs]
    assert len(channel.values) == len(rows) == 1000, (len(channel.values), len(rows))
    for row, time_ms, value in zip(rows, channel.time, channel.values):
        assert abs(float(row["time_s"]) - 1e-3 * time_ms) < 1e-9 and abs(float(row[ours]) - value) < 1e-7, row
"#;
    python(folder.path(), "pytcs", script);
}

/// pyarrow and the Python `mcap` read the numbers of the CSV, to the bit. A time of the CSV has at most nine decimals; the times of MCAP are
/// whole ns.
#[test]
fn python_reads_what_is_written() {
    let folder = WorkFolder::with(&[("log.csv", log())]);
    folder.succeeds("import log.csv --out log.parquet");
    folder.succeeds("import log.csv --out log.mcap");
    let script = r#"
import csv, json
import pyarrow.parquet
from mcap.reader import make_reader
rows = [{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(open("log.csv"))]
def check(found, what):
    assert len(found) == len(rows) > 100, (what, len(found))
    for row, other in zip(rows, found):
        assert row.keys() == other.keys(), what
        assert all(row[name] == other[name] for name in row if name != "time_s"), what
        assert abs(row["time_s"] - other["time_s"]) < 2e-9, what
check(pyarrow.parquet.read_table("log.parquet").to_pylist(), "parquet")
messages = list(make_reader(open("log.mcap", "rb")).iter_messages())
check([json.loads(message.data) for _, _, message in messages], "mcap")
for row, (schema, channel, message) in zip(rows, messages):
    assert (schema.encoding, channel.message_encoding, channel.topic) == ("jsonschema", "json", "log")
    assert set(json.loads(schema.data)["properties"]) == set(row)
    assert abs(message.log_time - 1e9 * row["time_s"]) <= 2
print("same")
"#;
    if let Some(stdout) = python(folder.path(), "pyarrow, mcap", script) {
        assert_eq!(stdout, "same\n");
    }
}

/// NumPy, SciPy and pyarrow write two channels in their own ways: matrices either way round, packed and not, single precision, whole counts,
/// missing values, dates. Each becomes the log that it was made of, within the rounding of its type.
#[test]
fn what_python_writes_is_read() {
    let folder = WorkFolder::with(&[("log.csv", log())]);
    let script = r#"
import numpy as np, scipy.io, pyarrow as pa, pyarrow.parquet
table = np.genfromtxt("log.csv", delimiter=",", names=True)
t, c, m = table["time_s"], table["x_command_mm"], table["x_motor_mm"]
np.savez_compressed("a.npz", t=t, data=np.column_stack([c, m / 25.4]))
np.savez("b.npz", t=t.astype(">f8"), data=np.asfortranarray(np.vstack([c, m / 25.4])))
np.save("c.npy", np.rec.fromarrays([t, c, m / 25.4], names="t,c,m"))
np.savetxt("d.txt", np.column_stack([t, c, m / 25.4]), header="t c m", fmt="%.12g")
scipy.io.savemat("e.mat", {"t": t, "data": np.vstack([c, m / 25.4]), "J": 0.2, "name": "rig", "s": {"a": 1}}, do_compression=True)
scipy.io.savemat("f.mat", {"t": t, "data": np.column_stack([c, m / 25.4])})
ns = pa.array(np.round(t * 1e9).astype("int64"), pa.timestamp("ns"))
columns = {"t": ns, "c": pa.array(c), "m": pa.array(m / 25.4), "what": pa.array(["x"] * len(t))}
for name, packing in [("g", "snappy"), ("h", "zstd"), ("i", "none")]:
    pyarrow.parquet.write_table(pa.table(columns), name + ".parquet", compression=packing, row_group_size=700)
pyarrow.parquet.write_table(pa.table(columns), "j.parquet", compression="gzip")
"#;
    if python(folder.path(), "numpy, scipy, pyarrow", script).is_none() {
        return;
    }
    let original = Log::parse(log().as_bytes(), "log").unwrap();
    let matrix = "--map x_command_mm=data:1 --map x_motor_mm=data:2";
    let names = "--map x_command_mm=c --map x_motor_mm=m";
    for (file, mappings) in [
        ("a.npz", matrix),
        ("b.npz", matrix),
        ("c.npy", names),
        ("d.txt", names),
        ("e.mat", matrix),
        ("f.mat", matrix),
        ("g.parquet", names),
        ("h.parquet", names),
        ("i.parquet", names),
    ] {
        folder.succeeds(&format!("import {file} --out out.csv {mappings} --unit x_motor_mm=in"));
        let found = read(&folder, "out.csv");
        assert_eq!(found.len(), original.len(), "{file}");
        assert!((found.sample_time_s / original.sample_time_s - 1.0).abs() < 1e-9, "{file}");
        for channel in [Channel::Command, Channel::Motor] {
            let of = |log: &Log| log.axis("x").unwrap().channel(channel).unwrap().to_vec();
            let pairs = of(&found).into_iter().zip(of(&original));
            // A decimal of the CSV, and the division by 25.4 that is taken back.
            let greatest = pairs.map(|(found, original)| (found - original).abs()).fold(0.0, f64::max);
            assert!(greatest < 1.5e-7, "{file}: {channel:?} {greatest}");
        }
    }
    let refused = folder.fails(&format!("import j.parquet --out no.csv {names}"), 2);
    assert!(
        refused.contains("expected columns that are packed by Snappy, Zstandard or not at all, found GZIP"),
        "{refused}"
    );
}

/// The command of docs/your-log.md on the real recording. `data` has time, reference, position (rad), velocity (rad/s), torque; facts of the
/// recording, found
/// with SciPy 1.17: the reference is zero, the axis turns by 3310.446975534937 rad in 19.999 s, the torque goes from 0.05 to 0.06 N m.
#[test]
fn the_recording_of_a_rig_is_read() {
    let Some(data) = tests::data::data_folder("data/hsm150") else { return };
    let file = data.join("idf_pos_0.06_1.mat").display().to_string();
    let folder = WorkFolder::with(&[("empty", "")]);
    let stdout = folder.succeeds(&format!(
        "import {file} --out log.csv --map time_s=data:1 --map c_command_deg=data:2 --map c_motor_deg=data:3 --map c_force_nm=data:5 \
         --unit c_command_deg=rad --unit c_motor_deg=rad"
    ));
    for said in [
        "MATLAB level 5",
        "20000 samples at 1000.000000 Hz",
        "single numbers, not used: \"Tvz\"",
        "not used: ",
    ] {
        assert!(stdout.contains(said), "{said}: {stdout}");
    }
    let log = read(&folder, "log.csv");
    let c = log.axis("c").unwrap();
    let [command, motor, torque] =
        [Channel::Command, Channel::Motor, Channel::Force].map(|channel| c.channel(channel).unwrap());
    assert!(command.iter().all(|command| command.abs() < 1e-12));
    assert!((motor[19_999] - 3_310.446_975_534_937_f64.to_degrees()).abs() < 1e-6, "{}", motor[19_999]);
    // 6.28318531e-4 rad, one step of an encoder of 10 000.
    assert!((motor[3] - 0.036).abs() < 1e-7, "{}", motor[3]);
    assert!((torque[0] - 0.05).abs() < 1e-9 && (torque[19_999] - 0.06).abs() < 1e-9);

    // The velocity is the difference of two positions over 1 ms: its integral by trapezoids lags by half of the last step.
    folder.succeeds(&format!(
        "import {file} --out velocity.csv --map time_s=data:1 --map c_motor_deg=data:4 --unit c_motor_deg=rad/s"
    ));
    let integral = read(&folder, "velocity.csv");
    let integral = integral.axis("c").unwrap().channel(Channel::Motor).unwrap();
    for (i, (integral, position)) in integral.iter().zip(motor).enumerate().skip(1) {
        let half_step = 0.5 * (motor[i] - motor[i - 1]);
        assert!((integral - (position - half_step)).abs() < 1e-3, "{i}: {integral} {position}");
    }
}

/// All values of the recording as SciPy reads them, in degrees.
#[test]
fn scipy_reads_the_same_recording() {
    let Some(data) = tests::data::data_folder("data/hsm150") else { return };
    let file = data.join("idf_pos_0.06_1.mat").display().to_string();
    let folder = WorkFolder::with(&[("empty", "")]);
    folder.succeeds(&format!("import {file} --out log.csv --map time_s=data:1 --map c_motor_deg=data:3 --map c_force_nm=Im --unit c_motor_deg=rad"));
    let script = format!(
        "import scipy.io\nm = scipy.io.loadmat({file:?})\n\
         for p, i in zip(m['data'][:, 2], m['Im'][:, 0]): print(float(p), float(i))"
    );
    let Some(stdout) = python(folder.path(), "scipy.io", &script) else { return };
    let log = read(&folder, "log.csv");
    let c = log.axis("c").unwrap();
    let (motor, current) = (c.channel(Channel::Motor).unwrap(), c.channel(Channel::Force).unwrap());
    assert_eq!(stdout.lines().count(), motor.len());
    for (i, line) in stdout.lines().enumerate() {
        let [position, other] = [0, 1].map(|cell| line.split(' ').nth(cell).unwrap().parse::<f64>().unwrap());
        // Half of the last decimal of the CSV: 1e-7 deg, 1e-4 N m.
        assert!((motor[i] - position.to_degrees()).abs() < 0.6e-7, "{i}");
        assert!((current[i] - other).abs() < 0.6e-4, "{i}");
    }
}

/// An export of TwinCAT Scope on a German computer: positions each 1 ms, the torque each 4 ms with its own times.
#[test]
fn an_export_of_twincat_is_read() {
    let mut text = "Name\tScope\r\nFile\tC:\\x.svdx\r\n\r\nName\tSoll\tIst\tName\tKraft\r\nSampleTime[ms]\t1\t1\tSampleTime[ms]\t4\r\n\r\n".to_owned();
    for i in 0..400 {
        let x = 0.01 * f64::from(i);
        let force = if i % 4 == 0 { format!("\t{i}\t{:.3}", -0.5 * f64::from(i)) } else { "\t\t".to_owned() };
        text.push_str(&format!("{i}\t{x:.3}\t{:.3}{force}\r\n", x + 0.5).replace('.', ","));
    }
    text.push_str("EOF\r\n");
    let folder = WorkFolder::with(&[("scope.csv", text)]);
    let stdout = folder.succeeds(
        "import scope.csv --out log.csv --map x_command_mm=Soll --map x_motor_mm=Ist --map x_force_n=Kraft",
    );
    assert!(
        stdout.contains("TwinCAT Scope") && stdout.contains("\"Kraft\", every 4.000000 ms, is interpolated"),
        "{stdout}"
    );
    let log = read(&folder, "log.csv");
    let x = log.axis("x").unwrap();
    // Up to the last time of the force.
    assert_eq!(log.len(), 397);
    for i in 0..397 {
        let at = |channel| x.channel(channel).unwrap()[i];
        let (command, motor, force) = (at(Channel::Command), at(Channel::Motor), at(Channel::Force));
        let t_ms = i as f64;
        assert!((command - 0.01 * t_ms).abs() < 1e-9 && (motor - command - 0.5).abs() < 1e-9, "{i}");
        assert!((force + 0.5 * t_ms).abs() < 1e-9, "{i}: {force}");
    }
}

#[test]
fn presets_and_what_no_log_can_hold_are_told_in_one_line() {
    let klipper = "#time,accel_x,accel_y,accel_z\n0.1,1.0,2.0,3.0\n0.2,1.0,2.0,3.0\n";
    let text = "0 1.5\n1 2.5\n2 3.5\n";
    let folder =
        WorkFolder::with(&[("k.csv", klipper), ("t.txt", text), ("v.csv", "t,v (mm/s)\n0,1\n1,2\n")]);
    for (arguments, expected) in [
        (
            "import k.csv --out o.csv",
            "k.csv: accelerations that Klipper recorded: a log has positions and forces",
        ),
        ("import t.txt --out o.csv --preset matlab", "t.txt: expected a MAT-file of level 5"),
        ("import t.txt --out o.csv --preset parquet", "t.txt: expected a Parquet file"),
        ("import t.txt --out o.csv --preset mcap", "t.txt: expected an MCAP file"),
        ("import t.txt --out o.csv --preset numpy", "t.txt: expected an archive of NumPy"),
        (
            "import t.txt --out o.csv --preset twincat",
            "t.txt: expected a line of names that begins with Name",
        ),
        ("import v.csv --out o.csv --map x_motor_mm=v", "--unit x_motor_mm=mm/s to integrate the velocity"),
        (
            "import t.txt --out o.csv --map x_motor_mm=2 --rate 9 --unit x_motor_mm=counts*1e10",
            "x_motor_mm: expected numbers from −1e9 to 1e9",
        ),
    ] {
        let stderr = folder.fails(arguments, 2);
        assert!(stderr.contains(expected), "{arguments}: {stderr}");
        assert!(!folder.path().join("o.csv").exists());
    }
    let output = folder.run("import t.txt --out o.csv --preset excel");
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && stderr.contains("halsampler, halscope, twincat"), "{stderr}");
    // With a preset, a text of numbers counts no samples.
    let mapped = "--map x_motor_mm=2 --rate 1000";
    let stdout = folder.succeeds(&format!("import t.txt --out o.csv {mapped} --preset text"));
    assert!(
        stdout.contains("separated text (preset text, as asked for)") && stdout.contains("not used: \"1\""),
        "{stdout}"
    );
    let stdout = folder.succeeds(&format!("import t.txt --out o.csv {mapped}"));
    assert!(stdout.contains("LinuxCNC halsampler (preset halsampler, recognised by content)"), "{stdout}");
}

/// A binary file with our names and units is a log for every verb that reads logs; what was assumed is on stderr.
#[test]
fn other_verbs_read_binary_files_with_our_names() {
    let folder =
        WorkFolder::with(&[("log.csv", log()), ("machine.toml", MACHINE), ("log.txt", "t;x\n0;1\n1;2\n")]);
    folder.succeeds("import log.csv --out log.parquet");
    folder.succeeds("import log.csv --out log.mcap");
    let json = |file: &str| {
        let output =
            folder.run(&format!("trace --machine machine.toml --fit {file} --evaluate --json out.json"));
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(0), "{stderr}");
        (serde_json::from_str::<serde_json::Value>(&folder.read("out.json")).unwrap(), stderr)
    };
    let (expected, stderr) = json("log.csv");
    assert_eq!(stderr, "");
    for (file, title) in [("log.parquet", "Parquet"), ("log.mcap", "MCAP")] {
        let (found, stderr) = json(file);
        assert!(
            found["residual"] == expected["residual"] && found["residual"][0]["before_um"].is_object(),
            "{file}"
        );
        assert!(stderr.starts_with(&format!("{file}: {title}")), "{stderr}");
    }
    let refused = folder.fails("trace --machine machine.toml --fit log.txt", 2);
    assert!(
        refused.contains("expected --map OURS=THEIRS")
            && refused.contains("(a log of another program is read"),
        "{refused}"
    );
}
