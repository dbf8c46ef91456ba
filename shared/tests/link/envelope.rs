//! Nothing that is uploaded, or that a flash holds, is beyond the envelope of the board.

use proptest::prelude::*;
use shared::config::{AxisEnvelope, AxisSettings, ScaleLimits, Sensors};
use shared::link::message::{BoardSettings, Reply, Request, UploadKind};
use shared::link::refusal::SettingProblem;
use shared::link::report::{SettingsReport, SettingsSource, StoredRecord};
use shared::link::{Envelope, Identity, Refusal, Status};
use shared::safety::Fault;
use shared::storage::Store;

use super::rig::{BOARD, ENVELOPE, IDENTITY, Memory, Rig, SLOTS, settings};
use super::uploads::{bytes_of, upload};

/// A setting with a ceiling, or with a floor if `sign` is negative.
struct Bounded {
    name: &'static str,
    set: fn(&mut AxisSettings, f64),
    bound: f64,
    sign: f64,
}

fn monitored(axis: &mut AxisSettings, disagreement_m: Option<f64>, frozen_m: Option<f64>) {
    axis.sensors = Sensors::Motor {
        scale_disagreement_limit_m: disagreement_m.or(axis.sensors.scale_disagreement_limit_m()),
        frozen_encoder_limit_m: frozen_m.or(axis.sensors.frozen_encoder_limit_m()),
    };
}

/// Every bound of an axis, with the way to reach it.
fn bounds() -> Vec<Bounded> {
    let [AxisEnvelope { travel_m, scale_disagreement_limit_m, .. }, _] = ENVELOPE.axes;
    let [least_m, greatest_m] = travel_m.unwrap();
    let bounded = |name, set, bound, sign| Bounded { name, set, bound, sign };
    let of = &ENVELOPE.axes[0];
    vec![
        bounded("travel_m", |axis, m| axis.travel_m = Some([m, 0.1]), least_m, -1.0),
        bounded("travel_m", |axis, m| axis.travel_m = Some([-0.1, m]), greatest_m, 1.0),
        bounded("fastest_m_per_s", |axis, value| axis.fastest_m_per_s = Some(value), of.fastest_m_per_s, 1.0),
        bounded("force_limit_n", |axis, value| axis.force_limit_n = value, of.force_limit_n, 1.0),
        bounded("saturation_time_s", |axis, value| axis.saturation_time_s = value, of.saturation_time_s, 1.0),
        bounded(
            "following_error_limit_m",
            |axis, value| axis.following_error_limit_m = value,
            of.following_error_limit_m,
            1.0,
        ),
        bounded(
            "frozen_encoder_limit_m",
            |axis, value| monitored(axis, None, Some(value)),
            of.frozen_encoder_limit_m,
            1.0,
        ),
        bounded(
            "scale_disagreement_limit_m",
            |axis, value| monitored(axis, Some(value), None),
            scale_disagreement_limit_m.unwrap(),
            1.0,
        ),
        bounded(
            "stop_deceleration_m_per_s2",
            |axis, value| axis.stop_deceleration_m_per_s2 = value,
            of.stop_deceleration_m_per_s2,
            -1.0,
        ),
    ]
}

/// What the status says about the machine, without its clock and counters.
fn state(rig: &mut Rig) -> Status {
    Status { tick: 0, link: Default::default(), ..rig.status() }
}

fn of_axis(axis: usize, change: impl Fn(&mut AxisSettings)) -> BoardSettings<2> {
    let mut settings = settings();
    change(&mut settings.axes[axis]);
    settings
}

fn refusal_of(rig: &mut Rig, settings: &BoardSettings<2>) -> (u8, String, SettingProblem) {
    match upload(rig, UploadKind::Settings, settings) {
        Reply::Refused(Refusal::Setting { axis, name, problem }) => (axis, name.to_string(), problem),
        reply => panic!("{reply:?}"),
    }
}

