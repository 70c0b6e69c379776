"""What deploy/ says about images is kept to, seen from the files alone."""

import re
import unittest
from pathlib import Path

TREE = Path(__file__).resolve().parents[2]
DOCKERFILE = (TREE / "deploy/Dockerfile").read_text()
COMPOSE = (TREE / "deploy/compose.yaml").read_text()
UNPRIVILEGED = "65532:65532"
HARDENING = [
    "read_only: true",
    "cap_drop: [ALL]",
    'security_opt: ["no-new-privileges:true"]',
    "mem_limit:",
    "pids_limit:",
]


def instructions():
    """Those of the Dockerfile, whole, without comments."""
    text = re.sub(r"^\s*#.*\n", "", DOCKERFILE, flags=re.MULTILINE).replace("\\\n", " ")
    return [" ".join(line.split()) for line in text.splitlines() if line.strip()]


def stages():
    """{name of a stage: its instructions}."""
    found, current = {}, None
    for instruction in instructions():
        if match := re.fullmatch(r"FROM \S+ AS (\w+)", instruction):
            current = found.setdefault(match[1], [])
        elif current is not None:
            current.append(instruction)
    return found


def services():
    """{name of a service of the compose file: its lines}."""
    body = COMPOSE.split("\nservices:\n")[1].split("\nvolumes:\n")[0]
    parts = re.split(r"^  (\w+):\n", body, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


class Dockerfile(unittest.TestCase):
    def test_images_run_without_privileges(self):
        for name in ("server", "proxy", "prometheus"):
            users = [i for i in stages()[name] if i.startswith("USER ")]
            self.assertEqual(users[-1:], [f"USER {UNPRIVILEGED}"], name)

    def test_all_stages_begin_with_the_pinned_base(self):
        bases = [i.split()[1] for i in instructions() if i.startswith("FROM ")]
        self.assertEqual(set(bases), {"${BASE}"})

    def test_packages_come_without_recommended_ones_and_leave_no_lists(self):
        installs = [i for i in instructions() if "apt-get install" in i]
        self.assertGreaterEqual(len(installs), 2)
        for install in installs:
            self.assertIn("--no-install-recommends", install)
            self.assertIn("rm -rf /var/lib/apt/lists/*", install)

    def test_what_is_copied_exists_and_is_in_the_build_context(self):
        allowed = [
            line[1:] for line in (TREE / ".dockerignore").read_text().splitlines()
            if line.startswith("!")
        ]
        for path in allowed:
            self.assertTrue((TREE / path).exists(), f".dockerignore lets {path} in")
        copies = [i for i in instructions() if i.startswith("COPY ") and "--from=" not in i]
        for source in (s for copy in copies for s in copy.split()[1:-1] if s != "."):
            self.assertTrue((TREE / source).exists(), source)
            self.assertIn(source.split("/")[0], allowed)

    def test_packages_at_run_time_are_pinned(self):
        lines = (TREE / "deploy/packages-runtime.txt").read_text().split()
        self.assertEqual(lines, sorted(lines))
        for line in lines:
            self.assertRegex(line, r"^[a-z0-9.+-]+=[0-9][\w.:+]*[.-]\*$")


class Compose(unittest.TestCase):
    def test_every_service_is_hardened(self):
        self.assertEqual(set(services()), {"server", "proxy", "prometheus"})
        for name, text in services().items():
            for line in HARDENING:
                self.assertIn(f"\n    {line}", text, name)

    def test_ports_are_open_to_this_machine_alone(self):
        for name, text in services().items():
            ports = re.findall(r'- "([^"]*:\d+:\d+)"', text)
            # Callers reach the server through the proxy alone.
            self.assertEqual(bool(ports), name != "server", name)
            for port in ports:
                self.assertTrue(port.startswith("127.0.0.1:"), f"{name}: {port}")

    def test_server_and_proxy_meet_at_one_socket(self):
        server, proxy = services()["server"], services()["proxy"]
        self.assertIn("CCST_PROXY_SOCKET: /run/ccst/server.sock", server)
        self.assertIn("CCST_LISTEN: 127.0.0.1:", server)
        for text in (server, proxy):
            self.assertIn("- run:/run/ccst\n", text)
        for name in ("ends-tls.cfg", "passes-tls.cfg"):
            configuration = (TREE / "deploy/haproxy" / name).read_text()
            self.assertIn("presetenv CCST_PROXY_SOCKET /run/ccst/server.sock", configuration)

    def test_every_service_is_a_target_of_the_dockerfile(self):
        for name, text in services().items():
            self.assertIn(f"target: {name}\n", text)
            self.assertIn(f"image: localhost/ccst-{name}:", text)
            self.assertIn(name, stages())

    def test_prometheus_looks_where_the_server_shows_its_metrics(self):
        scraped = re.findall(r'targets: \["(\w+):(\d+)"\]',
                             (TREE / "deploy/prometheus/prometheus.yml").read_text())
        listens = re.findall(r"CCST_METRICS_LISTEN=0\.0\.0\.0:(\d+)", DOCKERFILE)
        self.assertEqual(scraped, [("server", port) for port in listens])


if __name__ == "__main__":
    unittest.main()
