"""What the end-to-end tests share: the real programs, a server on a free port, made-up meshes."""

import math
import os
import select
import shutil
import signal
import subprocess
import tempfile
import unittest

BIN = os.environ.get("CCST_BIN", os.path.join("build", "release", "bin"))
CCST = os.path.abspath(os.path.join(BIN, "ccst"))
CCST_SERVER = os.path.abspath(os.path.join(BIN, "ccst-server"))
TIMEOUT_SECONDS = 120


def environment():
    """The environment without settings of the user's."""
    return {k: v for k, v in os.environ.items() if not k.startswith("CCST_")}


class Server:
    """A real server on the loopback interface, on a free port unless told otherwise."""

    def __init__(self, *flags, listen="127.0.0.1:0"):
        self._log = tempfile.TemporaryFile()
        self._data = tempfile.TemporaryDirectory()
        if "--data-dir" not in flags:
            flags = (*flags, "--data-dir", self._data.name)
        self.process = subprocess.Popen(
            [CCST_SERVER, "--listen", listen, *flags],
            stdout=subprocess.PIPE,
            stderr=self._log,
            text=True,
            env=environment(),
        )
        line = self.process.stdout.readline()
        if not line.startswith("listening on "):
            self.stop()
            raise AssertionError(f"server did not start: {line!r} {self.log()}")
        self.address = line.removeprefix("listening on ").strip()

    def log(self):
        self._log.seek(0)
        return self._log.read().decode()

    def stop(self, signum=signal.SIGTERM):
        """Sends a signal and returns the exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signum)
        code = self.process.wait(TIMEOUT_SECONDS)
        self.process.stdout.close()
        return code

    def __del__(self):
        self._log.close()


def torus(around=48, across=24, large=1.0, small=0.35, quads=False, offset=(0.0, 0.0, 0.0)):
    """An OBJ of a torus around the z axis."""
    lines = []
    for i in range(around):
        a = 2 * math.pi * i / around
        for j in range(across):
            b = 2 * math.pi * j / across
            r = large + small * math.cos(b)
            p = (r * math.cos(a), r * math.sin(a), small * math.sin(b))
            lines.append("v " + " ".join(repr(x + o) for x, o in zip(p, offset)))

    def vertex(i, j):
        return (i % around) * across + j % across + 1

    for i in range(around):
        for j in range(across):
            a, b = vertex(i, j), vertex(i + 1, j)
            c, d = vertex(i + 1, j + 1), vertex(i, j + 1)
            if quads:
                lines.append(f"f {a} {b} {c} {d}")
            else:
                lines += [f"f {a} {b} {c}", f"f {a} {c} {d}"]
    return "\n".join(lines) + "\n"


# A run that never ends by itself within a test.
ENDLESS = ["--count", "200000", "--max-iterations", "10000", "--tolerance", "1e-300"]


class EndToEnd(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="ccst-e2e-")
        self.addCleanup(shutil.rmtree, self.folder)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, contents):
        mode = "wb" if isinstance(contents, bytes) else "w"
        with open(self.path(name), mode) as file:
            file.write(contents)
        return self.path(name)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def ccst(self, *arguments, stdin=b"", env=None):
        """Runs ccst to its end; the result has returncode, stdout and stderr (text)."""
        result = subprocess.run(
            [CCST, *arguments],
            input=stdin,
            capture_output=True,
            timeout=TIMEOUT_SECONDS,
            cwd=self.folder,
            env=environment() | (env or {}),
        )
        result.stderr = result.stderr.decode()
        self.assertGreaterEqual(result.returncode, 0, f"killed: {result.stderr}")
        return result

    def start(self, *arguments):
        """Starts ccst and waits until the first alternation shows."""
        process = subprocess.Popen(
            [CCST, *arguments, "--progress", "json"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            cwd=self.folder,
            env=environment(),
        )

        def end():
            if process.poll() is None:
                process.kill()
                process.wait()
            process.stderr.close()

        self.addCleanup(end)
        ready, _, _ = select.select([process.stderr], [], [], TIMEOUT_SECONDS)
        self.assertTrue(ready, "no progress")
        self.assertTrue(process.stderr.readline().startswith(b"{"))
        return process

    def finish(self, process):
        """Reads what is left and returns exit code and standard error."""
        _, errors = process.communicate(timeout=TIMEOUT_SECONDS)
        return process.returncode, errors.decode()
