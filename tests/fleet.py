#!/usr/bin/env python3
"""Tests of tools/fleet.py on a local cluster; `tests/deep.sh fleet` runs them.

    tests/fleet.py PROGRAM cases    the nine blind cases: what a plain loop gets (LOST_MOTION_DATA: folder with cases)
    tests/fleet.py PROGRAM foreign  a log with other names, which are told after --
    tests/fleet.py PROGRAM kills    1,000 short traces while the worker of each twentieth is killed: none is lost
    tests/fleet.py PROGRAM refused  invalid arguments and logs
"""

import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))

import fleet  # noqa: E402

# Short traces, and how many logs differ.
TRACES, LOGS = 1000, 50
# The worker of each task with a number that this divides is killed: 5 %.
KILL_EACH = 20
# More than the workers of the run without kills, as they are killed.
WORKERS = 4


def plain(program, task):
    """The JSON of a task by the program alone."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out.json")
        subprocess.run([program, *fleet.arguments_of(task), "--json", out], check=True, stdout=subprocess.DEVNULL)
        return json.loads(pathlib.Path(out).read_text())


def fleet_of(program, folder, *more):
    """Runs tools/fleet.py and gives its exit code, stderr and rows."""
    import pyarrow.parquet

    with tempfile.TemporaryDirectory() as work:
        out = os.path.join(work, "all.parquet")
        command = [sys.executable, ROOT / "tools/fleet.py", folder, "--out", out, "--program", program, *more]
        ran = subprocess.run(command, capture_output=True, text=True)
        rows = pyarrow.parquet.read_table(out).to_pylist() if os.path.exists(out) else None
        assert os.listdir(work) == (["all.parquet"] if rows is not None else []), os.listdir(work)
        return ran, rows


def cases(program):
    folder = pathlib.Path(os.environ["LOST_MOTION_DATA"]) / "cases"
    tasks = fleet.tasks_of(folder)
    assert len(tasks) >= 9 and all(task["fit"] and task["validate"] for task in tasks), len(tasks)
    started = time.monotonic()
    expected = {task["task"]: plain(program, task) for task in tasks}
    loop_s = time.monotonic() - started
    started = time.monotonic()
    ran, rows = fleet_of(program, folder)
    fleet_s = time.monotonic() - started
    assert ran.returncode == 0, ran.stderr
    assert {row["task"]: json.loads(row["json"]) for row in rows} == expected
    assert all(row["verdict"] == expected[row["task"]]["verdict"] for row in rows)
    print(f"cases: {len(rows)} machines as by a plain loop; loop {loop_s:.1f} s, fleet {fleet_s:.1f} s on {os.cpu_count()} cores")


def traced_or_killed(task, program):
    """Traces a task; the first time, the worker of each twentieth is killed while the trace runs."""
    number = int(pathlib.Path(task["fit"][0]).name.split("_")[1].split(".")[0])
    mark = pathlib.Path(task["machine"]).parent / f"killed_{number}"
    if number % KILL_EACH == 0 and not mark.exists():
        mark.touch()
        subprocess.Popen([program, *fleet.arguments_of(task)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.kill(os.getpid(), signal.SIGKILL)
    return fleet.trace(task, program)


MOTION = """name = "short"
feed_mm_per_min = 3000.0
acceleration_m_per_s2 = 2.0
start_mm = { x = 10.0, y = 0.0 }

[[block]]
line_to_mm = { x = 16.0, y = 3.0 }

