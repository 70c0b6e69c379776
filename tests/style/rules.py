"""The architecture as data: which room may include or import what. Read by check_includes.

Arrows go only downwards: a room may include itself and what its entry reaches. A file that
needs more is listed by name in FILE_EXCEPTIONS with the reason.
"""

# room -> rooms it may include directly; what those may include is allowed too.
ROOMS = {
    "core/base": [],
    "core/random": ["core/base"],
    "core/parallel": ["core/base"],
    "core/mesh": ["core/random", "core/parallel"],
    "core/spatial": ["core/mesh"],
    "core/surface": ["core/spatial"],
    "core/repair": ["core/surface"],
    "core/density": ["core/surface"],
    "core/methods": ["core/density"],
    "core/quality": ["core/spatial"],
    "core/analysis": ["core/density", "core/quality"],
    # In the order in which a run passes them; see FILE_ROOMS for the first.
    "core/sampling/types": ["core/density", "core/repair"],
    "core/sampling/mesh": ["core/surface"],
    "core/sampling/input": ["core/sampling/types", "core/quality"],
    "core/sampling/start": ["core/sampling/mesh", "core/sampling/types", "core/quality"],
    "core/sampling/relax": ["core/sampling/start"],
    "core/sampling/output": ["core/sampling/mesh", "core/sampling/input"],
    "core/sampling": ["core/sampling/output", "core/sampling/relax", "core/methods"],
    "core/io": ["core/sampling"],
    "proto": [],
    "proto/convert": ["proto", "core/analysis", "core/io"],
    "server/base": ["core/base"],
    "server/formats": ["proto/convert", "server/base"],
    "server/store": ["server/formats"],
    "server/meshes": ["core/io", "server/store"],
    "server/auth": ["server/base"],
    "server/net": ["server/auth"],
    "server/log": ["server/base"],
    "server/metrics": ["server/base"],
    "server/jobs": ["core/analysis", "server/meshes", "server/metrics"],
    "server/rpc": ["proto/convert", "server/auth", "server/jobs", "server/log", "server/metrics"],
    "server/app": ["server/net", "server/rpc"],
    "server": ["server/app"],
    "client/lib": ["proto/convert"],
    "client/render": ["core/sampling"],
    "client/report": ["client/render", "core/analysis"],
    "client/cli": ["client/lib", "client/report", "core/analysis", "core/io"],
    "client": ["client/cli"],
    # TypeScript: what a file imports from another room of the page.
    "client/web/gateway": [],
    "client/web/src/api": [],
    "client/web/src/charts": [],
    "client/web/src/ui": ["client/web/src/api"],
    "client/web/src/mesh": ["client/web/src/api"],
    "client/web/src/job": ["client/web/src/mesh"],
    "client/web/src/export": ["client/web/src/job"],
    "client/web/src/view": ["client/web/src/job"],
    "client/web/src/panels": [
        "client/web/src/charts", "client/web/src/export", "client/web/src/ui", "client/web/src/view",
    ],
    "client/web/src/pages": ["client/web/src/panels"],
    "client/web/src": ["client/web/src/pages"],
    # Its settings of Vite.
    "client/web": [],
}

# file -> the room it belongs to, where that is not its folder's: what is asked of the sampler and what
# comes out lies beside its entrance, but the rooms below include it.
FILE_ROOMS = {
    "core/sampling/algorithm_revision.h": "core/sampling/types",
    "core/sampling/energy.h": "core/sampling/types",
    "core/sampling/option_kinds.cc": "core/sampling/types",
    "core/sampling/option_kinds.h": "core/sampling/types",
    "core/sampling/option_table.h": "core/sampling/types",
    "core/sampling/options.h": "core/sampling/types",
    "core/sampling/options.cc": "core/sampling/types",
    "core/sampling/result.h": "core/sampling/types",
    "core/sampling/run_control.h": "core/sampling/types",
}

# room -> its headers that other rooms may include, where that is not all of them.
PUBLIC = {
    "core/sampling": ["core/sampling/sampling.h"],
    "core/sampling/input": ["core/sampling/input/prepared_surface.h"],
    "core/sampling/mesh": [],
    "core/sampling/start": [],
    "core/sampling/relax": [],
    "core/sampling/output": [],
}

