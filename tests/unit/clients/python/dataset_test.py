#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests sonard_client.to_dataset with small folders in the form of `sonard render --truth` and masks drawn by hand. Outlines are
filled again by a rasteriser of this file, and HDF5 is read by h5py, if it is installed. The example that trains a detector runs
on pictures with bright bodies.

    dataset_test.py [Outlines.test_name ...]
"""

import importlib.util
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import zlib

import cv2
import numpy as np

SOURCE = pathlib.Path(__file__).resolve().parents[4]
CLIENT = SOURCE / "clients" / "python"
EXAMPLE = SOURCE / "clients" / "examples" / "dataset"
sys.path[:0] = [str(CLIENT)]

from sonard_client.dataset.outlines import one_polygon, outlines, run_lengths  # noqa: E402

HAS_H5PY = importlib.util.find_spec("h5py") is not None
BODIES = ["seabed", "boulder_1", "boulder_2", "station"]  # with the IDs 1 to 4
MASK = ["1111111111",
        "1220000001",
        "1220044401",
        "1111140401",
        "3111144401",
        "3300000000"]  # a square in the corner of the bed, a part of two rows, and a ring with one hole
BEARINGS_RAD = [0.5, 0.4, 0.3, 0.2, 0.1, -0.1, -0.2, -0.3, -0.4, -0.5]


def table(rows):
    return np.array([[int(cell, 16) for cell in row] for row in rows], np.uint8)


def filled(polygons, shape):
    """Pixels whose middle has an odd number of edges above it: along each column, from the definition of the even-odd rule."""
    inside = np.zeros(shape, bool)
    for corners in polygons:
        for (x0, y0), (x1, y1) in zip(corners, [*corners[1:], corners[0]]):
            for x in range(shape[1]):
                if min(x0, x1) <= x + 0.5 < max(x0, x1):
                    y = y0 + (x + 0.5 - x0) / (x1 - x0) * (y1 - y0)
                    inside[:, x] ^= np.arange(shape[0]) + 0.5 > y
    return inside


def mask_of(segmentation, shape):
    """A mask from COCO's polygons, or from its run lengths down the columns."""
    if isinstance(segmentation, list):
        return filled([list(zip(one[0::2], one[1::2])) for one in segmentation], shape)
    height, width = segmentation["size"]
    pixels = [value for k, count in enumerate(segmentation["counts"]) for value in [k % 2] * count]
    return np.array([[pixels[x * height + y] for x in range(width)] for y in range(height)], bool)


def pose(x):
    return {"position_m": [x, 2.0, -3.0], "quaternion_xyzw": [0.0, 0.0, 0.6, 0.8]}


class Rendered:
    """A folder as `sonard render --truth --bits 16` writes it."""

    def __init__(self, path, masks, seed=1, trajectory="aaaa0001", bodies=BODIES, config=b"", truth=True):
        self.path, self.seed, self.bodies, self.truth = path, seed, bodies, truth
        path.mkdir()
        for k, mask in enumerate(masks):
            self.write_frame(k, mask)
        self.write_json("run.json", {"program": "sonard 9.8.7", "config_crc32": f"{zlib.crc32(config):08x}",
                                     "world_crc32": "bbbb0001", "trajectory_crc32": trajectory, "head": "bow",
                                     "frames": len(masks), "settings": {"range_m": 3.0}})

    def write_json(self, name, content):
        (self.path / name).write_text(json.dumps(content), encoding="utf-8")

    def write_frame(self, k, mask):
        name = f"ping_{k:06d}"
        samples = (np.arange(mask.size).reshape(mask.shape) * 1000 + k).astype(np.uint16)
        np.save(self.path / f"{name}.npy", samples)
        np.save(self.path / f"{name}_bodies.npy", mask)
        self.write_json(f"{name}.json", {
            "frame": k, "head": "bow", "type": "gemini_720i", "stamp_s": 10.0 + k, "seed": self.seed,
            "samples": {"file": f"{name}.npy", "dtype": "<u2", "axes": ["line", "beam"], "shape": list(mask.shape)},
            "geometry": {"line_step_m": 0.5, "range_m": 3.0, "sound_speed_mps": 1500.0, "bearings_rad": BEARINGS_RAD},
            "T_world_vehicle": pose(k), "T_world_sonar": pose(k + 0.5),
            "truth": {"file": f"{name}_bodies.npy", "bodies": [{"id": number, "name": body} for number, body in
                                                               enumerate(self.bodies, 1)]} if self.truth else None})

    def add_fan(self, k, image, mask, apex_px):
        name = f"ping_{k:06d}"
        cv2.imwrite(str(self.path / f"{name}_fan.png"), image)
        cv2.imwrite(str(self.path / f"{name}_fan_bodies.png"), mask)
        facts = json.loads((self.path / f"{name}.json").read_text(encoding="utf-8"))
        facts["clean_pictures"] = {"fan": {"file": f"{name}_fan.png", "size_px": [image.shape[1], image.shape[0]],
                                           "apex_px": apex_px, "metres_per_px": 0.25, "mask": f"{name}_fan_bodies.png"}}
        self.write_json(f"{name}.json", facts)


