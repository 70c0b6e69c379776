#!/usr/bin/env python3
"""The checkers find what they are there for, and nothing else."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent


def run(checker, files):
    """Runs a checker on a tree made of {path: text}; returns (exit code, output)."""
    with tempfile.TemporaryDirectory() as folder:
        for path, text in files.items():
            file = Path(folder, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        answer = subprocess.run(
            [sys.executable, "-I", "-S", str(HERE / checker), folder],
            capture_output=True, text=True, check=False,
        )
        return answer.returncode, answer.stdout + answer.stderr


class CheckIncludes(unittest.TestCase):
    def accepts(self, path, *lines):
        code, output = run("check_includes", {path: "\n".join(lines) + "\n"})
        self.assertEqual(code, 0, output)

    def refuses(self, path, line, message):
        code, output = run("check_includes", {path: "#pragma once\n" + line + "\n"})
        self.assertEqual(code, 1, output)
        self.assertIn(f"{path}:2: {message}", output)

    def test_downward_arrows_pass(self):
        self.accepts("core/sampling/a.cc", '#include "core/mesh/triangle_mesh.h"', "#include <vector>")
        self.accepts("server/rpc/a.cc", '#include "server/jobs/queue.h"', "#include <grpcpp/server.h>")
        self.accepts("server/main.cc", '#include "server/app/server.h"')
        self.accepts("client/cli/a.cc", '#include "core/io/obj.h"', "#include <CLI/CLI.hpp>")
        self.accepts("core/io/draco.cc", '#include "draco/mesh/mesh.h"')
        self.accepts("tests/server/a.cc", '#include "server/jobs/queue.h"', "#include <iostream>")
        self.accepts("proto/convert/a.cc", '#include "proto/ccst/v1/sample.pb.h"')

    def test_upward_arrows_are_refused(self):
        self.refuses("core/mesh/a.h", '#include "core/sampling/sampling.h"',
                     "core/mesh must not include core/sampling")
        self.refuses("core/surface/a.h", '#include "core/io/obj.h"', "core/surface must not include core/io")
        self.refuses("server/jobs/a.cc", '#include "server/rpc/x.h"', "server/jobs must not include server/rpc")
        self.refuses("server/rpc/a.cc", '#include "server/app/x.h"', "server/rpc must not include server/app")

    def test_rooms_show_some_headers_only(self):
        inner = "core/sampling/relax/ring.h"
        self.refuses("server/jobs/a.cc", f'#include "{inner}"', f"core/sampling/relax keeps {inner} to itself")
        self.refuses("core/sampling/a.cc", f'#include "{inner}"', f"core/sampling/relax keeps {inner} to itself")
        self.accepts("core/sampling/relax/a.cc", f'#include "{inner}"')
        # For the house, not for others.
        plan = "core/sampling/start/plan.h"
        self.accepts("core/sampling/relax/a.cc", f'#include "{plan}"')
        self.refuses("client/cli/a.cc", f'#include "{plan}"', f"core/sampling/start keeps {plan} to itself")
        self.accepts("client/cli/a.cc", '#include "core/sampling/sampling.h"', '#include "core/sampling/options.h"')
        self.accepts("tests/core/a.cc", f'#include "{inner}"')

    def test_rooms_of_the_sampler_stand_in_order(self):
        self.accepts("core/sampling/relax/a.h", '#include "core/sampling/options.h"')
        self.refuses("core/sampling/relax/a.h", '#include "core/sampling/sampling.h"',
                     "core/sampling/relax must not include core/sampling")
        self.refuses("core/sampling/options.h", '#include "core/sampling/sampling.h"',
                     "core/sampling/types must not include core/sampling")
        self.refuses("core/sampling/start/a.h", '#include "core/sampling/relax/relaxation.h"',
                     "core/sampling/start must not include core/sampling/relax")
        self.refuses("core/sampling/input/a.h", '#include "core/sampling/mesh/samples.h"',
                     "core/sampling/input must not include core/sampling/mesh")
        self.refuses("core/sampling/start/a.h", '#include "core/methods/methods.h"',
                     "core/sampling/start must not include core/methods")

    def test_client_and_server_stay_apart(self):
        self.refuses("client/lib/a.cc", '#include "server/jobs/x.h"', "client/lib must not include server/jobs")
        self.refuses("client/lib/a.cc", '#include "core/io/obj.h"', "client/lib must not include core/io")
        self.refuses("server/rpc/a.cc", '#include "client/lib/x.h"', "server/rpc must not include client/lib")

    def test_pages_import_downwards(self):
        self.accepts("client/web/src/panels/a.ts", "import { a } from '../view/stage';",
                     "import type { Job } from '@api/job_pb';")
        self.refuses("client/web/src/view/a.ts", "import { a } from '../panels/b';",
                     "client/web/src/view must not import client/web/src/panels")
        self.refuses("client/web/gateway/a.ts", "const b = await import('../src/job/b');",
                     "client/web/gateway must not import client/web/src/job")
        self.refuses("client/web/src/pages/a.ts", "import 'three';",
                     "client/web/src/pages must not import three.js")

    def test_libraries_stay_in_their_rooms(self):
        self.refuses("core/sampling/a.cc", "#include <grpcpp/grpcpp.h>", "core/sampling must not include gRPC")
        self.refuses("core/mesh/a.cc", '#include "draco/mesh/mesh.h"', "core/mesh must not include Draco")
        self.refuses("core/io/a.cc", "#include <iostream>", "core/io must not include logging")
        self.refuses("server/jobs/a.cc", '#include "proto/ccst/v1/x.pb.h"',
                     "server/jobs must not include generated protobuf code")
        self.refuses("core/base/a.cc", '#include "absl/flags/flag.h"',
                     "core/base must not include command-line flags")
        self.refuses("proto/convert/a.cc", "#include <grpcpp/grpcpp.h>", "proto/convert must not include gRPC")

    def test_nothing_includes_tests(self):
        self.refuses("core/mesh/a.cc", '#include "tests/core/meshes.h"', "core/mesh must not include tests")

    def test_unknown_rooms_are_refused(self):
        code, output = run("check_includes", {"core/extras/a.h": "#pragma once\n"})
        self.assertEqual(code, 1)
        self.assertIn("lies in no room", output)

    def test_foreign_randomness_is_refused_outside_comments(self):
        self.refuses("core/sampling/a.cc", "std::mt19937 engine;", "'std::mt19937' in core/sampling")
        self.accepts("core/sampling/a.cc", "// not std::mt19937", 'const char* s = "throw x";')

    def test_mathematics_of_the_c_library_are_refused_where_samples_depend_on_them(self):
        for name in ("sin", "atan2", "pow", "log2", "exp", "hypot"):
            self.refuses("core/sampling/start/a.cc", f"x = std::{name}(y);", f"'std::{name}(' in core/sampling/start")
        self.accepts("core/sampling/a.cc", "x = std::sqrt(y) + std::ldexp(1.0, 3) + PortableSin(x);")
        self.accepts("core/analysis/a.cc", "x = std::exp(y);")

    def test_an_empty_tree_is_an_error(self):
        self.assertEqual(run("check_includes", {"README.md": "x\n"})[0], 1)


class CheckTree(unittest.TestCase):
    def refuses(self, files, message):
        code, output = run("check_tree", files)
        self.assertEqual(code, 1, output)
        self.assertIn(message, output)

    def test_a_tidy_tree_passes(self):
        files = {"core/CMakeLists.txt": "a\n", "core/README.md": "b\n", "tests/x/CMakeLists.txt": "c\n"}
        code, output = run("check_tree", files)
        self.assertEqual(code, 0, output)

    def test_a_room_without_readme_is_refused(self):
        self.refuses({"core/base/CMakeLists.txt": "a\n"}, "core/base: a room needs a README.md")

    def test_long_files_need_a_reason(self):
        listing = "tests/style/long_files.txt"
        long = {"core/a.cc": "x\n" * 501}
        self.refuses(long, "core/a.cc: 501 lines")
        self.refuses({**long, listing: "core/a.cc:\n"}, "core/a.cc: 501 lines")
        self.assertEqual(run("check_tree", {**long, listing: "core/a.cc: one table\n"})[0], 0)
        self.refuses({"core/a.cc": "x\n", listing: "core/a.cc: one table\n"}, "drop its line")
        self.refuses({"core/a.cc": "x\n", listing: "core/b.cc: gone\n"}, "core/b.cc does not exist")

    def test_machine_paths_and_hosts_are_refused(self):
        for path in ("/" + "work/x", "/" + "root/.cache", "/" + "home/jo/x"):
            self.refuses({"core/a.md": f"see {path}\n"}, "names a path of one machine")
        self.refuses({"a.json": "https://registry.npm" + "js.org/\n"}, "names a package host")
        self.assertEqual(run("check_tree", {"core/a.md": "server/" + "work/queue and ~/" + "work/x\n"})[0], 0)

    def test_blanks_at_the_end_are_refused(self):
        self.refuses({"core/a.h": "int a; \n"}, "core/a.h:1: blanks")
        self.refuses({"core/a.h": "int a;"}, "no newline at the end")


if __name__ == "__main__":
    unittest.main()
