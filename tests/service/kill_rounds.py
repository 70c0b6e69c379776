"""Kills the server in the middle of its work, over and over, and looks at what is left.

Every round starts the server on the same records, runs a mixed load and kills it at a moment of
chance. Afterwards: no acknowledged job is lost, each ends, equal specs have equal samples, also of a
server that was never killed, what was cancelled stays cancelled, and a repeated request is the same
job.
"""

import random
import threading
import time

import draco
import grpc

from harness import (ENDED, Client, Folder, Report, Server, arguments, job_pb2, mesh_pb2, options,
                     reason, sampling_service_pb2, spec)

# Some take no time, some are cut short by most kills.
WORK = ((50, 5), (400, 20), (1500, 60))
KILLED = (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.CANCELLED, grpc.StatusCode.UNKNOWN)


class Books:
    """What the server has acknowledged, kept outside of it."""

    def __init__(self):
        self.lock = threading.Lock()
        self.jobs = {}  # request_id -> (name, key); None while the answer is not known.
        self.keys = {}  # request_id -> key of its spec.
        self.cancelled = set()  # Names that were CANCELLED when we were answered.
        self.cancelling = {}  # Name -> round, of those that were CANCELLING.
        self.killed_at = []  # Time of day, by round.
        self.digests = {}  # key -> set of samples_digest.
        self.meshes = {}  # Index -> name.
        self.errors = []

    def error(self, text):
        with self.lock:
            self.errors.append(text)


def shapes():
    return [draco.encode(*draco.torus(16 + 4 * i, 8 + 2 * i)) for i in range(4)]


def spec_of(books, key):
    mesh, count, iterations, seed = key
    return spec(books.meshes[mesh], count, seed, max_iterations=iterations,
                relative_tolerance=1e-300)


def note_end(books, key, job):
    if job.state == job_pb2.Job.STATE_SUCCEEDED:
        with books.lock:
            books.digests.setdefault(key, set()).add(job.result.samples_digest.sha256)


def one_step(books, client, rng, label):
    """One call of the mix; errors of a killed server end the caller."""
    action = rng.random()
    if action < 0.5:
        index = rng.randrange(len(books.meshes))
        count, iterations = rng.choice(WORK)
        key = (index, count, iterations, rng.randrange(4))
        request_id = f"{label}-{rng.getrandbits(48)}"
        with books.lock:
            books.jobs[request_id], books.keys[request_id] = None, key
        job = client.create(spec_of(books, key), request_id=request_id,
                            skip_cache_lookup=rng.random() < 0.5)
        with books.lock:
            books.jobs[request_id] = job.name
        note_end(books, key, job)
        return
    with books.lock:
        known = [(r, n) for r, n in books.jobs.items() if n]
    if action < 0.62 and known:
        job = client.cancel(rng.choice(known[-20:])[1])
        with books.lock:
            if job.state == job_pb2.Job.STATE_CANCELLED:
                books.cancelled.add(job.name)
            elif job.state == job_pb2.Job.STATE_CANCELLING:
                books.cancelling.setdefault(job.name, len(books.killed_at))
    elif action < 0.75 and known:
        request_id, name = rng.choice(known[-20:])
        sequence = 0
        for event in client.watch(name):
            if event.sequence:
                if event.sequence <= sequence:
                    books.error(f"{name}: sequence {event.sequence} after {sequence}")
                sequence = event.sequence
            if event.HasField("snapshot"):
                note_end(books, books.keys[request_id], event.snapshot)
    elif action < 0.9:
        key = (rng.randrange(len(books.meshes)), 50, 5, rng.randrange(4))
        request = sampling_service_pb2.SampleRequest(mesh_name=books.meshes[key[0]],
                                                     options=spec_of(books, key).options)
        for event in client.call(client.jobs.Sample, request):
            if event.HasField("snapshot"):
                note_end(books, key, event.snapshot)
    else:
        client.upload(shapes()[rng.randrange(4)])


def caller(books, address, rng, label, stop):
    with Client(address) as client:
        while not stop.is_set():
            try:
                one_step(books, client, rng, label)
            except grpc.RpcError as error:
                if reason(error) in ("QUEUE_FULL", "QUOTA_EXCEEDED"):
                    time.sleep(0.05)  # As its RetryAdvice asks.
                elif stop.is_set() or error.code() in KILLED and not reason(error):
                    return
                else:
                    books.error(f"{error.code()} {reason(error)} {error.details()}")


