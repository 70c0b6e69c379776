"""The real command against the real server: results, exit codes, output files, signals."""

import csv
import io
import json
import os
import signal
import unittest

from harness import ENDLESS, EndToEnd, Server, torus


class Remote(EndToEnd):
    """With one server for all tests of the class."""

    @classmethod
    def setUpClass(cls):
        cls.server = Server()

    @classmethod
    def tearDownClass(cls):
        code = cls.server.stop()
        assert code == 0, f"server ended with {code}: {cls.server.log()}"

    def sample(self, *arguments, **keywords):
        return self.ccst("sample", *arguments, "--server", self.server.address, **keywords)


class SameBits(Remote):
    def assert_same(self, mesh, *flags):
        outputs = {}
        for where, place in {"r": ["--server", self.server.address], "l": ["--local"]}.items():
            for threads in [[]] if where == "r" else [["--threads", "1"], ["--threads", "2"]]:
                result = self.ccst(
                    "sample", mesh, "--count", "600", *flags, *place, *threads,
                    "-o", "s.ply", "--mesh-output", "m.obj", "--summary", "s.json",
                    "--progress", "none",
                )  # fmt: skip
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(result.stderr, "")
                digest = json.loads(self.read("s.json"))["samples_digest"]
                outputs[where + "".join(threads)] = (self.read("s.ply"), self.read("m.obj"), digest)
        self.assertEqual(len(set(outputs.values())), 1, list(outputs))

    def test_plain_mesh(self):
        self.assert_same(self.write("a.obj", torus()))

    def test_far_from_the_origin(self):
        self.assert_same(self.write("a.obj", torus(offset=(1e6, -2e6, 0.1))))

    def test_polygons(self):
        self.assert_same(self.write("a.obj", torus(quads=True)))

    def test_other_seed_and_energy(self):
        self.assert_same(self.write("a.obj", torus()), "--seed", "7", "--energy", "squared-area")

    def test_quantised(self):
        self.assert_same(self.write("a.obj", torus()), "--quantization-bits", "10")

    def test_vertices_of_no_face(self):
        self.assert_same(self.write("a.obj", torus() + "v 9 9 9\n" * 9000))


