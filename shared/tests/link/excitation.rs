//! The force by which a frequency response is measured: what starts it, what limits it, and what ends it.

use shared::excitation::{Excitation, ExcitationProblem, ExcitationSettings};
use shared::link::message::{Reply, Request};
use shared::link::packet::Header;
use shared::link::refusal::SettingProblem;
use shared::link::report::Activity;
use shared::link::{Identity, Refusal};
use shared::safety::{Fault, Power};
use shared::scalar::{Fixed, Scalar};

use super::jog_by;
use super::rig::{ENVELOPE, IDENTITY, Rig, settings};

fn excitation(axis: u8, force_n: f64) -> ExcitationSettings {
    let harmonics = heapless::Vec::from_slice(&[2, 5, 11]).unwrap();
    ExcitationSettings { axis, force_n, period_ticks: 1024, harmonics }
}

/// Greatest force on x at 40 times, N.
fn force_n(rig: &mut Rig) -> f64 {
    (0..40)
        .map(|_| {
            rig.run(20);
            f64::from(rig.status().axes[0].force_n).abs()
        })
        .fold(0.0, f64::max)
}

/// Below the friction of 20 N the axis stands, so that the force is that of the tones alone, from tick to tick.
#[test]
fn the_force_of_each_tick_is_that_of_the_tones() {
    let mut rig = Rig::enabled();
    let settings = excitation(0, 15.0);
    assert_eq!(rig.request(&Request::Excite(settings.clone())), Reply::Done);
    assert_eq!(rig.status().activity, Activity::Response);
    let tones = Excitation::<Fixed>::new(&settings).unwrap();
    for _ in 0..300 {
        rig.run(1);
        let tick = rig.drive.now() - 1;
        let [x, y] = rig.axes().map(|axis| axis.force_n);
        assert!((f64::from(x) - tones.force(tick).value()).abs() < 1e-4, "{tick}: {x}");
        assert!(y.abs() < 1e-4);
    }
    // Another one replaces it.
    assert_eq!(rig.request(&Request::Excite(excitation(1, 15.0))), Reply::Done);
    assert!(force_n(&mut rig) < 1e-4 && rig.drive.is_exciting());
}

/// Whatever ends a motion ends it, from the next tick on.
#[test]
fn a_halt_another_session_a_fault_and_silence_end_it() {
    type End = fn(&mut Rig);
    let ends: [(&str, End); 8] = [
        ("stop", |rig| assert_eq!(rig.request(&Request::Stop), Reply::Done)),
        ("hold", |rig| assert_eq!(rig.request(&Request::Hold), Reply::Done)),
        ("disable", |rig| assert_eq!(rig.request(&Request::Disable), Reply::Done)),
        ("stop by a guest", |rig| {
            assert_eq!(rig.send(Header::without_session(7), &Request::Stop), Reply::Done);
        }),
        ("another session", |rig| rig.hello(99)),
        ("a fault", |rig| rig.drive.fault(Fault::BusUndervoltage)),
        ("the enable switch", |rig| rig.plant.switch_closed = false),
        ("silence", |rig| rig.run(20 * u32::from(IDENTITY.times.hold_ms))),
    ];
    for (name, end) in ends {
        let mut rig = Rig::enabled();
        assert_eq!(rig.request(&Request::Excite(excitation(0, 15.0))), Reply::Done);
        assert!(force_n(&mut rig) > 5.0, "{name}");
        end(&mut rig);
        rig.run(2);
        assert!(!rig.drive.is_exciting() && rig.drive.activity() == Activity::Idle, "{name}");
        assert!(
            rig.drive.status(Default::default(), Default::default()).axes[0].force_n.abs() < 1e-4,
            "{name}"
        );
        let stays_on = ["stop", "hold", "stop by a guest", "another session", "silence"].contains(&name);
        assert_eq!(rig.drive.machine().power() == Power::On, stays_on, "{name}");
        if stays_on {
            assert_eq!(rig.drive.is_at_rest(), Ok(()), "{name}");
        }
    }
}

/// Beyond the envelope it is refused with the name of the limit, beyond the force limit of the axis and with no tones by the problem.
#[test]
fn what_is_beyond_the_limits_is_refused_by_name() {
    let mut rig = Rig::enabled();
    let ceiling = ENVELOPE.axes[0].excitation_limit_n;
    let beyond = Refusal::Setting {
        axis: 1,
        name: "excitation_limit_n".chars().collect(),
        problem: SettingProblem::AboveCeiling { value: ceiling + 0.5, ceiling },
    };
    assert_eq!(rig.refusal(&Request::Excite(excitation(1, ceiling + 0.5))), beyond);
    assert_eq!(rig.refusal(&Request::Excite(excitation(2, 1.0))), Refusal::NoSuchAxis);
    for (problem, settings) in [
        (ExcitationProblem::Force, excitation(0, f64::NAN)),
        (ExcitationProblem::Force, excitation(0, -1.0)),
        (ExcitationProblem::Period, ExcitationSettings { period_ticks: 1000, ..excitation(0, 1.0) }),
        (
            ExcitationProblem::Tones,
            ExcitationSettings { harmonics: heapless::Vec::new(), ..excitation(0, 1.0) },
        ),
    ] {
        assert_eq!(rig.refusal(&Request::Excite(settings)), Refusal::Excitation(problem));
    }
    assert!(!rig.drive.is_exciting());
    assert_eq!(rig.request(&Request::Excite(excitation(1, ceiling))), Reply::Done);

    // An axis with a force limit below that of the envelope.
    let mut weak = settings();
    weak.axes[0].force_limit_n = 30.0;
    let mut rig = Rig::of(&Identity { ..IDENTITY }, weak);
    rig.hello(1);
    rig.close_switch();
    rig.enable();
    let refused = rig.refusal(&Request::Excite(excitation(0, 31.0)));
    assert_eq!(refused, Refusal::Excitation(ExcitationProblem::Force));
    assert_eq!(rig.request(&Request::Excite(excitation(0, 30.0))), Reply::Done);
}

/// Neither with the drives off nor in a motion, and no motion or override during it.
#[test]
fn it_needs_drives_on_and_standing_axes_and_nothing_else_starts_meanwhile() {
    let mut rig = Rig::new();
    rig.hello(1);
    assert_eq!(rig.refusal(&Request::Excite(excitation(0, 15.0))), Refusal::DrivesOff);
    let mut rig = Rig::enabled();
    assert_eq!(rig.request(&jog_by(0.01)), Reply::Done);
    rig.run(100);
    assert_eq!(rig.refusal(&Request::Excite(excitation(0, 15.0))), Refusal::Moving);
    assert_eq!(rig.request(&Request::Stop), Reply::Done);
    rig.run(3000);
    assert_eq!(rig.request(&Request::Excite(excitation(0, 15.0))), Reply::Done);
    assert_eq!(rig.refusal(&jog_by(0.01)), Refusal::Moving);
    assert_eq!(rig.refusal(&Request::NewMotion), Refusal::Moving);
    assert_eq!(rig.refusal(&Request::Override { percent: 50 }), Refusal::NothingMoves);
    // The host is there: it goes on.
    for _ in 0..10 {
        rig.run(5000);
        assert_eq!(rig.status().activity, Activity::Response);
    }
}
