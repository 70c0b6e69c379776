"""The server as a process: its standard streams, signals, threads, addresses and settings."""

import fcntl
import os
import re
import resource
import signal
import socket
import stat
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import CCST, CCST_SERVER, TIMEOUT_SECONDS, EndToEnd, Server, environment, torus

TREE = Path(__file__).resolve().parents[2]
NOBODY = 65534
SMALL_PIPE_BYTES = 4096


def info(address):
    """One call with its line in the log; the exit code of ccst."""
    return subprocess.run([CCST, "info", "--server", address], capture_output=True,
                          timeout=TIMEOUT_SECONDS, env=environment()).returncode


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Process(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)
        self.data = os.path.join(self._folder.name, "data")

    def start(self, *flags, **options):
        """A server whose standard streams are up to `options`, as those of Popen."""
        listen = ("--listen", "127.0.0.1:0") if "--listen" not in flags else ()
        process = subprocess.Popen([CCST_SERVER, "--data-dir", self.data, *listen, *flags],
                                   env=environment(), **options)
        self.addCleanup(self._end, process)
        return process

    @staticmethod
    def _end(process):
        if process.poll() is None:
            process.kill()
        process.wait(TIMEOUT_SECONDS)
        for stream in (process.stdout, process.stderr):
            if stream is not None:
                stream.close()

    def refused(self, *flags, **options):
        """What a server that does not start says; its exit code must not be 0."""
        process = self.start(*flags, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                             **options)
        _, errors = process.communicate(timeout=TIMEOUT_SECONDS)
        self.assertGreater(process.returncode, 0, flags)
        return errors


class StandardStreams(Process):
    def serve_with_log_to(self, writing):
        process = self.start(stdout=subprocess.PIPE, stderr=writing, text=True)
        os.close(writing)
        return process, process.stdout.readline().split()[-1]

    def test_log_that_nobody_reads_stops_neither_calls_nor_the_drain(self):
        reading, writing = os.pipe()
        self.addCleanup(os.close, reading)
        fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, SMALL_PIPE_BYTES)
        process, address = self.serve_with_log_to(writing)
        # Twice what the pipe holds.
        self.assertEqual({info(address) for _ in range(60)}, {0})
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(TIMEOUT_SECONDS), 0)
        # What was read late is whole as far as it goes.
        lines = os.read(reading, SMALL_PIPE_BYTES).decode().splitlines()
        self.assertIn("listening on", lines[0])
        self.assertGreater(len(lines), 5)

    def test_reader_of_the_log_that_goes_away_does_not_end_the_server(self):
        reading, writing = os.pipe()
        process, address = self.serve_with_log_to(writing)
        os.close(reading)
        self.assertEqual({info(address) for _ in range(3)}, {0})
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(TIMEOUT_SECONDS), 0)

    def test_streams_that_are_closed_do_not_lead_into_the_database(self):
        address = f"127.0.0.1:{free_port()}"
        process = self.start("--listen", address, preexec_fn=lambda: os.closerange(0, 3))
        while info(address) != 0:  # It starts.
            self.assertIsNone(process.poll())
        for descriptor in range(3):
            self.assertEqual(os.readlink(f"/proc/{process.pid}/fd/{descriptor}"), "/dev/null")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(TIMEOUT_SECONDS), 0)

    def test_log_to_a_full_disk_does_not_stop_the_server(self):
        with open("/dev/full", "wb") as full:
            process = self.start(stdout=subprocess.PIPE, stderr=full, text=True)
        address = process.stdout.readline().split()[-1]
        self.assertEqual({info(address) for _ in range(3)}, {0})


class Signals(Process):
    def test_hangup_drains(self):
        server = Server()
        self.assertEqual(server.stop(signal.SIGHUP), 0)
        self.assertIn(" drained", server.log())

    def test_hangup_is_ignored_under_nohup(self):
        process = self.start(stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                             preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        address = process.stdout.readline().split()[-1]
        process.send_signal(signal.SIGHUP)
        self.assertEqual(info(address), 0)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(TIMEOUT_SECONDS), 0)


def nobody_may_run(program):
    """Whether every folder on the way to it lets others pass; "/" of a bare root may not."""
    path = os.path.dirname(os.path.abspath(program))
    while os.stat(path).st_mode & stat.S_IXOTH:
        if path == os.path.dirname(path):
            return True
        path = os.path.dirname(path)
    return False


