//! The functions that the HAL component calls. They do not unwind into it.

use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use crate::drive::Command;
use crate::machine::{AXES, AxisPins, SimulatedMachine};

/// Greatest difference of the thread's period to that of the machine file, of the latter.
const PERIOD_TOLERANCE: f64 = 0.01;

/// The machine of the file `path`, whose axes take the command `command` (`force`, `velocity` or `position`), at rest at zero; null
/// after a line on stderr that says what is wrong with them.
///
/// # Safety
/// Both are null or strings that end with a zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lost_motion_new(
    path: *const c_char,
    command: *const c_char,
) -> *mut SimulatedMachine {
    // SAFETY: by the contract of this function.
    let [path, command] = [path, command].map(|text| unsafe { text_of(text) });
    let made = catch_unwind(|| machine(path.as_deref(), command.as_deref()));
    match made {
        Ok(Ok(machine)) => Box::into_raw(Box::new(machine)),
        Ok(Err(problem)) => {
            eprintln!("lost_motion: {problem}");
            std::ptr::null_mut()
        }
        Err(_) => std::ptr::null_mut(),
    }
}

fn machine(path: Option<&str>, command: Option<&str>) -> Result<SimulatedMachine, String> {
    let path = path.ok_or("machine: expected the path of a machine file")?;
    let command = command.and_then(Command::named).ok_or_else(|| {
        let found = command.map_or_else(|| "nothing".to_owned(), |command| format!("{command:?}"));
        format!("command: expected force, velocity or position, found {found}")
    })?;
    SimulatedMachine::read(Path::new(path), command).map_err(|error| error.to_string())
}

/// # Safety
/// Null or a string that ends with a zero.
unsafe fn text_of(text: *const c_char) -> Option<String> {
    if text.is_null() {
        return None;
    }
    // SAFETY: by the contract of this function.
    let text = unsafe { CStr::from_ptr(text) };
    Some(text.to_string_lossy().into_owned())
}

/// Moves a machine over one period of a thread (s) by the commands of its pins, and sets the others. `false`: the period is not that
/// of the machine file, or the machine is broken; the pins are then as they were.
///
/// # Safety
/// `machine` is from [`lost_motion_new`] and used by one thread at a time; `pins` are those of 2 axes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lost_motion_step(
    machine: *mut SimulatedMachine,
    period_s: f64,
    pins: *mut AxisPins,
) -> bool {
    if machine.is_null() || pins.is_null() {
        return false;
    }
    // SAFETY: by the contract of this function.
    let (machine, pins) = unsafe { (&mut *machine, &mut *pins.cast::<[AxisPins; AXES]>()) };
    if ((period_s - machine.period_s()) / machine.period_s()).abs() > PERIOD_TOLERANCE {
        return false;
    }
    let mut moved = *pins;
    let is_sound = catch_unwind(AssertUnwindSafe(|| machine.step(&mut moved))).unwrap_or(false);
    if is_sound {
        *pins = moved;
    }
    is_sound
}

/// Frees a machine.
///
/// # Safety
/// `machine` is null, or from [`lost_motion_new`] and not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lost_motion_free(machine: *mut SimulatedMachine) {
    if !machine.is_null() {
        // SAFETY: by the contract of this function.
        drop(unsafe { Box::from_raw(machine) });
    }
}
