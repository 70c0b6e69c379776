"""Many callers and watchers at once: errors, latencies, memory, fairness.

Latencies are measured from a process of their own, so that the load generator's own waiting does
not count. Thresholds fail the run with --strict only: they need a machine that does nothing else.
"""

import asyncio
import multiprocessing
import os
import random
import subprocess
import threading
import time

import draco
import grpc

from harness import (UNLIMITED, WHITE_NOISE, Client, Folder, Report, Server, arguments,
                     environment, health_pb2, options, percentile, sampling_service_pb2,
                     program_named, spec)

HEALTH_EVERY_SECONDS, CREATE_EVERY = 0.02, 5


class Load:
    """Callers that sample and watchers that follow whatever job there is, in one event loop."""

    def __init__(self, address, mesh, count, iterations):
        self._address, self._mesh = address, mesh
        self._count, self._iterations = count, iterations
        self.errors, self.samples, self.watched = [], 0, 0

    async def _caller(self, client, rng):
        while True:
            request = sampling_service_pb2.SampleRequest(
                mesh_name=self._mesh, skip_cache_lookup=True,
                options=options(self._count, rng.getrandbits(32), max_iterations=self._iterations))
            got = 0
            async for event in client.jobs.Sample(request, timeout=300):
                got += len(event.samples.face_indices)
            if got != self._count:
                self.errors.append(f"{got} samples of {self._count}")
            self.samples += 1

    async def _watcher(self, client, rng):
        while True:
            page = await client.jobs.ListJobs(
                sampling_service_pb2.ListJobsRequest(page_size=32, states=[1, 2]), timeout=60)
            if not page.jobs:
                await asyncio.sleep(0.1)
                continue
            name = rng.choice(page.jobs).name
            async for _ in client.jobs.WatchJob(
                    sampling_service_pb2.WatchJobRequest(name=name), timeout=300):
                pass
            self.watched += 1

    async def _guard(self, coroutine):
        try:
            await coroutine
        except grpc.RpcError as error:
            self.errors.append(f"{error.code()} {error.details()}")

    async def run(self, callers, watchers, seconds):
        rng = random.Random(7)
        # Streams a connection are bounded.
        channels = [grpc.aio.insecure_channel(self._address, options=UNLIMITED)
                    for _ in range(-(-(callers + watchers) // 50))]
        clients = [Client(self._address, channel=c) for c in channels]
        tasks = [asyncio.create_task(self._guard(role(clients[i % len(clients)],
                                                      random.Random(rng.random()))))
                 for i, role in enumerate([self._caller] * callers + [self._watcher] * watchers)]
        await asyncio.sleep(seconds)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


def generate(address, mesh, args, results):
    """The load, as a process of its own: grpc.aio does not always come to an end by itself."""
    load = Load(address, mesh, args.count, args.iterations)

    async def run():
        await load.run(args.callers, args.watchers, args.seconds)
        results.put((load.samples, load.watched, load.errors))
        results.close()
        results.join_thread()
        os._exit(0)

    asyncio.run(run())


def probe(address, mesh, seconds, results):
    """Health checks all the time and a CreateJob now and then; puts their seconds."""
    health, create, errors = [], [], []
    with Client(address) as client:
        end = time.monotonic() + seconds
        number = 0
        while time.monotonic() < end:
            try:
                begin = time.perf_counter()
                client.health.Check(health_pb2.HealthCheckRequest(), timeout=30)
                health.append(time.perf_counter() - begin)
                if number % CREATE_EVERY == 0:
                    begin = time.perf_counter()
                    client.create(spec(mesh, 4, number, WHITE_NOISE))
                    create.append(time.perf_counter() - begin)
            except grpc.RpcError as error:
                errors.append(f"probe: {error.code()} {error.details()}")
            number += 1
            time.sleep(HEALTH_EVERY_SECONDS)
    results.put((health, create, errors))


def watch_memory(server, seconds, samples):
    begin = time.monotonic()
    while time.monotonic() - begin < seconds:
        samples.append((time.monotonic() - begin, server.resident_bytes()))
        time.sleep(0.5)


def run_load(args, report):
    with Folder() as folder, Server(folder) as server:
        with Client(server.address) as client:
            mesh = client.upload(draco.encode(*draco.torus(48, 24))).name
        # Forked before there are threads of gRPC's, which do not survive it.
        context = multiprocessing.get_context("spawn")
        results = context.Queue()
        prober = context.Process(target=probe,
                                 args=(server.address, mesh, args.seconds - 1, results))
        prober.start()
        memory = []
        watcher = threading.Thread(target=watch_memory, args=(server, args.seconds, memory))
        watcher.start()
        done = context.Queue()
        generator = context.Process(target=generate, args=(server.address, mesh, args, done))
        generator.start()
        samples, watched, errors = done.get(timeout=args.seconds + 60)
        generator.join()
        watcher.join()
        health, create, probe_errors = results.get(timeout=60)
        prober.join()
        errors += probe_errors
        report.figure("streams finished", f"{samples} Sample, {watched} WatchJob")
        report.check(not errors, f"no call failed {errors[:3]}")
        report.check(samples > 0 and watched > 0, "callers and watchers were served")
        for name, values, limit in (("health", health, 20.0), ("CreateJob", create, 100.0)):
            report.figure(f"{name} calls, median",
                          f"{len(values)}, {1e3 * percentile(values, 0.5):.2f} ms")
            report.threshold(f"{name} p99", 1e3 * percentile(values, 0.99), limit, "ms",
                             args.strict)
        late = [size for at, size in memory if at > args.seconds / 2]
        report.figure("memory", f"{max(late) >> 20} MiB at most")
        report.threshold("memory's change in the second half",
                         100.0 * (max(late) - min(late)) / max(late), 5.0, "%", args.strict)


def new_token(name):
    """A token and its line for the server."""
    output = subprocess.run([program_named("ccst-server"), "--new-token", name],
                            capture_output=True, text=True,
                            check=True, env=environment()).stdout
    return [line.split(": ", 1)[1] for line in output.splitlines()]


def mean_wait(client, mesh, jobs, count, first_seed):
    """Mean seconds from creation to end of `jobs` equal jobs sent at once."""
    begin = time.monotonic()
    names = [client.create(spec(mesh, count, first_seed + i, max_iterations=20,
                                relative_tolerance=1e-300)).name for i in range(jobs)]
    total = 0.0
    for name in names:  # A caller's jobs run in their order.
        client.wait(name)
        total += time.monotonic() - begin
    return total / jobs


def run_fairness(args, report):
    few = args.fair_jobs
    (token_a, line_a), (token_b, line_b) = new_token("greedy"), new_token("modest")
    with Folder() as folder:
        with open(folder + "/tokens", "w", encoding="ascii") as file:
            file.write(line_a + "\n" + line_b + "\n")
        with Server(folder + "/data", "--auth-token-file", folder + "/tokens",
                    "--max-running-jobs", "1") as server, \
                Client(server.address, token_a) as greedy, \
                Client(server.address, token_b) as modest:
            data = draco.encode(*draco.torus(48, 24))
            mesh = [client.upload(data).name for client in (greedy, modest)][0]
            alone = mean_wait(modest, mesh, few, args.fair_count, 0)
            for i in range(10 * few):
                greedy.create(spec(mesh, args.fair_count, 10_000 + i, max_iterations=20,
                                   relative_tolerance=1e-300))
            beside = mean_wait(modest, mesh, few, args.fair_count, 1000)
            report.figure("mean wait alone, beside ten times as many",
                          f"{alone:.3f} s, {beside:.3f} s")
            # The tenth is for the machine's noise.
            report.threshold("the wait grows by a factor of", beside / alone, 2.1, "", args.strict)


def main():
    args = arguments(__doc__, seconds=10.0, callers=64, watchers=200, count=1000, iterations=10,
                     fair_jobs=5, fair_count=300, strict=False)
    report = Report()
    run_load(args, report)
    run_fairness(args, report)
    report.exit()


if __name__ == "__main__":
    main()
