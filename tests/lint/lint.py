#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that need no build. `./test lint` runs them all; names select single checks.

The first line names Debian's interpreter because that one finds the packages of docker/packages.txt.
"""

import argparse
import pathlib
import sys
import time

import commits
import configurations
import includes
import links
import message_keys
import spdx
import tools
from tree import Tree

HERE = pathlib.Path(__file__).resolve().parent
LINES_SHOWN = 60


def make_checks(tree, base):
    """{name: function that yields complaints}. With a base, the check `format` reads only changed C++ files."""
    changed = tree.changed_since(base or "HEAD")
    return {
        "format": lambda: tools.format_complaints(tree, changed if base else tree.files),
        "shell": lambda: tools.shell_complaints(tree),
        "spelling": lambda: tools.spelling_complaints(tree, str(HERE / "codespell_ignore.txt")),
        "configurations": lambda: configurations.configuration_complaints(tree),
        "keys": lambda: message_keys.key_complaints(tree),
        "cycles": lambda: includes.cycle_complaints(includes.arrows(tree)),
        "libraries": lambda: includes.library_complaints(tree),
        "layers": lambda: includes.layer_complaints(tree),
        "spdx": lambda: spdx.spdx_complaints(tree),
        "links": lambda: links.link_complaints(tree),
        "site": lambda: tools.site_complaints(tree),
        "reference": lambda: tools.reference_complaints(tree),
        "commits": lambda: commits.commit_complaints(tree, base),
        "tidy": lambda: tools.tidy_complaints(tree, changed),
    }


def run_checks(checks):
    """Prints the complaints and one line for each check; returns true if there is no complaint."""
    summary = []
    for name, check in checks.items():
        started = time.monotonic()
        complaints = list(check())
        lines = [line for complaint in complaints for line in complaint.splitlines()]
        print(*lines[:LINES_SHOWN], sep="\n", end="\n" if lines else "")
        if len(lines) > LINES_SHOWN:
            print(f"... and {len(lines) - LINES_SHOWN} more lines of {name}")
        verdict = "COMPLAINS" if complaints else "clean"
        summary.append((not complaints, f"lint {name:<15} {verdict:<10} {time.monotonic() - started:5.1f} s"))
    print(*(line for _, line in summary), sep="\n")
    return all(clean for clean, _ in summary)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--base", metavar="COMMIT",
                        help="clang-format and clang-tidy read what changed since it, and subjects of commits are checked "
                             "from it. Without it: all files are formatted, clang-tidy reads what is not committed, and "
                             "commits count from the last tag")
    parser.add_argument("--without", metavar="CHECK", action="append", default=[], help="leave this one out")
    parser.add_argument("--message", metavar="FILE", help="only check the subject of the commit message in this file")
    parser.add_argument("--fix", action="store_true", help="first add the lines that spdx wants")
    parser.add_argument("checks", nargs="*", metavar="CHECK")
    arguments = parser.parse_args()

    if arguments.message:
        subject = pathlib.Path(arguments.message).read_text(encoding="utf-8").split("\n")[0]
        complaint = commits.subject_complaint(subject)
        if complaint and not subject.startswith("Merge "):
            sys.exit(f"the subject '{subject}' {complaint}")
        return

    tree = Tree(HERE.parent.parent)
    checks = make_checks(tree, arguments.base)
    for name in (*arguments.checks, *arguments.without):
        if name not in checks:
            parser.error(f"there is no check {name}; there are {' '.join(checks)}")
    wanted = [name for name in arguments.checks or checks if name not in arguments.without]
    if arguments.fix:
        if "spdx" in wanted:
            print(*(f"added to {path}\n" for path in spdx.add_lines(tree)), sep="", end="")
        checks = make_checks(Tree(tree.root), arguments.base)
    sys.exit(0 if run_checks({name: checks[name] for name in wanted}) else 1)


if __name__ == "__main__":
    main()
