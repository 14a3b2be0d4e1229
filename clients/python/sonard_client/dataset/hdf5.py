# SPDX-License-Identifier: Apache-2.0
"""HDF5: SPLIT.h5 with a group for each folder. Needs h5py (python3-h5py)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .choices import Split
from .folders import Folder, Frame
from .labels import Labels


def write_hdf5(out: Path, split: Split, labels: Labels) -> None:
    with h5py.File(out / f"{split.name}.h5", "x") as file:
        file.attrs["classes"] = json.dumps(labels.classes)
        for folder in split.folders:
            group = file.create_group(folder.name)
            frames = list(folder.frames())
            _write_attributes(group, folder, frames[0])
            _write_images(group, folder, frames, split, labels)
            _write_geometry(group, frames)
            _write_bodies(group, frames[0].bodies(), labels)


def _write_images(group: Any, folder: Folder, frames: list[Frame], split: Split, labels: Labels) -> None:
    """One chunk per frame, so that a loader reads no more than the frame. Sweeps of a sector differ in their number of columns:
    `columns` are those of each frame, the others are 0."""
    columns = [frame.facts["samples"]["shape"][1] for frame in frames]
    group["columns"] = np.array(columns)
    first = frames[0].samples()
    shape = (first.shape[0], max(columns))
    sets = [group.create_dataset(name, (len(frames), *shape), dtype, chunks=(1, *shape), compression="gzip", shuffle=True)
            for name, dtype in (("samples", first.dtype), ("masks", frames[0].mask().dtype))]
    for k, frame in enumerate(frames):
        samples, mask = frame.samples(), frame.mask()
        if samples.shape[0] != shape[0] or samples.dtype != first.dtype:
            raise ValueError(f"{folder.path}: {frame.name} and {frames[0].name} have different numbers of bins or bits")
        sets[0][k, :, : columns[k]], sets[1][k, :, : columns[k]] = samples, mask
        split.count(folder.name, labels.instances(frame, mask))


def _write_geometry(group: Any, frames: list[Frame]) -> None:
    """A row per frame; for a scanning head, with a pose, stamp and bearing per column."""
    first = frames[0].facts
    group["ranges_m"] = (np.arange(first["samples"]["shape"][0]) + 0.5) * first["geometry"]["line_step_m"]  # middles of rows
    group["bearings_rad"] = _rows([frame.facts["geometry"]["bearings_rad"] for frame in frames])
    group["stamps_s"] = _rows([frame.facts.get("stamps_s", frame.facts["stamp_s"]) for frame in frames])
    for name in ("T_world_sonar", "T_world_vehicle"):
        group[name] = _rows([_pose(frame.facts[name]) for frame in frames])


def _rows(values: list[Any]) -> Any:
    """One array. Shorter rows are filled with NaN."""
    rows = [np.array(value, float) for value in values]
    filled = np.full((len(rows), *np.max([row.shape for row in rows], axis=0)), np.nan)
    for k, row in enumerate(rows):
        filled[(k, *map(slice, row.shape))] = row
    return filled


def _write_bodies(group: Any, bodies: dict[int, str], labels: Labels) -> None:
    """By the IDs of masks: names, and places in the root's `classes` from 1 on; 0: background."""
    names = [bodies.get(k, "") for k in range(max(bodies, default=0) + 1)]
    indices = [labels.index_of(name) if name else None for name in names]
    group.create_dataset("bodies", data=names, dtype=h5py.string_dtype())
    group["class_of_body"] = np.array([0 if index is None else index + 1 for index in indices], np.uint16)


def _write_attributes(group: Any, folder: Folder, first: Frame) -> None:
    group.attrs["head"], group.attrs["type"] = first.facts["head"], first.facts["type"]
    group.attrs["seeds"] = folder.seeds()
    group.attrs["run"] = json.dumps(folder.run)
    for key, value in (folder.config.origin or {}).items():
        group.attrs[f"origin_{key}"] = value


def _pose(pose: Any) -> Any:
    """x, y, z, qx, qy, qz, qw; a row per column of a scanning head."""
    return [_pose(one) for one in pose] if isinstance(pose, list) else [*pose["position_m"], *pose["quaternion_xyzw"]]
