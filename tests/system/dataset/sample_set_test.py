#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""clients/examples/dataset with few images: the masks of its data set are those that sonard wrote, and a detector finds them.

    sample_set_test.py --programs DIR [SampleSet.test_name ...]
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import cv2
import numpy as np

SOURCE = pathlib.Path(__file__).resolve().parents[3]
EXAMPLE = SOURCE / "clients" / "examples" / "dataset"
PROGRAMS = None  # folder of the programs under test
PATIENCE_S = 540
IMAGES = 4  # in each of 14 folders
SCENES = ["docking_station", "gazebo_basin", "manifold", "oil_and_gas", "open_water", "ssiv", "tank"]
CLASSES = {"boulder": r"boulder_\d", "structure": "docking_station|ssiv|manifold|tree", "target": "crate|target"}
LEAST_PIXELS = 12  # of a label, in make_dataset.sh


def filled(segmentation, shape):
    """A mask from run lengths down the columns, or from polygons along the edges of pixels: OpenCV fills them in a picture
    that is twice as large, in which the middle of each pixel has a place of its own."""
    if isinstance(segmentation, dict):
        counts = segmentation["counts"]
        return np.repeat(np.arange(len(counts)) % 2 == 1, counts).reshape(shape[::-1]).T
    large = np.zeros((2 * shape[0] + 1, 2 * shape[1] + 1), np.uint8)
    cv2.fillPoly(large, [np.array(one, np.int32).reshape(-1, 1, 2) * 2 for one in segmentation], 1)
    return large[1::2, 1::2] == 1


class SampleSet(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.out = pathlib.Path(scratch.name) / "sample"
        path = f"{os.path.dirname(sys.executable)}:{os.environ['PATH']}"  # python3 is this one
        done = subprocess.run([str(EXAMPLE / "make_dataset.sh"), str(cls.out), str(IMAGES)], capture_output=True, text=True,
                              timeout=PATIENCE_S, check=False,
                              env={**os.environ, "PATH": path, "SONARD": os.path.join(PROGRAMS, "sonard"), "PYTHONDONTWRITEBYTECODE": "1"})
        if done.returncode != 0:
            raise AssertionError(done.stderr[-3000:])

    def content(self, split):
        return json.loads((self.out / "set" / "annotations" / f"instances_{split}.json").read_text(encoding="utf-8"))

    def test_labels_are_the_masks_of_sonard(self):
        seen = set()
        for split in ("train", "val"):
            content = self.content(split)
            self.assertEqual(sorted({image["sonard"]["folder"] for image in content["images"]}), [f"{scene}_{split}" for scene in SCENES])
            self.assertEqual(len(content["images"]), IMAGES * len(SCENES))
            classes = {category["id"]: category["name"] for category in content["categories"]}
            for image in content["images"]:
                found = [one for one in content["annotations"] if one["image_id"] == image["id"]]
                self.compare(image, found, classes)
                seen.update((classes[one["category_id"]], isinstance(one["segmentation"], dict)) for one in found)
                self.assertTrue(not found or "open_water" not in image["file_name"])
        self.assertTrue({name for name, _ in seen} == set(CLASSES) and {True, False} == {holes for _, holes in seen}, seen)

    def compare(self, image, found, classes):
        facts = image["sonard"]
        base = self.out / facts["folder"] / f"ping_{facts['frame']:06d}"
        truth = cv2.imread(f"{base}_fan_bodies.png", cv2.IMREAD_UNCHANGED)
        bodies = {body["name"]: body["id"] for body in json.loads(base.with_suffix(".json").read_text())["truth"]["bodies"]}
        expected = {name for name, number in bodies.items() if (truth == number).sum() >= LEAST_PIXELS
                    and any(re.fullmatch(pattern, name) for pattern in CLASSES.values())}
        self.assertEqual({one["body"] for one in found}, expected, image["file_name"])
        for one in found:
            mask = truth == bodies[one["body"]]
            self.assertRegex(one["body"], f"^({CLASSES[classes[one['category_id']]]})$")
            np.testing.assert_array_equal(filled(one["segmentation"], truth.shape), mask)

    def test_a_detector_finds_the_labels(self):
        done = subprocess.run([sys.executable, "-B", str(EXAMPLE / "train_detector.py"), str(self.out / "set")], capture_output=True,
                              text=True, timeout=PATIENCE_S, check=True)
        right, of_others = (float(word) for word in re.findall(r"([\d.]+) %", done.stdout))
        self.assertGreater(right, 75, done.stdout)
        self.assertLess(of_others, 65, done.stdout)


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder of the programs under test")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    PROGRAMS = os.path.abspath(arguments.programs)
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
