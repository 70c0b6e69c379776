"""A quick run of all scripts on a mesh made by code, and what must come out of it."""

import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import numpy as np  # noqa: E402

import developable  # noqa: E402
from harness import ROOT  # noqa: E402


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="ccst-paper-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        done = subprocess.run(
            [sys.executable, HERE / "page.py", "--quick", "--output", cls.folder],
            capture_output=True, text=True, cwd=ROOT,
        )
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        cls.page = (cls.folder / "index.html").read_text()

    def test_every_image_of_the_page_is_beside_it(self):
        images = re.findall(r'<img src="([^"]+)"', self.page)
        self.assertGreaterEqual(len(images), 10)
        for image in images:
            self.assertGreater((self.folder / image).stat().st_size, 1000, image)

    def test_every_figure_has_a_section(self):
        for name in ["figure-2", "figure-3", "figure-4", "figure-5", "figure-6", "figure-7",
                     "figure-8", "section-5-6", "energies", "crust", "crust-converged"]:
            self.assertIn(f'id="{name}"', self.page)
        self.assertNotIn("skipped", self.page)

    def test_what_the_command_sampled_is_there(self):
        summary = json.loads((self.folder / "work/evolution-command.json").read_text())
        self.assertEqual(summary["count"], 400)


class Periodogram(unittest.TestCase):
    def test_white_noise_has_power_one_at_every_frequency(self):
        points = [np.random.default_rng(s).random((500, 2)) for s in range(40)]
        _, power, anisotropy = developable.radial_figures(
            [developable.periodogram(p, 20) for p in points], 20)
        self.assertAlmostEqual(power.mean(), 1.0, delta=0.05)
        # Periodograms of white noise are exponentially distributed; 40 are averaged.
        self.assertAlmostEqual(anisotropy[5:].mean(), -10 * math.log10(40), delta=1.0)

    def test_lattice_has_its_power_in_its_own_frequency(self):
        side = (np.arange(10) + 0.5) / 10
        points = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
        power = developable.periodogram(points, 10)
        self.assertAlmostEqual(power[10, 20], 100.0)
        self.assertAlmostEqual(power[10, 15], 0.0)


class Unrolling(unittest.TestCase):
    def test_keeps_distances_along_the_surface(self):
        import shapes

        vertices, _ = shapes.cone(0.2, 2.0)
        p = np.array(vertices)
        slant = np.linalg.norm(p, axis=1)
        # Circles around the axis unroll to arcs of the same length: half a turn of the slant.
        circle = p[np.isclose(slant, 2.0)]
        steps = np.linalg.norm(np.diff(circle, axis=0), axis=1)
        self.assertAlmostEqual(steps.sum() * 720 / 719, developable.HALF_RING * 2.0, places=3)


if __name__ == "__main__":
    unittest.main()
