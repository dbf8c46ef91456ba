#!/usr/bin/env python3
"""LinuxCNC moves machines with errors; its logs are traced, compensated and moved again.

Usage: linuxcnc.py LOST-MOTION FOLDER [USER [CASE...]]. LinuxCNC refuses to run as root; USER runs it there, "" is nobody else. The machines
are those of cases.py. The last line is JSON: contour error before, predicted and after, µm rms on the circle, and the
range of the prediction.
"""

import csv
import html
import json
import pathlib
import random
import shutil
import subprocess
import sys

import textbook
from cases import CASES

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM, FOLDER = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
USER = sys.argv[3] if len(sys.argv) > 3 else ""
WANTED = sys.argv[4:]

MOTIONS = ("circle", "travel", "square")

# The circle of drive.py, for the prediction.
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

# Key of the shared memory of sampler.0.
SAMPLER_KEY = "0x48534130"

# What is commanded, of each HAL file of drives.
COMMANDS = {"steppers": "position", "velocity-drives": "velocity", "torque-drives": "force"}


def lost_motion(*arguments):
    """Runs the program and shows its output. It ends with 1 where a motion became worse, which is judged at the end."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        sys.exit(f"lost-motion {' '.join(map(str, arguments))}: {done.stderr}")
    print(done.stdout, flush=True)


def ini_text(folder, case, lines):
    """The INI file. `lines` are those of each joint that take the place of the case's."""
    text = (HERE / "mill.ini").read_text()
    loops = [] if case.drive == "steppers" else [f"{case.feedback}.hal"]
    files = ["machine.hal", f"{case.drive}.hal", *loops, "sample.hal"] if case.truth else ["loopback.hal"]
    for name in files:
        shutil.copy(HERE / name, folder / name)
    text = text.replace("{hal}", "".join(f"HALFILE = {name}\n" for name in files))
    machine = ""
    if case.truth is not None:
        (folder / "truth.toml").write_text(case.truth)
        machine = (f"FILE = {folder}/truth.toml\nCOMMAND = {COMMANDS[case.drive]}\n"
                   f"P_SHARE = {case.p_share}\n")
    own = "".join(f"{key} = {value}\n" for key, value in case.ini.items())
    text = text.replace("{machine}", machine)
    for joint in (0, 1):
        # The first line of a name is the one that LinuxCNC takes.
        text = text.replace(f"{{joint_{joint}}}", lines.get(joint, "") + own)
    return text


def run_linuxcnc(folder, case, lines, motions):
    """Moves motions of drive.py."""
    folder.mkdir(parents=True)
    (folder / "mill.ini").write_text(ini_text(folder, case, lines).replace("{motions}", " ".join(motions)))
    (folder / "tool.tbl").write_text("")
    shutil.copy(HERE / "drive.py", folder / "drive.py")
    (folder / "drive.py").chmod(0o755)
    # The sampler leaves its shared memory, and refuses it where another HAL file samples more pins.
    words = f"cd '{folder}' && {{ ipcrm -M {SAMPLER_KEY} 2>/dev/null; HOME='{folder}' linuxcnc -r mill.ini; }}"
    command = ["sh", "-c", words]
    if USER:
        subprocess.run(["chown", "-R", USER, folder], check=True)
        command = ["su", USER, "-c", words]
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)
    except subprocess.TimeoutExpired as late:
        sys.exit(f"linuxcnc in {folder}: not done within 300 s: {late.stdout} {late.stderr}")
    (folder / "linuxcnc.log").write_text(done.stdout + done.stderr)
    if not (folder / f"{motions[-1]}.txt").exists():
        sys.exit(f"linuxcnc in {folder}: no logs: {done.stdout[-2000:]} {done.stderr[-2000:]}")


def columns(case):
    """The columns of a log in the order of the sampler's pins, which are counted from 2."""
    channels = ["command_mm", "motor_mm"] if case.truth is None else ["command_mm", "motor_mm", "table_mm", "tool_mm", "force_n"]
    return [f"{axis}_{channel}" for axis in ("x", "y") for channel in channels]


def log(folder, name, case, seed):
    """A log of LinuxCNC as ours."""
    raw, path = folder / f"{name}.raw.csv", folder / f"{name}.csv"
    lacks = {"steppers": ["motor_mm", "table_mm", "force_n"], "velocity-drives": ["force_n"]}.get(case.drive, [])
    wanted = [(i, c) for i, c in enumerate(columns(case)) if not any(c.endswith(end) for end in lacks)]
    maps = [word for i, c in wanted for word in ("--map", f"{c}={i + 2}")]
    out = raw if case.truth is None else path
    lost_motion("import", folder / f"{name}.txt", "--out", out, "--rate", 1000, *maps)
    if case.truth is None:
        behind_formulas(raw, path, seed)
    return path


def behind_formulas(raw, path, seed):
    """Puts the tool behind screw and gap into a log, as a probe reads it, with noise of 50 nm, in the place of the motors."""
    noise = random.Random(seed)
    with open(raw, newline="") as source:
        rows = list(csv.DictReader(source))
    tools = {axis: list(textbook.tables_mm(axis, [float(row[f"{axis}_motor_mm"]) for row in rows])) for axis in ("x", "y")}
    with open(path, "w", newline="") as target:
        writer = csv.writer(target)
        writer.writerow(["time_s", "x_command_mm", "x_tool_mm", "y_command_mm", "y_tool_mm"])
        for i, row in enumerate(rows):
            values = [word for axis in ("x", "y") for word in
                      (row[f"{axis}_command_mm"], f"{tools[axis][i] + noise.gauss(0.0, 5e-5):.6f}")]
            writer.writerow([row["time_s"], *values])


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