class Outlines(unittest.TestCase):
    def test_square(self):
        outer, holes = outlines(table(["000", "011", "011"]))
        self.assertEqual([loop.tolist() for loop in outer], [[[1, 1], [3, 1], [3, 3], [1, 3]]])
        self.assertEqual(holes, [])

    def test_ring(self):
        outer, holes = outlines(table(["111", "101", "111"]))
        self.assertEqual([sorted(loop.tolist()) for loop in outer], [[[0, 0], [0, 3], [3, 0], [3, 3]]])
        self.assertEqual([sorted(loop.tolist()) for loop in holes], [[[1, 1], [1, 2], [2, 1], [2, 2]]])

    def test_pixels_that_share_a_corner_are_parts(self):
        for rows in (["10", "01"], ["01", "10"]):
            outer, holes = outlines(table(rows))
            self.assertEqual((len(outer), len(holes)), (2, 0), rows)
            self.assertTrue(all(len(loop) == 4 for loop in outer), rows)

    def test_nothing(self):
        self.assertEqual(outlines(np.zeros((3, 4), bool)), ([], []))

    def test_random_masks_are_covered_exactly(self):
        random = np.random.default_rng(4)
        holes_seen = 0
        for _ in range(200):
            mask = random.random(random.integers(1, 13, 2)) < random.choice([0.2, 0.5, 0.75, 0.95])
            outer, holes = outlines(mask)
            np.testing.assert_array_equal(filled([loop.tolist() for loop in outer + holes], mask.shape), mask)
            parts = cv2.connectedComponents(mask.astype(np.uint8), connectivity=4)[0] - 1
            gaps = cv2.connectedComponents(np.pad(~mask, 1, constant_values=True).astype(np.uint8), connectivity=8)[0] - 2
            self.assertEqual((len(outer), len(holes)), (parts, gaps), mask)
            holes_seen += gaps
            if outer:
                np.testing.assert_array_equal(filled([one_polygon(outer + holes).tolist()], mask.shape), mask)
        self.assertGreater(holes_seen, 50)

    def test_run_lengths_go_down_the_columns(self):
        self.assertEqual(run_lengths(table(["01", "11"])), [1, 3])
        self.assertEqual(run_lengths(table(["10", "01"])), [0, 1, 2, 1])
        self.assertEqual(run_lengths(table(["00", "00"])), [4])


class Folders(unittest.TestCase):
    """A case has a folder `one` with the mask above and an image of open water, and a folder `two`."""

    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(CLIENT), *filter(None, [os.environ.get("PYTHONPATH")])])}

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = pathlib.Path(scratch.name)
        self.mask = table(MASK)
        self.one = Rendered(self.root / "one", [self.mask, np.zeros_like(self.mask)], seed=11)
        self.two = Rendered(self.root / "two", [self.mask[::-1].copy()], seed=12, trajectory="aaaa0002")
        self.out = self.root / "set"

    def run_program(self, *words, code=0):
        done = subprocess.run([sys.executable, "-B", "-m", "sonard_client.to_dataset", *map(str, words)], capture_output=True,
                              text=True, cwd=self.root, timeout=60, check=False, env=self.environment)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def convert(self, *words, folders=("one", "two"), form="coco", code=0):
        return self.run_program(*folders, "--out", "set", "--format", form, *words, code=code)

    def write(self, name, text):
        (self.root / name).write_text(text, encoding="utf-8")
        return name

    def labels(self):
        return self.write("labels.yaml", "seabed:\n'boulder_*': boulder\nstation: structure\n")

    def coco(self, split="train"):
        return json.loads((self.out / "annotations" / f"instances_{split}.json").read_text(encoding="utf-8"))

    def refused(self, *words, folders=("one", "two"), form="coco"):
        error = self.convert(*words, folders=folders, form=form, code=2).stderr
        self.assertFalse(self.out.exists(), "half a data set is left")
        return error


