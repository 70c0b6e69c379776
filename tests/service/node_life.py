"""Runs life.mjs against a server; its packages are installed below build/ the first time."""

import fcntl
import os
import shutil
import subprocess
import sys

import draco

from harness import TIMEOUT_SECONDS, Folder, Server, arguments

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
TOOLS = os.path.join(ROOT, "build", "service-tools")


def install():
    """What package-lock.json pins, from the npm registry, unless it is there already."""
    os.makedirs(TOOLS, exist_ok=True)
    stamp = os.path.join(TOOLS, ".installed")
    with open(os.path.join(HERE, "package-lock.json"), encoding="utf-8") as file:
        wanted = file.read()
    with open(os.path.join(TOOLS, ".lock"), "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # Builds may run side by side.
        if os.path.exists(stamp):
            with open(stamp, encoding="utf-8") as file:
                if file.read() == wanted:
                    return
        for name in ("package.json", "package-lock.json", ".npmrc"):
            shutil.copy(os.path.join(HERE, name), TOOLS)
        subprocess.run(["npm", "ci", "--prefix", TOOLS, "--ignore-scripts", "--no-audit",
                        "--no-fund", "--loglevel=error"], check=True)
        with open(stamp, "w", encoding="utf-8") as file:
            file.write(wanted)


def main():
    arguments(__doc__)
    install()
    with Folder() as folder, Server(folder + "/data") as server:
        mesh = folder + "/torus.drc"
        with open(mesh, "wb") as file:
            file.write(draco.encode(*draco.torus()))
        result = subprocess.run(
            ["node", os.path.join(HERE, "life.mjs"), server.address, os.path.join(ROOT, "proto"),
             mesh, os.path.join(TOOLS, "node_modules")], timeout=TIMEOUT_SECONDS)
        if result.returncode != 0:
            print(server.log()[-2000:])
    sys.exit(result.returncode)


if __name__ == "__main__":
    main()
