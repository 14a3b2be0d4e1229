# SPDX-License-Identifier: Apache-2.0
"""Installs the protocol libraries into a temporary folder and builds programs against them, as users do.

The example must print section 10 of protocol/gemini/README.md, whose bytes it reads.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
sys.path.append(str(SOURCE / "tests" / "support"))
from example_messages import example

EXAMPLE = SOURCE / "clients" / "examples" / "protocol"
SAYS = "sonar 601 ping 5: 483 range lines of 256 beams, 1499.2 m/s\n"
ROOMS = sorted(path.parent.name for path in (SOURCE / "protocol").glob("*/CMakeLists.txt"))
CMAKE = COMPILER = BUILD = None


def run(*command, **options):
    """Returns the command's output, or fails with it."""
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=100, **options)
    if result.returncode:
        raise AssertionError(f"{command} ended with {result.returncode}:\n{result.stdout}{result.stderr}")
    return result.stdout


class Package(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sonard_package_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        run(CMAKE, "--install", BUILD, "--component", "protocol", "--prefix", self.folder / "first")
        # An installed package can be moved and does not depend on its build tree.
        self.prefix = self.folder / "prefix"
        (self.folder / "first").rename(self.prefix)

    def configure(self, source, *options):
        run(CMAKE, "-G", "Ninja", "-S", source, "-B", self.folder / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}",
            f"-DCMAKE_CXX_COMPILER={COMPILER}", *options)

    def pkg_config(self, *arguments):
        folders = ":".join(str(path) for path in self.prefix.glob("lib*/**/pkgconfig"))
        return run("pkg-config", *arguments, env={**os.environ, "PKG_CONFIG_PATH": folders}).split()

    def says(self, program):
        return run(program, input=example("gemini", "ping_head").hex(" "))

    def test_the_example_builds_with_cmake_and_decodes_a_ping_head(self):
        self.configure(EXAMPLE)
        run(CMAKE, "--build", self.folder / "build")
        self.assertEqual(self.says(self.folder / "build" / "ping_head"), SAYS)

    def test_the_example_builds_with_pkg_config(self):
        program = self.folder / "ping_head"
        run(COMPILER, "-std=c++20", EXAMPLE / "main.cpp", "-o", program,
            *self.pkg_config("--cflags", "--libs", "sonard-protocol-gemini"))
        self.assertEqual(self.says(program), SAYS)

    def test_every_header_compiles_by_itself_and_every_library_links(self):
        for room in ROOMS:
            headers = sorted((self.prefix / "include" / "sonard" / "protocol" / room).glob("*.hpp"))
            self.assertTrue(headers, room)
            source = self.folder / f"{room}.cpp"
            source.write_text("".join(f'#include "protocol/{room}/{header.name}"\n' for header in headers) +
                              "int main() {}\n", encoding="utf-8")
            with self.subTest(room=room):
                run(COMPILER, "-std=c++20", source, "-o", self.folder / room,
                    *self.pkg_config("--cflags", "--libs", f"sonard-protocol-{room}"))

    def test_warnings_are_those_of_the_user(self):
        for path in self.prefix.rglob("*.cmake"):
            for flag in ("-W", "-fsanitize", str(SOURCE), str(BUILD)):
                self.assertNotIn(flag, path.read_text(encoding="utf-8"), path)
        source = self.folder / "user"
        source.mkdir()
        (source / "main.cpp").write_text("int main() { int unused = (int)1.5; }\n", encoding="utf-8")
        (source / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.16)\nproject(user CXX)\nfind_package(sonard-protocol REQUIRED)\n"
            "add_executable(user main.cpp)\n"
            "target_link_libraries(user " + " ".join(f"sonard::protocol_{room}" for room in ROOMS) + ")\n", encoding="utf-8")
        self.configure(source)
        run(CMAKE, "--build", self.folder / "build")

    def test_a_component_that_is_not_there_is_said(self):
        source = self.folder / "user"
        source.mkdir()
        (source / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.16)\nproject(user CXX)\n"
            "find_package(sonard-protocol REQUIRED COMPONENTS gemini ping720)\n", encoding="utf-8")
        with self.assertRaisesRegex(AssertionError, "There is no component ping720"):
            self.configure(source)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cmake", required=True)
    parser.add_argument("--compiler", required=True)
    parser.add_argument("--build", required=True, help="folder in which the target sonard_protocol was built")
    options, rest = parser.parse_known_args()
    CMAKE, COMPILER, BUILD = options.cmake, options.compiler, os.path.abspath(options.build)
    unittest.main(argv=[sys.argv[0], "-v", *rest])
