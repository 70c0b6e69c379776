"""Stored meshes and jobs through the real programs: detach, watch, fetch, cancel, restarts."""

import json
import os
import signal
import unittest

from harness import ENDLESS, EndToEnd, Server, torus

# Long enough to be caught in the middle, short enough to be waited for.
LONG = ["--count", "20000", "--max-iterations", "25", "--tolerance", "1e-300"]


class Jobs(EndToEnd):
    """With a server whose data lies in the test's folder."""

    def setUp(self):
        super().setUp()
        os.mkdir(self.path("data"))
        self.server = self.serve()
        self.addCleanup(lambda: self.server.stop())

    def serve(self, *flags, listen="127.0.0.1:0"):
        return Server("--data-dir", self.path("data"), *flags, listen=listen)

    def run_ok(self, *arguments, **keywords):
        result = self.ccst(*arguments, "--server", self.server.address, **keywords)
        self.assertEqual(result.returncode, 0, result.stderr)
        return result.stdout.decode()

    def detach(self, mesh, *flags):
        name = self.run_ok("sample", mesh, *flags, "--detach")
        self.assertRegex(name, r"\Ajobs/[0-9a-f-]+\n\Z")
        return name.strip()

    def jobs(self, *flags):
        return json.loads(self.run_ok("jobs", "--json", *flags))

    def kill_and_restart(self):
        address = self.server.address
        self.server.stop(signal.SIGKILL)
        self.server = self.serve(listen=address)


class Fetch(Jobs):
    def assert_fetched_is_sampled(self, mesh, *flags, fetch=()):
        self.run_ok("sample", mesh, "-n", "500", *flags, "-o", "a.ply", "--mesh-output", "a.obj.ply")
        job = self.detach(mesh, "-n", "500", *flags, "--no-cache")
        self.run_ok("watch", job, "--progress", "none")
        self.run_ok("fetch", job, "-o", "b.ply", "--mesh-output", "b.obj.ply",
                    "--summary", "b.json", *fetch)  # fmt: skip
        self.assertEqual(self.read("a.ply"), self.read("b.ply"))
        self.assertEqual(self.read("a.obj.ply"), self.read("b.obj.ply"))
        summary = json.loads(self.read("b.json"))
        self.assertEqual(summary["job"], job)
        self.assertEqual(summary["count"], 500)

    def test_gives_the_bytes_of_sample(self):
        self.assert_fetched_is_sampled(self.write("m.obj", torus()), "--seed", "3")

    def test_knows_the_faces_of_polygons(self):
        self.assert_fetched_is_sampled(self.write("m.obj", torus(quads=True)))

    def test_gives_the_bytes_of_sample_far_from_the_origin(self):
        mesh = self.write("m.obj", torus(quads=True, offset=(1e6, -2e6, 0.1)))
        self.assert_fetched_is_sampled(mesh)

    def test_gives_the_bytes_of_sample_from_ply(self):
        faces = ["3 0 1 2", "3 0 2 3", "4 0 1 4 3", "3 1 2 4", "3 2 3 4"]
        vertices = ["0 0 0 10", "1 0 0 20", "1 1 0 30", "0 1 0 40", "0.3 0.4 0.9 50"]
        header = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}"]
        header += [f"property float {name}" for name in ("x", "y", "z", "heat")]
        header += [f"element face {len(faces)}", "property list uchar int vertex_indices"]
        text = "\n".join([*header, "end_header", *vertices, *faces]) + "\n"
        self.assert_fetched_is_sampled(self.write("m.ply", text))

    def test_takes_the_mesh_from_a_file(self):
        mesh = self.write("m.obj", torus(quads=True))
        self.assert_fetched_is_sampled(mesh, fetch=["--surface", mesh])
        other = self.write("other.obj", torus(large=1.5))
        job = self.jobs()[0]["name"]
        result = self.ccst("fetch", job, "-o", "c.ply", "--surface", other,
                           "--server", self.server.address)  # fmt: skip
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("other.obj", result.stderr)

    def test_refuses_what_has_no_samples(self):
        mesh = self.write("m.obj", torus())
        job = self.detach(mesh, *ENDLESS)
        for name, code in ((job, 2), ("jobs/none", 2)):
            result = self.ccst("fetch", name, "-o", "s.ply", "--server", self.server.address)
            self.assertEqual(result.returncode, code, result.stderr)
        self.run_ok("cancel", job)
        self.ccst("watch", job, "--server", self.server.address)
        result = self.ccst("fetch", job, "-o", "s.ply", "--server", self.server.address)
        self.assertEqual(result.returncode, 4, result.stderr)
        self.assertFalse(os.path.exists(self.path("s.ply")))


