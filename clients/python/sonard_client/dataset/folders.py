# SPDX-License-Identifier: Apache-2.0
"""Folders of `sonard render --truth` (docs/offline.md, "Files"). Functions raise ValueError or OSError, with the file."""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Iterator, Optional
from xml.etree import ElementTree

import numpy as np

Array = Any  # a NumPy array
_LEVELS = ("micron", "ping1d", "ping360")  # their samples are levels in dB already


@dataclass(frozen=True)
class Frame:
    folder: str
    name: str
    path: Path
    facts: dict[str, Any]  # of its JSON

    def samples(self) -> Array:
        """Row per range bin, near first; column per beam or line; uint8 or uint16."""
        return self._table(self.facts["samples"]["file"])

    def mask(self) -> Array:
        """IDs of bodies, in the shape of the samples."""
        mask = self._table(self.facts["truth"]["file"])
        if list(mask.shape) != self.facts["samples"]["shape"]:
            raise ValueError(f"{self.path / self.facts['truth']['file']}: has not the shape of the samples")
        return mask

    def bodies(self) -> dict[int, str]:
        return {body["id"]: body["name"] for body in self.facts["truth"]["bodies"]}

    def picture(self, kind: str, floor_db: Optional[float]) -> tuple[Array, Array]:
        """A grey picture of 8 bits and its mask. `grey`: the samples; `fan`: the fan of --clean-png. With a floor, the
        brightness is the level, from floor_db (black) to full scale (white); without, the amplitude."""
        if floor_db is not None and self.facts["type"] in _LEVELS:
            raise ValueError(f"{self.path}: samples of a {self.facts['type']} are levels already: leave out the floor")
        if kind == "grey":
            return _eight_bits(self.samples(), floor_db), self.mask()
        fan = self.facts.get("clean_pictures", {}).get("fan", {})
        if "mask" not in fan:
            raise ValueError(f"{self.path}: has no fans with masks: render it with --truth and --clean-png")
        return _eight_bits(self._image(fan["file"]), floor_db), self._image(fan["mask"])

    def _table(self, name: str) -> Array:
        try:
            table = np.load(self.path / name, allow_pickle=False)
        except (ValueError, EOFError) as error:
            raise ValueError(f"{self.path / name}: {error}") from None
        if table.ndim != 2 or table.dtype not in (np.uint8, np.uint16):
            raise ValueError(f"{self.path / name}: is not a table of 8-bit or 16-bit numbers")
        return table

    def _image(self, name: str) -> Array:
        import cv2

        image = cv2.imdecode(np.fromfile(self.path / name, np.uint8), cv2.IMREAD_UNCHANGED)
        if image is None or image.ndim != 2:
            raise ValueError(f"{self.path / name}: is not a grey picture")
        return image


@dataclass(frozen=True)
class Config:
    """What a data set states about the configuration of a folder."""

    name: str = ""
    preset: str = ""
    origin: Optional[dict[str, float]] = None  # of the world on Earth: latitude_deg, longitude_deg, altitude_m


@dataclass(frozen=True)
class Folder:
    path: Path
    run: dict[str, Any]  # run.json
    config: Config = field(default_factory=Config)

    @property
    def name(self) -> str:
        return self.path.resolve().name

    def frames(self) -> Iterator[Frame]:
        """In order of their names, which is the order of time."""
        for file in sorted(self.path.glob("*_[0-9]*.json")):
            facts = _json(file)
            if not facts.get("truth"):
                raise ValueError(f"{self.path}: has no masks: render it with --truth")
            yield Frame(self.name, file.stem, self.path, facts)

    def first(self) -> Frame:
        return next(self.frames())

    def seeds(self) -> list[int]:
        """Of speckle and noise, in the order of frames."""
        return sorted({frame.facts["seed"] for frame in self.frames()})


def open_folder(path: Path, configs: dict[str, Config]) -> Folder:
    """A complete folder. `configs` by the CRC-32 that run.json names."""
    run = _json(path / "run.json")
    frames = sum(1 for _ in path.glob("*_[0-9]*.json"))
    if frames == 0 or frames != run.get("frames"):
        raise ValueError(f"{path}: has {frames} of {run.get('frames')} frames: repeat the command that rendered it")
    return Folder(path, run, configs.get(run.get("config_crc32", ""), Config()))


def read_config(path: Path) -> tuple[str, Config]:
    """The CRC-32 of a configuration, and what it states. Needs PyYAML."""
    import yaml

    data = path.read_bytes()
    try:
        content = yaml.safe_load(data)
        world = content.get("world") or {}
        world = world if isinstance(world, dict) else {}
        preset = (content.get("sampling") or {}).get("preset", "default")
    except (yaml.YAMLError, AttributeError) as error:
        raise ValueError(f"{path}: is not a configuration of sonard: {error}") from None
    origin = world.get("origin")
    if origin is None and "file" in world:
        origin = _origin_of(path.parent / world["file"])
    return f"{zlib.crc32(data):08x}", Config(path.name, preset, {"altitude_m": 0.0, **origin} if origin else None)


def _origin_of(world: Path) -> Optional[dict[str, float]]:
    """<spherical_coordinates> as sonard reads it (docs/worlds.md, "Place on Earth")."""
    try:
        place = ElementTree.parse(world).find("world/spherical_coordinates")
    except ElementTree.ParseError as error:
        raise ValueError(f"{world}: {error}") from None
    if place is None:
        return None
    if float(place.findtext("heading_deg", "0")) != 0 or place.findtext("world_frame_orientation", "ENU").strip() != "ENU":
        return None
    return {"latitude_deg": float(place.findtext("latitude_deg", "0")),
            "longitude_deg": float(place.findtext("longitude_deg", "0")),
            "altitude_m": float(place.findtext("elevation", "0"))}


def _json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except json.JSONDecodeError as error:
        raise ValueError(f"{path}: {error}") from None
    if not isinstance(content, dict):
        raise ValueError(f"{path}: is not a file of sonard render")
    return content


def _eight_bits(samples: Array, floor_db: Optional[float]) -> Array:
    full = np.iinfo(samples.dtype).max
    codes = np.arange(full + 1) / full
    if floor_db is not None:
        codes = np.clip(1 - 20 * np.log10(np.maximum(codes, 1e-9)) / floor_db, 0, 1)
    return np.rint(255 * codes).astype(np.uint8)[samples]
