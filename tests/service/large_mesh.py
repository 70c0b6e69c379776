"""Uploads a mesh of 200 MiB with the command and samples it: no message may be too large for it."""

import array
import os
import random
import re
import subprocess
import tempfile
import time
from pathlib import Path

import draco

from harness import Folder, Report, Server, arguments, environment, program_named

AROUND, ACROSS = 1800, 1200  # Of the torus: 2.2 million vertices, 4.3 million faces.
ATTRIBUTES = 5  # Of four numbers: what brings the file to its size.
LEAST_BYTES = 200 * 2**20
COUNT = 5000


def main():
    arguments(__doc__)
    report = Report()
    with Folder() as folder, tempfile.TemporaryDirectory() as files, Server(folder) as server:
        mesh, samples = Path(files, "large.drc"), Path(files, "samples.csv")
        positions, faces = draco.torus(AROUND, ACROSS)
        # What does not compress, or little would be left of the size on its way. An odd length: no
        # two vertices have the same four numbers.
        rng = random.Random(1)
        noise = array.array("f", (rng.random() for _ in range(3 * 2**20 + 1)))
        count = 4 * len(positions)
        payload = (noise * (count // len(noise) + 1))[:count]
        attributes = {f"payload_{i}": payload for i in range(ATTRIBUTES)}
        mesh.write_bytes(draco.encode(positions, faces, **attributes))
        report.figure("mesh", f"{os.path.getsize(mesh) / 2**20:.0f} MiB, {len(faces)} faces")
        del positions, faces
        for command in (["upload", mesh], ["sample", mesh, "--count", str(COUNT), "-o", samples]):
            begin = time.monotonic()
            answer = subprocess.run(
                [program_named("ccst"), *command, "--server", server.address], env=environment(),
                capture_output=True, text=True, timeout=1200, check=False)
            report.figure(f"ccst {command[0]}", f"{time.monotonic() - begin:.1f} s")
            report.check(answer.returncode == 0, f"ccst {command[0]} succeeds {answer.stderr[-300:]}")
            if command[0] == "upload":
                sent = float(re.search(r"of ([0-9.]+) MiB", answer.stderr)[1])
                report.check(sent * 2**20 >= LEAST_BYTES, f"{sent} MiB are sent, at least 200")
        rows = samples.read_text().count("\n") - 1 if samples.exists() else 0
        report.check(rows == COUNT, f"{COUNT} samples are written (there are {rows})")
        report.figure("memory of the server", f"{server.resident_bytes() / 2**20:.0f} MiB at the end")
    report.exit()


if __name__ == "__main__":
    main()
