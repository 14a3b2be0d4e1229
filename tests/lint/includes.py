# SPDX-License-Identifier: Apache-2.0
"""Includes of the product: its folders have no circles, and their arrows point one way."""

import collections
import os
import re

from tree import CPP, ROOMS

INCLUDE = re.compile(r'^\s*#\s*include\s+(?:"([^"]+)"|<([^>]+)>)')

def devices():
    """The devices in cmake/devices.cmake."""
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "cmake", "devices.cmake")
    with open(path, encoding="utf-8") as file:
        return re.search(r"set\(SONARD_DEVICES([^)]*)\)", file.read()).group(1).split()


DEVICES = devices()

# Folders that the files of a folder may include. The longest matching prefix decides; a folder may include itself and
# its subfolders.
MAY_INCLUDE = {
    "common": (),
    "protocol": ("protocol",),
    # Devices do not depend on each other, but may use a protocol of several devices, or a log format of their users.
    **{f"protocol/{device}": ("protocol/common", "protocol/ping", "protocol/glf") for device in DEVICES},
    "renderer": ("renderer", "common/text"),
    # Clients also draw pictures; they use no other part of the renderer.
    "renderer/picture": (),
    "server": ("server", "renderer", "protocol", "common"),
    "clients": ("clients", "protocol", "renderer/picture", "common"),
}

# External libraries that a folder must not include.
MAY_NOT_INCLUDE = {
    "protocol": ("boost/", "spdlog/", "yaml-cpp/", "osg", "opencv", "GL/", "EGL/", "embree", "sys/socket.h"),
    "renderer": ("boost/", "spdlog/", "yaml-cpp/", "google/protobuf/", "sys/socket.h"),
    "server": ("osg", "embree", "GL/", "EGL/"),
    "clients": ("osg", "embree", "GL/", "EGL/"),
}


def within(folder, parent):
    return folder == parent or folder.startswith(parent + "/")


def rule(table, folder):
    """The longest matching prefix, or None, and its entry, or ()."""
    prefix = max((prefix for prefix in table if within(folder, prefix)), key=len, default=None)
    return prefix, table.get(prefix, ())


def read_includes(tree):
    """(file, line, folder, header) of each include of the product; the folder is None for external headers."""
    for path in tree.files:
        if not path.endswith(CPP) or path.split("/")[0] not in ROOMS:
            continue
        for number, line in enumerate(tree.text(path).splitlines(), 1):
            found = INCLUDE.match(line)
            if not found:
                continue
            if found[2]:
                yield path, number, None, found[2]
                continue
            header = found[1]
            beside = os.path.normpath(os.path.join(os.path.dirname(path), header))
            if not (tree.root / header).is_file() and (tree.root / beside).is_file():
                header = beside
            if header.split("/")[0] in ROOMS:
                yield path, number, os.path.dirname(header), header


def layer_complaints(tree):
    for path, number, folder, header in read_includes(tree):
        own = os.path.dirname(path)
        if folder is None:
            _, refused = rule(MAY_NOT_INCLUDE, own)
            if header.startswith(refused):
                yield f"{path}:{number}: {own} keeps out of <{header}>"
            continue
        prefix, allowed = rule(MAY_INCLUDE, own)
        if prefix and not any(within(folder, place) for place in (prefix, *allowed)):
            yield f"{path}:{number}: {own} may not include {header}"


def arrows(tree):
    """{(from, to): ['file:line includes header', ...]} between different folders."""
    found = collections.defaultdict(list)
    for path, number, folder, header in read_includes(tree):
        own = os.path.dirname(path)
        if folder is not None and folder != own:
            found[own, folder].append(f"{path}:{number} includes {header}")
    return dict(found)


def shortest_circle(pairs):
    """A shortest circle of arrows as a list of (from, to), or None."""
    following = collections.defaultdict(list)
    for start, end in sorted(pairs):
        following[start].append(end)
    best = None
    for first in sorted(following):
        came_from = {}
        queue = collections.deque([first])
        while queue and first not in came_from:
            here = queue.popleft()
            for there in following[here]:
                if there not in came_from:
                    came_from[there] = here
                    queue.append(there)
        if first not in came_from:
            continue
        circle = []
        end = first
        while not circle or end != first:
            circle.insert(0, (came_from[end], end))
            end = came_from[end]
        if best is None or len(circle) < len(best):
            best = circle
    return best


def cycle_complaints(found):
    """Circles of folders, the shortest first. The arrow with the fewest includes is removed before the next search."""
    left = dict(found)
    while circle := shortest_circle(left):
        text = "these folders include each other in a circle:"
        for pair in circle:
            text += f"\n  {pair[0]} -> {pair[1]} ({len(left[pair])})"
            text += "".join(f"\n    {where}" for where in left[pair][:3])
        thinnest = min(circle, key=lambda pair: len(left[pair]))
        yield text + f"\n  the thinnest arrow is {thinnest[0]} -> {thinnest[1]}"
        del left[thinnest]


SOURCES = re.compile(r"(sonard_library|sonard_program|add_executable|target_sources)\(\s*(\S+)\s+([^)]*)\)")


def library_complaints(tree):
    """Folders whose sources are not all in one library or in programs. The variable `device` of a CMake loop over
    SONARD_DEVICES stands for each device."""
    folders = collections.defaultdict(set)
    for path in tree.files:
        if path.endswith(".cpp") and path.split("/")[0] in ROOMS:
            folders[os.path.dirname(path)].add(os.path.basename(path))
    for folder, sources in folders.items():
        path = f"{folder}/CMakeLists.txt"
        if path not in tree.files:
            yield f"{folder}: has sources and no CMakeLists.txt"
            continue
        calls = SOURCES.findall(tree.text(path))
        calls = [(kind, name, " ".join(names.replace("${device}", device) for device in DEVICES))
                 for kind, name, names in calls]
        libraries = [name for kind, name, _ in calls if kind == "sonard_library"]
        if len(libraries) > 1:
            yield f"{path}: {len(libraries)} libraries, {' and '.join(libraries)}; a folder is one"
        listed = {source for _, _, names in calls for source in names.split() if source.endswith(".cpp")}
        for source in sorted(sources - listed):
            yield f"{path}: {source} is in no library and no program"
        for source in sorted(name for name in listed if "/" in name and not name.startswith("$")):
            yield f"{path}: {source} lies in another folder"
