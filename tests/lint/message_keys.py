# SPDX-License-Identifier: Apache-2.0
"""Keys of the configuration that messages name: the loader must accept each of them.

Keys are found in the string literals of C++ sources: words joined by dots ("sampling.preset"), and words with an
underscore before a colon ("hides_vehicle: true"). A message may leave out the front of a key ("physical.gain_db").
"""

import json
import re

SCHEMA = "configs/schema/sonard.schema.json"
SOURCES = re.compile(r"^(?:server|renderer|clients)/.*\.[ch]pp$")
# Words with dots that are not keys, although a part of them is the name of one.
OTHER_WORDS = {"fs.file", "model.config", "model.sdf", "sonard.log"}

_LITERALS = re.compile(r'(?:"(?:[^"\\\n]|\\.)*"\s*)+')
_LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
_INDEX = r"(?:\[[0-9{}]*\])?"
_NAME = r"[a-z][a-z0-9_]*"
_VALUE = r"(?:: ?([a-z0-9_.+-]*[a-z0-9_]))?"
_DOTTED = re.compile(rf"(?<![\w./:<-])({_NAME}{_INDEX}(?:\.{_NAME}{_INDEX})+)(?![\w/(<-]|\.\w|::){_VALUE}")
_SINGLE = re.compile(rf"(?<![\w./:<=-])((?:[a-z0-9]+_)+[a-z0-9]+): ([a-z0-9_.+-]*[a-z0-9_])(?![\w:])")


def texts_of(source):
    """The string literals of a C++ source, adjacent ones joined, without includes and comments."""
    source = re.sub(r"^\s*(?:#include|//).*$", "", source, flags=re.MULTILINE)
    for match in _LITERALS.finditer(source):
        yield "".join(_LITERAL.findall(match.group(0)))


def schema_paths(schema):
    """{path: [schema, ...]} of all keys, such as "heads.acoustics.seed". A key of several kinds has several schemas."""
    paths = {}

    def walk(node, path):
        for name, value in node.get("properties", {}).items():
            here = f"{path}.{name}" if path else name
            paths.setdefault(here, []).append(value)
            items = value.get("items", value)
            for inner in items.get("oneOf", items.get("anyOf", [items])):
                walk(inner, here)

    walk(schema, "")
    return paths


def named_in(text, names):
    """(key, value or None) of each key that a text names. `names` are the last words of all keys."""
    for match in _DOTTED.finditer(text):
        key = match.group(1)
        parts = re.sub(r"\[[^\]]*\]", "", key).split(".")
        if key not in OTHER_WORDS and any(part in names for part in parts) and parts[-1] != "md":
            yield ".".join(parts), match.group(2)
    for match in _SINGLE.finditer(text):
        if match.group(1) in names:
            yield match.group(1), match.group(2)


def named_keys(sources, schema):
    """{(key, value or None): path of a source that names it}; `sources` are (path, text)."""
    names = {path.rpartition(".")[2] for path in schema_paths(schema)}
    named = {}
    for path, text in sources:
        for literal in texts_of(text):
            for key in named_in(literal, names):
                named.setdefault(key, path)
    return named


def matching_paths(key, paths):
    """The paths that are the key or end with it."""
    return [path for path in paths if path == key or path.endswith("." + key)]


def accepts(node, value):
    """True if a value in a message suits the key by its schema. Any text suits a string."""
    for option in node.get("anyOf", [node]):
        if "enum" in option and value in option["enum"]:
            return True
        if option.get("type") == "boolean" and value in ("true", "false"):
            return True
        if option.get("type") in ("number", "integer") and re.fullmatch(r"-?[0-9.]+", value):
            return True
        if option.get("type") in ("string", "array"):
            return True
    return False


def key_complaints(tree):
    schema = json.loads(tree.text(SCHEMA))
    paths = schema_paths(schema)
    sources = ((path, tree.text(path)) for path in tree.files if SOURCES.match(path))
    for (key, value), path in named_keys(sources, schema).items():
        found = matching_paths(key, paths)
        if not found:
            yield f"{path}: a message names the key '{key}', which no configuration has"
        elif value is not None and not any(accepts(node, value) for there in found for node in paths[there]):
            yield f"{path}: a message names '{key}: {value}', which no configuration takes"
