"""A full disk, a read-only one, damaged records, and connections that are cut.

The disk is a tmpfs of a few MiB; where mounting is not permitted that part is skipped, and says so.
"""

import os
import random
import socket
import subprocess
import sys
import threading

import draco
import grpc

from harness import (WHITE_NOISE, Client, Folder, Report, Server, StartError, arguments, job_pb2,
                     reason, sampling_service_pb2, spec)

SKIPPED = 77


class SmallDisk:
    """A tmpfs of its own; `path` is None where mounting is not permitted."""

    def __init__(self, folder, mebibytes):
        self._folder = folder
        self.path = None
        os.makedirs(folder, exist_ok=True)
        result = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={mebibytes}m", "tmpfs", folder],
                                capture_output=True, text=True)
        self.why = result.stderr.strip()
        if result.returncode == 0:
            self.path = folder

    def remount(self, option):
        subprocess.run(["mount", "-o", f"remount,{option}", self._folder], check=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.path:
            subprocess.run(["umount", self._folder], check=True)


class Proxy:
    """Passes bytes between callers and the server until it is told to cut them off."""

    def __init__(self, address):
        host, port = address.rsplit(":", 1)
        self._target = (host, int(port))
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self._open = []
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self):
        while True:
            try:
                near, _ = self._listener.accept()
            except OSError:
                return
            far = socket.create_connection(self._target)
            self._open += [near, far]
            for source, sink in ((near, far), (far, near)):
                threading.Thread(target=self._pass, args=(source, sink), daemon=True).start()

    @staticmethod
    def _pass(source, sink):
        try:
            while data := source.recv(65536):
                sink.sendall(data)
        except OSError:
            pass
        for end in (source, sink):
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def cut(self):
        """Ends every connection; new ones are taken."""
        ends, self._open = self._open, []
        for end in ends:
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def close(self):
        self._listener.close()
        self.cut()


def outcome(act):
    """OK, or code and reason of the failed call."""
    try:
        act()
        return "OK"
    except grpc.RpcError as error:
        return f"{error.code().name} {reason(error)}"


def full_disk(folder, report):
    rng = random.Random(3)
    with SmallDisk(folder + "/small", 6) as disk:
        if disk.path is None:
            print(f"SKIPPED: no tmpfs can be mounted here: {disk.why}")
            return False
        data, acknowledged, refusals = disk.path + "/data", {}, set()
        with Server(data) as server, Client(server.address) as client:
            mesh = client.upload(draco.encode(*draco.torus())).name
            for number in range(200):
                try:
                    # Their samples differ: each takes room.
                    job = client.create(spec(mesh, 5000, number, WHITE_NOISE),
                                        request_id=f"r{number}")
                    acknowledged[f"r{number}"] = job.name
                    end = client.wait(job.name)
                    if end.state == job_pb2.Job.STATE_FAILED:
                        refusals.add(end.error.message)
                except grpc.RpcError as error:
                    refusals.add(f"{error.code().name} {reason(error)}")
                    if reason(error) == "STORAGE_FULL" and len(refusals) > 1:
                        break
            big = draco.encode([tuple(rng.random() for _ in range(3)) for _ in range(60000)],
                               [(i, i + 1, i + 2) for i in range(59998)])
            upload = outcome(lambda: [client.upload(big + bytes(i)) for i in range(1, 9)])
            report.figure("jobs until the disk was full", len(acknowledged))
            report.figure("what callers were told", sorted(refusals))
            report.check(upload == "RESOURCE_EXHAUSTED STORAGE_FULL", f"an upload gets {upload}")
            report.check(server.alive() and client.load() is not None, "the server answers")
            samples = [outcome(lambda n=n: client.get(n)) for n in acknowledged.values()]
            report.check(set(samples) == {"OK"}, f"every acknowledged job is there {set(samples)}")
            disk.remount("size=64m")
            again = outcome(lambda: client.upload(big))
            report.check(again in ("OK", "FAILED_PRECONDITION MESH_NOT_MANIFOLD"),
                         f"with room an upload works again: {again}")
            after = client.wait(client.create(spec(mesh, 5000, 10_000, WHITE_NOISE)).name)
            report.check(after.state == job_pb2.Job.STATE_SUCCEEDED, "and so does a job")
            server.kill()
        with Server(data) as server, Client(server.address) as client:
            lost = [n for r, n in acknowledged.items() if client.create(
                spec(mesh, 5000, int(r[1:]), WHITE_NOISE), request_id=r).name != n]
            report.check(not lost, f"none of {len(acknowledged)} is lost after a kill {lost[:3]}")
            server.stop()
        read_only(disk, mesh, report)
    return True