class Threads(Process):
    @unittest.skipUnless(os.geteuid() != 0 or nobody_may_run(CCST_SERVER),
                         "limits do not hold for root, and nobody may run the server where it is")
    def test_too_few_threads_are_an_error_in_words(self):
        for limit in (1, 6, 20, 40):
            def few(limit=limit):
                # Limits of processes do not hold for root.
                if os.geteuid() == 0:
                    os.setgroups([])
                    os.setgid(NOBODY)
                    os.setuid(NOBODY)
                resource.setrlimit(resource.RLIMIT_NPROC, (limit, limit))
            errors = self.refused(preexec_fn=few)
            self.assertRegex(errors, r"may need \d+ threads, but the system lets it have \d+ more")
            self.assertIn("ulimit -u", errors)


class Memory(EndToEnd):
    def test_heaps_are_shared_by_threads(self):
        server = Server()
        self.addCleanup(server.stop)
        mesh = self.write("torus.obj", torus())
        for count in (300, 400, 500):
            self.ccst("sample", mesh, "--count", str(count), "--server", server.address)
        with open(f"/proc/{server.process.pid}/status", encoding="ascii") as status:
            figures = dict(line.split(":\t", 1) for line in status if ":\t" in line)
        megabytes = int(figures["VmSize"].split()[0]) / 1024
        stacks = 8 * int(figures["Threads"])
        heaps = 64 * max(2, os.cpu_count())
        self.assertLess(megabytes, 256 + stacks + heaps)


class Addresses(Process):
    def test_addresses_that_are_none_are_refused(self):
        for flag in ("--listen", "--metrics-listen"):
            for address in ("127.0.0.1:99999", "127.0.0.1:", "127.0.0.1:0,0.0.0.0:0", ":0", "*:0",
                            "0:0", "+0:0", "127.0.0.1:-1"):
                errors = self.refused(flag, address)
                self.assertIn(f"{flag} must be one HOST:PORT", errors)

    def test_loopback_in_six_is_served(self):
        server = Server(listen="[::1]:0")
        self.assertEqual(info(server.address), 0)
        self.assertEqual(server.stop(), 0)

    def test_health_uses_no_proxy_of_the_environment(self):
        server = Server()
        self.addCleanup(server.stop)
        proxies = {name: "http://127.0.0.1:1"
                   for name in ("http_proxy", "https_proxy", "grpc_proxy", "all_proxy")}
        answer = subprocess.run([CCST_SERVER, "--health", "--listen", server.address],
                                capture_output=True, text=True, timeout=TIMEOUT_SECONDS,
                                env=environment() | proxies)
        self.assertEqual(answer.returncode, 0, answer.stderr)


class ImageSettings(Process):
    """What deploy/Dockerfile sets, with what deploy/compose.yaml says beside it."""

    def settings(self):
        text = (TREE / "deploy/Dockerfile").read_text().replace("\\\n", " ")
        # The server's stage; the proxy's has variables of its own.
        (line,) = re.findall(r"^ENV (CCST_LISTEN=.*)$", text, flags=re.MULTILINE)
        return dict(word.split("=", 1) for word in line.split())

    def check(self, **settings):
        answer = subprocess.run([CCST_SERVER, "--check-config"], capture_output=True, text=True,
                                timeout=TIMEOUT_SECONDS,
                                env=environment() | self.settings() | settings)
        return answer.returncode, answer.stderr

    def test_insecure_is_enough(self):
        self.assertEqual(self.check(CCST_INSECURE="true", CCST_WITHOUT_PROXY="true"), (0, ""))

    def test_a_certificate_instead_is_enough(self):
        certificate, key = (os.path.join(self._folder.name, name) for name in ("cert", "key"))
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt",
                        "ec_paramgen_curve:P-256", "-nodes", "-subj", "/CN=localhost", "-days", "1",
                        "-keyout", key, "-out", certificate], check=True, capture_output=True)
        self.assertEqual(self.check(CCST_TLS_CERT=certificate, CCST_TLS_KEY=key,
                                    CCST_WITHOUT_PROXY="true"), (0, ""))

    def test_neither_is_refused(self):
        code, errors = self.check(CCST_WITHOUT_PROXY="true")
        self.assertEqual(code, 1)
        self.assertIn("--listen 0.0.0.0:50051", errors)


if __name__ == "__main__":
    unittest.main()
