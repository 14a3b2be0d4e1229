# SPDX-License-Identifier: Apache-2.0
"""Compares two images of sonars by the five measures of Cerqueira et al. 2017, 4.3 and table 4
(docs/sonarview.md). Needs NumPy and OpenCV (python3-opencv).

    python3 -m sonard_client.compare dump/bow.csv#12 dump/bow.csv#13 --json difference.json
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import warnings
from pathlib import Path
from typing import Any, Optional, Tuple, Union

import cv2
import numpy as np

from .log import read_log

Image = Any  # float64, (rows, columns), range upwards; black 0, full scale 255
_PEAK = 255.0
_MOST_PSNR_DB = 99.0  # of identical images, in the paper
_WINDOW_PX, _WINDOW_SD_PX = 11, 1.5
_C1, _C2 = (0.01 * _PEAK) ** 2, (0.03 * _PEAK) ** 2
_SCALE_WEIGHTS = (0.0448, 0.2856, 0.3001, 0.2363, 0.1333)  # Wang et al. 2003, 4
_LARGEST_SIFT_DISTANCE = 512 * math.sqrt(2)  # OpenCV's descriptors have length 512 and no negative component
_LOWE_RATIO = 0.8  # Lowe 2004, 7.1
_UNITS_PER_TURN = 6400  # bearings of scanning heads: 1/16 gradian, 3200 ahead, rising clockwise


# ---- Measures


def mean_squared_error(a: Image, b: Image) -> float:
    return float(np.mean((a - b) ** 2))


def psnr_db(a: Image, b: Image) -> float:
    """Peak signal-to-noise ratio, at most 99 dB."""
    error = mean_squared_error(a, b)
    return min(10 * math.log10(_PEAK**2 / error), _MOST_PSNR_DB) if error > 0 else _MOST_PSNR_DB


def structural_similarity(a: Image, b: Image) -> Optional[float]:
    """Wang et al. 2004 (IEEE Trans. Image Processing 13:600), over all windows within the image; in [-1, 1]. None if the images
    are smaller than a window."""
    return _mean_terms(a, b)[1] if min(a.shape) >= _WINDOW_PX else None


def multi_scale_similarity(a: Image, b: Image) -> Optional[float]:
    """Wang et al. 2003 (Asilomar Conf. 2:1398), five scales; means below 0 count as 0. None if an image is smaller than 176
    pixels in one direction, because the smallest scale then has no window."""
    product = 1.0
    for scale, weight in enumerate(_SCALE_WEIGHTS):
        if scale > 0:
            a, b = _halved(a), _halved(b)
        if min(a.shape) < _WINDOW_PX:
            return None
        contrast_structure, with_luminance = _mean_terms(a, b)
        is_last = scale == len(_SCALE_WEIGHTS) - 1
        product *= max(with_luminance if is_last else contrast_structure, 0.0) ** weight
    return product


def sift_distance(a: Image, b: Image) -> Optional[float]:
    """Mean distance of SIFT descriptors (Lowe 2004), in [0, 1]: 0 for identical images, near 1 for unrelated ones. Each
    keypoint of both images counts with its distance to the nearest descriptor of the other image, relative to the largest
    possible distance, or with 1 if it has no match by Lowe's ratio. None if no image has a keypoint."""
    of_a, of_b = _descriptors(a), _descriptors(b)
    keypoints = len(of_a) + len(of_b)
    return (_distances(of_a, of_b) + _distances(of_b, of_a)) / keypoints if keypoints else None


def measures(a: Image, b: Image) -> list[dict[str, Any]]:
    """The five measures of images of one size: name, value, unit, score in [0, 1], and score of identical images. None: the
    images are too small for the measure."""
    mse, psnr, ssim = mean_squared_error(a, b), psnr_db(a, b), structural_similarity(a, b)
    ms_ssim, sift = multi_scale_similarity(a, b), sift_distance(a, b)
    rows = [("mse", mse, "", mse / _PEAK**2, 0), ("psnr", psnr, "dB", max(psnr, 0.0) / _MOST_PSNR_DB, 1),
            ("ssim", ssim, "", ssim if ssim is None else max(ssim, 0.0), 1), ("ms_ssim", ms_ssim, "", ms_ssim, 1),
            ("sift_distance", sift, "", sift, 0)]
    return [dict(zip(("name", "value", "unit", "score", "identical"), row)) for row in rows]


def _windowed(image: Image) -> Image:
    """Weighted mean over the window of each pixel; without pixels whose window leaves the image."""
    border = _WINDOW_PX // 2
    blurred = cv2.GaussianBlur(image, (_WINDOW_PX, _WINDOW_PX), _WINDOW_SD_PX)
    return blurred[border:-border, border:-border]


