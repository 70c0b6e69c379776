#!/usr/bin/env python3
"""The checkers of packages find what they are there for, in a copy of this tree that lacks something."""

import contextlib
import importlib.machinery
import importlib.util
import io
import json
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))
from asked import asked_for  # noqa: E402
from shell_commands import shell_commands  # noqa: E402
from tree import source_files  # noqa: E402


def load(name):
    """A checker as a module: started once, it remembers what files ask for that do not change."""
    loader = importlib.machinery.SourceFileLoader(name, str(HERE / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


CHECKERS = {name: load(name) for name in ("check_packages", "check_locks")}


def run(checker, folder):
    """(exit code, output) of a checker over a folder."""
    output = io.StringIO()
    with contextlib.redirect_stdout(output):
        code = CHECKERS[checker].main(Path(folder).resolve())
    return code, output.getvalue()


class CheckPackages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        for path in source_files(ROOT):
            if not path.endswith((".png", ".md")):
                Path(cls.folder, path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / path, Path(cls.folder, path))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def refuses(self, path, old, new, *messages):
        """With `old` replaced in a file, each message is among the violations."""
        file = Path(self.folder, path)
        text = file.read_text() if file.exists() else ""
        self.assertIn(old, text)
        file.write_text(text.replace(old, new))
        code, output = run("check_packages", self.folder)
        file.write_text(text) if text else file.unlink()
        self.assertEqual(code, 1, output)
        for message in messages:
            self.assertIn(message, output)

    def test_this_tree_passes(self):
        code, output = run("check_packages", self.folder)
        self.assertEqual(code, 0, output)

    def test_a_package_that_is_missing_is_named_with_who_asks(self):
        for path, package, message in (
            ("deploy/packages.txt", "cmake\n", "deploy/build-programs:"),
            ("deploy/packages.txt", "libssl-dev\n", ": asks for cmake package OpenSSL, "
             "but deploy/quickstart does not install libssl-dev"),
            ("deploy/packages.txt", "libstb-dev\n", "asks for header stb/stb_image_write.h"),
            ("deploy/packages.txt", "protobuf-compiler\n", "asks for program protoc"),
            ("deploy/packages-test.txt", "python3\n", "asks for cmake package Python3, but .ci/run does not"),
            ("deploy/packages-test.txt", "python3-grpcio\n", "asks for python module grpc, but tests/run does not"),
            ("deploy/packages-test.txt", "chromium\n", "tests/web/run:"),
            ("deploy/packages-quickstart.txt", "glmark2-data\n", "asks for file /usr/" "share/glmark2/"),
            ("deploy/packages-check.txt", "clang-tidy-14\n", "tests/style/tidy:"),
            ("deploy/packages-bare.txt", "debootstrap\n", "tests/bare/bare_root:"),
        ):
            with self.subTest(package):
                self.refuses(path, package, "", message, f"does not install {package.strip()}")

    def test_a_script_that_begins_to_ask_is_found(self):
        self.refuses("tests/consumer/run", "-G Ninja ", "", "asks for program make, but tests/run does not install make")
        self.refuses("deploy/quickstart", "step \"Server\"", "curl -s x", "asks for program curl; packages.py does not say")
        self.refuses("deploy/quickstart", "step \"Server\"", "python3 -c 1", "but deploy/quickstart does not install python3")
        self.refuses("tests/service/disk.py", "import grpc", "import scipy", "asks for python module scipy")
        self.refuses("core/CMakeLists.txt", "add_subdirectory(base)", "find_package(Boost)", "cmake package Boost")

    def test_a_command_that_installs_less_is_found(self):
        self.refuses("deploy/quickstart", "install-packages build quickstart", "install-packages build",
                     "deploy/quickstart: does not install the packages of quickstart")

    def test_a_package_that_nobody_asks_for_is_found(self):
        self.refuses("deploy/packages.txt", "ninja-build\n", "libtinyobjloader-dev\nninja-build\n",
                     "packages of build: nothing that is reached with them asks for libtinyobjloader-dev")

    def test_an_exception_that_is_none_is_found(self):
        self.refuses("tests/benchmark/limits.py", 'which("perf")', 'which("git")',
                     "packages.py: tests/benchmark/limits.py does not ask for perf")

    def test_a_node_module_that_is_not_declared_is_found(self):
        self.refuses("client/web/src/main.ts", "import", "import 'lodash/fp';\nimport", "imports lodash, which is not in")

    def test_a_file_that_no_command_reaches_is_found(self):
        self.refuses("deploy/extra", "", "#!/usr/bin/env bash\nset -euo pipefail\ncmake --version\n",
                     "and no command of packages.py reaches it")


class ShellCommands(unittest.TestCase):
    def names(self, text):
        return [name for name, _, _ in shell_commands(text)]

    def test_commands_are_found_wherever_they_stand(self):
        self.assertEqual(self.names('a | b && c || ! d; (e) & x=1 f "$(g)" `h`\nif i; then j; fi'),
                         ["a", "b", "c", "d", "e", "g", "f", "i", "j"])
        self.assertEqual(self.names("while read -r x; do k; done < <(l | m)\nn <<< word >o 2>&1"), ["k", "l", "m", "n"])
        self.assertEqual(self.names("exec env A=1 timeout 5 p\ncommand -v q\nxargs -0 r"),
                         ["env", "timeout", "p", "q", "xargs", "r"])

    def test_what_is_no_command_is_left_out(self):
        self.assertEqual(self.names("# a\necho 'b; c' \"d | e\" f\\; g\nh=(i j)\n[[ $k =~ ^(l|m)$ ]]"), [])
        self.assertEqual(self.names("case $x in\n  a | b) c ;;\n  *) d ;;\nesac\ncat <<E\ne; f\nE\ng() { h; }\ng"),
                         ["c", "d", "cat", "h"])

    def test_lines_are_those_of_the_script(self):
        self.assertEqual([line for _, line, _ in shell_commands("\na\n\n  b $(\nc)\n")], [2, 5, 4])


class AskedFor(unittest.TestCase):
    def test_kinds_of_files_are_read_as_what_they_are(self):
        for path, text, asked in (
            ("a/CMakeLists.txt", "# find_package(A)\nfind_package(B CONFIG)\n", ("cmake package", "B")),
            ("a.cc", "#include <vector>\n#include <sys/stat.h>\n#include <zlib.h>\n", ("header", "zlib.h")),
            ("a.py", "import os, own, yaml.b\n", ("python module", "yaml")),
            ("b.py", "T = 'jq'\nsubprocess.run([T, '-r'])\n", ("program", "jq")),
            ("a.ts", "import { b } from '@c/d/e';\nimport './f';\nimport 'node:fs';\n", ("node module", "@c/d")),
            ("run", "#!/usr/bin/env bash\n/usr/bin/gdb -p 1\n", ("program", "gdb")),
        ):
            with self.subTest(path):
                found = set(asked_for(path, text, frozenset({"own"}))) - {("program", "python3"), ("program", "env"),
                                                                ("program", "bash")}
                self.assertEqual(found, {asked})


class CheckLocks(unittest.TestCase):
    def check(self, package, entry):
        lock = {"lockfileVersion": 3, "packages": {"": {"dependencies": {"a": "1.0.0"}}, "node_modules/a": entry}}
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "package.json").write_text(json.dumps({"dependencies": {"a": "1.0.0"}, **package}))
            Path(folder, "package-lock.json").write_text(json.dumps(lock))
            return run("check_locks", folder)

    def test_what_debian_can_install_passes(self):
        for wanted in ("*", ">=18", ">= 14.17", "^18.0.0 || ^20.0.0 || >=22.0.0", ">=6 <19", "18.x", "~18.20.1", "12 - 18"):
            with self.subTest(wanted):
                code, output = self.check({}, {"version": "1.0.0", "engines": {"node": wanted, "npm": ">=8.0.0"}})
                self.assertEqual(code, 0, output)

    def test_what_wants_another_node_or_npm_is_refused(self):
        for wanted in (">=20", "^20.19.0 || >=22.12.0", "^18.20.5", "~18.19.0", ">18.20.4", "<18", "20.x", "14 - 17"):
            with self.subTest(wanted):
                code, output = self.check({}, {"version": "1.0.0", "engines": {"node": wanted}})
                self.assertEqual(code, 1, output)
                self.assertIn("node_modules/a 1.0.0 wants node", output)
        self.assertIn("wants npm >=10", self.check({}, {"engines": {"npm": ">=10"}})[1])

    def test_an_optional_package_may_want_more(self):
        self.assertEqual(self.check({}, {"engines": {"node": ">=99"}, "optional": True})[0], 0)

    def test_aliases_among_overrides_are_refused(self):
        for overrides in ({"b": "npm:c@1"}, {"d": {"b": "npm:c@1"}}):
            self.assertIn("cannot parse the override of b", self.check({"overrides": overrides}, {})[1])

    def test_a_lock_of_another_package_json_is_refused(self):
        code, output = self.check({"dependencies": {"a": "2.0.0"}}, {})
        self.assertEqual(code, 1)
        self.assertIn("dependencies are not those of package.json", output)


if __name__ == "__main__":
    unittest.main()
