# SPDX-License-Identifier: Apache-2.0
"""Links of the Markdown files: their files and headings exist, and links from README.md lead to every page of docs/."""

import pathlib
import posixpath
import re

START = "README.md"
FENCE = re.compile(r"^(```|~~~).*?^\1", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`[^`\n]*`")
LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#{1,6} +(.*?) *$", re.MULTILINE)


def slug(heading):
    """The anchor that GitHub makes from a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors(text):
    slugs = []
    for heading in HEADING.findall(FENCE.sub("", text)):
        name = slug(heading)
        slugs.append(f"{name}-{slugs.count(name)}" if name in slugs else name)
    return slugs


def links(text):
    """(line, target) of each link."""
    prose = FENCE.sub(lambda found: "\n" * found.group().count("\n"), text)
    prose = CODE.sub("``", prose)
    for found in LINK.finditer(prose):
        yield prose.count("\n", 0, found.start()) + 1, found.group(1)


def link_complaints(tree):
    files = set(tree.files)
    folders = {str(parent) for path in files for parent in pathlib.PurePosixPath(path).parents}
    pages = {path: tree.text(path) for path in tree.texts() if path.endswith(".md")}
    named = {}
    for path, text in pages.items():
        named[path] = set()
        for line, target in links(text):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, anchor = target.partition("#")
            place = posixpath.normpath(posixpath.join(posixpath.dirname(path), name)) if name else path
            named[path].add(place)
            if place not in files and place not in folders:
                yield f"{path}:{line}: {target}: there is no {place}"
            elif anchor and place in pages and anchor not in anchors(pages[place]):
                yield f"{path}:{line}: {target}: {place} has no heading of that name"
    reached, to_see = set(), [START]
    while to_see:
        page = to_see.pop()
        if page not in reached:
            reached.add(page)
            to_see += named.get(page, ())
    for path in pages:
        if path.startswith("docs/") and path not in reached:
            yield f"{path}: no way of links leads to it from {START}"
