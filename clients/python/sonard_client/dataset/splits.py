# SPDX-License-Identifier: Apache-2.0
"""Splits of folders into training, validation and so on. A folder, which is one trajectory, is never divided: neighbouring
frames resemble each other."""

from __future__ import annotations

import re
from fnmatch import fnmatchcase
from typing import Optional, Sequence

from .choices import Split
from .folders import Folder


def make_splits(folders: Sequence[Folder], rules: Sequence[str]) -> list[Split]:
    """From rules NAME=PATTERN[,PATTERN...] of folders' names; without a rule, all are `train`. Raises ValueError."""
    names = [folder.name for folder in folders]
    double = next((name for name in names if names.count(name) > 1), None)
    if double is not None:
        raise ValueError(f"two folders are called {double}")
    splits: dict[str, Split] = {}
    for rule in rules or ["train=*"]:
        name, _, patterns = rule.partition("=")
        if not re.fullmatch(r"[A-Za-z0-9_-]+", name) or not patterns:
            raise ValueError(f"--split {rule}: expected NAME=FOLDER[,FOLDER...]")
        for pattern in patterns.split(","):
            found = [folder for folder in folders if fnmatchcase(folder.name, pattern)]
            if not found:
                raise ValueError(f"--split {rule}: no folder is called {pattern}")
            splits.setdefault(name, Split(name, [])).folders.extend(found)
    for name in names:
        of = [split.name for split in splits.values() for folder in split.folders if folder.name == name]
        if len(of) != 1:
            raise ValueError(f"folder {name} is in {len(of)} splits ({', '.join(of) or 'none'}), expected 1")
    _check_trajectories(list(splits.values()))
    return list(splits.values())


def _check_trajectories(splits: Sequence[Split]) -> None:
    """One trajectory in one world must not be in two splits, even with other noise."""
    seen: dict[tuple[Optional[str], ...], tuple[str, str]] = {}
    for split in splits:
        for folder in split.folders:
            key = tuple(folder.run.get(name) for name in ("world_crc32", "trajectory_crc32"))
            other_split, other = seen.setdefault(key, (split.name, folder.name))
            if other_split != split.name:
                raise ValueError(f"folders {other} ({other_split}) and {folder.name} ({split.name}) are of the same trajectory "
                                 "and world: put both into one split")


def equal_noise(splits: Sequence[Split]) -> Optional[tuple[str, str]]:
    """Two folders of different splits with the same seed: frame k has the same noise in both."""
    seen: dict[int, tuple[str, str]] = {}
    for split in splits:
        for folder in split.folders:
            for seed in folder.seeds():
                other_split, other = seen.setdefault(seed, (split.name, folder.name))
                if other_split != split.name:
                    return other, folder.name
    return None
