# SPDX-License-Identifier: Apache-2.0
"""Subjects of commits have the form 'room: what'."""

import re
import subprocess

SUBJECT = re.compile(r"^[a-z0-9_.+-]+(/[a-z0-9_.+-]+)*(, [a-z0-9_.+-]+(/[a-z0-9_.+-]+)*)*: \S")
LONGEST = 72


def subject_complaint(subject):
    """A complaint about a subject; None if it is valid."""
    if len(subject) > LONGEST:
        return f"has {len(subject)} characters, {LONGEST} is the most"
    if not SUBJECT.match(subject):
        return "is not 'room: what'"
    return None


def default_base(tree):
    """The last tag; without a tag, the commit that added this check."""
    try:
        return tree.git("describe", "--tags", "--abbrev=0").strip()
    except subprocess.CalledProcessError:
        added = tree.git("log", "--diff-filter=A", "--format=%H", "--", "tests/lint/commits.py").split()
        return added[-1] if added else "HEAD"


def commit_complaints(tree, base):
    log = tree.git("log", "--no-merges", "--format=%h %s", f"{base or default_base(tree)}..HEAD")
    for line in log.splitlines():
        commit, _, subject = line.partition(" ")
        complaint = subject_complaint(subject)
        if complaint:
            yield f"commit {commit}: the subject '{subject}' {complaint}"
