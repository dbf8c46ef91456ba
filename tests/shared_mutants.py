#!/usr/bin/env python3
"""Do the tests of `shared` fail when its source is changed? Run by `tests/deep.sh mutants`: docs/testing.md.

    shared_mutants.py TREE RESULTS FINGERPRINT PART…     a part is a module of shared/src, or a file of one

All mutants of a part that cargo-mutants lists are in one build of TREE, a copy of the sources: the body of a function becomes a `match` with an
arm for each mutant, and the environment variable MUTANT selects one when a test program starts. A mutant whose arm the compiler rejects does not
compile. A mutant is run with the tests that reach its function, from the fastest to the first that fails. Some are not built:
see Source. RESULTS has a line for each mutant that was run, and is continued if it begins with FINGERPRINT.
"""

import collections
import itertools
import json
import os
import pathlib
import re
import resource
import subprocess
import sys

ENVIRONMENT = {"RUSTFLAGS": "--cap-lints warn", "PROPTEST_MAX_SHRINK_ITERS": "0", "PROPTEST_RNG_SEED": "1",
               "PROPTEST_DISABLE_FAILURE_PERSISTENCE": "1", "RUST_BACKTRACE": "0"}
# A mutant may loop for ever. The processor time of its tests, s: at least, and as a multiple of that without a mutant. Another job of the
# computer does not count, so that there is a longer time by the clock for a test that waits.
LEAST_S, LONGEST, WAITS_S = 5, 15, 600
# Tests that run together in one process, s: a process takes time to start, and a test behind the one that fails is for nothing.
TOGETHER_S = 0.3
# Minimum percentage of mutants that the tests detect; those listed as equivalent count as not detected.
MIN_DETECTED = 95


def run(command, tree, **extra):
    return subprocess.run(command, cwd=tree, env={**os.environ, **ENVIRONMENT, **extra}, text=True, capture_output=True)


