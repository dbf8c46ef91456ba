//! `compensate --format`: a machine of which neither masses nor gains are known, and files for another control.

use super::work_folder::WorkFolder;
use serde_json::Value;

/// x is behind by a gap and stretch, y moves too far by 400 µm/m.
const MACHINE: &str = r#"name = "mill"
sample_rate_hz = 1000.0

[axis.x]
drive = "velocity"
position_gain_per_s = 50.0
feedforward_percent = 100.0

[[axis.x.effect]]
name = "lost_motion"
width_um = 9.0

[axis.y]
drive = "stepper"

[[axis.y.effect]]
name = "pitch_progressive"
slope_um_per_m = 400.0
"#;

const CIRCLE: &str = r#"name = "circle"
feed_mm_per_min = 1200.0
acceleration_m_per_s2 = 0.5
start_mm = { x = 20.0, y = 0.0 }

[[block]]
arc = { plane = ["x", "y"], centre_mm = { x = 0.0, y = 0.0 }, turns = 1.0 }

[[block]]
arc = { plane = ["x", "y"], centre_mm = { x = 0.0, y = 0.0 }, turns = -1.0 }
"#;

const COMPENSATE: &str = "compensate --model machine.toml --motion motion.toml --out c.toml --json out.json";

fn folder() -> WorkFolder {
    WorkFolder::with(&[("machine.toml", MACHINE), ("motion.toml", CIRCLE)])
}

/// The tables are written, the program says what it assumes of the drive, and the compensated machine is better: the slope at 20 mm is
/// 8 µm, half of the lost motion 4.5 µm.
#[test]
fn a_machine_without_masses_gets_the_files_of_its_control() {
    let folder = folder();
    let text = folder.succeeds(&format!("{COMPENSATE} --format linuxcnc --out-dir ini"));
    assert!(text.contains("the bandwidth of its drive is not known"), "{text}");
    assert!(text.contains("ini: y.comp, joints.ini"), "{text}");
    let ini = folder.read("ini/joints.ini");
    assert!(ini.contains("[JOINT_0]\n# axis x\nBACKLASH = 0.009000\n"), "{ini}");
    assert!(ini.contains("[JOINT_1]\n# axis y\nCOMP_FILE = y.comp\nCOMP_FILE_TYPE = 1\n"), "{ini}");
    let last = folder.read("ini/y.comp").lines().last().unwrap().to_owned();
    let numbers: Vec<f64> = last.split(' ').map(|word| word.parse().unwrap()).collect();
    assert!(numbers[0] > 20.0 && (numbers[1] + 400e-6 * numbers[0]).abs() < 2e-6, "{last}");
    assert!(!folder.read("ini/README.txt").is_empty());
    let json: Value = serde_json::from_str(&folder.read("out.json")).unwrap();
    let predicted = &json["predicted"][0];
    let [before_um, after_um] = ["before_um", "after_um"].map(|key| predicted[key].as_f64().unwrap());
    assert!((2.0..8.0).contains(&before_um) && after_um < 0.5 * before_um, "{before_um} {after_um}");
    assert_eq!(json["assumed"][0]["axis"], "x");
    let simulated = folder.succeeds(
        "simulate --machine machine.toml --motion motion.toml --compensation c.toml --out after.csv",
    );
    assert!(simulated.contains("the bandwidth of its drive is not known"), "{simulated}");
}

#[test]
fn a_format_needs_a_folder() {
    let error = folder().fails(&format!("{COMPENSATE} --format siemens"), 2);
    assert!(error.contains("--out-dir"), "{error}");
    let error = folder().fails(&format!("{COMPENSATE} --format heidenham --out-dir com"), 2);
    assert!(error.contains("heidenhain"), "{error}");
}
