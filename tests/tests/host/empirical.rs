//! A residual that no effect describes, as a table of the machine file: it acts in the simulation, `--empirical` finds it, and
//! the written model gives the residuals that the trace reported.

use files::log::{Channel, Log};
use model::effects::Stage;
use model::machine::Machine;
use model::residual_table::{ResidualTable, TableChannel, TableVariable};
use trace::Identification;
use trace::judge::StageResidual;
use trace::{Request, Task, requested};

/// Height (µm) and standard deviation (mm) of the hump.
const HEIGHT_UM: f64 = 6.0;
const WIDTH_MM: f64 = 6.0;
const CENTRE_MM: f64 = 12.0;

fn hump_um(mm: f64) -> f64 {
    HEIGHT_UM * (-0.5 * ((mm - CENTRE_MM) / WIDTH_MM).powi(2)).exp()
}

fn declared() -> Machine {
    Machine::parse(demo::MACHINE, "demo.toml").unwrap()
}

/// The machine with a hump of the tool's path over the position of x, given every millimetre.
fn machine() -> Machine {
    let points: Vec<[f64; 2]> = (-60..=60).map(f64::from).map(|mm| [mm, hump_um(mm)]).collect();
    let table = ResidualTable::new(TableChannel::Tool, TableVariable::PositionMm, &points);
    let mut machine = declared();
    machine.axis["x"].empirical.push(table);
    machine
}

fn of_tool(trace: &Identification) -> StageResidual {
    *trace.axes()[0].residuals.iter().find(|error| error.stage == Stage::Tool).unwrap()
}

fn traced(machine: &Machine, [fit, validate]: &[Vec<Log>; 2], task: Task, tables: bool) -> Identification {
    requested(machine, [fit, validate], Request { task, tables }, &|_| {}).unwrap()
}

#[test]
fn a_table_displaces_the_logged_channel() {
    let [with, without] = [machine(), declared()].map(|machine| demo::logs(&machine, 7).unwrap());
    let channel = |log: &Log, axis: usize, channel| log.axes[axis].channel(channel).unwrap().to_vec();
    let mut largest = 0.0f64;
    for (with, without) in with.iter().flatten().zip(without.iter().flatten()) {
        // The same noise: the difference is the table, between its points off the hump by (1 mm)²/8·6 µm/(6 mm)² = 0.02 µm, and
        // rounded to 0.01 µm.
        let at_mm = channel(without, 0, Channel::Table);
        let tools = channel(with, 0, Channel::Tool).into_iter().zip(channel(without, 0, Channel::Tool));
        for ((with_mm, without_mm), at_mm) in tools.zip(at_mm) {
            let um = 1e3 * (with_mm - without_mm);
            assert!((um - hump_um(at_mm)).abs() < 0.04, "{um} at {at_mm}");
            largest = largest.max(um);
        }
        for other in [Channel::Motor, Channel::Table, Channel::Force] {
            assert_eq!(channel(with, 0, other), channel(without, 0, other));
        }
        assert_eq!(channel(with, 1, Channel::Tool), channel(without, 1, Channel::Tool));
    }
    assert!(largest > 0.9 * HEIGHT_UM, "the motions cross the hump: {largest}");
}

