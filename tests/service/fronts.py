"""Ways to a server: by itself, with TLS, and behind the proxies of deploy/haproxy."""

import os
import shutil
import socket
import ssl
import subprocess
import tempfile
import time

import grpc

from harness import TIMEOUT_SECONDS, UNLIMITED, Server, environment

TREE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CONFIGURATIONS = os.path.join(TREE, "deploy", "haproxy")
FRONTS = ("bare", "tls", "ends-tls", "passes-tls", "ends-nothing")
SKIPPED = 77


def without_haproxy():
    """Why proxies cannot be tested here; empty when they can."""
    if shutil.which("haproxy", path=os.environ.get("PATH", "") + ":/usr/sbin"):
        return ""
    return "no haproxy; deploy/install-packages test installs it"


def openssl(*arguments):
    subprocess.run(["openssl", *arguments], check=True, capture_output=True, timeout=TIMEOUT_SECONDS)


class Certificates:
    """An authority, the server's certificate, and those of callers, in a folder."""

    def __init__(self, folder):
        self.folder = folder
        self._run("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes",
                  "-subj", "/CN=authority", "-days", "1", "-keyout", self.path("ca.key"),
                  "-out", self.path("ca.pem"))
        self.make("server", "/CN=localhost", "DNS:localhost,IP:127.0.0.1")
        with open(self.path("both.pem"), "w", encoding="ascii") as both:
            for name in ("server.pem", "server.key"):
                both.write(self.read(name).decode())

    def _run(self, *arguments):
        openssl(*arguments)

    def path(self, name):
        return os.path.join(self.folder, name)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def make(self, name, subject, alternatives=""):
        """A certificate `name`.pem with its key, for who is called so."""
        extensions = f"subjectAltName={alternatives}\n" if alternatives else "\n"
        with open(self.path(name + ".ext"), "w", encoding="utf-8") as file:
            file.write(extensions)
        self._run("req", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-utf8",
                  "-subj", subject, "-keyout", self.path(name + ".key"),
                  "-out", self.path(name + ".csr"))
        self._run("x509", "-req", "-in", self.path(name + ".csr"), "-CA", self.path("ca.pem"),
                  "-CAkey", self.path("ca.key"), "-CAcreateserial", "-days", "1",
                  "-extfile", self.path(name + ".ext"), "-out", self.path(name + ".pem"))
        return name

    def credentials(self, name=None):
        """For a channel; with the certificate `name`, or without any."""
        own = (self.read(name + ".key"), self.read(name + ".pem")) if name else (None, None)
        return grpc.ssl_channel_credentials(self.read("ca.pem"), *own)


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Proxy:
    """A real HAProxy with a configuration of deploy/haproxy, on a free port of loopback."""

    def __init__(self, name, server_socket, changes=(), **variables):
        """`changes`: pairs of texts to replace in the configuration, for tests that cannot wait."""
        with open(os.path.join(CONFIGURATIONS, name + ".cfg"), encoding="utf-8") as file:
            text = file.read()
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new)
        self._configuration = tempfile.NamedTemporaryFile("w", suffix=".cfg", encoding="utf-8")
        self._configuration.write(text)
        self._configuration.flush()
        self._log = tempfile.TemporaryFile()
        self.address = f"127.0.0.1:{free_port()}"
        settings = {"CCST_PROXY_LISTEN": self.address, "CCST_PROXY_SOCKET": server_socket, **variables}
        self.process = subprocess.Popen(
            ["haproxy", "-db", "-f", self._configuration.name], stdout=self._log, stderr=self._log,
            env={**environment(), "PATH": os.environ["PATH"] + ":/usr/sbin", **settings})
        self._wait()

    def _wait(self):
        host, port = self.address.split(":")
        end = time.monotonic() + TIMEOUT_SECONDS
        while time.monotonic() < end and self.process.poll() is None:
            try:
                socket.create_connection((host, int(port)), timeout=1).close()
                return
            except OSError:
                time.sleep(0.02)
        raise AssertionError("haproxy did not start: " + self.log())

    def log(self):
        self._log.seek(0)
        return self._log.read().decode(errors="replace")

    def stop(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait(TIMEOUT_SECONDS)
        self._configuration.close()


class Front:
    """A server and the way to it: one of FRONTS."""

    def __init__(self, kind, folder, *flags, certificates=None, client_ca=False, changes=(),
                 **variables):
        self.kind = kind
        self.certificates = certificates
        self.proxy = None
        if kind in ("tls", "passes-tls"):
            flags += ("--tls-cert", certificates.path("server.pem"),
                      "--tls-key", certificates.path("server.key"))
            if client_ca:
                flags += ("--tls-client-ca", certificates.path("ca.pem"))
        server_socket = os.path.join(folder, f"{kind}.sock")
        if kind not in ("bare", "tls"):
            flags += ("--proxy-socket", server_socket)
        self.server = Server(os.path.join(folder, "data"), *flags)
        if kind == "ends-tls":
            variables["CCST_PROXY_CERTIFICATE"] = certificates.path("both.pem")
            if client_ca:
                variables["CCST_PROXY_CLIENT_CA"] = certificates.path("ca.pem")
        if kind not in ("bare", "tls"):
            name = "passes-tls" if kind == "passes-tls" else "ends-tls"
            self.proxy = Proxy(name, server_socket, changes, **variables)
        self.address = self.proxy.address if self.proxy else self.server.address
        self.has_tls = kind in ("tls", "ends-tls", "passes-tls")

    def channel(self, name=None):
        """A connection of its own; with the certificate `name`."""
        if not self.has_tls:
            return grpc.insecure_channel(self.address, options=UNLIMITED)
        return grpc.secure_channel(self.address, self.certificates.credentials(name),
                                   options=UNLIMITED)

    def resident_bytes(self):
        """Of the server and of the proxy."""
        total = self.server.resident_bytes()
        if self.proxy:
            with open(f"/proc/{self.proxy.process.pid}/status", encoding="ascii") as status:
                total += next(int(line.split()[1]) for line in status if line.startswith("VmRSS:")) * 1024
        return total

    def alive(self):
        return self.server.alive() and (self.proxy is None or self.proxy.process.poll() is None)

    def stop(self):
        if self.proxy:
            self.proxy.stop()
        return self.server.stop()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.proxy:
            self.proxy.stop()
        self.server.kill()


def connect(address, with_tls, source="127.0.0.1"):
    """A connection from an address of loopback, over TLS for HTTP/2 if so, to whatever certificate."""
    host, port = address.rsplit(":", 1)
    plain = socket.create_connection((host, int(port)), timeout=5, source_address=(source, 0))
    if not with_tls:
        return plain
    context = ssl.create_default_context()
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    context.set_alpn_protocols(["h2"])
    return context.wrap_socket(plain)
