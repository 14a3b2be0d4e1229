# SPDX-License-Identifier: Apache-2.0
"""Checks by external programs: clang-format, shellcheck, codespell, mkdocs, doxygen, clang-tidy."""

import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import tempfile

from tree import CPP

SPELLED = (*CPP, ".md", ".py", ".txt", ".cmake", ".yaml", ".yml", ".lua", ".cs", ".js", ".proto", "schema.json")


def run(tree, command, files, batch=40):
    """Runs the command on batches of the files, on all cores; yields its output if it fails."""
    groups = [files[start:start + batch] for start in range(0, len(files), batch)]

    def one(group):
        return subprocess.run([*command, *group], cwd=tree.root, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for result in pool.map(one, groups):
            if result.returncode:
                yield result.stdout.strip() or f"{command[0]} ended with {result.returncode}"


def format_complaints(tree, paths):
    formatted = (*CPP, ".glsl")
    yield from run(tree, ["clang-format", "--dry-run", "-Werror"], [path for path in paths if path.endswith(formatted)])


def shell_complaints(tree):
    scripts = [path for path in tree.files if tree.interpreter(path) in ("bash", "sh")]
    yield from run(tree, ["shellcheck"], scripts)


def spelling_complaints(tree, ignored):
    texts = [path for path in tree.texts() if path.endswith(SPELLED) or tree.interpreter(path)]
    yield from run(tree, ["codespell", "--ignore-words", ignored], texts, batch=1000)


def site_complaints(tree):
    """The pages of docs/ build strictly as a site, and every page is in its contents."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(["mkdocs", "build", "--strict", "--config-file", "packaging/site/mkdocs.yml", "--site-dir", folder],
                              cwd=tree.root, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode or "not included in the" in done.stdout:
        yield done.stdout


def reference_complaints(tree):
    """The reference of the protocol libraries builds; its settings make a warning an error."""
    settings = (tree.root / "packaging/reference/Doxyfile").read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(["doxygen", "-"], cwd=tree.root, input=f"{settings}\nOUTPUT_DIRECTORY = {folder}\n", stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        yield done.stdout


def singles(entry):
    """The commands for each source that a unity build includes, or the one command itself."""
    if "/Unity/unity_" not in entry["file"]:
        return [entry]
    try:
        text = pathlib.Path(entry["file"]).read_text(encoding="utf-8")
    except OSError:
        return []
    return [entry | {"file": source, "command": entry["command"].replace(entry["file"], source)}
            for source in re.findall(r'^#include "(.*)"', text, re.MULTILINE)]


def compile_commands(tree):
    """The commands of the clang build, or of the release or dev build, without precompiled headers, which only their
    own compiler can read. Empty if there is no build."""
    for preset in ("checked", "release", "dev"):
        path = tree.root / "build" / preset / "compile_commands.json"
        if path.is_file():
            entries = [single for entry in json.loads(path.read_text(encoding="utf-8")) for single in singles(entry)]
            for entry in entries:
                entry["command"] = re.sub(r" -Winvalid-pch| (-Xclang )?-include(-pch)? (-Xclang )?\S*cmake_pch\S*", "",
                                          entry["command"])
            return entries
    return []


def tidy_complaints(tree, paths):
    entries = compile_commands(tree)
    compiled = {os.path.relpath(entry["file"], tree.root) for entry in entries}
    sources = [path for path in paths if path in compiled]
    if not sources:
        return
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "compile_commands.json"), "w", encoding="utf-8") as file:
            json.dump(entries, file)
        yield from run(tree, ["clang-tidy", "--quiet", "--warnings-as-errors=*", "-p", folder], sources, batch=1)
