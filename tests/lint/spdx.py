# SPDX-License-Identifier: Apache-2.0
"""Every source file has a line that names the licence."""

from tree import CPP, DATA, matches

MARK = "SPDX-License-Identifier:"
LICENCE = "Apache-2.0"
LICENCE_OF_DISSECTORS = "Apache-2.0 OR GPL-2.0-or-later"  # Wireshark's programming interface requires this
SLASHES = (*CPP, ".proto", ".cs", ".js", ".glsl")

# A program of clients/wireshark writes these files; a test compares them.
GENERATED = ("clients/wireshark/*_fields.lua",)


def comment(tree, path):
    """The mark that begins a comment in a source file; empty for other files."""
    if matches(path, (*DATA, *GENERATED)):
        return ""
    if path.endswith(SLASHES):
        return "//"
    if path.endswith(".lua"):
        return "--"
    if path.endswith(("CMakeLists.txt", ".cmake")) or tree.interpreter(path):
        return "#"
    return ""


def missing(tree):
    """(path, line to add) of each source without the line."""
    for path in tree.files:
        mark = comment(tree, path)
        if not mark:
            continue
        licence = LICENCE_OF_DISSECTORS if matches(path, ("clients/wireshark/*.lua",)) else LICENCE
        line = f"{mark} {MARK} {licence}"
        if line not in tree.text(path).splitlines()[:3]:
            yield path, line


def spdx_complaints(tree):
    for path, line in missing(tree):
        yield f"{path}: wants the line '{line}' at its top; tests/lint/lint.py --fix spdx adds it"


def add_lines(tree):
    for path, line in list(missing(tree)):
        lines = tree.text(path).splitlines(keepends=True)
        lines.insert(1 if lines and lines[0].startswith("#!") else 0, line + "\n")
        (tree.root / path).write_text("".join(lines), encoding="utf-8")
        yield path