class Watch(Jobs):
    def test_shows_every_alternation_of_an_ended_job(self):
        job = self.detach(self.write("m.obj", torus()), "-n", "300")
        first = self.ccst("watch", job, "--progress", "json", "--server", self.server.address)
        again = self.ccst("watch", job.removeprefix("jobs/"), "--progress", "json",
                          "--server", self.server.address)  # fmt: skip
        self.assertEqual((first.returncode, again.returncode), (0, 0))
        self.assertEqual(first.stdout, b"")
        numbers = [json.loads(line)["iteration"] for line in first.stderr.splitlines()]
        self.assertEqual(numbers, list(range(len(numbers))))
        self.assertEqual(first.stderr, again.stderr)

    def test_ctrl_c_leaves_the_job_alone(self):
        job = self.detach(self.write("m.obj", torus()), *ENDLESS)
        process = self.start("watch", job, "--server", self.server.address)
        process.send_signal(signal.SIGINT)
        code, errors = self.finish(process)
        self.assertEqual(code, 4, errors)
        self.assertIn(f"ccst watch {job}", errors)
        self.assertEqual(self.jobs()[0]["state"], "running")

    def test_cancel_ends_it_with_4(self):
        job = self.detach(self.write("m.obj", torus()), *ENDLESS)
        process = self.start("watch", job, "--server", self.server.address)
        self.run_ok("cancel", job)
        self.assertEqual(self.finish(process)[0], 4)
        self.assertEqual(self.jobs("--state", "cancelled")[0]["name"], job)

    def test_goes_on_after_the_server_was_killed(self):
        mesh = self.write("m.obj", torus())
        job = self.detach(mesh, *LONG)
        process = self.start("watch", job, "--server", self.server.address)
        self.kill_and_restart()
        code, errors = self.finish(process)
        self.assertEqual(code, 0, errors)
        numbers = [json.loads(line)["iteration"] for line in errors.splitlines()]
        self.assertEqual(numbers, list(range(1, 26)))
        self.run_ok("fetch", job, "--summary", "f.json")
        self.run_ok("sample", mesh, *LONG, "--no-cache", "--summary", "s.json")
        digests = {json.loads(self.read(n))["samples_digest"] for n in ("f.json", "s.json")}
        self.assertEqual(len(digests), 1)

    def test_gives_up_with_5(self):
        job = self.detach(self.write("m.obj", torus()), *ENDLESS)
        process = self.start("watch", job, "--patience", "1", "--server", self.server.address)
        self.server.stop(signal.SIGKILL)
        self.assertEqual(self.finish(process)[0], 5)

    def test_an_unknown_job_is_2(self):
        result = self.ccst("watch", "none", "--server", self.server.address)
        self.assertEqual(result.returncode, 2, result.stderr)


class Lists(Jobs):
    def test_jobs_are_listed_newest_first_and_filtered(self):
        mesh = self.write("m.obj", torus())
        made = [self.detach(mesh, "-n", "50", "--seed", str(i), "--label", f"run={i}",
                            "--name", f"no {i}") for i in range(3)]  # fmt: skip
        for job in made:
            self.run_ok("watch", job)
        self.assertEqual([j["name"] for j in self.jobs()], made[::-1])
        self.assertEqual([j["name"] for j in self.jobs("--label", "run=1")], [made[1]])
        self.assertEqual(self.jobs("--state", "failed", "--state", "queued"), [])
        table = self.run_ok("jobs").splitlines()
        self.assertEqual(len(table), 4)
        self.assertIn("no 2", table[1])
        self.run_ok("delete", made[0])
        self.assertEqual(len(self.jobs()), 2)

    def test_an_equal_job_is_answered_from_the_cache(self):
        mesh = self.write("m.obj", torus())
        for flags in ([], [], ["--no-cache"]):
            self.run_ok("sample", mesh, "-n", "100", *flags)
        self.assertEqual([j["cached"] for j in self.jobs()], [False, True, False])

    def test_a_state_that_is_none_is_a_usage_error(self):
        self.assertEqual(self.ccst("jobs", "--state", "asleep").returncode, 1)
        self.assertEqual(self.ccst("jobs", "--label", "x").returncode, 1)
        self.assertEqual(self.ccst("fetch", "7").returncode, 1)


class Uploads(Jobs):
    def test_upload_prints_the_name_that_meshes_lists(self):
        mesh = self.write("m.obj", torus())
        name = self.run_ok("upload", mesh)
        self.assertRegex(name, r"\Ameshes/[0-9a-f]{64}\n\Z")
        self.assertEqual(self.run_ok("upload", mesh), name)
        meshes = json.loads(self.run_ok("meshes", "--json"))
        self.assertEqual([m["name"] for m in meshes], [name.strip()])
        self.assertEqual(meshes[0]["display_name"], "m.obj")
        self.assertEqual(meshes[0]["faces"], 2 * 48 * 24)
        self.assertIn("m.obj", self.run_ok("meshes"))
        job = self.detach(mesh, "-n", "50")
        self.run_ok("watch", job)
        self.assertEqual(self.jobs()[0]["mesh"], name.strip())
        self.run_ok("delete", name.strip())
        self.assertEqual(json.loads(self.run_ok("meshes", "--json")), [])

    def test_a_mesh_over_the_inline_limit_is_stored_first(self):
        self.server.stop()
        self.server = self.serve("--max-inline-mesh-bytes", "1000")
        mesh = self.write("m.obj", torus())
        self.run_ok("sample", mesh, "-n", "200", "-o", "remote.ply")
        self.assertEqual(len(json.loads(self.run_ok("meshes", "--json"))), 1)
        result = self.ccst("sample", mesh, "-n", "200", "-o", "local.ply", "--local")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.read("remote.ply"), self.read("local.ply"))

    def test_a_large_mesh_goes_up_once(self):
        mesh = self.write("m.obj", torus(around=400, across=300))  # Over 1 MiB as Draco.
        first = self.ccst("sample", mesh, "-n", "50", "--server", self.server.address)
        second = self.ccst("sample", mesh, "-n", "50", "--server", self.server.address)
        self.assertEqual((first.returncode, second.returncode), (0, 0), first.stderr)
        self.assertIn("uploading", first.stderr)
        self.assertNotIn("uploading", second.stderr)


if __name__ == "__main__":
    unittest.main()
