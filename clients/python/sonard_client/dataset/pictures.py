# SPDX-License-Identifier: Apache-2.0
"""The pictures of a data set: DIR/images/SPLIT/FOLDER-ping_000000.png."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterator

import cv2

from .choices import Choices
from .folders import Folder, Frame
from .labels import Instance


@dataclass(frozen=True)
class Picture:
    frame: Frame
    file_name: str
    width: int
    height: int
    instances: list[Instance]


def write_pictures(out: Path, split: str, folders: list[Folder], choices: Choices) -> Iterator[Picture]:
    """Writes the pictures of a split, one after the other. Raises OSError."""
    place = out / "images" / split
    place.mkdir(parents=True)
    for folder in folders:
        for frame in folder.frames():
            image, mask = frame.picture(choices.picture, choices.floor_db)
            if image.shape != mask.shape:
                raise ValueError(f"{folder.path}: {frame.name} has a picture and a mask of different sizes")
            name = f"{frame.folder}-{frame.name}.png"
            (place / name).write_bytes(_png(image))
            yield Picture(frame, name, mask.shape[1], mask.shape[0],
                          list(choices.labels.instances(frame, mask, choices.least_pixels)))


def _png(image: Any) -> bytes:
    return bytes(cv2.imencode(".png", image)[1])
