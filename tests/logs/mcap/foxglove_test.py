#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A recording of a Gemini and a Micron as Foxglove displays it; check_foxglove.js reads the file.

    foxglove_test.py --programs DIR --npm DIR [TestCase.test_name ...]
"""

from recorded import RecordingTest, main


class Foxglove(RecordingTest):
    def check(self, log, *heads):
        return self.node("check_foxglove.js", log, *heads)

    def test_images_transforms_and_echoes_are_there(self):
        self.check(self.record(", mcap_foxglove: true"), "bow", "stern")

    def test_they_are_left_out_unless_asked_for(self):
        self.assertEqual(self.check(self.record()), "{}\n")


if __name__ == "__main__":
    main(__doc__)
