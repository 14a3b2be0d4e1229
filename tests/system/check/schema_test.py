#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The program and an independent validator of JSON Schema must reject the same keys of a configuration.

    schema_test.py PROGRAM

Each key gets a value that is invalid everywhere, an empty mapping, and each mapping gets an unknown key. The program
reads such a file key by key, while the schema was written without a file: both must know the same keys.
"""

import copy
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

import jsonschema

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
PROGRAM = None
SURPLUS = "zz"


def for_heads_of_each_type():
    """The schema, once for each type of heads."""
    with open(os.path.join(SOURCE, "configs", "schema", "sonard.schema.json"), encoding="utf-8") as file:
        schema = json.load(file)
    for head in schema["properties"]["heads"]["items"]["oneOf"]:
        one = copy.deepcopy(schema)
        one["properties"]["heads"]["items"] = head
        # A world is a mapping or the word "empty"; the mapping has the keys.
        one["properties"]["world"] = next(form for form in one["properties"]["world"]["anyOf"] if "properties" in form)
        yield one


def mapping_of(node):
    """The schema of a mapping, or of the mappings in a list; None for other values."""
    node = node.get("items", node)
    return node if "properties" in node else None


def nonsense(node):
    if "properties" in node:
        return {SURPLUS: {}, **{name: nonsense(value) for name, value in node["properties"].items()}}
    if mapping_of(node):
        return [nonsense(node["items"])]
    return {}


def mappings(node, path=""):
    """(path, schema) of all mappings; "heads[0].mount" is the form of a path."""
    yield path, node
    for name, value in node["properties"].items():
        if inner := mapping_of(value):
            yield from mappings(inner, key_in(path, name) + ("[0]" if "items" in value else ""))


def key_in(path, name):
    return f"{path}.{name}" if path else name


def bad_keys(schema):
    """Paths of all invalid keys and values in nonsense()."""
    for path, node in mappings(schema):
        yield key_in(path, SURPLUS)
        yield from (key_in(path, name) for name, value in node["properties"].items() if not mapping_of(value))


class Schema(unittest.TestCase):
    def program_says(self, document):
        """{key: error message}"""
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            json.dump(document, file)  # JSON is YAML
            file.flush()
            done = subprocess.run([PROGRAM, "check", "--no-network", file.name], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2, done.stderr)
        return dict(re.match(r"[^:]+:\d+:\d+: ([^:]+): (.*)", line).groups() for line in done.stderr.splitlines())

    @staticmethod
    def validator_says(schema, document):
        """Paths of keys that fail."""
        for error in jsonschema.Draft202012Validator(schema).iter_errors(document):
            path = error.json_path.removeprefix("$").removeprefix(".")
            yield key_in(path, SURPLUS) if error.validator == "additionalProperties" else path

    def test_program_and_validator_know_the_same_keys_and_refuse_the_same_values(self):
        for schema in for_heads_of_each_type():
            document = nonsense(schema)
            head = schema["properties"]["heads"]["items"]
            [document["heads"][0]["type"]] = head["properties"]["type"]["enum"]
            bad = set(bad_keys(schema)) - {"heads[0].type"}
            self.assertGreater(len(bad), 150)
            said = self.program_says(document)
            self.assertEqual(bad - set(said), set(), "the program takes them")
            self.assertEqual(bad - set(self.validator_says(schema, document)), set(), "the schema lets them pass")
            for path, node in mappings(schema):
                known = re.search(r"unknown key.*\(expected one of (.*)\)", said[key_in(path, SURPLUS)])[1]
                self.assertEqual(set(known.split(", ")), set(node["properties"]), path)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
