"""Callers behind the proxies of deploy/haproxy: who they are, what they may, what passes."""

import os
import subprocess
import sys
import time

import grpc

import floods
from fronts import SKIPPED, Certificates, Front, connect, without_haproxy
from harness import (WHITE_NOISE, Client, Folder, Report, environment, job_pb2, program_named,
                     sampling_service_pb2, server_info_service_pb2)
import draco

FORGED_KEY = "x-ccst-client-certificate-bin"
# Longer than a proxy's buffer, and than what it lets pass before an answer.
LARGE_COUNT = 200_000


def der(certificates, name):
    return subprocess.run(["openssl", "x509", "-in", certificates.path(name + ".pem"), "-outform", "DER"],
                          check=True, capture_output=True).stdout


def make_job(channel, count=50, metadata=()):
    """A job on a mesh that is uploaded before; its name."""
    client = Client("", channel=channel)
    client.metadata = metadata
    mesh = client.upload(draco.encode(*draco.torus()))
    return client.create(job_pb2.JobSpec(
        mesh=mesh.name, options=job_pb2.SamplingOptions(sample_count=count, method=WHITE_NOISE))).name


def sees(channel, job, metadata=()):
    try:
        client = Client("", channel=channel)
        client.metadata = metadata
        return client.get(job).name == job
    except grpc.RpcError as error:
        if error.code() != grpc.StatusCode.NOT_FOUND:
            raise
        return False


def identities(report, folder, certificates):
    """The same holder is the same owner whoever ends TLS, and nobody can be another."""
    certificates.make("zoe", "/O=Caf\u00e9/CN=Zo\u00eb", "DNS:shared,DNS:one")
    certificates.make("zoe-renewed", "/O=Caf\u00e9/CN=Zo\u00eb", "DNS:one,DNS:shared")
    certificates.make("other", "/O=Caf\u00e9/CN=Zo\u00e9", "DNS:shared,DNS:one")
    certificates.make("nobody", "/")
    with Front("ends-tls", folder, certificates=certificates, client_ca=True) as front:
        job = make_job(front.channel("zoe"))
        report.check(sees(front.channel("zoe-renewed"), job), "a renewed certificate is the same owner")
        report.check(not sees(front.channel("other"), job), "a name that prints alike is another owner")
        forged = ((FORGED_KEY, der(certificates, "zoe")),)
        report.check(not sees(front.channel("other"), job, forged),
                     "what a caller says of its certificate does not count behind the proxy")
        with grpc.insecure_channel(front.server.address) as direct:
            client = Client("", channel=direct)
            client.metadata = forged
            client.call(client.info.GetServerInfo, server_info_service_pb2.GetServerInfoRequest())
            report.check("owner=127.0.0.1 " in front.server.log().splitlines()[-1],
                         "nor at the server's own port")
        try:
            sees(front.channel("nobody"), job)
            report.check(False, "a certificate of nobody is refused")
        except grpc.RpcError as error:
            report.check(error.code() == grpc.StatusCode.UNAUTHENTICATED,
                         f"a certificate of nobody is refused: {error.code().name}")
        try:
            sees(front.channel(), job)
            report.check(False, "without a certificate nobody gets through")
        except grpc.RpcError as error:
            report.check(error.code() == grpc.StatusCode.UNAVAILABLE,
                         f"without a certificate nobody gets through: {error.code().name}")
        front.stop()
    for kind in ("passes-tls", "tls"):
        with Front(kind, folder, certificates=certificates, client_ca=True) as front:
            report.check(sees(front.channel("zoe"), job) and not sees(front.channel("other"), job),
                         f"{kind}: the same owner as where the proxy ended TLS")
            front.stop()


def addresses(report, folder, certificates):
    """Callers without a name are known by their address, not by the proxy's."""
    for kind in ("ends-tls", "passes-tls", "ends-nothing"):
        with Front(kind, os.path.join(folder, kind), certificates=certificates) as front:
            client = Client("", channel=front.channel())
            client.call(client.info.GetServerInfo, server_info_service_pb2.GetServerInfoRequest())
            line = front.server.log().splitlines()[-1]
            report.check(" owner=127.0.0.1 " in line, f"{kind}: the log says from where the call came")


