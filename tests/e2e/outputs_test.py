"""Files of samples as the programs they are meant for read them, and places recovered from them."""

import csv
import io
import re
import struct
import xml.etree.ElementTree as ET
import zipfile

import numpy as np

from harness import EndToEnd, Server

# A concave heptagon that no fan covers, a bent quadrilateral and a triangle, apart from each other.
POLYGONS = """
v 0 1 0
v 2 1 0
v 2 0 0
v 4 2 0
v 2 4 0
v 2 3 0
v 0 3 0
v 10 0 0
v 11 0 1
v 11 1 0
v 10 1 0.5
v 20 0 0
v 21 0 0
v 20 1 0
f 1 2 3 4 5 6 7
f 8 9 10 11
f 12 13 14
"""

NUMPY_OF_PLY = {"double": "<f8", "float": "<f4", "int": "<i4", "uchar": "|u1"}
NUMPY_OF_VTK = {"Float64": "<f8", "Float32": "<f4", "Int32": "<i4", "Int64": "<i8", "UInt8": "|u1"}


def read_ply(data):
    header, _, body = data.partition(b"end_header\n")
    fields = re.findall(r"^property (\w+) (\S+)$", header.decode(), re.MULTILINE)
    return np.frombuffer(body, np.dtype([(name, NUMPY_OF_PLY[kind]) for kind, name in fields]))


def read_pcd(data):
    header, _, body = data.partition(b"DATA binary\n")
    lines = dict(line.split(" ", 1) for line in header.decode().splitlines()[1:])
    kinds = zip(lines["FIELDS"].split(), lines["TYPE"].split(), lines["SIZE"].split())
    rows = np.frombuffer(body, np.dtype([(name, f"<{kind.lower()}{size}")
                                         for name, kind, size in kinds]))
    assert len(rows) == int(lines["POINTS"]) == int(lines["WIDTH"])
    return rows


def read_vtp(data):
    """The arrays by name, and the numbers of the piece."""
    text, _, rest = data.partition(b"<AppendedData encoding=\"raw\">\n_")
    tree = ET.fromstring(text + b"</VTKFile>")
    arrays = {}
    for element in tree.iter("DataArray"):
        begin = int(element.get("offset"))
        size, = struct.unpack_from("<Q", rest, begin)
        values = np.frombuffer(rest[begin + 8:begin + 8 + size], NUMPY_OF_VTK[element.get("type")])
        width = int(element.get("NumberOfComponents"))
        arrays[element.get("Name")] = values if width == 1 else values.reshape(-1, width)
    return arrays, tree.find(".//Piece").attrib


