//! `positions`: the keys of its JSON, its page, its model, what it says of unusual tables, and what it refuses.

use serde_json::Value;

use super::work_folder::{MACHINE, WorkFolder};

/// Deviation at a target, µm: 50 µm/m, a bow of 20 µm, a gap of 8 µm, and a ripple in place of scatter.
fn deviation_um(run: u32, target: u32, sign: f64) -> f64 {
    let along = f64::from(target) - 5.0;
    let ripple = f64::from((run * 7919 + target * 104_729 + u32::from(sign > 0.0) * 31) % 101) / 101.0 - 0.5;
    5.0 * along + 0.8 * along * along - 4.0 * sign + ripple
}

/// The lines of a test of 11 targets, 100 mm apart, both ways, for these runs.
fn lines(runs: std::ops::RangeInclusive<u32>) -> Vec<String> {
    let mut lines = Vec::new();
    for run in runs {
        let there = (0..11).map(|target| (target, 1.0, '+'));
        let back = (0..11).rev().map(|target| (target, -1.0, '-'));
        for (target, sign, word) in there.chain(back) {
            let target_mm = 100.0 * f64::from(target);
            let measured_mm = target_mm + 1e-3 * deviation_um(run, target, sign);
            lines.push(format!("{run},{word},{target_mm:.3},{measured_mm:.5}"));
        }
    }
    lines
}

fn table(runs: std::ops::RangeInclusive<u32>) -> String {
    format!("run,approach,target_mm,measured_mm\n{}\n", lines(runs).join("\n"))
}

fn json(folder: &WorkFolder) -> Value {
    serde_json::from_str(&folder.read("o.json")).unwrap()
}

#[test]
fn the_json_has_its_keys_and_page_and_model_are_written() {
    let folder = WorkFolder::with(&[("y.csv", table(1..=3)), ("later.csv", table(4..=5))]);
    let arguments = "positions --fit y.csv --validate later.csv --feedback motor --json o.json --report page --model m.toml";
    let stdout = folder.succeeds(arguments);
    assert!(stdout.starts_with("Axis y positions with A = "), "{stdout}");
    let json = json(&folder);
    for key in [
        "A",
        "A_positive",
        "A_negative",
        "E",
        "E_positive",
        "E_negative",
        "M",
        "R",
        "R_positive",
        "R_negative",
        "B",
    ] {
        assert!(json["iso_230_2_um"][key].as_f64().is_some_and(|um| um > 0.0), "{key}: {json}");
    }
    assert!((json["iso_230_2_um"]["B_mean"].as_f64().unwrap() + 8.0).abs() < 0.2, "{json}");
    let residual = |when: &str, of: &str| json["residual_um"][when][of].as_f64().unwrap();
    assert!(residual("before", "validate") > 10.0 && residual("after", "validate") < 0.5, "{json}");
    assert!(residual("after", "fit") < 0.4, "{json}");
    let effects = json["effects"].as_array().unwrap();
    let named = |name: &str| {
        effects.iter().find(|effect| effect["name"] == name).unwrap_or_else(|| panic!("{name}: {json}"))
    };
    for (name, key, truth) in [("backlash", "width_um", 8.0), ("pitch_progressive", "slope_um_per_m", 50.0)] {
        let parameter = &named(name)["parameters"][key];
        let [low, high] = [0, 1].map(|end| parameter["ci95"][end].as_f64().unwrap());
        assert!((parameter["value"].as_f64().unwrap() - truth).abs() < 0.5 && low < high, "{json}");
    }
    assert_eq!(named("pitch_map")["parameters"]["error_um"]["value"].as_array().unwrap().len(), 11);
    for effect in effects {
        let is_certain = effect["certainty"] == "certain";
        assert!(
            is_certain == effect["rivals"].as_array().unwrap().is_empty() && effect["axis"] == "y",
            "{effect}"
        );
        assert!(effect["validate_reduction_percent"].is_f64(), "{effect}");
    }
    let page = folder.read("page/report.html");
    assert!(page.contains("Deviation over position") && page.contains("standard deviations"));
    let model = folder.read("m.toml");
    assert!(
        model.contains("[axis.y]") && model.contains("name = \"backlash\"") && model.contains("pitch_map"),
        "{model}"
    );
}

