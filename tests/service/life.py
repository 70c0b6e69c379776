"""The whole life of a job through another implementation of gRPC: Python's."""

import hashlib
import struct
import uuid

import draco

from harness import (Client, Folder, Report, Server, arguments, digest, job_pb2, mesh_service_pb2,
                     sampling_service_pb2, server_info_service_pb2, spec)

COUNT = 500


def live(client, report):
    info = client.call(client.info.GetServerInfo, server_info_service_pb2.GetServerInfoRequest())
    report.check(info.limits.max_sample_count >= COUNT, f"info: version {info.server_version}")

    data = draco.encode(*draco.torus())
    missing = client.call(client.meshes.FindMissingMeshes,
                          mesh_service_pb2.FindMissingMeshesRequest(digests=[digest(data)]))
    report.check(len(missing.missing_digests) == 1, "the mesh is missing before")
    mesh = client.upload(data)
    report.check(mesh.name == "meshes/" + hashlib.sha256(data).hexdigest(), "its name is its digest")
    report.check((mesh.face_count, mesh.boundary_loop_count) == (576, 0), "its facts are right")

    job = client.create(spec(mesh.name, COUNT, 7), request_id=str(uuid.uuid4()),
                        display_name="life", labels={"kind": "test"})
    events = list(client.watch(job.name))
    reports = [e for e in events if e.HasField("progress")]
    end = events[-1].snapshot
    report.check(events[0].HasField("snapshot") and end.state == job_pb2.Job.STATE_SUCCEEDED,
                 "watched from the first snapshot to the last")
    report.check([e.sequence for e in reports] == list(range(1, len(reports) + 1)) and reports != [],
                 f"{len(reports)} reports in order")

    chunks = [r.samples for r in client.call(
        client.jobs.ReadSamples, sampling_service_pb2.ReadSamplesRequest(name=job.name))]
    faces = [i for c in chunks for i in c.face_indices]
    positions = [x for c in chunks for x in c.positions]
    report.check(len(faces) == COUNT and len(positions) == 3 * COUNT, f"exactly {COUNT} samples")
    weights = [w for c in chunks for w in c.barycentrics]
    report.check(far_off(data, faces, weights, positions) < 1e-5, "positions follow from the weights")
    triangles = [i for r in client.call(client.jobs.ReadSampleMesh, sampling_service_pb2.
                                        ReadSampleMeshRequest(name=job.name))
                 for i in r.sample_mesh.vertex_indices]
    # A torus: as many triangles as twice the vertices.
    report.check(len(triangles) == 6 * COUNT and set(triangles) == set(range(COUNT)),
                 "the sample mesh is that of a torus")
    figures = client.call(client.jobs.AnalyzeJob,
                          sampling_service_pb2.AnalyzeJobRequest(name=job.name))
    report.check(figures.relative_radius > 0.6 and figures.capacity_cv < 0.1,
                 f"analysis: radius {figures.relative_radius:.3f}, cv {figures.capacity_cv:.4f}")
    power = figures.power_spectrum
    high = [y for x, y in zip(power.x, power.y) if x > 4]
    report.check(high and abs(sum(high) / len(high) - 1) < 0.1 and max(figures.radial_mean.y) > 1.5,
                 f"curves: mean power of high frequencies {sum(high) / max(1, len(high)):.3f}")

    angles = figures.angle_histogram
    report.check(len(angles.x) == len(angles.y) > 0 and abs(sum(angles.y) - 1) < 1e-9,
                 f"angles: {len(angles.x)} bins hold all")

    listed = client.call(client.jobs.ListJobs, sampling_service_pb2.ListJobsRequest(
        labels={"kind": "test"}, mesh=mesh.name))
    report.check([j.name for j in listed.jobs] == [job.name], "listed by label and mesh")
    downloaded = b"".join(r.chunk.data for r in client.call(
        client.meshes.DownloadMesh, mesh_service_pb2.DownloadMeshRequest(name=mesh.name)))
    report.check(downloaded == data, "the mesh comes back as it was sent")
    client.call(client.jobs.DeleteJob, sampling_service_pb2.DeleteJobRequest(name=job.name))
    client.call(client.meshes.DeleteMesh, mesh_service_pb2.DeleteMeshRequest(name=mesh.name))
    empty = client.call(client.jobs.ListJobs, sampling_service_pb2.ListJobsRequest())
    held = client.call(client.meshes.ListMeshes, mesh_service_pb2.ListMeshesRequest())
    report.check(not empty.jobs and not held.meshes, "nothing is left")


def far_off(data, faces, weights, positions):
    """Largest distance of a coordinate from where face and weights say it is."""
    points, triangles = draco.torus()
    points = [struct.unpack("<3f", struct.pack("<3f", *p)) for p in points]
    assert draco.encode(points, triangles) == data
    worst = 0.0
    for i, face in enumerate(faces):
        a, b = weights[2 * i], weights[2 * i + 1]
        corners = [points[v] for v in triangles[face]]
        for k in range(3):
            expected = a * corners[0][k] + b * corners[1][k] + (1 - a - b) * corners[2][k]
            worst = max(worst, abs(expected - positions[3 * i + k]))
    return worst


def main():
    arguments(__doc__)
    report = Report()
    with Folder() as folder, Server(folder) as server, Client(server.address) as client:
        live(client, report)
        report.check(server.stop() == 0, "the server drains and exits with 0")
    report.exit()


if __name__ == "__main__":
    main()
