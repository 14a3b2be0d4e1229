#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests sonard_client.compare: its measures against numbers calculated by hand and against the formulas of Wang et al. summed
pixel by pixel, its files written byte by byte in their formats, and the program.

    compare_test.py [Similarity.test_name ...]
"""

import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest

import cv2
import numpy as np

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", "..", ".."))
CLIENT = os.path.join(SOURCE, "clients", "python")
sys.path[:0] = [CLIENT]

from sonard_client import compare  # noqa: E402
from sonard_client.compare import load_image, measures, multi_scale_similarity, sift_distance, structural_similarity  # noqa: E402

C1, C2 = 6.5025, 58.5225  # (0.01 * 255)^2, (0.03 * 255)^2


def flat(width, height, value):
    return np.full((height, width), float(value))


def checkerboard(width, height, contrast):
    y, x = np.mgrid[:height, :width]
    return 128.0 + np.where((x + y) % 2 == 0, contrast, -contrast)


def texture(width, height, seed):
    image = cv2.GaussianBlur(np.random.default_rng(seed).normal(size=(height, width)), (0, 0), 2.5)
    return 255 * (image - image.min()) / (image.max() - image.min())


def terms_by_hand(a, b):
    """Means over all windows of contrast times structure, and of that times luminance (Wang et al. 2004, eq. 12-16)."""
    d = np.arange(-5, 6)
    weights = np.exp(-(d[:, None] ** 2 + d[None, :] ** 2) / (2 * 1.5 * 1.5))
    weights /= weights.sum()
    cs_sum, all_sum, windows = 0.0, 0.0, 0
    for y in range(5, a.shape[0] - 5):
        for x in range(5, a.shape[1] - 5):
            wa, wb = a[y - 5: y + 6, x - 5: x + 6], b[y - 5: y + 6, x - 5: x + 6]
            ma, mb = (weights * wa).sum(), (weights * wb).sum()
            va, vb = (weights * (wa - ma) ** 2).sum(), (weights * (wb - mb) ** 2).sum()
            cs = (2 * (weights * (wa - ma) * (wb - mb)).sum() + C2) / (va + vb + C2)
            cs_sum += cs
            all_sum += cs * (2 * ma * mb + C1) / (ma * ma + mb * mb + C1)
            windows += 1
    return cs_sum / windows, all_sum / windows


def half_by_hand(image):
    height, width = image.shape[0] // 2 * 2, image.shape[1] // 2 * 2
    return sum(image[i:height:2, j:width:2] for i in (0, 1) for j in (0, 1)) / 4


def by_name(rows):
    return {row["name"]: row for row in rows}


class Similarity(unittest.TestCase):
    def test_identical_images(self):
        image = texture(180, 200, 1)
        same = by_name(measures(image, image.copy()))
        self.assertEqual(same["mse"]["score"], 0.0)
        self.assertEqual((same["psnr"]["value"], same["psnr"]["score"]), (99.0, 1.0))
        self.assertAlmostEqual(same["ssim"]["score"], 1.0, delta=1e-12)
        self.assertAlmostEqual(same["ms_ssim"]["score"], 1.0, delta=1e-12)
        self.assertEqual(same["sift_distance"]["score"], 0.0)

    def test_mean_squared_error_by_hand(self):
        a = flat(4, 4, 100)  # 4 of 16 pixels differ by 10, and 1 by -20: (4 * 100 + 400) / 16 = 50
        b = a.copy()
        b[2] += 10
        b[0, 3] = 80
        rows = by_name(measures(a, b))
        self.assertEqual(rows["mse"]["value"], 50)
        self.assertAlmostEqual(rows["psnr"]["value"], 31.141103, delta=1e-6)  # 10 log10(65025 / 50)
        self.assertAlmostEqual(rows["mse"]["score"], 7.689350e-4, delta=1e-10)  # 50 / 65025
        self.assertAlmostEqual(rows["psnr"]["score"], 0.314556596, delta=1e-8)  # of 99 dB

    def test_black_against_white_is_the_worst(self):
        worst = by_name(measures(flat(200, 180, 0), flat(200, 180, 255)))
        self.assertEqual(worst["mse"]["score"], 1.0)
        self.assertAlmostEqual(worst["psnr"]["score"], 0.0, delta=1e-12)
        self.assertAlmostEqual(worst["ssim"]["value"], 9.999000e-5, delta=1e-10)  # C1 / (255^2 + C1)

    def test_a_constant_offset_changes_luminance_only(self):
        a, b = flat(192, 180, 100), flat(192, 180, 150)  # (2 a b + C1) / (a^2 + b^2 + C1); at the last scale to the 0.1333
        self.assertAlmostEqual(structural_similarity(a, b), 30006.5025 / 32506.5025, delta=1e-9)
        self.assertAlmostEqual(multi_scale_similarity(a, b), (30006.5025 / 32506.5025) ** 0.1333, delta=1e-9)

    def test_sums_over_windows(self):
        a = texture(23, 19, 2)
        b = 0.5 * a + 0.5 * texture(23, 19, 3)
        self.assertAlmostEqual(structural_similarity(a, b), terms_by_hand(a, b)[1], delta=1e-9)

    def test_inverted_contrast_is_negative(self):
        # Both variances are s^2 and the covariance is -s^2: (C2 - 2 s^2) / (C2 + 2 s^2) with s = 50. The means are equal.
        a, b = checkerboard(40, 30, 50), checkerboard(40, 30, -50)
        self.assertAlmostEqual(structural_similarity(a, b), (58.5225 - 5000) / (58.5225 + 5000), delta=1e-4)
        self.assertEqual(by_name(measures(a, b))["ssim"]["score"], 0.0)

    def test_one_scale_of_five(self):
        # A board of single pixels is flat at all scales but the first, so the result has the power of the first weight.
        a, b = checkerboard(180, 180, 60), checkerboard(180, 180, 15)
        first = (2 * 60.0 * 15 + C2) / (60.0 * 60 + 15.0 * 15 + C2)
        self.assertAlmostEqual(multi_scale_similarity(a, b), first ** 0.0448, delta=1e-6)

    def test_all_scales(self):
        a = texture(181, 177, 4)
        b = 0.7 * a + 0.3 * texture(181, 177, 5)
        measured, product = multi_scale_similarity(a, b), 1.0
        for scale, weight in enumerate((0.0448, 0.2856, 0.3001, 0.2363, 0.1333)):  # Wang et al. 2003, 4
            product *= terms_by_hand(a, b)[1 if scale == 4 else 0] ** weight
            a, b = half_by_hand(a), half_by_hand(b)
        self.assertAlmostEqual(measured, product, delta=1e-9)
        self.assertLess(product, 0.95)

    def test_small_images_have_no_windows(self):
        self.assertIsNone(structural_similarity(flat(10, 50, 1), flat(10, 50, 1)))
        self.assertIsNotNone(structural_similarity(flat(11, 11, 1), flat(11, 11, 1)))
        self.assertIsNone(multi_scale_similarity(flat(175, 300, 1), flat(175, 300, 1)))
        self.assertIsNotNone(multi_scale_similarity(flat(176, 300, 1), flat(176, 300, 1)))


class SiftDistance(unittest.TestCase):
    def test_of_an_image_to_itself_is_zero(self):
        self.assertEqual(sift_distance(texture(200, 150, 11), texture(200, 150, 11)), 0.0)

    def test_of_unrelated_images_is_near_one(self):
        self.assertGreater(sift_distance(texture(200, 150, 12), texture(200, 150, 13)), 0.9)

    def test_a_turned_image_is_found_again(self):
        image = texture(150, 150, 14)
        self.assertLess(sift_distance(image, np.rot90(image)), 0.35)

    def test_grows_with_what_is_new(self):
        half_new = texture(200, 150, 15)
        half_new[:, 100:] = texture(200, 150, 16)[:, 100:]
        self.assertTrue(0.3 < sift_distance(texture(200, 150, 15), half_new) < 0.7)

    def test_does_not_depend_on_the_order(self):
        a = texture(200, 150, 17)
        b = 0.6 * a + 0.4 * texture(200, 150, 18)
        self.assertAlmostEqual(sift_distance(a, b), sift_distance(b, a), delta=1e-12)

    def test_without_keypoints(self):
        self.assertIsNone(sift_distance(flat(100, 100, 90), flat(100, 100, 10)))
        self.assertEqual(sift_distance(flat(100, 100, 90), texture(100, 100, 19)), 1.0)


class InAFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data)
        return self.path(name)

    def picture(self, name, width, height, value):
        cv2.imwrite(self.path(name), np.full((height, width), value, np.uint8))
        return self.path(name)


def npy(descr, shape, samples):
    """A file in NumPy's format 1.0, padded so that the samples begin at a multiple of 64."""
    header = f"{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}".ljust(117)
    return b"\x93NUMPY\x01\x00\x76\x00" + header.encode() + b"\n" + samples