/// The effects in a whole machine: `simulate` and `compensate` take it.
#[test]
fn the_model_of_a_declared_machine_is_simulated_and_compensated() {
    let motion = "name = \"there and back\"\nstart_mm = { x = 100.0, y = 0.0 }\nfeed_mm_per_min = 6000.0\nacceleration_m_per_s2 = 2.0\n\n[[block]]\nline_to_mm = { x = 200.0, y = 50.0 }\n";
    let folder = WorkFolder::with(&[
        ("x.csv", table(1..=3).as_str()),
        ("machine.toml", MACHINE),
        ("motion.toml", motion),
    ]);
    folder.succeeds("positions --fit x.csv --machine machine.toml --model m.toml");
    folder.succeeds("simulate --machine m.toml --motion motion.toml --out log.csv");
    let stdout = folder.succeeds("compensate --model m.toml --motion motion.toml --out c.toml");
    assert!(folder.read("c.toml").contains("compensation"), "{stdout}");
    let error = folder.fails("positions --fit x.csv --axis u --machine machine.toml --model u.toml", 2);
    assert!(error.contains("--axis: expected an axis of machine.toml: x, y, found \"u\""), "{error}");
}

/// Separators, decimal commas, other names and units, approaches that are not told, µm in a column of mm.
#[test]
fn tables_of_other_programs_are_the_same_test() {
    let own = table(1..=3);
    let semicolons = own.replace('.', "§").replace(',', ";").replace('§', ",");
    let named = own.replace("run,approach,target_mm,measured_mm", "run,direction,Target (mm),Measured [mm]");
    let mapped = own.replace("run,approach,target_mm,measured_mm", "No,way,Nominal position,laser");
    let in_um: Vec<String> = own
        .lines()
        .skip(1)
        .map(|line| {
            let (head, measured) = line.rsplit_once(',').unwrap();
            format!("{head},{:.2}", 1e3 * measured.parse::<f64>().unwrap())
        })
        .collect();
    let in_um = format!("run,approach,target_mm,measured_mm\n{}\n", in_um.join("\n"));
    let without: Vec<String> = own
        .lines()
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            format!("{},{},{}", cells[0], cells[2], cells[3])
        })
        .collect();
    let folder = WorkFolder::with(&[
        ("own.csv", own.as_str()),
        ("semicolons.csv", semicolons.as_str()),
        ("named.csv", named.as_str()),
        ("mapped.csv", mapped.as_str()),
        ("um.csv", in_um.as_str()),
        ("without.csv", without.join("\n").as_str()),
    ]);
    folder.succeeds("positions --fit own.csv --json o.json");
    let expected = json(&folder)["iso_230_2_um"].clone();
    let mapping = "--map run=No --map approach=way --map measured_mm=laser";
    let target = "--map=target_mm=3";
    for (file, flags, said) in [
        ("semicolons.csv", String::new(), ""),
        ("named.csv", String::new(), ""),
        ("um.csv", String::new(), "um.csv: from line 2: measured_mm: the numbers are µm"),
        ("without.csv", String::new(), "The file has no approaches"),
        ("own.csv", "--unit measured_mm=mm".to_owned(), ""),
    ] {
        let stdout = folder.succeeds(&format!("positions --fit {file} {flags} --json o.json"));
        assert!(stdout.contains(said), "{file}: {stdout}");
        for (key, value) in expected.as_object().unwrap() {
            let found = json(&folder)["iso_230_2_um"][key].as_f64().unwrap();
            assert!((found - value.as_f64().unwrap()).abs() < 1e-6, "{file}: {key}");
        }
    }
    // A target that no flag names: the one that is like it is proposed.
    let error = folder.fails(&format!("positions --fit mapped.csv {mapping}"), 2);
    assert!(error.contains("mapped.csv: line 1: expected a column target_mm"), "{error}");
    let error = folder.fails(&format!("positions --fit mapped.csv {mapping} {target}"), 2);
    assert!(
        error.contains("expected a column of the file: \"No\", \"way\", \"Nominal position\", \"laser\""),
        "{error}"
    );
}

