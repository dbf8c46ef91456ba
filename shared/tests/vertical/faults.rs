//! What closes the brakes and switches the stage off in the same tick.

use super::{FREE, HELD, OFF, Rig, braked};
use shared::interpolate::Block;
use shared::safety::{Fault, FaultKind, Power, Reaction};

/// The states in which a stage is on: its brakes have to open, they open, it moves, it decelerates after a fault, its brakes close.
fn with_the_stage_on() -> [Rig<1>; 5] {
    let mut held = Rig::new([braked()]);
    held.ticks(3);
    let mut opening = Rig::new([braked()]);
    opening.ticks(6);
    let moving = || {
        let mut rig = Rig::on([braked()]);
        rig.machine().push(&Block::line([0.1], 0.05, 2.0)).unwrap();
        rig.ticks(2000);
        rig
    };
    let mut stopping = moving();
    stopping.machine().fault(Fault::HostSilent);
    stopping.ticks(2);
    let mut closing = Rig::on([braked()]);
    closing.machine().disable_in_order();
    closing.ticks(2);
    let rigs = [held, opening, moving(), stopping, closing];
    let outputs = rigs.each_ref().map(|rig| rig.board.outputs);
    assert_eq!(outputs, [HELD, FREE, FREE, FREE, HELD]);
    rigs
}

fn switching_off() -> impl Iterator<Item = Fault> {
    let on_axis = FaultKind::ALL.into_iter().map(|kind| Fault::Axis { axis: 0, kind });
    on_axis.chain(Fault::OF_THE_MACHINE).filter(|fault| fault.reaction() == Reaction::DriveOff)
}

/// Neither waits for the other: the reading or the force of such an axis is wrong, or nobody knows.
#[test]
fn a_fault_that_switches_the_drives_off_drops_stage_and_brakes_in_the_same_tick() {
    assert!(switching_off().count() >= 13);
    for fault in switching_off() {
        for mut rig in with_the_stage_on() {
            rig.machine().fault(fault);
            assert_eq!((rig.tick(), rig.power()), (OFF, Power::Faulted(fault)));
        }
    }
}

/// The inputs that act within the tick: the enable switch, the stop in hardware, an overrun.
#[test]
fn an_input_drops_stage_and_brakes_in_its_tick() {
    for mut rig in with_the_stage_on() {
        rig.board.switch_closed = false;
        assert_eq!((rig.tick(), rig.power()), (OFF, Power::Off));
    }
    for mut rig in with_the_stage_on() {
        rig.board.stopped = true;
        assert_eq!((rig.tick(), rig.power()), (OFF, Power::Faulted(Fault::HardwareStop)));
    }
    for mut rig in with_the_stage_on() {
        rig.board.late = true;
        assert_eq!((rig.tick(), rig.power()), (OFF, Power::Faulted(Fault::Overrun)));
    }
}

/// After a fault the brakes stay closed until it is acknowledged and the drives are enabled again.
#[test]
fn the_brakes_stay_closed_until_the_next_enable() {
    let mut rig = Rig::on([braked()]);
    rig.machine().fault(Fault::EmergencyStop);
    rig.machine().enable();
    assert_eq!(rig.ticks(50), vec![OFF; 50]);
    rig.machine().disable();
    assert_eq!(rig.ticks(50), vec![OFF; 50]);
    rig.machine().enable();
    assert_eq!(rig.ticks(2), [HELD, FREE]);
}