class Coco(Folders):
    def test_masks_are_those_of_the_folder_bit_by_bit(self):
        self.convert()
        content = self.coco()
        names = {category["id"]: category["name"] for category in content["categories"]}
        self.assertEqual(names, dict(enumerate(BODIES, 1)))
        compared = 0
        for image, mask in zip(content["images"], [self.mask, np.zeros_like(self.mask), self.mask[::-1]]):
            found = [one for one in content["annotations"] if one["image_id"] == image["id"]]
            self.assertEqual(sorted(one["body"] for one in found), sorted(BODIES) if mask.any() else [])
            for one in found:
                body = mask == 1 + BODIES.index(one["body"])
                np.testing.assert_array_equal(mask_of(one["segmentation"], mask.shape), body, one["body"])
                self.assertEqual((one["area"], one["iscrowd"], names[one["category_id"]]), (body.sum(), 0, one["body"]))
                compared += 1
        self.assertEqual(compared, 8)
        self.assertEqual([one["id"] for one in content["annotations"]], list(range(1, 9)))

    def test_boxes_and_kinds_of_masks(self):
        self.convert()
        found = {one["body"]: one for one in self.coco()["annotations"] if one["image_id"] == 1}
        self.assertEqual({body: one["bbox"] for body, one in found.items()},
                         {"seabed": [0, 0, 10, 5], "boulder_1": [1, 1, 2, 2], "boulder_2": [0, 4, 2, 2], "station": [5, 2, 3, 3]})
        self.assertEqual(found["boulder_1"]["segmentation"], [[1, 1, 3, 1, 3, 3, 1, 3]])
        self.assertEqual(found["station"]["segmentation"]["size"], [6, 10])  # it has a hole

    def test_pictures_and_what_gave_them(self):
        self.convert()
        content = self.coco()
        self.assertEqual([image["file_name"] for image in content["images"]],
                         ["one-ping_000000.png", "one-ping_000001.png", "two-ping_000000.png"])
        second = content["images"][1]
        self.assertEqual((second["width"], second["height"]), (10, 6))
        self.assertEqual(second["sonard"], {"folder": "one", "frame": 1, "stamp_s": 11.0, "seed": 11, "T_world_sonar": pose(1.5),
                                            "line_step_m": 0.5})
        self.assertEqual(content["info"]["sonard"]["two"]["bearings_rad"], BEARINGS_RAD)
        picture = cv2.imread(str(self.out / "images" / "train" / "one-ping_000000.png"), cv2.IMREAD_UNCHANGED)
        self.assertEqual((picture[0, 0], picture[0, 2], picture[5, 9]), (0, 8, 230))  # samples 0, 2000 and 59000 over 257

    def test_classes_from_a_file(self):
        error = self.convert("--labels", self.labels()).stderr
        self.assertEqual(error, "")
        content = self.coco()
        self.assertEqual([category["name"] for category in content["categories"]], ["boulder", "structure"])
        self.assertEqual(sorted((one["body"], one["category_id"]) for one in content["annotations"] if one["image_id"] == 1),
                         [("boulder_1", 1), ("boulder_2", 1), ("station", 2)])

    def test_the_first_pattern_counts_and_unused_ones_are_named(self):
        labels = self.write("labels.yaml", "boulder_2: big\n'*_?': small\nwreck: wreck\n")
        error = self.convert("--labels", labels).stderr
        self.assertEqual(error, "to_dataset: labels.yaml: no body is called wreck\n")
        content = self.coco()
        self.assertEqual([category["name"] for category in content["categories"]], ["big", "small", "wreck"])
        self.assertEqual(sorted((one["body"], one["category_id"]) for one in content["annotations"] if one["image_id"] == 1),
                         [("boulder_1", 2), ("boulder_2", 1)])

    def test_small_bodies_can_be_left_out(self):
        self.convert("--min-pixels", 4)
        self.assertEqual([one["body"] for one in self.coco()["annotations"] if one["image_id"] == 1],
                         ["seabed", "boulder_1", "station"])  # the other boulder has 3 pixels

    def test_floor_makes_brightness_a_level(self):
        self.convert("--floor-db", -60)
        picture = cv2.imread(str(self.out / "images" / "train" / "one-ping_000000.png"), cv2.IMREAD_UNCHANGED)
        for y, x, sample in ((0, 0, 0), (0, 1, 1000), (2, 0, 20000), (5, 9, 59000)):
            level_db = 20 * math.log10(max(sample, 1e-3) / 65535)
            self.assertAlmostEqual(picture[y, x], 255 * max(1 + level_db / 60, 0), delta=0.5)


