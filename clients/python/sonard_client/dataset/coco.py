# SPDX-License-Identifier: Apache-2.0
"""COCO: images/SPLIT and annotations/instances_SPLIT.json."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from .choices import Choices
from .folders import Folder
from .labels import Instance
from .outlines import box, outlines, run_lengths
from .pictures import Picture


def segmentation(mask: Any) -> Any:
    """Polygons along the edges of pixels, or uncompressed run lengths if the mask has holes."""
    outer, holes = outlines(mask)
    if holes:
        return {"size": list(mask.shape), "counts": run_lengths(mask)}
    return [loop.ravel().tolist() for loop in outer]


class CocoWriter:
    def __init__(self, out: Path, split: str, folders: list[Folder], choices: Choices) -> None:
        self._file = out / "annotations" / f"instances_{split}.json"
        self._images: list[dict[str, Any]] = []
        self._annotations: list[dict[str, Any]] = []
        self._content = {
            "info": {"description": choices.title, "contributor": folders[0].run["program"],
                     "sonard": {folder.name: _folder_facts(folder) for folder in folders}},
            "licenses": [{"id": 1, "name": choices.licence or "not stated", "url": ""}],
            "categories": [{"id": k, "name": name, "supercategory": ""} for k, name in enumerate(choices.labels.classes, 1)],
            "images": self._images, "annotations": self._annotations}

    def add(self, picture: Picture) -> None:
        image = len(self._images) + 1
        self._images.append({"id": image, "file_name": picture.file_name, "width": picture.width, "height": picture.height,
                             "license": 1, "sonard": _frame_facts(picture)})
        for instance in picture.instances:
            self._annotations.append(_annotation(instance, image, len(self._annotations) + 1))

    def close(self) -> None:
        self._file.parent.mkdir(exist_ok=True)
        with open(self._file, "x", encoding="utf-8") as file:
            json.dump(self._content, file)


def _annotation(instance: Instance, image: int, number: int) -> dict[str, Any]:
    body, category, mask = instance
    return {"id": number, "image_id": image, "category_id": category + 1, "segmentation": segmentation(mask),
            "bbox": list(box(mask)), "area": int(mask.sum()), "iscrowd": 0, "body": body}


def _frame_facts(picture: Picture) -> dict[str, Any]:
    """What pose and time gave the picture. The scale of a fan is its own."""
    frame = picture.frame
    facts = {key: frame.facts[key] for key in ("frame", "stamp_s", "seed", "T_world_sonar") if key in frame.facts}
    fan = frame.facts.get("clean_pictures", {}).get("fan")
    return {"folder": frame.folder, **facts, "line_step_m": frame.facts["geometry"]["line_step_m"],
            **({key: fan[key] for key in ("apex_px", "metres_per_px")} if fan else {})}


def _folder_facts(folder: Folder) -> dict[str, Any]:
    """What is the same in all frames. The bearings of columns; those of a scanning head are of its first turn."""
    first = folder.first().facts
    return {"run": folder.run, "type": first["type"], "origin": folder.config.origin,
            "bearings_rad": first["geometry"]["bearings_rad"]}
