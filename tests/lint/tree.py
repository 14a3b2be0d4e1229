# SPDX-License-Identifier: Apache-2.0
"""The files to check: files of the working tree that git does not ignore, and files that differ from a commit."""

import fnmatch
import pathlib
import subprocess

CPP = (".cpp", ".hpp", ".h")
# Rooms of the product; rules for includes apply in them.
ROOMS = ("common", "protocol", "renderer", "server", "clients")
# Files from other projects or from programs: bytes, pictures, worlds, locked versions.
DATA = ("tests/data/*", "tests/fuzz/corpus/*", "configs/worlds/meshes/*", "*/package-lock.json", "LICENSE")


class Tree:
    """A git working tree. Paths are relative to its root, with slashes."""

    def __init__(self, root):
        self.root = pathlib.Path(root)
        names = self.git("ls-files", "-z", "--cached", "--others", "--exclude-standard").split("\0")
        self.files = [path for path in sorted(names) if path and (self.root / path).is_file()]
        self._texts = {}

    def git(self, *arguments):
        return subprocess.run(["git", *arguments], cwd=self.root, check=True, capture_output=True, text=True).stdout

    def changed_since(self, base):
        """Files that differ from the merge base with `base`, committed or not."""
        point = self.git("merge-base", base, "HEAD").strip()
        changed = self.git("diff", "--name-only", "-z", "--diff-filter=d", point).split("\0")
        changed += self.git("ls-files", "-z", "--others", "--exclude-standard").split("\0")
        return [path for path in self.files if path in set(changed)]

    def text(self, path):
        """The text of a file; None if it is not UTF-8."""
        if path not in self._texts:
            try:
                self._texts[path] = (self.root / path).read_text(encoding="utf-8")
            except UnicodeDecodeError:
                self._texts[path] = None
        return self._texts[path]

    def texts(self):
        """Paths of all text files that people write."""
        return [path for path in self.files if not matches(path, DATA) and self.text(path) is not None]

    def interpreter(self, path):
        """The program that runs a script, such as 'python3' or 'bash', from its name or first line; else empty."""
        if path.endswith((".py", ".sh")):
            return "python3" if path.endswith(".py") else "bash"
        with (self.root / path).open("rb") as file:
            first = file.readline(80)
        if not first.startswith(b"#!"):
            return ""
        return first.decode("ascii", "replace").split("/")[-1].split()[-1]


def matches(path, patterns):
    """True if any of the patterns matches. A star also matches slashes."""
    return any(fnmatch.fnmatchcase(path, pattern) for pattern in patterns)
