#!/usr/bin/env python3
"""LinuxCNC moves a machine with errors; its logs are traced, compensated and moved again.

Usage: linuxcnc.py LOST-MOTION FOLDER [USER]. LinuxCNC refuses to run as root; USER runs it there. What the motor drives, a screw with a
gap, is computed from the logged motors by textbook formulas in this file: nothing of it reaches the loop, as there is no linear scale in it.
The last line is JSON: contour error before, predicted and after, µm rms on the circle.
"""

import csv
import json
import math
import pathlib
import random
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM, FOLDER = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
USER = sys.argv[3] if len(sys.argv) > 3 else None

CIRCLE = """name = "circle"
feed_mm_per_min = 3000.0
acceleration_m_per_s2 = 1.0
start_mm = { x = 40.0, y = 0.0 }
[[block]]
arc = { plane = ["x", "y"], centre_mm = { x = 0.0, y = 0.0 }, turns = 1.0 }
[[block]]
dwell_s = 0.2
[[block]]
arc = { plane = ["x", "y"], centre_mm = { x = 0.0, y = 0.0 }, turns = -1.0 }
"""


def screw_um(axis, x):
    """Pitch error of the screw at a position, mm: a slope of 150 µm/m and a wave of 8 µm over 160 mm; y has none."""
    return 0.15 * x + 8.0 * math.sin(2.0 * math.pi * x / 160.0 + 0.4) if axis == "x" else 0.0


GAP_UM = {"x": 10.0, "y": 6.0}

# Drive, what the machine file says of it, gains in the INI file, whether screw and gap are the machine's, least ratio of the errors.
CASES = [
    {"name": "stepper", "drive": "stepper", "keys": "", "gains": None, "has_errors": True, "ratio": 4.0},
    {"name": "velocity", "drive": "velocity", "keys": "position_gain_per_s = 50.0\nfeedforward_percent = 100.0\n",
     "gains": {"P": 50.0, "FF1": 1.0, "FF2": 0.0}, "has_errors": True, "ratio": 4.0},
    {"name": "no feed-forward", "drive": "velocity", "keys": "position_gain_per_s = 50.0\nfeedforward_percent = 0.0\n",
     "gains": {"P": 50.0, "FF1": 0.0, "FF2": 0.0}, "has_errors": False, "ratio": 4.0},
]