/// What is unusual is named with its line, and used.
#[test]
fn unusual_tests_are_used_and_said() {
    let all = lines(1..=3);
    let header = "run,approach,target_mm,measured_mm";
    let with = |lines: &[String]| format!("{header}\n{}\n", lines.join("\n"));
    let broken = format!("{}\n3,+,5", with(&all[..50]).trim_end());
    let one_way: Vec<String> = all.iter().filter(|line| line.contains('+')).cloned().collect();
    let mut slipped = all.clone();
    slipped[4] = "1,+,400.000,431.0021".to_owned();
    let mut single_um = all.clone();
    single_um[7] = "1,+,700.000,700002.1".to_owned();
    let extra: Vec<String> = all.iter().map(|line| format!("{line},21.5")).collect();
    let extra = format!("{header},air_deg\n{}\n", extra.join("\n"));
    let folder = WorkFolder::with(&[
        ("broken.csv", broken.as_str()),
        ("one_way.csv", with(&one_way).as_str()),
        ("slipped.csv", with(&slipped).as_str()),
        ("single_um.csv", with(&single_um).as_str()),
        ("extra.csv", extra.as_str()),
    ]);
    for (file, said) in [
        ("broken.csv", "broken.csv: line 51: run 3 ends after 6 of 22 readings, which are used."),
        ("broken.csv", "Left out: broken.csv: line 52: expected 4 values as in the other lines, found 3."),
        ("broken.csv", "The targets have 2 to 3 approaches each"),
        ("one_way.csv", "No approach in − direction: A, E, M, R, B, B̄, A↓, E↓ and R↓ are not given."),
        ("slipped.csv", "slipped.csv: line 6: measured_mm: 31."),
        ("single_um.csv", "single_um.csv: line 9: measured_mm: a number in µm, taken as such."),
        ("extra.csv", "Columns that are not used: \"air_deg\"."),
    ] {
        let stdout = folder.succeeds(&format!("positions --fit {file} --json o.json"));
        assert!(stdout.contains(said), "{file}: {stdout}");
    }
    folder.succeeds("positions --fit one_way.csv --json o.json");
    let json = json(&folder);
    assert!(json["iso_230_2_um"]["A"].is_null() && json["iso_230_2_um"]["A_positive"].is_f64(), "{json}");
}

#[test]
fn what_is_no_positioning_test_is_refused_in_one_line() {
    let own = table(1..=2);
    let misspelt = own.replace("measured_mm", "mesured_mm");
    let deviations = own.lines().map(|line| {
        let (head, last) = line.rsplit_once(',').unwrap();
        last.parse::<f64>().map_or_else(|_| line.to_owned(), |mm| format!("{head},{:.2}", 1e3 * (mm % 1.0)))
    });
    let deviations: Vec<String> = deviations.collect();
    let folder = WorkFolder::with(&[
        ("own.csv", own.as_str()),
        ("misspelt.csv", misspelt.as_str()),
        ("deviations.csv", deviations.join("\n").as_str()),
        ("words.csv", own.replace(",+,", ",up there,").as_str()),
        ("text.csv", "Dear all,\nthe laser was off.\n"),
        ("empty.csv", ""),
        ("single.csv", "run,approach,target_mm,measured_mm\n1,+,5,5.001\n2,+,5,5.002\n"),
    ]);
    for (arguments, expected) in [
        ("--fit misspelt.csv", "misspelt.csv: line 1: expected a column measured_mm or deviation_um"),
        ("--fit misspelt.csv", "is it \"mesured_mm\"? --map measured_mm=mesured_mm"),
        ("--fit deviations.csv", "measured_mm: expected positions that follow the targets, found deviations"),
        ("--fit words.csv", "words.csv: line 2: approach: expected + or -, found \"up there\""),
        (
            "--fit text.csv",
            "text.csv: expected a table with at least the columns run, target_mm and measured_mm",
        ),
        (
            "--fit empty.csv",
            "empty.csv: expected a table with at least the columns run, target_mm and measured_mm, found an empty file",
        ),
        ("--fit single.csv", "single.csv: expected readings at two targets or more, found 1"),
        ("--fit none.csv", "none.csv: expected a readable file"),
        (
            "--fit own.csv --map target=run",
            "--map: expected one of run, approach, target_mm, measured_mm, deviation_um, time_s (did you mean target_mm?)",
        ),
        ("--fit own.csv --unit measured_mm=N", "--unit: measured_mm: expected mm, m, um"),
        (
            "--fit own.csv --unit time_s=min",
            "--unit: expected the name of a column with a unit that the file has",
        ),
        ("--fit own.csv --axis 1x", "--axis: expected a name that starts with a letter"),
        ("--fit own.csv --json own.csv", "neither an input nor another output"),
        ("--fit own.csv --model o.json", "neither an input nor another output"),
    ] {
        let json = if arguments.contains("--json") { "" } else { "--json o.json" };
        let error = folder.fails(&format!("positions {arguments} {json}"), 2);
        assert!(error.contains(expected), "{arguments}: {error}");
        assert!(!folder.path().join("o.json").exists());
    }
}