def _mean_terms(a: Image, b: Image) -> Tuple[float, float]:
    """Means of contrast times structure, and of contrast times structure times luminance (Wang et al. 2004, eq. 12-16)."""
    mean_a, mean_b = _windowed(a), _windowed(b)
    squares, product = mean_a**2 + mean_b**2, mean_a * mean_b
    variances, covariance = _windowed(a**2 + b**2) - squares, _windowed(a * b) - product
    contrast_structure = (2 * covariance + _C2) / (variances + _C2)
    luminance = (2 * product + _C1) / (squares + _C1)
    return float(np.mean(contrast_structure)), float(np.mean(contrast_structure * luminance))


def _halved(image: Image) -> Image:
    """Means of 2 x 2 pixels, without an odd last row or column."""
    rows, columns = image.shape[0] // 2, image.shape[1] // 2
    return image[: 2 * rows, : 2 * columns].reshape(rows, 2, columns, 2).mean(axis=(1, 3))


def _descriptors(image: Image) -> Any:
    found = cv2.SIFT_create().detectAndCompute(np.rint(image).astype(np.uint8), None)[1]
    return np.zeros((0, 128), np.float32) if found is None else found


def _distances(of: Any, to: Any) -> float:
    """Sum over the descriptors `of`, each 0 to 1."""
    if len(to) == 0 or len(of) == 0:
        return float(len(of))
    total = 0.0
    for match in cv2.BFMatcher(cv2.NORM_L2).knnMatch(of, to, 2):
        second = match[1].distance if len(match) > 1 else _LARGEST_SIFT_DISTANCE
        is_match = match[0].distance <= _LOWE_RATIO * second
        total += min(match[0].distance / _LARGEST_SIFT_DISTANCE, 1.0) if is_match else 1.0
    return total


# ---- Images


def load_image(source: Union[str, Path]) -> Image:
    """One side of a comparison:

    FILE.png          a picture, PNG or JPEG by its contents; colours become brightness
    FILE.npy          a ping of sonard's `dump`
    FILE.csv#NUMBER   the ping with this number in the index of a dump
    FILE.jsonl#TURN   a turn of a scanning head, written by `sonarview --raw`
    FILE.LOG#IMAGE    a ping of an .mcap, .glf or .dat log, counted from 0

    Raises ValueError or OSError, with the file.
    """
    name, mark, number = str(source).rpartition("#")
    kinds = {".csv": ("PING", _dumped), ".jsonl": ("TURN", _turn), ".mcap": ("IMAGE", _logged), ".glf": ("IMAGE", _logged),
             ".dat": ("IMAGE", _logged)}
    file = Path(name) if mark and Path(name).suffix in kinds else Path(source)
    if file.suffix not in kinds:
        return _array(file) if file.suffix == ".npy" else _picture(file)
    what, read = kinds[file.suffix]
    if not mark or not number.isdecimal():
        raise ValueError(f"{file}: expected {file}#{what}")
    return read(file, int(number))


def _scaled(samples: Any) -> Image:
    """Samples from near to far become an image with range upwards."""
    image = samples[::-1].astype(np.float64)
    return image * (_PEAK / 65535) if samples.dtype == np.uint16 else image


def _picture(file: Path) -> Image:
    data = np.frombuffer(file.read_bytes(), np.uint8)
    picture = cv2.imdecode(data, cv2.IMREAD_COLOR) if len(data) else None
    if picture is None:
        raise ValueError(f"{file}: is not a PNG or JPEG picture")
    return cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY).astype(np.float64)


def _array(file: Path) -> Image:
    try:
        samples = np.load(file, mmap_mode="r", allow_pickle=False)  # a map is refused if the file is too short
    except (ValueError, EOFError, OverflowError) as error:
        raise ValueError(f"{file}: is not a NumPy file with all its samples: {error}") from None
    if not isinstance(samples, np.ndarray) or samples.ndim != 2 or samples.dtype not in (np.uint8, np.uint16) or \
            samples.size == 0:
        raise ValueError(f"{file}: is not a table of 8-bit or 16-bit samples")
    return _scaled(samples)


def _dumped(index: Path, number: int) -> Image:
    """The file HEAD-NUMBER.npy beside HEAD.csv, if the index lists it."""
    if not any(row.startswith(f"{number},") for row in index.read_text(errors="replace").splitlines()):
        raise ValueError(f"{index}: has no ping {number}")
    return _array(index.with_name(f"{index.stem}-{number:08d}.npy"))


def _logged(file: Path, number: int) -> Image:
    count = 0
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: print(f"compare: {message}", file=sys.stderr)
        try:
            for count, ping in enumerate(read_log(file), 1):
                if count == number + 1:
                    return _scaled(ping.samples)
        except ValueError as error:
            raise ValueError(f"{file}: {error}") from None
    raise ValueError(f"{file}: has no image {number}; it has {count} images")


