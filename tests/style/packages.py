"""Which Debian package has what the tree asks for, and which commands reach which files. Read by
check_packages.
"""

# What every Debian has (packages that are essential, and what is in minbase).
BASE = {
    "program": set(
        "apt-get basename bash cat chmod chroot cmp cp cut date dirname dpkg dpkg-query env false find flock grep head id "
        "ln ls mkdir mktemp mount mv nproc od perl readlink rm sed seq sh sha256sum sleep sort stat sync tail tar "
        "tee timeout touch tr true umount uname uniq unshare wc xargs".split()
    ),
    "cmake package": {"Threads", "ccst"},  # The C library's; what the consumer test has installed.
    "file": {"/usr/share/doc/", "/usr/share/info/", "/usr/share/locale/", "/usr/share/man/"},
}

# (kind, regular expression on the name) -> package. The first that fits counts.
PROVIDERS = [
    ("program", r"c\+\+|g\+\+", "g++"),
    ("program", r"cmake|ctest", "cmake"),
    ("program", r"ninja", "ninja-build"),
    ("program", r"make", "make"),
    ("program", r"protoc", "protobuf-compiler"),
    ("program", r"grpc_(cpp|python)_plugin", "protobuf-compiler-grpc"),
    ("program", r"python3", "python3"),
    ("program", r"node", "nodejs"),
    ("program", r"promtool", "prometheus"),
    ("program", r"clang(\+\+)?-14", "clang-14"),
    # Named like the package they are in.
    ("program", r"ccache|chromium|git|haproxy|npm|openssl|sudo|valgrind|debootstrap|mmdebstrap|clang-(format|tidy)-14", None),
    ("program", r"docker", "docker.io"),
    ("program", r"qemu-(x86_64|aarch64)-static", "qemu-user-static"),
    ("program", r"aarch64-linux-gnu-(gcc|g\+\+)", "g++-aarch64-linux-gnu"),
    ("program", r"perf", "linux-perf"),
    ("cmake package", r"absl", "libabsl-dev"),
    ("cmake package", r"benchmark", "libbenchmark-dev"),
    ("cmake package", r"CGAL", "libcgal-dev"),
    ("cmake package", r"CLI11", "libcli11-dev"),
    ("cmake package", r"draco", "libdraco-dev"),
    ("cmake package", r"Eigen3", "libeigen3-dev"),
    ("cmake package", r"GTest", "libgtest-dev"),
    ("cmake package", r"gRPC", "libgrpc++-dev"),
    ("cmake package", r"meshoptimizer", "libmeshoptimizer-dev"),
    ("cmake package", r"nlohmann_json", "nlohmann-json3-dev"),
    ("cmake package", r"OpenSSL", "libssl-dev"),
    ("cmake package", r"PkgConfig", "pkg-config"),
    ("cmake package", r"prometheus-cpp", "prometheus-cpp-dev"),
    ("cmake package", r"Protobuf", "libprotobuf-dev"),
    ("cmake package", r"Python3", "python3"),
    ("cmake package", r"Qhull", "libqhull-dev"),
    ("cmake package", r"SQLite3", "libsqlite3-dev"),
    ("cmake package", r"TBB", "libtbb-dev"),
    ("cmake package", r"ZLIB", "zlib1g-dev"),
    ("pkg-config", r"spng", "libspng-dev"),
    ("pkg-config", r"libzip", "libzip-dev"),
    ("pkg-config", r"libturbojpeg", "libturbojpeg0-dev"),
    ("file", r"/usr/share/glmark2/", "glmark2-data"),
    ("file", r"/usr/share/javascript/|chart\.min\.js", "libjs-chart.js"),
    ("file", r"/usr/share/mmdebstrap/", "mmdebstrap"),
    ("header", r"absl/.*", "libabsl-dev"),
    ("header", r"benchmark/.*", "libbenchmark-dev"),
    ("header", r"CGAL/.*", "libcgal-dev"),
    ("header", r"CLI/.*", "libcli11-dev"),
    ("header", r"draco/.*", "libdraco-dev"),
    ("header", r"Eigen/.*", "libeigen3-dev"),
    ("header", r"fast_float/.*", "libfast-float-dev"),
    ("header", r"gmock/.*", "libgmock-dev"),
    ("header", r"google/protobuf/.*|grpc/health/v1/.*", "libprotobuf-dev"),
    ("header", r"grpc(pp)?/.*", "libgrpc++-dev"),
    ("header", r"gtest/.*", "libgtest-dev"),
    ("header", r"libqhull_r/.*", "libqhull-dev"),
    ("header", r"meshoptimizer\.h", "libmeshoptimizer-dev"),
    ("header", r"nanoflann\.hpp", "libnanoflann-dev"),
    ("header", r"nlohmann/.*", "nlohmann-json3-dev"),
    ("header", r"openssl/.*", "libssl-dev"),
    ("header", r"prometheus/.*", "prometheus-cpp-dev"),
    ("header", r"spng\.h", "libspng-dev"),
    ("header", r"zip\.h", "libzip-dev"),
    ("header", r"sqlite3\.h", "libsqlite3-dev"),
    ("header", r"stb/.*", "libstb-dev"),
    ("header", r"tbb/.*", "libtbb-dev"),
    ("header", r"turbojpeg\.h", "libturbojpeg0-dev"),
    ("header", r"zlib\.h", "zlib1g-dev"),
    ("python module", r"google\.protobuf", "python3-protobuf"),
    ("python module", r"grpc", "python3-grpcio"),
    ("python module", r"matplotlib", "python3-matplotlib"),
    ("python module", r"numpy", "python3-numpy"),
    ("python module", r"open3d", "python3-open3d"),
]

