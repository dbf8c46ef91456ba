//! Each file read by the rules of its control, and its whole text.

use commissioning::compensate::CompensationFile;
use commissioning::compensate::file::AxisCompensation;
use commissioning::compensate::servo::ControllerChange;
use model::machine::Machine;
use shared::compensate::CompensationSettings;
use shared::compensate::settings::{
    Cycle, Factor, ForceModel, Pitch, PitchSource, Points, Product, TableFriction,
};

use crate::{Control, ControlFile, Written, write};

/// A screw of 50 µm/m and a bow of 3 µm over ±50 mm, and its backlash, µm.
const BACKLASH_UM: f64 = 6.0;

fn error_um(x_mm: f64) -> f64 {
    0.05 * x_mm + 3.0 * (0.03 * x_mm).cos()
}

fn machine() -> Machine {
    let text = "name = \"mill\"\nsample_rate_hz = 1000.0\n[axis.x]\ndrive = \"velocity\"\nposition_gain_per_s = 50.0\n\
                feedforward_percent = 80.0\n[axis.y]\ndrive = \"stepper\"\n";
    Machine::parse(text, "mill.toml").unwrap()
}

fn points(count: usize, value: impl Fn(f64) -> f64) -> Points {
    let spacing_m = 0.1 / (count - 1) as f64;
    let values = (0..count).map(|k| 1e-6 * value(1e3 * (spacing_m * k as f64 - 0.05))).collect();
    Points { start_m: -0.05, spacing_m, values }
}

/// x has a table, a backlash and a feed-forward; y, a stepper motor, has a backlash alone.
fn compensation() -> CompensationFile {
    let x = CompensationSettings {
        pitch: Some(Pitch { of: PitchSource::Screw, forward: points(64, error_um), backward: None }),
        backlash_width_m: Some(1e-6 * BACKLASH_UM),
        squareness: Some((1, 20e-6)),
        ..CompensationSettings::default()
    };
    let y = CompensationSettings { backlash_width_m: Some(9e-6), ..CompensationSettings::default() };
    let controller = ControllerChange {
        feedforward_percent: Some(98.0),
        feedforward_ahead_s: Some(0.002),
        ..ControllerChange::default()
    };
    let of = |compensation, controller| AxisCompensation {
        mapped_mm: Some([-50.0, 50.0]),
        controller,
        compensation,
    };
    let axis = [("x".to_owned(), of(x, controller)), ("y".to_owned(), of(y, ControllerChange::default()))];
    CompensationFile { axis: axis.into_iter().collect(), ..CompensationFile::none(&machine()) }
}

fn written(control: Control) -> Written {
    write(control, &machine(), &compensation())
}

fn file(written: &Written, name: &str) -> String {
    written.files.iter().find(|file| file.name == name).unwrap_or_else(|| panic!("no {name}")).text.clone()
}

/// Asserts that a table of positions (mm) and errors of both directions (µm) is that of the axis within a resolution, µm.
fn assert_table(rows: &[[f64; 3]], resolution_um: f64) {
    assert!(rows.len() >= 32 && rows.windows(2).all(|pair| pair[0][0] < pair[1][0]));
    assert!((rows[0][0] + 50.0).abs() < 1e-3 && (rows[rows.len() - 1][0] - 50.0).abs() < 1e-3);
    for [x_mm, forward_um, backward_um] in rows {
        let [forward, backward] = [-0.5, 0.5].map(|half| error_um(*x_mm) + half * BACKLASH_UM);
        assert!((forward_um - forward).abs() <= resolution_um, "{x_mm}: {forward_um} {forward}");
        assert!((backward_um - backward).abs() <= resolution_um, "{x_mm}: {backward_um} {backward}");
    }
}

fn numbers(line: &str) -> Vec<f64> {
    line.split([' ', ',']).map(|word| word.parse().unwrap()).collect()
}

