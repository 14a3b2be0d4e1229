#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""cmake/gazebo.cmake finds the packages of each release of Gazebo, and the pose source compiles with them. Only Fortress
is on Debian 12, so the packages of later releases are stand-ins: names as the releases have them, around the headers and
libraries of Fortress.

    releases_test.py --build DIR
"""

import argparse
import json
import os
import subprocess
import tempfile
import unittest

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
BUILD = None

PROJECT = """
cmake_minimum_required(VERSION 3.22)
project(releases LANGUAGES CXX)
include({source}/cmake/gazebo.cmake)
if(TARGET sonard_gazebo)
  get_target_property(libraries sonard_gazebo INTERFACE_LINK_LIBRARIES)
  message(STATUS "found: ${{libraries}}")
endif()
"""

# A package NAME with the imported target NAME::NAME, as Gazebo's packages have them.
PACKAGE = """
find_package({real} REQUIRED)
add_library({name}::{name} INTERFACE IMPORTED)
target_link_libraries({name}::{name} INTERFACE {real}::{real})
target_include_directories({name}::{name} INTERFACE {headers})
"""

HEADERS = ("msgs/pose.pb.h", "msgs/pose_v.pb.h", "transport/Node.hh")


def make_release(folder, transport, messages):
    """Stand-ins of the packages of one release, and the headers that it calls gz."""
    headers = os.path.join(folder, "include")
    for header in HEADERS:
        path = os.path.join(headers, "gz", header)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="ascii") as file:
            file.write(f"#pragma once\n#include <ignition/{header}>\nnamespace gz = ignition;\n")
    for name, real in ((transport, "ignition-transport11"), (messages, "ignition-msgs8")):
        package = os.path.join(folder, "lib", "cmake", name)
        os.makedirs(package, exist_ok=True)
        with open(os.path.join(package, f"{name}-config.cmake"), "w", encoding="ascii") as file:
            file.write(PACKAGE.format(name=name, real=real, headers=headers))


class Releases(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory(prefix="sonard-gazebo-")
        self.addCleanup(scratch.cleanup)
        self.folder = scratch.name

    def found(self, *releases):
        """The libraries that cmake/gazebo.cmake chooses if these releases are installed beside Fortress."""
        prefix = os.path.join(self.folder, "prefix")
        for release in releases:
            make_release(prefix, *release)
        project = os.path.join(self.folder, "project")
        os.makedirs(project, exist_ok=True)
        with open(os.path.join(project, "CMakeLists.txt"), "w", encoding="utf-8") as file:
            file.write(PROJECT.format(source=SOURCE))
        output = subprocess.run(["cmake", "-S", project, "-B", os.path.join(project, "build"), f"-DCMAKE_PREFIX_PATH={prefix}"],
                                check=True, capture_output=True, text=True, timeout=120).stdout
        return output.split("found: ")[1].split("\n")[0].split(";")

    def test_fortress_alone(self):
        self.assertEqual(self.found(), ["ignition-transport11::ignition-transport11", "ignition-msgs8::ignition-msgs8"])

    def test_jetty_without_version_numbers(self):
        self.assertEqual(self.found(("gz-transport", "gz-msgs")), ["gz-transport::gz-transport", "gz-msgs::gz-msgs"])

    def test_releases_with_version_numbers(self):
        for transport, messages in ((12, 9), (13, 10), (14, 11)):
            with self.subTest(transport=transport):
                self.assertEqual(self.found((f"gz-transport{transport}", f"gz-msgs{messages}")),
                                 [f"gz-transport{transport}::gz-transport{transport}", f"gz-msgs{messages}::gz-msgs{messages}"])

    def test_half_a_release_is_not_taken(self):
        self.assertIn("ignition-transport11::ignition-transport11", self.found(("gz-transport13", "gz-msgs")))

    def test_the_pose_source_compiles_with_the_names_of_later_releases(self):
        make_release(self.folder, "gz-transport", "gz-msgs")
        with open(os.path.join(BUILD, "compile_commands.json"), encoding="utf-8") as file:
            unit = next(entry for entry in json.load(file) if "/sonard_pose_gazebo.dir/" in entry["command"])
        source = os.path.join(SOURCE, "server", "pose", "gazebo", "source.cpp")
        options = [f"-I{os.path.join(self.folder, 'include')}", "-DSONARD_GAZEBO_GZ", "-fsyntax-only", source]
        words = unit["command"].split(" -o ")[0]
        subprocess.run(f"{words} {' '.join(options)}", shell=True, check=True, cwd=unit["directory"], timeout=300)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", required=True)
    parsed, rest = parser.parse_known_args()
    BUILD = parsed.build
    unittest.main(argv=[__file__, *rest])
