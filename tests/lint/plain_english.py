#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts phrases that make sentences hard to read, in the documents and in comments. A report, not a check.

    plain_english.py [FOLDER]            counts in the git working tree at FOLDER (default: this one)
    plain_english.py --show KIND         also prints each line of a kind: relative, where, speech, none, those-of, to-be
"""

import argparse
import pathlib
import re
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parent))
from tree import CPP, Tree  # noqa: E402

KINDS = {
    # A free relative clause as the subject: "What is seen twice is counted once."
    "relative": re.compile(r"(?:^|[.:;,] +)(?:and |but |so )?(?:What|what|Who|who|Whoever|whoever|Whatever|whatever) (?:is|are|was|were|has|have|can|comes?|goes|\w+s) [^?]*$"),
    # "where" for "if" or "when"; real places are counted, too.
    "where": re.compile(r"\b[Ww]here\b"),
    # Machines that speak, hear and want.
    "speech": re.compile(r"\b(?:says?|said|tells?|told|hears?|heard|wants?)\b"),
    "none": re.compile(r"\b(?:there is|are|is|has|have|gives?|makes?|finds?|was|were|had) none\b|\b[Nn]one (?:is|are|of|was|has)\b"),
    "those-of": re.compile(r"\b[Tt](?:hose|hat) of\b"),
    "to-be": re.compile(r"\b(?:is|are) to (?:be|have)\b|\bshall\b"),
}
COMMENT = re.compile(r"^\s*(?://+<?|#|\*)\s?(.*)$|\s//+<?\s(.*)$")


def prose_of_markdown(text):
    """(line number, text) outside of blocks of code, without code in the line."""
    code = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            code = not code
        elif not code:
            yield number, re.sub(r"`[^`]*`", "`", line)


def comments(text):
    for number, line in enumerate(text.splitlines(), 1):
        found = COMMENT.search(line)
        if found and not line.startswith("#!"):
            yield number, found.group(1) or found.group(2) or ""


def lines_of(tree):
    """(kind of text, path, line number, text) of all prose."""
    for path in tree.texts():
        text = tree.text(path)
        if path.endswith(".md") and path != "CHANGELOG.md":
            yield from (("docs", path, *line) for line in prose_of_markdown(text))
        elif path.endswith(CPP + (".py", ".cmake", ".sh")):
            yield from (("comments", path, *line) for line in comments(text))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", default=str(pathlib.Path(__file__).resolve().parents[2]))
    parser.add_argument("--show", choices=sorted(KINDS))
    arguments = parser.parse_args()
    counts = {kind: {"docs": 0, "comments": 0} for kind in KINDS}
    long_lines = 0
    for where, path, number, line in lines_of(Tree(arguments.folder)):
        long_lines += where == "docs" and len(line) > 120 and not line.startswith("|")
        for kind, pattern in KINDS.items():
            found = len(pattern.findall(line))
            counts[kind][where] += found
            if found and kind == arguments.show:
                print(f"{path}:{number}: {line.strip()}")
    print(f"{'':12}{'docs':>8}{'comments':>10}")
    for kind, count in counts.items():
        print(f"{kind:12}{count['docs']:8}{count['comments']:10}")
    print(f"lines of documents above 120 characters, without tables and code: {long_lines}")


if __name__ == "__main__":
    main()
