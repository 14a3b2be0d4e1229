# SPDX-License-Identifier: Apache-2.0
"""README.md of a data set."""

from __future__ import annotations

from typing import Any, Iterable, Sequence

from .choices import Choices, Split
from .folders import Folder
from .splits import equal_noise

_ERRORS = {"fast": "5 %", "default": "1.25 %"}  # docs/accuracy.md
_FILES = {
    "coco": "- `annotations/instances_SPLIT.json`: COCO. `file_name` is in `images/SPLIT`. A mask is polygons along the edges of "
            "pixels, or run lengths if it has holes. `body` names the body; `sonard` holds pose, stamp, seed and scale.",
    "yolo": "- `labels/SPLIT`: YOLO, class x y width height. `segments/SPLIT`: class and polygon; parts and holes are joined by "
            "lines without area. To train with polygons, rename `segments` to `labels`. `data.yaml` lists splits and classes.",
    "hdf5": "- `SPLIT.h5`: HDF5, a group per folder: `samples`, `masks` (IDs of `bodies`; `class_of_body`, 0 is background), "
            "`bearings_rad` (positive to port), `ranges_m`, `stamps_s`, `T_world_sonar` (x y z qx qy qz qw); the attribute `run`. A sweep "
            "of a scanning head has its own number of `columns`; the rest is 0 or NaN."}
_PIXELS = {
    "grey": "Row y, column x is the sample of range bin y (near first) and beam x (port first).",
    "fan": "The fan seen from above: range is hypot(x - ax, y - ay) `metres_per_px`, bearing is atan2(ax - x, ay - y) to port, with "
           "(ax, ay) = `apex_px`."}


def card(splits: Sequence[Split], choices: Choices) -> str:
    folders = [folder for split in splits for folder in split.folders]
    frames = sum(sum(split.frames.values()) for split in splits)
    programs = ", ".join(sorted({folder.run["program"] for folder in folders}))
    with_pictures = {"coco", "yolo"} & set(choices.formats)
    parts = [f"# {choices.title}", f"{frames} images of a simulated sonar, rendered by {programs}. No real sonar recorded them.",
             "## Folders", _folder_table(splits), *_seed_notes(splits), "## Classes", _class_table(splits, choices), "## Files",
             "\n".join(_FILES[name] for name in choices.formats)]
    if with_pictures:
        parts += [f"Pictures are `{choices.picture}`, 8 bits. {_PIXELS[choices.picture]} {_brightness(choices)}"]
    parts += ["A mask has the body with the strongest direct echo in each bin. It has sharp beams and a point pulse, so an echo is "
              "wider than its mask. Shadow and open water are background. Corners of polygons and boxes count from the corner of the "
              "picture: half a pixel before the middle of pixel (0, 0).", "## Error", _error(folders), "## Licence",
              choices.licence or "Not stated."]
    return "\n\n".join(parts) + "\n"


def _table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(str(cell).replace("|", "\\|") for cell in line) + " |" for line in lines)


def _folder_table(splits: Sequence[Split]) -> str:
    rows = []
    for split in splits:
        for folder in split.folders:
            run, first = folder.run, folder.first().facts
            origin = folder.config.origin
            rows.append([split.name, folder.name, split.frames[folder.name], f"{first['type']} ({run['head']})",
                         f"{first['geometry']['range_m']:.2f}", _numbers(folder.seeds()), folder.config.name or "not given",
                         f"{run['config_crc32']} {run['world_crc32']} {run['trajectory_crc32']}",
                         f"{origin['latitude_deg']}, {origin['longitude_deg']}" if origin else "none"])
    return _table(["split", "folder", "images", "head", "range, m", "seed", "configuration",
                   "CRC-32 of configuration, world, trajectory", "origin (latitude, longitude)"], rows)


def _seed_notes(splits: Sequence[Split]) -> list[str]:
    pair = equal_noise(splits)
    return [] if pair is None else [f"Folders {pair[0]} and {pair[1]} have one seed, so image k has the same noise in both."]


def _class_table(splits: Sequence[Split], choices: Choices) -> str:
    bodies: dict[int, dict[str, None]] = {}
    for folder in (folder for split in splits for folder in split.folders):
        for name in folder.first().bodies().values():
            index = choices.labels.index_of(name)
            if index is not None:
                bodies.setdefault(index, {})[name] = None
    return _table(["class", "bodies", *(f"in {split.name}" for split in splits)],
                  [[name, ", ".join(bodies.get(index, {})), *(split.instances[index] for split in splits)]
                   for index, name in enumerate(choices.labels.classes)])


def _brightness(choices: Choices) -> str:
    if choices.floor_db is None:
        return "Brightness is the sample."
    return f"Brightness is the level in dB, from {choices.floor_db:g} dB (black) to full scale (white)."


def _error(folders: Sequence[Folder]) -> str:
    presets = sorted({folder.config.preset for folder in folders})
    promises = [f"`sampling.preset: {name}`: " + (f"at most {_ERRORS[name]}" if name in _ERRORS else "not stated here")
                for name in presets if name]
    if "" in presets:
        promises.append("the preset of a folder without a configuration is not known: at most "
                        f"{_ERRORS['fast']} (`fast`) or {_ERRORS['default']} (`default`)")
    return ("Relative RMS error of the mean echo, before array, pulse, receiver and noise, in bins above 1 % of the strongest of their "
            f"beam: {'; '.join(promises)}. This is the error of rendering, not the difference from a real sonar. The page "
            "`docs/accuracy.md` of sonard (in its package: `/usr/share/doc/sonard/docs/accuracy.md`) has the conditions. The error of "
            "masks is not stated.")


def _numbers(numbers: Sequence[int]) -> str:
    return ", ".join(map(str, numbers))