/// At its bound a setting is accepted. Beyond it by a thousandth it is refused with axis, name, value and bound, and nothing has
/// changed; so is a number that is none.
#[test]
fn each_setting_is_accepted_up_to_its_bound_and_not_beyond() {
    for axis in [0, 1] {
        for Bounded { name, set, bound, sign } in bounds() {
            let mut rig = Rig::new();
            let before = state(&mut rig);
            let value = bound + sign * 1e-3 * bound.abs();
            let problem = if sign > 0.0 {
                SettingProblem::AboveCeiling { value, ceiling: bound }
            } else {
                SettingProblem::BelowFloor { value, floor: bound }
            };
            let beyond = of_axis(axis, |settings| set(settings, value));
            let number = u8::try_from(axis).unwrap();
            assert_eq!(refusal_of(&mut rig, &beyond), (number, name.to_owned(), problem));
            let infinite = of_axis(axis, |settings| set(settings, sign * f64::INFINITY));
            let expected = (number, name.to_owned(), SettingProblem::NotFinite);
            assert_eq!(refusal_of(&mut rig, &infinite), expected);
            assert_eq!(refusal_of(&mut rig, &of_axis(axis, |settings| set(settings, f64::NAN))), expected);
            assert_eq!(state(&mut rig), before);
            let at = of_axis(axis, |settings| set(settings, bound));
            assert_eq!(upload(&mut rig, UploadKind::Settings, &at), Reply::Done, "{name}");
        }
    }
}