def read_only(disk, mesh, report):
    """The disk is read-only when the server starts."""
    disk.remount("ro")
    try:
        with Server(disk.path + "/data") as other:
            report.check(False, "a start on a read-only disk is refused" + other.log()[-500:])
    except StartError as error:
        text = str(error).strip()
        report.check("ccst-server:" in text and "ead-only" in text,
                     f"a start on a read-only disk says why: {text[-200:]}")
    disk.remount("rw")
    with Server(disk.path + "/data") as other, Client(other.address) as again:
        job = again.wait(again.create(spec(mesh, 4000, 1, WHITE_NOISE)).name)
        report.check(job.state == job_pb2.Job.STATE_SUCCEEDED, "writable again, it works again")


def damaged(folder, report):
    """Bytes of the records and of a stored mesh are overwritten."""
    data = folder + "/damaged"
    stream = draco.encode(*draco.torus())
    with Server(data) as server, Client(server.address) as client:
        mesh = client.upload(stream).name
        for seed in range(50):
            client.wait(client.create(spec(mesh, 10, seed, WHITE_NOISE)).name)
        server.stop()
    blob = next(os.path.join(root, name) for root, _, names in os.walk(data + "/blobs")
                for name in names if name in mesh)
    overwrite(blob, 100, b"\xff" * 64)
    with Server(data) as server, Client(server.address) as client:
        try:
            client.create(spec(mesh, 20, 99))
            report.check(False, "a job on a damaged mesh is refused")
        except grpc.RpcError as error:
            report.check(reason(error) == "MESH_MISSING" and "damaged" in error.details(),
                         f"a job on a damaged mesh is refused and says why: {error.details()}")
        report.check(len(list(client.call(client.jobs.ListJobs, sampling_service_pb2.
                                          ListJobsRequest(page_size=100)).jobs)) == 50,
                     "the jobs that have ended are there")
        server.stop()
    records = data + "/records.sqlite"
    for offset in range(4096, os.path.getsize(records) - 4096, 4096):
        overwrite(records, offset, b"\x5a" * 512)
    size = os.path.getsize(records)
    try:
        with Server(data) as server:
            report.check(False, "damaged records are refused at the start" + server.log()[-500:])
    except StartError as error:
        text = str(error).strip()
        report.check("ccst-server:" in text and "records" in text,
                     f"damaged records are named at the start: {text[-200:]}")
    report.check(os.path.getsize(records) == size, "nothing was deleted")


def overwrite(path, offset, data):
    with open(path, "r+b") as file:
        file.seek(offset)
        file.write(data)


def cut_connections(folder, report):
    """Streams go on where they broke, without gap or repetition."""
    with Server(folder + "/cut") as server, Client(server.address) as direct:
        mesh = direct.upload(draco.encode(*draco.torus(48, 24))).name
        # Long enough that the stream is cut while the job runs, not when all of it has come.
        job = direct.create(spec(mesh, 100_000, 1, max_iterations=60, relative_tolerance=1e-300))
        proxy = Proxy(server.address)
        sequences, cuts, ended = [], 0, False
        while not ended and cuts < 200:
            with Client(proxy.address) as client:
                try:
                    for event in client.watch(job.name, after_sequence=max(sequences, default=0)):
                        if event.HasField("progress"):
                            sequences.append(event.sequence)
                            if len(sequences) % 3 == 0:
                                proxy.cut()
                        elif event.snapshot.state == job_pb2.Job.STATE_SUCCEEDED:
                            ended = True
                except grpc.RpcError as error:
                    cuts += error.code() == grpc.StatusCode.UNAVAILABLE
        whole = [e.sequence for e in direct.watch(job.name) if e.HasField("progress")]
        report.check(ended and cuts >= 3, f"the watch was cut {cuts} times and ended")
        report.check(sequences == whole == list(range(1, len(whole) + 1)),
                     f"{len(sequences)} of {len(whole)} reports, none twice")

        large = direct.create(spec(mesh, 200_000, 1, WHITE_NOISE)).name
        direct.wait(large)

        def faces(client, start):
            request = sampling_service_pb2.ReadSamplesRequest(name=large, start_index=start)
            for part in client.call(client.jobs.ReadSamples, request):
                assert part.samples.start_index == start
                start += len(part.samples.face_indices)
                yield from part.samples.face_indices
                yield None  # The end of a message.

        whole = [f for f in faces(direct, 0) if f is not None]
        got, cuts = [], 0
        while len(got) < len(whole) and cuts < 50:
            with Client(proxy.address) as client:
                try:
                    for face in faces(client, len(got)):
                        if face is None:
                            proxy.cut()
                        else:
                            got.append(face)
                except grpc.RpcError:
                    cuts += 1
        report.check(got == whole and cuts > 0, f"samples read across {cuts} cuts are the same")
        proxy.close()


def main():
    arguments(__doc__)
    report = Report()
    with Folder() as folder:
        damaged(folder, report)
        cut_connections(folder, report)
        had_disk = full_disk(folder, report)
    if not report.failures and not had_disk:
        sys.exit(SKIPPED)
    report.exit()


if __name__ == "__main__":
    main()
