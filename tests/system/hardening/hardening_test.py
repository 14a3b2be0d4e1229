#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The programs are built with the protections of docs/security.md ("Builds"), and the check finds programs without them.

    hardening_test.py --programs DIR
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from hardening import missing_protections  # noqa: E402

ARGUMENTS = None


class Hardening(unittest.TestCase):
    def test_each_program_has_all(self):
        for name in ("sonard", "sonarview", "posecast"):
            with self.subTest(name):
                self.assertEqual(missing_protections(str(ARGUMENTS.programs / name)), [])

    def test_a_program_without_them_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder) / "bare.cpp"
            source.write_text("#include <cstdio>\nint main(int n, char**) { char text[9]; std::snprintf(text, 9, \"%d\", n); return text[0]; }\n")
            flags = ["-O2", "-U_FORTIFY_SOURCE", "-fno-stack-protector", "-no-pie", "-fno-pie", "-fcf-protection=none", "-Wl,-z,norelro,-z,lazy,-z,execstack"]
            subprocess.run(["c++", *flags, str(source), "-o", folder + "/bare"], check=True)
            self.assertEqual(len(missing_protections(folder + "/bare")), 7)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", type=pathlib.Path, required=True)
    ARGUMENTS, rest = parser.parse_known_args()
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)
