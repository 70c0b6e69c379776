"""Sends a server what it should refuse, from a seed, and looks whether it is still well.

Each request must be answered in time, with OK or an error that proto/docs/errors.md describes; the
server must live, keep its memory bounded and serve an ordinary caller as before.
"""

import os
import random
import re
import threading
import time

import draco
import grpc

from harness import (CHUNK_BYTES, UNLIMITED, WHITE_NOISE, Client, Folder, Report, Server, arguments,
                     digest, header, mesh_pb2, mesh_service_pb2, options, reason,
                     sampling_service_pb2, server_info_service_pb2, spec)

ANSWER_SECONDS = 30
# What gRPC raises itself, without details: errors.md, "How a call ends".
TRANSPORT = {"CANCELLED", "RESOURCE_EXHAUSTED", "UNIMPLEMENTED"}
INTEGERS = (-2**63, -2**31, -1, 0, 1, 3, 4, 65, 2**20, 2**31 - 1, 2**32, 2**53, 2**63 - 1)
DOUBLES = (float("nan"), float("inf"), float("-inf"), -1.0, -0.0, 0.0, 5e-324, 1e-300, 1.0, 1e308)
NAMES = ("meshes/../../x", "meshes/", "jobs/..", "jobs/%2e%2e", "/etc/passwd", "meshes/" + "0" * 64,
         "meshes/" + "A" * 64, "jobs/00000000-0000-0000-0000-000000000000", "jobs/a\0b", "", "x" * 70000,
         "meshes/" + "0" * 63 + "/", "jobs/' OR 1=1 --", "meshes/\u202e\U0001f4a9", "jobs/\n\r")
RPCS = {name: (kind, path) for path, kind, names in (
    ("SamplingService", "us", ("Sample", "WatchJob", "ReadSamples", "ReadSampleMesh")),
    ("SamplingService", "uu", ("CreateJob", "GetJob", "ListJobs", "CancelJob", "AnalyzeJob",
                               "DeleteJob")),
    ("MeshService", "uu", ("FindMissingMeshes", "CreateMesh", "GetMesh", "ListMeshes",
                           "DeleteMesh")),
    ("MeshService", "us", ("DownloadMesh",)),
    ("MeshService", "su", ("UploadMesh",)),
    ("ServerInfoService", "uu", ("GetServerInfo",))) for name in names}
MODULES = (sampling_service_pb2, mesh_service_pb2, server_info_service_pb2)


def documented(path):
    """Reason -> codes, from the table of errors.md."""
    with open(path, encoding="utf-8") as file:
        rows = re.findall(r"^\| `([A-Z_]+)` \| ([A-Z_, ]+) \|", file.read(), re.MULTILINE)
    return {reason: codes.split(", ") for reason, codes in rows}


def fill(message, rng, depth=0):
    """Sets some fields of any message to values of chance, mostly bad ones."""
    for field in message.DESCRIPTOR.fields:
        if rng.random() < 0.4:
            continue
        for _ in range(rng.choice((1, 1, 2, 40)) if field.label == field.LABEL_REPEATED else 1):
            put(message, field, rng, depth)


def put(message, field, rng, depth):
    repeated = field.label == field.LABEL_REPEATED
    if field.message_type and field.message_type.GetOptions().map_entry:
        key = rng.choice(("", "k", "k" * 65, "k" * 10000, "\u00e9" * 64))
        getattr(message, field.name)[key + str(rng.randrange(99))] = rng.choice(NAMES)
    elif field.message_type:
        if depth < 4:
            target = getattr(message, field.name)
            child = target.add() if repeated else target
            child.SetInParent()
            fill(child, rng, depth + 1)
    else:
        value = scalar(field, rng)
        if repeated:
            getattr(message, field.name).append(value)
        else:
            setattr(message, field.name, value)


def scalar(field, rng):
    kind = field.cpp_type
    if kind in (field.CPPTYPE_DOUBLE, field.CPPTYPE_FLOAT):
        return rng.choice(DOUBLES)
    if kind == field.CPPTYPE_BOOL:
        return rng.random() < 0.5
    if kind == field.CPPTYPE_ENUM:
        return rng.choice((-1, 0, 1, 2, 3, 99, 2**31 - 1))
    if kind == field.CPPTYPE_STRING:
        return rng.choice(NAMES) if field.type == field.TYPE_STRING else rng.randbytes(
            rng.choice((0, 1, 100, 5000)))
    low, high = {field.CPPTYPE_INT32: (-2**31, 2**31 - 1), field.CPPTYPE_UINT32: (0, 2**32 - 1),
                 field.CPPTYPE_INT64: (-2**63, 2**63 - 1),
                 field.CPPTYPE_UINT64: (0, 2**64 - 1)}[kind]
    return min(max(rng.choice(INTEGERS), low), high)


