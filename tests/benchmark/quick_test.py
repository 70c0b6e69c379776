"""A quick run of the runner on small jobs and what must come out of it; the arithmetic of ratios,
slopes and the check against the baseline on numbers made up."""

import contextlib
import io
import json
import shutil
import statistics
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import instructions  # noqa: E402
import limits  # noqa: E402
import page  # noqa: E402
import peers  # noqa: E402
from programs import PHASES, Job, JobProgram, compare, measure  # noqa: E402

TINY = Job(count=200, faces=800)


class QuickRun(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="ccst-benchmark-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        done = subprocess.run(
            [sys.executable, HERE / "main.py", "measure", "--quick", "--output", cls.folder],
            capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        cls.results = json.loads((cls.folder / "results.json").read_text())
        cls.page = (cls.folder / "index.html").read_text()

    def test_every_phase_takes_time_and_relaxing_most(self):
        rows = self.results["by_count"] + self.results["by_faces"]
        self.assertEqual(len(rows), 8)
        for row in rows:
            seconds = row["seconds"]
            self.assertTrue(all(seconds[phase] > 0 for phase in PHASES), seconds)
            self.assertAlmostEqual(sum(seconds[phase] for phase in PHASES), seconds["total"])
        self.assertEqual(statistics.mode(max(PHASES, key=row["processor"].get) for row in rows),
                         "relax")

    def test_larger_surfaces_take_more_memory(self):
        single = [row["peak_mib"] for row in self.results["by_faces"] if row["threads"] == 1]
        self.assertGreater(single[1], single[0])

    def test_every_part_is_measured(self):
        names = {row["name"].split("/")[0] for row in self.results["parts"]}
        self.assertEqual(names, {
            "RepairClean", "RepairSoup", "SurfaceBuild", "DracoDecode", "ProjectionFollow",
            "ProjectionSearch", "PointTreeBuild", "PointTreeNearest", "DensityEvaluation",
            "InitialPoints", "InitialMesh", "Flips", "OrderProgressively", "ClosestSameSide"})
        self.assertTrue(all(row["seconds"] > 0 for row in self.results["parts"]))

    def test_small_working_sets_have_more_bandwidth_than_large(self):
        rates = list(self.results["machine"]["triad_gb_per_second"].values())
        self.assertGreater(rates[0], rates[-1])

    def test_page_needs_no_other_file(self):
        self.assertEqual(self.page.count("<svg"), 4)
        self.assertIn("slope", self.page)
        self.assertNotIn("<img", self.page)
        self.assertNotIn("<script", self.page)


class Slope(unittest.TestCase):
    def test_of_a_power_law_is_its_exponent(self):
        xs = [10, 100, 1000]
        self.assertAlmostEqual(page.slope(xs, [3 * x**1.25 for x in xs]), 1.25)

    def test_of_one_point_is_none(self):
        self.assertIsNone(page.slope([10], [1]))


class Made:
    """A program whose seconds are made up, slower by a part at every run as on a busy machine."""

    def __init__(self, seconds):
        self.seconds, self.runs = seconds, 0

    def run(self, _):
        self.runs += 1
        total = self.seconds * self.runs
        return {"seconds": {"relax": total, "total": total}, "processor": {"total": total / 2},
                "peak_mib": 10 * self.seconds}


class Compare(unittest.TestCase):
    def test_ratios_are_those_of_neighbouring_runs(self):
        one, other = Made(3.0), Made(2.0)
        first, _, ratios = compare(one, other, TINY, 5)
        self.assertEqual(ratios["relax"], 1.5)
        self.assertEqual(ratios["memory"], 1.5)
        self.assertEqual(first["seconds"]["total"], 9.0)  # The median of 3, 6, 9, 12, 15.

    def test_long_jobs_are_repeated_less(self):
        long = Made(20.0)
        self.assertEqual(measure(long, TINY, 5, patience=30.0)["runs"], 2)


def counts(relax, alternations=10):
    return {"made_with": {"compiler": "a"}, "jobs": {"scan": {
        "samples": 1, "alternations": alternations,
        "instructions": {"decode": 9, "relax": relax}}}}


class Baseline(unittest.TestCase):
    def test_over_five_percent_more_is_over(self):
        _, over, _ = instructions.differences(counts(1_000_000), counts(1_051_000, 11))
        self.assertEqual(len(over), 1)
        self.assertIn("10 -> 11 alternations", over[0])

    def test_within_five_percent_is_neither(self):
        lines, over, under = instructions.differences(counts(1_000_000), counts(1_049_000))
        self.assertEqual((len(lines), over, under), (1, [], []))

    def test_fewer_asks_for_a_new_baseline(self):
        _, over, under = instructions.differences(counts(1_000_000), counts(900_000))
        self.assertEqual((len(over), len(under)), (0, 1))

    def test_dropped_job_is_over(self):
        _, over, _ = instructions.differences(counts(1_000_000), {"jobs": {}})
        self.assertEqual(over, ["scan: no such job any more"])

    def test_every_job_has_a_baseline(self):
        baseline = json.loads(instructions.BASELINE.read_text())
        self.assertEqual(set(baseline["jobs"]), set(instructions.JOBS))


@unittest.skipUnless(shutil.which("valgrind"), "instructions are counted by valgrind")
class Check(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="ccst-benchmark-")
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name) / "baseline.json"
        self.output = io.StringIO()
        self.enterContext(contextlib.redirect_stdout(self.output))
        instructions.record(self.path, {"tiny": TINY})
        self.baseline = json.loads(self.path.read_text())

    def check(self):
        self.path.write_text(json.dumps(self.baseline))
        return instructions.check(self.path, {"tiny": TINY})

    def test_passes_what_was_just_recorded(self):
        self.assertEqual(self.check(), 0)

    def test_fails_where_the_baseline_was_lower(self):
        self.baseline["jobs"]["tiny"]["instructions"]["relax"] //= 2
        self.assertEqual(self.check(), 1)
        self.assertIn("tests/benchmark/run record", self.output.getvalue())

    def test_is_skipped_for_another_compiler(self):
        self.baseline["made_with"]["compiler"] = "1.0"
        self.assertEqual(self.check(), instructions.SKIPPED)
        self.assertIn("compiler 1.0 -> ", self.output.getvalue())


