#!/usr/bin/env python3
"""Traces the logs of many machines on many computers by Dask, and writes all results as one Parquet file: docs/fleet.md.

    tools/fleet.py FOLDER --out ALL.parquet [--workers N | --scheduler ADDRESS] [--program lost-motion]

Each folder below FOLDER with a `machine.toml` is a machine. Its logs `fit_*` (and `validate_*`) are one task; without `fit_*`, each log is a task of
its own. A task whose worker dies is given to another one.
"""

import argparse
import contextlib
import itertools
import json
import logging
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

# A worker that dies is no error of the run; a task that is lost is told with its row. Read at the import, also by the workers of this computer.
os.environ.setdefault("DASK_LOGGING__DISTRIBUTED", "critical")

try:
    import dask
    import pyarrow
    import pyarrow.parquet
    from dask.distributed import Client, LocalCluster, as_completed, get_worker
except ImportError as missing:
    print(f"fleet.py: {missing}; expected `pip install dask distributed pyarrow`", file=sys.stderr)
    sys.exit(2)

# Endings of logs that `lost-motion trace` reads without further arguments.
LOGS = (".csv", ".csv.gz", ".parquet", ".mcap", ".mat", ".npz")

# How often a worker may die with a task before the task counts as lost: a task that kills its worker would be repeated for ever.
MOST_DEATHS = 10

# Tasks given to the cluster at a time, for each worker.
AHEAD = 4


def tasks_of(folder, more=()):
    """The tasks of a folder: each a dict of its name, its machine file, logs to fit, logs to validate and more arguments; sorted by name."""
    tasks = []
    for machine in sorted(pathlib.Path(folder).resolve().rglob("machine.toml")):
        logs = sorted(str(path) for path in machine.parent.iterdir() if path.name.endswith(LOGS))
        named = lambda prefix: [log for log in logs if os.path.basename(log).startswith(prefix)]
        name = machine.parent.name
        if named("fit_"):
            tasks.append({"task": name, "machine": str(machine), "fit": named("fit_"), "validate": named("validate_"), "more": more})
        else:
            one = lambda log: {"task": f"{name}/{os.path.basename(log)}", "machine": str(machine), "fit": [log], "validate": [], "more": more}
            tasks.extend(one(log) for log in logs)
    return tasks


def arguments_of(task):
    """The arguments of `lost-motion trace` but for `--json`."""
    fit = [word for log in task["fit"] for word in ("--fit", log)]
    validate = [word for log in task["validate"] for word in ("--validate", log)]
    return ["trace", "--machine", task["machine"], *fit, *validate, *task["more"]]


def trace(task, program):
    """Traces a task on a worker and gives its row. A trace that fails is a result: it would fail again on any other worker."""
    try:
        scratch = get_worker().local_directory
    except ValueError:
        scratch = None
    started = time.monotonic()
    with tempfile.TemporaryDirectory(dir=scratch) as folder:
        out = os.path.join(folder, "out.json")
        # A task has one core, as the workers share the computer.
        environment = {**os.environ, "RAYON_NUM_THREADS": "1"}
        run = subprocess.run([program, *arguments_of(task), "--json", out], capture_output=True, text=True, env=environment)
        text = pathlib.Path(out).read_text() if run.returncode == 0 else None
    return {
        "task": task["task"],
        "machine": task["machine"],
        "logs": task["fit"] + task["validate"],
        "exit_code": run.returncode,
        "error": run.stderr.strip() if run.returncode else None,
        "verdict": json.loads(text)["verdict"] if text else None,
        "seconds": time.monotonic() - started,
        "json": text,
    }


