"""What limits a geometry pass: its time, instructions and cache misses per update beside what the
machine can do, and the table of geometry-pass.md. And the counters of the processor, where they can
be read."""

import json
import shutil
import subprocess
from pathlib import Path

from instructions import callgrind
from programs import BIN, execute, number, say

PAGE = Path(__file__).resolve().parent / "geometry-pass.md"
LINE = 64  # Bytes of a line of the cache.
COUNTERS = ["instructions", "cycles", "L1-dcache-load-misses", "cache-misses"]


def google_benchmarks(pattern, least_seconds, repetitions=1):
    """Rows of the Google Benchmark program for the benchmarks that match, of several repetitions
    the fastest: what else the machine does only adds. "seconds" are those of the processor that
    the main thread had."""
    rows = json.loads(execute([
        BIN / "ccst_benchmarks", f"--benchmark_filter={pattern}", "--benchmark_format=json",
        f"--benchmark_min_time={least_seconds}", f"--benchmark_repetitions={repetitions}"]))
    fastest = {}
    for row in rows["benchmarks"]:
        if row["run_type"] == "iteration":
            before = fastest.setdefault(row["run_name"], row)
            fastest[row["run_name"]] = min(before, row, key=lambda r: r["cpu_time"])
    unit = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}
    return [{"name": row["run_name"], "real_seconds": row["real_time"] * unit[row["time_unit"]],
             "seconds": row["cpu_time"] * unit[row["time_unit"]],
             "items_per_second": row.get("items_per_second"),
             "bytes_per_second": row.get("bytes_per_second")}
            for row in fastest.values()]


def machine(least_seconds):
    """Peak rates: bytes a second by working set [KiB], nanoseconds a load that depends on the one
    before, operations a second, nanoseconds a division."""
    rows = google_benchmarks("^Machine", least_seconds, repetitions=3)
    of = lambda name: {int(row["name"].split(":")[1]): row for row in rows  # noqa: E731
                       if row["name"].startswith(name + "/")}
    plain = {row["name"]: row for row in rows}
    return {
        "triad_gb_per_second": {size: row["bytes_per_second"] / 1e9
                                for size, row in of("MachineTriad").items()},
        "chase_ns": {size: 1e9 * row["seconds"] for size, row in of("MachineChase").items()},
        "gflops": plain["MachineMultiplyAdd"]["items_per_second"] / 1e9,
        "divide_ns": 1e9 * plain["MachineDivide"]["seconds"],
    }


def simulated_pass(count):
    """Per update of one pass over `count` samples: instructions, loads and stores, and misses of
    the first and the last cache as callgrind simulates them, with the sizes of this machine's."""
    benchmark = f"^GeometryPass/n:{count}/threads:1/"
    stdout, dumps = callgrind(
        [BIN / "ccst_benchmarks", f"--benchmark_filter={benchmark}", "--benchmark_format=json",
         "--benchmark_min_time=0"],
        "--toggle-collect=ccst_benchmark_pass", "--cache-sim=yes")
    updates = count * json.loads(stdout)["benchmarks"][0]["iterations"]
    counts = {name: value / updates for name, value in dumps[-1].items()}
    return {
        "instructions": counts["Ir"],
        "loads": counts["Dr"],
        "stores": counts["Dw"],
        "first_cache_misses": counts["D1mr"] + counts["D1mw"],
        "last_cache_misses": counts["DLmr"] + counts["DLmw"],
    }


def pass_limits(counts, simulated, least_seconds):
    """One row a number of samples; those in `simulated` with what callgrind sees."""
    rows = []
    for count in counts:
        say(f"a pass over {count} samples")
        times = google_benchmarks(f"^GeometryPass/n:{count}/", least_seconds, repetitions=3)
        row = {"count": count}
        for time in times:
            threads = int(time["name"].split("threads:")[1].split("/")[0])
            # With more than one thread the main one's processor time is not all there is.
            seconds = time["seconds" if threads == 1 else "real_seconds"]
            row[f"updates_per_second_{threads}"] = count / seconds
        row["ns"] = 1e9 / row["updates_per_second_1"]
        if count in simulated and shutil.which("valgrind"):
            row.update(simulated_pass(count))
            row["bytes"] = LINE * row["last_cache_misses"]
            row["instructions_per_ns"] = row["instructions"] / row["ns"]
        rows.append(row)
    return rows


def hardware_counters(job):
    """{counter: per sample} of a whole job, or a text that says why there is none."""
    if shutil.which("perf") is None:
        return "perf is not installed"
    command = ["perf", "stat", "-x", ";", "-e", ",".join(COUNTERS), BIN / "ccst_benchmark_job",
               *job.arguments()]
    done = subprocess.run([str(x) for x in command], capture_output=True, text=True)
    values = {}
    for line in done.stderr.splitlines():
        fields = line.split(";")
        if len(fields) > 2 and fields[2].split(":")[0] in COUNTERS and fields[0].isdigit():
            values[fields[2].split(":")[0]] = int(fields[0]) / job.count
    return values or "this machine has no counters that perf can read"


def pass_table(rows):
    """(header, rows of texts) of what an update takes."""
    columns = {
        "samples": "count", "ns": "ns", "updates a second": "updates_per_second_1",
        "on two threads": "updates_per_second_2", "instructions": "instructions",
        "instructions a ns": "instructions_per_ns", "loads": "loads", "stores": "stores",
        "misses of the first cache": "first_cache_misses", "bytes past the last cache": "bytes",
    }
    return list(columns), [[number(row.get(key)) for key in columns.values()] for row in rows]


def machine_table(machine):
    """Rows of texts of what the machine gives."""
    rows = [[f"bandwidth of a triad over {size:,} KiB", f"{number(rate)} GB/s"]
            for size, rate in machine["triad_gb_per_second"].items()]
    rows += [[f"load that waits for the one before, in {size:,} KiB", f"{number(ns)} ns"]
             for size, ns in machine["chase_ns"].items()]
    return rows + [
        ["multiplications and additions a ns, two lanes wide", number(machine["gflops"])],
        ["division and two additions that wait for those before",
         f"{number(machine['divide_ns'])} ns"]]


def fill_page(rows, machine, about, path=PAGE):
    """Replaces what stands between the page's two markers by tables of `rows` and `machine`."""
    header, lines = pass_table(rows)
    text = [about, "", *markdown(header, lines), "", *markdown(["the machine", ""],
                                                               machine_table(machine))]
    before, _, rest = path.read_text().partition("<!-- measured -->\n")
    _, _, after = rest.partition("<!-- end -->\n")
    path.write_text("\n".join([before + "<!-- measured -->", *text, "<!-- end -->"]) + "\n" + after)


def markdown(header, rows):
    return [f"| {' | '.join(row)} |" for row in [header, ["---"] * len(header), *rows]]
