//! The order of stage, brakes and motion, to the tick.

use super::{ENGAGE, FREE, HELD, OFF, Outputs, RELEASE, Rig, WEIGHT_N, braked, loops};
use shared::config::{AxisSettings, Brake};
use shared::interpolate::Block;
use shared::safety::{Fault, FaultKind, Power, Reaction};
use shared::units::Position;

/// `count` times the same outputs.
fn times(outputs: Outputs, count: usize) -> impl Iterator<Item = Outputs> {
    std::iter::repeat_n(outputs, count)
}

/// The force at full scale is 400 N for 8400 counts.
fn force_n<const N: usize>(rig: &Rig<N>) -> f64 {
    400.0 * f64::from(rig.board.duties[0].counts) / 8400.0
}

/// In the tick of the enable the stage comes on with the preload. The brakes open one tick later, when the stage has had its
/// force for a tick, and the path that waits moves after their time, not a tick earlier.
#[test]
fn the_stage_carries_the_weight_before_the_brakes_open_and_the_path_waits_for_them() {
    let mut rig = Rig::new([braked()]);
    rig.machine().push(&Block::line([0.01], 0.05, 5.0)).unwrap();
    let outputs = rig.ticks(2);
    assert_eq!((outputs, rig.power()), (vec![OFF; 2], Power::Off));
    assert_eq!((rig.tick(), rig.power()), (HELD, Power::Enabling));
    // A count is 48 mN.
    assert!((force_n(&rig) - WEIGHT_N).abs() < 0.05, "{} N", force_n(&rig));
    for tick in 0..RELEASE {
        assert_eq!((rig.tick(), rig.power()), (FREE, Power::Enabling), "{tick} ticks after the brakes");
        assert_eq!(rig.board.at, [Position(0)]);
    }
    assert_eq!((rig.tick(), rig.power()), (FREE, Power::On));
    assert!(rig.board.at[0] > Position(0), "the path moves as soon as the brakes are open");
}

/// At rest the brakes close in the next tick; the stage holds the axis for their time, then it goes off.
#[test]
fn the_stage_holds_the_axis_until_the_brakes_have_closed() {
    let mut rig = Rig::on([braked()]);
    rig.ticks(20);
    rig.machine().disable_in_order();
    for tick in 0..ENGAGE {
        assert_eq!((rig.tick(), rig.power()), (HELD, Power::Disabling(None)), "{tick} ticks after");
        assert!((force_n(&rig) - WEIGHT_N).abs() < 0.05, "{} N", force_n(&rig));
    }
    assert_eq!((rig.tick(), rig.power()), (OFF, Power::Off));
    assert!(force_n(&rig) < 1e-9);
}

/// A warning ends when the brakes have closed: not when they begin to, and not when they have opened.
#[test]
fn a_warning_is_kept_until_the_drives_are_off() {
    let mut kinds = FaultKind::ALL.into_iter().map(|kind| Fault::Axis { axis: 0, kind });
    let warning = kinds.find(|fault| fault.reaction() == Reaction::Warn);
    assert!(warning.is_some());
    let mut rig = Rig::new([braked()]);
    rig.ticks(5);
    rig.machine().fault(warning.unwrap());
    rig.ticks(2 * RELEASE);
    assert_eq!((rig.power(), rig.machine().warning()), (Power::On, warning));
    rig.machine().disable_in_order();
    rig.ticks(ENGAGE);
    assert_eq!((rig.power(), rig.machine().warning()), (Power::Disabling(None), warning));
    rig.tick();
    assert_eq!((rig.power(), rig.machine().warning()), (Power::Off, None));
}

