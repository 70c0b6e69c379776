"""Small jobs at once: what the service adds to the time of the core's own runs.

Processor time decides, the server's own a job over the core's phases a job: callers use the same processors.
"""

import json
import os
import statistics
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

import draco

from harness import (Client, Folder, Report, Server, arguments, mesh_pb2, options, program_named,
                     sampling_service_pb2)

TICKS = os.sysconf("SC_CLK_TCK")


def processor_seconds(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def core_seconds(mesh, count, jobs):
    """Processor seconds of the phases of each run, decoding included."""
    with tempfile.NamedTemporaryFile(suffix=".drc") as file:
        file.write(mesh)
        file.flush()
        run = lambda seed: json.loads(subprocess.run(  # noqa: E731
            [program_named("ccst_benchmark_job"), "--mesh", file.name, "--draco", "--count",
             str(count), "--seed", str(seed), "--threads", "1"],
            check=True, capture_output=True, text=True).stdout.strip().splitlines()[-1])
        return [run(seed)["processor"]["total"] for seed in range(jobs)]


def serve(client, mesh, count, seeds, callers):
    """`mesh` goes with each request when it is the bytes, and is named there when it is a name."""
    def sample(seed):
        request = sampling_service_pb2.SampleRequest(skip_cache_lookup=True,
                                                     options=options(count, seed))
        if isinstance(mesh, bytes):
            request.inline_mesh.format = mesh_pb2.MESH_FORMAT_DRACO
            request.inline_mesh.data = mesh
        else:
            request.mesh_name = mesh
        got = sum(len(event.samples.face_indices)
                  for event in client.call(client.jobs.Sample, request))
        return got == count

    with ThreadPoolExecutor(callers) as pool:
        return all(pool.map(sample, seeds))


def main():
    args = arguments(__doc__, jobs=40, count=2000, callers=4, mesh="", inline=False, strict=False)
    report = Report()
    mesh = draco.encode(*draco.torus(96, 48))
    if args.mesh:
        with open(args.mesh, "rb") as file:
            mesh = file.read()
    with Folder() as folder, Server(folder) as server, Client(server.address) as client:
        sent = mesh if args.inline else client.upload(mesh).name
        serve(client, sent, args.count, range(args.jobs, args.jobs + 8), args.callers)
        core = core_seconds(mesh, args.count, args.jobs)
        before, begin = processor_seconds(server.process.pid), time.monotonic()
        complete = serve(client, sent, args.count, range(args.jobs), args.callers)
        elapsed = time.monotonic() - begin
        used = processor_seconds(server.process.pid) - before
    report.check(complete, f"{args.jobs} jobs gave {args.count} samples each")
    report.figure("jobs a second", f"{args.jobs / elapsed:.1f}")
    report.figure("core, processor seconds a job",
                  f"{statistics.mean(core):.4f} (median {statistics.median(core):.4f})")
    report.figure("server, processor seconds a job", f"{used / args.jobs:.4f}")
    report.threshold("server over core", used / sum(core), 1.10, "times", args.strict)
    report.exit()


if __name__ == "__main__":
    main()