#[test]
fn a_table_is_found_written_and_read_again() {
    let logs = demo::logs(&machine(), 7).unwrap();
    let without = traced(&declared(), &logs, Task::Search, false);
    assert!(without.better_machine().axis["x"].empirical.is_empty(), "only if requested");
    let first = traced(&declared(), &logs, Task::Search, true);
    let model = first.better_machine();
    let [table] = &model.axis["x"].empirical[..] else { panic!("{:?}", model.axis["x"].empirical) };
    assert_eq!((table.channel, table.variable), (TableChannel::Tool, TableVariable::PositionMm));
    // Between points h apart, linear interpolation flattens the hump by up to h²/8·6 µm/(6 mm)², and the mean over the samples of a
    // point, each distributed to two points, by h²/12·6 µm/(6 mm)². The zero of the tool, which was fitted without the table, takes up
    // the mean of the hump: at most its area by the travel, 6·6·√(2π)/100 = 0.9 µm.
    let spacing_mm = table.at[1] - table.at[0];
    let flattened_um = (1.0 / 8.0 + 1.0 / 12.0) * spacing_mm.powi(2) * HEIGHT_UM / WIDTH_MM.powi(2);
    assert!((2.0..7.0).contains(&spacing_mm) && flattened_um < 0.25 * HEIGHT_UM, "{spacing_mm}");
    let off = |mm: f64| table.value(mm) - hump_um(mm);
    let zero_um = off(-40.0);
    assert!((-1.0..0.1).contains(&zero_um), "{zero_um}");
    for mm in [-20.0, 0.0, 6.0, 12.0, 18.0, 30.0] {
        let difference_um = (off(mm) - zero_um).abs();
        assert!(difference_um < flattened_um + 0.1, "{mm}: {} {}", table.value(mm), hump_um(mm));
    }
    // What remains is the hump flattened by a fifth, and the noise.
    let (before, after) = (of_tool(&without).after, of_tool(&first).after);
    assert!(after.fit < 0.3 * before.fit && after.validate < 0.3 * before.validate, "{before:?} {after:?}");

    let again = Machine::parse(&model.to_toml(), "model.toml").unwrap();
    assert_eq!(again, model);
    for task in [Task::Evaluate, Task::Search] {
        let second = traced(&again, &logs, task, false);
        for (axis, of_first) in second.axes().iter().zip(first.axes()) {
            assert!(axis.found.is_empty(), "{:?}", axis.found);
            for (error, reported) in axis.residuals.iter().zip(&of_first.residuals) {
                for (given, reported) in
                    [(error.before.fit, reported.after.fit), (error.before.validate, reported.after.validate)]
                {
                    assert!((given / reported - 1.0).abs() < 0.02, "{} {error:?} {reported}", axis.axis);
                }
            }
        }
    }
}

/// The simulation of the written model leaves the tool where the machine has it.
#[test]
fn the_written_model_simulates_the_machine() {
    let truth = machine();
    let model = traced(&declared(), &demo::logs(&truth, 7).unwrap(), Task::Search, true).better_machine();
    let [simulated, measured] = [&model, &truth].map(|machine| demo::logs(machine, 9).unwrap());
    let offset = |log: &Log| -> Vec<f64> {
        let [tool, table] =
            [Channel::Tool, Channel::Table].map(|channel| log.axes[0].channel(channel).unwrap().to_vec());
        let offset: Vec<f64> = tool.iter().zip(table).map(|(tool, table)| 1e3 * (tool - table)).collect();
        let mean = numerics::mean(offset.iter().copied());
        offset.iter().map(|um| um - mean).collect()
    };
    for (simulated, measured) in simulated.iter().flatten().zip(measured.iter().flatten()) {
        let difference = offset(simulated).into_iter().zip(offset(measured)).map(|(a, b)| a - b);
        // Noise of 0.08 µm of the tool and 0.02 µm of the scale twice, 0.12 µm, and a twentieth of the hump.
        let rms = numerics::rms(difference);
        assert!((0.1..0.35).contains(&rms), "{}: {rms}", measured.source);
    }
}

#[test]
fn a_table_that_cannot_be_used_is_refused_by_its_key() {
    let head = "[[axis.x.empirical]]\nchannel = \"table\"\nvariable = \"position_mm\"\n";
    let refused = |table: &str| {
        let text = format!("{}\n{table}", demo::MACHINE);
        Machine::parse(&text, "m.toml").unwrap_err().to_string()
    };
    for (keys, key) in [
        ("at = [0.0]\nerror_um = [1.0]\n", "axis.x.empirical[0].at"),
        ("at = [0.0, 0.0]\nerror_um = [1.0, 2.0]\n", "axis.x.empirical[0].at"),
        ("at = [0.0, 1.0]\nerror_um = [1.0]\n", "axis.x.empirical[0].error_um"),
        ("at = [0.0, 1.0]\nerror_n = [1.0, 2.0]\n", "axis.x.empirical[0].error_n"),
        ("at = [0.0, 1.0]\nerror_um = [1.0, nan]\n", "axis.x.empirical[0]"),
        ("at = [0.0, 1.0]\nerror_um = [1.0, 2.0]\nerror = 1.0\n", "error"),
    ] {
        let message = refused(&format!("{head}{keys}"));
        assert!(message.contains(key), "{message}");
    }
    let table = format!("{head}at = [0.0, 1.0]\nerror_um = [1.0, 2.0]\n");
    assert!(refused(&format!("{table}{table}")).contains("axis.x.empirical[1]"));
}
