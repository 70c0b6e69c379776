"""Cancels and leaves in every phase of a job: how long the worker and the memory stay taken.

The job is large, so that each phase lasts. The worker is seen through GetServerInfo, the memory is
the server's resident set.
"""

import time

import draco

from harness import (Client, Folder, Report, Server, arguments, eventually, job_pb2, options,
                     sampling_service_pb2)

PHASES = {
    "decoding": None,  # Running, but no phase has been left yet.
    "preparing": job_pb2.JOB_PHASE_PREPARING,
    "initializing": job_pb2.JOB_PHASE_INITIALIZING,
    "relaxing": job_pb2.JOB_PHASE_RELAXING,
    "finalizing": job_pb2.JOB_PHASE_FINALIZING,
}


def request(mesh, count):
    # One alternation: finalizing is soon.
    return sampling_service_pb2.SampleRequest(
        mesh_name=mesh, skip_cache_lookup=True, options=options(count, max_iterations=1))


def reach(stream, phase):
    """Reads until the job is in `phase`; False when it ended or went past it."""
    for event in stream:
        job = event.snapshot
        if event.HasField("samples") or job.state in (4, 5, 6):
            return False
        if event.HasField("progress") and phase == job_pb2.JOB_PHASE_RELAXING:
            return True
        if not event.HasField("snapshot") or job.state != job_pb2.Job.STATE_RUNNING:
            continue
        if phase is None or job.progress.phase == phase:
            return True
    return False


def measure(server, mesh, count, phase, how):
    """Seconds until the worker is free and until memory is down; None for a phase not met."""
    with Client(server.address) as watcher:
        before = server.resident_bytes()
        client = Client(server.address)
        stream = client.call(client.jobs.Sample, request(mesh, count))
        if not reach(stream, phase):
            client.close()
            return None
        held = server.resident_bytes()
        begin = time.monotonic()
        if how == "cancel":
            stream.cancel()
        else:
            client.close()  # The connection is gone, as when the client dies.
        freed = eventually(lambda: watcher.load().running_job_count == 0, 10.0)
        # A tenth above what it was, or 16 MiB, is fragmentation.
        limit = max(1.1 * before, before + 2**24)
        memory = eventually(lambda: server.resident_bytes() <= limit, 5.0)
        if memory is not None:
            memory = time.monotonic() - begin
        client.close()
        return freed, memory, held - before, server.resident_bytes() - before


def main():
    args = arguments(__doc__, count=200_000, around=600, across=300, repeats=1,
                     worker_seconds=0.1, memory_seconds=1.0, strict=False)
    report = Report()
    with Folder() as folder, Server(folder) as server:
        data = draco.encode(*draco.torus(args.around, args.across))
        with Client(server.address) as client:
            mesh = client.upload(data).name
            # What the first run leaves behind for good: threads, caches of the allocator.
            stream = client.call(client.jobs.Sample, request(mesh, args.count))
            reach(stream, job_pb2.JOB_PHASE_RELAXING)
            stream.cancel()
            eventually(lambda: client.load().running_job_count == 0, 30.0)
            time.sleep(1.0)
        for name, phase in PHASES.items():
            for how in ("cancel", "loss"):
                met = [m for m in (measure(server, mesh, args.count, phase, how)
                                   for _ in range(args.repeats)) if m]
                if not report.check(len(met) == args.repeats, f"{name}, {how}: the phase was met"):
                    continue
                ends = all(m[0] is not None for m in met)
                if not report.check(ends, f"{name}, {how}: the worker is freed"):
                    continue
                report.figure(f"{name}, {how}: memory held, left over",
                              f"{met[-1][2] / 2**20:.0f} MiB, {met[-1][3] / 2**20:.0f} MiB")
                report.threshold(f"{name}, {how}: worker free after", max(m[0] for m in met),
                                 args.worker_seconds, "s", args.strict)
                down = max(99.0 if m[1] is None else m[1] for m in met)
                report.threshold(f"{name}, {how}: memory down after", down, args.memory_seconds,
                                 "s", args.strict)
        report.check(server.alive(), "the server lives")
    report.exit()


if __name__ == "__main__":
    main()
