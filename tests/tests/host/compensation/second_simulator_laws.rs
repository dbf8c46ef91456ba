//! The correction of each law that the second simulator draws cancels what that simulator adds to the tool: units and signs, from the
//! term of a model to the fixed-point controller, judged by code that none of them use.

use std::f64::consts::TAU;

use commissioning::compensate::laws::{self, Place};
use model::machine::Axis;
use model::residual_law::{Term, WavePosition};
use model::residual_table::TableChannel;
use self_test::law::{Form, LawTerm, Memories, displacement_m};
use self_test::plant::State;
use shared::compensate::{AxisCompensation, AxisOf, Compensation, CompensationSettings};
use shared::config::Rates;
use shared::scalar::{Fixed, Scalar};
use shared::units::{LENGTH_M, Position};

const RATE_HZ: f64 = 1000.0;
const TRAVEL_M: [f64; 2] = [-0.045, 0.045];

/// A motion of an axis: amplitude (m) times a sine of a frequency (Hz).
#[derive(Clone, Copy)]
struct Sine(f64, f64, f64);

impl Sine {
    fn at(self, time_s: f64) -> State {
        let Self(amplitude_m, hz, phase) = self;
        let (omega, phase) = (TAU * hz, TAU * hz * time_s + phase);
        State {
            table_m: amplitude_m * phase.sin(),
            table_m_per_s: amplitude_m * omega * phase.cos(),
            table_m_per_s2: -amplitude_m * omega.powi(2) * phase.sin(),
            ..State::default()
        }
    }
}

/// The term of a model with the value of 1 SI unit of the form, times a factor, in µm per unit of its variables.
fn term(form: &Form, factor: f64) -> Term {
    let um = 1e6 * factor;
    if let Form::OtherWave(period_m, phase) = form {
        let (sine, cosine) = (um * phase.cos(), um * phase.sin());
        return Term::Wave { over: WavePosition::OtherPositionMm, period_mm: 1e3 * period_m, cosine, sine };
    }
    let (_, of) = form.described();
    let of: Vec<_> = of.iter().map(|name| serde_json::from_value((*name).into()).unwrap()).collect();
    let positions = form.described().1.iter().filter(|name| name.ends_with("_mm")).count();
    let coefficient = um * 1e-3f64.powi(i32::try_from(positions).unwrap());
    Term::Product { of, coefficient }
}

/// Rms of the displacement by a law of one term along a motion, and of displacement + correction, µm.
fn caused_and_left_um(form: Form, factor: f64) -> [f64; 2] {
    let term = term(&form, factor);
    assert!(laws::refused(&Axis::default(), TableChannel::Tool, &term).is_none(), "{form:?}");
    let mut settings = CompensationSettings { position_rate_m_per_s: 1.0, ..CompensationSettings::default() };
    let place = Place { own: 0, other: 1, travel_m: TRAVEL_M, other_travel_m: TRAVEL_M };
    laws::add(&mut settings, &term, &place);
    let rates = Rates { velocity_loop_hz: RATE_HZ, position_loop_divider: 1 };
    let converted = AxisCompensation::<Fixed>::new(&settings, rates, AxisOf { axis: 0, axes: 2 }).unwrap();
    let [x, y] = [Sine(0.03, 0.7, 0.2), Sine(0.04, 1.1, 0.9)];
    let law = [LawTerm { form, factor }];
    let command = |k: u32| [x, y].map(|axis| axis.at(f64::from(k) / RATE_HZ));
    let positions = |k: u32| command(k).map(|state| Position::from_m(state.table_m).unwrap());
    let mut controller = Compensation::<Fixed, 2>::none(positions(0));
    controller.replace(0, &converted);
    let (mut caused, mut left) = (0.0, 0.0);
    for k in 1..5000 {
        let [correction, _] = controller.commands(&positions(k));
        let [own, other] = command(k);
        let um = 1e6 * displacement_m(&law, &own, &other, &Memories::default());
        let correction_um = 1e6 * LENGTH_M * correction.total.value();
        // The second difference of the command is known from the third tick on.
        if k > 3 {
            caused += um * um;
            left += (um + correction_um).powi(2);
        }
    }
    [caused, left].map(|sum: f64| (sum / 4996.0).sqrt())
}

/// A difference quotient is half a tick late, and the second one a tick: at 1.1 Hz by 7e-3 of the amplitude. A wave in a table of 17 points
/// a period leaves (2π/17.5)²/8 = 1.6 % of its amplitude; a direction turns over within 0.05 mm/s, and here in a tick.
#[test]
fn the_correction_cancels_what_the_second_simulator_adds() {
    let forms = [
        (Form::OwnTimesOther, 0.01),
        (Form::Speed, 1e-4),
        (Form::OwnTimesDirection, -1e-4),
        (Form::VelocitySquared, 1e-3),
        (Form::OtherCubed, -0.1),
        (Form::VelocityTimesOther, 2e-3),
        (Form::AccelerationTimesOther, 4e-4),
        (Form::OtherDirection, -3e-6),
        (Form::OtherVelocity, 5e-5),
        (Form::DirectionTimesOther, 1e-4),
        (Form::OtherWave(0.025, 0.6), 4e-6),
    ];
    for (form, factor) in forms {
        let [caused_um, left_um] = caused_and_left_um(form, factor);
        // Within the range of the sizes of the self-test, so that roundings of a nanometre do not count.
        assert!((0.5..30.0).contains(&caused_um), "{form:?}: {caused_um}");
        let bound = match form {
            // Some 20 turnovers of 5000 samples, each off by up to twice the amplitude for one: sqrt(20·4/5000).
            Form::OwnTimesDirection | Form::OtherDirection | Form::DirectionTimesOther => 0.13,
            _ => 0.02,
        };
        assert!(left_um < bound * caused_um, "{form:?}: {left_um} of {caused_um} µm");
    }
}