class PassPage(unittest.TestCase):
    def test_tables_stand_between_the_markers_and_the_text_stays(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "page.md"
            shutil.copy(limits.PAGE, path)
            machine = {"triad_gb_per_second": {24: 101.5}, "chase_ns": {16: 1.5}, "gflops": 21.5,
                       "divide_ns": 8.5}
            limits.fill_page([{"count": 1234, "ns": 432.0}], machine, "A machine.", path)
            text = path.read_text()
        self.assertIn("<!-- measured -->\nA machine.\n\n| samples | ns |", text)
        self.assertIn("| 1,234 | 432 |", text)
        self.assertIn("| bandwidth of a triad over 24 KiB | 102 GB/s |", text)
        after = limits.PAGE.read_text().partition("<!-- end -->")[2]
        self.assertTrue(text.endswith("<!-- end -->" + after))


class Peers(unittest.TestCase):
    def test_those_not_built_are_named_beside_ours(self):
        with tempfile.TemporaryDirectory() as folder, \
                mock.patch.object(peers, "PEER_BIN", Path(folder)), \
                mock.patch.object(peers, "OPEN3D", Path(folder) / "none.py"):
            result = peers.measure_peers(folder, count=200, repeats=1, quick=True)
        rows = {row["name"].split(",")[0]: row for row in result["rows"]}
        self.assertEqual(rows["ccst"]["ratio"], 1.0)
        self.assertEqual(rows["ccst"]["count"], 200)
        self.assertIn("error", rows["CGAL"])
        self.assertIn("error", rows["Open3D"])


class Program(unittest.TestCase):
    def test_counts_what_it_did(self):
        report = JobProgram().run(TINY)
        self.assertEqual(report["count"], 200)
        self.assertGreaterEqual(report["passes"], report["alternations"])
        self.assertGreater(report["processor"]["relax"], 0.0)


if __name__ == "__main__":
    unittest.main()
