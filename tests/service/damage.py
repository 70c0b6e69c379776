"""Damaged files of meshes and results, while the server runs and before it starts: noticed by every call
that hands them out, healed by the right bytes, and in nobody's way.
"""

import os
import sqlite3

import draco
import grpc

from harness import (WHITE_NOISE, Client, Folder, Report, Server, arguments, digest, header, job_pb2,
                     mesh_service_pb2, reason, sampling_service_pb2, spec, upload_messages)

DAMAGED = "DATA_LOSS STORAGE_FAILED"


def outcome(act):
    """OK, or code and reason of the failed call."""
    try:
        act()
        return "OK"
    except grpc.RpcError as error:
        return f"{error.code().name} {reason(error)}"


class Blob:
    """The file of a blob, and what can happen to it."""

    def __init__(self, data, sha256):
        self.path = f"{data}/blobs/{sha256[:2]}/{sha256}"
        self.size = os.path.getsize(self.path)

    def flip(self, offset):
        with open(self.path, "r+b") as file:
            file.seek(offset)
            byte = file.read(1)[0]
            file.seek(offset)
            file.write(bytes([byte ^ 0x10]))

    def cut(self, size):
        os.truncate(self.path, size)

    def remove(self):
        os.unlink(self.path)

    def damages(self):
        """Each with its name; the file must be whole before each."""
        yield "a flipped bit", lambda: self.flip(self.size // 2)
        yield "a flipped last bit", lambda: self.flip(self.size - 1)
        yield "a flipped first bit", lambda: self.flip(0)
        yield "a cut end", lambda: self.cut(self.size - 1)
        yield "no bytes", lambda: self.cut(0)
        yield "no file", self.remove


def download(client, mesh, start=0):
    request = mesh_service_pb2.DownloadMeshRequest(name=mesh, start_offset_bytes=start)
    return b"".join(m.chunk.data for m in client.call(client.meshes.DownloadMesh, request))


def read(client, job, start=0):
    request = sampling_service_pb2.ReadSamplesRequest(name=job, start_index=start)
    return [m.samples for m in client.call(client.jobs.ReadSamples, request)]


def read_mesh(client, job):
    request = sampling_service_pb2.ReadSampleMeshRequest(name=job)
    return [m.sample_mesh for m in client.call(client.jobs.ReadSampleMesh, request)]


def meshes(data, report, restart):
    """Every call that hands out a mesh; then the ways to heal it."""
    stream = draco.encode(*draco.torus(60, 40))
    sha256 = digest(stream).sha256
    server = Server(data)
    client = Client(server.address)
    mesh = client.upload(stream).name
    blob = Blob(data, sha256)
    for name, damage in blob.damages():
        if restart:
            server.stop()
        damage()
        if restart:
            server = Server(data)
            client = Client(server.address)
        report.check(outcome(lambda: download(client, mesh)) == DAMAGED,
                     f"{name}: a download ends with {outcome(lambda: download(client, mesh))}")
        part = outcome(lambda: download(client, mesh, len(stream) - 10))
        report.check(part == DAMAGED, f"{name}: so does one of the last bytes alone: {part}")
        missing = client.call(client.meshes.FindMissingMeshes,
                              mesh_service_pb2.FindMissingMeshesRequest(digests=[digest(stream)]))
        report.check(len(missing.missing_digests) == 1, f"{name}: the mesh counts as missing")
        refused = outcome(lambda: client.create(spec(mesh, 100, 1, WHITE_NOISE),
                                                skip_cache_lookup=True))
        report.check(refused == "FAILED_PRECONDITION MESH_MISSING",
                     f"{name}: a job on it is told to upload: {refused}")
        answer = client.call(client.meshes.UploadMesh, upload_messages(stream))
        report.check(not answer.already_present, f"{name}: an upload is taken")
        report.check(download(client, mesh) == stream, f"{name}: after it all is well")
        end = client.wait(client.create(spec(mesh, 100, 1, WHITE_NOISE), skip_cache_lookup=True).name)
        report.check(end.state == job_pb2.Job.STATE_SUCCEEDED, f"{name}: and a job succeeds")
    blob.flip(10)
    answer = client.call(client.meshes.CreateMesh, mesh_service_pb2.CreateMeshRequest(
        header=header(stream), data=stream))
    report.check(not answer.already_present and download(client, mesh) == stream,
                 "a mesh inside CreateMesh heals it too")
    blob.flip(10)
    request = sampling_service_pb2.SampleRequest(options=spec(mesh, 90).options)
    request.inline_mesh.format, request.inline_mesh.data = 1, stream
    last = list(client.call(client.jobs.Sample, request))[-1]
    report.check(last.snapshot.state == job_pb2.Job.STATE_SUCCEEDED and
                 download(client, mesh) == stream, "and so does one inside Sample")
    server.stop()


def results(data, report):
    """Damaged samples are not handed out, answer nobody, and are computed again."""
    stream = draco.encode(*draco.torus(60, 40))
    with Server(data) as server, Client(server.address) as client:
        mesh = client.upload(stream).name
        asked = spec(mesh, 20000, 7, WHITE_NOISE)
        meshed = spec(mesh, 2000, 7)
        for what, request, reader in (("samples", asked, read), ("the sample mesh", meshed, read_mesh)):
            first = client.wait(client.create(request).name).name
            right = reader(client, first)
            blob = Blob(data, samples_blob(data, first))
            for name, damage in blob.damages():
                damage()
                told = outcome(lambda: reader(client, first))
                both = {told, outcome(lambda: (read(client, first), read_mesh(client, first)))}
                report.check(DAMAGED in both and told in ("OK", DAMAGED),
                             f"{what}, {name}: reading ends with {told}")
                if told == "OK":  # The damage is in the other part.
                    report.check(reader(client, first) == right, f"{what}, {name}: nothing wrong came")
                analysis = outcome(lambda: client.call(
                    client.jobs.AnalyzeJob, sampling_service_pb2.AnalyzeJobRequest(name=first)))
                report.check(analysis == DAMAGED, f"{what}, {name}: AnalyzeJob ends with {analysis}")
                again = client.create(request)
                report.check(not again.result_cached, f"{what}, {name}: an equal request is computed")
                end = client.wait(again.name)
                report.check(end.state == job_pb2.Job.STATE_SUCCEEDED and
                             reader(client, again.name) == right and reader(client, first) == right,
                             f"{what}, {name}: then both are right")
                report.check(client.create(request).result_cached,
                             f"{what}, {name}: and answer the next")
        large = read(client, first, 0)
        report.check(len(large) > 0, "what is whole is read")


def samples_blob(data, job):
    return one(data, "SELECT samples_sha256 FROM jobs WHERE id = ?", job.removeprefix("jobs/"))


def one(data, query, *values):
    with sqlite3.connect(data + "/records.sqlite") as records:
        return records.execute(query, values).fetchone()[0]


def rows(data, report):
    """Rows whose content is damaged, which the database's own check does not see."""
    stream = draco.encode(*draco.torus())
    other = draco.encode(*draco.torus(20, 10))
    with Server(data) as server, Client(server.address) as client:
        mesh, small = client.upload(stream).name, client.upload(other).name
        names = [client.wait(client.create(spec(mesh, 60, seed)).name).name for seed in range(7)]
        server.stop()
    changes = ["outcome = X'ff'", "definition = X'ff'", "display_name = 'other'",
               "samples_sha256 = 'x'", "end_time = 0"]
    with sqlite3.connect(data + "/records.sqlite") as records:
        for name, change in zip(names, changes):
            records.execute(f"UPDATE jobs SET {change} WHERE id = ?", (name.removeprefix("jobs/"),))
        records.execute("UPDATE histories SET history = X'00' WHERE sha256 = "
                        "(SELECT history_sha256 FROM jobs WHERE id = ?)",
                        (names[5].removeprefix("jobs/"),))
        records.execute("UPDATE meshes SET facts = X'ff' WHERE sha256 = ?",
                        (mesh.removeprefix("meshes/"),))
    with Server(data) as server, Client(server.address) as client:
        listed = {j.name: j for j in client.call(
            client.jobs.ListJobs, sampling_service_pb2.ListJobsRequest(page_size=100)).jobs}
        report.check(set(listed) == set(names), "all jobs are listed, the damaged ones too")
        for name, change in zip(names, changes):
            job = listed[name]
            report.check(job.state == job_pb2.Job.STATE_FAILED and
                         job.error.code == grpc.StatusCode.DATA_LOSS.value[0],
                         f"{change}: listed as damaged: {job.error.message}")
            got = outcome(lambda n=name: client.get(n))
            report.check(got == DAMAGED, f"{change}: GetJob says {got}")
        for name in names[5:]:
            report.check(listed[name].state == job_pb2.Job.STATE_SUCCEEDED and
                         outcome(lambda n=name: read(client, n)) == "OK", "whole ones are as before")
        watched = outcome(lambda: list(client.watch(names[5])))
        report.check(watched == DAMAGED, f"a damaged history: WatchJob ends with {watched}")
        kept = client.call(client.meshes.ListMeshes, mesh_service_pb2.ListMeshesRequest()).meshes
        warned = [m.name for m in kept if any("damaged" in w for w in m.warnings)]
        report.check({m.name for m in kept} == {mesh, small} and warned == [mesh],
                     "all meshes are listed, the damaged one as such")
        healed = client.upload(stream)
        report.check(not healed.warnings and healed.face_count > 0, "an upload heals it")
        for seed, name in enumerate(names):
            again = client.create(spec(mesh, 60, seed))
            whole = seed == 6
            report.check(again.result_cached == whole, f"job {seed} answers an equal request: {whole}")
            client.wait(again.name)
        deleted = {outcome(lambda n=n: client.call(
            client.jobs.DeleteJob, sampling_service_pb2.DeleteJobRequest(name=n))) for n in names}
        report.check(deleted == {"OK"}, f"all can be deleted {deleted}")
        server.stop()


def main():
    arguments(__doc__)
    report = Report()
    with Folder() as folder:
        meshes(folder + "/running", report, restart=False)
        meshes(folder + "/stopped", report, restart=True)
        results(folder + "/results", report)
        rows(folder + "/rows", report)
    report.exit()


if __name__ == "__main__":
    main()