class Hostile:
    """Makes requests of chance; `mesh` and `job` are real ones."""

    def __init__(self, mesh, job, stream):
        self.mesh, self.job, self.stream = mesh, job, stream

    def message(self, rpc, rng):
        """A message of the right type with wrong contents."""
        module = next(m for m in MODULES if hasattr(m, rpc + "Request"))
        message = getattr(module, rpc + "Request")()
        fill(message, rng)
        # Half of the time what the name is checked for is right, so that the rest is reached.
        if rng.random() < 0.5:
            fields = message.DESCRIPTOR.fields_by_name
            if "name" in fields:
                message.name = self.mesh if "Mesh" in rpc and rpc != "ReadSampleMesh" else self.job
            if rpc == "CreateJob":
                message.spec.mesh = self.mesh
                message.spec.options.sample_count = rng.choice((0, -1, 3, 4, 100, 2**40))
            if rpc == "Sample":
                message.mesh_name = self.mesh
        return message

    def serialized(self, rpc, rng):
        """Bytes of one message: wrong contents, a mutated message, or anything."""
        kind = rng.random()
        if kind < 0.1:
            return rng.randbytes(rng.choice((0, 1, 7, 100, 4000)))
        if kind < 0.35 and rpc in ("Sample", "CreateMesh", "UploadMesh"):
            return self.mesh_message(rpc, rng).SerializeToString()
        data = self.message(rpc, rng).SerializeToString()
        return draco.mutate(data, rng) if kind > 0.8 and len(data) > 1 else data

    def mesh_message(self, rpc, rng):
        """A mesh that is broken in itself, in an otherwise right request."""
        data = draco.mutate(self.stream, rng)
        if rng.random() < 0.2:
            positions, faces = draco.torus(6, 4)
            bad = rng.choice(DOUBLES)
            if rng.random() < 0.5:
                fits = abs(bad) < 1e38 or bad != bad
                weight = [rng.choice((1.0, bad)) if fits else bad for _ in positions]
                data = draco.encode(positions, faces, weight=weight)
            else:
                positions[0] = (float("nan"), 0.0, 0.0)
                data = draco.encode(positions, faces)
        if rpc == "CreateMesh":
            return mesh_service_pb2.CreateMeshRequest(header=header(data), data=data)
        if rpc == "UploadMesh":
            return mesh_service_pb2.UploadMeshRequest(header=header(data))
        request = sampling_service_pb2.SampleRequest(options=options(50, max_iterations=2))
        request.inline_mesh.format, request.inline_mesh.data = 1, data
        if rng.random() < 0.5:
            request.options.attribute.attribute_name = "weight"
        return request

    def upload(self, rng):
        """The messages of an upload: each part may be wrong, missing, or twice."""
        data = draco.mutate(self.stream, rng) if rng.random() < 0.5 else self.stream
        head = header(data)
        if rng.random() < 0.3:
            head = mesh_service_pb2.MeshUploadHeader(
                digest=mesh_pb2.Digest(sha256=rng.choice(NAMES), size_bytes=rng.choice(INTEGERS)),
                format=1)
        elif rng.random() < 0.3:
            head.digest.CopyFrom(digest(rng.randbytes(len(data))))
        elif rng.random() < 0.3:
            head.digest.size_bytes = max(-2**63, min(2**63 - 1, rng.choice(INTEGERS)))
        messages = [mesh_service_pb2.UploadMeshRequest(header=head)]
        step = rng.choice((1000, 4000, CHUNK_BYTES))
        for begin in range(0, len(data), step):
            messages.append(mesh_service_pb2.UploadMeshRequest(chunk=mesh_pb2.MeshChunk(
                offset_bytes=begin + rng.choice((0, 0, 0, 0, 1, -1, 2**62)),
                data=data[begin:begin + step])))
        if rng.random() < 0.4:
            rng.shuffle(messages)
        if rng.random() < 0.2:
            messages.append(messages[rng.randrange(len(messages))])
        result = [m.SerializeToString() for m in messages[: rng.randrange(len(messages) + 1)]]
        if rng.random() < 0.2:
            result.insert(rng.randrange(len(result) + 1), self.serialized("UploadMesh", rng))
        return result


class Judge:
    """Decides of every answer whether it is one that may be."""

    def __init__(self, reasons):
        self._reasons = reasons
        self._lock = threading.Lock()
        self.counts, self.wrong, self.slowest = {}, [], 0.0

    def _note(self, what, seconds):
        with self._lock:
            self.counts[what] = self.counts.get(what, 0) + 1
            self.slowest = max(self.slowest, seconds)

    def call(self, rpc, act):
        """Runs one call to its end."""
        begin = time.monotonic()
        try:
            act()
            what = "OK"
        except grpc.RpcError as error:
            code, why = error.code().name, reason(error)
            what = why or code
            fine = code in (self._reasons.get(why, ()) if why else TRANSPORT)
            if not fine or why == "INTERNAL":
                with self._lock:
                    self.wrong.append(f"{rpc}: {code} {why} {error.details()}"[:300])
        self._note(what, time.monotonic() - begin)


