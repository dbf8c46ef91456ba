//! Proposals from responses that differ from the model, each in a known way.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::candidate::Candidate;
use super::measured::MeasuredAxis;
use super::tests::{RIGID, machine};
use super::velocity_loop::fastest;
use crate::margins::axis_margins::AxisLoops;
use crate::margins::{Condition, MarginLimits};
use crate::response::ResponseFile;
use crate::response::file::{Conditions, NotchKeys, Tone};
use model::axis::{Feedback, Law, PerNotch};
use model::machine::Machine;
use plant::instruments::Instruments;

const LIMITS: MarginLimits = MarginLimits { gain_db: 6.0, phase_deg: 45.0 };
const MASS_KG: f64 = 100.0;
const TICK_S: f64 = 1.0 / 8000.0;

fn rigid() -> Machine {
    machine(RIGID)
}

/// The response of the rigid axis whose plant is `factor` times that of the model, at 60 frequencies from 5 to 3500 Hz: above 1000 Hz, half the rate of
/// the position loop, the model has none.
fn response(factor: impl Fn(f64) -> Complex<f64>) -> ResponseFile {
    let machine = rigid();
    let loops = &AxisLoops::of_machine(&machine, &Instruments::of(&machine, 0)).unwrap()[0];
    let axis = loops.linear(Condition::Sliding);
    let tone = |number: i32| {
        let frequency_hz = 5.0 * 700.0f64.powf(f64::from(number) / 59.0);
        let angle = TAU * frequency_hz * axis.tick_s();
        let model = axis.velocity_loop().response(angle).unwrap();
        let velocity = model * factor(frequency_hz);
        let closed = |open: Complex<f64>| open / (1.0 + open);
        let position_angle = (TAU * frequency_hz * axis.position_tick_s()).min(3.0);
        let position = axis.position_loop().response(position_angle).unwrap();
        let position = position * closed(velocity) / closed(model);
        let one = Complex::from(1.0).into();
        Tone {
            frequency_hz,
            coherence: 1.0,
            plant_m_per_s_per_n: one,
            open_loop: one,
            closed_loop: one,
            velocity_loop: Some(velocity.into()),
            position_loop: Some(position.into()),
        }
    };
    let conditions = Conditions {
        board: "test".to_owned(),
        axis: "x".to_owned(),
        at_mm: 0.0,
        force_n: 100.0,
        tones_at_once: 4,
        periods: 4,
        period_s: 0.2,
        tick_rate_hz: 8000.0,
        controller: (&machine.axis["x"].settings).into(),
    };
    ResponseFile {
        version: 1,
        conditions,
        tones: (0..60).map(tone).collect(),
        margins: Vec::new(),
        resonances: Vec::new(),
        notch: None,
    }
}

fn delayed(late_s: f64) -> ResponseFile {
    response(|hz| Complex::from_polar(1.0, -TAU * hz * late_s))
}

/// Kv of the fastest velocity loop, and its notches, Hz.
fn tuned(measured: Option<&ResponseFile>) -> (f64, Vec<f64>) {
    let machine = rigid();
    let instruments = Instruments::of(&machine, 0);
    let axes: Vec<MeasuredAxis> =
        measured.into_iter().map(|file| MeasuredAxis::of(file, &machine, &instruments).unwrap()).collect();
    let tuned = fastest(&machine, &instruments, LIMITS, &axes).unwrap();
    let settings = &tuned.axis["x"].settings;
    let notches = settings.filters.notch_frequency_hz.clone().map_or(Vec::new(), |hz| hz.0);
    (settings.controller.velocity_gain_n_s_per_m.unwrap(), notches)
}

#[test]
fn a_response_that_is_the_models_changes_nothing() {
    assert_eq!(tuned(Some(&delayed(0.0))), tuned(None));
}

