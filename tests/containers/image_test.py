"""The images as they are run: hardened, stopped by SIGTERM, started again on the same data."""

import json
import os
import socket
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import grpc

TREE = Path(__file__).resolve().parents[2]
CCST = os.path.abspath(os.path.join(os.environ.get("CCST_BIN", "build/release/bin"), "ccst"))
TAG = os.environ.get("CCST_TEST_TAG", "latest")
SERVER = f"localhost/ccst-server:{TAG}"
PROMETHEUS = f"localhost/ccst-prometheus:{TAG}"
LARGEST_SERVER_IMAGE = 150_000_000  # bytes
TIMEOUT_SECONDS = 120
HARDENED = [
    "--read-only", "--cap-drop=all", "--security-opt=no-new-privileges", "--memory=1g",
    "--pids-limit=512", "--network=host", "--no-healthcheck",
]
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def podman(*arguments, check=True):
    answer = subprocess.run(
        [TREE / "deploy/containers/run", "podman", *arguments],
        capture_output=True, text=True, timeout=TIMEOUT_SECONDS, check=False,
    )
    if check and answer.returncode != 0:
        raise AssertionError(f"podman {arguments}: {answer.stderr}")
    return answer


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Images(unittest.TestCase):
    def test_server_image_is_small(self):
        size = int(podman("image", "inspect", "--format", "{{.Size}}", SERVER).stdout)
        print(f"{SERVER}: {size / 1e6:.1f} MB")
        self.assertLess(size, LARGEST_SERVER_IMAGE)

    def test_server_image_says_how_to_ask_for_its_health(self):
        config = json.loads(podman("image", "inspect", SERVER).stdout)[0]
        self.assertEqual(config["Config"]["User"], "65532:65532")
        self.assertIn("--health", config["Healthcheck"]["Test"])

    def test_prometheus_image_holds_a_valid_configuration(self):
        answer = podman("run", "--rm", *HARDENED, PROMETHEUS, "promtool", "check", "config",
                        "/etc/prometheus/prometheus.yml")
        self.assertIn("rules found", answer.stdout)

    def test_both_programs_are_of_one_revision(self):
        versions = [
            podman("run", "--rm", *HARDENED, SERVER, program, "--version").stdout.split()[1:]
            for program in ("ccst", "ccst-server")
        ]
        self.assertEqual(versions[0], versions[1])
        self.assertNotIn("unknown", versions[0][1])


class Server(unittest.TestCase):
    """A container of the server, with a volume of its own."""

    def setUp(self):
        self.name = f"ccst-test-{os.getpid()}"
        self.volume = f"{self.name}-data"
        self.address = f"127.0.0.1:{free_port()}"
        podman("volume", "create", self.volume)
        self.addCleanup(podman, "volume", "rm", "--force", self.volume)
        self.addCleanup(podman, "rm", "--force", "--time=0", self.name)
        self.start()

    def start(self):
        podman("run", "--detach", f"--name={self.name}", *HARDENED,
               f"--volume={self.volume}:/var/lib/ccst", f"--env=CCST_LISTEN={self.address}",
               "--env=CCST_METRICS_LISTEN=127.0.0.1:0", SERVER)
        with grpc.insecure_channel(self.address) as channel:
            try:
                grpc.channel_ready_future(channel).result(TIMEOUT_SECONDS)
            except grpc.FutureTimeoutError:
                self.fail(podman("logs", self.name).stderr)

    def stop(self):
        """Sends SIGTERM; returns exit code and seconds."""
        begin = time.monotonic()
        podman("kill", "--signal=TERM", self.name)
        code = int(podman("wait", self.name).stdout)
        seconds = time.monotonic() - begin
        podman("rm", self.name)
        return code, seconds

    def jobs(self):
        """ListJobs, as the bytes on the wire: whether two answers are equal needs no more."""
        with grpc.insecure_channel(self.address) as channel:
            return channel.unary_unary("/ccst.v1.SamplingService/ListJobs")(
                b"", timeout=TIMEOUT_SECONDS)

    def sample(self, output):
        with tempfile.TemporaryDirectory() as folder:
            mesh, samples = Path(folder, "mesh.obj"), Path(folder, output)
            mesh.write_text(TETRAHEDRON)
            answer = subprocess.run(
                [CCST, "sample", mesh, "--count", "500", "--server", self.address, "-o", samples],
                capture_output=True, text=True, timeout=TIMEOUT_SECONDS, check=False,
                env={k: v for k, v in os.environ.items() if not k.startswith("CCST_")},
            )
            self.assertEqual(answer.returncode, 0, answer.stderr)
            return samples.read_text()

    def test_health_is_told_inside(self):
        healthy = podman("exec", self.name, "ccst-server", "--health", check=False)
        self.assertEqual(healthy.returncode, 0, healthy.stderr)
        elsewhere = podman("exec", "--env=CCST_LISTEN=127.0.0.1:1", self.name, "ccst-server",
                           "--health", check=False)
        self.assertEqual(elsewhere.returncode, 1)
        self.assertIn("no healthy server", elsewhere.stderr)

    def test_process_has_no_privileges(self):
        status = podman("exec", self.name, "cat", "/proc/1/status").stdout
        fields = dict(line.split(":\t", 1) for line in status.splitlines() if ":\t" in line)
        self.assertEqual(fields["Uid"].split(), ["65532"] * 4)
        self.assertEqual(int(fields["CapEff"], 16), 0)
        self.assertEqual(fields["NoNewPrivs"], "1")
        write = podman("exec", self.name, "touch", "/usr/local/bin/x", check=False)
        self.assertNotEqual(write.returncode, 0)

    def test_jobs_are_there_again_after_a_restart(self):
        lines = self.sample("samples.csv").splitlines()
        self.assertGreaterEqual(len(lines), 500)
        before = self.jobs()
        self.assertIn(b"jobs/", before)
        code, seconds = self.stop()
        print(f"SIGTERM to exit: {seconds:.2f} s")
        self.assertEqual(code, 0)
        self.assertLess(seconds, 10)
        self.start()
        self.assertEqual(self.jobs(), before)
        self.assertEqual(self.sample("samples.csv").splitlines(), lines)


if __name__ == "__main__":
    unittest.main()