class Fan(Folders):
    def test_fans_have_their_own_masks(self):
        image = np.arange(48, dtype=np.uint8).reshape(6, 8)
        mask = table(["00000000", "00222000", "02220000", "00000400", "00004400", "00000000"])
        self.two.add_fan(0, image, mask, [3.5, 5.0])
        self.convert("--picture", "fan", folders=["two"])
        content = self.coco()
        picture = cv2.imread(str(self.out / "images" / "train" / "two-ping_000000.png"), cv2.IMREAD_UNCHANGED)
        np.testing.assert_array_equal(picture, image)
        self.assertEqual((content["images"][0]["sonard"]["apex_px"], content["images"][0]["sonard"]["metres_per_px"]),
                         ([3.5, 5.0], 0.25))
        self.assertEqual([one["body"] for one in content["annotations"]], ["boulder_1", "station"])
        for one, number in zip(content["annotations"], (2, 4)):
            np.testing.assert_array_equal(mask_of(one["segmentation"], mask.shape), mask == number)

    def test_needs_clean_png(self):
        self.assertIn("two: has no fans with masks: render it with --truth and --clean-png",
                      self.refused("--picture", "fan", folders=["two"]))


class Yolo(Folders):
    def lines(self, kind, name, split="train"):
        text = (self.out / kind / split / f"{name}.txt").read_text(encoding="utf-8")
        return [[float(word) for word in line.split()] for line in text.splitlines()]

    def test_boxes(self):
        self.convert("--labels", self.labels(), form="yolo")
        self.assertEqual(self.lines("labels", "one-ping_000000"),  # class, middle, width and height over 10 and 6 pixels
                         [[0, 0.2, 0.3333333, 0.2, 0.3333333], [0, 0.1, 0.8333333, 0.2, 0.3333333], [1, 0.65, 0.5833333, 0.3, 0.5]])

    def test_segments_cover_the_masks(self):
        self.convert("--labels", self.labels(), form="yolo")
        lines = self.lines("segments", "one-ping_000000")
        self.assertEqual([line[0] for line in lines], [0, 0, 1])
        for line, number in zip(lines, (2, 3, 4)):
            corners = [(round(10 * x, 4), round(6 * y, 4)) for x, y in zip(line[1::2], line[2::2])]
            np.testing.assert_array_equal(filled([corners], self.mask.shape), self.mask == number)

    def test_open_water_has_empty_files(self):
        self.convert(form="yolo")
        for kind in ("labels", "segments"):
            self.assertEqual(self.lines(kind, "one-ping_000001"), [])

    def test_data_yaml(self):
        import yaml

        self.convert("--labels", self.labels(), "--split", "train=one", "val=two", form="coco,yolo")
        content = yaml.safe_load((self.out / "data.yaml").read_text(encoding="utf-8"))
        self.assertEqual(content, {"train": "images/train", "val": "images/val", "names": {0: "boulder", 1: "structure"}})
        self.assertEqual(len(self.coco("val")["images"]), 1)
        self.assertTrue((self.out / "images" / "val" / "two-ping_000000.png").exists())


