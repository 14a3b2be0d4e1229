#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The loader must accept every key that a message or a finding names, with the value in the message.

    message_keys_test.py PROGRAM

The keys are those in the string literals of the sources (tests/lint/message_keys.py).
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path.insert(0, os.path.join(SOURCE, "tests", "lint"))
import message_keys  # noqa: E402

PROGRAM = None
FOLDERS = ("server", "renderer", "clients")


def sources():
    """(path, text) of each C++ source."""
    for folder in FOLDERS:
        for there, _, names in os.walk(os.path.join(SOURCE, folder)):
            for name in sorted(names):
                path = os.path.relpath(os.path.join(there, name), SOURCE)
                if message_keys.SOURCES.match(path):
                    with open(os.path.join(SOURCE, path), encoding="utf-8") as file:
                        yield path, file.read()


def a_value(node):
    """A value that is valid in a schema."""
    node = node.get("anyOf", [node])[0]
    if "enum" in node:
        return node["enum"][0]
    if "default" in node:
        return node["default"]
    if node.get("type") == "array":
        return [a_value(node["items"])] * node.get("minItems", 1)
    if node.get("type") == "object":
        return {}
    return {"boolean": True, "integer": node.get("minimum", 0), "number": node.get("minimum", 0.5)}.get(
        node.get("type"), "text")


def document(parts, value):
    """The nested mapping of a key; a list if the schema has one."""
    name, *rest = parts
    inner, is_list = name
    made = document(rest, value) if rest else value
    return {inner: [made] if is_list and rest else made}


def typed(value):
    """The text of a value in a message, converted to its type."""
    if value in ("true", "false"):
        return value == "true"
    return json.loads(value) if value and value.replace(".", "", 1).isdigit() else value


class MessageKeys(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with open(os.path.join(SOURCE, message_keys.SCHEMA), encoding="utf-8") as file:
            cls.schema = json.load(file)
        cls.paths = message_keys.schema_paths(cls.schema)
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)

    def complaints_of(self, path, type_of_head, value):
        """{key: error message} of a file with this key only."""
        parts = path.split(".")
        nested = document([(part, self.is_list(".".join(parts[:i + 1]))) for i, part in enumerate(parts)], value)
        if parts[0] == "heads":
            nested["heads"][0]["type"] = type_of_head
        file = os.path.join(self.folder.name, "sonard.yaml")
        with open(file, "w", encoding="utf-8") as out:
            json.dump(nested, out)  # YAML, too
        done = subprocess.run([PROGRAM, "check", "--no-network", file], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2, "the file lacks what is required")
        complaints = (re.match(r"[^:]+(?::\d+:\d+)?: ([^:]+): (.*)", line) for line in done.stderr.splitlines())
        return {re.sub(r"\[\d+\]", "", match[1]): match[2] for match in complaints if match}

    def is_list(self, path):
        return any("items" in node for node in self.paths[path])

    def types_with(self, path):
        """Types of heads that have a key; a key outside of `heads` is tried once."""
        if not path.startswith("heads."):
            return [None]
        types = []
        for head in self.schema["properties"]["heads"]["items"]["oneOf"]:
            if path[len("heads."):] in message_keys.schema_paths(head):
                types += head["properties"]["type"]["enum"]
        return types

    def is_accepted(self, path, value):
        """Whether at least one type of heads accepts the key, and the value if it is given."""
        for type_of_head in self.types_with(path):
            said = self.complaints_of(path, type_of_head, a_value(self.paths[path][0]) if value is None else value)
            unknown = any("unknown key" in complaint for complaint in said.values())
            if not unknown and (value is None or path not in said):
                return True
        return False

    def test_the_loader_accepts_every_key_that_a_message_names(self):
        named = message_keys.named_keys(sources(), self.schema)
        self.assertGreater(len(named), 30)
        for (key, value), place in named.items():
            with self.subTest(key, place=place):
                paths = message_keys.matching_paths(key, self.paths)
                self.assertTrue(paths, "no configuration has this key")
                self.assertTrue(any(self.is_accepted(path, typed(value)) for path in paths))

    def test_it_does_not_accept_a_key_that_there_is_not(self):
        """Tests this test: it finds a wrong name, a wrong value, and a mapping that is given a word."""
        self.paths["heads.acoustics.multipath"] = [{"type": "string"}]
        self.addCleanup(self.paths.pop, "heads.acoustics.multipath")
        self.assertIn("unknown key", self.complaints_of("heads.acoustics.multipath", "gemini_720i", "off")
                      ["heads.acoustics.multipath"])
        self.assertFalse(self.is_accepted("sampling.preset", "faster"))
        self.assertFalse(self.is_accepted("heads.acoustics.physical.multipath", "off"))
        self.assertTrue(self.is_accepted("heads.acoustics.physical.multipath.level", "off"))


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
