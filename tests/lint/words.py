# SPDX-License-Identifier: Apache-2.0
"""Deprecated words and their replacements (words.yaml)."""

import re

import yaml

from tree import matches


def read_rows(text):
    rows = yaml.safe_load(text)
    for row in rows:
        unknown = set(row) - {"word", "use", "within", "allowed", "left"}
        if unknown or not {"word", "use"} <= set(row):
            raise ValueError(f"words.yaml: a row needs word and use, and may have within, allowed and left: {row}")
    return rows


def uses_of(tree, row, own):
    """Places at which a row's word occurs. Paths count as text."""
    pattern = re.compile(row["word"])
    for path in tree.texts():
        if path in ("CHANGELOG.md", own) or matches(path, row.get("allowed", ())):
            continue
        if not matches(path, row.get("within", ("*",))):
            continue
        if pattern.search(path):
            yield f"{path}: its name"
        if pattern.search(tree.text(path)):
            for number, line in enumerate(tree.text(path).splitlines(), 1):
                if pattern.search(line):
                    yield f"{path}:{number}: {line.strip()[:100]}"


def word_complaints(tree, rows, own):
    """Uses of deprecated words, and numbers of uses that differ from a row's `left`. `own` is the file of the rows."""
    for row in rows:
        uses = list(uses_of(tree, row, own))
        left = row.get("left", 0)
        if uses and not left:
            yield from (f"{use}\n  '{row['word']}' is gone; write: {row['use']}" for use in uses)
        elif len(uses) > left:
            yield f"'{row['word']}' stands in {len(uses)} lines, {left} were left; write: {row['use']}"
        elif len(uses) < left:
            yield f"'{row['word']}' stands in {len(uses)} lines, {own} says {left}; tests/lint/lint.py --fix words lowers it"


def lower_counts(tree, rows, own):
    """Lowers `left` in the file of the rows to the number of uses; yields the words whose row changed."""
    text = tree.text(own)
    for row in rows:
        left = len(list(uses_of(tree, row, own)))
        if left < row.get("left", 0):
            start = text.index(f'- word: "{row["word"]}"')
            old = f"\n  left: {row['left']}"
            place = text.index(old, start)
            text = text[:place] + (f"\n  left: {left}" if left else "") + text[place + len(old):]
            yield row["word"]
    (tree.root / own).write_text(text, encoding="utf-8")