/// motor = command + trim, and table = motor + error less half of the backlash: together the command.
#[test]
fn a_comp_file_takes_the_error_back() {
    let written = written(Control::Linuxcnc);
    let text = file(&written, "x.comp");
    assert!(text.lines().count() <= 256);
    let row = |line: &str| {
        let [x_mm, forward_mm, reverse_mm] = numbers(line)[..] else { panic!("{line}") };
        [x_mm, -1e3 * forward_mm, -1e3 * reverse_mm]
    };
    // A position is rounded to 0.1 µm, over which the error is the same; a trim to 1 nm.
    assert_table(&text.lines().map(row).collect::<Vec<_>>(), 0.001);
    let ini = file(&written, "joints.ini");
    let section =
        |name: &str| ini.split('[').find_map(|section| section.strip_prefix(&format!("{name}]"))).unwrap();
    assert!(section("JOINT_0").contains("COMP_FILE = x.comp\nCOMP_FILE_TYPE = 1\n"));
    assert!(!section("JOINT_0").contains("BACKLASH"));
    assert!(section("JOINT_0").contains("# FF1 was 0.800000\nFF1 = 0.980000\n"));
    assert!(section("JOINT_0").contains("FF2 = 0.001960\n"));
    assert!(section("JOINT_1").contains("BACKLASH = 0.009000\n") && !section("JOINT_1").contains("FF1"));
    assert!(written.remarks.iter().any(|remark| remark.contains("squareness") && remark.contains("HAL")));
}

/// Torque drives with friction, masses and stretch: N, mm and s; the stretch under 180 N with 200 N/µm is 0.9 µm in either direction.
#[test]
fn forces_of_torque_drives_are_lines_for_linuxcnc() {
    let text = "name = \"mill\"\nsample_rate_hz = 1000.0\n[axis.x]\nposition_gain_per_s = 50.0\n";
    let machine = Machine::parse(text, "mill.toml").unwrap();
    let friction = TableFriction {
        coulomb_n: 180.0,
        viscous_n_s_per_m: 1000.0,
        presliding_stiffness_n_per_m: Some(4e7),
        ..TableFriction::default()
    };
    let force = ForceModel {
        motor_mass_kg: 90.0,
        table_mass_kg: 160.0,
        motor_coulomb_n: 30.0,
        friction,
        ..ForceModel::default()
    };
    let compensation = CompensationSettings {
        force: Some(force),
        stretch_m_per_n: Some(1.0 / 200e6),
        ..CompensationSettings::default()
    };
    let x = AxisCompensation { mapped_mm: None, controller: ControllerChange::default(), compensation };
    let axis = [("x".to_owned(), x)].into_iter().collect();
    let file = CompensationFile { axis, ..CompensationFile::none(&machine) };
    let written = write(Control::Linuxcnc, &machine, &file);
    let ini = self::file(&written, "joints.ini");
    for line in [
        "BACKLASH = 0.001800",
        "FORCE_FF1 = 1.000000",
        "FORCE_FF2 = 0.250000",
        "FRICTION = 180.000000",
        "FRICTION_PER_MM = 222.222222",
        "MOTOR_FRICTION = 30.000000",
        "MOTOR_FRICTION_FF1 = 150.000000",
    ] {
        assert!(ini.lines().any(|found| found == line), "{line}: {ini}");
    }
    assert!(written.remarks.iter().any(|remark| remark.contains("HAL file")), "{:?}", written.remarks);
}

/// A drive with a time constant of 4 ms needs 4 mm/s more for a friction of 1 m/s²; an integral part of 16 ms makes up for 6 % of it in
/// each millisecond.
#[test]
fn the_friction_of_a_velocity_drive_is_a_velocity_for_linuxcnc() {
    let text = "name = \"mill\"\nsample_rate_hz = 1000.0\n[axis.x]\ndrive = \"velocity\"\nposition_gain_per_s = 50.0\n\
                [axis.x.log_offsets]\nvelocity_time_constant_ms = 4.0\nvelocity_integral_per_s = 62.5\nvelocity_friction_m_per_s2 = 1.0\n";
    let machine = Machine::parse(text, "mill.toml").unwrap();
    let friction = TableFriction { coulomb_n: plant::equivalent::MOTOR_KG, ..TableFriction::default() };
    let force = ForceModel { friction, ..ForceModel::default() };
    let compensation = CompensationSettings { force: Some(force), ..CompensationSettings::default() };
    let x = AxisCompensation { mapped_mm: None, controller: ControllerChange::default(), compensation };
    let axis = [("x".to_owned(), x)].into_iter().collect();
    let file = CompensationFile { axis, ..CompensationFile::none(&machine) };
    let ini = self::file(&write(Control::Linuxcnc, &machine, &file), "joints.ini");
    assert!(
        ini.contains("FRICTION = 4.000000\nFRICTION_PER_MM = 200.000000\nFRICTION_DECAY = 0.060587\n"),
        "{ini}"
    );
}

