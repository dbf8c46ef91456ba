//! A host is told of late ticks.

use shared::drive::TickCounts;
use shared::safety::{Fault, Power};

use super::rig::Rig;

/// The board of the rig tolerates none: the drives go off, and the counts remain when the fault is acknowledged.
#[test]
fn a_late_tick_is_a_fault_and_counted_in_the_status() {
    let mut rig = Rig::enabled();
    assert_eq!(rig.status().ticks, TickCounts::default());
    rig.plant.late = true;
    rig.run(1);
    rig.plant.late = false;
    let status = rig.status();
    assert_eq!(status.power, Power::Faulted(Fault::Overrun));
    assert_eq!(status.ticks, TickCounts { late: 1, ..TickCounts::default() });
    rig.drive.clear().unwrap();
    assert_eq!(rig.status().ticks.late, 1);
}