def attack(address, hostile, judge, seed, count):
    rng = random.Random(seed)
    channel = grpc.insecure_channel(address, options=UNLIMITED)
    for _ in range(count):
        rpc = rng.choice(list(RPCS))
        kind, service = RPCS[rpc]
        path = f"/ccst.v1.{service}/{rpc}"
        if kind == "su":
            messages = hostile.upload(rng)
            judge.call(rpc, lambda: channel.stream_unary(path)(iter(messages),
                                                               timeout=ANSWER_SECONDS))
            continue
        data = hostile.serialized(rpc, rng)
        if kind == "uu":
            judge.call(rpc, lambda: channel.unary_unary(path)(data, timeout=ANSWER_SECONDS))
        else:
            # A job may be made by chance that runs for long: it is left after its first words.
            def read(rng_limit=rng.choice((1, 5, 1000))):
                stream = channel.unary_stream(path)(data, timeout=ANSWER_SECONDS)
                for number, _ in enumerate(stream):
                    if number >= rng_limit or number >= 3 and rpc == "Sample":
                        stream.cancel()
                        return

            judge.call(rpc, read)
    channel.close()


def oversized(address, judge):
    """More than the transport takes, in one message."""
    with Client(address) as client:
        big = sampling_service_pb2.SampleRequest(options=options(4))
        big.inline_mesh.format, big.inline_mesh.data = 1, bytes(80 << 20)
        judge.call("Sample", lambda: list(client.call(client.jobs.Sample, big)))
        labels = sampling_service_pb2.CreateJobRequest(labels={str(i): "x" * 1000
                                                               for i in range(20000)})
        judge.call("CreateJob", lambda: client.call(client.jobs.CreateJob, labels))


class SlowLoris:
    """Uploads that begin and never go on."""

    def __init__(self, address, count, stream):
        self._stop = threading.Event()
        self._client = Client(address)

        def messages():
            yield mesh_service_pb2.UploadMeshRequest(header=header(stream + b"never sent"))
            self._stop.wait()

        self._calls = [self._client.meshes.UploadMesh.future(messages(), timeout=300)
                       for _ in range(count)]

    def end(self):
        for call in self._calls:
            call.cancel()
        self._stop.set()
        self._client.close()


def ordinary(client, mesh, repeats):
    """Median seconds of a small job from its request to its last sample."""
    seconds = []
    for seed in range(repeats):
        begin = time.perf_counter()
        request = sampling_service_pb2.SampleRequest(
            mesh_name=mesh, options=options(500, seed, max_iterations=10), skip_cache_lookup=True)
        samples = sum(len(e.samples.face_indices)
                      for e in client.call(client.jobs.Sample, request))
        assert samples == 500, samples
        seconds.append(time.perf_counter() - begin)
    return sorted(seconds)[repeats // 2]


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    args = arguments(__doc__, requests=1000, seed=1, callers=4, loris=20, memory_mib=1024,
                     errors=os.path.join(here, "..", "..", "proto", "docs", "errors.md"),
                     strict=False)
    report = Report()
    with Folder() as folder, Server(folder, "--max-job-duration", "5") as server, \
            Client(server.address) as client:
        stream = draco.encode(*draco.torus(), weight=[1.0] * 288)
        mesh = client.upload(stream).name
        job = client.wait(client.create(spec(mesh, 100, method=WHITE_NOISE)).name).name
        before = ordinary(client, mesh, 15)
        judge = Judge(documented(args.errors))
        loris = SlowLoris(server.address, args.loris, stream)
        hostile = Hostile(mesh, job, stream)
        threads = [threading.Thread(target=attack, args=(
            server.address, hostile, judge, args.seed * 1000 + i, args.requests // args.callers))
            for i in range(args.callers)]
        most = 0
        for thread in threads:
            thread.start()
        while any(thread.is_alive() for thread in threads) and server.alive():
            most = max(most, server.resident_bytes())
            threads[0].join(0.2)
        oversized(server.address, judge)
        if not report.check(server.alive(), "the server lives"):
            print(server.log()[-4000:])
            report.exit()
        report.figure("answers", ", ".join(f"{k} {v}" for k, v in sorted(judge.counts.items())))
        report.figure("slowest answer", f"{judge.slowest:.2f} s")
        report.check(not judge.wrong, f"each is OK or a documented error {judge.wrong[:5]}")
        report.threshold("most memory", most / 2**20, args.memory_mib, "MiB")
        loris.end()
        for listed in client.call(client.jobs.ListJobs, sampling_service_pb2.ListJobsRequest(
                page_size=1000, states=[1, 2])).jobs:
            client.cancel(listed.name)
        client.upload(stream)  # By chance it was deleted.
        after = ordinary(client, mesh, 15)
        report.figure("an ordinary job before, after", f"{1e3 * before:.1f}, {1e3 * after:.1f} ms")
        report.threshold("it got slower by a factor of", after / before, 2.0, "", args.strict)
    report.exit()


if __name__ == "__main__":
    main()