def scan_line(turn, bearing, step, bins):
    return json.dumps({"number": 0, "turn": turn, "unix_s": 1.5, "bearing": bearing, "left_limit": 0, "right_limit": 0,
                       "step": step, "all_round": True, "bits": 8, "bins": bins}) + "\n"


def dat_image(pixels):
    """Two lines of three beams, laid out by protocol/glf/README.md 1.3 and 1.4, with raw pixels and zeros in unused fields."""
    body = struct.pack("<HHHIIHIIHI", 1, 0xEFEF, 3, 0, 2, 0, 0, 3, 1, 6) + pixels + struct.pack(
        "<3dIIfdHfHIH", 1.0, 0.0, -1.0, 0, 18750, 120.0, 1.5, 0, 1500.0, 50, 0, 0xDEDE)
    return b"*" + struct.pack("<BIdBHHH", 2, 21 + len(body), 1.5, 0, 1194, 100, 0) + body


class Images(InAFolder):
    def refused(self, source, message):
        with self.assertRaises((ValueError, OSError), msg=source) as caught:
            load_image(source)
        self.assertIn(message, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))

    def test_pictures_are_grey(self):
        picture = np.full((2, 3, 3), 40, np.uint8)
        picture[1, 2] = 255
        cv2.imwrite(self.path("picture.png"), picture)
        image = load_image(self.path("picture.png"))
        self.assertEqual((image.shape, image[0, 0], image[1, 2]), ((2, 3), 40, 255))

    def test_a_dumped_ping_has_range_upwards(self):
        image = load_image(self.write("ping.npy", npy("|u1", "(2, 3)", b"\1\2\3\4\5\6")))  # two bins, the near one first
        self.assertEqual(image.tolist(), [[4, 5, 6], [1, 2, 3]])

    def test_sixteen_bits_have_the_same_scale(self):
        image = load_image(self.write("ping.npy", npy("<u2", "(1, 2)", b"\xff\xff\1\1")))
        self.assertAlmostEqual(image[0, 0], 255)
        self.assertAlmostEqual(image[0, 1], 1)  # 257 of 65535 in 8 bits

    def test_a_ping_of_a_dump(self):
        index = self.write("gemini.csv", b"number,id,transmit_us,lines,beams,crc32\n"
                                         b"7,7,1000,1,2,00000000\n12,12,2000,1,2,00000000\n")
        self.write("gemini-00000012.npy", npy("|u1", "(1, 2)", b"ab"))
        self.assertEqual(load_image(index + "#12")[0, 1], ord("b"))
        self.refused(index + "#1", "has no ping 1")
        self.refused(index + "#7", "gemini-00000007.npy")
        self.refused(index + "#seven", "expected")
        self.refused(index, "#PING")

    def test_a_turn_of_a_scan(self):
        # Steps of 9 degrees, all round: 40 columns. Bearing 3200 is ahead, in the middle of the picture, which begins astern.
        lines = [(0, 3200, "1020"), (1, 3200, "01ff"), (1, 4800, "0304"), (1, 0, "0506")]
        file = self.write("turn.jsonl", "".join(scan_line(*line[:2], 160, line[2]) for line in lines).encode())
        image = load_image(file + "#1")
        self.assertEqual(image.shape, (2, 40))
        self.assertEqual(image[0, 20], 255)  # the far bin, ahead
        self.assertEqual(image[1, 30], 3)  # the near bin, to starboard
        self.assertEqual(image[0, 0], 6)  # astern
        self.assertEqual(image[0, 10], 0)  # there is no line to port
        self.refused(file + "#2", "has no turn 2")
        self.refused(file, "#TURN")
        self.refused(self.write("step.jsonl", scan_line(0, 3200, 1600, "10").encode()) + "#0",
                     "step.jsonl:1: step 1600 is out of range")
        self.refused(self.write("mixed.jsonl", (scan_line(0, 0, 160, "10") + scan_line(0, 160, 160, "1020")).encode()) + "#0",
                     "mixed.jsonl:2: differs from the turn's first line")
        self.refused(self.write("text.jsonl", b"no line\n") + "#0", "text.jsonl:1: is not a line of a scanning head")
        self.refused(self.write("other.jsonl", b"[3]\n") + "#0", "other.jsonl:1: is not a line of a scanning head")

    def test_a_sector_begins_at_its_left_limit(self):
        line = {"turn": 0, "bearing": 3360, "left_limit": 3200, "right_limit": 3520, "step": 160, "all_round": False, "bits": 4,
                "bins": "0f"}
        image = load_image(self.write("sector.jsonl", json.dumps(line).encode()) + "#0")
        self.assertEqual(image.tolist(), [[0, 255, 0]])

    def test_images_of_a_log_are_counted(self):
        log = self.write("log.dat", dat_image(b"abcdef") + dat_image(b"uvwxyz") + b"\xDE\xDE")
        image = load_image(log + "#1")
        self.assertEqual(image.shape, (2, 3))
        self.assertEqual(image[1, 0], ord("u"))  # the near bin is at the bottom
        self.assertEqual(image[0, 2], ord("z"))
        self.refused(log + "#2", "has no image 2; it has 2 images")
        self.refused(log + "#", "expected")
        self.refused(self.write("other.glf", b"PK, or not") + "#0", "other.glf")

    def test_other_files_are_refused(self):
        self.refused(self.path("missing.png"), "missing.png")
        self.refused(self.folder.name, self.folder.name)
        for name, data in {"text.png": b"no picture", "empty.png": b""}.items():
            self.refused(self.write(name, data), f"{name}: is not a PNG or JPEG picture")
        for name, data in {"text.npy": b"no array", "empty.npy": b"", "short.npy": npy("|u1", "(2, 3)", b"abcde"),
                           "huge.npy": npy("|u1", "(999999, 999999)", b"")}.items():
            self.refused(self.write(name, data), f"{name}: is not a NumPy file with all its samples")
        for name, data in {"floats.npy": npy("<f4", "(1, 1)", b"abcd"), "flat.npy": npy("|u1", "(4,)", b"abcd"),
                           "none.npy": npy("|u1", "(0, 3)", b"")}.items():
            self.refused(self.write(name, data), f"{name}: is not a table of 8-bit or 16-bit samples")