/// A motion decelerates first: with v²/(2a) = 50²/(2·2000) mm = 0.625 mm. The brakes close when it stands, and not while it moves. No
/// block is accepted meanwhile.
#[test]
fn an_axis_that_moves_decelerates_before_its_brake_closes() {
    let mut rig = Rig::on([braked()]);
    rig.machine().push(&Block::line([0.1], 0.05, 2.0)).unwrap();
    rig.ticks(2000);
    let start = rig.board.at;
    rig.machine().disable_in_order();
    assert!(rig.machine().push(&Block::line([0.2], 0.05, 2.0)).is_err());
    let mut last = start;
    while rig.tick() == FREE {
        assert_eq!(rig.power(), Power::Disabling(None));
        last = rig.board.at;
    }
    assert_eq!((rig.board.at, rig.board.outputs), (last, HELD), "it moves with closed brakes");
    let way_m = (last[0] - start[0]) as f64 / shared::units::PER_M;
    // A command more or less at 50 mm/s: 2.5 µm.
    assert!((way_m - 0.625e-3).abs() < 5e-6, "{way_m} m");
    let outputs = rig.ticks(ENGAGE);
    assert!(outputs.into_iter().eq(times(HELD, ENGAGE - 1).chain([OFF])));
}

/// A disable before the brakes have opened has nothing to close: the drives go off in the next tick. While they open, they close for their
/// whole time.
#[test]
fn drives_that_come_on_are_disabled_in_order() {
    let mut rig = Rig::new([braked()]);
    rig.ticks(3);
    rig.machine().disable_in_order();
    assert_eq!((rig.tick(), rig.power()), (OFF, Power::Off));
    let mut rig = Rig::new([braked()]);
    rig.ticks(5);
    assert_eq!((rig.board.outputs, rig.power()), (FREE, Power::Enabling));
    rig.machine().disable_in_order();
    let outputs = rig.ticks(ENGAGE + 1);
    assert!(outputs.into_iter().eq(times(HELD, ENGAGE).chain([OFF])));
}

/// The stages have one enable: the slowest brake counts in both directions, also if it is on another axis.
#[test]
fn the_slowest_brake_counts() {
    let brake = |release: f64, engage: f64| {
        Some(Brake { release_s: release * super::TICK_S, engage_s: engage * super::TICK_S })
    };
    let axes = [brake(4.0, 9.0), None, brake(11.0, 2.0)].map(|brake| AxisSettings { brake, ..loops() });
    let mut rig = Rig::new(axes);
    rig.ticks(3 + 11);
    assert_eq!((rig.power(), rig.tick(), rig.power()), (Power::Enabling, FREE, Power::On));
    rig.machine().disable_in_order();
    let outputs = rig.ticks(10);
    assert!(outputs.into_iter().eq(times(HELD, 9).chain([OFF])));
}

/// A fault that stops lets the axis decelerate, closes its brake, and then switches the stage off: the fault has to be acknowledged.
#[test]
fn after_a_stop_by_a_fault_the_brakes_close_before_the_stage_goes_off() {
    let mut rig = Rig::on([braked()]);
    rig.machine().push(&Block::line([0.1], 0.05, 2.0)).unwrap();
    rig.ticks(2000);
    let fault = Fault::OverTemperature;
    rig.machine().fault(fault);
    while rig.tick() == FREE {
        assert!(matches!(rig.power(), Power::Stopping(f) | Power::Disabling(Some(f)) if f == fault));
    }
    assert_eq!((rig.board.outputs, rig.power()), (HELD, Power::Disabling(Some(fault))));
    let outputs = rig.ticks(ENGAGE);
    assert!(outputs.into_iter().eq(times(HELD, ENGAGE - 1).chain([OFF])));
    assert_eq!(rig.power(), Power::Faulted(fault));
}

/// Without a brake there is nothing to wait for, and the output of the brakes never opens them.
#[test]
fn without_a_brake_nothing_waits() {
    let mut rig = Rig::new([loops()]);
    rig.ticks(2);
    assert_eq!((rig.tick(), rig.power()), (HELD, Power::On));
    assert_eq!(rig.ticks(100), vec![HELD; 100]);
    rig.machine().disable_in_order();
    assert_eq!((rig.power(), rig.tick()), (Power::Off, OFF));
}