# The sources of ccst and ccst-server.
PROGRAMS = r"CMake[^/]*|deploy/cmake/.*|(core|proto|server)/.*|client/(?!web/).*"
# What only some commands run; all other tests are those of tests/run.
ASIDE = r"tests/(bare/(?!CMake).*|golden/elsewhere|benchmark/peers.*|containers/(run|image_test\.py)|style/tidy)"
TESTS = rf"(?!{ASIDE}$)tests/.*|client/web/.*"

# command -> (groups of packages that it installs, regular expression on the files that it reaches).
# What another command of this table does, which it starts, is that one's.
COMMANDS = {
    "deploy/quickstart": (["build", "quickstart"], rf"deploy/(quickstart|build-programs)|{PROGRAMS}"),
    "deploy/dashboard": (["build", "node"], rf"deploy/(dashboard|build-programs)|{PROGRAMS}|client/web/.*"),
    "tests/run": (["build", "test", "paper", "node"], rf"{PROGRAMS}|{TESTS}"),
    ".ci/run": (["build", "test", "check", "node"], r"\.ci/run|tests/style/.*|tests/containers/check_alerts"),
    "tests/benchmark/run": (["build", "test", "check", "paper", "peers"], rf"{PROGRAMS}|tests/benchmark/.*"),
    "tests/paper/run": (["build", "test", "paper"], rf"{PROGRAMS}|tests/(?!benchmark/peers).*CMakeLists.txt|tests/paper/.*"),
    "tests/golden/elsewhere": (["build", "test", "check", "emulator", "arm64"], r"tests/golden/elsewhere"),
    "tests/bare/bare_root": (["bare"], r"tests/bare/bare_root"),
    "deploy/images": (["containers"], r"deploy/(images|containers/.*)"),
}

# Of what the tree asks for, what a command does without, or brings itself: (file, name) -> why.
OPTIONAL = {
    ("CMakePresets.json", "clang++-14"): "for fuzzing alone: .ci/run installs it",
    ("tests/style/tidy", "ninja"): "a build was made with it before",
    ("deploy/images", "docker"): "buildah where it is not there",
    ("deploy/images", "git"): "the revision is unknown without",
    ("deploy/containers/base-image", "debootstrap"): "mmdebstrap comes first",
    ("deploy/install-packages", "sudo"): "only for who is not root",
    ("deploy/install-packages", "node"): "whether one is there already",
    ("deploy/install-packages", "npm"): "whether one is there already",
    ("deploy/cmake/ccst-config.cmake", "*"): "read by who uses what was installed",
    ("tests/bare/bare_root", "git"): "without it there is nothing to clone",
    ("tests/bare/bare_root", "npm"): "only where its settings lie",
    ("tests/bare/try", "node"): "deploy/dashboard has installed it",
    ("tests/benchmark/limits.py", "perf"): "left out where it is not there",
    ("tests/containers/check_alerts", "promtool"): "skipped without; .ci/run installs it",
    ("tests/containers/run", "*"): "skipped without; tests/run containers installs it",
    ("tests/containers/image_test.py", "*"): "tests/run containers installs it",
}
for _name in ("instructions.py", "limits.py", "main.py", "quick_test.py"):
    OPTIONAL[f"tests/benchmark/{_name}", "valgrind"] = "instructions are left out without"

# Packages that no file names: package -> why they are there.
UNNAMED = {
    "buildah": "deploy/containers/run starts the word behind it",
    "podman": "deploy/containers/run starts the word behind it",
    "runc": "what podman runs containers with",
    "containernetworking-plugins": "what podman makes networks with",
    "fonts-dejavu-core": "chromium draws text with it",
    "libclang-rt-14-dev": "libFuzzer and the sanitizers of the fuzz preset",
    "clang-14": "the compiler of the fuzz preset",
    "python3": "Debian's, for its modules; tests/containers/run",
    "python3-grpcio": "tests/containers/run",
}