class Program(InAFolder):
    def compare(self, *words):
        return subprocess.run([sys.executable, "-m", "sonard_client.compare", *words], capture_output=True, text=True,
                              cwd=CLIENT, check=False)

    def test_prints_a_table_and_writes_json(self):
        # Flat images, 100 against 150: MSE 2500, PSNR 14.1514 dB, no keypoints. They are too small for five scales.
        a, b = self.picture("a.png", 64, 48, 100), self.picture("b.png", 64, 48, 150)
        result = self.compare(a, b, "--json", self.path("out.json"))
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(result.stdout, "measure              value         score  identical\n"
                                        "MSE              2500.0000        0.0384          0\n"
                                        "PSNR               14.1514 dB     0.1429          1\n"
                                        "SSIM                0.9231        0.9231          1\n"
                                        "MS-SSIM                  -             -          1\n"
                                        "SIFT distance            -             -          0\n")
        with open(self.path("out.json"), encoding="utf-8") as file:
            written = json.load(file)
        self.assertEqual([written[key] for key in ("a", "b", "width", "height")], [a, b, 64, 48])
        self.assertEqual(len(written["measures"]), 5)
        psnr = by_name(written["measures"])["psnr"]
        self.assertAlmostEqual(psnr["value"], 10 * math.log10(65025 / 2500), delta=1e-9)
        self.assertEqual((psnr["unit"], psnr["identical"]), ("dB", 1))
        self.assertEqual(by_name(written["measures"])["ms_ssim"],
                         {"name": "ms_ssim", "value": None, "unit": "", "score": None, "identical": 1})

    def test_exit_status_1_without_a_comparison(self):
        a = self.picture("a.png", 30, 20, 10)
        for other, why in ((self.picture("b.png", 20, 30, 10), "b.png is 20 x 30"), (self.path("missing.png"), "missing.png"),
                           (self.write("notes.txt", b"no picture"), "notes.txt: is not a PNG or JPEG picture")):
            result = self.compare(a, other)
            self.assertEqual((result.returncode, result.stdout), (1, ""), other)
            self.assertTrue(result.stderr.startswith("compare: ") and why in result.stderr, result.stderr)
        self.assertEqual(self.compare(a, a, "--json", self.path("no/such/folder.json")).returncode, 1)

    def test_exit_status_2_for_an_invalid_command_line(self):
        for words in ([], ["a.png"], ["a.png", "b.png", "c.png"]):
            self.assertEqual(self.compare(*words).returncode, 2, words)
        self.assertEqual(self.compare("--help").returncode, 0)


if __name__ == "__main__":
    unittest.main()
