"""`ccst analyze` and `ccst compare`: figures of any samples, and the page as a browser shows it."""

import html.parser
import json
import os
import pathlib
import shutil
import struct
import subprocess
import unittest
import zlib

from harness import TIMEOUT_SECONDS, EndToEnd, torus

COUNT = "1000"
CHROMIUM = shutil.which("chromium")
# Without a network: no name is found.
BROWSER_FLAGS = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                 "--disable-background-networking", "--disable-component-update", "--disable-sync",
                 "--host-resolver-rules=MAP * ~NOTFOUND", "--window-size=1280,2400",
                 "--virtual-time-budget=20000")


def png_colours(data):
    """How many pixels a PNG of 8-bit RGB or RGBA has of each colour."""
    assert data.startswith(b"\x89PNG")
    width, height, _, kind = struct.unpack(">IIBB", data[16:26])
    channels = {2: 3, 6: 4}[kind]
    packed, at = b"", 8
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at:at + 8])
        if name == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += size + 12
    raw = zlib.decompress(packed)
    stride = width * channels
    above, colours = bytearray(stride), {}
    for y in range(height):
        begin = y * (stride + 1)
        kind, row = raw[begin], bytearray(raw[begin + 1:begin + 1 + stride])
        for i in range(stride):
            left = row[i - channels] if i >= channels else 0
            corner = above[i - channels] if i >= channels else 0
            up = above[i]
            if kind == 1:
                row[i] = (row[i] + left) & 255
            elif kind == 2:
                row[i] = (row[i] + up) & 255
            elif kind == 3:
                row[i] = (row[i] + (left + up) // 2) & 255
            elif kind == 4:
                near = min((abs(up - corner), 0, left), (abs(left - corner), 1, up),
                           (abs(left + up - 2 * corner), 2, corner))
                row[i] = (row[i] + near[2]) & 255
        above = row
        for i in range(0, stride, channels):
            colour = tuple(row[i:i + 3])
            colours[colour] = colours.get(colour, 0) + 1
    return colours


class Text(html.parser.HTMLParser):
    """Counts elements and keeps attributes of the body."""

    def __init__(self, page):
        super().__init__()
        self.count, self.body, self.best = {}, {}, 0
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.count[tag] = self.count.get(tag, 0) + 1
        self.best += ("class", "best") in attrs
        if tag == "body":
            self.body = dict(attrs)


class Analyze(EndToEnd):
    def setUp(self):
        super().setUp()
        self.mesh = self.path("torus.obj")
        pathlib.Path(self.mesh).write_text(torus())

    def sample(self, name, *flags):
        path = self.path(name)
        out = "--mesh-output" if name.startswith("mesh") else "-o"
        self.run_ccst("sample", self.mesh, "--count", COUNT, "--local", out, path, *flags)
        return path

    def run_ccst(self, *arguments):
        result = self.ccst(*arguments)
        self.assertEqual(result.returncode, 0, result.stderr)

    def figures(self, *arguments):
        out = self.path("figures.json")
        self.run_ccst(*arguments, "--json", out)
        return json.loads(pathlib.Path(out).read_text())

    def test_a_sample_mesh_gives_every_key(self):
        one = self.figures("analyze", self.sample("mesh.ply"), "--surface", self.mesh)
        self.assertEqual(one["count"], int(COUNT))
        for key in ("relative_radius", "relative_radius_same_side", "mean_nearest_distance",
                    "capacity_cv", "valence_5_7", "hausdorff", "rms", "effective_nyquist",
                    "oscillation", "density_fidelity"):
            self.assertIsInstance(one[key], (int, float), key)
        for key in ("min", "mean", "share_below_30", "share_above_90"):
            self.assertIsInstance(one["angles"][key], (int, float), key)
        for key in ("radial_mean", "anisotropy", "power_spectrum"):
            self.assertEqual(len(one[key]["x"]), len(one[key]["y"]), key)
            self.assertEqual(one[key]["x"], sorted(one[key]["x"]), key)
        self.assertGreater(one["relative_radius_same_side"], 0.6)
        self.assertLess(one["capacity_cv"], 0.05)
        low = [y for x, y in zip(one["power_spectrum"]["x"], one["power_spectrum"]["y"]) if x < 0.4]
        self.assertLess(max(low), 0.05)

    def test_points_of_other_programs_are_measured_alike(self):
        ply = self.figures("analyze", self.sample("samples.ply"), "--surface", self.mesh)
        xyz = self.figures("analyze", self.sample("samples.xyz"), "--surface", self.mesh)
        csv = self.figures("analyze", self.sample("samples.csv"), "--surface", self.mesh)
        for other in (xyz, csv):
            self.assertEqual({**ply, "name": ""}, {**other, "name": ""})
        self.assertIsNone(ply["capacity_cv"])
        self.assertIsNone(ply["angles"])

    def test_points_without_a_surface_are_counted(self):
        one = self.figures("analyze", self.sample("samples.xyz"))
        self.assertEqual(one["count"], int(COUNT))
        self.assertIsNone(one["relative_radius"])
        self.assertIsNone(one["radial_mean"])

    def test_a_broken_file_is_refused_with_its_line(self):
        broken = self.path("broken.xyz")
        pathlib.Path(broken).write_text("0 0 0\n1 2\n")
        result = self.ccst("analyze", broken, "--surface", self.mesh)
        self.assertEqual(result.returncode, 2)
        self.assertIn("broken.xyz: line 2", result.stderr)

    def test_seeds_of_one_set_are_averaged(self):
        files = [self.sample(f"s{seed}.xyz", "--seed", str(seed)) for seed in (1, 2)]
        both = self.figures("compare", "both=" + ",".join(files), files[0], "--surface", self.mesh)
        self.assertEqual([row["name"] for row in both], ["both", "s1.xyz"])
        self.assertEqual([row["sets"] for row in both], [2, 1])

    @unittest.skipIf(CHROMIUM is None, "chromium is not installed")
    def test_the_page_shows_curves_pictures_and_the_best(self):
        ours = self.sample("mesh.ply")
        lloyd = self.sample("lloyd.ply", "--method", "lloyd")
        page = self.path("page.html")
        self.run_ccst("compare", f"CCST={ours}", f"<!--<script><b>Lloyd={lloyd}", "--surface", self.mesh,
                  "--html", page)
        self.assertNotIn("http", pathlib.Path(page).read_text().split("<script>")[0])
        url = pathlib.Path(page).as_uri()
        run = [CHROMIUM, *BROWSER_FLAGS, f"--user-data-dir={self.path('browser')}"]
        dom = subprocess.run([*run, "--dump-dom", url], capture_output=True, text=True, check=True,
                             timeout=TIMEOUT_SECONDS).stdout
        shown = Text(dom)
        self.assertEqual(shown.body.get("data-ready"), "true")
        self.assertEqual(shown.count["canvas"], 7)
        self.assertEqual(shown.count["img"], 2)
        self.assertNotIn("b", shown.count)
        self.assertGreaterEqual(shown.best, 6)
        picture = self.path("page.png")
        subprocess.run([*run, f"--screenshot={picture}", url], capture_output=True, check=True,
                       timeout=TIMEOUT_SECONDS)
        colours = png_colours(pathlib.Path(picture).read_bytes())
        # The curves of both sets, in their colours.
        self.assertGreater(colours.get((0x1F, 0x6F, 0xB4), 0), 300)
        self.assertGreater(colours.get((0xD9, 0x63, 0x2A), 0), 300)


if __name__ == "__main__":
    unittest.main()