[[block]]
line_to_mm = { x = 10.0, y = 0.0 }
"""


def short_logs(program, folder):
    """A machine with 1,000 logs of which 50 differ, each under twenty names."""
    machine = folder / "machine.toml"
    machine.write_text((ROOT / "host-sim/machines/demo.toml").read_text())
    (folder / "motion.toml").write_text(MOTION)
    for number in range(LOGS):
        out = folder / f"log_{number}.csv"
        arguments = ["simulate", "--machine", machine, "--motion", folder / "motion.toml", "--out", out, "--seed", str(number)]
        subprocess.run([program, *arguments], check=True, stdout=subprocess.DEVNULL)
    for number in range(LOGS, TRACES):
        os.link(folder / f"log_{number % LOGS}.csv", folder / f"log_{number}.csv")


def kills(program):
    from dask.distributed import Client

    with tempfile.TemporaryDirectory() as work:
        folder = pathlib.Path(work) / "machine"
        folder.mkdir()
        short_logs(program, folder)
        tasks = fleet.tasks_of(work)
        assert len(tasks) == TRACES, len(tasks)
        started = time.monotonic()
        with fleet.cluster(WORKERS) as cluster, Client(cluster) as client:
            rows = fleet.run(client, tasks, program, work=traced_or_killed)
        seconds = time.monotonic() - started
        killed = len(list(folder.glob("killed_*")))
        assert killed == TRACES // KILL_EACH, killed
        assert sorted(row["task"] for row in rows) == sorted(task["task"] for task in tasks)
        failed = [row for row in rows if row["exit_code"] != 0]
        assert not failed, failed[:3]
        check_residuals(program, tasks, rows)
        alone_s = kills_alone(program, tasks)
    print(f"kills: {len(rows)} traces, {killed} workers killed, none lost; {seconds:.0f} s, {alone_s:.0f} s without kills; {WORKERS} workers")


def kills_alone(program, tasks):
    """Seconds of the same traces without kills."""
    from dask.distributed import Client

    started = time.monotonic()
    with fleet.cluster(WORKERS) as cluster, Client(cluster) as client:
        rows = fleet.run(client, tasks, program)
    assert all(row["exit_code"] == 0 for row in rows) and len(rows) == TRACES
    return time.monotonic() - started


def check_residuals(program, tasks, rows):
    """The rows of equal logs have the residuals of a trace by the program alone; those of different logs differ."""
    of_task = {row["task"]: json.loads(row["json"])["residual"] for row in rows}
    different = set()
    for task in tasks:
        number = int(task["task"].rsplit("_", 1)[1].split(".")[0])
        if number < LOGS:
            expected = plain(program, task)["residual"]
            different.add(json.dumps(expected))
            same = [f"{task['task'].rsplit('_', 1)[0]}_{other}.csv" for other in range(number, TRACES, LOGS)]
            assert all(of_task[name] == expected for name in same), task["task"]
    assert len(different) == LOGS, len(different)


def foreign(program):
    """A log whose columns have other names gives the residuals of the plain one, if the names are told after --."""
    with tempfile.TemporaryDirectory() as work:
        folder = pathlib.Path(work) / "machine"
        folder.mkdir()
        (folder / "machine.toml").write_text((ROOT / "host-sim/machines/demo.toml").read_text())
        motion, log = pathlib.Path(work) / "motion.toml", folder / "fit_a.csv"
        motion.write_text(MOTION)
        arguments = ["simulate", "--machine", folder / "machine.toml", "--motion", motion, "--out", log]
        subprocess.run([program, *arguments], check=True, stdout=subprocess.DEVNULL)
        [task] = fleet.tasks_of(work)
        expected = plain(program, task)
        header, rest = log.read_text().split("\n", 1)
        names = header.split(",")
        assert names[0] == "time_s", header
        log.write_text(",".join(["time_s", *(f"column {number}" for number in range(1, len(names)))]) + "\n" + rest)
        ran, [row] = fleet_of(program, work, "--workers", "1")
        assert ran.returncode == 1 and row["exit_code"] == 2, row
        maps = [word for number, name in enumerate(names) if number > 0 for word in ("--map", f"{name}=column {number}")]
        ran, [row] = fleet_of(program, work, "--workers", "1", "--", *maps)
        assert ran.returncode == 0, ran.stderr
        assert json.loads(row["json"])["residual"] == expected["residual"], row
    print("foreign: as by the plain log")


def refused(program):
    with tempfile.TemporaryDirectory() as work:
        ran, rows = fleet_of(program, work)
        assert (ran.returncode, rows) == (2, None) and "expected folders with machine.toml" in ran.stderr, ran.stderr
        machine = pathlib.Path(work) / "machine"
        machine.mkdir()
        (machine / "machine.toml").write_text((ROOT / "host-sim/machines/demo.toml").read_text())
        (machine / "bad.csv").write_text("time_s,x_motor_mm\n0,1\n0.001,x\n")
        ran, rows = fleet_of("no-such-program", work)
        assert (ran.returncode, rows) == (2, None) and "--program" in ran.stderr, ran.stderr
        ran, rows = fleet_of(program, work, "--scheduler", "tcp://127.0.0.1:1")
        assert (ran.returncode, rows) == (2, None) and ran.stderr.count("\n") == 1, ran.stderr
        assert ran.stderr.startswith("fleet.py: --scheduler: expected a running Dask scheduler"), ran.stderr
        # A log that cannot be traced is a row with its error, and no reason to lose the others.
        ran, rows = fleet_of(program, work, "--workers", "1")
        assert ran.returncode == 1 and len(rows) == 1 and rows[0]["exit_code"] == 2, ran.stderr
        assert "bad.csv: line 3: x_motor_mm: expected a finite number" in rows[0]["error"], rows
    print("refused: as expected")


if __name__ == "__main__":
    found = subprocess.run(["which", sys.argv[1]], capture_output=True, text=True).stdout.strip()
    if len(sys.argv) != 3 or sys.argv[2] not in ("cases", "foreign", "kills", "refused") or not found:
        sys.exit(__doc__)
    {"cases": cases, "foreign": foreign, "kills": kills, "refused": refused}[sys.argv[2]](os.path.abspath(found))
