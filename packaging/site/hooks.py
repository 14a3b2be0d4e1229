# SPDX-License-Identifier: Apache-2.0
"""For mkdocs: the site has README as its first page, docs/, and protocol/*/README.md in the folder protocols. Links to
other files of the repository become plain text."""

import pathlib
import posixpath
import re

from mkdocs.structure.files import File

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
PAGES = {"README.md": "index.md",
         **{f"protocol/{file.parent.name}/README.md": f"protocols/{file.parent.name}.md"
            for file in sorted(REPOSITORY.glob("protocol/*/README.md"))}}
SOURCES = {page: source for source, page in PAGES.items()}


def on_files(files, config):
    for source, page in PAGES.items():
        file = File(page, config.docs_dir, config.site_dir, config.use_directory_urls)
        file.abs_src_path = str(REPOSITORY / source)
        files.append(file)
    return files


def page_of(source):
    """The page of a file of the repository; None if the site does not have it."""
    return PAGES.get(source) or (source.removeprefix("docs/") if source.startswith("docs/") else None)


def on_page_markdown(markdown, page, config, files):
    here = page.file.src_path
    source_folder = posixpath.dirname(SOURCES.get(here, f"docs/{here}"))

    def on_the_site(link):
        mark, text, target = link.groups()
        if re.match(r"[a-z]+:|#", target):
            return link.group(0)
        path, _, anchor = target.partition("#")
        place = page_of(posixpath.normpath(posixpath.join(source_folder, path)))
        if place is None:
            return text
        inside = posixpath.relpath(place, posixpath.dirname(here) or ".")
        return f"{mark}[{text}]({inside}{'#' + anchor if anchor else ''})"

    return LINK.sub(on_the_site, markdown)
