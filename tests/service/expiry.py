"""Records of jobs: they expire as fast as they come, and are bounded for a caller and in all."""

import os
import sqlite3
import threading
import time

import draco
import grpc

from harness import (WHITE_NOISE, Client, Folder, Report, Server, arguments, error_pb2, eventually,
                     reason, sampling_service_pb2, spec)

RETENTION_SECONDS = 2
# The sweeper comes every five seconds.
LONGEST_STAY_SECONDS = RETENTION_SECONDS + 5 + 3


def records(data, query):
    with sqlite3.connect(f"file:{data}/records.sqlite?mode=ro", uri=True) as database:
        return database.execute(query).fetchone()[0]


def size_of_records(data):
    return sum(os.path.getsize(f"{data}/{n}") for n in os.listdir(data) if n.startswith("records"))


def fill(address, request, seconds, callers=6):
    """Lets callers repeat a request that is answered from the cache; how many jobs that made."""
    made = [0] * callers
    deadline = time.monotonic() + seconds

    def repeat(index):
        with Client(address) as client:
            while time.monotonic() < deadline:
                client.create(request, labels={f"label {i}": "x" * 60 for i in range(8)})
                made[index] += 1

    threads = [threading.Thread(target=repeat, args=(i,)) for i in range(callers)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return sum(made)


def keeps_up(folder, report, seconds):
    """Cached answers come for some time; no more of them stay than come within their retention."""
    data = folder + "/expiry"
    with Server(data, "--job-retention", str(RETENTION_SECONDS)) as server, \
            Client(server.address) as client:
        mesh = client.upload(draco.encode(*draco.torus())).name
        request = spec(mesh, 30, 1, max_iterations=2000, relative_tolerance=1e-300)
        client.wait(client.create(request).name)
        most, done = [0], threading.Event()

        def watch():
            while not done.wait(0.5):
                most[0] = max(most[0], records(data, "SELECT count(*) FROM jobs"))

        watcher = threading.Thread(target=watch)
        watcher.start()
        made = fill(server.address, request, seconds)
        done.set()
        watcher.join()
        rate = made / seconds
        report.figure("cached answers", f"{made} in {seconds} s, {rate:.0f} a second")
        report.figure("most that were there at once", most[0])
        report.check(most[0] < rate * LONGEST_STAY_SECONDS + 100,
                     f"no more than came in {LONGEST_STAY_SECONDS} s")
        gone = eventually(lambda: records(data, "SELECT count(*) FROM jobs") == 0,
                          LONGEST_STAY_SECONDS + 5)
        report.check(gone is not None, f"all were dropped after {gone} s")
        report.check(server.metric("ccst_record_bytes") < 4096, "their records count no more")
        report.check(records(data, "SELECT count(*) FROM histories") == 0, "nor are their reports kept")
        report.figure("records on the disk", f"{size_of_records(data) / 1e6:.1f} MB")
        server.stop()


def bounded(folder, report):
    """A caller meets its limit, is told what would help, and that helps; others go on."""
    data = folder + "/bounded"
    limit = 1_000_000
    with Server(data, "--max-record-bytes-per-caller", str(limit)) as server, \
            Client(server.address) as client:
        mesh = client.upload(draco.encode(*draco.torus())).name
        request = spec(mesh, 30, 1, WHITE_NOISE)
        names, refused = [], None
        while refused is None and len(names) < 5000:
            try:
                names.append(client.create(request).name)
            except grpc.RpcError as error:
                refused = error
        report.figure("jobs until the limit", len(names))
        report.check(refused is not None and reason(refused) == "QUOTA_EXCEEDED",
                     f"refused: {refused and refused.details()}")
        violation = error_pb2.LimitViolation()
        for key, value in refused.trailing_metadata():
            if key == "grpc-status-details-bin":
                for detail in error_pb2.Status.FromString(value).details:
                    detail.Unpack(violation)
        report.check(violation.limit == "max_record_bytes_per_caller" and
                     violation.limit_value == limit < violation.requested_value,
                     f"with the limit that was passed: {violation.limit} {violation.limit_value}")
        report.check(server.metric("ccst_record_bytes") <= limit, "what is kept is within it")
        client.wait(names[0])
        for name in names[:10]:
            client.call(client.jobs.DeleteJob, sampling_service_pb2.DeleteJobRequest(name=name))
        report.check(client.create(request).result_cached, "after some are deleted it goes on")
        server.stop()
    with Server(data, "--max-record-bytes", "4096") as server, Client(server.address) as client:
        try:
            client.create(request)
            report.check(False, "a limit of all that is lower than what is there refuses more")
        except grpc.RpcError as error:
            report.check(reason(error) == "STORAGE_FULL", f"the limit of all: {error.details()}")
        server.stop()


def main():
    args = arguments(__doc__, seconds=12)
    report = Report()
    with Folder() as folder:
        keeps_up(folder, report, args.seconds)
        bounded(folder, report)
    report.exit()


if __name__ == "__main__":
    main()
