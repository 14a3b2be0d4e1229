#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Texts of a release, from the sources.

    release_notes.py --version                the version; an error if two files have different ones
    release_notes.py --notes < CHANGELOG.md   the newest section of the changelog, after the keys to rename
    release_notes.py --tag < CHANGELOG.md     the text of the tag
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
# Each file that has the version, and where.
VERSIONS = {"CMakeLists.txt": r"^project\(sonard VERSION (\S+)", "CITATION.cff": r"^version: (\S+)",
            "clients/python/pyproject.toml": r'^version = "(.*)"', "clients/ros2/package.xml": r"<version>(.*)</version>",
            "clients/ros2/setup.py": r'version="(.*)"'}
# How the loader reads former names: YamlSection::renamed, renamed_value, retired, and the former key of an input of poses.
RENAMED = re.compile(r'\brenamed\("(\w+)",\s*"(\w+)"\)')
RENAMED_VALUE = re.compile(r'\brenamed_value\("(\w+)",\s*"(\w+)",\s*"(\w+)"\)')
RENAMED_INPUT = re.compile(r'\.key = "(\w+)",\s*\.former_key = "(\w+)"')
RETIRED = re.compile(r'\bretired\("(\w+)",\s*"([^"]+)"\)')
# A sentence on a key, an option or a file that is removed.
GONE = re.compile(r"`[^`]+`[^`]{0,30} (?:is|are) gone\b(?! (?:from|does))")


def version():
    found = {}
    for path, pattern in VERSIONS.items():
        match = re.search(pattern, (ROOT / path).read_text(encoding="utf-8"), re.MULTILINE)
        if not match:
            raise SystemExit(f"release_notes.py: {path} has no version")
        found[path] = match.group(1)
    if len(set(found.values())) != 1:
        raise SystemExit("release_notes.py: versions differ: " + ", ".join(f"{path} {text}" for path, text in found.items()))
    return found["CMakeLists.txt"]


def renamed_keys(sources):
    """Lines on the names that the loader reads with a warning, from the texts of its sources."""
    lines = set()
    for text in sources:
        lines |= {f"`{former}` is now `{key}`" for former, key in RENAMED.findall(text)}
        lines |= {f"`{key}: {former}` is now `{key}: {value}`" for key, former, value in RENAMED_VALUE.findall(text)}
        lines |= {f"`poses.{former}` is now `poses.{key}`" for key, former in RENAMED_INPUT.findall(text)}
    return sorted(lines)


def retired_keys(sources):
    """Lines on the keys that the loader refuses, with what to write in their place."""
    return sorted({f"`{key}`: {what_to_do}" for text in sources for key, what_to_do in RETIRED.findall(text)})


def newest_section(changelog, wanted):
    """The text of the first section, which must be that of the version `wanted`."""
    match = re.search(r"^## (\S+)[^\n]*\n(.*?)(?=^## |\Z)", changelog, re.MULTILINE | re.DOTALL)
    if not match or match.group(1) != wanted:
        raise SystemExit(f"release_notes.py: the first section of CHANGELOG.md is not that of {wanted}")
    return match.group(2).strip()


def entries(section):
    """The list entries of a section, each on one line."""
    return [" ".join(entry.split()) for entry in re.findall(r"^- (.*?)(?=^- |^#|\Z)", section, re.MULTILINE | re.DOTALL)]


def notes(changelog):
    section = newest_section(changelog, version())
    sources = [path.read_text(encoding="utf-8") for path in sorted((ROOT / "server").rglob("*.cpp"))]
    gone = [sentence for entry in entries(section) for sentence in re.split(r"(?<=\.) (?=[A-Z`])", entry) if GONE.search(sentence)]
    return "\n".join([f"# sonard {version()}", "", "## Before you upgrade", "",
                      "sonard reads these former names with a warning. `sonard check CONFIG` lists those in your file.", "",
                      *(f"- {line}" for line in renamed_keys(sources)), "", "sonard refuses these keys:", "",
                      *(f"- {line}" for line in retired_keys(sources)), "", "These changes remove something:", "",
                      *(f"- {entry}" for entry in gone), "", "## Changes", "", section]) + "\n"


def main():
    if sys.argv[1:] == ["--version"]:
        print(version())
    elif sys.argv[1:] == ["--notes"]:
        sys.stdout.write(notes(sys.stdin.read()))
    elif sys.argv[1:] == ["--tag"]:
        section = newest_section(sys.stdin.read(), version())
        print(f"sonard {version()}\n\n{len(entries(section))} changes: see CHANGELOG.md.")
    else:
        raise SystemExit(__doc__)


if __name__ == "__main__":
    main()