/// A positive value moves the axis in negative direction: it is the error. Half of the backlash on each side is MD32450.
#[test]
fn the_siemens_values_are_the_error() {
    let written = written(Control::Siemens);
    let text = file(&written, "AX_EEC.INI");
    let value = |key: &str| -> f64 {
        let line = text.lines().find_map(|line| line.strip_prefix(&format!("{key}="))).unwrap();
        line.parse().unwrap()
    };
    let [step_mm, least_mm, most_mm] =
        ["STEP", "MIN", "MAX"].map(|name| value(&format!("$AA_ENC_COMP_{name}[0,X1]")));
    let count =
        text.lines().filter(|line| line.starts_with("$AA_ENC_COMP[0,") && line.contains(",X1]")).count();
    assert!(count <= 200 && (least_mm + step_mm * (count - 1) as f64 - most_mm).abs() < 1e-3);
    let machine_data = file(&written, "machine_data.txt");
    assert!(machine_data.contains("$MA_BACKLASH[0,X1]=0.006000\n"), "{machine_data}");
    assert!(machine_data.contains("$MA_BACKLASH[0,Y1]=0.009000\n") && !text.contains("Y1"));
    let row = |k: usize| {
        let um = 1e3 * value(&format!("$AA_ENC_COMP[0,{k},X1]"));
        [least_mm + step_mm * k as f64, um - 0.5 * BACKLASH_UM, um + 0.5 * BACKLASH_UM]
    };
    assert_table(&(0..count).map(row).collect::<Vec<_>>(), 0.002);
}

#[test]
fn the_heidenhain_table_has_both_directions() {
    let written = written(Control::Heidenhain);
    let text = file(&written, "X.COM");
    let rows = text.lines().skip(2).take_while(|line| *line != "[END]");
    let row = |line: &str| {
        let [_, x_mm, backward_mm, forward_mm] = numbers(line)[..] else { panic!("{line}") };
        [x_mm, 1e3 * forward_mm, 1e3 * backward_mm]
    };
    assert_table(&rows.map(row).collect::<Vec<_>>(), 0.01);
    assert!(written.remarks.iter().any(|remark| remark.contains("Sign")));
    assert!(written.remarks.iter().any(|remark| remark.contains("0.0090 mm")));
}

#[test]
fn the_beckhoff_list_has_actual_less_commanded() {
    let written = written(Control::Beckhoff);
    let text = file(&written, "achskw_x.lis");
    let values = |name: &str| -> Vec<f64> {
        let of = |line: &str| {
            let (key, value) = line.split_once(' ')?;
            (key.starts_with("kw.ssfk.table[") && key.ends_with(name)).then(|| value.trim().parse().unwrap())
        };
        text.lines().filter_map(of).collect()
    };
    let [at, pos, neg] = [".setpoint", ".pos", ".neg"].map(values);
    let rows = at.iter().zip(pos.iter().zip(&neg)).map(|(x, (p, n))| [1e-4 * x, 0.1 * p, 0.1 * n]);
    // Tenths of a micrometre.
    assert_table(&rows.collect::<Vec<_>>(), 0.051);
    assert!(file(&written, "axis_y.txt").contains("getriebe[0].lose                     90\n"));
}

/// The points are the changes of the compensation, the opposite of the error, in micrometres.
#[test]
fn the_sum_of_the_fanuc_points_is_the_error() {
    let written = written(Control::Fanuc);
    let text = file(&written, "parameters.txt");
    let value = |key: &str| -> f64 {
        let line = text.lines().find_map(|line| line.strip_prefix(key)).unwrap_or_else(|| panic!("no {key}"));
        line.parse().unwrap()
    };
    let [reference, first, last, magnification, interval_um] =
        [3620, 3621, 3622, 3623, 3624].map(|number| value(&format!("N{number} A1 P")));
    assert!(text.contains("N1851 A1 P6\n") && text.contains("N1851 A2 P9\n"));
    assert!(last - first < 128.0);
    let points = text.lines().filter(|line| line.starts_with("N100"));
    let steps: Vec<f64> = points.map(|line| line.split_once(" P").unwrap().1.parse().unwrap()).collect();
    assert!((steps.len() as f64 - (last - first + 1.0)).abs() < 0.5);
    assert!(steps.iter().all(|step| step.abs() <= 7.0));
    let mut sum_um = -error_um(-50.0);
    let row = |(k, step): (usize, &f64)| {
        sum_um += magnification * step;
        let x_mm = 1e-3 * interval_um * (k as f64 - reference + first) + 0.0;
        [x_mm, sum_um]
    };
    let rows: Vec<[f64; 2]> = steps.iter().enumerate().map(row).collect();
    // Half of a unit of the points, and what the error changes over half of their distance, 0.8 mm at 0.14 µm/mm.
    let worst_um = numerics::max_abs(rows.iter().map(|[x_mm, um]| um + error_um(*x_mm)));
    assert!(worst_um <= 0.5 * magnification + 0.15, "{worst_um} {magnification}");
}

