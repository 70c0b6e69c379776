"""Instructions of small jobs by callgrind, and their baseline. They hardly depend on what else the
machine does, so that a few percent more are a change of the code and no noise."""

import json
import re
import shutil
import tempfile
from pathlib import Path

from programs import BIN, PHASES, Job, execute, say

BASELINE = Path(__file__).resolve().parent / "baseline.json"
SKIPPED = 77
TOLERANCE = 0.05

# Few enough samples that all of them take a minute under callgrind, many enough that every phase
# does what it does in large jobs.
JOBS = {
    "scan": Job(count=2000, faces=8000, draco=True),
    "large surface": Job(count=200, faces=40000, shape="torus"),
    "boundary": Job(count=1000, faces=4000, shape="saddle"),
    "soup": Job(count=500, faces=8000, shape="soup"),
    "curvature": Job(count=1000, faces=4000, density="curvature"),
}

# What the C library looks at when it chooses among its functions for memory and mathematics.
CHOOSING_FLAGS = ["avx", "avx2", "avx512f", "avx512vl", "erms", "fma", "fsrm", "rtm", "sse4_2"]


def callgrind(command, *options):
    """(standard output, [instructions between one dump and the next]) of a program."""
    with tempfile.TemporaryDirectory(prefix="ccst-benchmark-") as folder:
        out = Path(folder) / "out"
        stdout = execute(["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", *options,
                          *command])
        dumps = sorted(Path(folder).glob("out.*"), key=lambda p: int(p.suffix[1:]))
        return stdout, [events(dump) for dump in [*dumps, out]]


def events(path):
    """{event: count} of a file of callgrind."""
    text = path.read_text()
    names = re.search(r"^events: (.*)$", text, re.M).group(1).split()
    counts = re.search(r"^totals: (.*)$", text, re.M).group(1).split()
    return dict(zip(names, map(int, counts)))


def count_job(job, path=BIN / "ccst_benchmark_job"):
    """(report of the program, {phase: instructions})."""
    stdout, dumps = callgrind([path, *job.arguments()], "--dump-before=ccst_benchmark_mark")
    # The first dump is what came before the first phase, the last what came after them.
    if len(dumps) != len(PHASES) + 2:
        raise RuntimeError(f"callgrind saw {len(dumps)} marks; is {path} stripped?")
    return json.loads(stdout), {phase: dump["Ir"] for phase, dump in zip(PHASES, dumps[1:])}


def environment(report):
    """What counts depend on besides the code, given the report of any job of the build."""
    flags = re.search(r"^flags\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.M)
    present = set(flags.group(1).split()) if flags else set()
    return {**report["build"], "processor": [f for f in CHOOSING_FLAGS if f in present],
            "valgrind": execute(["valgrind", "--version"]).strip()}


def count_all(jobs):
    counts, where = {}, None
    for name, job in jobs.items():
        say(f"counting the instructions of '{name}'")
        report, phases = count_job(job)
        where = environment(report)
        counts[name] = {"samples": job.count, "alternations": report["alternations"],
                        "instructions": phases}
    return {"made_with": where, "jobs": counts}


def record(path=BASELINE, jobs=None):
    path.write_text(json.dumps(count_all(jobs or JOBS), indent=2, sort_keys=True) + "\n")
    print(f"recorded {path}")
    return 0


def differences(baseline, now, tolerance=TOLERANCE):
    """(lines of a table, those over the baseline, those under it by as much)."""
    lines, over, under = [], [], []
    for name, before in baseline["jobs"].items():
        after = now["jobs"].get(name)
        if after is None:
            over.append(f"{name}: no such job any more")
            continue
        for phase, old in before["instructions"].items():
            new = after["instructions"][phase]
            # A phase of next to nothing, such as decoding a mesh that is there already.
            if max(old, new) < 100_000:
                continue
            change = new / old - 1.0
            line = f"{name + ', ' + phase:28} {old:14,} {new:14,} {100 * change:+7.1f} %"
            if after["alternations"] != before["alternations"]:
                line += f"   ({before['alternations']} -> {after['alternations']} alternations)"
            lines.append(line)
            if change > tolerance:
                over.append(line)
            elif change < -tolerance:
                under.append(line)
    return lines, over, under


def check(path=BASELINE, jobs=None):
    """0, 1 when a count is over the baseline by more than the tolerance, or SKIPPED."""
    if shutil.which("valgrind") is None:
        print("SKIPPED: instructions are counted by valgrind, which is not installed")
        return SKIPPED
    baseline = json.loads(path.read_text())
    jobs = jobs or JOBS
    where = environment(count_job(Job(count=100, faces=200))[0])
    if where != baseline["made_with"]:
        different = [f"{k} {baseline['made_with'].get(k)} -> {v}" for k, v in where.items()
                     if v != baseline["made_with"].get(k)]
        print("SKIPPED: the baseline was made elsewhere and counts would differ for that reason "
              f"alone ({'; '.join(different)}); `tests/benchmark/run record` makes one of this")
        return SKIPPED
    lines, over, under = differences(baseline, count_all(jobs))
    print(f"{'job, phase':28} {'baseline':>14} {'now':>14}   change")
    print("\n".join(lines))
    if under:
        print("Fewer instructions by more than the tolerance: `tests/benchmark/run record` keeps "
              "what was gained from being lost again.")
    if over:
        print(f"More instructions than the baseline by over {100 * TOLERANCE:.0f} %:")
        print("\n".join(over))
        print("If that is the price of something: `tests/benchmark/run record`, and commit "
              "tests/benchmark/baseline.json with the reason.")
        return 1
    print(f"{len(lines)} counts are within {100 * TOLERANCE:.0f} % of the baseline")
    return 0
