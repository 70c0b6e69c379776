"""Every file format as a user meets it: what it carries, and what runs without a triangle give."""

import csv
import io
import json
import os
import struct

from harness import ENDLESS, EndToEnd, torus

MESH_FORMATS = ("obj", "ply", "stl", "off", "glb", "drc")


def linear(position):
    """Red, green, blue, s, t and heat: linear in space, so that interpolation reproduces them."""
    x, y, z = position
    return [0.5 + 0.3 * x, 0.5 + 0.3 * y, 0.5 + z, 0.5 - 0.3 * y, 0.5 + 0.3 * x, 20 + 5 * z]


def linear_torus():
    """An ascii PLY of a torus that carries linear()."""
    vertices, faces = [], []
    for line in torus().splitlines():
        kind, *rest = line.split()
        if kind == "v":
            vertices.append([float(x) for x in rest])
        else:
            faces.append([int(x) - 1 for x in rest])
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}"]
    lines += [f"property double {axis}" for axis in "xyz"]
    lines += [f"property float {name}" for name in ("red", "green", "blue", "s", "t", "heat")]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(repr(x) for x in [*vertex, *linear(vertex)]) for vertex in vertices]
    lines += ["3 " + " ".join(map(str, face)) for face in faces]
    return "\n".join(lines) + "\n"


def separate_triangles(count):
    """An OBJ of coloured triangles that do not touch."""
    lines = []
    for i in range(count):
        lines += [f"v {2 * i + x} {y} 0 0.25 0.5 1" for x, y in ((0, 0), (1, 0), (0, 1))]
    lines += [f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}" for i in range(count)]
    return "\n".join(lines) + "\n"


class Formats(EndToEnd):
    def sample(self, *arguments, **keywords):
        return self.ccst("sample", *arguments, "--local", "--progress", "none", **keywords)

    def succeed(self, *arguments, **keywords):
        result = self.sample(*arguments, **keywords)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result

    def test_sample_meshes_carry_what_the_mesh_carried(self):
        mesh = self.write("a.ply", linear_torus())
        colors, texture, heat = ["red", "green", "blue"], ["s", "t"], ["heat"]
        for extension, names, tolerance in (
            ("ply", colors + texture + heat, 0.5 / 255),  # Colours in bytes.
            ("glb", colors + texture + heat, 0),
            ("drc", colors + texture + heat, 0),
            ("obj", colors + texture, 0),
            ("off", [], 0),
            ("stl", [], 0),
        ):
            self.succeed(mesh, "-n", "300", "--mesh-output", f"m.{extension}")
            self.succeed(f"m.{extension}", "-n", "60", "-o", "s.csv")
            rows = list(csv.DictReader(io.StringIO(self.read("s.csv").decode())))
            self.assertEqual(len(rows), 60)
            self.assertEqual(list(rows[0])[9:], names, extension)
            for row in rows:
                expected = linear(float(row[axis]) for axis in "xyz")
                for name, value in zip(colors + texture + heat, expected):
                    if name in names:
                        self.assertAlmostEqual(float(row[name]), value, delta=tolerance + 1e-5)

    def test_samples_carry_what_the_mesh_carried(self):
        mesh = self.write("a.ply", linear_torus())
        for extension in ("obj", "drc", "xyz"):
            self.succeed(mesh, "-n", "90", "-o", f"s.{extension}")
        lines = [line.split() for line in self.read("s.obj").decode().splitlines()]
        points = [[float(x) for x in rest] for kind, *rest in lines if kind == "v"]
        texture = [[float(x) for x in rest] for kind, *rest in lines if kind == "vt"]
        self.assertEqual((len(points), len(texture)), (90, 90))
        for point, uv in zip(points, texture):
            for value, expected in zip([*point[3:], *uv], linear(point[:3])):
                self.assertAlmostEqual(value, expected, delta=1e-6)
        self.assertIn(b"heat", self.read("s.drc"))
        self.assertEqual([[float(x) for x in line.split()] for line in self.read("s.xyz").splitlines()],
                         [point[:3] for point in points])  # fmt: skip

    def test_runs_without_triangles_give_points(self):
        mesh = self.write("a.obj", separate_triangles(6))
        for extension in MESH_FORMATS:
            self.succeed(mesh, "-n", "6", "--mesh-output", f"m.{extension}", "-o", "s.csv")
        self.assertEqual(self.read("m.obj").count(b"v "), 6)
        self.assertIn(b"element vertex 6\n", self.read("m.ply"))
        self.assertTrue(self.read("m.off").startswith(b"OFF\n6 0 0\n"))
        self.assertEqual(struct.unpack_from("<I", self.read("m.stl"), 80), (0,))
        self.assertEqual(self.read("m.drc")[7], 0)  # A point cloud.
        glb = self.read("m.glb")
        document = json.loads(glb[20 : 20 + struct.unpack_from("<I", glb, 12)[0]])
        (primitive,) = document["meshes"][0]["primitives"]
        self.assertEqual(primitive["mode"], 0)
        for accessor in primitive["attributes"].values():
            self.assertEqual(document["accessors"][accessor]["count"], 6)
        self.assertIn("COLOR_0", primitive["attributes"])

    def test_methods_without_a_mesh_are_refused_before_they_run(self):
        mesh = self.write("a.obj", torus())
        for method in ("white", "poisson", "elimination", "lloyd", "ccvt"):
            result = self.sample(mesh, *ENDLESS, "--method", method, "--mesh-output", "m.glb")
            self.assertEqual(result.returncode, 1, method)
            self.assertIn("--method ccst", result.stderr)
            self.assertIn("-o", result.stderr)
        self.assertEqual(os.listdir(self.folder), ["a.obj"])

    def test_every_mesh_format_comes_through_standard_input(self):
        mesh = self.write("a.ply", linear_torus())
        for extension in MESH_FORMATS:
            self.succeed(mesh, "-n", "100", "--mesh-output", f"m.{extension}")
            result = self.succeed("-", "-n", "50", "-o", "-", stdin=self.read(f"m.{extension}"))
            self.succeed(f"m.{extension}", "-n", "50", "-o", "s.csv")
            self.assertTrue(result.stdout == self.read("s.csv"), extension)
        off = b"# by hand\nCOFF\n4 4 0\n0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 0 0 1\n0 0 1 1 1 1\n" \
              b"3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"  # fmt: skip
        result = self.succeed("-", "-n", "20", "-o", "-", stdin=off)
        self.assertIn(b"red,green,blue\n", result.stdout)

    def test_quantisation_says_what_it_cost(self):
        mesh = self.write("a.obj", torus())
        sizes = []
        for bits in ("8", "24"):
            result = self.ccst("sample", mesh, "-n", "50", "--local", "--progress", "lines",
                               "--quantization-bits", bits)  # fmt: skip
            self.assertEqual(result.returncode, 0, result.stderr)
            words = result.stderr.splitlines()[0].split()
            self.assertEqual(words[:4], ["quantised", "to", bits, "bits:"])
            sizes.append(int(words[4]))
            # Half a cell of the longest side, which is 2.7, in each direction at most.
            self.assertLess(0, float(words[-1]))
            self.assertLess(float(words[-1]), 0.5 * 3**0.5 * 2.7 / (2 ** int(bits) - 1) + 1e-6)
        self.assertLess(sizes[0], sizes[1])
        result = self.sample(mesh, "-n", "50", "--quantization-bits", "25")
        self.assertEqual(result.returncode, 1)
        self.assertIn("24", result.stderr)