def one_round(books, folder, rng, number, callers):
    with Server(folder, "--max-queued-jobs", "100000",
                "--max-queued-jobs-per-caller", "100000") as server:
        stop = threading.Event()
        threads = [threading.Thread(target=caller, args=(
            books, server.address, random.Random(rng.random()), f"{number}-{i}", stop))
            for i in range(callers)]
        for thread in threads:
            thread.start()
        time.sleep(rng.uniform(0.02, 1.2))
        died = not server.alive()
        server.kill()
        books.killed_at.append(time.time())
        stop.set()
        for thread in threads:
            thread.join()
        if died:
            books.error("the server ended by itself: " + server.log()[-2000:])
        return server.start_seconds


def list_all(client):
    """Every job the server lists, by name."""
    jobs, token = {}, ""
    while True:
        page = client.call(client.jobs.ListJobs, sampling_service_pb2.ListJobsRequest(
            page_size=1000, page_token=token))
        jobs.update((job.name, job) for job in page.jobs)
        token = page.next_page_token
        if not token:
            return jobs


def settle(books, folder, report):
    """The last start: everything ends, and is what was promised."""
    with Server(folder, "--max-queued-jobs", "100000",
                "--max-queued-jobs-per-caller", "100000") as server, \
            Client(server.address) as client:
        acknowledged = {r: n for r, n in books.jobs.items() if n}
        listed = list_all(client)
        lost = [n for n in acknowledged.values() if n not in listed]
        report.check(not lost, f"none of {len(acknowledged)} acknowledged jobs is lost {lost[:3]}")
        states, ended_at = {}, {}
        failed = []
        for request_id, name in acknowledged.items():
            if name in lost:
                continue
            job = client.wait(name)
            states[name] = job.state
            ended_at[name] = job.end_time.ToNanoseconds() / 1e9
            note_end(books, books.keys[request_id], job)
            if job.state == job_pb2.Job.STATE_FAILED:
                failed.append((name, job.error.message))
        report.check(not failed and len(states) + len(lost) == len(acknowledged),
                     f"each ended, none failed {failed[:3]}")
        revived = [n for n in books.cancelled if states.get(n) != job_pb2.Job.STATE_CANCELLED]
        report.check(not revived,
                     f"{len(books.cancelled)} cancelled jobs stayed cancelled {revived[:3]}")
        # A run that finishes while it is being cancelled has won the race; after the kill there is
        # no such run any more.
        won = [n for n in books.cancelling if states.get(n) == job_pb2.Job.STATE_SUCCEEDED]
        revived = [n for n in books.cancelling if states.get(n) != job_pb2.Job.STATE_CANCELLED
                   and (n not in won or ended_at[n] > books.killed_at[books.cancelling[n]])]
        report.check(not revived, f"{len(books.cancelling)} jobs that were being cancelled stayed "
                     f"so, but {len(won)} that won the race {revived[:3]}")
        other = []
        for request_id, key in books.keys.items():
            again = client.create(spec_of(books, key), request_id=request_id)
            before = books.jobs[request_id]
            if before and again.name != before:
                other.append((before, again.name))
            if not before:
                note_end(books, key, client.wait(again.name))
        report.check(not other, f"{len(books.keys)} repeated requests gave the same jobs {other[:3]}")
        unfinished = [j.name for j in list_all(client).values() if j.state not in ENDED]
        report.check(not unfinished, f"nothing is left that has not ended {unfinished[:3]}")


def compare(books, report):
    """Equal specs gave equal samples, those of a server that was never killed."""
    two = {k: d for k, d in books.digests.items() if len(d) != 1}
    report.check(not two, f"each of {len(books.digests)} specs has one samples_digest {two}")
    with Folder() as folder, Server(folder, "--threads", "2") as server, \
            Client(server.address) as client:
        for data in shapes():
            client.upload(data)
        wrong = []
        for key, digests in sorted(books.digests.items()):
            job = client.wait(client.create(spec_of(books, key)).name)
            if {job.result.samples_digest.sha256} != digests:
                wrong.append(key)
        report.check(not wrong, f"a fresh server gives the same samples {wrong[:3]}")


def main():
    args = arguments(__doc__, rounds=10, callers=6, seed=1)
    rng = random.Random(args.seed)
    report, books = Report(), Books()
    with Folder() as folder:
        with Server(folder) as server, Client(server.address) as client:
            for index, data in enumerate(shapes()):
                books.meshes[index] = client.upload(data).name
        starts = [one_round(books, folder, rng, i, args.callers) for i in range(args.rounds)]
        report.figure("rounds", args.rounds)
        report.figure("longest start", f"{max(starts):.3f} s")
        report.check(not books.errors, f"no call failed but by the kill {books.errors[:3]}")
        settle(books, folder, report)
    compare(books, report)
    report.exit()


if __name__ == "__main__":
    main()
