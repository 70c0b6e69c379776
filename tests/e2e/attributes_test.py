"""What meshes carry arrives at the samples: the same on both paths, interpolated over the host."""

import csv
import io
import struct

from client_test import Remote
from harness import torus

NUMBER = {"double": "d", "float": "f", "int": "i", "uchar": "B"}


def read_ply(data):
    """The rows of a binary PLY of points, as dictionaries."""
    header, body = data.split(b"end_header\n", 1)
    names, code = [], "<"
    for line in header.decode().splitlines():
        words = line.split()
        if words[0] == "property":
            code += NUMBER[words[1]]
            names.append(words[2])
    return [dict(zip(names, row)) for row in struct.iter_unpack(code, body)]


def at(row, values):
    """The barycentric interpolation of the values of the three corners of a row's host."""
    u, v = row["bary_u"], row["bary_v"]
    return [u * a + v * b + (1 - u - v) * c for a, b, c in zip(*values)]


class Attributes(Remote):
    def both(self, mesh, *flags):
        """PLY and CSV of a run on the server, once a local run has given the same bytes."""
        outputs = []
        for place in (["--server", self.server.address], ["--local"]):
            files = []
            for name in ("s.ply", "s.csv"):
                result = self.ccst("sample", mesh, "-n", "700", *flags, *place, "-o", name,
                                   "--progress", "none")  # fmt: skip
                self.assertEqual(result.returncode, 0, result.stderr)
                files.append(self.read(name))
            outputs.append(files)
        # Not assertEqual, which would spend minutes on what is different between two files.
        self.assertTrue(outputs[0] == outputs[1], "the server and a local run differ")
        return outputs[0]

    def coloured_torus(self):
        """An ascii PLY with colours and a scalar at the vertices, and these as lists."""
        vertices, faces = [], []
        for line in torus().splitlines():
            kind, *rest = line.split()
            if kind == "v":
                vertices.append([float(x) for x in rest])
            else:
                faces.append([int(x) - 1 for x in rest])
        colors = [[(37 * i) % 256, (91 * i) % 256, i % 256, 255 - i % 7] for i in range(len(vertices))]
        heat = [1000.5 * x - 3 * z for x, _, z in vertices]
        lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}"]
        lines += [f"property double {axis}" for axis in "xyz"]
        lines += [f"property uchar {c}" for c in ("red", "green", "blue", "alpha")]
        lines += ["property float heat", f"element face {len(faces)}"]
        lines += ["property list uchar int vertex_indices", "end_header"]
        for vertex, color, value in zip(vertices, colors, heat):
            lines.append(" ".join(repr(x) for x in [*vertex, *color, value]))
        lines += ["3 " + " ".join(map(str, face)) for face in faces]
        return "\n".join(lines) + "\n", faces, colors, heat

    def test_colours_and_scalars_of_a_ply(self):
        text, faces, colors, heat = self.coloured_torus()
        ply, table = self.both(self.write("a.ply", text))
        rows = read_ply(ply)
        self.assertEqual(len(rows), 700)
        numbers = list(csv.DictReader(io.StringIO(table.decode())))
        self.assertEqual(list(rows[0]), list(numbers[0]))
        used = set()
        for row, number in zip(rows, numbers):
            host = faces[row["face"]]
            used.update(host)
            for name, expected in zip(("red", "green", "blue", "alpha"), at(row, [colors[v] for v in host])):
                self.assertLessEqual(abs(row[name] - expected), 0.5001, name)
                self.assertAlmostEqual(float(number[name]), expected / 255, delta=1e-6)
            (expected,) = at(row, [[heat[v]] for v in host])
            self.assertAlmostEqual(row["heat"], expected, delta=1e-3)
            self.assertEqual(struct.pack("<f", float(number["heat"])), struct.pack("<f", row["heat"]))
        self.assertGreater(len(used), 500)

    def test_quantised_positions_keep_colours(self):
        text, faces, colors, _ = self.coloured_torus()
        ply, _ = self.both(self.write("a.ply", text), "--quantization-bits", "12")
        for row in read_ply(ply):
            expected = at(row, [colors[v] for v in faces[row["face"]]])
            self.assertLessEqual(abs(row["green"] - expected[1]), 0.5001)

    def test_texture_coordinates_of_an_obj_with_seams(self):
        # Each face has its own part of the image, so that every edge is a seam.
        lines, faces, corners = [], 0, []
        for line in torus().splitlines():
            if line.startswith("f"):
                base = 3 * faces
                uv = [(faces / 4096, 0.25), ((faces + 0.5) / 4096, 0.5), (faces / 4096, 0.75)]
                corners.append(uv)
                lines += [f"vt {u!r} {v!r}" for u, v in uv]
                line = "f " + " ".join(f"{v}/{base + k + 1}" for k, v in enumerate(line.split()[1:]))
                faces += 1
            lines.append(line)
        ply, _ = self.both(self.write("a.obj", "\n".join(lines) + "\n"))
        rows = read_ply(ply)
        self.assertEqual(len(rows), 700)
        for row in rows:
            s, t = at(row, corners[row["face"]])
            self.assertAlmostEqual(row["s"], s, delta=1e-6)
            self.assertAlmostEqual(row["t"], t, delta=1e-6)
