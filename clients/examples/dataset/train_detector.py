#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Trains a small detector on a data set of make_dataset.sh (COCO), to show that its labels fit its images.

It tells crops at labels from crops at the same range and random bearings, by HOG features and a linear SVM of OpenCV. For
comparison, it does so with the labels of other pictures: they do not fit, so about half of the crops are right. Needs NumPy
and OpenCV.
"""
import argparse
import copy
import json
import math
import pathlib
import sys

import cv2
import numpy as np

SIDE_PX, LEAST_PX = 32, 6  # of a crop for the features; of a box
HOG = cv2.HOGDescriptor((SIDE_PX, SIDE_PX), (16, 16), (8, 8), (8, 8), 9)


class Picture:
    """A fan and the squares (x, y, side) around its labels, in pixels."""

    def __init__(self, file, facts, limit_rad):
        self.pixels, self.apex, self.limit_rad = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE), facts["apex_px"], limit_rad
        self.boxes = []

    def background(self, random, box):
        """A square of this size and range without a label; None if there is hardly a place."""
        x, y, side = box
        range_px = math.hypot(x + side / 2 - self.apex[0], y + side / 2 - self.apex[1])
        for bearing in random.uniform(-self.limit_rad, self.limit_rad, 50):
            middle = self.apex[0] - range_px * math.sin(bearing), self.apex[1] - range_px * math.cos(bearing)
            other = int(middle[0] - side / 2), int(middle[1] - side / 2), side
            if not any(overlaps(other, label) for label in (box, *self.boxes)):
                return other
        return None


def load(folder, split):
    content = json.loads((folder / "annotations" / f"instances_{split}.json").read_text(encoding="utf-8"))
    pictures = {}
    for image in content["images"]:
        facts = image["sonard"]
        bearings_rad = content["info"]["sonard"][facts["folder"]]["bearings_rad"]
        pictures[image["id"]] = Picture(folder / "images" / split / image["file_name"], facts, max(bearings_rad))
    for annotation in content["annotations"]:
        x, y, width, height = annotation["bbox"]
        if min(width, height) >= LEAST_PX:
            side = max(width, height) + 4
            pictures[annotation["image_id"]].boxes.append((int(x + (width - side) / 2), int(y + (height - side) / 2), side))
    return [picture for picture in pictures.values() if picture.boxes]


def overlaps(a, b):
    return a[0] < b[0] + b[2] and b[0] < a[0] + a[2] and a[1] < b[1] + b[2] and b[1] < a[1] + a[2]


def crop(picture, box):
    """Black beyond the picture."""
    x, y, side = box
    padded = cv2.copyMakeBorder(picture, side, side, side, side, cv2.BORDER_CONSTANT)
    return padded[y + side: y + 2 * side, x + side: x + 2 * side]


def features(picture, box):
    small = cv2.resize(crop(picture, box), (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_AREA)
    return np.concatenate([HOG.compute(small).ravel(), cv2.resize(small, (8, 8), interpolation=cv2.INTER_AREA).ravel() / 255])


def samples(pictures, seed):
    """Features and classes (1: at a label, 0: background), as many of the one as of the other."""
    random = np.random.default_rng(seed)
    rows, classes = [], []
    for picture in pictures:
        for box in picture.boxes:
            other = picture.background(random, box)
            if other is not None:
                rows += [features(picture.pixels, box), features(picture.pixels, other)]
                classes += [1, 0]
    return np.array(rows, np.float32), np.array(classes, np.int32)


def accuracy(train, test, seed):
    """Share of crops that are right, and their number."""
    (x, y), (test_x, test_y) = samples(train, seed), samples(test, seed + 1)
    if not len(x) or not len(test_x):
        raise ValueError("there are no labels in train or val")
    svm = cv2.ml.SVM_create()
    svm.setType(cv2.ml.SVM_C_SVC)
    svm.setKernel(cv2.ml.SVM_LINEAR)
    svm.setC(0.1)
    svm.train(x, cv2.ml.ROW_SAMPLE, y)
    return float(np.mean(svm.predict(test_x)[1].ravel() == test_y)), len(test_y)


def with_other_labels(pictures):
    """The labels of each picture on another one, half of the pictures further on."""
    half = len(pictures) // 2
    others = [copy.copy(picture) for picture in pictures]
    for picture, source in zip(others, pictures[half:] + pictures[:half]):
        picture.boxes = source.boxes
    return others


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("set", type=pathlib.Path, help="folder of the data set")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    try:
        train, test = load(options.set, "train"), load(options.set, "val")
        right, count = accuracy(train, test, options.seed)
        control, _ = accuracy(with_other_labels(train), with_other_labels(test), options.seed)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"train_detector: {error}")
    print(f"{100 * right:.1f} % of {count} crops are right; with the labels of other pictures {100 * control:.1f} %")


if __name__ == "__main__":
    main()