def run(client, tasks, program, work=trace):
    """The rows of all tasks, sorted by name. A task that was lost with MOST_DEATHS workers has the exit code -1."""
    rows, of_future, left = [], {}, iter(enumerate(tasks))

    def submit(count):
        futures = []
        for number, task in itertools.islice(left, count):
            future = client.submit(work, task, program=program, key=f"{number}-{task['task']}", pure=False)
            of_future[future.key] = task
            futures.append(future)
        return futures

    # Few tasks at a time, and each row is fetched when it is done: a worker that is killed takes few rows with it, which are computed again.
    running = as_completed(submit(AHEAD * max(1, len(client.scheduler_info(n_workers=-1)["workers"]))))
    for future in running:
        running.update(submit(1))
        try:
            rows.append(future.result())
        except Exception as error:  # of the worker or of Dask: it is a row, and the other tasks go on
            task = of_future[future.key]
            lost = {"exit_code": -1, "error": str(error), "verdict": None, "seconds": None, "json": None}
            rows.append({"task": task["task"], "machine": task["machine"], "logs": task["fit"] + task["validate"], **lost})
        future.release()
        if sys.stderr.isatty():
            print(f"\r{len(rows)} of {len(tasks)} tasks", end="\n" if len(rows) == len(tasks) else "", file=sys.stderr)
    return sorted(rows, key=lambda row: row["task"])


def write(rows, out):
    """Writes the rows as Parquet, completely or not at all."""
    schema = pyarrow.schema(
        [
            ("task", pyarrow.string()),
            ("machine", pyarrow.string()),
            ("logs", pyarrow.list_(pyarrow.string())),
            ("exit_code", pyarrow.int64()),
            ("error", pyarrow.string()),
            ("verdict", pyarrow.string()),
            ("seconds", pyarrow.float64()),
            ("json", pyarrow.string()),
        ]
    )
    unfinished = f"{out}.unfinished"
    pyarrow.parquet.write_table(pyarrow.Table.from_pylist(rows, schema), unfinished, compression="zstd")
    os.replace(unfinished, out)


def cluster(workers):
    """A cluster on this computer: a worker a core, each a process that is started again when it dies."""
    dask.config.set({"distributed.scheduler.allowed-failures": MOST_DEATHS})
    # Dask gives up the place of a worker that is not there 15 s after it was lost, even if it was started again and lost a second time.
    dask.config.set({"distributed.deploy.lost-worker-timeout": "1000 h"})
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    return LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=":0")


def refuse(message):
    """Ends the program after a line on stderr, as `lost-motion` does."""
    print(f"fleet.py: {message}", file=sys.stderr)
    sys.exit(2)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0],
        epilog="What stands after -- goes to each trace: arguments of lost-motion trace, such as --map or --rate.",
    )
    parser.add_argument("folder", help="folder of machines, each a folder with machine.toml and logs")
    parser.add_argument("--out", required=True, help="Parquet file to write: one row a task")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="workers on this computer (default: its cores)")
    parser.add_argument("--scheduler", help="address of a running Dask scheduler, in place of --workers")
    parser.add_argument("--program", default="lost-motion", help="the program, as each worker finds it")
    words = sys.argv[1:]
    end = words.index("--") if "--" in words else len(words)
    arguments = parser.parse_args(words[:end])
    tasks = tasks_of(arguments.folder, words[end + 1 :])
    if not tasks:
        refuse(f"{arguments.folder}: expected folders with machine.toml and logs, found none")
    if not os.path.isdir(os.path.dirname(os.path.abspath(arguments.out))):
        refuse(f"--out: expected a file in a folder that exists, found {arguments.out!r}")
    if arguments.workers < 1:
        refuse(f"--workers: expected 1 or more, found {arguments.workers}")
    program = arguments.program
    if not arguments.scheduler:
        program = shutil.which(program) or refuse(f"--program: expected a program, found {program!r}")
    started = time.monotonic()
    with contextlib.ExitStack() as open_until_done:
        where = arguments.scheduler or open_until_done.enter_context(cluster(arguments.workers))
        try:
            client = open_until_done.enter_context(Client(where))
        except (OSError, ValueError) as error:
            refuse(f"--scheduler: expected a running Dask scheduler at {where!r}: {error}".splitlines()[0])
        rows = run(client, tasks, program)
    write(rows, arguments.out)
    failed = [row for row in rows if row["exit_code"] != 0]
    for row in failed:
        print(f"{row['task']}: {row['error']}", file=sys.stderr)
    print(f"{len(rows)} tasks in {time.monotonic() - started:.1f} s, {len(failed)} failed: {arguments.out}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