class Results(Remote):
    def test_samples_lie_on_the_files_own_faces(self):
        mesh = self.write("a.obj", torus(quads=True, offset=(1e5, 0, 0)))
        result = self.sample(mesh, "-n", "500", "-o", "s.csv")
        self.assertEqual(result.returncode, 0, result.stderr)
        vertices, faces = [], []
        for line in self.read("a.obj").decode().splitlines():
            kind, *rest = line.split()
            if kind == "v":
                vertices.append([float(x) for x in rest])
            else:
                faces.append([int(x) - 1 for x in rest])
        rows = list(csv.DictReader(io.StringIO(self.read("s.csv").decode())))
        self.assertEqual(len(rows), 500)
        for row in rows:
            corners = [vertices[v] for v in faces[int(row["face"])]]
            position = [float(row[k]) for k in "xyz"]
            u, v = float(row["bary_u"]), float(row["bary_v"])
            # On one of the two triangles that the quad was cut into.
            distances = []
            for a, b, c in (corners[:3], [corners[0], *corners[2:]]):
                point = [u * p + v * q + (1 - u - v) * r for p, q, r in zip(a, b, c)]
                distances.append(max(abs(p - q) for p, q in zip(point, position)))
            self.assertLess(min(distances), 1e-6)

    def test_summary_tells_what_came_out(self):
        result = self.sample(self.write("a.obj", torus()), "-n", "500", "--summary", "-",
                             "--seed", "3", "--progress", "none")  # fmt: skip
        self.assertEqual(result.returncode, 0, result.stderr)
        summary = json.loads(result.stdout)
        self.assertEqual(summary["count"], 500)
        self.assertEqual(summary["seed"], 3)
        self.assertEqual(summary["surface"]["euler"], 0)
        self.assertEqual(summary["surface"]["faces"], 2 * 48 * 24)
        self.assertEqual(summary["server"], self.server.address)
        self.assertTrue(summary["job"].startswith("jobs/"))
        self.assertLess(summary["capacity_cv"], 0.1)

    def test_progress_json_is_one_line_an_alternation(self):
        mesh = self.write("a.obj", torus())
        for place in (["--server", self.server.address], ["--local"]):
            result = self.ccst("sample", mesh, "-n", "500", *place, "--progress", "json",
                               "--summary", "s.json")  # fmt: skip
            self.assertEqual(result.returncode, 0, result.stderr)
            lines = [json.loads(line) for line in result.stderr.splitlines()]
            alternations = json.loads(self.read("s.json"))["alternations"]
            self.assertEqual([x["iteration"] for x in lines], list(range(alternations + 1)))
            keys = {"iteration", "energy", "capacity_cv", "flips", "relocations", "elapsed"}
            for line in lines:
                self.assertEqual(set(line), keys)

    def test_figures_go_to_standard_output_when_nothing_is_asked_for(self):
        result = self.sample(self.write("a.obj", torus()), "-n", "100", "--progress", "none")
        self.assertEqual(result.returncode, 0)
        self.assertIn(b"100 samples", result.stdout)

    def test_samples_and_mesh_go_through_pipes(self):
        result = self.sample("-", "-n", "100", "-o", "-", stdin=torus().encode())
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(result.stdout.splitlines()), 101)
        result = self.sample("-", "-n", "100", "--mesh-output", "-", stdin=torus().encode())
        self.assertEqual(result.stdout.count(b"v "), 100)

    def test_every_output_at_once(self):
        names = ["s.ply", "m.glb", "p.png", "s.json"]
        result = self.sample(self.write("a.obj", torus()), "-n", "200", "-o", names[0],
                             "--mesh-output", names[1], "--picture", names[2],
                             "--summary", names[3])  # fmt: skip
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), sorted(["a.obj", *names]))
        self.assertTrue(self.read("p.png").startswith(b"\x89PNG"))
        self.assertTrue(self.read("m.glb").startswith(b"glTF"))

    def test_the_environment_names_the_server(self):
        mesh = self.write("a.obj", torus())
        env = {"CCST_SERVER": self.server.address}
        self.assertEqual(self.ccst("sample", mesh, "-n", "50", env=env).returncode, 0)
        self.assertEqual(self.ccst("info", env=env).returncode, 0)

    def test_time_limit_is_a_result(self):
        mesh = self.write("a.obj", torus())
        result = self.sample(mesh, *ENDLESS, "--time-limit", "3", "--summary", "s.json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(self.read("s.json"))["termination"], "time_limit")

    def test_time_limit_without_a_result_is_3(self):
        mesh = self.write("a.obj", torus())
        for place in (["--server", self.server.address], ["--local"]):
            for method in ("ccst", "white", "poisson", "elimination", "lloyd", "ccvt"):
                result = self.ccst(
                    "sample", mesh, "-n", "1000", "--method", method, "--time-limit", "1e-6", *place,
                    "-o", "s.ply", "--progress", "none",
                )  # fmt: skip
                self.assertEqual(result.returncode, 3, result.stderr)
                self.assertIn("the time limit passed while", result.stderr)
                self.assertNotIn("cannot reach", result.stderr)
                self.assertFalse(os.path.exists(self.path("s.ply")))

    def test_thin_mesh_is_refused_at_once(self):
        mesh = self.write(
            "strip.obj", "v 0 0 0\nv 1e9 0 0\nv 1e9 .01 0\nv 0 .01 0\nf 1 2 3\nf 1 3 4\n"
        )
        for place in (["--server", self.server.address], ["--local"]):
            result = self.ccst("sample", mesh, "-n", "64", *place, "-o", "s.ply")
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn("boundary", result.stderr)

    def test_info_describes_the_server(self):
        result = self.ccst("info", "--server", self.server.address, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        info = json.loads(result.stdout)
        self.assertEqual(info["server"], self.server.address)
        self.assertGreater(info["limits"]["max_sample_count"], 1000)
        self.assertGreaterEqual(info["algorithm_revision"], 1)
        self.assertIn("running_jobs", info["load"])
        text = self.ccst("info", "--server", self.server.address).stdout.decode()
        self.assertIn(info["version"], text)


class ExitCodes(Remote):
    def both(self, *arguments):
        """Runs remotely and locally; the answers must be alike."""
        remote = self.sample(*arguments)
        local = self.ccst("sample", *arguments, "--local")
        self.assertEqual(remote.returncode, local.returncode)
        self.assertEqual(remote.stderr, local.stderr)
        return local

    def test_usage_errors_are_1(self):
        mesh = self.write("a.obj", torus())
        for arguments in (["--no-such-flag"], [], ["sample", mesh], ["sample", mesh, "-n", "x"],
                          ["sample", mesh, "-n", "9", "-o", "s.txt"]):  # fmt: skip
            result = self.ccst(*arguments)
            self.assertEqual(result.returncode, 1, arguments)
            self.assertTrue(result.stderr.startswith("ccst: "), result.stderr)

    def test_outputs_that_cannot_be_written_are_found_first(self):
        mesh = self.write("a.obj", torus())
        os.mkdir(self.path("folder.ply"))
        for target in ("none/s.ply", "folder.ply", mesh + "/s.ply"):
            result = self.ccst("sample", mesh, *ENDLESS, "--local", "-o", target)
            self.assertEqual(result.returncode, 1, target)
            self.assertIn(target, result.stderr)

    def test_refused_input_is_2(self):
        cases = {
            "empty.obj": "",
            "nan.obj": "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            "range.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
            "flat.obj": "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
            "garbage.drc": b"DRACO" + bytes(range(200)),
            "garbage.ply": b"\x00\xff" * 50,
            "unknown.xyz": "1 2 3\n",
        }
        for name, contents in cases.items():
            result = self.both(self.write(name, contents), "-n", "100", "-o", "s.ply")
            self.assertEqual(result.returncode, 2, (name, result.stderr))
            self.assertEqual(result.stderr.count("\n"), 1)
            self.assertFalse(os.path.exists(self.path("s.ply")))
        self.assertEqual(self.both("no-such-file.obj", "-n", "100").returncode, 2)

    def test_refused_request_is_2(self):
        mesh = self.write("a.obj", torus())
        for flags in (["-n", "2"], ["-n", "-5"], ["-n", "100", "--tolerance", "-1"],
                      ["-n", "100", "--max-iterations", "-1"],
                      ["-n", "100", "--time-limit", "0"]):  # fmt: skip
            result = self.both(mesh, *flags)
            self.assertEqual(result.returncode, 2, (flags, result.stderr))

    def test_limits_of_the_server_are_2(self):
        mesh = self.write("a.obj", torus())
        few = Server("--max-sample-count", "50")
        small = Server("--max-inline-mesh-bytes", "1000", "--max-mesh-bytes", "1001")
        for server, limit in ((few, "max_sample_count"), (small, "max_mesh_bytes")):
            self.addCleanup(server.stop)
            result = self.ccst("sample", mesh, "-n", "51", "--server", server.address)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(limit, result.stderr)

    def test_no_server_is_5(self):
        mesh = self.write("a.obj", torus())
        gone = Server()
        gone.stop()
        for command in (["sample", mesh, "-n", "100", "-o", "s.ply"], ["info"]):
            result = self.ccst(*command, "--server", gone.address)
            self.assertEqual(result.returncode, 5, result.stderr)
            self.assertIn(gone.address, result.stderr)
        self.assertFalse(os.path.exists(self.path("s.ply")))


class Interrupted(Remote):
    def places(self):
        return (["--server", self.server.address], ["--local"])

    def assert_untouched(self):
        self.assertEqual(self.read("s.ply"), b"old")
        self.assertEqual(sorted(os.listdir(self.folder)), ["a.obj", "s.ply"])

    def setUp(self):
        super().setUp()
        self.write("a.obj", torus())
        self.write("s.ply", "old")

    def test_ctrl_c_cancels_with_4(self):
        for signum in (signal.SIGINT, signal.SIGTERM):
            for place in self.places():
                process = self.start("sample", "a.obj", *ENDLESS, "-o", "s.ply", *place)
                process.send_signal(signum)
                code, errors = self.finish(process)
                self.assertEqual(code, 4, errors)
                self.assertIn("cancelled", errors)
                self.assert_untouched()

    def test_cancelling_frees_the_server(self):
        process = self.start("sample", "a.obj", *ENDLESS, "--server", self.server.address)
        process.send_signal(signal.SIGINT)
        self.finish(process)
        # One place to compute would be taken by a job that goes on; all are tried.
        info = json.loads(self.ccst("info", "--server", self.server.address, "--json").stdout)
        for _ in range(info["limits"]["max_running_jobs"]):
            self.assertEqual(self.sample("a.obj", "-n", "50").returncode, 0)

    def test_kill_leaves_nothing(self):
        for place in self.places():
            process = self.start("sample", "a.obj", *ENDLESS, "-o", "s.ply", *place)
            process.kill()
            self.finish(process)
            self.assert_untouched()

    def test_server_killed_in_the_middle_is_5(self):
        server = Server()
        self.addCleanup(server.stop)
        process = self.start("sample", "a.obj", *ENDLESS, "-o", "s.ply", "--server", server.address)
        server.stop(signal.SIGKILL)
        code, errors = self.finish(process)
        self.assertEqual(code, 5, errors)
        self.assert_untouched()

    def test_server_going_away_is_5(self):
        server = Server("--drain-timeout", "0")
        self.addCleanup(server.stop)
        process = self.start("sample", "a.obj", *ENDLESS, "-o", "s.ply", "--server", server.address)
        self.assertEqual(server.stop(), 0)
        code, errors = self.finish(process)
        self.assertEqual(code, 5, errors)
        self.assert_untouched()

    def test_the_server_survives_its_callers(self):
        for _ in range(3):
            process = self.start("sample", "a.obj", *ENDLESS, "--server", self.server.address)
            process.kill()
            self.finish(process)
        self.assertEqual(self.sample("a.obj", "-n", "100").returncode, 0)


if __name__ == "__main__":
    unittest.main()
