# SPDX-License-Identifier: Apache-2.0
"""For mkdocs: README is the first page; links to the repository outside of docs/ become plain text on the site."""

import pathlib
import posixpath
import re

from mkdocs.structure.files import File

DOCS = "docs"
REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")


def on_files(files, config):
    first = File("index.md", config.docs_dir, config.site_dir, config.use_directory_urls)
    first.abs_src_path = str(REPOSITORY / "README.md")
    files.append(first)
    return files


def on_page_markdown(markdown, page, config, files):
    # Paths are relative to the repository's root.
    folder = "" if page.file.src_path == "index.md" else posixpath.join(DOCS, posixpath.dirname(page.file.src_path))

    def on_the_site(link):
        mark, text, target = link.groups()
        if re.match(r"[a-z]+:|#", target):
            return link.group(0)
        path, _, anchor = target.partition("#")
        place = posixpath.normpath(posixpath.join(folder, path))
        if not place.startswith(DOCS + "/"):
            return f"{mark}[{text}](index.md)" if place == "README.md" else text
        inside = posixpath.relpath(place, folder or DOCS) if folder else place.removeprefix(DOCS + "/")
        return f"{mark}[{text}]({inside}{'#' + anchor if anchor else ''})"

    return LINK.sub(on_the_site, markdown)
