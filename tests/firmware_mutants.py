#!/usr/bin/env python3
"""Do the tests of the chip fail when the source of `firmware` is changed? Run by `tests/deep.sh mutants firmware`: docs/testing.md.

    firmware_mutants.py FILE OUTPUT        the mutants of a source file that cargo-mutants lists
    firmware_mutants.py count              the number of the following
    firmware_mutants.py constants OUTPUT   those of CONSTANTS below: cargo-mutants changes no pins, numbers and periods

Makes the mutants one after the other, in the tree of the working directory. Each is built for the chip
or for the host, and run with the tests of `tests/tests/chip` that can notice it, from the fastest to the first that fails. Writes
caught.txt, missed.txt, timeout.txt and unviable.txt to the folder OUTPUT, as cargo-mutants does: cargo-mutants itself runs all tests of a
mutant before it looks at their results, which takes minutes on an emulated chip.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import time

# Longest time of a build and of a test, s: a mutant may wait for ever.
BUILD_S = 600
TEST_S = 300

# Quick to build. The tests of stack, panics and instructions, which need the program as it is flashed, are not among those below, and the
# last of these keeps the others from computing the depth of the stack.
QUICK_BUILD = {
    "CARGO_PROFILE_FIRMWARE_LTO": "off",
    "CARGO_PROFILE_FIRMWARE_CODEGEN_UNITS": "16",
    "CARGO_PROFILE_FIRMWARE_INCREMENTAL": "true",
    "CARGO_PROFILE_FIRMWARE_DEBUG": "false",
    "QUICK_CHIP_BUILD": "1",
}

START = ["registers::", "board_boot::the_flashed_program"]
CLOSED_LOOP = ["board_boot::a_host_at_the_serial_port"]
WIRES = [
    "board_boot::wiring::the_probe",
    "board_boot::wiring::each_scale",
    "board_boot::wiring::each_index",
    "board_boot::an_open_safety_contact",
    "board_boot::wiring::each_limit_switch",
    "board_boot::wiring::each_home_switch",
]
STORED = ["board_boot::stored::"]
USB = ["board_boot::a_usb_core"]
BRAKES = ["board_boot::the_brakes_open", "board_boot::a_supply"]
MODEL = ["two_drives::", "g474::registers", "g474::start", "g474::wiring", "g474::outputs", "g474::ports", "g474::flash"]
TICKS = ["board_boot::ticks::", "board_boot::a_hard_fault"]

# The tests of a file, by the beginning of its path. The first that fits.
TESTS = {
    "firmware/src/flash.rs": ["flash_model::"],
    "firmware/src/setup.rs": ["setup_values::", *START, *CLOSED_LOOP],
    "firmware/src/board/flash.rs": STORED,
    "firmware/src/board/watchdog.rs": [*START, *STORED],
    "firmware/src/board/usb.rs": [*START, *USB],
    "firmware/src/board/tick.rs": [*START, *CLOSED_LOOP, *TICKS],
    "firmware/src/board/stage.rs": [*START, *CLOSED_LOOP, *TICKS, *BRAKES, *WIRES[3:4]],
    "firmware/src/board/switches.rs": [*START, *CLOSED_LOOP, *WIRES],
    # What both chips share is noticed first by the tests of the second one, which run on the host.
    "firmware/src/two_drives/switches.rs": [*MODEL, *START, *CLOSED_LOOP, *WIRES],
    "firmware/src/two_drives/sensors.rs": [*MODEL, *START, *CLOSED_LOOP, *WIRES[:3]],
    "firmware/src/two_drives/counters.rs": [*MODEL, *START, *CLOSED_LOOP, *WIRES[:3]],
    "firmware/src/two_drives/": [*MODEL, *START, *CLOSED_LOOP, *TICKS, *BRAKES],
    "firmware/src/g474/": MODEL,
    "firmware/src/board/quadrature.rs": [*START, *CLOSED_LOOP, *WIRES[:3]],
    "firmware/src/board/mod.rs": [*START, *CLOSED_LOOP, *TICKS, *BRAKES, *WIRES[:4]],
    "firmware/src/board/converter.rs": [*START, *CLOSED_LOOP, *BRAKES],
    "firmware/src/": [*START, *CLOSED_LOOP, *STORED],
}

# Mutants of constants and wiring: file, what is there, what takes its place, and, where it is not among the first tests of the file, the test
# that is expected to notice it, which is run first.
CONSTANTS = [
    # Sector 9 is of the program.
    ("flash.rs", "from / SLOTS.length + 4", "from / SLOTS.length + 3"),
    ("flash.rs", "starts: [0xc_0000, 0xe_0000]", "starts: [0xe_0000, 0xc_0000]"),
    ("flash.rs", "[0x4567_0123, 0xcdef_89ab]", "[0xcdef_89ab, 0x4567_0123]"),
    ("flash.rs", "DATA_CACHE_RESET: u32 = 1 << 12", "DATA_CACHE_RESET: u32 = 1 << 11"),
    ("setup.rs", "max_bus_mv: 60_000", "max_bus_mv: 600_000"),
    ("setup.rs", "(100.0 + 4.7) / 4.7", "(100.0 + 4.7) / 47.0"),
    ("setup.rs", "5e-3 / 20_000.0", "5e-3 / 5_000.0"),
    ("setup.rs", "Some(0.5e-6)", "Some(1e-6)"),
    ("setup.rs", "TOLERATED_TICKS: u32 = 0", "TOLERATED_TICKS: u32 = 1"),
    ("setup.rs", "CRYSTAL_HZ: u32 = 8_000_000", "CRYSTAL_HZ: u32 = 16_000_000"),
    # Ends, axes and pins exchanged, or a pin beside.
    ("board/switches.rs", "[1 << 1, 1 << 5]", "[1 << 5, 1 << 1]", "board_boot::wiring::each_limit_switch"),
    ("board/switches.rs", "[1 << 9, 1 << 13]", "[1 << 13, 1 << 9]", "board_boot::wiring::each_limit_switch"),
    ("board/switches.rs", "drive_faults: [1 << 2, 1 << 3]", "drive_faults: [1 << 2, 1 << 4]", "board_boot::an_open_safety_contact"),
    ("board/switches.rs", "stop: 1 << 12", "stop: 1 << 13", "board_boot::an_open_safety_contact"),
    ("board/switches.rs", "enable_switch: 1 << 15", "enable_switch: 1 << 13", "board_boot::a_host"),
    ("board/switches.rs", "homes: [1 << 9, 1 << 12]", "homes: [1 << 12, 1 << 9]", "board_boot::wiring::each_home_switch"),
    ("board/switches.rs", "scale_signals: [1 << 3, 1 << 10]", "scale_signals: [1 << 10, 1 << 3]", "board_boot::wiring::each_scale"),
    ("board/switches.rs", "probe: 1 << 15", "probe: 1 << 14", "board_boot::wiring::the_probe"),
    # Y reads the scale of X.
    ("two_drives/sensors.rs", "YScale::Scale(scale) => (Some(scale.position()), None)", "YScale::Scale(_) => (x_table, None)", "board_boot::wiring::each_scale"),
    ("two_drives/sensors.rs", "self.x.take_index() } else { self.y.take_index()", "self.y.take_index() } else { self.x.take_index()", "board_boot::wiring::each_index"),
    ("board/watchdog.rs", "PERIOD_MS: u32 = 10", "PERIOD_MS: u32 = 1000", "registers::"),
    ("board/watchdog.rs", "LONGEST_MS: u32 = 32_767", "LONGEST_MS: u32 = 10", "board_boot::stored::a_save"),
    ("board/converter.rs", "jsq2().bits(12)", "jsq2().bits(13)"),
    ("board/converter.rs", "bus: self.first.jdr3()", "bus: self.second.jdr3()", "board_boot::a_supply"),
    ("board/tick.rs", "CONVERSION_COUNTS: u32 = 600", "CONVERSION_COUNTS: u32 = 60"),
    ("board/tick.rs", "EXTRA_COUNTS: u32 = 64", "EXTRA_COUNTS: u32 = 0"),
    ("board/stage.rs", "w.br14()", "w.br13()", "board_boot::a_hard_fault"),
    ("board/stage.rs", "self.timer.ccr1() } else { self.timer.ccr2()", "self.timer.ccr2() } else { self.timer.ccr1()", "board_boot::a_host"),
    ("board/stage.rs", "bkp().clear_bit()", "bkp().set_bit()"),
    ("board/stage.rs", "level2()", "level1()"),
    ("board/quadrature.rs", "cc3s().ti3().ic3f().fdts_div2_n8()", "cc3s().ti3().ic3f().no_filter()"),
    ("board/dac.rs", "self.0.dhr12r1() } else { self.0.dhr12r2()", "self.0.dhr12r2() } else { self.0.dhr12r1()"),
    ("board/mod.rs", "c.pc6 => 3", "c.pc6 => 2"),
    ("board/mod.rs", "internal_resistor(Pull::Down)", "internal_resistor(Pull::Up)"),
    ("g474/pins.rs", "pin(gpio::B, 4, Mode::Input)", "pin(gpio::B, 8, Mode::Input)"),
    ("g474/pins.rs", "Mode::Device(6, Pull::Down)", "Mode::Device(6, Pull::Up)"),
    ("g474/pins.rs", "SCALE_Y: Mode = Mode::Device(4,", "SCALE_Y: Mode = Mode::Device(2,"),
    ("g474/pins.rs", "[1 << 4, 1 << 13]", "[1 << 13, 1 << 4]", "g474::wiring"),
    ("g474/clock.rs", "WAIT_STATES: u32 = 4", "WAIT_STATES: u32 = 3"),
    ("g474/clock.rs", "TIM8: Self = Self { reset: rcc::APB2RSTR, bit: 13 }", "TIM8: Self = Self { reset: rcc::APB2RSTR, bit: 12 }"),
    ("g474/supply.rs", "1 | 6 << 1", "1 | 5 << 1"),
    ("g474/supply.rs", "BREAKS: u32 = 1 | 1 << 2", "BREAKS: u32 = 1"),
    ("g474/stage.rs", "2 << 8", "1 << 8"),
    ("g474/stage.rs", "BROKEN: u32 = 1 << 7 | 1 << 13", "BROKEN: u32 = 1 << 7", "g474::wiring"),
    ("g474/tick.rs", "EXTRA_COUNTS: u32 = 128", "EXTRA_COUNTS: u32 = 0"),
    ("g474/tick.rs", "CONVERSION_COUNTS: u32 = 1190", "CONVERSION_COUNTS: u32 = 119"),
    ("g474/counters.rs", "tim::TIM4, Index::Fourth", "tim::TIM4, Index::Third"),
    ("g474/counters.rs", "tim::TIM8, Index::Third", "tim::TIM8, Index::Fourth"),
    ("g474/counters.rs", "INPUT: u32 = 0x71", "INPUT: u32 = 0x51"),
    ("g474/converter.rs", "[9, 7, 5, 11]", "[9, 7, 11, 5]"),
    ("g474/dac.rs", "0b10 << 14", "0b01 << 14"),
    ("g474/watchdog.rs", "PERIOD_MS: u32 = 10", "PERIOD_MS: u32 = 1000"),
    ("g474/watchdog.rs", "PRESCALER: u32 = 0", "PRESCALER: u32 = 1"),
    ("g474/flash.rs", "IN_SECOND_BANK: u32 = 1 << 11", "IN_SECOND_BANK: u32 = 0"),
    ("g474/flash.rs", "(offset - SECOND_BANK) / PAGE", "offset / PAGE"),
    ("g474/flash.rs", "starts: [0x6_0000, 0x7_0000]", "starts: [0x7_0000, 0x6_0000]"),
    ("g474/flash.rs", "ERROR_IN_SECOND_BANK: u32 = 1 << 21", "ERROR_IN_SECOND_BANK: u32 = 0"),
    ("g474/can.rs", "DIVIDER: u32 = 5;", "DIVIDER: u32 = 10;"),
    ("g474/can.rs", "0b10 << 30 | 0b001 << 27", "0b10 << 30 | 0b010 << 27"),
    ("g474/can.rs", "BUS_OFF: u32 = 1 << 19", "BUS_OFF: u32 = 1 << 18", "g474::wiring"),
    ("board/usb.rs", "0x1100, 0x1200", "0x1200, 0x1300", "board_boot::a_usb_core"),
]

# What the host compiles: its mutants are built with the program of the tests. The others only change the program of the chip.
FOR_HOST = ("firmware/src/flash.rs", "firmware/src/setup.rs", "firmware/src/two_drives/", "firmware/src/g474/")


def run(command, seconds, **options):
    """Runs a command in a process group of its own; the exit code, None after the timeout, and its output."""
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
        **options,
    )
    try:
        output, _ = process.communicate(timeout=seconds)
        return process.returncode, output
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        process.communicate()
        return None, ""


def build_tests(environment):
    """Builds the program of the tests; its path, or None if it does not compile."""
    command = ["cargo", "test", "--release", "--no-run", "--test", "chip"]
    code, output = run(command, BUILD_S, env=environment)
    found = re.search(r"Executable .*\((.*)\)", output)
    return str(pathlib.Path(found[1]).resolve()) if code == 0 and found else None


def tests_of(file):
    """The tests of a file."""
    return next(tests for path, tests in TESTS.items() if file.startswith(path))


def outcome_of(file, program, environment, first=()):
    """Whether the source as it is now is noticed: caught, missed, timeout or unviable; and by which test. Some tests are run first."""
    if file.startswith(FOR_HOST):
        program = build_tests(environment)
        if program is None:
            return "unviable", ""
    if file != "firmware/src/flash.rs" and not file.startswith("firmware/src/g474/"):
        code, _ = run(["cargo", "board"], BUILD_S, env=environment)
        if code != 0:
            return "unviable", ""
    for test in [*first, *tests_of(file)]:
        code, output = run([program, test], TEST_S, env=environment, cwd="tests")
        if code is None:
            return "timeout", test
        if code != 0:
            return "caught", ", ".join(re.findall(r"^test (\S+) \.\.\. FAILED", output, re.M))
    return "missed", ""


def mutated(source, mutant):
    """The source with a mutant, which is stated by the span that it replaces, in lines and columns from 1."""
    lines = source.splitlines(keepends=True)
    at = lambda place: sum(len(line) for line in lines[: place["line"] - 1]) + place["column"] - 1
    span = mutant["span"]
    return source[: at(span["start"])] + mutant["replacement"] + source[at(span["end"]) :]


def of_file(file):
    """The mutants of a file: file, name, tests to run first, and what makes the source of the mutant."""
    listing = subprocess.run(
        ["cargo", "mutants", "--list", "--json", "--package", "firmware", "--file", file],
        check=True,
        capture_output=True,
        text=True,
    )
    for mutant in json.loads(listing.stdout):
        yield file, mutant["name"], (), lambda source, mutant=mutant: mutated(source, mutant)


def of_constants():
    """The mutants of CONSTANTS, as of_file gives them."""
    for name, old, new, *first in CONSTANTS:
        file = f"firmware/src/{name}"
        if old not in pathlib.Path(file).read_text():
            sys.exit(f"{file} does not contain {old}")
        yield file, f"{file}: {new} for {old}", first, lambda source, old=old, new=new: source.replace(old, new, 1)


def main(what, output):
    environment = {**os.environ, **QUICK_BUILD}
    output = pathlib.Path(output)
    output.mkdir(parents=True, exist_ok=True)
    results = {kind: (output / f"{kind}.txt").open("w") for kind in ("caught", "missed", "timeout", "unviable")}
    program = build_tests(environment)
    if program is None:
        sys.exit("the tests do not compile")
    sound, is_stale = set(), False
    for file, name, first, change in of_constants() if what == "constants" else of_file(what):
        # The program of the tests has the last mutant of a file that the host compiles until it is built again.
        if is_stale:
            program = build_tests(environment)
        is_stale = file.startswith(FOR_HOST)
        # The tests of a file pass without a mutant.
        tests = tuple(tests_of(file))
        if tests not in sound:
            kind, test = outcome_of(file, program, environment)
            if kind != "missed":
                # Once more: a busy computer may have been too slow.
                kind, test = outcome_of(file, program, environment)
            if kind != "missed":
                sys.exit(f"without a mutant of {file}: {kind} {test}")
            sound.add(tests)
        path, start = pathlib.Path(file), time.monotonic()
        source = path.read_text()
        try:
            path.write_text(change(source))
            kind, test = outcome_of(file, program, environment, first)
        finally:
            path.write_text(source)
        results[kind].write(name + "\n")
        results[kind].flush()
        print(f"{kind:8} {time.monotonic() - start:4.0f} s  {name}  {test}", flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["count"]:
        print(len(CONSTANTS))
    else:
        main(*sys.argv[1:])
