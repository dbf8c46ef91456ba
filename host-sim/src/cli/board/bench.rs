//! `lost-motion board bench`: the switches and sensors of the simulated machine of the emulated board.

use anyhow::Result;
use clap::ValueEnum;

use crate::cli::outputs::print;
use ::board::bench::{Bench, END};

/// What is done at the machine.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Action {
    /// Start the emulator with four axes instead of two: the axes z and u are as y.
    StartFour,
    /// Close the enable switch.
    CloseSwitch,
    /// Open the enable switch.
    OpenSwitch,
    /// Press the emergency stop.
    PressStop,
    /// Release the emergency stop.
    ReleaseStop,
    /// The encoder of the x motor freezes.
    FreezeEncoder,
    /// The encoder of the x motor works again.
    ThawEncoder,
    /// The x scale freezes: it has a signal, and its reading stands.
    FreezeScale,
    /// The x scale works again.
    ThawScale,
    /// The x scale loses its signal.
    LoseScale,
    /// The x scale has its signal again.
    RestoreScale,
    /// The x motor has cogging.
    AddCogging,
    /// The x motor has no cogging.
    RemoveCogging,
    /// y is vertical, has a brake, and carries its weight of 147 N.
    StandUp,
    /// y is horizontal.
    LayDown,
    /// Put 3 kg on the table of y.
    AddLoad,
    /// Take the 3 kg from the table of y.
    RemoveLoad,
    /// Put a hard stop before x, 28.8 mm in the negative direction from where it is at power-up.
    AddStop,
    /// Take the hard stop away.
    RemoveStop,
    /// Put a workpiece before the probe of x, 11.2 mm in the positive direction from where x is at power-up.
    AddWorkpiece,
    /// Take the workpiece away.
    RemoveWorkpiece,
    /// Turn the master encoder at the counter of x by a turn of 4000 counts, in a second.
    TurnMaster,
    /// Turn it back by a turn.
    TurnMasterBack,
    /// With the drives off: put a beam on the tables of x and of the last axis, which is moved to x for it, with 0.08 mm of skew.
    AddBeam,
    /// Take the beam away.
    RemoveBeam,
    /// Give the table of the last axis 400 N of friction, twice the force of its drive.
    AddDrag,
    /// Take that friction away.
    RemoveDrag,
    /// The next tick with the drives on takes one and a half periods.
    SlowTick,
    /// The interrupts of the ticks are held off for two periods.
    HoldOffTicks,
    /// End the emulator, as a board without supply: what was saved is kept in its flash.
    End,
    /// End the emulator and erase its flash: the next start is that of a new board.
    EraseFlash,
}

/// Arguments of `board bench`.
#[derive(clap::Args)]
pub struct Arguments {
    /// What is done at the machine.
    action: Action,
}

/// Runs the command.
///
/// # Errors
/// An emulator that cannot be started.
pub fn run(arguments: &Arguments) -> Result<()> {
    let Some((byte, done)) = operation(arguments.action) else {
        Bench::start_four()?;
        return print("The emulated board runs with four axes.");
    };
    let was_running = Bench::is_running();
    if byte != END || was_running {
        Bench::start()?.operate(byte)?;
    }
    let erases = matches!(arguments.action, Action::EraseFlash);
    if erases {
        Bench::erase_flash()?;
    }
    print(match (byte, was_running, erases) {
        (END, false, false) => "No emulator was running.",
        (END, false, true) => "No emulator was running; its flash is erased.",
        _ => done,
    })
}

/// The byte for a machine that runs, and what it has done; `None` for the start of one.
const fn operation(action: Action) -> Option<(u8, &'static str)> {
    Some(match action {
        Action::StartFour => return None,
        Action::CloseSwitch => (b'c', "The enable switch is closed."),
        Action::OpenSwitch => (b'o', "The enable switch is open."),
        Action::PressStop => (b'e', "The emergency stop is pressed."),
        Action::ReleaseStop => (b'r', "The emergency stop is released."),
        Action::FreezeEncoder => (b'f', "The encoder of x is frozen."),
        Action::ThawEncoder => (b't', "The encoder of x works."),
        Action::FreezeScale => (b'k', "The scale of x is frozen."),
        Action::ThawScale => (b'm', "The scale of x works."),
        Action::LoseScale => (b'l', "The scale of x has no signal."),
        Action::RestoreScale => (b'g', "The scale of x has its signal."),
        Action::AddCogging => (b'w', "The x motor has cogging."),
        Action::RemoveCogging => (b'n', "The x motor has no cogging."),
        Action::StandUp => (b'v', "y is vertical, with its brake."),
        Action::LayDown => (b'h', "y is horizontal."),
        Action::AddLoad => (b'a', "The table of y carries 3 kg more."),
        Action::RemoveLoad => (b'd', "The table of y carries nothing more."),
        Action::AddStop => (b'b', "A hard stop is before x."),
        Action::RemoveStop => (b'u', "There is no hard stop before x."),
        Action::AddWorkpiece => (b'p', "A workpiece is before the probe of x."),
        Action::RemoveWorkpiece => (b'x', "There is no workpiece before the probe of x."),
        Action::TurnMaster => (b'j', "The master of x turns by 4000 counts."),
        Action::TurnMasterBack => (b'z', "The master of x turns back by 4000 counts."),
        Action::AddBeam => (b'B', "A beam is on the tables of x and of the last axis."),
        Action::RemoveBeam => (b'U', "There is no beam on the tables of x and of the last axis."),
        Action::AddDrag => (b'D', "The table of the last axis has 400 N more friction."),
        Action::RemoveDrag => (b'R', "The table of the last axis has its own friction."),
        Action::SlowTick => (b's', "The next tick with the drives on takes one and a half periods."),
        Action::HoldOffTicks => (b'i', "The ticks were held off for two periods."),
        Action::End => (END, "The emulator has ended."),
        Action::EraseFlash => (END, "The emulator has ended, and its flash is erased."),
    })
}
