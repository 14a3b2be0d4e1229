#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The Debian package: checked by lintian, then installed, used and purged on a fresh system.

    sudo package_test.py [--codename NAME] PACKAGE.deb [TestCase.test_name ...]

The system is a folder made by debootstrap from this machine's mirror, for the release NAME (this machine's). Its programs run
in mount, process and network namespaces of their own. Needs root, debootstrap, lintian, iproute2, and systemd to check the unit.
"""

import argparse
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(REPOSITORY / "tests" / "support"))
from fresh_system import make_fresh_system  # noqa: E402
from hardening import missing_protections  # noqa: E402

PACKAGE = None
CODENAME = None  # of the fresh system; None: this machine's
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"


def system_calls(name):
    """The system calls of a set of systemd ("@system-service"), or the one with this name."""
    if not name.startswith("@"):
        return {name}
    lines = subprocess.run(["systemd-analyze", "syscall-filter", "--no-pager", name], check=True, stdout=subprocess.PIPE, text=True).stdout.split("\n")[1:]
    return {call for line in lines if line.strip() and not line.strip().startswith("#") for call in system_calls(line.strip())}


class System:
    """A fresh Debian in a folder."""

    def __init__(self, root):
        self.root = pathlib.Path(root)
        make_fresh_system(root, CODENAME)

    def run(self, command, network=True, expected=0, timeout=600):
        """Output of a shell command in the system, standard error included."""
        inside = shlex.join(["chroot", str(self.root), "env", "-i", f"PATH={PATH}", "HOME=/root", "DEBIAN_FRONTEND=noninteractive",
                             "sh", "-c", command])
        setup = (f"mount -t proc proc {shlex.quote(str(self.root / 'proc'))} && mount --bind /dev {shlex.quote(str(self.root / 'dev'))} && "
                 + ("" if network else "ip link set lo up && ") + "exec " + inside)
        done = subprocess.run(["unshare", "--mount", "--pid", "--fork", "--kill-child", *([] if network else ["--net"]), "sh", "-c", setup],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=timeout)
        if done.returncode != expected:
            raise AssertionError(f"'{command}' ended with {done.returncode}:\n{done.stdout[-4000:]}")
        return done.stdout

    def files(self):
        """Files that the package may have left behind."""
        return {str(path.relative_to(self.root)) for folder in ("etc", "usr", "opt", "var", "srv")
                for path in (self.root / folder).rglob("*") if "sonar" in path.name or "posecast" in path.name}


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.system = System(cls.folder.name + "/root")
        shutil.copy(PACKAGE, cls.system.root / "tmp" / "sonard.deb")
        cls.system.run("apt-get update && apt-get install --yes --no-install-recommends /tmp/sonard.deb", timeout=1800)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_1_lintian_has_nothing_to_say(self):
        done = subprocess.run(["lintian", "--allow-root", "--fail-on", "error,warning", PACKAGE], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
        self.assertEqual((done.returncode, done.stdout.strip()), (0, ""))

    def test_2_the_demo_moves_from_the_package_alone(self):
        printed = self.system.run("cd /tmp && sonard demo --seconds 10 --out /tmp/out", network=False)
        print(printed)
        self.assertRegex(printed, r"demo: open http://127\.0\.0\.1:8014 in a browser")
        self.assertRegex(printed, r"got .* complete \([1-9]\d* in all\); 0 lines missing")
        picture = (self.system.root / "tmp/out/fan-last.png").read_bytes()
        self.assertTrue(picture.startswith(b"\x89PNG") and len(picture) > 10000)

    def test_3_the_service_serves_sonarview(self):
        unit = (self.system.root / "usr/lib/systemd/system/sonard.service").read_text()
        start = re.search("^ExecStart=(.*)$", unit, re.MULTILINE).group(1)
        printed = self.system.run(
            f"{start} 2>/tmp/log & daemon=$!; "
            "for try in $(seq 300); do grep -q 'sonard ready' /tmp/log && break; sleep 0.2; done; "
            "sonarview --pings 5 --range 10; code=$?; kill $daemon; wait $daemon; cat /tmp/log; exit $code", network=False)
        self.assertRegex(printed, "summary pings_complete=5 pings_incomplete=0")

    def test_4_the_configuration_of_the_service_is_good(self):
        self.assertIn("/etc/sonard/sonard.yaml: good", self.system.run("sonard check /etc/sonard/sonard.yaml", network=False))

    def test_5_pages_and_versions(self):
        pages = {path.name for path in (self.system.root / "usr/share/man").rglob("*.gz")}
        for command in ("sonard", "sonarview", "posecast", "roscast"):
            self.assertIn(command + ".1.gz", pages)
            self.assertRegex(self.system.run(command + " --version"), rf"^{command} \d+\.\d+\.\d+, commit [0-9a-f]+")
        self.assertIn("sonard.yaml.5.gz", pages)
        words = self.system.run("apt-get install --yes bash-completion >/dev/null 2>&1; bash -c '. /usr/share/bash-completion/completions/sonard; "
                                "COMP_WORDS=(sonard re); COMP_CWORD=1; _sonard; echo ${COMPREPLY[@]}; "
                                "COMP_WORDS=(sonard replay --l); COMP_CWORD=2; _sonard; echo ${COMPREPLY[@]}'")
        self.assertEqual(words.split("\n")[:2], ["render replay", "--loop --log-level --log-format"])

    def test_6_the_unit_is_sound(self):
        unit = str(self.system.root / "usr/lib/systemd/system/sonard.service")
        line = subprocess.run(["systemd-analyze", "security", "--offline=true", "--no-pager", unit], stdout=subprocess.PIPE, text=True).stdout
        print(line.strip().splitlines()[-1])
        self.assertRegex(line, "Overall exposure level for .*: [0-2]\\.")

    def test_7_the_unit_allows_each_system_call_of_the_service(self):
        """Under strace the service loads its world, serves, records and ends; the filter must allow each of its calls."""
        self.system.run("apt-get install --yes --no-install-recommends strace")
        printed = self.system.run(
            "cd /tmp && sed 's|^heads:|recording: {directory: /tmp/rec}\\nheads:|' /etc/sonard/sonard.yaml >/etc/sonard/recorded.yaml && "
            "strace --follow-forks --summary-only --output=/tmp/calls sonard run /etc/sonard/recorded.yaml 2>/tmp/log & "
            "for try in $(seq 600); do grep -q 'sonard ready' /tmp/log && break; sleep 0.2; done; "
            "sonarview --pings 3 --range 10; kill $(pidof sonard); wait; rm /etc/sonard/recorded.yaml; cat /tmp/log /tmp/calls", network=False)
        self.assertIn("summary pings_complete=3", printed)
        made = set(re.findall(r"^\s*[0-9.]+\s+[0-9.]+\s+\d+\s+\d+\s+(?:\d+\s+)?(\w+)$", printed, re.MULTILINE)) - {"total"}
        self.assertGreater(len(made), 50)
        unit = (self.system.root / "usr/lib/systemd/system/sonard.service").read_text()
        allowed = set()
        for line in re.findall("^SystemCallFilter=(.*)$", unit, re.MULTILINE):
            calls = {call for word in line.lstrip("~").split() for call in system_calls(word)}
            allowed = allowed - calls if line.startswith("~") else allowed | calls
        # Libraries try these calls and continue without them.
        self.assertEqual(sorted(made - allowed - {"sched_setaffinity", "mbind", "set_mempolicy"}), [])

    def installed(self):
        return set(self.system.run("dpkg-query --show --showformat='${Package} '").split())

    def test_8_programs_are_hardened_and_their_parts_are_listed(self):
        for name in ("sonard", "sonarview", "posecast"):
            self.assertEqual(missing_protections(str(self.system.root / "usr/bin" / name)), [], name)
        bill = json.loads((self.system.root / "usr/share/doc/sonard/sonard.spdx.json").read_text())
        self.assertEqual(bill["spdxVersion"], "SPDX-2.3")
        listed = {package["name"]: package["versionInfo"] for package in bill["packages"]}
        depends = self.system.run("dpkg-query --show --showformat='${Depends}' sonard")
        libraries = {name.split()[0] for name in depends.split(", ")} - {"python3:any", "libgl1-mesa-dri"}
        provided = self.system.run("dpkg-query --show --showformat='${Provides}, ' " + " ".join(set(listed) & self.installed()))
        self.assertEqual(sorted(libraries - set(listed) - {name.split()[0] for name in provided.split(", ") if name}), [])
        installed = self.system.run("dpkg-query --show --showformat='${Version}' libyaml-cpp0.7 2>/dev/null || true")
        self.assertEqual(listed.get("libyaml-cpp0.7", ""), installed)

    def test_9_purged_it_leaves_nothing(self):
        self.system.run("apt-get purge --yes sonard")
        self.assertEqual(self.system.files(), set())


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--codename", help="release of the fresh system, such as trixie; without it this machine's")
    parser.add_argument("package")
    parser.add_argument("tests", nargs="*")
    options = parser.parse_args()
    PACKAGE, CODENAME = os.path.abspath(options.package), options.codename
    unittest.main(argv=[sys.argv[0], "-v", *options.tests])
