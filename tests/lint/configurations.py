# SPDX-License-Identifier: Apache-2.0
"""Configurations against their JSON Schema, with an independent validator."""

import json
import re

import jsonschema
import yaml

from tree import matches

SCHEMA = "configs/schema/sonard.schema.json"
DEMOS = "configs/demo/list.yaml"  # the list of `sonard demo`, not a configuration


class Loader(yaml.SafeLoader):
    """YAML as the daemon reads it: `on` and `off` are words, and only true and false are booleans."""


Loader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag != "tag:yaml.org,2002:bool"]
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()}
Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile("^(?:true|false)$"), list("tf"))


def configuration_complaints(tree):
    schema = json.loads(tree.text(SCHEMA))
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    for path in tree.files:
        if not matches(path, ("configs/*.yaml",)) or path == DEMOS:
            continue
        document = yaml.load(tree.text(path), Loader)
        for error in validator.iter_errors(document):
            yield f"{path}: {error.json_path}: {error.message[:200]}"
