"""Measures whole jobs and parts; see README.md.

usage: main.py [measure] [options]      sweeps, parts and limits: results.json and index.html
       main.py against PROGRAM          this build and another in turn, as ratios
       main.py peers                    this build beside other projects
       main.py limits                   tables of geometry-pass.md
       main.py check | record           instruction counts against baseline.json
"""

import argparse
import json
import platform
import shutil
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))
import instructions  # noqa: E402
import limits  # noqa: E402
import peers  # noqa: E402
from programs import BIN, PHASES, ROOT, Job, JobProgram, compare, measure, program, say, \
    with_threads  # noqa: E402

PARTS = "^(Repair|Surface|Draco|Projection|PointTree|Density|Initial|Flips|Order|Closest)"
RATIOS = [*PHASES[1:], "total", "processor", "memory"]


def numbers(text):
    """[1000, 20000] of "1e3,20000"."""
    return [int(float(x)) for x in text.split(",") if x]


def sweep(jobs, threads, repeats):
    """A row a job and number of threads."""
    rows = []
    for job in jobs:
        for count in threads:
            say(f"{job.count} samples, {job.faces} faces, {count} threads")
            row = measure(JobProgram(), with_threads(job, count), repeats)
            relax = row["processor" if count == 1 else "seconds"]["relax"]
            # A pass visits only the samples that are not at rest, so these are more than updates.
            row["samples_swept_per_second"] = row["passes"] * row["count"] / relax
            rows.append(row)
    return rows


def processor():
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def about(report):
    build = report["build"]
    return f"{processor()}; compiler {build['compiler']}, C library {build['libc']}."


def run_limits(options):
    counts = options.counts or numbers("1e3,1e4,1e5,1e6")
    rows = limits.pass_limits(counts, [n for n in counts if n <= 100000], 0.5)
    limits.fill_page(rows, limits.machine(0.5), about(JobProgram().run(Job(count=100))))
    print(limits.PAGE)
    return 0


def run_measure(options):
    from page import write_page

    quick = options.quick
    repeats = 1 if quick else options.repeats
    counts = options.counts or ([500, 1000] if quick else numbers("1e3,1e4,1e5,1e6"))
    sizes = options.faces or ([1000, 4000] if quick else numbers("1e3,1e4,1e5,1e6"))
    results = {
        "by_count": sweep(
            [Job(count=n, faces=2000 if quick else 200000, draco=True) for n in counts],
            options.threads, repeats),
        "by_faces": sweep(
            [Job(count=500 if quick else 10000, faces=f, draco=True) for f in sizes],
            options.threads, repeats),
    }
    small = Job(count=500 if quick else 2000, faces=2000 if quick else 8000)
    results["counters"] = limits.hardware_counters(small)
    if shutil.which("valgrind"):
        _, counted = instructions.count_job(small)
        results["instructions"] = {phase: counted[phase] / small.count for phase in PHASES}
    least = 0.01 if quick else 0.5
    results["machine"] = limits.machine(least)
    results["pass"] = limits.pass_limits([1000] if quick else [1000, 10000, 100000, 1000000],
                                         [1000] if quick else [1000, 10000, 100000], least)
    part = PARTS + ("[^:]*:1000(/.*)?$" if quick else "")
    results["parts"] = limits.google_benchmarks(part, least)
    results["about"] = (
        about(results["by_count"][0]) + " The mesh is a scan made by code. Tables have the seconds "
        "of a clock, plots those of the processor, which other work on the machine changes least. "
        "All are medians; phases under a millisecond are left out of the slopes.")
    options.output.mkdir(parents=True, exist_ok=True)
    (options.output / "results.json").write_text(json.dumps(results, indent=2) + "\n")
    write_page(options.output / "index.html", results)
    print(options.output / "index.html")
    return 0


def run_against(options):
    other = program(options.program)
    # The same kind of program for both: a command also reads and writes files.
    this = program(BIN / other.path.name)
    jobs = [Job(count=n, faces=2 * n) for n in options.counts or [1000, 10000, 100000]]
    print(f"{'samples':>9} {'threads':>7}   this / other: " +
          " ".join(f"{name:>10}" for name in RATIOS))
    rows = []
    for job in [with_threads(job, t) for job in jobs for t in options.threads]:
        first, second, ratios = compare(this, other, job, options.repeats)
        rows.append({"this": first, "other": second, "ratios": ratios})
        print(f"{job.count:9} {job.threads:7}                 " + " ".join(
            f"{ratios.get(name, float('nan')):10.3f}" for name in RATIOS), flush=True)
    options.output.mkdir(parents=True, exist_ok=True)
    (options.output / "against.json").write_text(json.dumps(rows, indent=2) + "\n")
    return 0


def run_peers(options):
    with tempfile.TemporaryDirectory(prefix="ccst-benchmark-") as folder:
        result = peers.measure_peers(folder, (options.counts or [10000])[0], options.repeats,
                                     options.quick)
    peers.print_peers(result)
    options.output.mkdir(parents=True, exist_ok=True)
    (options.output / "peers.json").write_text(json.dumps(result, indent=2) + "\n")
    return 0


def main():
    parser = argparse.ArgumentParser(description="Measures ccst")
    parser.add_argument("what", nargs="?", default="measure",
                        choices=["measure", "against", "peers", "limits", "check", "record"])
    parser.add_argument("program", nargs="?", help="of `against`: ccst_benchmark_job or ccst of "
                                                   "another build")
    parser.add_argument("--quick", action="store_true", help="small jobs: seconds, not minutes")
    parser.add_argument("--counts", type=numbers, help="samples, for example 1e3,1e4,2e6")
    parser.add_argument("--faces", type=numbers, help="faces, for example 1e4,5e6")
    parser.add_argument("--threads", type=numbers, default=[1, 2], help="default 1,2")
    parser.add_argument("--repeats", type=int, default=5, help="runs of a job, at most; default 5")
    parser.add_argument("--output", type=Path, default=ROOT / "build/benchmark")
    options = parser.parse_args()
    if options.what == "check":
        return instructions.check()
    if options.what == "record":
        return instructions.record()
    if options.what == "peers":
        return run_peers(options)
    if options.what == "limits":
        return run_limits(options)
    if options.what == "against":
        if options.program is None:
            parser.error("against which program?")
        return run_against(options)
    return run_measure(options)


if __name__ == "__main__":
    sys.exit(main())