def lost_motion(*arguments):
    """Runs the program and shows its output. It ends with 1 where a motion became worse, which is judged at the end."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        sys.exit(f"lost-motion {' '.join(map(str, arguments))}: {done.stderr}")
    print(done.stdout, flush=True)


def run_linuxcnc(folder, case, lines):
    """Moves all motions of drive.py. `lines` are those of each joint in the INI file."""
    folder.mkdir(parents=True)
    gains = "".join(f"{key} = {value}\n" for key, value in (case["gains"] or {}).items())
    text = (HERE / "mill.ini").read_text().replace("{hal}", f"{case['drive']}.hal")
    for joint in (0, 1):
        # The first line of a name is the one that LinuxCNC takes.
        text = text.replace(f"{{joint_{joint}}}", lines.get(joint, "") + gains)
    (folder / "mill.ini").write_text(text)
    (folder / "tool.tbl").write_text("")
    for name in (f"{case['drive']}.hal", "drive.py"):
        shutil.copy(HERE / name, folder / name)
    (folder / "drive.py").chmod(0o755)
    command = ["linuxcnc", "-r", "mill.ini"]
    if USER:
        subprocess.run(["chown", "-R", USER, folder], check=True)
        command = ["su", USER, "-c", f"cd '{folder}' && HOME='{folder}' linuxcnc -r mill.ini"]
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)
    except subprocess.TimeoutExpired as late:
        sys.exit(f"linuxcnc in {folder}: not done within 300 s: {late.stdout} {late.stderr}")
    if not (folder / "square.txt").exists():
        sys.exit(f"linuxcnc in {folder}: no logs: {done.stdout[-2000:]} {done.stderr[-2000:]}")


def log(folder, name, case, seed):
    """A log of LinuxCNC as ours, with the tool behind screw and gap as a probe reads it, and noise of 50 nm."""
    raw, path = folder / f"{name}.raw.csv", folder / f"{name}.csv"
    columns = {"x_command_mm": 2, "x_motor_mm": 3, "y_command_mm": 4, "y_motor_mm": 5}
    maps = [word for ours, theirs in columns.items() for word in ("--map", f"{ours}={theirs}")]
    lost_motion("import", folder / f"{name}.txt", "--out", raw, "--rate", 1000, *maps)
    noise = random.Random(seed)
    with open(raw, newline="") as source, open(path, "w", newline="") as target:
        reader = csv.DictReader(source)
        columns = ["x_command_mm", "x_motor_mm", "x_tool_mm", "y_command_mm", "y_motor_mm", "y_tool_mm"]
        if not case["gains"]:
            # A stepper motor without an encoder has no motor channel.
            columns = [name for name in columns if "motor" not in name]
        writer = csv.writer(target)
        writer.writerow(["time_s", *columns])
        behind = {}
        for row in reader:
            values = {name: float(row[name]) for name in row if name in columns or "motor" in name}
            for axis in ("x", "y"):
                motor = values[f"{axis}_motor_mm"]
                table = motor + 1e-3 * screw_um(axis, motor) * case["has_errors"]
                half = 5e-4 * GAP_UM[axis] * case["has_errors"]
                behind[axis] = min(max(behind.get(axis, table), table - half), table + half)
                values[f"{axis}_tool_mm"] = behind[axis] + noise.gauss(0.0, 5e-5)
            writer.writerow([row["time_s"], *(f"{values[name]:.6f}" for name in columns)])
    return path


def joint_lines(folder):
    """The lines of each joint in `joints.ini`, with each COMP_FILE where it is."""
    lines, joint = {}, None
    path = folder / "joints.ini"
    for line in path.read_text().splitlines() if path.exists() else []:
        if line.startswith("[JOINT_"):
            joint = int(line[7:-1])
        elif joint is not None:
            lines[joint] = lines.get(joint, "") + line.replace("COMP_FILE = ", f"COMP_FILE = {folder}/") + "\n"
    return lines


def run(case, number):
    """Before, remedy, after: the contour errors on the circle, µm rms."""
    folder = FOLDER / case["name"].replace(" ", "-")
    print(f"\n== {case['name']}\n", flush=True)
    run_linuxcnc(folder / "before", case, {})
    seed = 100 * number
    before = {name: log(folder / "before", name, case, seed + i) for i, name in enumerate(("circle", "travel", "square"))}
    known = folder / "known.toml"
    axes = "".join(f"[axis.{axis}]\ndrive = \"{case['drive']}\"\n{case['keys']}" for axis in ("x", "y"))
    known.write_text(f"name = \"mill\"\nsample_rate_hz = 1000.0\n{axes}")
    (folder / "circle.toml").write_text(CIRCLE)
    machine, better, file = folder / "machine.toml", folder / "better.toml", folder / "c.toml"
    lost_motion("init", "--machine", known, "--log", before["circle"], "--log", before["travel"], "--out", machine)
    lost_motion("trace", "--machine", machine, "--fit", before["circle"], "--fit", before["travel"], "--validate",
                before["square"], "--model", better, "--json", folder / "trace.json")
    lost_motion("compensate", "--model", better, "--motion", folder / "circle.toml", "--out", file, "--json",
                folder / "c.json", "--format", "linuxcnc", "--out-dir", folder / "remedy")
    run_linuxcnc(folder / "after", case, joint_lines(folder / "remedy"))
    after = log(folder / "after", "circle", case, seed + 50)
    lost_motion("verify", "--machine", machine, "--before", before["circle"], "--after", after, "--predicted", file,
                "--json", folder / "verify.json", "--report", folder / "report")
    [motion] = json.loads((folder / "verify.json").read_text())["motions"]
    errors = motion["contour_error_um"]
    found = [effect["name"] for effect in json.loads((folder / "trace.json").read_text())["effects"]]
    return {"drive": case["name"], "effects": found,
            "contour_error_um": {key: errors[key]["rms"] for key in ("before", "predicted", "after")}}


def main():
    results = [run(case, number) for number, case in enumerate(CASES)]
    print(json.dumps({"cases": results}))
    failed = []
    for case, result in zip(CASES, results):
        errors = result["contour_error_um"]
        if errors["before"] < case["ratio"] * errors["after"]:
            failed.append(f"{case['name']}: {errors['before']:.2f} to {errors['after']:.2f} µm")
    if failed:
        sys.exit("the contour error did not fall as expected: " + "; ".join(failed))


main()
