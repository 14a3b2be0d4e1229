# SPDX-License-Identifier: Apache-2.0
"""Makes a data set to train with from folders of `sonard render --truth` (docs/offline.md). Needs NumPy and OpenCV
(python3-opencv), for --labels and --config PyYAML (python3-yaml), for HDF5 h5py (python3-h5py).

    python3 -m sonard_client.to_dataset pings more --out set --format coco,yolo --split train=pings val=more
"""

from __future__ import annotations

import argparse
import shutil
import sys
from pathlib import Path
from typing import Optional, Sequence

from .dataset.card import card
from .dataset.choices import Choices, Split
from .dataset.folders import Folder, open_folder, read_config
from .dataset.labels import Labels, labels_of_bodies, read_labels
from .dataset.splits import equal_noise, make_splits

_FORMATS = ("coco", "yolo", "hdf5")


def write(out: Path, splits: Sequence[Split], choices: Choices) -> None:
    """Writes into an empty folder. Counts frames and instances of the splits. Raises ValueError, OSError or ImportError."""
    if "hdf5" in choices.formats:
        from .dataset.hdf5 import write_hdf5

        for split in splits:
            write_hdf5(out, split, choices.labels)
    if {"coco", "yolo"} & set(choices.formats):
        for split in splits:
            split.frames.clear()  # of HDF5, whose masks are others than those of fans
            split.instances.clear()
            _write_pictures(out, split, choices)
    if "yolo" in choices.formats:
        from .dataset.yolo import write_data_yaml

        write_data_yaml(out, [split.name for split in splits], choices.labels.classes)
    (out / "README.md").write_text(card(splits, choices), encoding="utf-8")


def _write_pictures(out: Path, split: Split, choices: Choices) -> None:
    from .dataset.coco import CocoWriter
    from .dataset.pictures import write_pictures
    from .dataset.yolo import YoloWriter

    coco = [CocoWriter(out, split.name, split.folders, choices)] if "coco" in choices.formats else []
    yolo = [YoloWriter(out, split.name)] if "yolo" in choices.formats else []
    for picture in write_pictures(out, split.name, split.folders, choices):
        split.count(picture.frame.folder, picture.instances)
        for writer in (*coco, *yolo):
            writer.add(picture)
    for writer in coco:
        writer.close()


def _labels(file: Optional[Path], folders: Sequence[Folder]) -> Labels:
    bodies = dict.fromkeys(name for folder in folders for name in folder.first().bodies().values())
    if file is None:
        return labels_of_bodies(bodies)
    labels = read_labels(file)
    for pattern in labels.without_body(bodies):
        print(f"to_dataset: {file}: no body is called {pattern}", file=sys.stderr)
    return labels


def _formats(text: str) -> tuple[str, ...]:
    names = tuple(dict.fromkeys(text.split(",")))
    if not set(names) <= set(_FORMATS):
        raise argparse.ArgumentTypeError(f"'{text}': expected one or more of {', '.join(_FORMATS)}, with commas")
    return names


def _pixels(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text} is below 1")
    return value


def _floor(text: str) -> float:
    value = float(text)
    if not -200 <= value < 0:
        raise argparse.ArgumentTypeError(f"{text} is not between -200 and 0")
    return value


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python3 -m sonard_client.to_dataset",
                                     description="Makes a data set to train with from folders of `sonard render --truth`.",
                                     epilog="Exit status: 0 written; 2 invalid command line, or a file could not be read or written.")
    parser.add_argument("folders", metavar="FOLDER", type=Path, nargs="+", help="a folder of sonard render; one trajectory")
    parser.add_argument("--out", metavar="DIR", type=Path, required=True, help="new folder for the data set")
    parser.add_argument("--format", metavar="FORMAT", type=_formats, required=True, help="coco, yolo or hdf5; several with commas")
    parser.add_argument("--picture", choices=("grey", "fan"), default="grey",
                        help="pictures of COCO and YOLO: samples by range and beam (%(default)s), or the fan of --clean-png")
    parser.add_argument("--floor-db", metavar="DB", type=_floor,
                        help="pictures show levels in dB, black at DB below full scale (-70); default: amplitudes")
    parser.add_argument("--labels", metavar="FILE", type=Path,
                        help="YAML, lines of PATTERN: CLASS for names of bodies; others are background. Default: each body is a class")
    parser.add_argument("--min-pixels", metavar="N", type=_pixels, default=1,
                        help="COCO and YOLO leave out bodies with fewer pixels in a picture (%(default)s)")
    parser.add_argument("--split", metavar="NAME=FOLDER[,FOLDER...]", nargs="+", action="extend", default=[],
                        help="names of folders (with * and ?) of a split; default: train=*")
    parser.add_argument("--config", metavar="FILE", type=Path, nargs="+", action="extend", default=[],
                        help="configurations of the folders, for preset and origin (latitude, longitude) in the data set")
    parser.add_argument("--title", default="Images of a simulated sonar", help="title of README.md")
    parser.add_argument("--licence", metavar="TEXT", default="", help="licence of the data set")
    return parser


def main(arguments: Optional[Sequence[str]] = None) -> int:
    options = _parser().parse_args(arguments)
    try:
        configs = dict(read_config(path) for path in options.config)
        folders = [open_folder(path, configs) for path in options.folders]
        splits = make_splits(folders, options.split)
        pair = equal_noise(splits)
        if pair is not None:
            print(f"to_dataset: folders {pair[0]} and {pair[1]} have one seed, so frame k has the same noise in both: render one "
                  "again with another --seed", file=sys.stderr)
        choices = Choices(_labels(options.labels, folders), options.format, options.picture, options.floor_db, options.min_pixels,
                          options.title, options.licence)
        options.out.mkdir(parents=True)
        try:
            write(options.out, splits, choices)
        except BaseException:
            shutil.rmtree(options.out)  # no half of a data set
            raise
    except FileExistsError as error:
        print(f"to_dataset: {error.filename} exists", file=sys.stderr)
        return 2
    except ImportError as error:
        print(f"to_dataset: {error} (apt install python3-opencv python3-yaml python3-h5py)", file=sys.stderr)
        return 2
    except KeyError as error:
        print(f"to_dataset: a JSON file of these folders lacks {error}", file=sys.stderr)
        return 2
    except (OSError, ValueError) as error:
        print(f"to_dataset: {error}", file=sys.stderr)
        return 2
    for split in splits:
        print(f"{options.out}: {split.name} {sum(split.frames.values())} images, {sum(split.instances.values())} labels")
    return 0


if __name__ == "__main__":
    sys.exit(main())