class Outputs(EndToEnd):
    def sample(self, mesh, *arguments):
        result = self.ccst("sample", mesh, "--count", "300", "--progress", "none", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)

    def coloured(self):
        """Two triangles with colours, of different sizes."""
        return self.write("a.obj", "v 0 0 0 1 0 0\nv 4 0 0 0 1 0\nv 4 1 0 0 0 1\nv 0 1 0 0.5 0.5 0\n"
                                   "f 1 2 3\nf 1 3 4\n")

    def test_numpy_reads_the_columns_of_ply(self):
        mesh = self.coloured()
        for name in ("s.ply", "s.npy"):
            self.sample(mesh, "--local", "-o", name)
        rows = np.load(self.path("s.npy"))
        ply = read_ply(self.read("s.ply"))
        self.assertEqual(rows.dtype, ply.dtype)
        self.assertEqual(rows.tobytes(), ply.tobytes())
        self.assertIn("red", rows.dtype.names)

    def test_numpy_reads_every_array(self):
        mesh = self.coloured()
        for name in ("s.ply", "s.npz", "again.npz", "m.obj"):
            self.sample(mesh, "--local", "-o" if name != "m.obj" else "--mesh-output", name)
        ply = read_ply(self.read("s.ply"))
        arrays = np.load(self.path("s.npz"))
        self.assertEqual(arrays["positions"].shape, (300, 3))
        for k, name in enumerate("xyz"):
            np.testing.assert_array_equal(arrays["positions"][:, k], ply[name])
        for k, name in enumerate(("nx", "ny", "nz")):
            np.testing.assert_array_equal(arrays["normals"][:, k], ply[name])
        for k, name in enumerate(("bary_u", "bary_v")):
            np.testing.assert_array_equal(arrays["barycentrics"][:, k], ply[name])
        np.testing.assert_array_equal(arrays["faces"], ply["face"])
        np.testing.assert_array_equal(arrays["green"], ply["green"])
        corners = [[int(c.split("/")[0]) - 1 for c in line.split()[1:]]
                   for line in self.read("m.obj").decode().splitlines() if line.startswith("f ")]
        np.testing.assert_array_equal(arrays["triangles"], corners)
        self.assertEqual(self.read("s.npz"), self.read("again.npz"))
        self.assertIsNone(zipfile.ZipFile(self.path("s.npz")).testzip())

    def test_clouds_hold_what_ply_holds(self):
        mesh = self.coloured()
        for name in ("s.ply", "s.pcd"):
            self.sample(mesh, "--local", "-o", name)
        ply, pcd = read_ply(self.read("s.ply")), read_pcd(self.read("s.pcd"))
        for name in "xyz":
            np.testing.assert_array_equal(pcd[name], ply[name].astype("<f4"))
        np.testing.assert_array_equal(pcd["normal_z"], ply["nz"])
        np.testing.assert_array_equal(pcd["bary_v"], ply["bary_v"])
        packed = pcd["rgb"].view("<u4")
        np.testing.assert_array_equal(packed >> 16, ply["red"])
        np.testing.assert_array_equal(packed >> 8 & 255, ply["green"])
        np.testing.assert_array_equal(packed & 255, ply["blue"])

    def test_vtk_holds_samples_and_triangles(self):
        mesh = self.coloured()
        for name in ("s.npz", "s.vtp", "w.vtp"):
            self.sample(mesh, "--local", "-o", name, *(["--method", "white"] * (name == "w.vtp")))
        npz = np.load(self.path("s.npz"))
        arrays, piece = read_vtp(self.read("s.vtp"))
        self.assertEqual(piece["NumberOfPoints"], "300")
        self.assertEqual(int(piece["NumberOfPolys"]), len(npz["triangles"]))
        np.testing.assert_array_equal(arrays["points"], npz["positions"])
        np.testing.assert_array_equal(arrays["connectivity"].reshape(-1, 3), npz["triangles"])
        np.testing.assert_array_equal(arrays["offsets"],
                                      3 * np.arange(1, len(npz["triangles"]) + 1))
        np.testing.assert_array_equal(arrays["blue"], npz["blue"])
        arrays, piece = read_vtp(self.read("w.vtp"))
        self.assertEqual(piece["NumberOfVerts"], "300")
        np.testing.assert_array_equal(arrays["connectivity"], np.arange(300))

    def places(self, rows, mesh):
        """Positions from face, corners and barycentrics alone, and the file as it stands."""
        lines = [line.split() for line in mesh.splitlines()]
        vertices = np.array([[float(x) for x in line[1:]] for line in lines if line[:1] == ["v"]])
        faces = [[int(x) - 1 for x in line[1:]] for line in lines if line[:1] == ["f"]]
        places = []
        for row in rows:
            face = faces[int(row["face"])]
            a, b, c = (vertices[face[int(row[f"corner_{k}"])]] for k in range(3))
            u, v = float(row["bary_u"]), float(row["bary_v"])
            places.append(u * a + v * b + (1 - u - v) * c)
        return np.array(places)

    def test_places_on_polygons_follow_from_face_corners_and_barycentrics(self):
        mesh = self.write("p.obj", POLYGONS)
        self.sample(mesh, "--local", "-o", "s.ply")
        rows = read_ply(self.read("s.ply"))
        self.assertEqual(set(rows["face"]), {0, 1, 2})
        places = self.places(rows, POLYGONS)
        for k, name in enumerate("xyz"):
            np.testing.assert_allclose(places[:, k], rows[name], atol=1e-12)
        self.sample(mesh, "--local", "-o", "s.csv")
        table = list(csv.DictReader(io.StringIO(self.read("s.csv").decode())))
        np.testing.assert_array_equal(self.places(table, POLYGONS), places)
        self.sample(mesh, "--local", "-o", "s.npz")
        corners = np.load(self.path("s.npz"))["face_corners"]
        np.testing.assert_array_equal(corners[:, 2], rows["corner_2"])

    def test_fetched_samples_name_the_corners_too(self):
        server = Server()
        self.addCleanup(server.stop)
        mesh = self.write("p.obj", POLYGONS)
        self.sample(mesh, "--server", server.address, "-o", "s.ply")
        job = self.ccst("sample", mesh, "--count", "300", "--server", server.address, "--detach")
        name = job.stdout.decode().split()[-1]
        for output, flags in (("f.ply", ()), ("g.ply", ("--surface", mesh))):
            self.ccst("watch", name, "--server", server.address)
            fetched = self.ccst("fetch", name, "--server", server.address, "-o", output, *flags)
            self.assertEqual(fetched.returncode, 0, fetched.stderr)
            self.assertEqual(self.read(output), self.read("s.ply"))

    def test_triangles_need_no_corners(self):
        self.sample(self.coloured(), "--local", "-o", "s.ply")
        self.assertNotIn("corner_0", read_ply(self.read("s.ply")).dtype.names)