def folder_name(case_name):
    return case_name.replace(",", "").replace(" ", "-")


def trace(case, known, before, outputs):
    """From logs to a model: the machine file, the model and the JSON are the outputs."""
    machine, better, result = outputs
    if case.has_init:
        lost_motion("init", "--machine", known, "--log", before["circle"], "--log", before["travel"], "--out", machine)
    else:
        shutil.copy(known, machine)
    lost_motion("trace", "--machine", machine, "--fit", before["circle"], "--fit", before["travel"], "--validate",
                before["square"], "--model", better, "--json", result)


def found(result):
    """Names of the effects that a trace has found."""
    return [effect["name"] for effect in json.loads(result.read_text())["effects"]] if result.exists() else []


def run(case, number):
    """Before, remedy, after: the contour errors on the circle, µm rms."""
    folder = FOLDER / folder_name(case.name)
    print(f"\n== {case.name}\n", flush=True)
    run_linuxcnc(folder / "before", case, {}, MOTIONS)
    seed = 100 * number
    before = {name: log(folder / "before", name, case, seed + i) for i, name in enumerate(MOTIONS)}
    known = folder / "known.toml"
    known.write_text(case.known)
    (folder / "circle.toml").write_text(CIRCLE)
    machine, better, file = folder / "machine.toml", folder / "better.toml", folder / "c.toml"
    if case.model_of:
        machine = known
        of_other = (FOLDER / folder_name(case.model_of) / "better.toml").read_text()
        better.write_text(of_other.replace('feedback = "motor"', 'feedback = "table"'))
    else:
        trace(case, known, before, (machine, better, folder / "trace.json"))
    lost_motion("compensate", "--model", better, "--motion", folder / "circle.toml", "--out", file, "--json",
                folder / "c.json", "--format", "linuxcnc", "--out-dir", folder / "remedy")
    run_linuxcnc(folder / "after", case, joint_lines(folder / "remedy"), ["circle"])
    after = log(folder / "after", "circle", case, seed + 50)
    lost_motion("verify", "--machine", machine, "--before", before["circle"], "--after", after, "--predicted", file,
                "--json", folder / "verify.json", "--report", folder / "report")
    [motion] = json.loads((folder / "verify.json").read_text())["motions"]
    errors = motion["contour_error_um"]
    return {"case": case.name, "effects": case.effects, "found": found(folder / "trace.json"),
            "contour_error_um": {key: errors[key]["rms"] for key in ("before", "predicted", "after")},
            "predicted_range_um": motion["predicted_range_um"]}


STYLE = """body { font: 16px/1.5 sans-serif; margin: 2rem auto; max-width: 70rem; padding: 0 1rem; }
table { border-collapse: collapse; } th, td { padding: 0.25rem 0.75rem; text-align: left; border-bottom: 1px solid #ccc; }
td.number, th.number { text-align: right; } iframe { width: 100%; height: 60rem; border: 1px solid #ccc; }"""


def page(results):
    """A page with the figures of all cases, and the page of `verify` of each, with its circles. The text for the terminal: its path."""
    rows, circles = "", ""
    for result in results:
        name, errors = html.escape(result["case"]), result["contour_error_um"]
        least, most = result["predicted_range_um"]
        figures = [f"{errors['before']:.2f}", f"{errors['predicted']:.2f}", f"{least:.2f} to {most:.2f}", f"{errors['after']:.2f}"]
        cells = "".join(f'<td class="number">{figure}</td>' for figure in figures)
        link = html.escape(f"{folder_name(result['case'])}/report/report.html")
        rows += f'<tr><td><a href="{link}">{name}</a></td><td>{html.escape(", ".join(result["effects"]))}</td>{cells}</tr>\n'
        circles += f'<details><summary>{name}</summary><iframe loading="lazy" src="{link}" title="{name}"></iframe></details>\n'
    heads = "".join(f'<th class="number">{head}</th>' for head in ("before", "predicted", "as a range", "after"))
    text = (f'<!doctype html><html lang="en"><head><meta charset="utf-8"><title>LinuxCNC</title><style>{STYLE}</style></head><body>\n'
            "<h1>Circles by LinuxCNC</h1>\n<p>Contour error, µm rms.</p>\n"
            f"<table>\n<tr><th>drives</th><th>errors</th>{heads}</tr>\n{rows}</table>\n<h2>Before and after</h2>\n{circles}</body></html>\n")
    path = FOLDER / "index.html"
    path.write_text(text)
    return f"\nCircles: {path}"


def main():
    cases = [case for case in CASES if not WANTED or case.name in WANTED]
    results = [run(case, number) for number, case in enumerate(cases)]
    print(page(results))
    print(json.dumps({"cases": results}))
    failed = []
    for case, result in zip(cases, results):
        errors = result["contour_error_um"]
        if errors["before"] < case.ratio * errors["after"]:
            failed.append(f"{case.name}: {errors['before']:.2f} to {errors['after']:.2f} µm")
    if failed:
        sys.exit("the contour error did not fall as expected: " + "; ".join(failed))


main()