class Splits(Folders):
    def test_folders_are_never_divided(self):
        self.convert("--split", "train=o*", "--split", "val=two")
        self.assertEqual([image["sonard"]["folder"] for image in self.coco("train")["images"]], ["one", "one"])
        self.assertEqual([image["sonard"]["folder"] for image in self.coco("val")["images"]], ["two"])

    def test_each_folder_is_in_one_split(self):
        self.assertIn("folder two is in 0 splits (none), expected 1", self.refused("--split", "train=one"))
        self.assertIn("folder two is in 2 splits (train, val), expected 1", self.refused("--split", "train=*", "val=two"))
        self.assertIn("no folder is called three", self.refused("--split", "train=one,two,three"))
        self.assertIn("expected NAME=FOLDER", self.refused("--split", "../up=one"))

    def test_a_trajectory_is_not_in_two_splits(self):
        Rendered(self.root / "again", [self.mask], seed=13)  # the trajectory of `one`, with other noise
        error = self.refused("--split", "train=one", "val=again", folders=["one", "again"])
        self.assertIn("folders one (train) and again (val) are of the same trajectory and world", error)

    def test_equal_noise_is_named(self):
        Rendered(self.root / "same", [self.mask], seed=11, trajectory="aaaa0003")
        error = self.convert("--split", "train=one", "val=same", folders=["one", "same"]).stderr
        self.assertIn("folders one and same have one seed", error)
        self.assertIn("image k has the same noise", (self.out / "README.md").read_text(encoding="utf-8"))


class Card(Folders):
    def card(self):
        return (self.out / "README.md").read_text(encoding="utf-8")

    def test_what_was_rendered(self):
        self.convert("--labels", self.labels(), "--split", "train=one", "val=two", "--title", "Stones", "--licence", "CC BY 4.0")
        text = self.card()
        self.assertTrue(text.startswith("# Stones\n\n3 images of a simulated sonar, rendered by sonard 9.8.7."))
        self.assertRegex(text, r"\| train \| one \| 2 \| gemini_720i \(bow\) \| 3\.00 \| 11 \| not given \| \w{8} bbbb0001 aaaa0001 \|")
        self.assertRegex(text, r"\| val \| two \| 1 \| gemini_720i \(bow\) \| 3\.00 \| 12 \|")
        self.assertIn("| boulder | boulder_1, boulder_2 | 2 | 2 |\n| structure | station | 1 | 1 |", text)
        self.assertIn("the preset of a folder without a configuration is not known", text)
        self.assertIn("docs/accuracy.md", text)
        self.assertTrue(text.endswith("## Licence\n\nCC BY 4.0\n"))
        self.assertEqual(self.coco()["licenses"][0]["name"], "CC BY 4.0")

    def test_configurations_give_preset_and_origin(self):
        text = "world: {file: a.sdf, origin: {latitude_deg: 53.5, longitude_deg: 9.9}}\nsampling: {preset: fast}\n"
        config = self.write("harbour.yaml", text)
        Rendered(self.root / "placed", [self.mask], seed=14, trajectory="aaaa0004", config=text.encode())
        self.convert("--config", config, folders=["placed"])
        self.assertIn("| harbour.yaml |", self.card())
        self.assertIn("| 53.5, 9.9 |", self.card())
        self.assertIn("`sampling.preset: fast`: at most 5 %. ", self.card())
        self.assertEqual(self.coco()["info"]["sonard"]["placed"]["origin"],
                         {"latitude_deg": 53.5, "longitude_deg": 9.9, "altitude_m": 0.0})

    def test_origin_in_the_world(self):
        place = "<latitude_deg>-33.5</latitude_deg><longitude_deg>151.25</longitude_deg><elevation>7</elevation>"
        config = self.write("bay.yaml", "world: {file: bay.sdf}\n")
        Rendered(self.root / "bay", [self.mask], config=b"world: {file: bay.sdf}\n")
        self.write("bay.sdf", f"<sdf><world name='b'><spherical_coordinates>{place}</spherical_coordinates></world></sdf>")
        self.convert("--config", config, folders=["bay"])
        self.assertEqual(self.coco()["info"]["sonard"]["bay"]["origin"],
                         {"latitude_deg": -33.5, "longitude_deg": 151.25, "altitude_m": 7.0})
        self.assertIn("`sampling.preset: default`: at most 1.25 %. ", self.card())