def _turn(file: Path, turn: int) -> Image:
    """A column for each step, clockwise from the left limit; a full circle begins astern, so that ahead is in the middle. A
    column without a line is black."""
    image, shape = None, None
    with open(file, encoding="utf-8", errors="replace") as rows:
        for row, text in enumerate(rows, 1):
            try:
                number, bearing, of_line, samples = _scan_line(text)
                if number != turn:
                    continue
                if shape is None:
                    shape = of_line
                    left, width, step, bins = shape
                    is_circle = width == _UNITS_PER_TURN
                    columns = -(-width // step) + (0 if is_circle else 1)
                    image = np.zeros((bins, columns), np.uint8)
                elif of_line != shape:
                    raise ValueError("differs from the turn's first line in step, sector or number of bins")
            except (ValueError, TypeError, KeyError) as error:
                why = error if isinstance(error, ValueError) and not isinstance(error, json.JSONDecodeError) else "is not a " \
                    "line of a scanning head (expected a line written by sonarview --raw)"
                raise ValueError(f"{file}:{row}: {why}") from None
            column = (2 * ((bearing - left) % _UNITS_PER_TURN) + step) // (2 * step)
            if is_circle or column < columns:
                image[:, column % columns] = samples
    if image is None:
        raise ValueError(f"{file}: has no turn {turn}")
    return _scaled(image)


def _scan_line(text: str) -> Tuple[int, int, Tuple[int, int, int, int], Any]:
    """Turn, bearing, (left, width, step, bins) and samples of a line (docs/sonarview.md, "Lines in a file")."""
    line = json.loads(text)

    def integer(key: str, least: int, most: int) -> int:
        value = int(line[key])
        if not least <= value <= most:
            raise ValueError(f"{key} {value} is out of range")
        return value

    last = _UNITS_PER_TURN - 1
    samples = np.frombuffer(bytes.fromhex(line["bins"]), np.uint8)
    if integer("bits", 4, 8) == 4:
        if samples.max(initial=0) > 15:
            raise ValueError("bins of 4 bits are above 15")
        samples = samples * np.uint8(17)
    left, width = 0, _UNITS_PER_TURN
    if not line["all_round"]:
        left = integer("left_limit", 0, last)
        width = (integer("right_limit", 0, last) - left) % _UNITS_PER_TURN
    if len(samples) == 0 or width == 0:
        raise ValueError("the line is empty")
    return int(line["turn"]), integer("bearing", 0, last), (left, width, integer("step", 1, 255), len(samples)), samples


# ---- Program


_NAMES = {"mse": "MSE", "psnr": "PSNR", "ssim": "SSIM", "ms_ssim": "MS-SSIM", "sift_distance": "SIFT distance"}


def table(rows: list[dict[str, Any]]) -> str:
    def number(value: Optional[float]) -> str:
        return "-" if value is None else f"{value:.4f}"

    text = f"{'measure':<14}{'value':>12} {'':<3}{'score':>10}{'identical':>11}\n"
    for row in rows:
        text += f"{_NAMES[row['name']]:<14}{number(row['value']):>12} {row['unit']:<3}{number(row['score']):>10}" \
                f"{row['identical']:>11}\n"
    return text


def main() -> int:
    parser = argparse.ArgumentParser(prog="python3 -m sonard_client.compare",
                                     description="Compares two images by MSE, PSNR, SSIM, MS-SSIM and SIFT.",
                                     epilog="Exit status: 0 compared; 1 a file could not be read or written, or the sizes "
                                            "differ; 2 invalid command line.")
    parser.add_argument("a", help="first image: a picture, FILE.npy or FILE.csv#PING of sonard's dump, FILE.jsonl#TURN of "
                                  "--raw, or LOG#IMAGE of an .mcap, .glf or .dat")
    parser.add_argument("b", help="second image, of the same size")
    parser.add_argument("--json", metavar="FILE", help="write the result to this file too")
    options = parser.parse_args()
    try:
        a, b = load_image(options.a), load_image(options.b)
        if a.shape != b.shape:
            raise ValueError(f"{options.a} is {a.shape[1]} x {a.shape[0]}, {options.b} is {b.shape[1]} x {b.shape[0]}: only "
                             "images of equal size can be compared")
        rows = measures(a, b)
        print(table(rows), end="")
        if options.json:
            result = {"a": options.a, "b": options.b, "width": a.shape[1], "height": a.shape[0], "measures": rows}
            Path(options.json).write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    except (OSError, ValueError) as error:
        print(f"compare: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