/// The crossover of Kv·(1 + 1/(jω·Ti))/(jω·m) with Ti = 4·m/Kv is 1.03·Kv/m. There the integral part takes 14°, the sampling a delay of 1 to
/// 1.5 ticks, and the delay of the response what it is: 45° are left, or the next gain, 5 % higher, would have them as well.
#[test]
fn a_delay_that_the_model_lacks_leaves_the_phase_margin() {
    let late_s = 0.4e-3;
    let (gain, _) = tuned(Some(&delayed(late_s)));
    let margin_deg = |gain: f64, ticks: f64| {
        let crossover = 1.03 * gain / MASS_KG;
        90.0 - 14.0 - (crossover * (late_s + ticks * TICK_S)).to_degrees()
    };
    assert!(margin_deg(gain, 1.0) >= 45.0 - 0.5, "{gain}: {}", margin_deg(gain, 1.0));
    assert!(margin_deg(1.05 * gain, 1.5) < 45.0 + 0.5, "{gain}: {}", margin_deg(1.05 * gain, 1.5));
    assert!(gain < 0.8 * tuned(None).0);
}

/// A mode that raises the plant by a factor of 4: 1 + 0.24/(2·0.04).
fn mode(hz: f64, centre_hz: f64) -> Complex<f64> {
    let s = Complex::new(0.0, hz / centre_hz);
    1.0 + 0.24 * s / (s * s + 0.08 * s + 1.0)
}

/// Notches that take such modes off.
fn notches(centres_hz: &[f64]) -> NotchKeys {
    let of = |factor: f64| PerNotch(centres_hz.iter().map(|hz| factor * hz).collect());
    NotchKeys {
        notch_frequency_hz: of(1.0),
        notch_width_hz: of(0.2),
        notch_depth: PerNotch(vec![0.75; centres_hz.len()]),
    }
}

/// Of two modes that are as high, one notch leaves the other: both are proposed, although the first one alone does not raise Kv. A third
/// where there is no mode would not raise it, and is left out.
#[test]
fn each_measured_resonance_has_its_notch() {
    let mut file = response(|hz| mode(hz, 280.0) * mode(hz, 520.0));
    let (without, _) = tuned(Some(&file));
    file.notch = Some(notches(&[280.0, 520.0, 1500.0]));
    let (with, found) = tuned(Some(&file));
    assert_eq!(found, [280.0, 520.0]);
    file.notch = Some(notches(&[280.0]));
    let (with_one, _) = tuned(Some(&file));
    assert!(with > 1.2 * with_one.max(without), "{without}, {with_one}, {with}");
}

/// A declared notch is kept, and has no second one beside it: the measured loop already has its effect.
#[test]
fn a_declared_notch_is_kept() {
    let keys = "notch_frequency_hz = 300\nnotch_width_hz = 60\nnotch_depth = 0.75\ncontroller = ";
    let machine = machine(&RIGID.replacen("controller = ", keys, 1));
    let instruments = Instruments::of(&machine, 0);
    let mut file = response(|hz| mode(hz, 420.0));
    file.conditions.controller = (&machine.axis["x"].settings).into();
    file.notch = Some(notches(&[310.0, 420.0]));
    let axis = MeasuredAxis::of(&file, &machine, &instruments).unwrap();
    let tuned = fastest(&machine, &instruments, LIMITS, &[axis]).unwrap();
    let found = tuned.axis["x"].settings.filters.notch_frequency_hz.clone();
    assert_eq!(found, Some(PerNotch(vec![300.0, 420.0])));
}

/// A mode of 300 Hz raises the plant by a factor of 4 there. The notch of the response takes it off; without it, Kv has to be lower by
/// what the mode adds: not below the gain at which its peak, 4·Kv/(ω·m), is at −6 dB.
#[test]
fn the_notch_is_that_of_the_measured_resonance() {
    let mut file = response(|hz| mode(hz, 300.0));
    let (without, none) = tuned(Some(&file));
    file.notch = Some(notches(&[300.0]));
    let (with, notch) = tuned(Some(&file));
    let (of_model, _) = tuned(None);
    assert_eq!((none, notch), (vec![], vec![300.0]));
    assert!(1.1 * without <= with && with <= of_model, "{without}, {with}, {of_model}");
    let peak_below = 0.5 * TAU * 300.0 * MASS_KG / 4.0;
    assert!(without >= peak_below / 1.05, "{without}, {peak_below}");
}