class Refusals(Folders):
    def test_folders(self):
        Rendered(self.root / "blind", [self.mask], truth=False)
        self.assertIn("blind: has no masks: render it with --truth", self.refused(folders=["blind"]))
        (self.root / "one" / "ping_000001.json").unlink()
        self.assertIn("one: has 1 of 2 frames: repeat the command that rendered it", self.refused())
        self.assertIn("run.json", self.refused(folders=["nowhere"]))
        self.two.write_json("run.json", {"frames": 1})
        self.assertIn("lacks 'program'", self.refused(folders=["two"]))
        self.assertIn("two folders are called two", self.refused(folders=["two", "two"]))

    def test_files(self):
        (self.root / "two" / "ping_000000_bodies.npy").write_bytes(b"no array")
        self.assertIn("ping_000000_bodies.npy", self.refused())
        np.save(self.root / "two" / "ping_000000_bodies.npy", self.mask[:3])
        self.assertIn("ping_000000_bodies.npy: has not the shape of the samples", self.refused())
        np.save(self.root / "two" / "ping_000000_bodies.npy", self.mask + 4)
        self.assertIn("has no body 5", self.refused())

    def test_labels(self):
        for text in ("- a\n", "a: [b]\n", "*_1: a\n", "a: ''\n"):
            self.assertIn("labels.yaml: ", self.refused("--labels", self.write("labels.yaml", text)), text)

    def test_an_existing_data_set_stays(self):
        self.out.mkdir()
        self.assertEqual(self.convert(code=2).stderr, "to_dataset: set exists\n")
        self.assertEqual(list(self.out.iterdir()), [])

    def test_command_line(self):
        self.assertIn("'voc': expected one or more of coco, yolo, hdf5", self.refused(form="voc"))
        self.assertIn("is not between -200 and 0", self.refused("--floor-db", "3"))
        self.assertIn("0 is below 1", self.refused("--min-pixels", "0"))

    @unittest.skipIf(HAS_H5PY, "h5py is installed")
    def test_hdf5_without_h5py(self):
        self.assertIn("python3-h5py", self.refused(form="hdf5"))


@unittest.skipUnless(HAS_H5PY, "h5py is not installed (python3-h5py)")
class Hdf5(Folders):
    def test_arrays_poses_and_attributes(self):
        import h5py

        self.convert("--labels", self.labels(), "--split", "train=one", "val=two", form="hdf5")
        with h5py.File(self.out / "train.h5") as file:
            self.assertEqual(list(file), ["one"])
            self.assertEqual(json.loads(file.attrs["classes"]), ["boulder", "structure"])
            group = file["one"]
            for k in range(2):
                np.testing.assert_array_equal(group["samples"][k], np.load(self.one.path / f"ping_00000{k}.npy"))
                np.testing.assert_array_equal(group["masks"][k], [self.mask, 0 * self.mask][k])
            self.assertEqual((group["samples"].dtype, group["samples"].chunks), (np.uint16, (1, 6, 10)))
            self.assertEqual(group["ranges_m"][:].tolist(), [0.25, 0.75, 1.25, 1.75, 2.25, 2.75])
            self.assertEqual(group["bearings_rad"][:].tolist(), [BEARINGS_RAD] * 2)
            self.assertEqual(group["stamps_s"][:].tolist(), [10, 11])
            self.assertEqual(group["T_world_sonar"][:].tolist(), [[0.5, 2, -3, 0, 0, 0.6, 0.8], [1.5, 2, -3, 0, 0, 0.6, 0.8]])
            self.assertEqual([name.decode() for name in group["bodies"]], ["", *BODIES])
            self.assertEqual(group["class_of_body"][:].tolist(), [0, 0, 1, 1, 2])
            self.assertEqual((group.attrs["head"], group.attrs["seeds"].tolist()), ("bow", [11]))
            self.assertEqual(json.loads(group.attrs["run"])["program"], "sonard 9.8.7")
        self.assertIn("| boulder | boulder_1, boulder_2 | 2 | 2 |", (self.out / "README.md").read_text(encoding="utf-8"))

    def scan(self, folder, number, columns):
        """Makes a sweep of a Micron with so many columns of a frame."""
        name = f"ping_{number:06d}"
        facts = json.loads((folder.path / f"{name}.json").read_text(encoding="utf-8"))
        facts.update(type="micron", stamps_s=[0.5 * k for k in range(columns)], T_world_sonar=[pose(k) for k in range(columns)],
                     T_world_vehicle=[pose(0)] * columns)
        facts["geometry"]["bearings_rad"] = BEARINGS_RAD[:columns]
        facts["samples"]["shape"][1] = columns
        folder.write_json(f"{name}.json", facts)
        for file in (folder.path / f"{name}.npy", folder.path / f"{name}_bodies.npy"):
            np.save(file, np.load(file)[:, :columns])

    def test_scanning_heads_have_a_pose_per_column(self):
        import h5py

        folder = Rendered(self.root / "sector", [self.mask] * 2)
        self.scan(folder, 0, 10)
        self.scan(folder, 1, 9)  # sweeps of a sector differ
        self.convert(folders=["sector"], form="hdf5")
        with h5py.File(self.out / "train.h5") as content:
            group = content["sector"]
            self.assertEqual(group["columns"][:].tolist(), [10, 9])
            self.assertEqual(group["T_world_sonar"].shape, (2, 10, 7))
            self.assertEqual(group["T_world_sonar"][1, :9, 0].tolist(), list(range(9)))
            self.assertEqual(group["stamps_s"][0].tolist(), [0.5 * k for k in range(10)])
            self.assertTrue(np.isnan(group["T_world_sonar"][1, 9]).all() and np.isnan(group["bearings_rad"][1, 9]))
            np.testing.assert_array_equal(group["masks"][0], self.mask)
            np.testing.assert_array_equal(group["masks"][1, :, :9], self.mask[:, :9])
            self.assertFalse(group["masks"][1, :, 9].any() or group["samples"][1, :, 9].any())


