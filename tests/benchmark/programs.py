"""The programs that jobs are measured with, and how a job is put to each of them."""

import json
import os
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ.get("CCST_BIN", ROOT / "build/release/bin"))
PHASES = ["decode", "prepare", "initialise", "relax", "finalize"]


@dataclass(frozen=True)
class Job:
    """`count` samples of a mesh: `mesh` is a file, else one is made by code."""

    count: int
    faces: int = 20000
    shape: str = "scan"
    mesh: str = ""
    threads: int = 1
    density: str = "uniform"
    draco: bool = False

    def arguments(self):
        made = ["--shape", self.shape, "--faces", self.faces]
        where = ["--mesh", self.mesh] if self.mesh else made
        rest = ["--count", self.count, "--threads", self.threads, "--density", self.density]
        return [str(x) for x in where + rest + ["--draco"] * self.draco]


class Failed(Exception):
    """A program that ended with an error."""


def execute(command, **options):
    """Standard output of a program that must succeed."""
    command = [str(x) for x in command]
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise Failed(f"{' '.join(command)}: exit code {done.returncode}\n{done.stderr.strip()}")
    return done.stdout


class JobProgram:
    """ccst_benchmark_job of this build or another."""

    def __init__(self, path=BIN / "ccst_benchmark_job"):
        self.path = Path(path)

    def run(self, job):
        report = json.loads(execute([self.path, *job.arguments()]))
        report["peak_mib"] = max(report["peak_kib"].values()) / 1024
        return report


class Command:
    """The ccst command of any build, on its own: what it reads and writes comes on top in memory,
    not in seconds."""

    def __init__(self, path):
        self.path = Path(path)
        self.folder = tempfile.TemporaryDirectory(prefix="ccst-benchmark-")

    def run(self, job):
        folder = Path(self.folder.name)
        mesh = job.mesh or folder / f"{job.shape}-{job.faces}.ply"
        if not Path(mesh).exists():
            execute([BIN / "ccst_benchmark_job", *job.arguments(), "--write", mesh])
        arguments = ["sample", mesh, "--local", "--count", job.count, "--threads", job.threads,
                     "--density", job.density, "--progress", "none", "-o", folder / "samples.ply",
                     "--summary", folder / "summary.json"]
        command = [str(x) for x in [self.path, *arguments]]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        message = process.stderr.read().decode()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        process.stderr.close()
        if process.returncode != 0:
            raise Failed(f"{' '.join(command)}: exit code {process.returncode}\n{message.strip()}")
        report = json.loads((folder / "summary.json").read_text())
        seconds = report["seconds"]
        seconds["relax"] = seconds.pop("optimise")
        seconds["decode"] = 0.0  # Reading the file, outside of the total.
        seconds["finalize"] = seconds["total"] - sum(
            seconds[phase] for phase in ["prepare", "initialise", "relax"])
        return {**report, "peak_mib": usage.ru_maxrss / 1024,
                "processor": {"total": usage.ru_utime + usage.ru_stime}}


def program(path):
    """The program at `path`, by its name."""
    return Command(path) if Path(path).name == "ccst" else JobProgram(path)


def median(reports):
    """One report with the medians of the seconds and of the memory of several of the same job."""
    result = dict(reports[0])
    for clock in ["seconds", "processor"]:
        result[clock] = {phase: statistics.median(r[clock][phase] for r in reports)
                         for phase in reports[0][clock]}
    result["peak_mib"] = statistics.median(r["peak_mib"] for r in reports)
    result["runs"] = len(reports)
    return result


def measure(runner, job, repeats, patience=30.0):
    """The median report of `repeats` runs; of fewer when they take over `patience` seconds."""
    reports = []
    while len(reports) < repeats:
        reports.append(runner.run(job))
        if sum(r["seconds"]["total"] for r in reports) > patience:
            break
    return median(reports)


def compare(one, other, job, repeats):
    """Runs both programs in turn and returns the medians of each and, by phase, the median of the
    ratios one / other of runs that followed each other: what slows the machine slows both. Of one
    thread the processor's time is compared where both programs tell it by phase."""
    pairs = [(one.run(job), other.run(job)) for _ in range(repeats)]
    ratios = {}
    by_phase = all("relax" in report["processor"] for report in pairs[0])
    clock = "processor" if job.threads == 1 and by_phase else "seconds"
    for phase in [*PHASES, "total"]:
        quotients = [a[clock][phase] / b[clock][phase]
                     for a, b in pairs if b[clock].get(phase, 0.0) > 0.0]
        if quotients:
            ratios[phase] = statistics.median(quotients)
    ratios["processor"] = statistics.median(
        a["processor"]["total"] / b["processor"]["total"] for a, b in pairs)
    first, second = median([a for a, _ in pairs]), median([b for _, b in pairs])
    ratios["memory"] = first["peak_mib"] / second["peak_mib"]
    return first, second, ratios


def number(value):
    """Three figures, without an exponent where that is short."""
    if value is None:
        return ""
    if isinstance(value, int):
        return f"{value:,}"
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def with_threads(job, threads):
    return replace(job, threads=threads)


def say(message):
    print(message, file=sys.stderr, flush=True)
