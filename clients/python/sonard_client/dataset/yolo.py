# SPDX-License-Identifier: Apache-2.0
"""YOLO: images/SPLIT with labels/SPLIT (boxes), segments/SPLIT (polygons) and data.yaml."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Iterable

from .outlines import box, one_polygon, outlines
from .pictures import Picture


class YoloWriter:
    def __init__(self, out: Path, split: str) -> None:
        self._boxes, self._segments = out / "labels" / split, out / "segments" / split
        for place in (self._boxes, self._segments):
            place.mkdir(parents=True)

    def add(self, picture: Picture) -> None:
        boxes, segments = [], []
        for _, index, mask in picture.instances:
            x, y, width, height = box(mask)
            boxes.append(_line(index, [x + width / 2, y + height / 2, width, height], picture))
            outer, holes = outlines(mask)
            segments.append(_line(index, one_polygon(outer + holes).ravel().tolist(), picture))
        name = Path(picture.file_name).with_suffix(".txt")
        (self._boxes / name).write_text("".join(boxes), encoding="utf-8")
        (self._segments / name).write_text("".join(segments), encoding="utf-8")


def write_data_yaml(out: Path, splits: Iterable[str], classes: list[str]) -> None:
    lines = [f"{split}: images/{split}\n" for split in splits] + ["names:\n"]
    lines += [f"  {index}: {json.dumps(name)}\n" for index, name in enumerate(classes)]
    (out / "data.yaml").write_text("".join(lines), encoding="utf-8")


def _line(index: int, pixels: Iterable[float], picture: Picture) -> str:
    """x and y in turn, as shares of width and height."""
    size = (picture.width, picture.height)
    return " ".join([str(index), *(f"{value / size[k % 2]:.7g}" for k, value in enumerate(pixels))]) + "\n"