class Example(Folders):
    """clients/examples/dataset on pictures with a bright bar with a shadow at each label, and noise elsewhere."""

    def bars(self, name, seed, offset_px=0):
        random = np.random.default_rng(seed)
        folder = Rendered(self.root / name, [self.mask] * 24, seed=seed, trajectory=f"{seed:08x}")
        for k in range(24):
            image, mask = random.integers(20, 60, (120, 200), np.uint8), np.zeros((120, 200), np.uint8)
            x, y = (int(value) for value in (random.integers(40, 150), random.integers(10, 50)))
            image[y: y + 6, x: x + 14] += 150
            image[y - 8: y, x: x + 14] = 5
            mask[y: y + 6, x + offset_px: x + offset_px + 14] = 2
            folder.add_fan(k, image, mask, [100.0, 119.0])

    def accuracies(self):
        self.convert("--picture", "fan", "--split", "train=train*", "val=val*", folders=["train_bars", "val_bars"])
        done = subprocess.run([sys.executable, "-B", str(EXAMPLE / "train_detector.py"), str(self.out)], capture_output=True,
                              text=True, timeout=60, check=True)
        return [float(word) for word in re.findall(r"([\d.]+) %", done.stdout)]

    def test_detector_shows_that_labels_fit(self):
        self.bars("train_bars", 1)
        self.bars("val_bars", 2)
        right, of_others = self.accuracies()
        self.assertGreaterEqual(right, 95)
        self.assertLess(of_others, 75)

    def test_detector_shows_that_labels_do_not_fit(self):
        self.bars("train_bars", 1, offset_px=30)
        self.bars("val_bars", 2, offset_px=-30)
        self.assertLess(self.accuracies()[0], 80)

    def test_poses_look_at_a_body(self):
        world = self.write("tank.sdf", "<sdf><world name='t'><model name='wall'><pose>9 9 9 0 0 0</pose></model>"
                                       "<model name='boulder_1'><pose>1 -2 -5 0 0 0</pose></model></world></sdf>")
        done = subprocess.run([sys.executable, "-B", str(EXAMPLE / "poses.py"), world, "--labels", str(EXAMPLE / "labels.yaml"),
                               "--seed", "3", "--count", "40"], capture_output=True, text=True, cwd=self.root, timeout=60, check=True)
        rows = [[float(word) for word in line.split(",")] for line in done.stdout.splitlines()[1:]]
        self.assertEqual([row[0] for row in rows], list(range(40)))
        off_deg = []
        for _, x, y, z, qx, qy, qz, qw in rows:
            self.assertTrue(abs(x) < 6.5 and abs(y) < 4.5 and -5 < z < -0.5, "not in the tank, above the body")
            self.assertTrue(3 <= math.hypot(x - 1, y + 2) <= 10)
            self.assertAlmostEqual(qz * qz + qw * qw, 1, delta=1e-3)
            self.assertEqual((qx, qy), (0, 0))
            off_deg.append((math.degrees(2 * math.atan2(qz, qw) - math.atan2(-2 - y, 1 - x)) + 180) % 360 - 180)
        self.assertLess(max(map(abs, off_deg)), 60)
        self.assertGreater(max(map(abs, off_deg)), 5)


if __name__ == "__main__":
    unittest.main()
