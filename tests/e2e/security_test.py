"""The real programs with tokens and certificates."""

import json
import os
import subprocess
import tempfile
import unittest

from harness import CCST, CCST_SERVER, TIMEOUT_SECONDS, Server, environment, torus


def run(*arguments, **variables):
    return subprocess.run(
        arguments,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_SECONDS,
        env=environment() | variables,
    )


def openssl(*arguments):
    subprocess.run(["openssl", *arguments], check=True, capture_output=True, timeout=TIMEOUT_SECONDS)


class Security(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.addCleanup(self._folder.cleanup)
        self.mesh = self.write("torus.obj", torus())

    def path(self, name):
        return os.path.join(self._folder.name, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)

    def new_token(self, name):
        """A new token and its line for the server."""
        lines = run(CCST_SERVER, "--new-token", name).stdout.splitlines()
        return [line.split(": ", 1)[1] for line in lines]

    def certificate(self, name):
        """A certificate of localhost that vouches for itself, and its key."""
        openssl("req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes",
                "-subj", f"/CN={name}", "-addext", "subjectAltName=DNS:localhost,IP:127.0.0.1",
                "-days", "1", "-keyout", self.path(name + ".key"), "-out", self.path(name + ".pem"))
        return self.path(name + ".pem"), self.path(name + ".key")

    def serve(self, *flags):
        server = Server(*flags)
        self.addCleanup(server.stop)
        return server

    def test_token_over_tls_gives_the_bits_of_a_local_run(self):
        certificate, key = self.certificate("server")
        token, line = self.new_token("alice")
        server = self.serve("--tls-cert", certificate, "--tls-key", key,
                            "--auth-token-file", self.write("tokens", line + "\n"))
        reach = ["--server", server.address, "--tls-ca", certificate]
        sample = [CCST, "sample", self.mesh, "--count", "200", "--progress", "none"]
        result = run(*sample, *reach, "-o", self.path("remote.csv"),
                     "--token-file", self.write("token", token + "\n"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(run(*sample, "--local", "-o", self.path("local.csv")).returncode, 0)
        with open(self.path("remote.csv"), "rb") as a, open(self.path("local.csv"), "rb") as b:
            self.assertEqual(a.read(), b.read())
        info = run(CCST, "info", "--json", *reach, CCST_TOKEN=token)
        self.assertEqual(json.loads(info.stdout)["server"], server.address)
        self.assertEqual(server.stop(), 0)
        self.assertNotIn(token, server.log())
        self.assertIn(" owner=alice ", server.log())

    def test_wrong_and_missing_token_are_refused_with_advice(self):
        server = self.serve("--auth-token-file", self.write("tokens", self.new_token("a")[1]))
        for variables in ({}, {"CCST_TOKEN": "ccst_wrong"}):
            info = run(CCST, "info", "--server", server.address, **variables)
            self.assertEqual(info.returncode, 2)
            self.assertIn("--token-file", info.stderr)
            self.assertNotIn("ccst_wrong", info.stderr)

    def test_read_only_token_may_not_sample(self):
        token, line = self.new_token("bob:read-only")
        server = self.serve("--auth-token-file", self.write("tokens", line))
        reach = ["--server", server.address]
        self.assertEqual(run(CCST, "info", *reach, CCST_TOKEN=token).returncode, 0)
        result = run(CCST, "sample", self.mesh, "--count", "50", *reach, CCST_TOKEN=token)
        self.assertEqual(result.returncode, 2)
        self.assertIn("read-only", result.stderr)

    def test_mutual_tls_needs_both_certificates(self):
        certificate, key = self.certificate("server")
        client, client_key = self.certificate("client")
        server = self.serve("--tls-cert", certificate, "--tls-key", key, "--tls-client-ca", client,
                            "--log-format", "json")
        info = [CCST, "info", "--server", server.address, "--tls-ca", certificate]
        self.assertEqual(run(*info).returncode, 5)
        self.assertEqual(run(*info, "--tls-cert", client, "--tls-key", client_key).returncode, 0)
        self.assertEqual(server.stop(), 0)
        messages = [json.loads(line).get("message", "") for line in server.log().splitlines()]
        self.assertTrue(any("did not return a certificate" in m for m in messages), messages)

    def test_token_does_not_leave_the_machine_unencrypted(self):
        info = run(CCST, "info", "--server", "192.0.2.1:1", CCST_TOKEN="ccst_secret")
        self.assertEqual(info.returncode, 2)
        self.assertIn("--tls-ca", info.stderr)
        self.assertNotIn("ccst_secret", info.stderr)

    def test_server_is_not_open_by_accident(self):
        result = run(CCST_SERVER, "--listen", "0.0.0.0:0")
        self.assertEqual(result.returncode, 1)
        self.assertIn("--insecure", result.stderr)


if __name__ == "__main__":
    unittest.main()