/// Kp is the highest: the loop has the margins, and with 10 % more it does not.
#[test]
fn the_position_gain_has_its_margins_as_measured() {
    let machine = rigid();
    let instruments = Instruments::of(&machine, 0);
    let candidate = Candidate {
        law: Law::P,
        feedback: Feedback::Motor,
        time_constant_factor: 1.0,
        feedforward_percent: 0.0,
        ahead_ticks: 0.0,
    };
    let gain = |measured: &[MeasuredAxis]| {
        let tuned = candidate.applied_to(&machine, &instruments, LIMITS, measured).unwrap().unwrap();
        let loops = AxisLoops::of_machine(&tuned, &instruments).unwrap().remove(0);
        (tuned.axis["x"].settings.controller.position_gain_per_s.unwrap(), loops)
    };
    let axis = MeasuredAxis::of(&delayed(2e-3), &machine, &instruments).unwrap();
    let (measured, loops) = gain(std::slice::from_ref(&axis));
    assert!(axis.position(&loops).meets(LIMITS));
    assert!(!axis.position(&loops.with_position_gain(1.1 * measured)).meets(LIMITS));
    let (of_model, _) = gain(&[]);
    assert!(measured < of_model, "{measured}, {of_model}");
}

#[test]
fn a_response_with_other_settings_is_refused() {
    let machine =
        machine(&RIGID.replace("velocity_gain_n_s_per_m = 5000.0", "velocity_gain_n_s_per_m = 6000.0"));
    let refused = |file: &ResponseFile, expected: &str| {
        let error = MeasuredAxis::of(file, &machine, &Instruments::of(&machine, 0)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    };
    let mut file = delayed(0.0);
    refused(&file, "measured with velocity_gain_n_s_per_m = 5000, and the machine file has 6000");
    file.conditions.axis = "z".to_owned();
    refused(&file, "the machine file has no such axis");
    file.conditions.axis = "x".to_owned();
    file.conditions.controller.velocity_gain_n_s_per_m = Some(6000.0);
    file.conditions.controller.notch_depth = Some(PerNotch(vec![0.5]));
    refused(&file, "measured with notch_depth = 0.5, and the machine file has none");
    file.conditions.controller.notch_depth = None;
    file.conditions.tick_rate_hz = 20_000.0;
    refused(&file, "measured with velocity_loop_rate_hz = 20000, and the machine file has 8000");
    file.conditions.tick_rate_hz = 8000.0;
    file.conditions.controller.feedback = Feedback::Table;
    refused(&file, "measured with feedback = \"table\", and the machine file has \"motor\"");
    file.conditions.controller.feedback = Feedback::Motor;
    file.tones.iter_mut().for_each(|tone| tone.coherence = 0.7);
    refused(&file, "expected two tones");
}

/// A response is measured with one gain, a machine with a schedule has another one elsewhere.
#[test]
fn a_response_is_no_measure_of_a_machine_with_a_gain_schedule() {
    let keys = "velocity_gain_n_s_per_m = 5000.0\ngain_schedule_speed_mm_per_s = [0, 50]\ngain_schedule_ratio = [1, 2]";
    let scheduled = machine(&RIGID.replace("velocity_gain_n_s_per_m = 5000.0", keys));
    let instruments = Instruments::of(&scheduled, 0);
    let error = MeasuredAxis::of(&delayed(0.0), &scheduled, &instruments).unwrap_err().to_string();
    assert!(error.contains("gain_schedule_ratio: expected a constant velocity gain"), "{error}");
    let constant = machine(RIGID);
    assert!(MeasuredAxis::of(&delayed(0.0), &constant, &Instruments::of(&constant, 0)).is_ok());
}