/// A limit, settings without it, and its ceiling.
type Missing = (&'static str, fn(&mut AxisSettings), f64);

/// A limit that the envelope has cannot be left out.
#[test]
fn a_monitor_that_the_board_requires_cannot_be_left_out() {
    let [envelope, _] = ENVELOPE.axes;
    let [_, travel] = envelope.travel_m.unwrap();
    let missing: [Missing; 4] = [
        ("travel_m", |axis| axis.travel_m = None, travel),
        ("fastest_m_per_s", |axis| axis.fastest_m_per_s = None, envelope.fastest_m_per_s),
        (
            "frozen_encoder_limit_m",
            |axis| {
                axis.sensors =
                    Sensors::Motor { scale_disagreement_limit_m: Some(0.5e-3), frozen_encoder_limit_m: None };
            },
            envelope.frozen_encoder_limit_m,
        ),
        (
            "scale_disagreement_limit_m",
            |axis| {
                axis.sensors =
                    Sensors::Motor { scale_disagreement_limit_m: None, frozen_encoder_limit_m: Some(0.3e-3) };
            },
            envelope.scale_disagreement_limit_m.unwrap(),
        ),
    ];
    let mut rig = Rig::new();
    let before = state(&mut rig);
    for (name, without, ceiling) in missing {
        let refused = refusal_of(&mut rig, &of_axis(1, without));
        assert_eq!(refused, (1, name.to_owned(), SettingProblem::NotMonitored { ceiling }));
    }
    assert_eq!(state(&mut rig), before);
}

/// With a scale in the loop its limits are part of the setting; they have the same ceilings.
#[test]
fn the_limits_of_a_scale_in_the_loop_have_the_same_ceilings() {
    let with = |disagreement_m, frozen_m| {
        let limits = ScaleLimits { disagreement_m, frozen_m };
        let loops = [Sensors::Table(limits), Sensors::Dual { time_constant_s: 0.1, limits }];
        loops.map(|sensors| of_axis(0, |axis| axis.sensors = sensors))
    };
    let mut rig = Rig::new();
    for settings in with(1.001e-3, 0.4e-3) {
        let (axis, name, problem) = refusal_of(&mut rig, &settings);
        assert_eq!((axis, name.as_str()), (0, "scale_disagreement_limit_m"));
        assert_eq!(problem, SettingProblem::AboveCeiling { value: 1.001e-3, ceiling: 1e-3 });
    }
    for settings in with(1e-3, 0.501e-3) {
        let (axis, name, problem) = refusal_of(&mut rig, &settings);
        assert_eq!((axis, name.as_str()), (0, "frozen_encoder_limit_m"));
        assert_eq!(problem, SettingProblem::AboveCeiling { value: 0.501e-3, ceiling: 0.5e-3 });
    }
    for settings in with(1e-3, 0.5e-3) {
        assert_eq!(upload(&mut rig, UploadKind::Settings, &settings), Reply::Done);
    }
}

/// A board whose y axis has no scale, and no ends.
static WITHOUT_SCALE: Envelope<2> = {
    let [x, y] = ENVELOPE.axes;
    Envelope { axes: [x, AxisEnvelope { scale_disagreement_limit_m: None, travel_m: None, ..y }], ..ENVELOPE }
};

#[test]
fn an_axis_without_a_scale_takes_no_settings_that_use_one() {
    let motor = Sensors::Motor { scale_disagreement_limit_m: None, frozen_encoder_limit_m: Some(0.3e-3) };
    let endless = of_axis(1, |axis| (axis.sensors, axis.travel_m) = (motor, None));
    let mut rig = Rig::of(&Identity { envelope: &WITHOUT_SCALE, ..IDENTITY }, endless.clone());
    let limits = ScaleLimits::DEFAULT;
    let compared =
        Sensors::Motor { scale_disagreement_limit_m: Some(0.5e-3), frozen_encoder_limit_m: Some(0.3e-3) };
    for (sensors, name) in [
        (Sensors::Table(limits), "sensors"),
        (Sensors::Dual { time_constant_s: 0.1, limits }, "sensors"),
        (compared, "scale_disagreement_limit_m"),
    ] {
        let refused = refusal_of(&mut rig, &of_axis(1, |axis| axis.sensors = sensors));
        assert_eq!(refused, (1, name.to_owned(), SettingProblem::NoScale));
    }
    assert_eq!(upload(&mut rig, UploadKind::Settings, &endless), Reply::Done);
}

/// A record in flash that an earlier program with a wider envelope has saved: nothing of it is applied, and the fault has to be
/// acknowledged.
#[test]
fn a_record_beyond_the_envelope_is_refused_at_the_start() {
    for Bounded { set, bound, sign, name } in bounds() {
        for beyond in [false, true] {
            let mut flash = Memory::erased();
            let mut store = Store::new(&mut flash, SLOTS, BOARD).unwrap();
            let mut writer = store.writer().unwrap();
            let value = if beyond { bound + sign * 1e-3 * bound.abs() } else { bound };
            let settings = of_axis(0, |axis| set(axis, value));
            writer.message(&mut store, &UploadKind::Settings).unwrap();
            writer.bytes(&mut store, &bytes_of(&settings)).unwrap();
            assert_eq!(writer.commit(&mut store), Ok(1));
            let mut rig = Rig::with_flash(flash);
            let (source, stored) = if beyond {
                (SettingsSource::Program, StoredRecord::Refused(1))
            } else {
                (SettingsSource::Record, StoredRecord::Valid(1))
            };
            assert_eq!(rig.status().settings, SettingsReport { source, stored }, "{name}");
            rig.close_switch();
            let enabled = rig.request(&Request::Enable);
            let faulted = Reply::Refused(Refusal::Faulted(Fault::StoredSettings));
            assert_eq!(enabled, if beyond { faulted } else { Reply::Done });
        }
    }
}

/// Whether settings are within the envelope, in words of this test.
fn is_within(axis: &AxisSettings, envelope: &AxisEnvelope) -> bool {
    let up_to = |value: Option<f64>, ceiling| value.is_some_and(|value| value <= ceiling);
    let [floor, ceiling] = envelope.travel_m.unwrap();
    up_to(axis.fastest_m_per_s, envelope.fastest_m_per_s)
        && axis.force_limit_n <= envelope.force_limit_n
        && axis.saturation_time_s <= envelope.saturation_time_s
        && axis.following_error_limit_m <= envelope.following_error_limit_m
        && up_to(axis.sensors.frozen_encoder_limit_m(), envelope.frozen_encoder_limit_m)
        && up_to(axis.sensors.scale_disagreement_limit_m(), envelope.scale_disagreement_limit_m.unwrap())
        && axis.travel_m.is_some_and(|[least, greatest]| least >= floor && greatest <= ceiling)
        && axis.stop_deceleration_m_per_s2 >= envelope.stop_deceleration_m_per_s2
}

prop_compose! {
    fn sensors()(
        kind in 0..3, disagreement_m in 1e-5..2e-3, frozen_m in 1e-5..1e-3, left_out in 0..8,
    ) -> Sensors {
        let limits = ScaleLimits { disagreement_m, frozen_m };
        match kind {
            0 => Sensors::Motor {
                scale_disagreement_limit_m: (left_out != 0).then_some(disagreement_m),
                frozen_encoder_limit_m: (left_out != 1).then_some(frozen_m),
            },
            1 => Sensors::Table(limits),
            _ => Sensors::Dual { time_constant_s: 0.1, limits },
        }
    }
}

prop_compose! {
    fn any_settings()(
        sensors in sensors(),
        fastest in proptest::option::weighted(0.9, 0.05..0.4),
        force_limit_n in 10.0..500.0,
        saturation_time_s in 0.05..2.0,
        following_error_limit_m in 5e-4..8e-3,
        travel in proptest::option::weighted(0.9, (-0.2..0.0, 0.01..0.2)),
        stop_deceleration_m_per_s2 in 0.1..3.0,
    ) -> AxisSettings {
        let [axis, _] = settings().axes;
        AxisSettings {
            sensors, fastest_m_per_s: fastest, force_limit_n, saturation_time_s, following_error_limit_m,
            travel_m: travel.map(|(least, greatest)| [least, greatest]), stop_deceleration_m_per_s2, ..axis
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    /// Whatever is accepted is within the envelope. What is refused by a bound of the envelope is beyond it.
    #[test]
    #[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
    fn whatever_is_accepted_is_within_the_envelope(x in any_settings(), y in any_settings(), all in 0..4) {
        // Mostly one axis alone is changed, so that a good share is accepted.
        let mut settings = settings();
        settings.axes[0] = x;
        if all == 0 {
            settings.axes[1] = y;
        }
        let within = settings.axes.iter().zip(&ENVELOPE.axes).all(|(axis, envelope)| is_within(axis, envelope));
        match ENVELOPE.admit(settings.clone()) {
            Ok(admitted) => prop_assert!(within && *admitted == settings),
            Err(error) => prop_assert!(!within, "{error}"),
        }
    }
}

/// The server admits what the envelope admits: of 300 uploads with one setting between half of its bound and twice that, those that
/// are accepted are within it.
#[test]
#[cfg_attr(miri, ignore = "a sweep too long for it; other tests run the same code")]
fn an_upload_is_accepted_if_and_only_if_it_is_within_the_envelope() {
    let mut rig = Rig::new();
    let mut accepted = 0;
    for step in 0..300u32 {
        let bounds = bounds();
        let Bounded { set, bound, name, .. } = &bounds[step as usize % bounds.len()];
        let value = bound * (0.5 + 1.5 * f64::from(step) / 300.0);
        let settings = of_axis(usize::from(step % 2 == 0), |axis| set(axis, value));
        let within = settings.axes.iter().all(|axis| is_within(axis, &ENVELOPE.axes[0]));
        let reply = upload(&mut rig, UploadKind::Settings, &settings);
        assert_eq!(reply == Reply::Done, within, "{name} = {value}: {reply:?}");
        accepted += u32::from(within);
    }
    // A third of the ceilings' values is below them; two of nine bounds are floors, of which two thirds are above.
    assert!((60..200).contains(&accepted), "{accepted}");
}