def bits(report, folder, certificates):
    """A large mesh goes in and large results come out as without any proxy."""
    mesh = os.path.join(folder, "mesh.obj")
    side = 300
    with open(mesh, "w", encoding="ascii") as file:
        for i in range(side):
            for j in range(side):
                file.write(f"v {i} {j} {(i * 7 + j * 3) % 11 / 10}\n")
        for i in range(side - 1):
            for j in range(side - 1):
                a, b, c, d = (i * side + j + 1, (i + 1) * side + j + 1, (i + 1) * side + j + 2,
                              i * side + j + 2)
                file.write(f"f {a} {b} {c}\nf {a} {c} {d}\n")
    results = {}
    for kind in ("bare", "ends-tls", "passes-tls", "ends-nothing"):
        with Front(kind, os.path.join(folder, kind), certificates=certificates) as front:
            output = os.path.join(folder, kind + ".ply")
            reach = ["--tls-ca", certificates.path("ca.pem")] if front.has_tls else []
            begin = time.monotonic()
            done = subprocess.run(
                [program_named("ccst"), "sample", mesh, "--count", str(LARGE_COUNT), "--method", "white",
                 "--server", front.address, "--progress", "none", "-o", output, *reach],
                capture_output=True, text=True, env=environment())
            report.check(done.returncode == 0, f"{kind}: ccst samples {done.stderr}")
            report.figure(f"{kind}: seconds of ccst sample", f"{time.monotonic() - begin:.2f}")
            with open(output, "rb") as file:
                results[kind] = file.read()
    report.check(len(set(results.values())) == 1, "the samples have the same bits on every way")


def quiet_streams(report, folder, certificates):
    """A stream that has nothing to say for longer than a caller may be silent goes on."""
    with Front("ends-tls", folder, "--max-running-jobs", "1", certificates=certificates,
               changes=(("timeout client 60s", "timeout client 1s"),)) as front:
        client = Client("", channel=front.channel())
        mesh = client.upload(draco.encode(*draco.torus()))
        endless = job_pb2.SamplingOptions(sample_count=100_000, max_iterations=10000,
                                          relative_tolerance=1e-300)
        runs = client.create(job_pb2.JobSpec(mesh=mesh.name, options=endless))
        waits = client.create(job_pb2.JobSpec(
            mesh=mesh.name, options=job_pb2.SamplingOptions(sample_count=10, method=WHITE_NOISE)))
        events = iter(client.watch(waits.name))
        next(events)
        time.sleep(4)
        client.cancel(runs.name)
        ended = [event for event in events if event.HasField("snapshot")]
        report.check(bool(ended) and ended[-1].snapshot.state == job_pb2.Job.STATE_SUCCEEDED,
                     "a watch that was quiet for four times as long as a caller may be goes on")


def limits(report, folder, certificates):
    """One address has so many connections and calls, and is told so."""
    with Front("ends-tls", folder, certificates=certificates,
               CCST_PROXY_CONNECTIONS_PER_ADDRESS="3", CCST_PROXY_CALLS_PER_10S="20") as front:
        held = [front.channel() for _ in range(3)]
        for channel in held:
            grpc.channel_ready_future(channel).result(20)
        try:
            sees(front.channel(), "jobs/x")
            report.check(False, "a fourth connection is refused")
        except grpc.RpcError as error:
            report.check(error.code() == grpc.StatusCode.UNAVAILABLE, "a fourth connection is refused")
        codes = set()
        client = Client("", channel=held[0])
        for _ in range(40):
            try:
                client.call(client.info.GetServerInfo,
                            server_info_service_pb2.GetServerInfoRequest())
            except grpc.RpcError as error:
                codes.add((error.code(), error.details()))
        report.check(codes == {(grpc.StatusCode.RESOURCE_EXHAUSTED, "too many calls over this connection")},
                     f"too many calls are refused in words: {codes}")


def methods(report, folder, certificates):
    """Only calls pass."""
    post, get, path = b"\x83", b"\x82", floods.field(b":path", b"/ccst.v1.ServerInfoService/GetServerInfo")
    of_grpc, of_text = (floods.field(b"content-type", kind) for kind in (b"application/grpc", b"text/plain"))
    with Front("ends-nothing", folder, certificates=certificates) as front:
        for name, method, kind in (("another method", get, of_grpc), ("another content", post, of_text)):
            block = method + b"\x86" + path + floods.field(b":authority", b"x") + kind
            with connect(front.address, False) as connection:
                connection.sendall(floods.PREFACE + floods.frame(floods.SETTINGS, 0, 0) + floods.frame(
                    floods.HEADERS, floods.END_HEADERS | floods.END_STREAM, 1, block))
                answer = b""
                while b"415" not in answer:
                    part = connection.recv(4096)
                    if not part:
                        break
                    answer += part
            report.check(b"415" in answer, f"{name} than that of a call is refused")
        report.check("GetServerInfo" not in front.server.log(), "and does not reach the server")


def main():
    why_not = without_haproxy()
    if why_not:
        print("SKIPPED: " + why_not)
        sys.exit(SKIPPED)
    report = Report()
    with Folder() as folder:
        certificates = Certificates(folder)
        for part in (identities, addresses, bits, quiet_streams, limits, methods):
            own = os.path.join(folder, part.__name__)
            os.makedirs(own)
            part(report, own, certificates)
    report.exit()


if __name__ == "__main__":
    main()