#[test]
fn a_control_without_tables_gets_the_backlash_and_says_what_is_missing() {
    let grblhal = written(Control::Grblhal);
    assert_eq!(file(&grblhal, "grblhal.txt"), "$160=0.0060\n$161=0.0090\n");
    assert!(grblhal.remarks.iter().any(|remark| remark.contains("the error over the position is not")));
    assert_eq!(file(&written(Control::Marlin), "marlin.gcode"), "M425 F1 X0.0060 Y0.0090\nM500\n");
}

#[test]
fn the_table_for_any_control_is_the_error() {
    let text = file(&written(Control::Csv), "x.csv");
    let row = |line: &str| <[f64; 3]>::try_from(numbers(line)).unwrap();
    assert_table(&text.lines().skip(1).map(row).collect::<Vec<_>>(), 0.002);
}

/// 128 points over 100 mm resolve a period of 10 mm with 12 points, and not one of 2 mm with 8.
#[test]
fn periodic_errors_are_in_the_table_where_its_points_resolve_them() {
    let with_period = |period_m: f64, control| {
        let mut compensation = compensation();
        let x = &mut compensation.axis["x"].compensation;
        x.pitch = None;
        x.screw = [Cycle::harmonic(4e-6, period_m, 0.0)].into_iter().collect();
        write(control, &machine(), &compensation)
    };
    let resolved = file(&with_period(0.01, Control::Csv), "x.csv");
    for line in resolved.lines().skip(1) {
        let [x_mm, forward_um, _] = <[f64; 3]>::try_from(numbers(line)).unwrap();
        let expected_um = 4.0 * (std::f64::consts::TAU * x_mm / 10.0).sin() - 0.5 * BACKLASH_UM;
        // The controller's own table has 64 points a period: 0.1 %.
        assert!((forward_um - expected_um).abs() < 0.01, "{x_mm}: {forward_um} {expected_um}");
    }
    let coarse = with_period(0.002, Control::Fanuc);
    assert!(coarse.remarks.iter().any(|remark| remark.contains("periodic error of 2 mm")), "{coarse:?}");
}

/// The whole text of each file: what a user has entered once stays what it was.
#[test]
fn the_files_are_these() {
    let names = [
        ("linuxcnc", Control::Linuxcnc),
        ("siemens", Control::Siemens),
        ("heidenhain", Control::Heidenhain),
        ("fanuc", Control::Fanuc),
        ("beckhoff", Control::Beckhoff),
        ("csv", Control::Csv),
    ];
    for (name, control) in names {
        let one = |ControlFile { name, text }: &ControlFile| format!("== {name}\n{text}");
        let all: Vec<String> = written(control).files.iter().map(one).collect();
        insta::assert_snapshot!(name, all.join("\n"));
    }
}

/// No control has a setting for a product of several variables: it is named for each, and not dropped without a word.
#[test]
fn products_are_named_as_left_out() {
    let mut file = compensation();
    let factors =
        [Factor::Position { axis: 0, full_scale_m: 0.1 }, Factor::Position { axis: 1, full_scale_m: 0.1 }];
    let product = Product { amplitude_m: 1e-6, factors: factors.into_iter().collect() };
    file.axis["x"].compensation.products = [product].into_iter().collect();
    for control in [
        Control::Linuxcnc,
        Control::Siemens,
        Control::Heidenhain,
        Control::Fanuc,
        Control::Beckhoff,
        Control::Grblhal,
        Control::Marlin,
        Control::Csv,
    ] {
        let said = |file: &CompensationFile| {
            let remarks = write(control, &machine(), file).remarks;
            remarks.iter().any(|remark| remark.starts_with("x: a law of several variables"))
        };
        assert!(said(&file) && !said(&compensation()), "{control:?}");
    }
}
