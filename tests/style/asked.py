"""What a file of the tree asks of the system: programs, libraries of CMake, headers, modules."""

import ast
import functools
import json
import re
import sys

from shell_commands import shell_commands

# Compilers, CMake and Ninja are asked for by saying so, not by name.
CMAKE_CALL = re.compile(r"^\s*(\w+)\s*\(\s*([^()]*)", re.MULTILINE)
ABSOLUTE = re.compile(r"""(?<![\w$}*.])/usr/(?:s?bin/[\w.+-]*\w|share/[\w.+-]+/)""")
SYSTEM_HEADER = re.compile(r"^(sys|arpa|netinet|net|linux|gnu)/|^\w+$|^(unistd|fcntl|signal|time|stdlib|pthread|malloc|"
                           r"dirent|string|stdio|stdint|math|errno|poll|getopt|dlfcn|netdb|ifaddrs|sched|semaphore|spawn|termios|pwd|grp|"
                           r"locale|syslog|limits|assert|execinfo)\.h$")
ROOMS = re.compile(r"^(core|server|client|proto|tests|ccst)/")
SPAWNING = {"run", "Popen", "check_output", "check_call", "call", "which", "execFileSync", "spawn"}


def _from_shell(text):
    for name, line, words in shell_commands(text):
        if name.startswith("/"):
            yield "program", name.rpartition("/")[2], line
        elif "/" not in name:
            yield "program", name, line
        if name == "command" and words[:1] == ["-v"] and len(words) > 1 and words[1]:
            yield "program", words[1], line
        # Without a generator that is named, CMake's own choice is make.
        if name == "cmake" and ("-S" in words or "-B" in words) and not {"-G", "--preset"} & set(words):
            yield "program", "make", line


def _from_cmake(text):
    # Comments keep their line's number.
    text = re.sub(r"(?m)#.*$", "", text)
    if "protobuf::protoc" in text:
        yield "program", "protoc", text.count("\n", 0, text.index("protobuf::protoc")) + 1
    for call in CMAKE_CALL.finditer(text):
        function, words = call.group(1).lower(), call.group(2).split()
        line = text.count("\n", 0, call.start(1)) + 1
        if function in ("find_package", "find_dependency") and words:
            yield "cmake package", words[0], line
        elif function == "find_program" and len(words) > 1:
            yield "program", words[1], line
        elif function in ("find_file", "find_library") and len(words) > 1:
            yield "file", words[1], line
        elif function == "pkg_check_modules":
            for name in words[1:]:
                if name not in ("REQUIRED", "QUIET", "IMPORTED_TARGET", "GLOBAL"):
                    yield "pkg-config", name, line
        elif function == "project":
            yield from (("program", "c++", line), ("program", "cmake", line))


def _from_python(text, modules):
    tree = ast.parse(text)
    constants = {
        node.targets[0].id: node.value for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    }
    for node in ast.walk(tree):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names = [node.module]
        for name in names:
            root = name.partition(".")[0]
            if root.endswith("_pb2_grpc"):
                yield "python module", "grpc", node.lineno
            elif root.endswith("_pb2") or root == "ccst":
                yield "python module", "google.protobuf", node.lineno
            elif root == "google":
                yield "python module", name, node.lineno
            elif root not in sys.stdlib_module_names and root not in modules:
                yield "python module", root, node.lineno
        if isinstance(node, ast.Call) and node.args:
            function = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            first = node.args[0]
            if isinstance(first, (ast.List, ast.Tuple)) and first.elts:
                first = first.elts[0]
            elif function != "which":
                continue
            first = constants.get(getattr(first, "id", None), first)
            if function in SPAWNING and isinstance(first, ast.Constant) and isinstance(first.value, str):
                if "/" not in first.value:
                    yield "program", first.value, node.lineno


def _from_cpp(text):
    for match in re.finditer(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', text, re.MULTILINE):
        name = match.group(1)
        if not SYSTEM_HEADER.search(name) and not ROOMS.search(name) and ("/" in name or match.group(0).endswith(">")):
            yield "header", name, text.count("\n", 0, match.start(1)) + 1


def _from_javascript(text):
    for match in re.finditer(r"""(?:from|import|import\()\s*['"]([^'"\n]+)['"]""", text):
        name = match.group(1)
        if not re.match(r"[./]|node:|@(api|health)/", name):
            parts = name.split("/")
            package = "/".join(parts[: 2 if name.startswith("@") else 1])
            yield "node module", package, text.count("\n", 0, match.start()) + 1
    for match in re.finditer(r"""\b(?:execFileSync|spawn)\(\s*'([\w.+-]+)'""", text):
        yield "program", match.group(1), text.count("\n", 0, match.start()) + 1


def _from_presets(text):
    for preset in json.loads(text)["configurePresets"]:
        if "generator" in preset:
            yield "program", preset["generator"].lower(), 1
        if "CMAKE_CXX_COMPILER" in preset.get("cacheVariables", {}):
            yield "program", preset["cacheVariables"]["CMAKE_CXX_COMPILER"], 1


@functools.lru_cache(maxsize=None)
def asked_for(path, text, modules):
    """{(kind, name): first line} that a file asks for. `modules` are the names of Python modules that
    are in the tree, frozen. Kinds: program, cmake package, pkg-config, file, header, python module, node module."""
    first = text.partition("\n")[0]
    found = []
    if path.endswith("CMakePresets.json"):
        found += _from_presets(text)
    elif path.endswith((".cmake", "CMakeLists.txt")):
        found += _from_cmake(text)
    elif path.endswith((".cc", ".h")):
        found += _from_cpp(text)
    elif path.endswith((".ts", ".mjs", ".js")):
        found += _from_javascript(text)
    elif path.endswith(".py") or first.startswith("#!") and "python" in first:
        found += [("program", "python3", 1), *_from_python(text, modules)]
    elif first.startswith("#!") and "bash" in first:
        found += _from_shell(text)
    else:
        return {}
    for match in ABSOLUTE.finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        name = match.group(0)
        if "bin/" in name:
            found.append(("program", name.rpartition("/")[2], line))
        else:
            found.append(("file", name, line))
    result = {}
    for kind, name, line in found:
        result.setdefault((kind, name), line)
    return result
