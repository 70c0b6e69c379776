"""What the scripts of the figures share: the programs, the models, pictures and the page's parts."""

import csv
import json
import os
import resource
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]


class Skipped(Exception):
    """A figure whose models are not there."""


@dataclass
class Figure:
    """One section of the page."""

    name: str
    title: str
    images: list = field(default_factory=list)  # Names of files beside the page.
    text: list = field(default_factory=list)  # Paragraphs.
    header: list = field(default_factory=list)  # Of the table.
    rows: list = field(default_factory=list)


class Bench:
    """Where things are and how much to do."""

    def __init__(self, output, quick):
        self.bin = Path(os.environ.get("CCST_BIN", ROOT / "build/release/bin"))
        self.meshes = Path(os.environ.get("CCST_MESHES", ROOT.parent / "shared/meshes"))
        self.output = Path(output)
        self.work = self.output / "work"
        self.work.mkdir(parents=True, exist_ok=True)
        self.quick = quick

    def model(self, name):
        """Path of a model; in a quick run that of a mesh made by code instead."""
        if self.quick:
            from shapes import blob, write_off

            return write_off(self.work / "blob.off", blob())
        path = self.meshes / name
        if not path.exists():
            raise Skipped(f"no model {name} in {self.meshes}: set CCST_MESHES to a folder with it")
        return path

    def count(self, wanted):
        """How many samples: few in a quick run."""
        return min(wanted, 400) if self.quick else wanted

    def run(self, program, *arguments):
        """Standard output and standard error of a program that must succeed."""
        command = [str(self.bin / program), *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stderr}")
        return done.stdout, done.stderr

    def sample(self, mesh, count, stem, *arguments, picture=False):
        """Samples `mesh` in the process; returns the summary, with "stem" to the files written
        (.csv, .obj for methods with a sample mesh, .png), "progress" and "cpu_seconds"."""
        stem = self.work / stem
        command = ["sample", mesh, "--count", count, "--local", "--threads", 1]
        command += ["--summary", f"{stem}.json", "-o", f"{stem}.csv", "--progress", "json"]
        if picture:
            command += ["--picture", f"{stem}.png"]
        if "--method" not in arguments:
            command += ["--mesh-output", f"{stem}.obj"]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        _, progress = self.run("ccst", *command, *arguments)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        summary = json.loads(Path(f"{stem}.json").read_text())
        summary["cpu_seconds"] = after.ru_utime - before.ru_utime
        summary["stem"] = stem
        summary["progress"] = [json.loads(x) for x in progress.splitlines() if x.startswith("{")]
        return summary

    def save(self, name, dpi=110):
        """Writes the current plot beside the page and closes it."""
        plt.savefig(self.output / name, dpi=dpi, bbox_inches="tight")
        plt.close("all")
        return name


def read_points(path):
    """n x 3 positions of a CSV of samples."""
    with open(path) as file:
        rows = csv.DictReader(file)
        return np.array([[float(row[k]) for k in "xyz"] for row in rows])


def panels(path):
    """The two halves of a picture of ccst, samples and sample mesh, without their white margins."""
    image = plt.imread(path)
    middle = image.shape[1] // 2
    return [_crop(image[:, :middle]), _crop(image[:, middle:])]


def _crop(image):
    drawn = (image[..., :3] < 0.995).any(axis=2)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    return image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def show(axes, image, title=""):
    axes.imshow(image, interpolation="lanczos")
    axes.set_axis_off()
    axes.set_title(title, fontsize=9)


def show_halves(over, under, picture, title=""):
    """The samples of a picture into one axes, the sample mesh into the other."""
    points, triangles = panels(picture)
    show(over, points, title)
    show(under, triangles)


def say(message):
    print(message, file=sys.stderr, flush=True)
