"""Other programs on the same mesh for the same number of samples, beside this build."""

import json
import os
import statistics
from pathlib import Path

from programs import BIN, ROOT, Failed, Job, JobProgram, execute, say

PEER_BIN = Path(os.environ.get("CCST_PEER_BIN", ROOT / "build/peers/bin"))
MESHES = Path(os.environ.get("CCST_MESHES", ROOT.parent / "shared/meshes"))
OPEN3D = Path(__file__).resolve().parent / "peers/open3d_poisson.py"
ONE_THREAD = {**os.environ, "OMP_NUM_THREADS": "1"}


def mesh_file(folder, quick):
    """The rocker arm where it is, else a mesh made by code."""
    model = MESHES / "cad/rocker-arm.obj"
    if model.exists() and not quick:
        return model
    mesh = Path(folder) / "scan.ply"
    execute([BIN / "ccst_benchmark_job", *Job(count=4).arguments(), "--write", mesh])
    return mesh


def runners(mesh, count):
    """{name: function that runs it once and returns count, seconds, processor_seconds}."""
    ours = JobProgram()

    def sample():
        report = ours.run(Job(count=count, mesh=str(mesh)))
        return {"count": report["count"], "seconds": report["seconds"]["total"],
                "processor_seconds": report["processor"]["total"]}

    def other(*command):
        return lambda: json.loads(execute(command, env=ONE_THREAD).splitlines()[-1])

    return {
        "ccst": sample,
        "CGAL, isotropic remeshing": other(
            PEER_BIN / "ccst_peer_cgal", "--mesh", mesh, "--count", count),
        "Open3D, sample_points_poisson_disk": other("/usr/bin/python3", OPEN3D, mesh, count),
    }


def measure_peers(folder, count=10000, repeats=5, quick=False):
    """{"mesh", "count", "rows": [{"name", "count", "seconds", "processor_seconds", "ratio"} or
    {"name", "error"}]}: the programs run in turn, medians, ratios of processor seconds over ours,
    which other work on the machine changes least."""
    mesh = mesh_file(folder, quick)
    runs, errors = {}, {}
    for _ in range(repeats):
        for name, run in runners(mesh, count).items():
            if name in errors:
                continue
            say(f"{name} on {mesh.name}")
            try:
                done = run()
                runs.setdefault(name, []).append(done)
            except (Failed, FileNotFoundError) as error:
                errors[name] = str(error).splitlines()[-1]
    rows = [{"name": name, "error": error} for name, error in errors.items()]
    if "ccst" in errors:
        raise Failed(errors["ccst"])
    median = lambda name, key: statistics.median(run[key] for run in runs[name])  # noqa: E731
    for name, done in runs.items():
        processor = median(name, "processor_seconds")
        rows.append({"name": name, "count": done[0]["count"], "seconds": median(name, "seconds"),
                     "processor_seconds": processor,
                     "ratio": processor / median("ccst", "processor_seconds")})
    return {"mesh": mesh.name, "count": count, "repeats": repeats, "rows": rows}


def print_peers(result):
    print(f"{result['mesh']}, {result['count']} samples, one thread, "
          f"median of {result['repeats']}, without reading the file")
    for row in result["rows"]:
        if "error" in row:
            print(f"{row['name']:36} {row['error']}")
        else:
            print(f"{row['name']:36} {row['seconds']:8.3f} s, {row['processor_seconds']:8.3f} s of "
                  f"a processor, {row['ratio']:6.2f} x ccst, {row['count']:8} points")