# room of PUBLIC -> further headers, for the rooms of its own house: its parent folder and those
# beside it.
PUBLIC_IN_HOUSE = {
    "core/sampling/input": ["core/sampling/input/source_map.h"],
    "core/sampling/mesh": [
        "core/sampling/mesh/edge_flips.h", "core/sampling/mesh/faults.h",
        "core/sampling/mesh/sample_mesh.h",
        "core/sampling/mesh/samples.h",
    ],
    "core/sampling/start": [
        "core/sampling/start/creases.h", "core/sampling/start/initial_mesh.h",
        "core/sampling/start/initial_points.h", "core/sampling/start/plan.h",
    ],
    "core/sampling/relax": ["core/sampling/relax/relaxation.h"],
    "core/sampling/output": [
        "core/sampling/output/export.h", "core/sampling/output/progressive_order.h",
        "core/sampling/output/stages.h",
    ],
}

# Folders that may include any room.
UNRESTRICTED = ["tests"]

# (room, rooms reached through the table that it must not include itself).
DENIED = {
    "client/lib": ["core/io"],
    "proto/convert": ["core/io"],
    # What is stored hangs on no message of the API.
    "server/store": ["proto", "proto/convert"],
    "server/meshes": ["proto", "proto/convert"],
    "server/jobs": ["proto", "proto/convert"],
}

# name -> (regular expression on the include path, rooms that may include it).
EXTERNALS = {
    "generated protobuf code": (
        r"^google/protobuf/|\.pb\.h$",
        ["proto", "proto/convert", "server/formats", "server/rpc", "server/app", "client/lib", "client/cli"],
    ),
    "gRPC": (
        r"^grpc(pp|\+\+)?/|\.grpc\.pb\.h$",
        ["proto", "server/rpc", "server/app", "server", "client/lib", "client/cli"],
    ),
    "Draco": (r"^draco/", ["core/io"]),
    "Qhull": (r"^libqhull", []),
    "SQLite": (r"^sqlite3\.h$", ["server/store"]),
    "image decoders": (r"^(spng|turbojpeg)\.h$", ["core/io"]),
    "archives": (r"^zip\.h$", ["core/io"]),
    "command-line flags": (
        r"^absl/flags/|^CLI/|^getopt\.h$",
        ["server", "server/app", "client", "client/cli"],
    ),
    "logging": (
        r"^absl/log/|^glog/|^spdlog/|^iostream$|^syslog\.h$",
        ["server/rpc", "server/app", "server", "server/metrics", "client/cli", "client"],
    ),
    "OpenSSL": (r"^openssl/", ["core/base", "server/auth", "server/net"]),
    "Prometheus": (r"^prometheus/", ["server/metrics"]),
    "three.js": (r"^three(/|$)", ["client/web/src/view", "client/web/src/mesh"]),
    "uPlot": (r"^uplot", ["client/web/src/charts"]),
    "Connect": (r"^@connectrpc/", ["client/web/src/api", "client/web/gateway"]),
    "nanoflann": (r"^nanoflann", ["core/spatial", "core/quality"]),
    "oneTBB": (r"^(one)?tbb/", ["core/parallel"]),
}

# (regular expression on code, rooms it must not occur in, why).
FORBIDDEN_CODE = [
    (
        r"std::(mt19937|random_device|default_random_engine|rand\b|uniform_|normal_distribution)",
        ["core", "proto"],
        "samples come from core/random alone: std distributions differ between libraries",
    ),
    (
        r"std::(a?(sin|cos|tan)h?|atan2|exp2?|expm1|log(2|10|1p)?|pow|cbrt|hypot|[lt]gamma|erfc?)\(",
        [
            "core/base", "core/random", "core/mesh", "core/spatial", "core/surface", "core/repair", "core/density",
            "core/methods", "core/sampling", "core/io",
        ],
        "samples depend on it, and the C library chooses its last bits by the processor: core/base/portable_math.h",
    ),
    (
        r"\b(system_clock|high_resolution_clock)\b",
        ["core"],
        "core measures with steady_clock and knows no date",
    ),
    (
        r"\bthrow\b(?!\s*\()",
        ["core", "proto/convert", "server/jobs"],
        "errors are values: absl::Status, see core/docs/adr",
    ),
    (r"\busing namespace (?!std::(\w+_)?literals)", [""], "name what is used"),
]

# file -> {what it may include or do besides: reason}. "What" is an include path, a name of
# EXTERNALS, or the regular expression of a FORBIDDEN_CODE row.
FILE_EXCEPTIONS = {
    "client/lib/checked_outcome.cc": {
        "core/io/samples_digest.h": "the digest of what arrived is compared with the server's",
    },
}