def test(tree, program, names, seconds, **extra):
    """Runs tests, and returns their status and their processor time, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    limit = ["timeout", "--kill-after=1", str(WAITS_S), "prlimit", f"--cpu={int(seconds) + 1}"]
    status = run([*limit, program, "--test-threads", "1", "--exact", *names], tree / "shared", **extra).returncode
    return status, resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def listed(tree, paths, *options):
    """The mutants of files, by file."""
    done = run(["cargo", "mutants", "--list", "--json", "--package", "shared", *options, *(f"--file={path}" for path in paths)], tree)
    if done.returncode != 0:
        sys.exit(done.stderr)
    mutants = collections.defaultdict(list)
    for mutant in json.loads(done.stdout):
        mutants[mutant["file"]].append(mutant)
    return mutants


def body_of(text, start, end):
    """Where the braces of a function are: the first that is not within parentheses, strings and comments."""
    depth = 0
    for token in re.finditer(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])\'|[()\[\]{]', text[start:end], re.S):
        if token[0] == "{" and depth == 0:
            return start + token.start(), end
        depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(token[0], 0)
    sys.exit(f"no body: {text[start:end]}")


class Source:
    """The mutants of a file. Not in the build are those of constants, of functions that the compiler evaluates, and of those that return `impl …`,
    whose arms would have different types."""

    def __init__(self, file, listed, first_function, first_mutant):
        self.file, self.text = file, file.read_text()
        starts = [0, *itertools.accumulate(len(line) for line in self.text.splitlines(keepends=True))]

        def place(span):
            return tuple(starts[span[end]["line"] - 1] + span[end]["column"] - 1 for end in ("start", "end"))

        self.functions = collections.defaultdict(dict)
        self.mutants, self.not_built, spans = {}, [], {}
        for number, mutant in enumerate(listed, first_mutant):
            if mutant["function"] is None or "impl " in mutant["function"]["return_type"]:
                self.not_built.append(mutant["name"])
                continue
            whole = place(mutant["function"]["span"])
            function = spans.setdefault(whole, first_function + len(spans))
            self.mutants[number] = (mutant["name"], function)
            self.functions[whole, function][number] = (*place(mutant["span"]), mutant["replacement"])
        self.count, self.end = len(spans), first_mutant + len(listed)

    def write(self, without, still_constant):
        """Writes the file with a `match` in each function, and returns the numbers of the mutants by line."""
        inserted = [(found.start(), len(found[0]), "") for found in re.finditer(r"\bconst (?=fn (\w+))", self.text)
                    if found[1] not in still_constant]
        for ((start, end), function), mutants in self.functions.items():
            opening, closing = body_of(self.text, start, end)
            constant = re.search(r"\bconst fn (\w+)", self.text[start:opening])
            if constant and constant[1] in still_constant:
                continue
            arms = ""
            for number, (begin, finish, replacement) in mutants.items():
                if number not in without:
                    changed = self.text[opening:begin] + f" {replacement} " + self.text[finish:closing]
                    arms += f"\n/*<{number}*/ {number}usize => {changed}\n/*>{number}*/"
            inserted += [(opening, 0, f"{{ match crate::mutant::of({function}) {{{arms}\n_ => "), (closing, 0, "}}")]
        text = self.text
        for at, length, new in sorted(inserted, reverse=True):
            text = text[:at] + new + text[at + length:]
        self.file.write_text(text)
        self.arms, inside = {}, None
        for line, content in enumerate(text.split("\n"), 1):
            if mark := re.match(r"/\*([<>])(\d+)\*/", content):
                inside = int(mark[2]) if mark[1] == "<" else None
            self.arms[line] = inside


def errors(done):
    """The messages of the compiler that are errors, with the places in the source that they are about."""
    for line in done.stdout.splitlines():
        message = json.loads(line).get("message") if line.startswith("{") else None
        if not isinstance(message, dict) or message["level"] != "error" or not message["spans"]:
            continue
        places = []
        for span in message["spans"]:
            while span["expansion"] and "shared/src" not in span["file_name"]:
                span = span["expansion"]["span"]
            places += [(span["file_name"], span["line_start"])] if span["is_primary"] or not message["code"] else []
        yield message, places


def build(tree, sources):
    """Builds until the compiler rejects nothing any more. Returns the test programs, and the mutants that do not compile."""
    without, still_constant = set(), set()
    functions = sum(source.count for source in sources.values())
    selection = pathlib.Path(__file__).with_name("mutant.rs").read_text().replace("COUNT: usize = 0", f"COUNT: usize = {functions}")
    while True:
        for source in sources.values():
            source.write(without, still_constant)
        with (tree / "shared/src/lib.rs").open("a") as library:
            library.write("mod mutant {\n" + selection + "}\n")
        done = run(["cargo", "test", "--profile", "mutants", "--package", "shared", "--lib", "--test", "integration", "--no-run",
                    "--message-format", "json"], tree)
        if done.returncode == 0:
            built = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
            return [message["executable"] for message in built if message.get("executable")], without
        before = len(without) + len(still_constant)
        for message, places in errors(done):
            rejected = {sources[path].arms.get(line) for path, line in places if path in sources} - {None}
            if constant := re.match(r"cannot call non-const .*`(?:[^`]*::)?(\w+)(?:::<[^`]*>)?` in", message["message"]):
                still_constant.add(constant[1])
            elif rejected:
                without |= rejected
            else:
                print(message["rendered"], file=sys.stderr)
        if len(without) + len(still_constant) == before:
            sys.exit(done.stderr)


def reached(tree, programs):
    """The tests of each function, with their durations: each test alone."""
    tests = collections.defaultdict(list)
    for program in programs:
        for name in re.findall(r"^(.*): test$", run([program, "--list", "--format", "terse"], tree / "shared").stdout, re.M):
            (calls := tree.parent / "called").write_text("")
            status, duration = test(tree, program, [name], WAITS_S, MUTANT="0", CALLED=str(calls))
            if status != 0:
                sys.exit(f"fails without a mutant: {name}")
            for function in set(calls.read_text().split()):
                tests[int(function)].append((duration, program, name))
    return tests


def together(tests):
    """Tests of one program that follow each other, from the fastest on, in groups that take a short time."""
    groups = []
    for duration, program, name in sorted(tests):
        if groups and groups[-1][1] == program and groups[-1][0] + duration <= TOGETHER_S:
            groups[-1] = (groups[-1][0] + duration, program, [*groups[-1][2], name])
        else:
            groups.append((duration, program, [name]))
    return groups


def outcome(tree, number, tests):
    for duration, program, names in together(tests):
        status, _ = test(tree, program, names, max(LEAST_S, LONGEST * duration), MUTANT=str(number))
        if status != 0:
            return "timeout" if status in (124, 137, -9) else "caught"
    return "missed"


def files_of(tree, part):
    path = tree / "shared/src" / part
    return [str(file.relative_to(tree)) for file in (sorted(path.rglob("*.rs")) if path.is_dir() else [path.with_suffix(".rs")])]


def finished(results, fingerprint):
    """The results of an interrupted run of the same sources and tests."""
    lines = results.read_text().splitlines() if results.exists() else []
    if lines[:1] != [fingerprint]:
        results.write_text(fingerprint + "\n")
        return {}
    return {name: result for result, name in (line.split(" ", 1) for line in lines[1:])}


def main(tree, results, fingerprint, parts):
    paths = list(dict.fromkeys(path for part in parts for path in files_of(tree, part)))
    to_run, everything = listed(tree, paths), listed(tree, paths, "--no-config")
    sources, function, mutant = {}, 0, 2
    # All files, as a function that is not constant any more may be called by a constant one anywhere.
    for path in paths + [path for path in files_of(tree, ".") if path not in paths]:
        sources[path] = Source(tree / path, to_run[path], function, mutant)
        function, mutant = function + sources[path].count, sources[path].end
    done = finished(results, fingerprint)
    programs, without = build(tree, sources)
    tests = reached(tree, programs)
    table = []
    for path in paths:
        source = sources[path]
        count = collections.Counter(equivalent=len(everything[path]) - len(to_run[path]), not_built=len(source.not_built))
        arms = set(source.arms.values())
        for number, (name, function) in source.mutants.items():
            if number in arms and name not in done:
                done[name] = outcome(tree, number, tests[function])
                with results.open("a") as file:
                    print(done[name], name, file=file)
            kind = done[name] if number in arms else "unviable" if number in without else "not_built"
            count[kind] += 1
            if kind in ("timeout", "missed", "not_built"):
                print(f"{kind}: {name}", flush=True)
        print("".join(f"not_built: {name}\n" for name in source.not_built), end="")
        table += [(path.removeprefix("shared/src/"), count)] if count.total() else []
    sys.exit(report(table))


def report(table):
    kinds = ["caught", "timeout", "missed", "equivalent", "unviable", "not_built"]
    everything = sum((count for _, count in table), collections.Counter())
    print(f"{'file':36}" + "".join(f"{kind:>11}" for kind in kinds))
    for path, count in [*table, ("all", everything)]:
        print(f"{path:36}" + "".join(f"{count[kind]:11}" for kind in kinds))
    detected = everything["caught"] + everything["timeout"]
    compiled = detected + everything["missed"] + everything["equivalent"]
    print(f"{detected} of {compiled} detected: {100 * detected / max(compiled, 1):.1f} %")
    if everything["missed"] == 0 and 100 * detected >= MIN_DETECTED * compiled:
        return 0
    print(f"expected {MIN_DETECTED} %, and for each that is missed a test, or a line with the reason in .cargo/mutants.toml", file=sys.stderr)
    return 1


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3], sys.argv[4:])
